"""`python -m studies.bench`."""

import sys

from sculler.main import run_command
from studies.bench.command import command

sys.exit(run_command(command, sys.argv[1:], "python -m studies.bench"))
