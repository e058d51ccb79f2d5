"""`python -m studies.evidence`."""

import sys

from sculler.main import run_command
from studies.evidence.command import command

sys.exit(run_command(command, sys.argv[1:], "python -m studies.evidence"))
