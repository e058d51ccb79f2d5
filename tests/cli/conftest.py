"""What the command-line tests share: running a verb, and what a refusal must look like."""

from __future__ import annotations

import os
import sys
import threading
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

import numpy as np
import pytest

from sculler.main import main

ROOT = Path(__file__).parents[2]


class Outcome(NamedTuple):
    status: int
    out: str
    err: str


class _Watched(ModuleType):
    """`sys` while a verb runs, whose streams nobody may exchange: who does is told."""

    def __setattr__(self, name: str, value: object) -> None:
        if name in ("stdout", "stderr"):
            who = f"{name} becomes {value!r} in {threading.current_thread().name}:\n"
            _exchanged.append(who + "".join(traceback.format_stack(limit=12)))
        super().__setattr__(name, value)


_exchanged: list[str] = []


@contextmanager
def _streams_stay() -> Iterator[None]:
    """See that a verb's output goes where the test reads it, to its end."""
    before, of = (sys.stdout, sys.stderr), type(sys)
    assert not any(stream.closed for stream in before), before
    _exchanged.clear()
    sys.__class__ = _Watched  # type: ignore[assignment]
    try:
        yield
    finally:
        sys.__class__ = of
    assert (sys.stdout, sys.stderr) == before, "\n".join(_exchanged)


@pytest.fixture
def run(capfd: pytest.CaptureFixture[str]) -> Callable[..., Outcome]:
    """Run a verb in this process."""

    def run(*words: object) -> Outcome:
        capfd.readouterr()
        with _streams_stay():
            status = main([str(word) for word in words])
        return Outcome(status, *capfd.readouterr())

    return run


def _files(folder: Path) -> set[Path]:
    return set(folder.rglob("*"))


@pytest.fixture
def refused(run: Callable[..., Outcome], tmp_path: Path) -> Callable[..., str]:
    """Run a verb that must refuse its input: status 2, one line on stderr, no file left behind."""

    def refused(*words: object) -> str:
        before = _files(tmp_path)
        outcome = run(*words)
        assert outcome.status == 2, outcome
        assert outcome.out == ""
        assert outcome.err.startswith("sculler: ")
        assert outcome.err.count("\n") == 1
        assert outcome.err.endswith("\n")
        assert "Traceback" not in outcome.err
        assert _files(tmp_path) == before
        return outcome.err.strip()

    return refused


@pytest.fixture
def data() -> Path:
    """The folder of real logs."""
    folder = Path(os.environ.get("SCULLER_DATA", ROOT / "../shared/data"))
    if not folder.is_dir():
        pytest.skip(f"no real logs in {folder}; set SCULLER_DATA")
    return folder


SMALL = """
name = "little"
[sensor]
kind = "increment"
sample_rate_hz = 1000.0
gyro = { bits = 16, lsb = 1e-6 }
accel = { bits = 12, lsb = 1e-4 }
[algorithm]
family = "frequency-taylor"
samples = 3
history = 1
minors = 2
"""

HEADER = "gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z"


@pytest.fixture
def design(tmp_path: Path) -> Path:
    """A small design: 16-bit gyro, 12-bit accelerometer, six samples a major interval."""
    path = tmp_path / "little.toml"
    path.write_text(SMALL)
    return path


@pytest.fixture
def counts() -> np.ndarray:
    """27 samples with both extremes: four major intervals and three samples over."""
    rng = np.random.default_rng(5)
    gyro = rng.integers(-(2**15), 2**15, (27, 3))
    accel = rng.integers(-(2**11), 2**11, (27, 3))
    gyro[4], gyro[5], accel[6], accel[7] = -(2**15), 2**15 - 1, -(2**11), 2**11 - 1
    return np.hstack([gyro, accel])


@pytest.fixture
def log(tmp_path: Path, counts: np.ndarray) -> Path:
    """`counts` as a log."""
    path = tmp_path / "log.csv"
    rows = [",".join(map(str, row)) for row in counts.tolist()]
    path.write_text("\n".join([HEADER, *rows]) + "\n")
    return path
