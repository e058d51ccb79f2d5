"""The pipelined core on every target with blocks of its own, in Icarus Verilog.

The blocks' models and the core's text as they are handed out; the bench holds every port to the
golden vectors and to the core's timing on every clock.
"""

import pytest

from bench_files import run_bench
from position_designs import HIGH_RESOLUTION
from strategies import DESIGNS, on_targets

EACH = {
    name: on_target
    for design in (*DESIGNS.values(), HIGH_RESOLUTION["taylor_3p3_hr"])
    for name, on_target in on_targets(design, "pipelined").items()
}

pytestmark = pytest.mark.usefixtures("icarus")

SHORT = ((1, 50), (2, 100))
"""A reset after some 50 samples, then at least two major intervals."""


@pytest.mark.parametrize("design", EACH.values(), ids=EACH.keys())
def test_the_bench_passes(design, tmp_path):
    run_bench(design, tmp_path, SHORT)
