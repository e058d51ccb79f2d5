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

WHOLE = few_of(SHAPES, ["one_minor", "compact_one"])
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


@pytest.fixture(scope="module")
def whole_bench(tmp_path_factory):
    folder = tmp_path_factory.mktemp("smallest")
    command = bench_of(SMALLEST, folder, LEAST)["icarus"]
    return folder, command, (folder / "smallest_tb.v").read_text()


@pytest.mark.parametrize("goal", CUTS)
def test_it_fails_by_name_where_a_goal_is_not_reached(whole_bench, goal):
    folder, command, text = whole_bench
    (folder / "smallest_tb.v").write_text(text)
    edited(folder, "smallest_tb.v", CUTS[goal])
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
