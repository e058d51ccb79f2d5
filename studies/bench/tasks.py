"""What is measured: models, simulators, log reading, navigation."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sculler import terminal
from sculler.formats.log import LogWriter, read_log
from sculler_hdl import timing
from sculler_model.design import Design
from sculler_model.fast import FastModel, VectorBlock
from sculler_model.golden import GoldenModel, clocks_per_major
from sculler_model.host import major_increments
from sculler_model.motion import demo_motion
from sculler_model.navigation import navigate
from sculler_model.samples import Quantiser
from sculler_sim.engine import EngineName, simulate


class Task(NamedTuple):
    """One measurement: what it is, the samples one run takes, and the run.

    `clocks` are those of one run, where it simulates hardware.
    """

    name: str
    samples: int
    run: Callable[[], object]
    clocks: int | None = None


def tasks(design: Design, folder: Path) -> list[Task]:
    """All measurements; a log for the reading goes into the folder."""
    rng = np.random.default_rng(1)
    words = design.words

    def random_counts(samples: int) -> NDArray[np.int64]:
        gyro = rng.integers(words.gyro.lo, words.gyro.hi + 1, (samples, 3))
        accel = rng.integers(words.accel.lo, words.accel.hi + 1, (samples, 3))
        return np.hstack([gyro, accel])

    few, some, many = (random_counts(samples) for samples in (2_000, 10_000, 2_000_000))
    compact = Design.parse({**design.as_json(), "hardware": {"core": "compact"}})
    log = folder / "log.csv"
    with LogWriter(log) as writer:
        writer.write(many[:400_000])
    plain = [((a, b, c), (d, e, f), 0) for a, b, c, d, e, f in some.tolist()]

    # navigation needs a vehicle that stays on the Earth
    seconds = 100
    count = round(seconds * design.sensor.sample_rate_hz)
    motion, quantise, model = demo_motion(), Quantiser(design), FastModel(design)
    block = VectorBlock.concatenate(
        [
            model.feed(quantise(chunk))
            for chunk in motion.chunks(design.sensor.kind, count, design.sample_interval)
        ]
    )
    start = motion.state(np.zeros(1)).state(0)

    def simulation(name: str, core: Design, engine: EngineName, counts: NDArray[np.int64]) -> Task:
        def run() -> object:
            return sum(map(len, simulate(core, [(counts, None)], engine=engine)))

        intervals = len(counts) // core.samples_per_major
        clocks = intervals * clocks_per_major(core, timing(core))
        return Task(name, len(counts), run, clocks)

    return [
        Task("golden model, reference", len(plain), lambda: list(GoldenModel(design).run(plain))),
        Task("golden model, fast twin", len(many), lambda: FastModel(design).feed(many)),
        simulation("pipelined core in Amaranth's simulator", design, "amaranth", few),
        simulation("pipelined core in Verilator", design, "verilator", many),
        simulation("compact core in Verilator", compact, "verilator", many[:20_000]),
        Task(
            "navigate (one update a major interval)",
            count,
            lambda: navigate(start, design.major_interval, major_increments(design, block)),
        ),
        Task("reading a log", 400_000, lambda: sum(len(c) for c, *_ in read_log(log, design))),
    ]


def measure(all_tasks: list[Task], runs: int) -> dict[str, list[float]]:
    """Seconds of each run of each task, the tasks taking turns."""
    seconds: dict[str, list[float]] = {task.name: [] for task in all_tasks}
    with terminal.progress("measuring", (runs + 1) * len(all_tasks)) as advance:
        for turn in range(runs + 1):
            for task in all_tasks:
                start = time.perf_counter()
                task.run()
                if turn:
                    seconds[task.name].append(time.perf_counter() - start)
                advance(1)
    return seconds
