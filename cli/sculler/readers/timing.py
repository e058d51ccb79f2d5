"""Whether the time column of a recording agrees with the design's sample rate."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sculler_model.design import Design
from sculler_model.errors import InputError

TIME_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}

_TOLERANCE = 0.01  # of the interval: clocks are better than this, wrong rates are worse
_GAP = 1.5  # intervals: beyond this a sample is missing


class TimeCheck:
    """Checks the times of consecutive samples, chunk by chunk.

    Args:
        path: for messages.
        design: its sample rate is what the times should show.
        unit: seconds of one unit of the column.
    """

    def __init__(self, path: Path, design: Design, unit: float) -> None:
        self._path, self._design, self._unit = path, design, unit
        self._last: float | None = None
        self._rows = 0
        self._gaps = 0
        self._longest = 0.0

    def __call__(self, times: NDArray[np.float64]) -> None:
        """Take the next times, (N,), in the column's unit.

        Raises:
            InputError: time does not grow, or the first chunk shows another sample rate.
        """
        seconds = times * self._unit
        before = [] if self._last is None else [self._last]
        intervals = np.diff(np.concatenate([before, seconds]))
        if (intervals <= 0).any():
            row = self._rows - len(before) + int(np.argmax(intervals <= 0)) + 1
            raise InputError(f"{self._path}: sample {row}: time does not grow, mend the log")
        T = self._design.sample_interval
        if self._last is None and len(intervals):
            usual = float(np.median(intervals))
            if abs(usual / T - 1) > _TOLERANCE:
                raise InputError(
                    f"{self._path}: the time column shows {1 / usual:.6g} Hz but"
                    f" sensor.sample_rate_hz = {1 / T:.6g}, change one of them (or --time-unit)"
                )
        if len(intervals):
            self._gaps += int((intervals > _GAP * T).sum())
            self._longest = max(self._longest, float(intervals.max()))
        self._last = float(seconds[-1])
        self._rows += len(times)

    def note(self) -> str:
        """What the times showed."""
        if not self._gaps:
            return "agrees with sensor.sample_rate_hz, no gaps"
        return (
            f"{self._gaps} gaps (longest {self._longest:.6g} s): the core knows no time, so the"
            " samples missing there are missing in the result"
        )
