"""Taps that reach further back than the interval before: both cores equal the cycle model."""

import pytest

from rtl import check_trace, clocks_of_major
from strategies import make_design, with_hardware

pytestmark = [pytest.mark.deep, pytest.mark.usefixtures("verilator")]

LONG = {
    "parabola": make_design("parabola_1p2", 1, 2, 6, (14, 11), "time-taylor"),
    "far": make_design("far_1p7", 1, 7, 6, (14, 11)),
    "spread": make_design("spread_2p4", 2, 4, 3, (14, 11), "uncompressed"),
}


@pytest.mark.parametrize("core", ["compact", "pipelined"])
@pytest.mark.parametrize("name", LONG)
def test_on_every_clock(name, core):
    design = with_hardware(LONG[name], core=core)
    check_trace(design, "verilator", max(4000, 5 * clocks_of_major(design)), seeds=range(2))
