"""`make test-breaks`: make every fault in turn, print the table of which test finds it.

Exit status 1 where one is not found.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

from breaks.faults import FAULTS
from breaks.running import copy, made, run


def main() -> int:
    """The table, as Markdown."""
    parser = argparse.ArgumentParser(prog="python -m breaks", description=__doc__)
    parser.add_argument("--only", metavar="NAME", choices=FAULTS, help="one of the faults")
    only = parser.parse_args().only
    status = 0
    print("| fault | where | found by | CPU time |\n|---|---|---|---:|")
    with tempfile.TemporaryDirectory(prefix="sculler-breaks-") as folder:
        root = copy(Path(folder))
        for name in [only] if only else FAULTS:
            fault = FAULTS[name]
            with made(fault, root):
                caught = run(fault, root)
            test = f"`{caught.test}`" if caught.test else "**nothing**"
            where = fault.place(root)
            print(f"| {fault.what} | `{where}` | {test} | {caught.seconds:.0f} s |", flush=True)
            if not caught.test:
                status = 1
                print(caught.said, file=sys.stderr)
    return status


if __name__ == "__main__":
    sys.exit(main())
