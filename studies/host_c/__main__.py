"""`python -m studies.host_c`."""

import sys

from sculler.main import run_command
from studies.host_c.command import command

sys.exit(run_command(command, sys.argv[1:], "python -m studies.host_c"))
