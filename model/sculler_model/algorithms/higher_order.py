"""Third and fourth order of the rotation vector and of velocity, in exact integers.

Rotations of consecutive minor intervals compose by the formula of Baker, Campbell and Hausdorff;
for a rate in body axes its bracket is the cross product.  With α, β, γ, δ the orders 1 to 4 of
the rotation vector since the major interval's start, θ, κ, τ, ς those of a minor interval,

    P  = α×θ        b = β + P/6        k = κ + P/6
    γ += τ + ½ (b×θ + α×k)
    δ += ς + ½ (b×k + g×θ + α×h)
    g  = γ + X/3 - (P×θ - ½ α×P)/36                                       γ before it grows
    h  = τ + X/3 - (α×P - ½ P×θ)/36,      X = ½ (b×θ + α×k)

which docs/explanation/higher-order.md derives.  Everything is a sum of products of integers over
one denominator for each order.  Each letter stands for a dual vector, an angle and a velocity, so
the same lines are sculling.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import lcm

from sculler_model.algorithms.dual_vectors import (
    DUAL_ZERO,
    Dual,
    dual_cross,
    dual_sum,
    dual_times,
)
from sculler_model.algorithms.tap_table import TapTable
from sculler_model.algorithms.triples import TripleTaps, triple_taps

ORDERS = (2, 3, 4)
"""That the rotation vector and the velocity may be formed to."""


@dataclass(frozen=True)
class Composition:
    """What the integers of third and fourth order stand over, and the factors to bring them there.

    Attributes:
        taps: the weights inside a minor interval.
        within: Dc, of the tap table.
        third, fourth: D3 and D4, of the results of third and of fourth order.
        third_triple, third_composed: of τ and of 12 Dc X in γ, t and f.
        fourth_inner, fourth_outer, fourth_pairs: of ς, of g×θ + α×h and of b×k in δ: u, y and e.
    """

    taps: TripleTaps
    within: int
    third: int
    fourth: int
    third_triple: int
    third_composed: int
    fourth_inner: int
    fourth_outer: int
    fourth_pairs: int


@lru_cache(maxsize=64)
def composition(table: TapTable) -> Composition:
    """Denominators and factors of a table whose samples count once each (`Dw` = 1).

    Args:
        table: the tap table.
    """
    taps, Dc = triple_taps(table.samples), table.denominator
    D3 = lcm(12 * Dc, taps.third_denominator)
    D4 = lcm(12 * D3, 72 * Dc * Dc, taps.fourth_denominator)
    return Composition(
        taps=taps,
        within=Dc,
        third=D3,
        fourth=D4,
        third_triple=D3 // taps.third_denominator,
        third_composed=D3 // (12 * Dc),
        fourth_inner=D4 // taps.fourth_denominator,
        fourth_outer=D4 // (12 * D3),
        fourth_pairs=D4 // (72 * Dc * Dc),
    )


class HigherOrder:
    """γ and δ since the start of the major interval, minor interval by minor interval.

    Args:
        table: the tap table.
        order: 3, or 4.

    Attributes:
        third: over `Composition.third`, counts³.
        fourth: over `Composition.fourth`, counts⁴; zero with order 3.
    """

    def __init__(self, table: TapTable, order: int) -> None:
        self.composition = composition(table)
        self.order = order
        self.clear()

    def clear(self) -> None:
        """Begin a major interval."""
        self.third = self.fourth = DUAL_ZERO

    def step(
        self,
        samples: Sequence[Dual],
        alpha: Dual,
        within: Dual,
        between: Dual,
        kappa: Dual,
    ) -> None:
        """Take a minor interval.

        Args:
            samples: its n samples (gyro, accelerometer counts), the oldest first.
            alpha, within, between: the sums of the major interval BEFORE this minor interval:
                alpha and nu, coning_within and sculling_within, and those between.
            kappa: what this minor interval adds to the sums within.
        """
        c, Dc = self.composition, self.composition.within
        theta = dual_sum(*samples)
        P = dual_cross(alpha, theta)
        # b and k over 6 Dc, X over 12 Dc
        b = dual_sum(dual_times(6, within), dual_times(3 * Dc, between), dual_times(Dc, P))
        k = dual_sum(dual_times(6, kappa), dual_times(Dc, P))
        X = dual_sum(dual_cross(b, theta), dual_cross(alpha, k))
        tau = self._tau(samples, theta)
        if self.order > 3:
            f, t = c.third_composed, c.third_triple
            # g and h over 6 D3
            p, q = dual_cross(P, theta), dual_cross(alpha, P)
            g = dual_sum(
                dual_times(6, self.third),
                dual_times(2 * f, X),
                dual_times(-2 * f * Dc, p),
                dual_times(f * Dc, q),
            )
            h = dual_sum(
                dual_times(6 * t, tau),
                dual_times(2 * f, X),
                dual_times(f * Dc, p),
                dual_times(-2 * f * Dc, q),
            )
            outer = dual_sum(dual_cross(g, theta), dual_cross(alpha, h))
            self.fourth = dual_sum(
                self.fourth,
                dual_times(c.fourth_inner, self._sigma(samples, theta)),
                dual_times(c.fourth_outer, outer),
                dual_times(c.fourth_pairs, dual_cross(b, k)),
            )
        self.third = dual_sum(
            self.third, dual_times(c.third_triple, tau), dual_times(c.third_composed, X)
        )

    def _tau(self, samples: Sequence[Dual], theta: Dual) -> Dual:
        """θ×(θ×c) + l×(θ×m)."""
        taps = self.composition.taps
        c, m = _weighted(taps.curvature, samples), _weighted(taps.partner, samples)
        slope = _weighted(taps.slope, samples)
        return dual_sum(
            dual_cross(theta, dual_cross(theta, c)), dual_cross(slope, dual_cross(theta, m))
        )

    def _sigma(self, samples: Sequence[Dual], theta: Dual) -> Dual:
        """θ×(θ×(θ×f))."""
        f = _weighted(self.composition.taps.fourth, samples)
        return dual_cross(theta, dual_cross(theta, dual_cross(theta, f)))


def _weighted(weights: Sequence[int], samples: Sequence[Dual]) -> Dual:
    """The sum of weight d times the sample d samples back."""
    return dual_sum(*(dual_times(w, s) for w, s in zip(weights, reversed(samples), strict=True)))
