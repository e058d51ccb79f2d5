"""`python -m sculler`."""

import sys

from sculler.main import main

sys.exit(main())
