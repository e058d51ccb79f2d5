"""`python -m studies.mutate`."""

import sys

from sculler.main import run_command
from studies.mutate.command import command

sys.exit(run_command(command, sys.argv[1:], "python -m studies.mutate"))
