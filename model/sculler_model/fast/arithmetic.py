"""The arithmetic of `FastModel`: a block of whole major intervals at once, exact for every width.

It computes the page (docs/explanation/theory.md) for R major intervals.  An array of vectors has
the shape (2, 4, M, R): sensor (gyro, accelerometer), axis, minor interval, major interval.  Axes
are stored as y, z, x, y, so that a cross product is two products of slices,

    left[:3] * right[1:] - left[1:] * right[:3]            (x, y, z)

and a sum of cross products over the minor intervals of every major is two calls of `einsum`.

Where every component of a design fits 64 bits, everything on the way to it does too: the range of
a sum holds the ranges of its parts (`word_lengths`).  Wider designs are computed as on paper:
taps, weights and counts are written in digits of c bits, the digits are multiplied, their products
summed in int64, and the sums put together as one Python integer per component.  `digit_bits`
finds the c for which no such sum can pass 64 bits.  A narrow design is the case of one digit.
Counts of more than `WIDE` bits are split in weighted sums too.

High-resolution position is that of `scrolling`, third and fourth order that of `higher_order`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from itertools import pairwise
from typing import Any, TypeAlias

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from sculler_model.design import VECTORS, Design, Interval, cross_range
from sculler_model.fast.blocks import component_limbs
from sculler_model.fast.digits import digit_count, split_digits
from sculler_model.fast.higher_order import FastHigherOrder
from sculler_model.fast.scrolling import FastHighResolution
from sculler_model.fast.wide import Integers, as_integers

Counts: TypeAlias = NDArray[np.integer[Any]]
"""(N, 6): gyro x, y, z, accelerometer x, y, z of N samples."""

MinorVectors: TypeAlias = NDArray[np.int64]
"""(2, 4, M, R): a gyro and an accelerometer vector of each minor interval, axes y, z, x, y."""

Digits: TypeAlias = NDArray[np.int64]
"""(digits, ...): numbers in digits, the lowest first."""

Terms: TypeAlias = list[tuple[int, int]]
"""Pairs (distance, coefficient) of a weighted sum."""


BLOCK = 65536
"""Samples computed at a time: few enough for the cache, many enough for numpy."""

FEW_MINORS = 16
"""Up to this many minor intervals per major, memory runs along majors, else along minors."""

WIDE = 32
"""Bits of a count of a sensor at most; compensated ones have more."""

XYZ = [2, 0, 1]
"""Where x, y and z stand in the order y, z, x, y."""


class Arithmetic:
    """The arithmetic of a block of whole major intervals.

    Attributes:
        history: rows before the first major interval, whole minor intervals of samples.
        majors: R, the most major intervals of a block.
        limbs: W of the components, 1 for int64.

    Args:
        design: the design.
        block: samples computed at a time.
        few_minors: up to so many minor intervals a major memory runs along majors, else along
            minors.
    """

    def __init__(self, design: Design, block: int = BLOCK, few_minors: int = FEW_MINORS) -> None:
        table, words = design.table, design.words
        self.n, self.M = table.samples, design.algorithm.minors
        self.minors_back = max(-((k - d) // self.n) for k, d in enumerate(design.reaches))
        self.history = self.n * self.minors_back
        self.majors = max(block // (self.n * (self.minors_back + self.M)), 1)
        self.limbs = component_limbs(design)
        self._along_majors = few_minors >= self.M

        self.bits = digit_bits(design)
        self.count_digits = digit_count(words.gyro | words.accel, self.bits)
        tap_digits = digit_count(words.gyro_taps | words.accel_taps, self.bits)
        sum_digits = digit_count(words.theta | words.v, self.bits)
        self._splits = is_wide(design)
        own = max(digit_count(coefficients(design), self.bits), 1) if self._splits else 0
        self.taps = {
            k: self._terms(enumerate(table.taps[k - 1], start=1), own or tap_digits)
            for k in table.active_phases
        }
        self.weights = self._terms(enumerate(table.weights), own or sum_digits)

        self.fits_int64 = [
            (coning | sculling).bits <= 64
            for coning, sculling in (
                (words.alpha, words.nu),
                (words.coning_within, words.sculling_within),
                (words.coning_between, words.sculling_between),
            )
        ]

        self._position = None
        if design.high_resolution:
            counts = words.gyro | words.accel
            self._position = FastHighResolution(design.samples_per_major, counts)
        self._higher = FastHigherOrder(design, self.history) if design.order > 2 else None

        # Arrays that every block uses anew: fresh memory costs more than the arithmetic.
        self._x = self._vectors(self.n, self.minors_back + self.M)
        self._A_B = self._vectors(tap_digits, self.M)
        self._theta_v = self._vectors(sum_digits, self.M)
        self._alpha_nu = self._vectors(sum_digits, self.M)
        self._term = self._vectors(1, self.M)

    def _terms(self, row: Iterable[tuple[int, int]], digits: int) -> list[Terms]:
        """The non-zero coefficients of a row, once for each digit."""
        split = [(d, split_digits(c, self.bits, digits)) for d, c in row if c]
        return [[(d, c[i]) for d, c in split] for i in range(digits)]

    def _vectors(self, count: int, minors: int) -> NDArray[np.int64]:
        """Memory for `count` arrays of vectors, (count, 2, 4, minors, R)."""
        if self._along_majors:
            return np.empty((count, 2, 4, minors, self.majors), np.int64)
        return np.empty((count, 2, 4, self.majors, minors), np.int64).swapaxes(-1, -2)

    def components(self, rows: Counts) -> Integers:
        """(R, C) components of the R major intervals after the history in `rows`."""
        n, M = self.n, self.M
        R = (len(rows) - self.history) // (n * M)
        buffers = (self._x, self._A_B, self._theta_v, self._alpha_nu)
        x, A_B, theta_v, alpha_nu = (buffer[..., :R] for buffer in buffers)
        self._load(rows, x)

        def samples_of(k: int) -> Callable[[int], MinorVectors]:
            """d -> s[t-d], r[t-d] for the t of phase k."""

            def back(d: int) -> MinorVectors:
                minor, phase = divmod(k - 1 - d, n)
                return x[phase, :, :, self.minors_back + minor :][:, :, :M]

            return back

        # every sample
        within = np.zeros((len(A_B) + self.count_digits - 1, 2, 3, R), np.int64)
        for k, taps in self.taps.items():
            self._weighted_sum(taps, samples_of(k), A_B)
            s_r = split_digits(samples_of(k)(0), self.bits, self.count_digits)
            _add_products(within, A_B, s_r)

        # every minor end
        self._weighted_sum(self.weights, samples_of(n), theta_v)
        self._running_sum(theta_v, alpha_nu)
        between = np.zeros((2 * len(theta_v) - 1, 2, 3, R), np.int64)
        _add_products(between, alpha_nu[:, :, :, :-1], theta_v[:, :, :, 1:])

        # every major end
        sums = (alpha_nu[:, :, XYZ, -1], within, between)
        numbers = [self._number(*each) for each in zip(sums, self.fits_int64, strict=True)]
        components: NDArray[Any] = np.stack(numbers, axis=1).reshape(-1, R).T
        if self._position is not None:
            position = self._position.components(rows[self.history - 1 :])
            components = np.concatenate([components, position], axis=1)
        if self._higher is not None:
            components = np.concatenate([components, self._higher.components(rows)], axis=1)
        return as_integers(components, self.limbs)

    def _load(self, rows: Counts, x: NDArray[np.int64]) -> None:
        """Lay samples out as (phase, sensor, axis, minor, major), minors of history first."""
        minors = rows.reshape(-1, self.n, 2, 3)
        windows = sliding_window_view(minors, self.minors_back + self.M, axis=0)[:: self.M]
        xyz = windows.transpose(1, 2, 3, 4, 0)
        x[:, :, 2] = xyz[:, :, 0]
        x[:, :, :2] = xyz[:, :, 1:]
        for k in self.taps:
            x[k - 1, :, 3] = x[k - 1, :, 0]

    def _weighted_sum(
        self, terms: list[Terms], back: Callable[[int], MinorVectors], out: Digits
    ) -> None:
        """Sum of coefficient * x[t-d], in digits."""
        xyz = out[:, :, :3]
        if self._splits:
            self._sum_of_digits(terms, back, xyz)
        else:
            self._sum_of_counts(terms, back, xyz)
        for low, high in pairwise(xyz):
            high += low >> self.bits
            low &= (1 << self.bits) - 1
        out[:, :, 3] = out[:, :, 0]

    def _sum_of_counts(
        self, terms: list[Terms], back: Callable[[int], MinorVectors], xyz: Digits
    ) -> None:
        """The sum, with what is to be carried left in each digit."""
        spare = self._term[0, :, :3, :, : xyz.shape[-1]]
        for digit_terms, total in zip(terms, xyz, strict=True):
            (d, c), *others = digit_terms
            np.multiply(back(d)[:, :3], c, out=total)
            for d, c in others:
                x = back(d)[:, :3]
                total += x if c == 1 else np.multiply(x, c, out=spare)

    def _sum_of_digits(
        self, terms: list[Terms], back: Callable[[int], MinorVectors], xyz: Digits
    ) -> None:
        """The same with the counts in digits too; what is beyond the highest digit goes into it."""
        xyz[:] = 0
        top = len(xyz) - 1
        for d in sorted({d for digit_terms in terms for d, _ in digit_terms}):
            counts = split_digits(back(d)[:, :3], self.bits, self.count_digits)
            for i, digit_terms in enumerate(terms):
                for c in (c for distance, c in digit_terms if distance == d and c):
                    for place, count in enumerate(counts, start=i):
                        above = max(place - top, 0)
                        xyz[place - above] += (c * count) << above * self.bits

    def _running_sum(self, theta_v: Digits, alpha_nu: Digits) -> None:
        """alpha and nu after each minor interval."""
        if not self._along_majors:
            np.add.accumulate(theta_v, axis=3, out=alpha_nu)
            return
        alpha_nu[:, :, :, 0] = theta_v[:, :, :, 0]
        for m in range(1, self.M):
            np.add(alpha_nu[:, :, :, m - 1], theta_v[:, :, :, m], out=alpha_nu[:, :, :, m])

    def _number(self, digits: Digits, fits_int64: bool) -> NDArray[Any]:
        """The numbers that stand in digits."""
        number: NDArray[Any] = digits[-1].astype(np.int64 if fits_int64 else object)
        for digit in digits[-2::-1]:
            number = (number << self.bits) + digit
        return number


def _add_products(
    sums: Digits, left: Iterable[MinorVectors], right: Iterable[MinorVectors]
) -> None:
    """Add A x s and A x r + B x s of left = [A, B], right = [s, r], summed over minors, to sums."""
    for i, A_B in enumerate(left):
        for j, s_r in enumerate(right):
            A, s, r_s = A_B[0], s_r[0], s_r[::-1]
            coning, sculling = sums[i + j]
            coning += np.einsum("amr,amr->ar", A[:3], s[1:])
            coning -= np.einsum("amr,amr->ar", A[1:], s[:3])
            sculling += np.einsum("vamr,vamr->ar", A_B[:, :3], r_s[:, 1:])
            sculling -= np.einsum("vamr,vamr->ar", A_B[:, 1:], r_s[:, :3])


def is_wide(design: Design) -> bool:
    """Whether counts are wider than any sensor's."""
    return (design.words.gyro | design.words.accel).bits > WIDE


