"""The compact core in both its forms equals the golden model and, clock by clock, the cycle model.

Its Verilog in Verilator and its Amaranth design in Amaranth's simulator, generic target.
"""

import numpy as np
import pytest

from rtl import check_files, check_trace, clocks_of_major, samples_of, write
from sculler_hdl.core import timing
from sculler_sim.compare import compare
from sculler_sim.engine import simulate
from sculler_sim.stimulus import Stimulus
from strategies import DESIGNS, with_hardware

pytestmark = pytest.mark.usefixtures("verilator")

COMPACT = {name: with_hardware(design, core="compact") for name, design in DESIGNS.items()}
SERIAL = {
    f"{name}-serial": with_hardware(DESIGNS[name], core="compact", multipliers=0)
    for name in ("stim300_4x5", "dense_odd_3", "smallest", "wide_5p0")
}
EACH_DESIGN = pytest.mark.parametrize("design", COMPACT.values(), ids=COMPACT.keys())
EACH_SERIAL = pytest.mark.parametrize("design", SERIAL.values(), ids=SERIAL.keys())


@EACH_DESIGN
def test_the_files_of_model_and_verilator_are_equal(design, tmp_path):
    """Every design, with and without stalls, full-scale counts among the samples."""
    check_files(design, tmp_path, ["verilator"], samples=60)


@EACH_DESIGN
def test_verilator_shows_on_every_clock_what_the_cycle_model_says(design):
    clocks = max(12_000, 5 * clocks_of_major(design))
    check_trace(design, "verilator", clocks, seeds=range(2))


@pytest.mark.parametrize("name", ["stim300_4x5", "taylor_3p3", "wide_5p0", "dense_odd_3"])
def test_amaranth_gives_the_same_files_and_shows_on_every_clock_the_same(name, tmp_path):
    check_files(COMPACT[name], tmp_path, ["amaranth"], samples=4)
    check_trace(COMPACT[name], "amaranth", 2 * clocks_of_major(COMPACT[name]), [3], least=-1)


@EACH_DESIGN
def test_random_resets_and_stalls_give_the_cycle_models_results(design, tmp_path):
    """Resets come while samples load, while the engine computes and while words wait."""
    counts, faults = samples_of(design, 6 * design.samples_per_major + 20, seed=8)
    major = clocks_of_major(design)
    resets = np.random.default_rng(2).integers(0, 4 * major, 5).tolist()
    stimulus = Stimulus.stalls(2, major).with_resets(3, 40, 41, *resets)
    paths = [
        write(
            tmp_path / f"{engine}.csv",
            simulate(design, [(counts, faults)], engine=engine, stimulus=stimulus),
        )
        for engine in ("model", "verilator")
    ]
    assert compare(*paths) is None


@EACH_SERIAL
def test_without_a_multiplier(design, tmp_path):
    check_files(design, tmp_path, ["verilator"], samples=10)
    check_trace(design, "verilator", 3 * clocks_of_major(design), seeds=range(2))


def test_the_engine_is_busy_only_after_phases_that_have_work():
    for design in COMPACT.values():
        busy = [phase for phase, work in enumerate(timing(design).work, start=1) if work]
        assert busy == sorted({*design.table.active_phases, design.algorithm.samples})
