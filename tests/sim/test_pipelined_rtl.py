"""The pipelined core in all its forms equals the golden model and, clock by clock, the cycle model.

Its Verilog in Verilator and its Amaranth design in Amaranth's simulator, generic target.
"""

import pytest

from rtl import check_files, check_resets, check_trace, clocks_of_major
from sculler_hdl import timing
from sculler_sim.stimulus import Stimulus
from strategies import DESIGNS, on_cores, with_hardware
from tiers import few_of, tiers

pytestmark = pytest.mark.usefixtures("verilator")

EACH_DESIGN = pytest.mark.parametrize("design", tiers(DESIGNS, also=["stim300_4x5"]))

# compressed and dense, long and short, narrow and wide
SOME = ["stim300_4x5", "taylor_3p3", "wide_5p0", "rate_2p0", "dense_odd_3", "smallest"]
FORMS = {
    "streaming": {"handover": "stream"},
    "shared": {"multipliers": 10},
    "shared-streaming": {"multipliers": 10, "handover": "stream"},
}
OTHER_FORMS = {
    name: design for each in SOME for name, design in on_cores(DESIGNS[each], FORMS).items()
}
EACH_FORM = pytest.mark.parametrize("design", tiers(OTHER_FORMS))
# Amaranth's simulator is slow: at every change it gives traces, and files of few other cores
EACH_ENGINE = pytest.mark.parametrize(
    "engine", ["verilator", pytest.param("amaranth", marks=pytest.mark.deep)]
)


@EACH_DESIGN
@EACH_ENGINE
def test_the_files_of_model_and_simulator_are_equal(design, engine, tmp_path):
    """Every design, with and without stalls, full-scale counts among the samples."""
    check_files(design, tmp_path, [engine], samples=60)


@EACH_DESIGN
def test_verilator_shows_on_every_clock_what_the_cycle_model_says(design):
    check_trace(design, "verilator", 40 * design.samples_per_major + 600, seeds=range(3))


@pytest.mark.parametrize(
    "name", few_of([*SOME, "late_sum_2"], ["taylor_3p3", "dense_odd_3", "late_sum_2"])
)
def test_amaranth_shows_on_every_clock_what_the_cycle_model_says(name):
    check_trace(DESIGNS[name], "amaranth", 600, seeds=[4], least=-1)


@EACH_DESIGN
def test_random_resets_and_stalls_give_the_cycle_models_results(design, tmp_path):
    stimulus = Stimulus.stalls(2, 64).with_resets(3, 40, 41, 77, 160, 161, 162, 391)
    check_resets(design, tmp_path, 20 * design.samples_per_major + 100, stimulus)


@EACH_FORM
@EACH_ENGINE
def test_other_forms_give_the_same_files(design, engine, tmp_path):
    check_files(design, tmp_path, [engine], samples=60)


@EACH_FORM
def test_other_forms_show_on_every_clock_what_the_cycle_model_says(design):
    check_trace(design, "verilator", 12 * clocks_of_major(design) + 600, seeds=range(3))
    check_trace(design, "amaranth", 600, seeds=[4], least=-1)


def test_fewer_multipliers_take_more_clocks():
    """What the forms are there for: some share, all stream words without a pause."""
    spacing = {name: timing(design).spacing for name, design in OTHER_FORMS.items()}
    assert {name for name, clocks in spacing.items() if clocks > 1} == {
        name for name in OTHER_FORMS if "shared" in name
    }
    assert all(timing(design).handover_spacing == 1 for design in OTHER_FORMS.values())


ON_ECP5 = {name: with_hardware(design, target="ecp5") for name, design in DESIGNS.items()}
# in very short and very long major intervals a second result wins no clocks
ROOM_FOR_ONE = "savage_1p1 taylor_3p3 taylor_6p2 taylor_7p0 smallest late_sum_2".split()
TWO_RESULTS = {name: design for name, design in ON_ECP5.items() if name not in ROOM_FOR_ONE}
EACH_WITH_TWO = pytest.mark.parametrize("design", few_of(TWO_RESULTS, ["stim300_4x5"]))


@EACH_WITH_TWO
def test_with_room_for_two_results(design, tmp_path):
    """Hosts that take results at once, late, or so late that samples wait; resets at any time."""
    assert timing(design).results == 2
    check_files(design, tmp_path, ["verilator"], samples=60)
    check_trace(design, "verilator", 40 * clocks_of_major(design) + 600, seeds=range(3))
    stimulus = Stimulus.stalls(2, 64).with_resets(3, 40, 41, 77, 160, 161, 162, 391)
    check_resets(design, tmp_path, 20 * design.samples_per_major + 100, stimulus)


@pytest.mark.parametrize("name", ROOM_FOR_ONE)
def test_the_others_have_room_for_one(name):
    assert timing(ON_ECP5[name]).results == 1
