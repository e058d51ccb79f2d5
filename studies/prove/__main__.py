"""`python -m studies.prove`."""

import sys

from sculler.main import run_command
from studies.prove.command import command

sys.exit(run_command(command, sys.argv[1:], "python -m studies.prove"))
