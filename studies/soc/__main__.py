"""`python -m studies.soc`."""

import sys

from sculler.main import run_command
from studies.soc.command import command

sys.exit(run_command(command, sys.argv[1:], "python -m studies.soc"))
