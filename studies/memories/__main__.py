"""`python -m studies.memories`."""

import sys

from sculler.main import run_command
from studies.memories.command import command

sys.exit(run_command(command, sys.argv[1:], "python -m studies.memories"))
