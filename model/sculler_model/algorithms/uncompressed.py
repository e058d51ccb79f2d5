"""`uncompressed`: a compressed table's coning response, with accuracy in manoeuvres (Song)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

from sculler_model.algorithms.pairs import (
    Elimination,
    ManoeuvreTerm,
    distance_sums,
    first_manoeuvre_error,
    manoeuvre_error,
    manoeuvre_terms,
    pair_products,
    sample_pairs,
    tap_table,
    true_term,
)
from sculler_model.algorithms.series import Series
from sculler_model.algorithms.tap_table import TapTable, frequency_taylor
from sculler_model.errors import InputError

MAX_POINTS = 16
"""Largest n + p."""


@dataclass(frozen=True)
class Uncompressed:
    """An uncompressed table and what became of the manoeuvre terms g_a × g_b.

    Attributes:
        table: the dense tap table.
        vanishing: terms (a, b) whose error is zero, of all orders a + b up to `order`.
        order: the lowest a + b at which an error is left.
        left: the errors of that order, computed minus true, τ in samples from the middle.
    """

    table: TapTable
    vanishing: tuple[ManoeuvreTerm, ...]
    order: int
    left: dict[ManoeuvreTerm, Fraction]


def uncompress(
    sums: Sequence[Fraction],
    samples: int,
    history: int,
    inverse_power: Series | None = None,
) -> Uncompressed:
    """Spread distance sums K_d over all pairs, the freedom spent on manoeuvres.

    The sums Σ_{j-i=d} c_ij = K_d are kept exactly, so coning is as it was; then the terms g_a × g_b
    are matched in order of a + b, and at one order in order of a, each as far as the ones before
    leave it free.  The solution is unique.

    Args:
        sums: K_1..K_(n+p-1).
        samples, history: n and p; pairs reach p samples back, before the interval.
        inverse_power: series of 1/|F|² if the table is tuned to a filter F (see `true_term`).

    Raises:
        InputError: n + p > 16, or the sums do not fit n and p.
    """
    points = samples + history
    if points > MAX_POINTS:
        raise InputError(
            f"algorithm.samples + algorithm.history: {points} is too large for uncompressed,"
            f" give a sum up to {MAX_POINTS}"
        )
    if len(sums) != points - 1:
        raise InputError(
            f"uncompressed: {len(sums)} distance sums for samples + history = {points}, give"
            f" {points - 1}"
        )
    pairs = sample_pairs(samples, history)
    system = Elimination(len(pairs))
    for distance, total in enumerate(sums, start=1):
        system.add([Fraction(int(j - i == distance)) for i, j in pairs], total)
    for term in manoeuvre_terms():
        if not system.free:
            break
        products = pair_products(samples, pairs, term)
        system.add(products, true_term(samples, term, inverse_power))
    table = tap_table(samples, dict(zip(pairs, system.solution(), strict=True)))
    order, left = first_manoeuvre_error(table, inverse_power)
    vanishing = tuple(
        (a, b)
        for total in range(1, order + 1)
        for a in range((total + 1) // 2)
        for b in [total - a]
        if not manoeuvre_error(table, (a, b), inverse_power)
    )
    return Uncompressed(table, vanishing, order, left)


@lru_cache(maxsize=64)
def uncompressed(samples: int, history: int) -> TapTable:
    """The frequency-taylor table, uncompressed (Savage-20 method 4).

    Raises:
        InputError: n + p < 2 or n + p > 16.
    """
    if samples + history < 2:
        raise InputError(
            "algorithm.samples + algorithm.history: 1 sample gives no cross product for"
            " uncompressed, give samples + history >= 2"
        )
    return uncompress(distance_sums(frequency_taylor(samples, history)), samples, history).table
