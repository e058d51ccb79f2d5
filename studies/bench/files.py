"""Files: logs and vectors as CSV and Parquet, against polars, pyarrow and a plain C program.

The log is an hour at 2 kHz of the motion `demo`, whose first 100 seconds repeat.
"""

from __future__ import annotations

import subprocess
from functools import partial
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from sculler.formats import compiled
from sculler.formats.history import HistoryWriter, rows
from sculler.formats.log import LogWriter, read_log
from sculler.runs.counts import model_log
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.motion import demo_motion
from sculler_model.samples import Quantiser
from studies.bench.contest import Contest, Run
from studies.bench.contest import compiled as compiled_c

DESIGN = "stim300"
HOUR = 7_200_000
"""Samples of an hour at 2 kHz."""

_PLAIN = Path(__file__).parent / "plain" / "csv_vectors.c"
_REPEATED = 200_000
_STATES = 10_000  # written together


def contests(folder: Path, samples: int = HOUR) -> list[Contest]:
    """Reading a log, `model` from file to file, and writing states.

    Args:
        folder: for the files.
        samples: of the log.

    Raises:
        InputError: the C program writes other bytes than `model`.
    """
    design = Design.preset(DESIGN)
    kinds = ["csv"] + ["parquet"] * (find_spec("pyarrow") is not None)
    logs = {kind: _log(folder / f"log.{kind}", design, samples) for kind in kinds}
    held = []
    for package, kind, goal in (
        ("polars", "csv", 0.7),
        ("pyarrow", "csv", 0.7),
        ("pyarrow", "parquet", None),
    ):
        if kind in kinds:
            name = f"reading a log and checking it, {kind}"
            theirs = _reader(package, kind, logs[kind])
            ours = _reading(logs[kind], design)
            against = f"{package}, which reads the numbers"
            held.append(
                Contest(name, against, samples, "samples", ours, theirs, goal, _absent(package))
            )
    missing, plain = _plain(folder, logs["csv"])
    for kind, goal in (("csv", 0.4), ("parquet", 1.0)):
        if kind in kinds:
            name, ours = f"model, {kind} to {kind}", _modelling(logs[kind], design, folder)
            held.append(
                Contest(name, "plain C, CSV to CSV", samples, "samples", ours, plain, goal, missing)
            )
    if plain is not None:
        _modelling(logs["csv"], design, folder)()
        plain()
        if (folder / "ours.csv").read_bytes() != (folder / "theirs.csv").read_bytes():
            raise InputError(f"{_PLAIN}: writes other bytes than sculler model")
    return [*held, _states(folder, samples // design.samples_per_major)]


def _reading(log: Path, design: Design) -> Run:
    return lambda: sum(len(chunk.counts) for chunk in read_log(log, design))


def _modelling(log: Path, design: Design, folder: Path) -> Run:
    return lambda: model_log(design, log, folder / f"ours{log.suffix}", "fast", _nothing)


def _states(folder: Path, count: int) -> Contest:
    """Writing states as CSV, every float with the fewest digits that are read as it again."""
    states = demo_motion().state(np.arange(count) / 100)

    def ours() -> None:
        with HistoryWriter(folder / "states.csv") as writer:
            for first in range(0, count, _STATES):
                writer.write(rows(states, slice(first, first + _STATES)))

    theirs = None
    if find_spec("polars") is not None:
        import polars

        table = polars.read_csv(_written(folder, ours))
        theirs = partial(table.write_csv, folder / "theirs.csv")
    name = "writing states, csv"
    return Contest(name, "polars", count, "states", ours, theirs, None, _absent("polars"))


def _written(folder: Path, write: Run) -> Path:
    write()
    return folder / "states.csv"


def _nothing(_: int) -> None:
    """Nobody looks at the progress."""


def _log(path: Path, design: Design, samples: int) -> Path:
    motion, quantise = demo_motion(), Quantiser(design)
    chunks = motion.chunks(design.sensor.kind, min(samples, _REPEATED), design.sample_interval)
    counts = np.concatenate([quantise(chunk) for chunk in chunks])
    with LogWriter(path) as writer:
        for first in range(0, samples, len(counts)):
            writer.write(counts[: samples - first])
    return path


def _plain(folder: Path, log: Path) -> tuple[str | None, Run | None]:
    """Why the C program is missing, or what runs it."""
    program = folder / "csv_vectors"
    missing = compiled_c(str(_PLAIN), str(program))
    if missing is not None:
        return missing, None
    words = [str(program), str(log), str(folder / "theirs.csv")]
    return None, lambda: subprocess.run(words, check=True)


def _absent(name: str) -> str | None:
    if compiled.loaded() is None:
        return "numba is missing, so ours is not compiled"
    return None if find_spec(name) is not None else f"{name} is missing"


def _reader(package: str, kind: str, path: Path) -> Run | None:
    """How another package reads a log."""
    if find_spec(package) is None:
        return None
    if package == "polars":
        import polars

        return lambda: polars.read_csv(path)
    from pyarrow import csv, parquet

    return lambda: csv.read_csv(path) if kind == "csv" else parquet.read_table(path)
