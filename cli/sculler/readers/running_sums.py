"""Running sums instead of increments, as counters send them: differences, and the wraps undone."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sculler.formats.log import COUNTS
from sculler.readers.recording import Samples
from sculler_model.errors import InputError

Array = NDArray[np.float64]

WIDTHS = range(8, 49)
"""Bits of counters whose sums are undone: beyond, a float has not all digits."""

_SMALL = 8  # a step is a wrap if the step without it is less than this part of the range


class Differences:
    """Increments from running sums, streaming.

    The first sample is only where the sums begin, so it gives no increment.  Sums that are whole
    numbers may wrap at 2**bits, signed or not.

    Args:
        path: for messages.
        columns: which of the six hold running sums, as numbers from 0.
        bits: width at which they wrap; None to find it: a step of more than half a range whose
            rest is less than an eighth of it.

    Attributes:
        wraps: how often each of the six wrapped.
        found: the width found or given, by column; 0 where none wrapped.
    """

    def __init__(self, path: Path, columns: Sequence[int], bits: int | None = None) -> None:
        self._path, self._columns = path, list(columns)
        self.wraps = np.zeros(len(COUNTS), np.int64)
        self.found = [0] * len(COUNTS)
        if bits is not None:
            for column in self._columns:
                self.found[column] = bits
        self._given = bits is not None
        self._last: Array | None = None
        self._samples = 0

    def __call__(self, chunks: Iterator[Samples]) -> Iterator[Samples]:
        """The samples but the first, with increments for sums.

        Raises:
            InputError: sums that are to wrap are no whole numbers, or do not fit the width.
        """
        for chunk in chunks:
            if not len(chunk.values):
                continue
            values = chunk.values.astype(np.float64)
            before = values[:1] if self._last is None else self._last
            joined = np.concatenate([before, values])
            steps = values.copy()
            for column in self._columns:
                steps[:, column] = self._steps(column, joined[:, column])
            first = 1 if self._last is None else 0
            self._last = values[-1:]
            self._samples += len(values)
            if len(steps) > first:
                yield Samples(
                    steps[first:],
                    None if chunk.faults is None else chunk.faults[first:],
                    None if chunk.times is None else chunk.times[first:],
                )

    def _steps(self, column: int, sums: Array) -> Array:
        steps = np.diff(sums)
        if self._given:
            self._require_fit(column, sums[1:])
            return self._undone(column, steps, self.found[column])
        suspects = np.abs(steps) > 2 ** (WIDTHS[0] - 1)
        if not suspects.any() or (sums != np.rint(sums)).any():
            return steps
        bits = self.found[column] or _width(steps[suspects], sums)
        if not bits:
            return steps
        self.found[column] = bits
        return self._undone(column, steps, bits)

    def _undone(self, column: int, steps: Array, bits: int) -> Array:
        full = 2.0**bits
        turns = np.rint(steps / full)
        self.wraps[column] += np.count_nonzero(turns)
        undone: Array = steps - turns * full
        return undone

    def _require_fit(self, column: int, sums: Array) -> None:
        bits = self.found[column]
        full = 2.0**bits
        good = (sums == np.rint(sums)) & (sums >= -full / 2) & (sums < full)
        if not good.all():
            row = int(np.argmin(good))
            raise InputError(
                f"{self._path}: sample {self._samples + row}: {COUNTS[column]} = {sums[row]:.15g}"
                f" is no count of {bits} bits, give another --cumulative-bits"
            )

    def told(self) -> str:
        """What was done, in words."""
        names = {COUNTS[column].split("_")[0] for column in self._columns}
        what = "all six" if len(names) == 2 else f"the {names.pop()}'s"
        wraps = [
            f"{name} at {bits} bits {times:,} times"
            for name, bits, times in zip(COUNTS, self.found, self.wraps.tolist(), strict=True)
            if times
        ]
        wrapped = f"; wraps undone: {', '.join(wraps)}" if wraps else "; none wrapped"
        return f"{what} columns, increments are their differences (from sample 1 on){wrapped}"


def _width(steps: Array, sums: Array) -> int:
    """Bits of the counter that makes such steps; 0 if none does."""
    for step in np.unique(np.abs(steps))[::-1].tolist():
        bits = int(np.ceil(np.log2(step)))  # the rest is small, of either sign
        for width in (bits - 1, bits, bits + 1):
            full = 2.0**width
            signed = sums.min() >= -full / 2 and sums.max() < full / 2
            unsigned = sums.min() >= 0 and sums.max() < full
            if width in WIDTHS and abs(step - full) < full / _SMALL and (signed or unsigned):
                return width
    return 0


class SumsSuspicion:
    """Whether numbers look like running sums, though they are taken as increments.

    Two signs: the accelerometer's differences are as large as gravity makes them while the numbers
    themselves are not; or whole numbers step back by the width of a counter.

    Args:
        gravity: size of an increment of 9.8 m/s², in SI.
    """

    def __init__(self, gravity: float) -> None:
        self._gravity = gravity
        self._last: Array | None = None
        self._steps = self._like_gravity = self._large = 0
        self._wrapped: tuple[int, int] | None = None  # column and bits

    def __call__(self, values: Array, si: Array) -> None:
        """Look at the next samples.

        Args:
            values: (N, 6) as the file has them.
            si: (N, 3) the accelerometer's, SI, as increments.
        """
        now = np.hstack([values, si])
        joined = now if self._last is None else np.concatenate([self._last, now])
        self._last = joined[-1:]
        if len(joined) < 2:
            return
        steps = np.diff(joined, axis=0)
        size = np.linalg.norm(steps[:, 6:], axis=1) / self._gravity
        self._steps += len(steps)
        self._like_gravity += int(((size > 0.8) & (size < 1.25)).sum())
        self._large += int((np.linalg.norm(joined[1:, 6:], axis=1) > 3 * self._gravity).sum())
        if self._wrapped is not None:
            return
        for column in range(6):
            step = np.abs(steps[:, column])
            few = step > max(2.0 ** (WIDTHS[0] - 1), _SMALL * float(np.median(step)))
            sums = joined[:, column]
            if few.any() and few.sum() < len(step) / 16 and (sums == np.rint(sums)).all():
                rest = np.abs(step[~few]).max(initial=0.0)
                bits = _width(step[few], sums)
                if bits and rest < 2.0**bits / _SMALL and rest > 0:
                    self._wrapped = column, bits
                    return

    def told(self) -> list[str]:
        """The warning, if there is one."""
        if self._steps >= 20 and self._wrapped is not None:
            column, bits = self._wrapped
            return [
                f"{COUNTS[column]} steps back by the range of a counter of {bits} bits: are these"
                " running sums? then give --cumulative"
            ]
        share = 0.8 * self._steps
        if self._steps >= 20 and self._like_gravity > share and self._large > share:
            return [
                "the accelerometer's numbers grow by gravity's 9.8 m/s² from sample to sample: are"
                " these running sums? then give --cumulative"
            ]
        return []
