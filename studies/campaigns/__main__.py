"""`python -m studies.campaigns`."""

import sys

from sculler.main import run_command
from studies.campaigns.command import command

sys.exit(run_command(command, sys.argv[1:], "python -m studies.campaigns"))
