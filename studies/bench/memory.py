"""Peak memory of every verb that goes through a log, on one as long as asked for.

    python -m studies.bench.memory --hours 24

Each verb is a process of its own; the figure is the largest resident set of it, and of any process
that it waited for (`wait4`).
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import click
import numpy as np
from rich.table import Table

from sculler import terminal
from sculler.main import run_command
from sculler_model.design import Design
from sculler_model.motion import MOTIONS, PLACE
from studies.bench import before

DESIGN, MOTION = "stim300", "spin-cone"
_BLOCK = 1 << 18


def peaks(folder: Path, hours: float, ending: str, told: Callable[[str], None]) -> dict[str, Any]:
    """Peak resident set (MB) and seconds of each verb.

    Args:
        folder: for the files.
        hours: of the motion, at the 2 kHz of the design.
        ending: of the files: csv, npz or parquet.
        told: gets a line as each verb is done.
    """
    log, counts, truth, vectors, again, states = (
        str(folder / f"{name}.{ending}")
        for name in ("log", "counts", "truth", "vectors", "rtl", "states")
    )
    foreign = str(folder / "foreign.parquet")
    motion = ["motion", MOTION, "--design", DESIGN, "--duration", f"{3600 * hours:g}"]
    damped = ["--height-damping", "100"]  # a free vertical channel ends in hours
    units = ["--gyro-unit", "rad", "--accel-unit", "m/s"]
    jobs = {
        "motion": [*motion, "-o", log, "--truth", truth],
        "model": ["model", DESIGN, log, "-o", vectors],
        "simulate": ["simulate", DESIGN, log, "-o", again],
        "compare": ["compare", vectors, again],
        "navigate": ["navigate", DESIGN, vectors, "--truth", truth, "-o", states, *damped],
        "convert": ["convert", foreign, "--design", DESIGN, "-o", counts, *units],
    }
    rows: dict[str, Any] = {}
    for verb, words in jobs.items():
        if verb == "convert":
            # in a process of its own: a child's peak begins with what its parent has in memory
            writer = get_context("spawn").Process(target=_write_foreign, args=(foreign, hours))
            writer.start()
            writer.join()
        started = time.perf_counter()
        megabytes = _peak(words)
        rows[verb] = {"peak_mb": megabytes, "seconds": time.perf_counter() - started}
        told(f"{verb}: {megabytes:.0f} MB, {rows[verb]['seconds']:.1f} s")
    return rows


def _peak(words: list[str]) -> float:
    """MB of the largest process of a verb.

    Raises:
        RuntimeError: the verb failed; with what it said.
    """
    with tempfile.TemporaryFile() as said:
        child = subprocess.Popen(
            [sys.executable, "-m", "sculler", *words],
            env=before.environment(before.REPOSITORY),
            stdout=said,
            stderr=said,
        )
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode:
            said.seek(0)
            raise RuntimeError(f"{' '.join(words)}: {said.read().decode()}")
    return usage.ru_maxrss / 1000


def _write_foreign(path: str, hours: float) -> None:
    """Increments of the motion in SI, as another program's Parquet."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    design = Design.preset(DESIGN)
    motion = MOTIONS[MOTION].make(*PLACE)
    count = round(3600 * hours * design.sensor.sample_rate_hz)
    names = [f"{sensor}_{axis}" for sensor in ("gyro", "accel") for axis in "xyz"]
    schema = pa.schema([(name, pa.float64()) for name in names])
    with pq.ParquetWriter(path, schema) as file:
        chunks = motion.chunks("increment", count, design.sample_interval, _BLOCK)
        for chunk in chunks:
            columns = [pa.array(np.ascontiguousarray(column)) for column in chunk.T]
            file.write_table(pa.Table.from_arrays(columns, schema=schema))


@click.command(epilog=terminal.examples("python -m studies.bench.memory --hours 24"))
@click.option("--hours", type=float, default=1.0, show_default=True, help="Of the log.")
@click.option(
    "--ending",
    type=click.Choice(["csv", "npz", "parquet"]),
    default="parquet",
    show_default=True,
    help="Of the files.",
)
@terminal.json_option
def command(hours: float, ending: str, as_json: bool) -> None:
    """Measure the peak memory of every verb that goes through a log.

    A day at 2 kHz takes half an hour and some 20 GB of disk for Parquet.
    """
    with tempfile.TemporaryDirectory() as folder:
        rows = peaks(Path(folder), hours, ending, lambda line: click.echo(line, err=True))
    table = Table(title=f"{hours:g} h at 2 kHz, {ending}", title_justify="left")
    table.add_column("")
    for column in ("peak, MB", "s"):
        table.add_column(column, justify="right")
    for verb, row in rows.items():
        table.add_row(verb, f"{row['peak_mb']:.0f}", f"{row['seconds']:.1f}")
    terminal.report({"hours": hours, "ending": ending, "verbs": rows}, as_json, table)


if __name__ == "__main__":
    sys.exit(run_command(command, sys.argv[1:], "python -m studies.bench.memory"))
