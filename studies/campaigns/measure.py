"""`sculler campaign` started and timed: the clock, the processors, and its results."""

from __future__ import annotations

import hashlib
import resource
import shutil
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

from sculler_model.errors import InputError

RATE = 2000
"""Samples a second of the design."""

WARM = 4
"""Runs of a short campaign before the first that is timed: what is compiled once is then there."""


def campaign_text(runs: int, seconds: float) -> str:
    """A campaign: a flight with climbs and turns, a STIM300 with all errors of its data sheet."""
    return f"""runs = {runs}
seconds = {seconds:g}
checkpoints = 60
[motion]
name = "flight"
[initial]
tilt_mrad = 0.05
heading_mrad = 0.5
[navigator]
height_damping = 60.0
[[design]]
preset = "stim300"
errors = {{ preset = "stim300" }}
"""


@dataclass(frozen=True)
class Timed:
    """A campaign that was flown.

    Attributes:
        workers: processes.
        runs: how many.
        seconds: of each.
        clock: s from start to end.
        processor: s of all processes together.
        digest: of the results, bit for bit.
    """

    workers: int
    runs: int
    seconds: float
    clock: float
    processor: float
    digest: str

    @property
    def samples(self) -> float:
        """Of all runs."""
        return self.runs * self.seconds * RATE

    @property
    def a_sample(self) -> float:
        """Processor time, µs."""
        return 1e6 * self.processor / self.samples

    @property
    def a_minute(self) -> float:
        """Runs a minute of the clock."""
        return 60 * self.runs / self.clock

    @property
    def busy(self) -> float:
        """Share of the workers' time in which they had a processor."""
        return self.processor / (self.clock * self.workers)


def timed(build: Path, runs: int, seconds: float, workers: int) -> Timed:
    """Fly a campaign from nothing and time it.

    Args:
        build: a folder for it; what an earlier one left is removed.
        runs, seconds: of the campaign.
        workers: processes.

    Raises:
        InputError: the campaign fails.
    """
    build.mkdir(parents=True, exist_ok=True)
    file, folder = build / "campaign.toml", build / f"flown-{workers}"
    file.write_text(campaign_text(runs, seconds), encoding="utf-8")
    shutil.rmtree(folder, ignore_errors=True)
    words = [sys.executable, "-m", "sculler", "campaign", str(file), "-o", str(folder)]
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    done = subprocess.run(
        [*words, "--workers", str(workers), "--json"], capture_output=True, text=True, check=False
    )
    clock, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode:
        raise InputError(f"the campaign failed: {done.stderr.strip()}")
    processor = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    digest = hashlib.sha256((folder / "results.parquet").read_bytes()).hexdigest()
    return Timed(workers, runs, seconds, clock, processor, digest)
