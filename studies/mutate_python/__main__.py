"""`python -m studies.mutate_python`."""

import sys

from sculler.main import run_command
from studies.mutate_python.command import command

sys.exit(run_command(command, sys.argv[1:], "python -m studies.mutate_python"))
