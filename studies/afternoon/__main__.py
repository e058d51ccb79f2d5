"""`python -m studies.afternoon`."""

import sys

from sculler.main import run_command
from studies.afternoon.command import command

sys.exit(run_command(command, sys.argv[1:], "python -m studies.afternoon"))
