"""Triple and quadruple products inside one minor interval, as exact rationals.

From the samples s_1 .. s_n of a minor interval alone, with θ their sum (docs/explanation/
higher-order.md),

    τ = θ×(θ×c) + l×(θ×m)          third order       l, m, c: weighted sums of the samples
    ς = θ×(θ×(θ×f))                fourth order      f: likewise

l is the slope of a straight line through the samples.  The weights of m and f are antisymmetric
about the interval's middle, those of c symmetric with the sum 0, so that τ and ς change under a
reversal of time as the true terms do.  They are matched to

- manoeuvres: a rate g_0 + g_1 t + g_2 t² about the middle, all terms of T⁵ (time-Taylor);
- coning about an axis that turns at a steady rate (τ), and coning alone (ς), one power of λ²
  further, λ = ΩT (frequency-Taylor), where there are weights enough for it: n >= 4.

n = 2 has no c, so that g_0×(g_0×g_2) is left; n = 1 has nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from math import factorial, lcm

from sculler_model.algorithms.pairs import power_increment
from sculler_model.algorithms.tap_table import solve_exactly

CONING_IN_A_TURN = Fraction(1, 3780)
"""Of λ⁴ in the mean third-order term of the rate (cos Ωt, sin Ωt, 1)/T: -λ²/180 + λ⁴/3780 - ..."""

CONING = Fraction(-11, 30240)
"""Of λ³ in the mean fourth-order term of (cos Ωt, sin Ωt, 0)/T: λ/720 - 11 λ³/30240 + ..."""


@dataclass(frozen=True)
class TripleTaps:
    """Integer weights of l, m, c and f; weight d is that of the sample d samples back, d < n.

    Attributes:
        slope: of l, over 1.
        partner, curvature: of m and c, over `third_denominator`.
        fourth: of f, over `fourth_denominator`.
        third_denominator, fourth_denominator: of τ and of ς.
    """

    slope: tuple[int, ...]
    partner: tuple[int, ...]
    curvature: tuple[int, ...]
    fourth: tuple[int, ...]
    third_denominator: int
    fourth_denominator: int

    @property
    def third_is_zero(self) -> bool:
        """Whether there is no τ and no ς: a single sample."""
        return not any(self.slope)


@lru_cache(maxsize=32)
def triple_taps(samples: int) -> TripleTaps:
    """The weights for n samples.

    Args:
        samples: n, 1 or more.
    """
    n = samples
    place = [Fraction(2 * i - n - 1) for i in range(1, n + 1)]  # of sample i, in half samples
    if n == 1:
        return TripleTaps((0,), (0,), (0,), (0,), 1, 1)
    antisymmetric = [place, [p**3 for p in place]][: 1 if n < 4 else 2]
    mean = sum((p * p for p in place), Fraction(0)) / n
    symmetric = [p * p - mean for p in place]

    curvature = [Fraction(0)] * n
    if n > 2:
        curvature = _scaled(Fraction(1, 360) / _moment(symmetric, 2), symmetric)
    # l × (θ × m):  -g_1×(g_0×g_1)/240, and the mean of coning in a turn
    rows, right = [[_moment(b, 1) for b in antisymmetric]], [Fraction(-1, 240) / _moment(place, 1)]
    if n >= 4:
        rows.append([_product(_sine(place), _sine(b))[1] for b in antisymmetric])
        known = _product(_cosine([Fraction(1)] * n), _cosine(curvature))[2]
        right.append(CONING_IN_A_TURN - known)
    partner = _combination(antisymmetric, solve_exactly(rows, right))
    # θ × (θ × (θ × f)):  -g_0×(g_0×(g_0×g_1))/720, and the mean of coning
    rows, right = [[_moment(b, 1) for b in antisymmetric]], [Fraction(-1, 720)]
    if n >= 4:
        theta = _cosine([Fraction(1)] * n)
        cube = _product(theta, _product(theta, theta))
        rows.append([-_product(cube, _sine(b))[1] for b in antisymmetric])
        right.append(CONING)
    fourth = _combination(antisymmetric, solve_exactly(rows, right))

    third_denominator = lcm(*(w.denominator for w in [*partner, *curvature]))
    fourth_denominator = lcm(*(w.denominator for w in fourth))
    return TripleTaps(
        _integers(place, 1),
        _integers(partner, third_denominator),
        _integers(curvature, third_denominator),
        _integers(fourth, fourth_denominator),
        third_denominator,
        fourth_denominator,
    )


def _moment(weights: Sequence[Fraction], power: int) -> Fraction:
    """The weighted sum of the samples of the rate t^power, t in minor intervals from the middle."""
    n = len(weights)
    increments = (power_increment(n, i, power) for i in range(1, n + 1))
    total = sum((w * s for w, s in zip(weights, increments, strict=True)), Fraction(0))
    return total / Fraction(n) ** (power + 1)


def _cosine(weights: Sequence[Fraction]) -> list[Fraction]:
    """The weighted sum of the samples of cos(λt): the coefficients of λ⁰, λ², λ⁴."""
    return [Fraction((-1) ** i, factorial(2 * i)) * _moment(weights, 2 * i) for i in range(3)]


def _sine(weights: Sequence[Fraction]) -> list[Fraction]:
    """Of sin(λt): the coefficients of λ, λ³, λ⁵."""
    return [
        Fraction((-1) ** i, factorial(2 * i + 1)) * _moment(weights, 2 * i + 1) for i in range(3)
    ]


def _product(a: Sequence[Fraction], b: Sequence[Fraction]) -> list[Fraction]:
    """Of two series in λ²."""
    return [sum((a[j] * b[i - j] for j in range(i + 1)), Fraction(0)) for i in range(len(a))]


def _scaled(factor: Fraction, weights: Sequence[Fraction]) -> list[Fraction]:
    return [factor * w for w in weights]


def _combination(
    vectors: Sequence[Sequence[Fraction]], factors: Sequence[Fraction]
) -> list[Fraction]:
    columns = zip(*vectors, strict=True)
    return [
        sum((f * w for f, w in zip(factors, column, strict=True)), Fraction(0))
        for column in columns
    ]


def _integers(weights: Sequence[Fraction], denominator: int) -> tuple[int, ...]:
    """Numerators, the newest sample's first."""
    return tuple(int(w * denominator) for w in reversed(weights))
