"""`time-taylor`: a polynomial rate through the samples (Savage-20 method 1)."""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache

from sculler_model.algorithms.pairs import (
    Elimination,
    Pair,
    manoeuvre_terms,
    pair_products,
    power_increment,
    sample_pairs,
    tap_table,
    true_term,
)
from sculler_model.algorithms.tap_table import TapTable, solve_exactly
from sculler_model.errors import InputError

MAX_FOLDED = 16
"""Largest n + p with p >= 2, where the pairs must be solved for instead of written down."""


@lru_cache(maxsize=64)
def time_taylor(samples: int, history: int) -> TapTable:
    """½ ∫ α × ω of the polynomial rate whose integrals are the n + p increments.

    With p <= 1 this is `polynomial_fit` itself.  With p >= 2 the fit also names pairs that lie
    wholly in the previous interval, which no tap row can form at their own time; the pairs there
    are then match the terms g_a × g_b, b < n + p, in order of a + b instead
    (docs/explanation/families.md Eq. 6): the order of the error in manoeuvres and in
    coning stays that of the fit.

    Raises:
        InputError: n + p < 2 leaves no product; n + p > 12 with p >= 2.
    """
    points = samples + history
    if points < 2:
        raise InputError(
            "algorithm.samples + algorithm.history: 1 sample gives no cross product for"
            " time-taylor, give samples + history >= 2"
        )
    if history <= 1:
        return tap_table(samples, polynomial_fit(samples, history))
    if points > MAX_FOLDED:
        raise InputError(
            f"algorithm.samples + algorithm.history: {points} is too large for time-taylor with"
            f" history >= 2, give a sum up to {MAX_FOLDED}, or history 0 or 1"
        )
    pairs = sample_pairs(samples, history)
    system = Elimination(len(pairs))
    for term in manoeuvre_terms(points - 1):
        if not system.free:
            break
        system.add(pair_products(samples, pairs, term), true_term(samples, term))
    return tap_table(samples, dict(zip(pairs, system.solution(), strict=True)))


def polynomial_fit(samples: int, history: int) -> dict[Pair, Fraction]:
    """c_ij of the polynomial through n + p increments, pairs of the previous interval included.

    With s_i = Σ_a V_ia g_a, the correction Σ_{a<b} t_ab g_a × g_b is (P1) with
    c = V⁻ᵀ t V⁻¹, t antisymmetric.
    """
    points = samples + history
    numbers = range(1 - history, samples + 1)
    V = [[power_increment(samples, i, a) for a in range(points)] for i in numbers]
    unit = [[Fraction(int(i == j)) for i in range(points)] for j in range(points)]
    inverse = [solve_exactly(V, column) for column in unit]  # inverse[i][a]: g_a per s_i
    t = [[Fraction(0)] * points for _ in range(points)]
    for a, b in manoeuvre_terms(points - 1):
        t[a][b] = true_term(samples, (a, b))
        t[b][a] = -t[a][b]
    left = [
        [sum((g[a] * t[a][b] for a in range(points)), Fraction(0)) for b in range(points)]
        for g in inverse
    ]
    return {
        (i, j): sum((x * y for x, y in zip(left[row], inverse[col], strict=True)), Fraction(0))
        for col, j in enumerate(numbers)
        for row, i in enumerate(numbers)
        if i < j
    }
