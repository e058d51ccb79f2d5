"""Stamps against even steps: what is jitter, and what is a lasting shift.

The stamp of sample i, in sample intervals and less i, is the same for all samples of a perfect log.
Jitter moves it to and fro: a host that reads a sample late, or reads several at once.  A lost
sample moves it by one for good, as does a sample written twice (back) or a clock that is set.  So
where it moves, the samples around are looked at: it is a *shift* if the lowest, the middle and the
highest value of the `WINDOW` samples from there on all lie on the same side of those of the
`WINDOW` samples before, by more than half an interval.  What evens out within the window is jitter.

A stamp that repeats the one before it, or follows it within a quarter of an interval, says nothing:
clocks that count whole milliseconds or seconds, and hosts that stamp a batch of samples at once,
give such runs.  Only the first of a run counts.
"""

from __future__ import annotations

from bisect import bisect_left, insort
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

WINDOW = 64
"""Samples on either side by which a step is judged."""

HELD = 1 << 16
"""Samples held back at most until a step can be judged."""

_SILENT = 0.25  # intervals: a stamp this soon after the one before says nothing
_SUSPECT = 0.25  # intervals: what moves less is not looked at
_LASTING = 0.5  # intervals
_FEW = 16  # samples on a side: then jitter alone may look like a shift
_PASSES = 4.0  # times the median change from stamp to stamp
_AT_ONCE = 1 << 12  # windows compared at a time
_TOLERANCE = 0.01  # of the rate: clocks are better than this, wrong rates are worse


@dataclass(frozen=True)
class Shift:
    """A lasting shift.

    Attributes:
        sample: number of the first sample after it, from 0 (of a run of equal stamps, the first).
        time: stamp of the last sample before it, s.
        seconds: from that stamp to the next; not positive where time stands or goes back.
        missing: samples that are not there; negative where there are too many for the time.
    """

    sample: int
    time: float
    seconds: float
    missing: int


class ShiftFinder:
    """Finds the lasting shifts in a stream of stamps.

    Args:
        interval: between samples, s.

    Attributes:
        decided: samples up to which all shifts have been told.
    """

    def __init__(self, interval: float) -> None:
        self._T = interval
        self._samples = 0  # seen
        self._last: float | None = None  # stamp of the last of them
        # stamps that say something, their sample numbers, and the stamps just before them
        self._times: Array = np.empty(0)
        self._numbers = np.empty(0, np.int64)
        self._before: Array = np.empty(0)
        self._judged = 0  # of these stamps
        self._known: list[int] = []  # those of them that begin a shift
        self.decided = 0

    def __call__(self, times: Array, last: bool = False) -> list[Shift]:
        """The shifts that can now be told, all before sample `decided`.

        Args:
            times: (N,) stamps of the next samples, s.
            last: no more are to come.
        """
        self._take(times)
        count = len(self._times)
        # a shift may seem to lie some samples before its place, until that one is judged too
        upto = max(count if last else count - 2 * WINDOW, self._judged)
        if not last and self._samples - self._number(upto) > HELD:
            upto = count
        found = self._found(count if upto == count else count - WINDOW)
        shifts = [self._shift(at, move) for at, move in found if at < upto]
        self.decided = self._samples if upto == count else self._number(upto)
        drop = max(upto - WINDOW, 0)
        self._times, self._numbers = self._times[drop:], self._numbers[drop:]
        self._before, self._judged = self._before[drop:], upto - drop
        known = [*self._known, *(at for at, _ in found if at < upto)]
        self._known = [at - drop for at in known if at > drop]
        return shifts

    def _number(self, at: int) -> int:
        return int(self._numbers[at]) if at < len(self._numbers) else self._samples

    def _take(self, times: Array) -> None:
        """Keep those of the next stamps that say something."""
        if not len(times):
            return
        before = np.concatenate([[-np.inf if self._last is None else self._last], times[:-1]])
        step = times - before
        keep = (step > _SILENT * self._T) | (step < 0)
        numbers = self._samples + np.flatnonzero(keep)
        if self._samples <= 1 < self._samples + len(times) and not keep[1 - self._samples]:
            # the run that the log begins with began before it, nobody knows when
            self._times, self._numbers, self._before = (
                self._times[:0], self._numbers[:0], self._before[:0]
            )  # fmt: skip
            keep[:1], numbers = False, numbers[numbers > 0]
        self._times = np.concatenate([self._times, times[keep]])
        self._numbers = np.concatenate([self._numbers, numbers])
        self._before = np.concatenate([self._before, before[keep]])
        self._samples += len(times)
        self._last = float(times[-1])

    def _found(self, end: int) -> list[tuple[int, float]]:
        """Which of the kept stamps up to `end` begin a shift, and by how much; those judged out."""
        begin = max(self._judged, 1)
        if end <= begin:
            return []
        stray = (self._times - self._times[0]) / self._T - (self._numbers - self._numbers[0])
        at = np.arange(begin, end)
        at = at[np.abs(stray[at] - stray[at - 1]) > _SUSPECT]
        moves = _moves(stray, at)
        at, moves = at[np.abs(moves) > _LASTING], moves[np.abs(moves) > _LASTING]
        if len(at) > 2 and 2 * len(at) > end - begin:  # of another rate: every step is one
            return [*zip(at.tolist(), moves.tolist(), strict=True)]
        # the clearest first; what lies beyond a shift is no measure for its neighbours
        edges = sorted(self._known)
        step = np.abs(stray[at] - stray[at - 1])
        for row in np.lexsort((-step, -np.abs(moves).round(3))).tolist():
            i, move = int(at[row]), float(moves[row])
            first, stop = _reach(edges, i, len(stray))
            if first > i - WINDOW or stop < i + WINDOW:
                move = _short_move(stray[first:i], stray[i:stop])
            if abs(move) > _LASTING:
                insort(edges, i)
        found = []
        for i in edges[len(self._known) :]:
            first, stop = _reach(edges, i, len(stray))
            move = float(_move(stray[None, first:i], stray[None, i:stop])[0])
            if abs(move) > _LASTING:
                found.append((i, move))
        return found

    def _shift(self, at: int, move: float) -> Shift:
        """The shift that begins at a kept stamp."""
        number, last = int(self._numbers[at]), int(self._numbers[at - 1])
        missing = round(move)
        if missing < 0 and number > last + 1:  # the stamps between repeat
            return Shift(last + 1, float(self._times[at - 1]), 0.0, missing)
        before = float(self._before[at])
        return Shift(number, before, float(self._times[at]) - before, missing)


