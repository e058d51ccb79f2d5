"""`python -m studies.hardware`."""

import sys

from sculler.main import run_command
from studies.hardware.command import command

sys.exit(run_command(command, sys.argv[1:], "python -m studies.hardware"))
