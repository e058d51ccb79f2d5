"""Third and fourth order compiled by Numba: the page of `algorithms.higher_order`.

A dual vector is a `Six` of `lanes`, and `add_crossed` its product.  Where totals have several
limbs, factors are kept whole, in groups of one number of limbs each: sums of angles (`sum_like`),
numbers of second order (`low_like`), of third (`high_like`), and products of fourth order before
their factors (`top_like`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sculler_model.design import Design, DualRange, Interval
from sculler_model.fast import lanes
from sculler_model.fast.lanes import (
    TAP_BITS,
    add_crossed,
    add_scaled,
    append_digit,
    plus,
    put_left,
    put_right,
    row,
    weighted,
    zero,
)
from sculler_model.machine_code import compiled

Like = tuple[int, ...]
Terms = Callable[[Iterable[tuple[int, int]], int], tuple[NDArray[np.int64], int]]

_LOW = ("kappa", "c", "m", "slope", "f", "theta_c", "theta_m", "theta_f", "P", "b", "k")
_HIGH = ("tau", "theta_theta_f", "X", "p", "q", "g", "h", "third")
_TOP = ("sigma", "outer", "pairs")


def arguments(
    design: Design, like: Callable[..., Like], terms: Terms, limbs: int
) -> tuple[Any, ...]:
    """What `higher` takes after the counts and the first row.

    Args:
        design: of third or fourth order.
        like: zeros, as many as limbs of factors of these ranges.
        terms: distances and coefficients in digits, see `kernel`.
        limbs: of results.
    """
    words, taps, c = design.words, design.composition.taps, design.composition
    higher = words.higher
    assert higher is not None

    def ranges(names: Sequence[str]) -> list[Interval]:
        found: list[DualRange] = [getattr(higher, name) for name in names]
        return [each for dual in found for each in dual]

    sums = like(words.alpha, words.nu, words.theta, words.v)
    low = like(*ranges(_LOW), words.coning_within, words.sculling_within, words.coning_between,
               words.sculling_between)  # fmt: skip
    tap_like = like(words.gyro_taps, words.accel_taps)
    rows = [[(d, c) for d, c in enumerate(r, start=1) if c] for r in design.table.taps]
    phases = [k for k, r in enumerate(rows) if r]
    stops = np.cumsum([len(rows[k]) for k in phases], dtype=np.int64)
    inner = [taps.curvature, taps.partner, taps.slope, taps.fourth]
    t, f, Dc = c.third_triple, c.third_composed, c.within
    factors = [6, 3 * Dc, Dc, t, f, 6 * t, 2 * f, -2 * f * Dc, f * Dc]
    factors += [c.fourth_inner, c.fourth_outer, c.fourth_pairs]
    return (
        design.table.samples,
        design.algorithm.minors,
        design.order,
        np.column_stack([np.array(phases, np.int64), stops]),
        *terms((term for r in rows for term in r), len(tap_like)),
        *terms(((d, w) for r in inner for d, w in enumerate(r)), len(low)),
        _digits_of(factors, limbs),
        tap_like,
        sums,
        low,
        like(*ranges(_HIGH)),
        like(*ranges(_TOP)),
        (0,) * limbs,
    )


def _digits_of(factors: Sequence[int], limbs: int) -> NDArray[np.int64]:
    """(F, D) each factor in digits of TAP_BITS, the highest first; whole with one limb."""
    widest = max(abs(factor).bit_length() for factor in factors) + 1
    digits = 1 if limbs == 1 else -(-widest // TAP_BITS)
    found = np.zeros((len(factors), digits), np.int64)
    for i, factor in enumerate(factors):
        for j in range(digits):
            digit = factor >> TAP_BITS * (digits - 1 - j)
            found[i, j] = digit if j == 0 else digit & (1 << TAP_BITS) - 1
    return found


_inlined: Any = njit(inline="always")


@_inlined
def _scaled(like, x, factors, i):  # type: ignore[no-untyped-def]
    """Factor i times x."""
    total = zero(like)
    for j in range(factors.shape[1]):
        digit = factors[i, j]
        total = append_digit(total, add_scaled(zero(like), x, digit, digit))
    return total


@_inlined
def _crossed(like, a, b):  # type: ignore[no-untyped-def]
    return add_crossed(zero(like), a, b)


@_inlined
def _outer(high_like, top_like, alpha, theta, P, X, tau, third, factors):  # type: ignore[no-untyped-def]
    """g × theta + alpha × h."""
    p, q = _crossed(high_like, P, theta), _crossed(high_like, alpha, P)
    X2 = _scaled(high_like, X, factors, 6)
    g = plus(_scaled(high_like, third, factors, 0), X2)
    g = plus(g, _scaled(high_like, p, factors, 7))
    g = plus(g, _scaled(high_like, q, factors, 8))
    h = plus(_scaled(high_like, tau, factors, 5), X2)
    h = plus(h, _scaled(high_like, q, factors, 7))
    h = plus(h, _scaled(high_like, p, factors, 8))
    return add_crossed(_crossed(top_like, g, theta), alpha, h)


def _higher_of(  # type: ignore[no-untyped-def]
    counts, first, n, M, order, phases, taps, tap_digits, inner, inner_digits, factors,
    tap_like, sum_like, low_like, high_like, top_like, like, results,
):  # fmt: skip
    t = first
    for major in range(len(results)):
        alpha, within, between = zero(sum_like), zero(low_like), zero(low_like)
        third, fourth = zero(high_like), zero(like)
        for _minor in range(M):
            theta, kappa = zero(sum_like), zero(low_like)
            for s in range(t, t + n):
                theta = plus(theta, row(counts, s))
            start = 0
            for phase in range(len(phases)):
                s, stop = t + phases[phase, 0], phases[phase, 1]
                A_B = weighted(tap_like, taps, tap_digits, start, stop, counts, s)
                kappa = add_crossed(kappa, A_B, row(counts, s))
                start = stop
            last = t + n - 1
            c = weighted(low_like, inner, inner_digits, 0, n, counts, last)
            m = weighted(low_like, inner, inner_digits, n, 2 * n, counts, last)
            slope = weighted(low_like, inner, inner_digits, 2 * n, 3 * n, counts, last)
            tau = _crossed(high_like, theta, _crossed(low_like, theta, c))
            tau = add_crossed(tau, slope, _crossed(low_like, theta, m))
            P = _crossed(low_like, alpha, theta)
            b = plus(_scaled(low_like, within, factors, 0), _scaled(low_like, between, factors, 1))
            Dc_P = _scaled(low_like, P, factors, 2)
            b = plus(b, Dc_P)
            k = plus(_scaled(low_like, kappa, factors, 0), Dc_P)
            X = add_crossed(_crossed(high_like, b, theta), alpha, k)
            if order > 3:
                f = weighted(low_like, inner, inner_digits, 3 * n, 4 * n, counts, last)
                twice = _crossed(high_like, theta, _crossed(low_like, theta, f))
                sigma = _crossed(top_like, theta, twice)
                outer = _outer(high_like, top_like, alpha, theta, P, X, tau, third, factors)
                fourth = plus(fourth, _scaled(like, sigma, factors, 9))
                fourth = plus(fourth, _scaled(like, outer, factors, 10))
                fourth = plus(fourth, _scaled(like, _crossed(top_like, b, k), factors, 11))
            third = plus(third, _scaled(high_like, tau, factors, 3))
            third = plus(third, _scaled(high_like, X, factors, 4))
            alpha, within, between = plus(alpha, theta), plus(within, kappa), plus(between, P)
            t += n
        put_left(results, major, 18, third, like)
        put_right(results, major, 21, third, like)
        if order > 3:
            put_left(results, major, 24, fourth, like)
            put_right(results, major, 27, fourth, like)


higher: Any = compiled(_higher_of, lanes, nogil=True)
