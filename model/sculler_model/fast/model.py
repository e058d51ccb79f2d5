"""`FastModel`: the twin of `GoldenModel` for arrays, exact for every legal design.

It takes arrays of counts of any length, checks them, keeps what later results need, shares blocks
of whole major intervals out to threads and gives them their status.  A block is computed by
`kernel`, compiled by Numba, where that is installed and there are samples enough to be worth its
loading; else by `arithmetic` in numpy: the same integers, more slowly.  Compensated samples
(`compensation`) are too wide for the kernel, whose counts fit 32 bits.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from itertools import pairwise
from queue import SimpleQueue
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sculler_model import machine_code
from sculler_model.design import STATUS_FAULT, STATUS_RAIL, STATUS_SHORT_HISTORY, Design
from sculler_model.errors import InputError
from sculler_model.fast.arithmetic import BLOCK, FEW_MINORS, Arithmetic, Counts
from sculler_model.fast.blocks import VectorBlock
from sculler_model.fast.compensation import FastCompensator, Marks
from sculler_model.fast.counts import Rows, as_counts, as_faults, column_extremes
from sculler_model.fast.wide import from_limbs, limbs_of
from sculler_model.golden import check_widths

if TYPE_CHECKING:
    from sculler_model.fast.kernel import Kernel

THREADS = min(os.cpu_count() or 1, 4)
"""Blocks computed at the same time."""

WORTH_COMPILING = 2_000_000
"""Samples that numpy takes as long for as Numba takes to be loaded, for designs of some widths."""

WORTH_COMPILING_ORDERS = 200_000
"""The same for third and fourth order, which numpy has in Python's integers."""


WORTH_A_THREAD = 1_000_000
"""Samples for each thread from which on it pays to share the kernel's work out."""


class _Place(NamedTuple):
    """Where the results of intervals first..last-1 go.

    Attributes:
        room: gives memory for so many, or for more.
        done: is told these numbers and the memory once they are there.
    """

    room: Callable[[int, int], NDArray[np.int64]]
    done: Callable[[int, int, NDArray[np.int64]], None] = lambda _first, _last, _results: None


