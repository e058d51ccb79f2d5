"""What the stamps of a recording showed."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from sculler.readers.rollover import Rollover


@dataclass(frozen=True)
class Gap:
    """A lasting shift of the stamps: samples are missing.

    Attributes:
        sample: number of the first sample after it, in the file from 0 (or from --start on).
        time: of the last sample before it, s of the file's clock.
        seconds: from that sample to the next.
        missing: samples that are not there.
    """

    sample: int
    time: float
    seconds: float
    missing: int


@dataclass
class TimingReport:
    """What the stamps showed.

    Attributes:
        samples: samples of the file that were taken.
        start: first stamp, s of the file's clock.
        span: from there to the last stamp, s.
        longest_step, shortest_step: between samples with no gap between, s.
        unequal: steps that differ by more than 1 % from the interval, gaps left out.
        gap_count, missing: gaps, and samples missing in them, in all.
        gaps: the first of them.
        repeated: stamps that do not grow.
        twice: those of them whose values repeat the sample before, too.
        passed_over: stamps too far from their places, which were taken instead.
        first_passed_over: sample number of the first of them.
        too_many: samples more than the stamps have time for.
        rollovers: where the clock was full and began anew.
    """

    samples: int = 0
    start: float = 0.0
    span: float = 0.0
    longest_step: float = 0.0
    shortest_step: float = np.inf
    unequal: int = 0
    gap_count: int = 0
    missing: int = 0
    gaps: list[Gap] = field(default_factory=list)
    repeated: int = 0
    twice: int = 0
    passed_over: int = 0
    first_passed_over: int | None = None
    too_many: int = 0
    rollovers: list[Rollover] = field(default_factory=list)

    @property
    def rate(self) -> float | None:
        """Mean sample rate, Hz, samples missing in gaps counted; None where no time goes by."""
        if self.samples < 2 or self.span <= 0:
            return None
        return (self.samples - 1 + self.missing) / self.span