def _reach(edges: list[int], i: int, count: int) -> tuple[int, int]:
    """From where and up to where stamps are a measure for number i of `count`."""
    place = bisect_left(edges, i)
    after = edges[place : place + 2]
    first = max([i - WINDOW, 0, *edges[max(place - 1, 0) : place]])
    return first, min([i + WINDOW, count, *(edge for edge in after if edge > i)])


def _moves(stray: Array, at: NDArray[np.int64]) -> Array:
    """By how much `stray` moves for good at each of the places `at`; 0 where it comes back."""
    found = np.empty(len(at))
    whole = (at >= WINDOW) & (at + WINDOW <= len(stray))
    for row in np.flatnonzero(~whole).tolist():
        i = int(at[row])
        found[row] = _move(stray[None, max(i - WINDOW, 0) : i], stray[None, i : i + WINDOW])[0]
    rows = np.flatnonzero(whole)
    for first in range(0, len(rows), _AT_ONCE):
        some = rows[first : first + _AT_ONCE]
        after = at[some, None] + np.arange(WINDOW)
        found[some] = _move(stray[after - WINDOW], stray[after])
    return found


def _move(before: Array, after: Array) -> Array:
    """(N,) the smallest of the moves of lowest, middle and highest; 0 where they disagree."""
    moves = np.stack(
        [
            measure(after, axis=1) - measure(before, axis=1)
            for measure in (np.min, np.median, np.max)
        ]
    )
    low, high = moves.min(axis=0), moves.max(axis=0)
    smallest: Array = np.where(low > 0, low, np.where(high < 0, high, 0.0))
    return smallest


def _short_move(before: Array, after: Array) -> float:
    """The same for one place; where few samples stand on a side it must pass the jitter."""
    move = float(_move(before[None], after[None])[0])
    if min(len(before), len(after)) >= _FEW:
        return move
    steps = np.abs(np.concatenate([np.diff(before), np.diff(after)]))
    jitter = float(np.median(steps)) if len(steps) else 0.0
    return 0.0 if abs(move) <= _PASSES * jitter else move


def wrong_rate(times: Array, shifts: list[Shift], interval: float) -> float | None:
    """The sample rate (Hz) that stamps show, if it cannot be that of the interval; else None.

    The rate is (N-1)/span, samples missing in shifts counted.  It may be off by 1 %, and by what
    jitter does to the first and the last stamp.  Where stamps keep shifting it is another rate.

    Args:
        times: (N,) stamps of the first samples, s.
        shifts: those among them.
        interval: between samples, s.
    """
    count = len(times) - 1
    span = float(times[-1] - times[0]) if count > 0 else 0.0
    if span <= 0:
        return None  # stamps of too few digits; they say nothing
    if len(shifts) > count // 2:
        return count / span
    plain = np.delete(np.diff(times), [shift.sample - 1 for shift in shifts])
    # both ends are as unsure as the longest step that is jitter
    unsure = max(float(plain.max(initial=0.0)), 0.5 * interval)
    intervals = count + sum(shift.missing for shift in shifts)
    if abs(span - intervals * interval) <= _TOLERANCE * intervals * interval + unsure:
        return None
    return intervals / span