class FastModel:
    """Exact coning/sculling accumulators of one design, fed with arrays.

    Chunks of any length give the results that `GoldenModel` gives for the same samples.  Memory
    is bounded by the chunk, its results and one major interval.

    Args:
        design: the design.
        block: samples computed at a time; makes no difference to the results.
        few_minors: see `Arithmetic`; makes none either.
        threads: blocks computed at the same time; `THREADS` if left out.
        compiled: whether to go through Numba; if left out, where it is installed and there have
            been `WORTH_COMPILING` samples, with third and fourth order `WORTH_COMPILING_ORDERS`.
        expected: samples that will come, if known; so many need not be waited for.

    Attributes:
        design: the design.
        samples: samples accepted since reset.

    Raises:
        InputError: `compiled` is asked for without Numba, or of a design with compensation.
    """

    def __init__(
        self,
        design: Design,
        *,
        block: int = BLOCK,
        few_minors: int = FEW_MINORS,
        threads: int = THREADS,
        compiled: bool | None = None,
        expected: int = 0,
    ) -> None:
        self.design = design
        self._block = max(block // design.samples_per_major, 1)
        self._arithmetics = [Arithmetic(design.inner, block, few_minors) for _ in range(threads)]
        self._arithmetic = self._arithmetics[0]
        self._threads = threads
        self._compiled = compiled
        self._kernel: Kernel | None = None
        self._taken = 0  # samples, whether or not reset
        self._expected = expected
        if compiled and design.compensation is not None:
            raise InputError("the compiled model has no compensation: leave it to numpy")
        if compiled:
            kernel = kernel_class()
            if kernel is None:
                raise InputError("the compiled model needs Numba: install sculler[fast]")
            self._kernel = kernel(design)
        self.reset()

    def reset(self) -> None:
        """Forget everything: the next sample is the first, the next major interval is 0."""
        self.samples = 0
        # What later results still need: the history, then the incomplete major interval.
        self._kept: list[Counts] = [np.zeros((self._arithmetic.history, 6), np.int64)]
        # samples that carried `fault`; and, where they are compensated, that counts at rails are in
        self._faulty: Marks = np.zeros(0, np.int64)
        self._railed: Marks = np.zeros(0, np.int64)
        plan = self.design.compensation_plan
        self._compensator = None if plan is None else FastCompensator(plan)

    @property
    def leftover(self) -> int:
        """Samples in the incomplete major interval so far."""
        return self.samples % self.design.samples_per_major

    @property
    def lacks_numba(self) -> bool:
        """Whether there were samples enough to be compiled for, but Numba is missing."""
        worth = self._compensator is None and self._taken >= self._worth_compiling
        return worth and kernel_class() is None

    @property
    def _worth_compiling(self) -> int:
        return WORTH_COMPILING if self.design.order == 2 else WORTH_COMPILING_ORDERS

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
        found: list[NDArray[np.int64]] = []

        def room(first: int, last: int) -> NDArray[np.int64]:
            return found[0][first:last]

        def compute(rows: Rows, majors: int) -> NDArray[np.bool_]:
            found.append(self._room(majors))
            return self._computed(rows, majors, _Place(room))

        first, status = self._taken_by(as_counts(counts), faults, compute)
        if not found:
            return VectorBlock.from_rows([], self.design)
        major = np.arange(first, first + len(status), dtype=np.int64)
        return VectorBlock(major, status, from_limbs(found[0]))

    def feed_to(
        self,
        use: Callable[[int, NDArray[np.int64]], None],
        counts: ArrayLike,
        faults: ArrayLike | None,
        size: int,
    ) -> NDArray[np.int64]:
        """`feed`, for who needs no result twice: some are computed, used and forgotten.

        Args:
            use: takes the number of an interval, from 0 on, and the limbs of it and of those after
                it, (R, C, W) as of `limbs_of`, which it must not keep.  Several threads call it.
            counts, faults: as for `feed`.
            size: intervals computed at a time.

        Returns:
            (R,) the intervals' status.

        Raises:
            InputError: as `feed`; then nothing of them is taken, but some may have been used.
        """
        idle: list[NDArray[np.int64]] = []

        def room(_first: int, _last: int) -> NDArray[np.int64]:
            return idle.pop() if idle else self._room(size)

        def done(first: int, last: int, results: NDArray[np.int64]) -> None:
            use(first, results[: last - first])
            idle.append(results)

        def compute(rows: Rows, majors: int) -> NDArray[np.bool_]:
            return self._computed(rows, majors, _Place(room, done), size)

        return self._taken_by(as_counts(counts), faults, compute)[1]

    def _room(self, majors: int) -> NDArray[np.int64]:
        """Memory for results.  The kernel writes nothing between minor intervals if one is all."""
        memory = np.zeros if self.design.algorithm.minors == 1 else np.empty
        return memory((majors, len(self.design.components), self._arithmetic.limbs), np.int64)

    def _taken_by(
        self,
        counts: Counts,
        faults: ArrayLike | None,
        compute: Callable[[Rows, int], NDArray[np.bool_]],
    ) -> tuple[int, NDArray[np.int64]]:
        """Have `compute` work out what samples complete, if anything, and take them.

        Args:
            counts, faults: as for `feed`.
            compute: takes the history with the samples after it and how many intervals they are,
                returns whether each has a count at an end of its width.

        Returns:
            The first interval's number, and the status of each.
        """
        faulty = self.samples + np.flatnonzero(as_faults(faults, len(counts)))
        railed = self._railed
        if self._compensator is not None and len(counts):
            self._check_widths(counts, self.samples)
            newly = self.samples + np.flatnonzero(self._with_rail(counts))
            railed = np.concatenate([railed, self._compensator.spread(newly)])
            faulty = self._compensator.spread(faulty)
            counts = self._compensator(counts)
        faulty = np.concatenate([self._faulty, faulty])
        span = self.design.samples_per_major
        first_major, majors = self.samples // span, (self.leftover + len(counts)) // span
        if majors == 0:
            self._check_unless_made(counts, self.samples)
            self._kept.append(counts.copy())
            self._faulty, self._railed = faulty, railed
            self.samples += len(counts)
            return first_major, np.zeros(0, np.int64)

        rows = Rows(np.concatenate(self._kept, dtype=np.int64), counts)
        rails = compute(rows, majors)
        history = self._arithmetic.history
        self._check_rows(rows, majors * span + history, len(rows))
        still_needed = rows[majors * span : len(rows)].astype(np.int64)

        status = np.zeros(majors, np.int64)
        status[: max(self.design.short_majors - first_major, 0)] = STATUS_SHORT_HISTORY
        status[rails] |= STATUS_RAIL
        left = []
        for marked, bit in ((faulty, STATUS_FAULT), (railed, STATUS_RAIL)):
            complete = marked < (first_major + majors) * span
            status[marked[complete] // span - first_major] |= bit
            left.append(marked[~complete])

        self._kept = [still_needed]
        self._faulty, self._railed = left
        self.samples += len(counts)
        self._taken += len(counts)
        return first_major, status

    def _computed(
        self, rows: Rows, majors: int, place: _Place, size: int | None = None
    ) -> NDArray[np.bool_]:
        """Compute major intervals; whether each has a count at an end of its width.

        Args:
            rows: the history and the samples after it.
            majors: how many intervals.
            place: of the results.
            size: intervals at a time, each of which is work enough for a thread; if left out, a
                block, and the kernel gets as many threads as pay.
        """
        span = self.design.samples_per_major
        rails = np.empty(majors, np.bool_)
        threads = self._threads
        if size is None:
            size, threads = self._block, min(threads, len(rows.counts) // WORTH_A_THREAD)
        kernel = self._kernel_if_worth(rows)
        if kernel is None:
            self._by_arithmetic(rows, place, rails, min(size, self._arithmetic.majors))
        else:
            # first what reaches into the rows that were kept, which must be copied
            head = min(-(-len(rows.kept) // span), majors)
            edges = sorted({*range(0, head, size), *range(head, majors, size), majors})

            def compute(first: int, last: int) -> None:
                self._by_kernel(kernel, rows, place, rails, slice(first, last))

            _share(compute, edges, threads)
        return rails

    def _by_kernel(
        self, kernel: Kernel, rows: Rows, place: _Place, rails: NDArray[np.bool_], part: slice
    ) -> None:
        """Compute the results of some major intervals."""
        first, last, span = part.start, part.stop, self.design.samples_per_major
        history = self._arithmetic.history
        begin, end = first * span, last * span + history
        if not np.can_cast(rows.counts.dtype, np.int64):  # the greatest would wrap
            self._check_rows(rows, begin, end)
        narrow = np.can_cast(rows.counts.dtype, np.int32)
        block = rows[begin:end].astype(np.int32 if narrow else np.int64, copy=False)
        block = np.require(block, None, ["C", "A"])
        results = place.room(first, last)
        done = first + kernel(block, history, results[: last - first], rails[first:last])
        if done < last:
            self._check_rows(rows, done * span + history, (done + 1) * span + history)
        place.done(first, last, results)

    def _by_arithmetic(
        self, rows: Rows, place: _Place, rails: NDArray[np.bool_], size: int
    ) -> None:
        """Compute all results."""
        span, history = self.design.samples_per_major, self._arithmetic.history
        idle = SimpleQueue[Arithmetic]()
        for arithmetic in self._arithmetics:
            idle.put(arithmetic)

        def compute(first: int, last: int) -> None:
            begin, end = first * span, last * span + history
            self._check_rows(rows, begin, end)
            block, results = rows[begin:end], place.room(first, last)
            arithmetic = idle.get()
            try:
                results[: last - first] = limbs_of(arithmetic.components(block))
            finally:
                idle.put(arithmetic)
            made = self._compensator is not None  # then `_taken_by` knows
            rails[first:last] = False if made else self._at_rail(block[history:])
            place.done(first, last, results)

        _share(compute, [*range(0, len(rails), size), len(rails)], self._threads)

    def _kernel_if_worth(self, rows: Rows) -> Kernel | None:
        """The kernel, if Numba is there and with these samples there are enough."""
        worth = max(self._taken + len(rows.counts), self._expected) >= self._worth_compiling
        worth = worth and self._compensator is None
        if self._kernel is None and self._compiled is None and worth:
            kernel = kernel_class()
            self._kernel = None if kernel is None else kernel(self.design)
        return self._kernel

    def _check_rows(self, rows: Rows, start: int, stop: int) -> None:
        """See that rows start..stop-1 fit their widths; what was kept has been seen to."""
        first = max(start - len(rows.kept), 0)
        new = rows.counts[first : max(stop - len(rows.kept), 0)]
        self._check_unless_made(new, self.samples + first)

    def _check_unless_made(self, counts: Counts, first: int) -> None:
        """`_check_widths`, unless they are compensated samples, whose counts have been seen to."""
        if self._compensator is None:
            self._check_widths(counts, first)

    def _check_widths(self, counts: Counts, first: int) -> None:
        """See that all counts, the first of which belong to sample `first`, fit the sensors."""
        words = self.design.words
        narrower = min(words.gyro, words.accel, key=lambda allowed: allowed.hi)
        if len(counts) == 0 or (int(counts.min()) in narrower and int(counts.max()) in narrower):
            return
        try:
            for extreme in (np.minimum, np.maximum):
                check_widths(words, first, column_extremes(counts, extreme))
        except InputError:
            for t, sample in enumerate(counts.tolist(), start=first):
                check_widths(words, t, sample)

    def _at_rail(self, rows: Counts) -> NDArray[np.bool_]:
        """For each of whole major intervals, whether a count of it is at an end of its width."""
        found, span = self._with_rail(rows), self.design.samples_per_major
        each: NDArray[np.bool_] = np.logical_or.reduce(found.reshape(-1, span), axis=1)
        return each

    def _with_rail(self, rows: Counts) -> NDArray[np.bool_]:
        """For each sample, whether a count of it is at an end of its width."""
        words = self.design.words
        found = np.zeros(len(rows), np.bool_)
        for extreme, end in ((np.minimum, "lo"), (np.maximum, "hi")):
            for column, count in enumerate(column_extremes(rows, extreme)):
                if count == getattr(words.gyro if column < 3 else words.accel, end):
                    found |= rows[:, column] == count
        return found


@cache
def kernel_class() -> type[Kernel] | None:
    """What makes a compiled kernel of a design; None where Numba is missing."""
    if not machine_code.available():
        return None
    from sculler_model.fast.kernel import Kernel

    return Kernel


def _share(compute: Callable[[int, int], None], edges: Sequence[int], threads: int) -> None:
    """Compute what lies between the edges, on several threads."""
    if len(edges) == 2 or threads <= 1:
        for edge in pairwise(edges):
            compute(*edge)
        return
    # numpy and the kernel let go of the interpreter, so threads share the blocks out; `map` gives
    # their ends in order, and so the first block's fault
    with ThreadPoolExecutor(threads) as pool:
        for _ in pool.map(lambda edge: compute(*edge), pairwise(edges)):
            pass


def run_fast(design: Design, counts: ArrayLike, faults: ArrayLike | None = None) -> VectorBlock:
    """All complete major intervals of a sequence of samples, from reset.

    Args:
        design: the design.
        counts, faults: as for `FastModel.feed`.

    Raises:
        InputError: as `FastModel.feed`.
    """
    return FastModel(design).feed(counts, faults)
