"""Model, Verilator and Amaranth's simulator agree: results through files, ports clock by clock."""

import numpy as np
import pytest

from sculler_hdl.core import core_latency
from sculler_model.blocks import VectorBlock
from sculler_model.fast import FastModel
from sculler_model.golden import GoldenModel
from sculler_sim.compare import compare
from sculler_sim.engine import simulate, trace
from sculler_sim.stimulus import Stimulus
from sculler_sim.vectors_file import VectorsWriter
from strategies import DESIGNS, random_counts

pytestmark = pytest.mark.usefixtures("built")

EACH_DESIGN = pytest.mark.parametrize("design", DESIGNS.values(), ids=DESIGNS.keys())


def samples_of(design, samples, seed):
    rng = np.random.default_rng(seed)
    return random_counts(design, samples, rng), (rng.random(samples) < 0.01).astype(int)


def golden(design, counts, faults):
    """The reference model's results."""
    rows = zip(counts.tolist(), faults.tolist(), strict=True)
    samples = [(tuple(row[:3]), tuple(row[3:]), fault) for row, fault in rows]
    return VectorBlock.from_results(list(GoldenModel(design).run(samples)))


def in_chunks(counts, faults, size):
    return [(counts[i : i + size], faults[i : i + size]) for i in range(0, len(counts), size)]


def write(path, blocks):
    with VectorsWriter(path) as writer:
        for block in blocks:
            writer.write(block)
    return path


