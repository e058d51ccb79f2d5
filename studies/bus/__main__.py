"""`python -m studies.bus`."""

import sys

from sculler.main import run_command
from studies.bus.command import command

sys.exit(run_command(command, sys.argv[1:], "python -m studies.bus"))
