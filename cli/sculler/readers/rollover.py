"""Stamps that go back because their counter is full, or the GPS week or the day is over."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sculler.readers.recording import TIME_UNITS

_WEEK, _DAY = 604800.0, 86400.0  # s
_SLACK = 1.0  # s: a gap may lie where time goes back, but no longer than this
_SHARE = 0.25  # of the width: nor than this


@dataclass(frozen=True)
class Rollover:
    """Where time went back by a known width.

    Attributes:
        sample: number of the first sample after it, in the file from 0.
        width: s.
        name: of what is full.
    """

    sample: int
    width: float
    name: str


class Unwrapper:
    """Makes time go on where it goes back by the width of something that is full.

    The widths are those of counters of 16 and 32 bits in the stamps' own unit, of the GPS week and
    of the day.  The step that is left must be forward, up to a second (and a quarter of the width).

    Args:
        unit: of the stamps.
        interval: between samples, s; what is full within four of them is no counter of time.

    Attributes:
        found: all such places.
    """

    def __init__(self, unit: str, interval: float) -> None:
        tick = TIME_UNITS[unit]
        widths = {
            f"a counter of 16 bits ({unit})": 2**16 * tick,
            f"a counter of 32 bits ({unit})": 2**32 * tick,
            "the GPS week": _WEEK,
            "the day": _DAY,
        }
        self._widths = {name: width for name, width in widths.items() if width > 4 * interval}
        self._offset = 0.0
        self._last: float | None = None  # stamp of the last sample, as the file has it
        self._samples = 0
        self.found: list[Rollover] = []

    def __call__(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """The next stamps (N,), s, going on."""
        if not len(times):
            return times
        before = np.concatenate([[times[0] if self._last is None else self._last], times[:-1]])
        steps = times - before
        offsets = np.full(len(times), self._offset)
        for at in np.flatnonzero(steps < 0).tolist():
            for name, width in self._widths.items():
                if 0 < steps[at] + width <= min(_SLACK, _SHARE * width):
                    offsets[at:] += width
                    self.found.append(Rollover(self._samples + at, width, name))
                    break
        self._offset, self._last = float(offsets[-1]), float(times[-1])
        self._samples += len(times)
        unwrapped: NDArray[np.float64] = times + offsets
        return unwrapped
