"""`python -m studies.navigator`."""

import sys

from sculler.main import run_command
from studies.navigator.command import command

sys.exit(run_command(command, sys.argv[1:], "python -m studies.navigator"))
