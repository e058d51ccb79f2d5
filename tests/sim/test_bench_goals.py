"""The bench that is handed out reaches its goals, says so where it does not, and sees faults.

The faults are such as stimulus without the goals has missed: they show where a reset or a carry
comes at one certain time.
"""

import re

import pytest

from bench_files import LEAST, bench_of, run_bench, shell
from sculler_sim import bench_runs
from sculler_sim.prove.shapes import SHAPES
from strategies import DESIGNS, with_hardware
from tiers import few_of

pytestmark = pytest.mark.usefixtures("icarus")

WHOLE = few_of(SHAPES, ["one_minor", "compact_one", "dropping_stream"])
SMALLEST = DESIGNS["smallest"]
COMPACT = with_hardware(SMALLEST, core="compact")


@pytest.mark.parametrize("design", WHOLE)
def test_every_goal_is_reached(design, tmp_path):
    run_bench(design, tmp_path, LEAST)


def edited(folder, name, *changes):
    """A file with each pattern in the place of which another text stands."""
    path = folder / name
    text = path.read_text()
    for pattern, by in changes:
        text, count = re.subn(pattern, by, text, flags=re.M)
        assert count == 1, pattern
    path.write_text(text)


CUTS = {
    "a result that waits longer than the latency": (r"lfsr\[5\] && !stubbornly", "lfsr[5]"),
    "a reset at each stage of a result on its way": (
        r"^ +5: plan_of = \{(.*), 32'd3, 4'd(.), 4'd1\};",
        r"      5: plan_of = {\1, 32'd40, 4'd\2, 4'd1};",
    ),
    "samples and results back to back": (
        "willing && !holding;",
        "willing && !holding && result_valid;",
    ),
    "carries from limb to limb of a result's number": (
        "settings <= NUMBERS$",
        "settings <= NUMBERS && settings == 0",
    ),
}


DROPPING = SHAPES["dropping_stream"]
CUTS_DROPPING = {
    "each rail touched alone, by a result that the host took": (
        "localparam SHOWN = 16;",
        "localparam SHOWN = 0;",
    ),
    "the first result after a reset, taken whole each time": (
        r"waits = begins \? last_taken \|\| made != results$",
        "waits = begins ? 1'b0",
    ),
}


@pytest.fixture(scope="module")
def whole_benches(tmp_path_factory):
    found = {}
    for design in (SMALLEST, DROPPING):
        folder = tmp_path_factory.mktemp(design.name)
        command = bench_of(design, folder, LEAST)["icarus"]
        found[design.name] = (folder, command, (folder / f"{design.name}_tb.v").read_text())
    return found


@pytest.mark.parametrize(
    ("name", "goal", "cut"),
    [(SMALLEST.name, *each) for each in CUTS.items()]
    + [(DROPPING.name, *each) for each in CUTS_DROPPING.items()],
)
def test_it_fails_by_name_where_a_goal_is_not_reached(whole_benches, name, goal, cut):
    folder, command, text = whole_benches[name]
    (folder / f"{name}_tb.v").write_text(text)
    edited(folder, f"{name}_tb.v", cut)
    done = shell(command, folder)
    assert done.returncode != 0
    assert done.stdout.startswith("FAIL: goals not reached: "), done.stdout
    assert goal in done.stdout.split("\n")[0]


def test_it_fails_without_faulty_samples(tmp_path, monkeypatch):
    def faultless(design, runs, made=bench_runs.samples_of):
        parts = made(design, runs)
        for part in parts:
            part[:, 6] = 0
        return parts

    monkeypatch.setattr("sculler_sim.testbench.samples_of", faultless)
    done = shell(bench_of(SMALLEST, tmp_path, LEAST)["icarus"], tmp_path)
    assert done.stdout.startswith(
        "FAIL: goals not reached: an interval with a fault and one without\n"
    )
