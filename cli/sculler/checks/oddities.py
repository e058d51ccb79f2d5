"""Intervals that no motion gives: spikes, zeros and repetitions that go on.

A real motion comes and goes over several intervals, and a real sensor's noise never stands still.
What is found is a warning, for a simulated or a very coarse sensor may do it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sculler.words import plural
from sculler_model.design import Design
from sculler_model.host import MajorIncrements

Array = NDArray[np.float64]

SPIKE = 1000.0
"""A lone interval this many times as large about an axis as its neighbours is a spike."""

NEIGHBOURS = 2
"""On either side."""

LONG = 5.0
"""Seconds of zeros or of one and the same increments that are told."""

FEWEST = 50
"""Intervals that they must be."""

SENSORS = ("gyros", "accelerometers")


class Oddities:
    """Looks at intervals as they come; `finish` says what was odd.

    Args:
        design: gives the LSBs: what is below a thousand of them is no spike.
    """

    def __init__(self, design: Design) -> None:
        self._lsb = np.repeat(design.count_scales, 3)
        self._long = max(FEWEST, round(LONG / design.major_interval))
        self._spikes = [_Spikes(), _Spikes()]
        self._repeats = [_Repeats(), _Repeats()]
        # of the last intervals: sizes, ends, how many at the beginning have been judged
        self._sizes, self._times, self._judged = np.zeros((0, 6)), np.zeros(0), 0
        self._last = np.full((1, 2, 3), np.nan)

    def see(self, increments: MajorIncrements) -> None:
        """Take the next intervals, which have times."""
        if not len(increments):
            return
        assert increments.times is not None
        rows = np.stack((increments.alpha, increments.dv_sf), axis=1)  # (R, 2, 3)
        same = (rows == np.concatenate([self._last, rows[:-1]])).all(axis=2)
        for k, repeats in enumerate(self._repeats):
            repeats.see(same[:, k], increments.times, rows[:, k])
        self._last = rows[-1:]
        self._sizes = np.concatenate([self._sizes, np.abs(rows).reshape(-1, 6)])
        self._times = np.concatenate([self._times, increments.times])
        self._judge(len(self._sizes) - NEIGHBOURS)

    def begin(self) -> None:
        """A break: what comes is no neighbour of what came."""
        self._judge(len(self._sizes))
        self._forget()

    def finish(self) -> list[str]:
        """What was odd, in words."""
        self.begin()
        found = []
        for name, spikes, repeats in zip(SENSORS, self._spikes, self._repeats, strict=True):
            if spikes.count:
                found.append(
                    f"{plural(spikes.count, 'interval')} where the {name} are"
                    f" {spikes.ratio:,.0f} times as large as before and after, the first one ends"
                    f" at {spikes.time:.15g} s: a spike in the log?"
                )
            if repeats.longest >= self._long:
                what = "give nothing but zeros" if repeats.zero else "repeat the same increments"
                found.append(
                    f"the {name} {what} over {repeats.longest:,} intervals, the first one ends at"
                    f" {repeats.time:.15g} s: a stuck sensor, or lost data that was filled in?"
                )
        return found

    def _forget(self) -> None:
        self._sizes, self._times, self._judged = np.zeros((0, 6)), np.zeros(0), 0
        self._last = np.full((1, 2, 3), np.nan)

    def _judge(self, ready: int) -> None:
        """Look for spikes among the intervals before `ready` that have not been looked at."""
        ready = max(ready, self._judged)
        count = len(self._sizes)
        padded = np.pad(self._sizes, ((NEIGHBOURS, NEIGHBOURS), (0, 0)))
        places = [place for place in range(2 * NEIGHBOURS + 1) if place != NEIGHBOURS]
        rest = padded[places[0] : places[0] + count].copy()
        for place in places[1:]:
            np.maximum(rest, padded[place : place + count], out=rest)
        by_axis = self._sizes / np.maximum(rest, self._lsb)
        ratios = by_axis.reshape(-1, 2, 3).max(axis=2)
        for k, spikes in enumerate(self._spikes):
            rows = np.flatnonzero(ratios[self._judged : ready, k] > SPIKE) + self._judged
            if len(rows) and not spikes.count:
                spikes.time, spikes.ratio = float(self._times[rows[0]]), float(ratios[rows[0], k])
            spikes.count += len(rows)
        keep = max(0, ready - NEIGHBOURS)
        self._sizes, self._times = self._sizes[keep:], self._times[keep:]
        self._judged = ready - keep


@dataclass
class _Spikes:
    """How many, when the first one was, and how many times as large as its neighbours."""

    count: int = 0
    time: float = 0.0
    ratio: float = 0.0


@dataclass
class _Repeats:
    """The longest run of equal intervals: how many, from when on, whether they are zero."""

    longest: int = 0
    time: float = 0.0
    zero: bool = False
    _count: int = 0  # of the run that goes on
    _since: float = 0.0

    def see(self, same: NDArray[np.bool_], times: Array, rows: Array) -> None:
        """Take intervals: whether each is as the one before, its end, and its vector."""
        starts = np.flatnonzero(~same)
        edges = np.concatenate([[-self._count], starts, [len(same)]])
        since = np.concatenate([[self._since], times[starts]])
        lengths = np.diff(edges)
        most = int(np.argmax(lengths))
        if lengths[most] > self.longest:
            first = max(int(edges[most]), 0)
            self.longest, self.time = int(lengths[most]), float(since[most])
            self.zero = not rows[first].any()
        self._count, self._since = int(lengths[-1]), float(since[-1])
