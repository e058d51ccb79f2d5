"""`FastModel`: the vectorised twin of `GoldenModel`, exact for every legal design.

It takes arrays of counts of any length, checks them, keeps what later results need, shares blocks
of whole major intervals out to threads and gives them their status; `arithmetic` computes a block.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from queue import SimpleQueue
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sculler_model.design import STATUS_FAULT, STATUS_RAIL, STATUS_SHORT_HISTORY, Design
from sculler_model.errors import InputError
from sculler_model.fast.arithmetic import BLOCK, FEW_MINORS, Arithmetic, Counts
from sculler_model.fast.blocks import VectorBlock
from sculler_model.fast.wide import Integers, from_limbs, limbs_of
from sculler_model.golden import check_widths

THREADS = min(os.cpu_count() or 1, 4)
"""Blocks computed at the same time."""

ROW = 256
"""Samples side by side where extremes are sought: numpy is quick along long rows."""


class FastModel:
    """Exact coning/sculling accumulators of one design, fed with arrays.

    Chunks of any length give the results that `GoldenModel` gives for the same samples.  Memory
    is bounded by the chunk, its results and one major interval.

    Args:
        design: the design.
        block: samples computed at a time; makes no difference to the results.
        few_minors: see `Arithmetic`; makes none either.

    Attributes:
        design: the design.
        samples: samples accepted since reset.
    """

    def __init__(self, design: Design, *, block: int = BLOCK, few_minors: int = FEW_MINORS) -> None:
        self.design = design
        self._arithmetics = [Arithmetic(design, block, few_minors) for _ in range(THREADS)]
        self._arithmetic = self._arithmetics[0]
        self.reset()

    def reset(self) -> None:
        """Forget everything: the next sample is the first, the next major interval is 0."""
        self.samples = 0
        # What later results still need: the history, then the incomplete major interval.
        self._kept: list[Counts] = [np.zeros((self._arithmetic.history, 6), np.int64)]
        self._faulty: NDArray[np.int64] = np.zeros(0, np.int64)  # samples that carried `fault`

    @property
    def leftover(self) -> int:
        """Samples in the incomplete major interval so far."""
        return self.samples % self.design.samples_per_major

    def feed(self, counts: ArrayLike, faults: ArrayLike | None = None) -> VectorBlock:
        """Take consecutive samples and return the major intervals they complete.

        Args:
            counts: (N, 6) integers: gyro x, y, z, accelerometer x, y, z.
            faults: (N,) integers or booleans, not 0 where the sample carried `fault`.

        Returns:
            Their results, in order; none if no major interval has ended.

        Raises:
            InputError: the arrays are not of this form, or a count does not fit the sensor's
                width.  Then nothing of them is taken.
        """
        counts = _as_counts(counts)
        faulty = self.samples + np.flatnonzero(_as_faults(faults, len(counts)))
        faulty = np.concatenate([self._faulty, faulty])
        span = self.design.samples_per_major
        first_major, majors = self.samples // span, (self.leftover + len(counts)) // span
        if majors == 0:
            self._check_widths(counts, self.samples)
            self._kept.append(counts.copy())
            self._faulty = faulty
            self.samples += len(counts)
            return VectorBlock.from_rows([], self.design)

        kept = np.concatenate(self._kept, dtype=np.int64)

        def rows(start: int, stop: int) -> Counts:
            """Rows start..stop-1 of `kept` with `counts` after it, the widths checked."""
            new = slice(max(start - len(kept), 0), max(stop - len(kept), 0))
            self._check_widths(counts[new], self.samples + new.start)
            if start >= len(kept):
                return counts[new]
            return np.concatenate([kept[start:stop], counts[new]], dtype=np.int64)

        components, rails = self._computed(rows, majors)
        still_needed = rows(majors * span, len(kept) + len(counts)).copy()

        major = np.arange(first_major, first_major + majors, dtype=np.int64)
        status = np.where(major < self.design.short_majors, STATUS_SHORT_HISTORY, 0)
        status[rails] |= STATUS_RAIL
        complete = faulty < (first_major + majors) * span
        status[faulty[complete] // span - first_major] |= STATUS_FAULT

        self._kept, self._faulty = [still_needed], faulty[~complete]
        self.samples += len(counts)
        return VectorBlock(major, status, components)

    def _computed(
        self, rows: Callable[[int, int], Counts], majors: int
    ) -> tuple[Integers, NDArray[np.bool_]]:
        """Components of major intervals, and whether each has a count at an end of its width.

        Args:
            rows: rows start..stop-1 of the history and the samples after it.
            majors: how many.
        """
        span, history = self.design.samples_per_major, self._arithmetic.history
        rails = np.empty(majors, np.bool_)
        limbs = self._arithmetic.limbs
        components = np.empty((majors, len(self.design.components), limbs), np.int64)
        idle = SimpleQueue[Arithmetic]()
        for arithmetic in self._arithmetics:
            idle.put(arithmetic)

        def compute(first: int) -> None:
            arithmetic = idle.get()
            try:
                last = min(first + arithmetic.majors, majors)
                block = rows(first * span, last * span + history)
                components[first:last] = limbs_of(arithmetic.components(block))
                rails[first:last] = self._at_rail(block[history:])
            finally:
                idle.put(arithmetic)

        blocks = range(0, majors, self._arithmetic.majors)
        if len(blocks) == 1:
            compute(0)
        else:
            # numpy lets go of the interpreter while it computes, so threads share the blocks
            # out; `map` gives their ends in order, and so the first block's fault
            with ThreadPoolExecutor(len(self._arithmetics)) as pool:
                for _ in pool.map(compute, blocks):
                    pass
        return from_limbs(components), rails

    def _check_widths(self, counts: Counts, first: int) -> None:
        """See that all counts, the first of which belong to sample `first`, fit the sensors."""
        words = self.design.words
        narrower = min(words.gyro, words.accel, key=lambda allowed: allowed.hi)
        if len(counts) == 0 or (int(counts.min()) in narrower and int(counts.max()) in narrower):
            return
        try:
            for extreme in (np.minimum, np.maximum):
                check_widths(words, first, _column_extremes(counts, extreme))
        except InputError:
            for t, sample in enumerate(counts.tolist(), start=first):
                check_widths(words, t, sample)

    def _at_rail(self, rows: Counts) -> NDArray[np.bool_]:
        """For each of whole major intervals, whether a count of it is at an end of its width."""
        words, span = self.design.words, self.design.samples_per_major
        found = np.zeros(len(rows), np.bool_)
        for extreme, end in ((np.minimum, "lo"), (np.maximum, "hi")):
            for column, count in enumerate(_column_extremes(rows, extreme)):
                if count == getattr(words.gyro if column < 3 else words.accel, end):
                    found |= rows[:, column] == count
        each: NDArray[np.bool_] = np.logical_or.reduce(found.reshape(-1, span), axis=1)
        return each


def run_fast(design: Design, counts: ArrayLike, faults: ArrayLike | None = None) -> VectorBlock:
    """All complete major intervals of a sequence of samples, from reset.

    Args:
        design: the design.
        counts, faults: as for `FastModel.feed`.

    Raises:
        InputError: as `FastModel.feed`.
    """
    return FastModel(design).feed(counts, faults)


def _column_extremes(counts: Counts, extreme: np.ufunc) -> list[int]:
    """Least or greatest count of each column; there must be a sample."""
    whole = len(counts) // ROW * ROW
    rows = counts[:whole].reshape(-1, ROW * 6)
    parts = [counts[whole:], *([extreme.reduce(rows).reshape(ROW, 6)] if whole else [])]
    columns: list[int] = extreme.reduce(np.concatenate(parts)).tolist()
    return columns


def _as_counts(counts: ArrayLike) -> Counts:
    array = np.asarray(counts)
    if array.ndim != 2 or array.shape[1] != 6 or array.dtype.kind not in "iu":
        raise InputError(
            f"counts: an array of shape {array.shape} and type {array.dtype} is not allowed,"
            " give integers of shape (N, 6)"
        )
    return array


def _as_faults(faults: ArrayLike | None, samples: int) -> NDArray[Any]:
    if faults is None:
        return np.zeros(0, np.bool_)
    array = np.asarray(faults)
    if array.shape != (samples,) or array.dtype.kind not in "iub":
        raise InputError(
            f"faults: an array of shape {array.shape} and type {array.dtype} is not allowed,"
            f" give {samples} integers or booleans, one per sample"
        )
    return array