@EACH_DESIGN
def test_the_files_of_model_and_both_simulators_are_equal(design, tmp_path):
    """Every design, with and without stalls, full-scale counts among the samples."""
    intervals, over = max(4, 60 // design.samples_per_major), design.samples_per_major // 2
    counts, faults = samples_of(design, intervals * design.samples_per_major + over, seed=11)
    reference = write(tmp_path / "model.csv", [golden(design, counts, faults)])
    for stimulus in (Stimulus.always(), Stimulus.stalls(5, 2 * design.samples_per_major)):
        for engine in ("verilator", "amaranth"):
            run = simulate(design, in_chunks(counts, faults, 37), engine=engine, stimulus=stimulus)
            path = write(tmp_path / f"{engine}.csv", run)
            difference = compare(reference, path)
            assert difference is None, difference.describe(reference, path)
            assert run.progress.results == intervals
            assert run.progress.samples == len(counts)
            assert run.leftover == over


@EACH_DESIGN
def test_verilator_shows_on_every_clock_what_the_cycle_model_says(design):
    clocks = 40 * design.samples_per_major + 600
    check_trace(design, "verilator", clocks, seeds=range(3))


@pytest.mark.parametrize(
    "name", ["stim300_4x5", "wide_5p0", "dense_odd_3", "rate_2p0", "smallest", "late_sum_2"]
)
def test_amaranth_shows_on_every_clock_what_the_cycle_model_says(name):
    check_trace(DESIGNS[name], "amaranth", 600, seeds=[3])


def check_trace(design, engine, clocks, seeds):
    """All ports on all clocks, under stalls that bite and resets in mid-interval."""
    interval = design.samples_per_major
    stopped = waited = 0
    for seed in seeds:
        stimulus = Stimulus.stalls(seed, 4 * interval)
        resets = np.random.default_rng(seed).integers(clocks, size=3)
        stimulus = stimulus.with_resets(*resets.tolist(), int(resets[0]) + 1)
        inputs = (*samples_of(design, clocks, seed), stimulus, clocks)
        model, shown = (trace(design, *inputs, each) for each in ("model", engine))
        assert len(shown) == clocks
        assert model.first_difference(shown) is None
        stopped += int((model.sample_ready == 0).sum())
        waited += int(model.result_valid.sum())
    assert waited > 10
    if engine == "verilator":
        assert stopped > 10


def test_a_trace_tells_the_first_difference():
    design = DESIGNS["smallest"]
    counts, faults = samples_of(design, 50, 1)
    one = trace(design, counts, faults, Stimulus.always(), 500, "model")
    other_counts = counts.copy()
    other_counts[20, 0] ^= 1  # alpha_x of result 20
    other = trace(design, other_counts, faults, Stimulus.always(), 500, "verilator")
    clock, port, ours, theirs = one.first_difference(other)
    assert port == "result_alpha_x"
    assert one.result[clock, 0] == 20
    assert one.result[clock, 2] == ours == counts[20, 0]
    assert other.result[clock, 2] == theirs == other_counts[20, 0]


@pytest.mark.parametrize("engine", ["verilator", "amaranth"])
@pytest.mark.parametrize("name", ["stim300_4x5", "savage_1p1", "dense_uncompressed_4", "rate_2p0"])
def test_reset_in_mid_interval_starts_from_nothing(name, engine, tmp_path):
    """Against the reference model alone: the clocks tell which samples the reset cuts off."""
    design = DESIGNS[name]
    interval, latency = design.samples_per_major, core_latency(design)
    # without stalls sample t is taken in clock t, and interval i's result in clock
    # (i + 1) * interval - 1 + latency: by this clock, that of interval 1
    reset = 2 * interval + latency + 1
    assert reset < 3 * interval - 1
    counts, faults = samples_of(design, 5 * interval, seed=2)
    before = golden(design, counts[:reset], faults[:reset])
    after = golden(design, counts[reset:], faults[reset:])
    assert len(before) == 2
    reference = write(tmp_path / "model.csv", [before, after])
    run = simulate(
        design,
        in_chunks(counts, faults, 50),
        engine=engine,
        stimulus=Stimulus.always().with_resets(reset),
    )
    assert compare(reference, write(tmp_path / "rtl.csv", run)) is None
    assert run.leftover == (5 * interval - reset) % interval


@EACH_DESIGN
def test_random_resets_and_stalls_give_the_cycle_models_results(design, tmp_path):
    counts, faults = samples_of(design, 20 * design.samples_per_major + 100, seed=8)
    stimulus = Stimulus.stalls(2, 64).with_resets(3, 40, 41, 77, 160, 161, 162, 391)
    paths = [
        write(
            tmp_path / f"{engine}.csv",
            simulate(design, [(counts, faults)], engine=engine, stimulus=stimulus),
        )
        for engine in ("model", "verilator")
    ]
    assert compare(*paths) is None


def test_a_million_samples_on_the_default_design(tmp_path):
    design = DESIGNS["stim300_4x5"]
    counts, faults = samples_of(design, 1_000_000, seed=1)
    model = FastModel(design)
    chunks = in_chunks(counts, faults, 1 << 16)
    reference = write(tmp_path / "model.csv", (model.feed(*chunk) for chunk in chunks))
    run = simulate(design, chunks)
    assert compare(reference, write(tmp_path / "rtl.csv", run)) is None
    assert run.progress.results == 50_000
    # one sample a clock, and after the last one the latency and the clock that takes its result
    assert run.progress.clocks == 1_000_000 + core_latency(design)


def test_long_runs_under_stalls_take_the_clocks_the_model_says():
    """Longer than the stimulus that is made at a time, with resets far apart."""
    design = DESIGNS["smallest"]
    counts, faults = samples_of(design, 8000, seed=4)
    stimulus = Stimulus.stalls(9, 50).with_resets(32_767, 32_768, 40_000)
    runs = {}
    for engine in ("model", "verilator"):
        run = simulate(design, in_chunks(counts, faults, 3001), engine=engine, stimulus=stimulus)
        runs[engine] = (VectorBlock.concatenate(list(run)), run.progress)
    assert runs["model"][1].clocks > 80_000
    assert runs["model"][1] == runs["verilator"][1]
    assert runs["model"][0].first_difference(runs["verilator"][0]) is None


def test_memory_stays_bounded_by_the_chunk():
    """Blocks come while samples are still being read."""
    design = DESIGNS["smallest"]
    read = 0

    def chunks():
        nonlocal read
        for _ in range(100):
            read += 1
            yield samples_of(design, 5000, read)

    run = simulate(design, chunks())
    first = next(run)
    assert read <= 2
    assert len(first) <= 1 << 15
    assert len(first) + sum(map(len, run)) == 500_000
