"""The page compiled by Numba: counts to exact integers, sample by sample, for every legal design.

One program serves all designs.  What differs between them, taps, weights, n and M, is data that it
reads; only the types differ, by the counts' type and by the limbs of 64 bits that sums and results
need.  So Numba compiles once for all designs of the same widths and keeps that between processes.
With the table as constants each design would cost seconds of compiling and gain nothing: the
vectors of six (`lanes`) are where the speed comes from.

Everything is exact modulo 2^64 a limb: what wraps on the way wraps back, for sums and products
modulo 2^k of the right integers are right modulo 2^k, and the result fits (`word_lengths`).  The
factors of products with several limbs are kept whole, see `lanes.factor_limbs`.

High-resolution position is the sum of products of `scrolling`, there with its derivation.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sculler_model.algorithms import scrolling_weights_total
from sculler_model.design import Design, Interval
from sculler_model.fast import kernel_orders, lanes
from sculler_model.fast.blocks import component_limbs
from sculler_model.fast.lanes import (
    DIGIT_BITS,
    LIMB_DIGITS,
    TAP_BITS,
    add_crossed,
    add_crossed_over,
    add_scaled,
    any_negative,
    factor_limbs,
    halves_added,
    outside,
    plus,
    put_left,
    put_right,
    row,
    weighted,
    zero,
)
from sculler_model.machine_code import compiled

Rows = NDArray[np.int64]


class Kernel:
    """Machine code for a design.

    Attributes:
        history: rows that it wants before the first major interval.

    Args:
        design: the design.
    """

    def __init__(self, design: Design) -> None:
        table, words = design.table, design.words
        limbs = component_limbs(design)

        def like(*factors: Interval) -> tuple[int, ...]:
            """Zeros, as many as limbs of these factors."""
            return (0,) * (1 if limbs == 1 else factor_limbs(max(each.bits for each in factors)))

        self.history = max(reach - k for k, reach in enumerate(design.reaches))
        tap_like = like(words.gyro_taps, words.accel_taps)
        sum_like = like(words.alpha, words.nu, words.theta, words.v)
        rows = [[(d, c) for d, c in enumerate(row, start=1) if c] for row in table.taps]
        phases = [k for k, row in enumerate(rows) if row]
        stops = np.cumsum([len(rows[k]) for k in phases], dtype=np.int64)
        weights = [(d, c) for d, c in enumerate(table.weights) if c]
        self._arguments = (
            table.samples,
            design.algorithm.minors,
            np.column_stack([np.array(phases, np.int64), stops]),
            *_terms((term for row in rows for term in row), len(tap_like)),
            *_terms(weights, len(sum_like)),
            weights == [(d, 1) for d in range(table.samples)],
            _limits(words.gyro, words.accel),
            tap_like,
            sum_like,
            (0,) * limbs,
        )
        self._position: tuple[Any, ...] = ()
        if design.high_resolution:
            samples, counts = design.samples_per_major, words.gyro | words.accel
            # the sum of all products with a right factor of 1: more than any left one
            sums = max(2 * scrolling_weights_total(samples), 4096 * samples**2)
            self._position = (samples, like(counts.repeated(sums)), (0,) * limbs)

        self._higher: tuple[Any, ...] = ()
        if design.order > 2:
            self._higher = kernel_orders.arguments(design, like, _terms, limbs)

    def __call__(
        self, counts: NDArray[Any], first: int, results: Rows, rails: NDArray[np.bool_]
    ) -> int:
        """Fill in the results of whole major intervals.

        Args:
            counts: (N, 6) int32 or int64, contiguous and aligned.
            first: row of the first major interval's first sample, at least `history`.
            results: (R, C, W) limbs of R intervals' components; zeros where a design has one minor
                interval, else anything.
            rails: (R,), filled in with whether a count of the interval is at an end of its width.

        Returns:
            R, or the first interval that has a count beyond its width; what is filled in from there
            on means nothing.
        """
        counts = counts[:]
        counts.flags.writeable = False  # one type for Numba, whatever the caller's is
        done: int = _vectors(counts, first, *self._arguments, results, rails)
        if self._position:
            _position(counts, first, *self._position, results[:done])
        if self._higher:
            kernel_orders.higher(counts, first, *self._higher, results[:done])
        return done


def _terms(terms: Iterable[tuple[int, int]], limbs: int) -> tuple[Rows, int]:
    """Distances and coefficients, and in how many digits: all terms for each digit, highest first.

    With one limb a coefficient is one digit.
    """
    terms = [*terms]
    digits = 1 if limbs == 1 else -(-LIMB_DIGITS * DIGIT_BITS * limbs // TAP_BITS)
    found = np.zeros((digits, len(terms), 2), np.int64)
    for i in range(digits):
        part = [(d, c >> TAP_BITS * (digits - 1 - i)) for d, c in terms]
        if i:
            part = [(d, c & (1 << TAP_BITS) - 1) for d, c in part]
        found[i] = np.array(part, np.int64).reshape(-1, 2)
    return found.reshape(-1, 2), digits


def _limits(gyro: Interval, accel: Interval) -> Rows:
    """The least and greatest counts (4, 6) off their rails, and then those of their width."""
    ends = [(w.lo + 1, w.hi - 1, w.lo, w.hi) for w in (gyro, accel)]
    return np.repeat(np.array(ends, np.int64).T, 3, axis=1)


def _vectors_of(  # type: ignore[no-untyped-def]
    counts, first, n, M, phases, taps, tap_digits, weights, weight_digits, plain, limits,
    tap_like, sum_like, like, results, rails,
):  # fmt: skip
    low, high = row(limits, 0), row(limits, 1)
    t = first
    for major in range(len(results)):
        within, between = zero(like), zero(like)
        alpha_nu, flags = zero(sum_like), zero((0,))
        for minor in range(M):
            # every minor end
            theta_v = zero(sum_like)
            for s in range(t, t + n):
                samples = row(counts, s)
                flags = outside(flags, samples, low, high)
                if plain:
                    theta_v = plus(theta_v, samples)
            if not plain:
                each = len(weights) // weight_digits
                last = t + n - 1
                theta_v = weighted(sum_like, weights, weight_digits, 0, each, counts, last)
            # every sample whose taps are not all zero
            start = 0
            for phase in range(len(phases)):
                s, stop = t + phases[phase, 0], phases[phase, 1]
                A_B = weighted(tap_like, taps, tap_digits, start, stop, counts, s)
                within = add_crossed(within, A_B, row(counts, s))
                start = stop
            if minor:
                between = add_crossed(between, alpha_nu, theta_v)
            alpha_nu = plus(alpha_nu, theta_v)
            t += n
        rails[major] = any_negative(flags)
        if rails[major]:
            flags = zero((0,))
            for s in range(t - n * M, t):
                flags = outside(flags, row(counts, s), row(limits, 2), row(limits, 3))
            if any_negative(flags):
                return major
        put_left(results, major, 0, alpha_nu, like)
        put_left(results, major, 3, within, like)
        put_right(results, major, 9, alpha_nu, like)
        put_right(results, major, 12, within, like)
        if M > 1:
            put_left(results, major, 6, between, like)
            put_right(results, major, 15, between, like)
    return len(results)


def _position_of(counts, first, N, sum_like, like, results):  # type: ignore[no-untyped-def]
    t = first
    for major in range(len(results)):
        scrolling = zero(like)
        sums, doubly = zero(sum_like), zero(sum_like)  # alpha and nu; S over 12
        b = row(counts, t - 1)
        for m in range(N):
            d = row(counts, t + m)
            r = N - 1 - m
            more = np.int64(r > 0)
            P_Q = zero(sum_like)
            P_Q = add_scaled(P_Q, sums, 2880 * r + 780 + 300 * more, 1440 * r + 1020 + 60 * more)
            P_Q = add_scaled(P_Q, b, 360 * r + 102, 360 * r + 78)
            P_Q = add_scaled(P_Q, d, 720 * r - 42 + 240 * more, 0)
            P_Q = add_scaled(P_Q, doubly, -60, 60)
            scrolling = add_crossed_over(scrolling, P_Q, d)
            scrolling = add_crossed_over(scrolling, add_scaled(zero((0,)), b, 18, 0), b)
            doubly = plus(add_scaled(add_scaled(doubly, sums, 12, 12), d, 5, 5), b)
            sums = plus(sums, d)
            b = d
        t += N
        put_left(results, major, 18, doubly, like)
        put_right(results, major, 21, doubly, like)
        put_left(results, major, 24, halves_added(scrolling), like)


_vectors = compiled(_vectors_of, lanes, nogil=True)
_position = compiled(_position_of, lanes, nogil=True)
