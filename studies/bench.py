"""How fast everything is: `python -m studies.bench` (or `make bench`).

Each measurement runs once unmeasured, then several times, in turn with the others, so that a busy
moment of the machine does not fall on one of them alone; medians are reported.  All are of the
default design (the STIM300 preset) on random full-scale samples; simulations of the RTL tell the
clocks they run in a second too.  Then the navigator runs against `python-ins` (`bench_navigate`),
where that is installed.
"""

from __future__ import annotations

import os
import platform
import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import click
import numpy as np
from numpy.typing import NDArray
from rich.table import Table

from sculler import terminal
from sculler.formats.log import LogWriter, read_log
from sculler.main import run_command
from sculler_hdl import timing
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.fast import FastModel, VectorBlock
from sculler_model.golden import GoldenModel, clocks_per_major
from sculler_model.host import major_increments
from sculler_model.motion import demo_motion
from sculler_model.navigation import navigate
from sculler_model.samples import Quantiser
from sculler_sim.engine import EngineName, simulate
from studies import bench_navigate


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


@click.command(epilog=terminal.examples("python -m studies.bench --runs 9 --json"))
@click.option(
    "--runs", type=click.IntRange(min=5), default=5, show_default=True, help="Runs of each."
)
@terminal.json_option
def command(runs: int, as_json: bool) -> None:
    """Measure model, simulators, log reading and navigation, the latter beside python-ins."""
    design = Design.preset("stim300")
    with tempfile.TemporaryDirectory() as folder:
        all_tasks = tasks(design, Path(folder))
        seconds = measure(all_tasks, runs)
    rows = {}
    for task in all_tasks:
        speeds = [task.samples / s for s in seconds[task.name]]
        rows[task.name] = {
            "samples": task.samples,
            "samples_per_s": statistics.median(speeds),
            "majors_per_s": statistics.median(speeds) / design.samples_per_major,
            "slowest": min(speeds),
            "fastest": max(speeds),
            "clocks_per_s": statistics.median(speeds) / task.samples * task.clocks
            if task.clocks
            else None,
        }
    machine = f"{platform.machine()}, {os.cpu_count()} processors, Python"
    machine += f" {platform.python_version()}, numpy {np.__version__}"
    data = {"design": design.name, "runs": runs, "machine": machine, "speeds": rows}
    navigators = _compare_navigators(runs)
    terminal.report(
        {**data, "navigators": navigators}, as_json, _table(data), "", _navigators(navigators)
    )


def _compare_navigators(runs: int) -> dict[str, Any]:
    """`bench_navigate.compare`, or which package it misses."""
    try:
        return bench_navigate.compare(runs=runs)
    except InputError as missing:
        return {"missing": str(missing)}


def _table(data: dict[str, Any]) -> Table:
    table = Table(
        title=f"samples/s, design {data['design']}, medians of {data['runs']} runs",
        title_justify="left",
        caption=data["machine"],
        caption_justify="left",
    )
    table.add_column("")
    for column in ("samples/s", "slowest", "fastest", "results/s", "clocks/s", "samples a run"):
        table.add_column(column, justify="right")
    for name, row in data["speeds"].items():
        speeds = [row["samples_per_s"], row["slowest"], row["fastest"], row["majors_per_s"]]
        clocks = row["clocks_per_s"]
        table.add_row(
            name,
            *(terminal.three_digits(speed) for speed in speeds),
            terminal.three_digits(clocks) if clocks else "",
            f"{row['samples']:,}",
        )
    return table


def _navigators(data: dict[str, Any]) -> Table | str:
    """Of `_compare_navigators`."""
    if "missing" in data:
        return f"navigators not compared: {data['missing']}"
    table = Table(
        title=f"navigators, {data['seconds']:g} s of a {data['motion']},"
        f" {data['rate_hz']:g} increments a second",
        title_justify="left",
        caption=f"compiled, {data['speed_ratio']:.3g} times the updates of python-ins a second,"
        f" {1 / data['error_ratio']:.2g} of its horizontal error",
        caption_justify="left",
    )
    table.add_column("")
    for column in ("updates/s", "us an update", "horizontal error, m", "velocity error, m/s"):
        table.add_column(column, justify="right")
    for name, row in data["navigators"].items():
        keys = ("updates_per_s", "us_per_update", "horizontal_m", "velocity_m_per_s")
        table.add_row(
            name, *(terminal.three_digits(row[key]) if key in row else "" for key in keys)
        )
    return table


if __name__ == "__main__":
    sys.exit(run_command(command, sys.argv[1:], "python -m studies.bench"))
