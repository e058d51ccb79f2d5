"""`python -m studies.upsets`."""

import sys

from sculler.main import run_command
from studies.upsets.command import command

sys.exit(run_command(command, sys.argv[1:], "python -m studies.upsets"))
