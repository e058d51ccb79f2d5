"""High-resolution position in hardware: the golden model's vectors, the cycle model's clocks.

The Verilog of both cores in Verilator, the compact one's on all targets; worst cases of scrolling
among the inputs.
"""

from typing import Any

import numpy as np
import pytest

from position_designs import HIGH_RESOLUTION, furthest
from rtl import (
    anywhere_in_four_majors,
    check_resets,
    check_trace,
    clocks_of_major,
    golden,
    samples_of,
)
from sculler_sim.engine import simulate
from sculler_sim.stimulus import Stimulus
from strategies import TARGETS, with_hardware
from tiers import few_of

pytestmark = pytest.mark.usefixtures("verilator")

SIMULATED = "smallest_hr savage_hr stim300_hr wide_hr taylor_2p1_hr dense_hr".split()
PIPELINED: dict[str, dict[str, Any]] = {
    "smallest_hr": {},
    "stim300_hr": {"target": "ecp5"},
    "wide_hr": {"handover": "stream"},
    "taylor_2p1_hr": {"target": "ecp5", "multipliers": 20},
    "taylor_3p3_hr": {"target": "ice40", "handover": "stream"},
    "dense_hr": {"target": "ice40", "multipliers": 7},
    "long_hr": {"target": "ecp5", "multipliers": 30},
}
FORMS = {name: HIGH_RESOLUTION[name] for name in SIMULATED} | {
    f"{name}-pipelined": with_hardware(HIGH_RESOLUTION[name], core="pipelined", **hardware)
    for name, hardware in PIPELINED.items()
}
# the benches have every target and width with high-resolution position
QUICK = ("smallest_hr", "dense_hr", "smallest_hr-pipelined")
EACH = pytest.mark.parametrize("design", few_of(FORMS, QUICK))


def check_rows(design, counts, stimulus):
    """The core's results are the golden model's."""
    faults = np.zeros(len(counts), int)
    run = simulate(design, [(counts, faults)], engine="verilator", stimulus=stimulus)
    rows = [row for block in run for row in block.rows()]
    assert rows == list(golden(design, counts, faults).rows())
    assert all(len(row) == len(design.columns) == 29 for row in rows)


@EACH
def test_verilator_gives_the_golden_vectors(design):
    """With and without stalls, full-scale counts among the samples."""
    counts, _ = samples_of(design, 5 * design.samples_per_major, seed=11)
    for stimulus in (Stimulus.always(), Stimulus.stalls(5, 2 * clocks_of_major(design))):
        check_rows(design, counts, stimulus)


@EACH
def test_verilator_shows_on_every_clock_what_the_cycle_model_says(design):
    """Under stalls of both sides and resets in mid-interval."""
    check_trace(design, "verilator", max(12_000, 5 * clocks_of_major(design)), seeds=range(2))


@EACH
def test_near_the_extremes_of_scrolling(design):
    """All axes, both ends, one after another, so that history runs from one to the next."""
    logs = [furthest(design, axis, sign) for axis in range(3) for sign in (1, -1)]
    check_rows(design, np.concatenate(logs), Stimulus.always())


@EACH
def test_resets_and_stalls(design, tmp_path):
    samples = 10 * design.samples_per_major + 20
    check_resets(design, tmp_path, samples, anywhere_in_four_majors(design))


@pytest.mark.parametrize(
    ("name", "seed"),
    [
        ("smallest_hr", 4),
        pytest.param("savage_hr", 4, marks=pytest.mark.deep),
        pytest.param("taylor_2p1_hr", 2, marks=pytest.mark.deep),
    ],
)
def test_without_a_multiplier(name, seed):
    """Seeds with results between the resets."""
    design = with_hardware(HIGH_RESOLUTION[name], core="compact", multipliers=0)
    check_rows(design, furthest(design, 1, -1), Stimulus.always())
    check_trace(design, "verilator", 2 * clocks_of_major(design), seeds=[seed])


@pytest.mark.parametrize("target", few_of(TARGETS, ["ecp5", "ice40"]))
def test_every_target(target):
    """Blocks of the vendor in place of what is inferred, by their models."""
    design = with_hardware(HIGH_RESOLUTION["taylor_2p1_hr"], core="compact", target=target)
    check_rows(design, furthest(design, 2, 1), Stimulus.stalls(1, clocks_of_major(design)))
    check_trace(design, "verilator", 4 * clocks_of_major(design), seeds=range(2))