def coefficients(design: Design) -> Interval:
    """Range of taps and weights, and 0."""
    rows = (*design.table.taps, design.table.weights)
    every = [0, *(c for row in rows for c in row)]
    return Interval(min(every), max(every))


def digit_bits(design: Design) -> int:
    """The widest digits for which no sum of products can pass 64 bits; 64 where one digit does."""
    table, words, M = design.table, design.words, design.algorithm.minors
    if all(getattr(words, vector).bits <= 64 for vector in VECTORS):
        return 64
    counts = words.gyro | words.accel
    most_terms = max(sum(map(bool, row)) for row in (*table.taps, table.weights))

    def fits(bits: int) -> bool:
        digit = Interval.signed(bits + 1)
        pairs = cross_range(digit, digit) + cross_range(digit, digit)  # A x r + B x s
        same_place = min(
            digit_count(counts, bits), digit_count(words.gyro_taps | words.accel_taps, bits)
        )
        terms = most_terms * (digit_count(counts, bits) if is_wide(design) else 1)
        sums = [
            pairs.repeated(M * len(table.active_phases) * same_place),
            pairs.repeated(M * (M - 1) // 2 * digit_count(words.theta | words.v, bits)),
            # a weighted sum and the carry into it
            (digit * (digit if is_wide(design) else counts)).repeated(2 * terms),
        ]
        return all(total.bits <= 64 for total in sums)

    return next(bits for bits in range(62, 0, -1) if fits(bits))
