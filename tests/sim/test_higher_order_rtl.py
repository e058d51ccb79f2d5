"""Cores of third and fourth order: the golden model's vectors, the cycle model's clocks."""

import pytest

from higher_order_designs import HIGHER_ORDER
from rtl import check_files, check_trace, clocks_of_major
from strategies import with_hardware
from tiers import few_of

pytestmark = pytest.mark.usefixtures("verilator")

FORMS = HIGHER_ORDER | {
    "one_sample-ecp5": with_hardware(HIGHER_ORDER["one_sample"], core="compact", target="ecp5"),
    "fourth_order-ice40": with_hardware(
        HIGHER_ORDER["fourth_order"], core="compact", target="ice40"
    ),
    "two_samples-serial": with_hardware(HIGHER_ORDER["two_samples"], core="compact", multipliers=0),
}
EACH = pytest.mark.parametrize("design", few_of(FORMS, []))


@EACH
def test_the_files_of_model_and_verilator_are_equal(design, tmp_path):
    """With and without stalls, full-scale counts among the samples."""
    check_files(design, tmp_path, ["verilator"], samples=5 * design.samples_per_major)


@EACH
def test_verilator_shows_on_every_clock_what_the_cycle_model_says(design):
    clocks = max(12_000, 5 * clocks_of_major(design))
    check_trace(design, "verilator", clocks, seeds=range(2))
