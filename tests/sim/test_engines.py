"""The engines: traces, resets, long runs, bounded memory.

Every design on every core and target: test_pipelined_rtl, test_compact_rtl, test_targets_*.
"""

import pytest

from rtl import golden, in_chunks, samples_of, write
from sculler.formats.comparison import compare
from sculler_hdl import timing
from sculler_model.fast import FastModel, VectorBlock, run_fast
from sculler_sim.engine import simulate, trace
from sculler_sim.stimulus import Stimulus
from strategies import DESIGNS, with_hardware
from tiers import few_of

pytestmark = pytest.mark.usefixtures("verilator")


def test_a_trace_tells_the_first_difference():
    design = DESIGNS["smallest"]
    counts, faults = samples_of(design, 50, 1)
    one = trace(design, counts, faults, Stimulus.always(), 500, "model")
    other_counts = counts.copy()
    other_counts[17, 2] ^= 1  # alpha_z of result 17
    other = trace(design, other_counts, faults, Stimulus.always(), 500, "verilator")
    clock, port, ours, theirs = one.first_difference(other)
    assert port == "result_alpha_z"
    assert one.result[clock, 0] == 17
    assert one.result[clock, 4] == ours == counts[17, 2]
    assert other.result[clock, 4] == theirs == other_counts[17, 2]


@pytest.mark.parametrize("engine", ["verilator", "amaranth"])
@pytest.mark.parametrize(
    "name",
    few_of(
        ["stim300_4x5", "savage_1p1", "dense_uncompressed_4", "rate_2p0"],
        ["stim300_4x5", "rate_2p0"],
    ),
)
def test_reset_in_mid_interval_starts_from_nothing(name, engine, tmp_path):
    """Against the reference model alone: the clocks tell which samples the reset cuts off."""
    design = DESIGNS[name]
    interval, latency = design.samples_per_major, timing(design).latency
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


@pytest.mark.parametrize("samples", few_of([200_000, 1_000_000], [200_000]))
def test_many_samples_on_the_default_design(samples, tmp_path):
    design = DESIGNS["stim300_4x5"]
    counts, faults = samples_of(design, samples, seed=1)
    model = FastModel(design)
    chunks = in_chunks(counts, faults, 1 << 16)
    reference = write(tmp_path / "model.csv", (model.feed(*chunk) for chunk in chunks))
    run = simulate(design, chunks)
    assert compare(reference, write(tmp_path / "rtl.csv", run)) is None
    assert run.progress.results == samples // 20
    # one sample a clock, and after the last one the latency and the clock that takes its result
    assert run.progress.clocks == samples + timing(design).latency


@pytest.mark.parametrize("handover", few_of(["parallel", "stream"], ["parallel"]))
def test_the_number_of_a_result_goes_on_past_16_bits(handover):
    """The core counts results 16 bits at a time."""
    design = with_hardware(DESIGNS["smallest"], handover=handover)
    counts, faults = samples_of(design, 65_540 * design.samples_per_major, seed=2)
    run = simulate(design, in_chunks(counts, faults, 1 << 16))
    found = VectorBlock.concatenate(list(run))
    assert list(found.rows()) == list(run_fast(design, counts, faults).rows())
    assert found.major[-1] == 65_539


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


@pytest.mark.parametrize("chunks_read", few_of([20, 100], [20]))
def test_memory_stays_bounded_by_the_chunk(chunks_read):
    """Blocks come while samples are still being read."""
    design = DESIGNS["smallest"]
    read = 0

    def chunks():
        nonlocal read
        for _ in range(chunks_read):
            read += 1
            yield samples_of(design, 5000, read)

    run = simulate(design, chunks())
    first = next(run)
    assert read <= 2
    assert len(first) <= 1 << 15
    assert len(first) + sum(map(len, run)) == 5000 * chunks_read
