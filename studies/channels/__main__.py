"""`python -m studies.channels`."""

import sys

from sculler.main import run_command
from studies.channels.command import command

sys.exit(run_command(command, sys.argv[1:], "python -m studies.channels"))
