"""What the tests of simulated cores share: samples, references, comparison of files and traces."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sculler.formats.comparison import compare
from sculler.formats.vectors import VectorsWriter
from sculler_hdl import timing
from sculler_model.design import COLUMNS, Design
from sculler_model.fast import VectorBlock
from sculler_model.golden import GoldenModel, clocks_per_major
from sculler_sim.engine import EngineName, simulate, trace
from sculler_sim.stimulus import Stimulus
from strategies import Counts, Samples, samples_of


def golden(design: Design, counts: Counts, faults: NDArray[Any]) -> VectorBlock:
    """The reference model's results."""
    rows = zip(counts.tolist(), faults.tolist(), strict=True)
    samples = [(tuple(row[:3]), tuple(row[3:]), fault) for row, fault in rows]
    return VectorBlock.from_results(list(GoldenModel(design).run(samples)))


def in_chunks(counts: Counts, faults: NDArray[Any], size: int) -> list[Samples]:
    """The samples cut into chunks."""
    return [(counts[i : i + size], faults[i : i + size]) for i in range(0, len(counts), size)]


def write(path: Path, blocks: Iterable[VectorBlock], columns: tuple[str, ...] = COLUMNS) -> Path:
    """A vectors file of all blocks."""
    with VectorsWriter(path, columns) as writer:
        for block in blocks:
            writer.write(block)
    return path


def clocks_of_major(design: Design) -> int:
    """Clocks of a major interval on the design's core, when nothing stalls."""
    return clocks_per_major(design, timing(design))


def check_files(design: Design, folder: Path, engines: Iterable[EngineName], samples: int) -> None:
    """The simulators' vectors files are the golden model's, with stalls and without."""
    per_major = design.samples_per_major
    intervals, over = max(4, samples // per_major), per_major // 2
    counts, faults = samples_of(design, intervals * per_major + over, seed=11)
    reference = write(folder / "model.csv", [golden(design, counts, faults)], design.columns)
    for stimulus in (Stimulus.always(), Stimulus.stalls(5, 2 * clocks_of_major(design))):
        for engine in engines:
            run = simulate(design, in_chunks(counts, faults, 37), engine=engine, stimulus=stimulus)
            path = write(folder / f"{engine}.csv", run, design.columns)
            difference = compare(reference, path)
            assert difference is None, difference.describe(reference, path)
            assert run.progress.results == intervals
            assert run.progress.samples == len(counts)
            assert run.leftover == over


def anywhere_in_four_majors(design: Design) -> Stimulus:
    """Stalls, and resets while samples load, while the engine computes and while words wait."""
    major = clocks_of_major(design)
    resets = np.random.default_rng(2).integers(0, 4 * major, 5).tolist()
    return Stimulus.stalls(2, major).with_resets(3, 40, 41, *resets)


def check_resets(design: Design, folder: Path, samples: int, stimulus: Stimulus) -> None:
    """Verilator's vectors file is the cycle model's, under resets and stalls."""
    chunks = [samples_of(design, samples, seed=8)]
    engines: tuple[EngineName, ...] = ("model", "verilator")
    model, verilator = (
        write(
            folder / f"{engine}.csv",
            simulate(design, chunks, engine=engine, stimulus=stimulus),
            design.columns,
        )
        for engine in engines
    )
    difference = compare(model, verilator)
    assert difference is None, difference.describe(model, verilator)
    assert len(model.read_text().splitlines()) > 1  # there are results


def check_trace(
    design: Design, engine: EngineName, clocks: int, seeds: Iterable[int], least: int = 10
) -> None:
    """All ports on all clocks, under stalls that bite, resets in mid-interval and lost samples.

    Args:
        design: the design.
        engine: the simulator whose trace is to equal the cycle model's.
        clocks: clocks of each run.
        seeds: one run each; at even ones the sensor gives samples up.
        least: clocks in which samples must have been stopped, and in which a result must have
            waited.
    """
    stopped = waited = lost = 0
    for seed in seeds:
        stimulus = Stimulus.stalls(seed, 4 * clocks_of_major(design))
        if seed % 2 == 0:
            stimulus = stimulus.giving_up()
        resets = np.random.default_rng(seed).integers(clocks, size=3)
        stimulus = stimulus.with_resets(*resets.tolist(), int(resets[0]) + 1)
        counts, faults = samples_of(design, clocks, seed)
        model, shown = (
            trace(design, counts, faults, stimulus, clocks, each) for each in ("model", engine)
        )
        assert len(shown) == clocks
        assert model.first_difference(shown) is None
        stopped += int((model.sample_ready == 0).sum())
        waited += int(model.result_valid.sum())
        lost += int(model.counters[:, 0].max())
    assert waited > least
    assert stopped > least
    assert lost > min(least, 0)
