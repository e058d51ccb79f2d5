"""Cores of third and fourth order: the golden model's vectors, the cycle model's clocks."""

import shlex
import shutil

import pytest

from bench_files import bench_of, run_bench, shell
from higher_order_designs import HIGHER_ORDER
from rtl import check_files, check_trace, clocks_of_major, golden, in_chunks, write
from sculler.formats.comparison import compare
from sculler_model.design import Design
from sculler_sim.engine import simulate
from strategies import samples_of, with_hardware
from tiers import few_of

pytestmark = pytest.mark.usefixtures("verilator")

PIPELINED = [
    *((name, {}) for name in HIGHER_ORDER),
    ("third_order", {"target": "ecp5"}),
    ("three_alone", {"target": "ecp5"}),
    # three axes in turn
    ("fourth_order", {"target": "ecp5", "multipliers": 28}),
    ("two_samples", {"target": "ice40", "multipliers": 12}),
    ("third_order", {"handover": "stream"}),
    ("three_alone", {"handover": "stream", "overrun": "drop-result"}),
    ("two_samples", {"overrun": "drop-result"}),
    ("one_sample", {"reset": "async", "clock_enable": True}),
    ("dense", {"initial": False}),
]
COMPACT = [
    *((name, {}) for name in HIGHER_ORDER),
    ("one_sample", {"target": "ecp5"}),
    ("fourth_order", {"target": "ice40"}),
    ("two_samples", {"multipliers": 0}),
]
FORMS = {
    "-".join([name, core, *map(str, hardware.values())]): with_hardware(
        HIGHER_ORDER[name], core=core, **hardware
    )
    for core, forms in (("compact", COMPACT), ("pipelined", PIPELINED))
    for name, hardware in forms
}
EACH = pytest.mark.parametrize("design", few_of(FORMS, []))


# a late host makes the others drop results, which traces show
@pytest.mark.parametrize(
    "design", few_of({n: each for n, each in FORMS.items() if not each.drops_results}, [])
)
def test_the_files_of_model_and_verilator_are_equal(design, tmp_path):
    """With and without stalls, full-scale counts among the samples."""
    check_files(design, tmp_path, ["verilator"], samples=5 * design.samples_per_major)


@EACH
def test_verilator_shows_on_every_clock_what_the_cycle_model_says(design):
    clocks = max(12_000, 5 * clocks_of_major(design))
    check_trace(design, "verilator", clocks, seeds=range(2))


# a bench with an asynchronous reset has words of its own
@pytest.mark.parametrize(
    "design",
    few_of({n: each for n, each in FORMS.items() if not each.hardware.resets_at_once}, []),
)
def test_the_bench_passes_and_no_linter_has_a_word(design, tmp_path, verilator):
    """Icarus with all warnings runs the bench; Verilator's full lint reads it all."""
    if shutil.which("iverilog"):
        run_bench(design, tmp_path)
    else:
        bench_of(design, tmp_path)
    top = f"{design.name}_tb"
    lint = [*verilator.verilator, *"--lint-only --timing -Wall --top-module".split(), top]
    files = sorted(path.name for path in tmp_path.glob("*.v"))
    done = shell(shlex.join([*lint, *files]), tmp_path)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.deep
def test_a_million_samples_of_third_order(tmp_path):
    """The pipelined core through Verilator and the golden model, all integers equal."""
    design = with_hardware(Design.preset("stim300", order=3))
    counts, faults = samples_of(design, 1_000_000, seed=3)
    reference = write(tmp_path / "model.csv", [golden(design, counts, faults)], design.columns)
    run = simulate(design, in_chunks(counts, faults, 50_000), engine="verilator")
    found = write(tmp_path / "verilator.csv", run, design.columns)
    difference = compare(reference, found)
    assert difference is None, difference.describe(reference, found)
    assert (run.progress.samples, run.progress.results) == (1_000_000, 50_000)
