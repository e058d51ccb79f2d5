"""Files: logs and vectors as CSV and Parquet, against polars, pyarrow and a plain C program.

The log is an hour at 2 kHz of the motion `demo`, whose first 100 seconds repeat.
"""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from sculler.formats import compiled
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


def contests(folder: Path, samples: int = HOUR) -> list[Contest]:
    """Reading a log, and `model` from file to file.

    Args:
        folder: for the files.
        samples: of the log.

    Raises:
        InputError: the C program writes other bytes than `model`.
    """
    design = Design.preset(DESIGN)
    kinds = ["csv"] + ["parquet"] * (find_spec("pyarrow") is not None)
    logs = {kind: _log(folder / f"log.{kind}", design, samples) for kind in kinds}
    missing, plain = _plain(folder, logs["csv"])

    def read(kind: str) -> Run:
        return lambda: sum(len(chunk.counts) for chunk in read_log(logs[kind], design))

    def model(kind: str) -> Run:
        def run() -> object:
            return model_log(design, logs[kind], folder / f"ours.{kind}", "fast", _nothing)

        return run

    if plain is not None:
        model("csv")()
        plain()
        if (folder / "ours.csv").read_bytes() != (folder / "theirs.csv").read_bytes():
            raise InputError(f"{_PLAIN}: writes other bytes than sculler model")
    held = [
        Contest(f"reading a log, CSV, all checks; {told}", name, samples, "samples", read("csv"),
                _reader(name, logs["csv"]), 0.7, _absent(name))
        for name, told in (("polars", "polars reads the numbers"), ("pyarrow", "pyarrow does"))
    ]  # fmt: skip
    held += [
        Contest(
            f"model, {kind} to {kind}",
            "plain C, CSV to CSV",
            samples,
            "samples",
            model(kind),
            plain,
            goal,
            missing,
        )
        for kind, goal in (("csv", 0.4), ("parquet", 1.0))
        if kind in kinds
    ]
    return held


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
    if compiled.kernels(compiled.WORTH_COMPILING) is None:
        return "numba is missing, so ours is not compiled"
    return None if find_spec(name) is not None else f"{name} is missing"


def _reader(name: str, path: Path) -> Callable[[], object] | None:
    """How another package reads a CSV."""
    if find_spec(name) is None:
        return None
    if name == "polars":
        import polars

        return lambda: polars.read_csv(path)
    from pyarrow import csv

    return lambda: csv.read_csv(path)
