"""Pair coefficients c_ij and the tap table that carries them.

Savage-20 Eq. 5 writes the correction of a minor interval over all pairs of samples,

    δφ = Σ_{i<j} c_ij s_i × s_j                                                             (P1)

with the samples 1..n of this interval and 0, -1, ..., 1-p of the one before.  A tap row k holds the
products with the newest sample s_k, so ``tap[k][d] = c_(k-d),k``: it can hold every pair whose
later sample is in this interval, j >= 1, and no other.  `sample_pairs` are those pairs.

Manoeuvres are polynomial rates ω = Σ_a g_a τ^a, τ in samples from the middle of the minor interval.
The correction is then Σ_{a<b} (...) g_a × g_b, and `ManoeuvreTerm` names a term by (a, b).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from functools import lru_cache
from math import gcd, lcm

from sculler_model.algorithms.series import Series
from sculler_model.algorithms.tap_table import TapTable

Pair = tuple[int, int]
"""(i, j), i < j: sample numbers, 1..n in this interval, 0, -1, ... before it."""

ManoeuvreTerm = tuple[int, int]
"""(a, b), a < b: the cross product g_a × g_b of polynomial rate coefficients."""


def sample_pairs(samples: int, history: int) -> list[Pair]:
    """All pairs that a tap row can hold at their own time."""
    return [(i, j) for j in range(1, samples + 1) for i in range(1 - history, j)]


def pair_coefficients(table: TapTable) -> dict[Pair, Fraction]:
    """c_ij of the non-zero taps."""
    return {
        (k - d, k): Fraction(tap, table.denominator)
        for k, row in enumerate(table.taps, start=1)
        for d, tap in enumerate(row, start=1)
        if tap
    }


def tap_table(samples: int, coefficients: Mapping[Pair, Fraction]) -> TapTable:
    """The table of angle increments with these pair coefficients.

    Raises:
        ValueError: a pair's later sample is not in 1..n.
    """
    rows: list[list[Fraction]] = [[] for _ in range(samples)]
    reach = max(j - i for i, j in coefficients)
    for (i, j), c in coefficients.items():
        if not 1 <= j <= samples:
            raise ValueError(f"pair {i}, {j} has no row of its own in 1..{samples}")
        row = rows[j - 1]
        row.extend([Fraction(0)] * (reach - len(row)))
        row[j - i - 1] = c
    return TapTable.from_rationals(rows, [Fraction(1)] * samples)


def distance_sums(table: TapTable) -> list[Fraction]:
    """K_d = Σ_k tap[k, d], d = 1..reach: all that classical coning sees of a table (Yang Eq. 8)."""
    return [Fraction(sum(column), table.denominator) for column in zip(*table.taps, strict=True)]


def manoeuvre_terms(largest_power: int | None = None) -> Iterator[ManoeuvreTerm]:
    """(a, b) in order of a + b, then of a; without end, or with b up to `largest_power`."""
    order = 1
    while largest_power is None or order < 2 * largest_power:
        for a in range((order + 1) // 2):
            if largest_power is None or order - a <= largest_power:
                yield a, order - a
        order += 1


@lru_cache(maxsize=4096)
def power_increment(samples: int, i: int, a: int) -> Fraction:
    """s_i of the rate τ^a: the integral over sample i, from i-1 to i, of (t - n/2)^a."""
    middle = Fraction(samples, 2)
    return ((i - middle) ** (a + 1) - (i - 1 - middle) ** (a + 1)) / (a + 1)


def pair_products(samples: int, pairs: Sequence[Pair], term: ManoeuvreTerm) -> list[Fraction]:
    """Coefficient of g_a × g_b in s_i × s_j, for each pair."""
    a, b = term
    needed = {i for pair in pairs for i in pair}
    of_a = {i: power_increment(samples, i, a) for i in needed}
    of_b = {i: power_increment(samples, i, b) for i in needed}
    return [of_a[i] * of_b[j] - of_b[i] * of_a[j] for i, j in pairs]


def true_term(samples: int, term: ManoeuvreTerm, inverse_power: Series | None = None) -> Fraction:
    """Coefficient of g_a × g_b in the true correction of a minor interval.

    Without a filter that is ½ ∫ α × ω, α the angle since the interval's start:

        ½ ∫_{-n/2}^{n/2} (A_a(τ) τ^b - A_b(τ) τ^a) dτ,   A_a(τ) = (τ^{a+1} - (-n/2)^{a+1})/(a+1)

    With samples that passed F, the rate seen is x, the true one is F⁻¹x.  Its correction is, up to
    terms that cancel between one interval and the next (docs/explanation/families.md Eq. 14),

        ½ ∫ α_x × x dτ + ½ Σ_{k>=1} (-1)^k e_k ∫ (D^(2k-1) x) × x dτ,    1/|F|² = Σ e_k λ^(2k)

    Args:
        samples: n.
        term: (a, b).
        inverse_power: e_0, e_1, ..., at least (b + 3)/2 of them; None for F = 1.
    """
    a, b = term
    half = Fraction(samples, 2)

    def integral(power: int) -> Fraction:
        """Of τ^power over the interval."""
        return (half ** (power + 1) - (-half) ** (power + 1)) / (power + 1)

    def angle(power: int, other: int) -> Fraction:
        """∫ A_power τ^other."""
        start = (-half) ** (power + 1)
        return (integral(power + 1 + other) - start * integral(other)) / (power + 1)

    total = (angle(a, b) - angle(b, a)) / 2
    for k, e in enumerate(inverse_power or ()):
        order = 2 * k - 1
        if k:
            slope = _falling(a, order) - _falling(b, order)
            if slope:
                total += Fraction((-1) ** k, 2) * e * slope * integral(a + b - order)
    return total


def _falling(power: int, order: int) -> int:
    """D^order τ^power = falling · τ^(power-order)."""
    product = 1
    for factor in range(power, power - order, -1):
        product *= factor
    return product if order <= power else 0


def manoeuvre_error(
    table: TapTable, term: ManoeuvreTerm, inverse_power: Series | None = None
) -> Fraction:
    """Computed minus true coefficient of g_a × g_b over one minor interval, exact.

    The rate is Σ g_a τ^a, τ in samples from the middle of the interval, so that ``g_a`` has the
    unit rad/sample^(a+1) and the result is a pure number.
    """
    coefficients = pair_coefficients(table)
    products = pair_products(table.samples, list(coefficients), term)
    computed = sum(
        (c * x for c, x in zip(coefficients.values(), products, strict=True)), Fraction()
    )
    return computed - true_term(table.samples, term, inverse_power)


def first_manoeuvre_error(
    table: TapTable, inverse_power: Series | None = None, highest_order: int = 64
) -> tuple[int, dict[ManoeuvreTerm, Fraction]]:
    """The lowest order a + b at which a table errs, and its errors there.

    Raises:
        ValueError: it errs nowhere up to `highest_order`.
    """
    for order in range(1, highest_order + 1):
        terms = [(a, order - a) for a in range((order + 1) // 2)]
        errors = {term: manoeuvre_error(table, term, inverse_power) for term in terms}
        left = {term: error for term, error in errors.items() if error}
        if left:
            return order, left
    raise ValueError(f"no manoeuvre term is left up to order {highest_order}")


class Elimination:
    """Linear equations taken one after another, each as far as the earlier ones leave it free.

    This is lexicographic matching: an equation that the earlier ones already decide, for or
    against, changes nothing.  Rows are integers without a common factor, so all is exact.
    """

    def __init__(self, unknowns: int) -> None:
        self.unknowns = unknowns
        self._rows: list[tuple[int, list[int]]] = []  # (pivot column, row | right side)

    @property
    def free(self) -> int:
        """Unknowns not yet decided."""
        return self.unknowns - len(self._rows)

    def add(self, row: Sequence[Fraction], right: Fraction) -> bool:
        """Take an equation; False if earlier ones decided it already."""
        entries = [*row, right]
        scale = lcm(*(entry.denominator for entry in entries))
        reduced = [int(entry * scale) for entry in entries]
        for pivot, known in self._rows:
            factor = reduced[pivot]
            if factor:
                head = known[pivot]
                common = gcd(factor, head)
                factor, head = factor // common, head // common
                reduced = [head * x - factor * y for x, y in zip(reduced, known, strict=True)]
        column = next((c for c in range(self.unknowns) if reduced[c]), None)
        if column is None:
            return False
        common = gcd(*reduced)
        self._rows.append((column, [x // common for x in reduced]))
        return True

    def solution(self) -> list[Fraction]:
        """The unknowns.

        Raises:
            ValueError: some are still free.
        """
        if self.free:
            raise ValueError(f"{self.free} unknowns are free")
        values = [Fraction(0)] * self.unknowns
        for pivot, row in reversed(self._rows):
            # an earlier row may name the pivots of later ones, never the other way round
            known = sum(
                (c * values[i] for i, c in enumerate(row[:-1]) if c and i != pivot), Fraction(0)
            )
            values[pivot] = (row[-1] - known) / row[pivot]
        return values
