"""The compact core in both its forms equals the golden model and, clock by clock, the cycle model.

Its Verilog in Verilator and its Amaranth design in Amaranth's simulator, generic target.
"""

import pytest

from rtl import (
    anywhere_in_four_majors,
    check_files,
    check_resets,
    check_trace,
    clocks_of_major,
)
from sculler_hdl import timing
from strategies import DESIGNS, with_hardware
from tiers import few_of, tiers

pytestmark = pytest.mark.usefixtures("verilator")

COMPACT = {name: with_hardware(design, core="compact") for name, design in DESIGNS.items()}
SERIAL = {
    f"{name}-serial": with_hardware(DESIGNS[name], core="compact", multipliers=0)
    for name in ("stim300_4x5", "dense_odd_3", "smallest", "wide_5p0")
}
EACH_DESIGN = pytest.mark.parametrize("design", tiers(COMPACT, also=["stim300_4x5"]))
EACH_SERIAL = pytest.mark.parametrize(
    "design", few_of(SERIAL, ["dense_odd_3-serial", "smallest-serial"])
)


@EACH_DESIGN
def test_the_files_of_model_and_verilator_are_equal(design, tmp_path):
    """Every design, with and without stalls, full-scale counts among the samples."""
    check_files(design, tmp_path, ["verilator"], samples=60)


@EACH_DESIGN
def test_verilator_shows_on_every_clock_what_the_cycle_model_says(design):
    clocks = max(12_000, 5 * clocks_of_major(design))
    check_trace(design, "verilator", clocks, seeds=range(2))


@pytest.mark.parametrize(
    "name", few_of(["stim300_4x5", "taylor_3p3", "wide_5p0", "dense_odd_3"], [])
)
def test_amaranth_gives_the_same_files_and_shows_on_every_clock_the_same(name, tmp_path):
    check_files(COMPACT[name], tmp_path, ["amaranth"], samples=4)
    check_trace(COMPACT[name], "amaranth", 2 * clocks_of_major(COMPACT[name]), [4], least=-1)


@EACH_DESIGN
def test_random_resets_and_stalls_give_the_cycle_models_results(design, tmp_path):
    samples = 6 * design.samples_per_major + 20
    check_resets(design, tmp_path, samples, anywhere_in_four_majors(design))


@pytest.mark.deep
@EACH_SERIAL
def test_without_a_multiplier(design, tmp_path):
    check_files(design, tmp_path, ["verilator"], samples=10)
    check_trace(design, "verilator", 3 * clocks_of_major(design), seeds=range(2))


def test_the_engine_is_busy_only_after_phases_that_have_work():
    for design in COMPACT.values():
        busy = [phase for phase, work in enumerate(timing(design).work, start=1) if work]
        assert busy == sorted({*design.table.active_phases, design.algorithm.samples})
