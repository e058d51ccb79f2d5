"""`overrun = "drop-result"`: samples never wait for results, and what is dropped is told.

Both cores in all their forms, against the cycle model on every clock and against the golden model.
"""

from __future__ import annotations

import shlex
from dataclasses import dataclass

import numpy as np
import pytest

from bench_files import bench_of, shell
from dropping_designs import DROPPING, FEW_DROPPING
from rtl import clocks_of_major, golden
from sculler.formats.vectors import VectorsWriter, read_vectors
from sculler_hdl import timing
from sculler_model.golden import words_per_result
from sculler_sim.engine import simulate, trace
from sculler_sim.stimulus import Levels, Stimulus
from strategies import samples_of
from tiers import few_of

pytestmark = pytest.mark.usefixtures("verilator")

# the benches have the others at every change
SMALL = ("smallest-pipelined", "dense_odd_3-compact-ice40", "smallest-compact")
EACH = pytest.mark.parametrize("design", few_of(DROPPING, [*SMALL, "smallest-serial"]))
EACH_OF_FEW = pytest.mark.parametrize("design", few_of(FEW_DROPPING, SMALL))


def clocks_of_result(design):
    """Clocks between results: as fast as they are made, and taken."""
    words = words_per_result(design) if design.hardware.handover == "stream" else 1
    clocks = timing(design)
    return max(clocks_of_major(design), (words - 1) * clocks.handover_spacing + clocks.latency)


@dataclass(frozen=True)
class Host(Stimulus):
    """Random offers, and a host that always takes what there is, or never does."""

    takes: int = 1

    def levels(self, start: int, clocks: int) -> Levels:
        return super().levels(start, clocks)._replace(take=np.full(clocks, self.takes, np.uint8))


@dataclass(frozen=True)
class AwayAtTimes(Stimulus):
    """A host that takes nothing for as many clocks as it then takes at random."""

    away: int = 1

    def levels(self, start: int, clocks: int) -> Levels:
        levels = super().levels(start, clocks)
        here = np.arange(start, start + clocks) // self.away % 2
        return levels._replace(take=levels.take & here.astype(np.uint8))


@EACH
def test_verilator_shows_on_every_clock_what_the_cycle_model_says(design):
    dropped = lost = 0
    each = clocks_of_result(design)
    clocks = 16 * each + 600
    for seed in (4, 5):
        stimulus = AwayAtTimes(seed, each, away=4 * each, gives_up=seed == 4)
        stimulus = stimulus.with_resets(clocks // 3, clocks // 3 + 1)
        samples = samples_of(design, clocks, seed)
        model, shown = (
            trace(design, *samples, stimulus, clocks, engine) for engine in ("model", "verilator")
        )
        assert model.first_difference(shown) is None
        lost += int(model.counters[:, 0].max())
        dropped += int(model.counters[:, 1].max())
        # what is shown stays until it is taken
        take, rst = stimulus.levels(0, clocks)[1:3]
        waits = (model.result_valid == 1) & (take == 0) & (rst == 0)
        assert (shown.result[1:][waits[:-1]] == shown.result[:-1][waits[:-1]]).all()
        assert shown.result_valid[1:][waits[:-1]].all()
    assert dropped > 0
    assert (lost > 0) == (timing(design).spacing > 1)


@pytest.mark.parametrize("name", ["smallest-pipelined", "smallest-streaming", "smallest-compact"])
def test_amaranth_shows_on_every_clock_what_the_cycle_model_says(name):
    design = DROPPING[name]
    samples = samples_of(design, 1500, 6)
    stimulus = Stimulus.stalls(6, 4 * clocks_of_result(design)).giving_up().with_resets(700)
    model, shown = (
        trace(design, *samples, stimulus, 1500, engine) for engine in ("model", "amaranth")
    )
    assert model.first_difference(shown) is None
    assert model.counters.max(axis=0).all()


@EACH_OF_FEW
def test_samples_do_not_wait_for_a_host_that_takes_nothing(design):
    """`sample_ready` is the same, whatever the host does; all results but two are dropped."""
    clocks = 30 * clocks_of_result(design)
    samples = samples_of(design, clocks, 1)
    ready, never = (
        trace(design, *samples, Host(3, 50, takes=takes), clocks, "verilator") for takes in (1, 0)
    )
    assert ready.sample_ready.tolist() == never.sample_ready.tolist()
    majors = never.counters[-1, 1] + 2
    assert majors * design.samples_per_major <= never.sample_ready.sum()
    assert never.counters[-1, 1] >= 6
    shown = never.result[never.result_valid == 1]
    assert len(shown) > 0
    assert (shown == shown[0]).all()  # the first, for ever


@EACH_OF_FEW
@pytest.mark.parametrize("engine", ["verilator", "model"])
def test_what_is_handed_over_is_the_golden_models_and_gaps_tell_the_rest(design, engine, tmp_path):
    span, intervals = design.samples_per_major, 60
    counts, faults = samples_of(design, intervals * span, 9)
    each = clocks_of_result(design)
    stimulus = AwayAtTimes(8, each, away=5 * each)
    run = simulate(design, [(counts, faults)], engine=engine, stimulus=stimulus)
    blocks = list(run)
    found = [row for block in blocks for row in block.rows()]
    majors = [row[0] for row in found]
    expected = list(golden(design, counts, faults).rows())
    assert found == [expected[major] for major in majors]
    assert majors == sorted(set(majors))
    assert majors[-1] == intervals - 1  # the newest is never dropped
    assert 4 < len(majors) < intervals
    # the file with its gaps is read by who knows of them
    with VectorsWriter(tmp_path / "gaps.csv", design.columns) as writer:
        for block in blocks:
            writer.write(block)
    read = [row for block in read_vectors(tmp_path / "gaps.csv", design) for row in block.rows()]
    assert read == found


@EACH_OF_FEW
def test_a_host_that_is_quick_enough_misses_nothing(design):
    """Samples at a pace at which every result can be handed over."""
    span = design.samples_per_major
    counts, faults = samples_of(design, 12 * span, 2)
    pause = -(-2 * clocks_of_result(design) // span)

    @dataclass(frozen=True)
    class Paced(Stimulus):
        def levels(self, start, clocks):
            offer = (np.arange(start, start + clocks) % pause == 0).astype(np.uint8)
            return super().levels(start, clocks)._replace(offer=offer)

    run = simulate(design, [(counts, faults)], stimulus=Paced())
    rows = [row for block in run for row in block.rows()]
    assert rows == list(golden(design, counts, faults).rows())


@pytest.mark.parametrize("name", ["smallest-pipelined", "smallest-streaming", "smallest-compact"])
def test_verilators_full_lint_has_nothing_to_say(verilator, name, tmp_path):
    design = DROPPING[name]
    bench_of(design, tmp_path)
    top = f"{design.name}_tb"
    lint = [*verilator.verilator, *"--lint-only --timing -Wall --top-module".split(), top]
    done = shell(shlex.join([*lint, f"{top}.v", f"{design.name}.v"]), tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
