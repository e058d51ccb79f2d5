"""`python -m studies.accuracy`."""

import sys

from sculler.main import run_command
from studies.accuracy.page import command

sys.exit(run_command(command, sys.argv[1:], "python -m studies.accuracy"))
