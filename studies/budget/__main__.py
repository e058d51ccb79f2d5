"""`python -m studies.budget`."""

import sys

from sculler.main import run_command
from studies.budget.command import command

sys.exit(run_command(command, sys.argv[1:], "python -m studies.budget"))
