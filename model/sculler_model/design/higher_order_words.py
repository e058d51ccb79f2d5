"""Worst-case ranges of the terms of third and fourth order (`algorithms.higher_order`).

The page is evaluated once for each minor interval with ranges in place of numbers: exact interval
arithmetic over all input sequences, as `word_lengths` does for the rest.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from sculler_model.algorithms import TapTable, composition
from sculler_model.design.interval import (
    ZERO_RANGE,
    Interval,
    cross_range,
    range_of_sum,
)


class DualRange(NamedTuple):
    """Ranges of the components of a dual vector."""

    angle: Interval
    velocity: Interval

    def cross(self, other: DualRange) -> DualRange:
        """Of a dual cross product."""
        return DualRange(
            cross_range(self.angle, other.angle),
            cross_range(self.angle, other.velocity) + cross_range(self.velocity, other.angle),
        )

    def scaled(self, factor: int) -> DualRange:
        """Of a multiple of one dual vector."""
        return DualRange(self.angle.scaled(factor), self.velocity.scaled(factor))

    def repeated(self, count: int) -> DualRange:
        """Of a sum of so many."""
        return DualRange(self.angle.repeated(count), self.velocity.repeated(count))

    def joined(self, other: DualRange) -> DualRange:
        """The smallest that holds both."""
        return DualRange(self.angle | other.angle, self.velocity | other.velocity)


ZERO_DUAL = DualRange(ZERO_RANGE, ZERO_RANGE)


def dual_range_of_sum(*ranges: DualRange) -> DualRange:
    """Of a sum of independent dual vectors."""
    return DualRange(
        range_of_sum(each.angle for each in ranges), range_of_sum(each.velocity for each in ranges)
    )


@dataclass(frozen=True)
class HigherOrderWords:
    """Ranges of what `HigherOrder` forms, by its letters; those of order 4 are zero with order 3.

    Attributes:
        kappa: the products within of one minor interval.
        c, m, slope, f: the weighted sums of samples.
        theta_c, theta_m, tau: θ×c, θ×m and τ.
        theta_f, theta_theta_f, sigma: θ×f, θ×(θ×f) and ς.
        P, b, k, X, p, q, g, h, outer, pairs: of the composition.
        third, fourth: the results.
    """

    kappa: DualRange
    c: DualRange
    m: DualRange
    slope: DualRange
    theta_c: DualRange
    theta_m: DualRange
    tau: DualRange
    f: DualRange
    theta_f: DualRange
    theta_theta_f: DualRange
    sigma: DualRange
    P: DualRange
    b: DualRange
    k: DualRange
    X: DualRange
    p: DualRange
    q: DualRange
    g: DualRange
    h: DualRange
    outer: DualRange
    pairs: DualRange
    third: DualRange
    fourth: DualRange


def higher_order_words(
    gyro: Interval, accel: Interval, kappa: DualRange, minors: int, table: TapTable, order: int
) -> HigherOrderWords:
    """Ranges of a design of third or fourth order.

    Args:
        gyro, accel: of the counts.
        kappa: the products within of one minor interval.
        minors: M.
        table: the tap table; its samples count once each.
        order: 3 or 4.
    """
    counts, taps = DualRange(gyro, accel), composition(table).taps

    def weighted(weights: Sequence[int]) -> DualRange:
        return dual_range_of_sum(*(counts.scaled(w) for w in weights))

    theta = counts.repeated(table.samples)
    inside = {
        "kappa": kappa,
        "c": weighted(taps.curvature),
        "m": weighted(taps.partner),
        "slope": weighted(taps.slope),
        "f": weighted(taps.fourth) if order > 3 else ZERO_DUAL,
    }
    inside["theta_c"] = theta.cross(inside["c"])
    inside["theta_m"] = theta.cross(inside["m"])
    inside["tau"] = dual_range_of_sum(
        theta.cross(inside["theta_c"]), inside["slope"].cross(inside["theta_m"])
    )
    inside["theta_f"] = theta.cross(inside["f"])
    inside["theta_theta_f"] = theta.cross(inside["theta_f"])
    inside["sigma"] = theta.cross(inside["theta_theta_f"])

    widest: dict[str, DualRange] = {}
    within = between = third = fourth = ZERO_DUAL
    for minor in range(minors):
        found = _composed(inside, theta, minor, within, between, third, table, order)
        third = dual_range_of_sum(third, found.pop("to_third"))
        fourth = dual_range_of_sum(fourth, found.pop("to_fourth"))
        within = dual_range_of_sum(within, kappa)
        between = dual_range_of_sum(between, found["P"])
        for name, each in found.items():
            widest[name] = widest.get(name, ZERO_DUAL).joined(each)
    return HigherOrderWords(**inside, **widest, third=third, fourth=fourth)


def _composed(
    inside: dict[str, DualRange],
    theta: DualRange,
    minor: int,
    within: DualRange,
    between: DualRange,
    third: DualRange,
    table: TapTable,
    order: int,
) -> dict[str, DualRange]:
    """The ranges of one minor interval's composition, given those before it."""
    factors = composition(table)
    f, t, Dc = factors.third_composed, factors.third_triple, factors.within
    alpha = theta.repeated(minor)
    P = alpha.cross(theta)
    b = dual_range_of_sum(within.scaled(6), between.scaled(3 * Dc), P.scaled(Dc))
    k = dual_range_of_sum(inside["kappa"].scaled(6), P.scaled(Dc))
    X = dual_range_of_sum(b.cross(theta), alpha.cross(k))
    found = {"P": P, "b": b, "k": k, "X": X}
    found |= dict.fromkeys(("p", "q", "g", "h", "outer", "pairs", "to_fourth"), ZERO_DUAL)
    if order > 3:
        p, q = P.cross(theta), alpha.cross(P)
        g = dual_range_of_sum(
            third.scaled(6), X.scaled(2 * f), p.scaled(-2 * f * Dc), q.scaled(f * Dc)
        )
        h = dual_range_of_sum(
            inside["tau"].scaled(6 * t), X.scaled(2 * f), p.scaled(f * Dc), q.scaled(-2 * f * Dc)
        )
        outer, pairs = dual_range_of_sum(g.cross(theta), alpha.cross(h)), b.cross(k)
        found |= {"p": p, "q": q, "g": g, "h": h, "outer": outer, "pairs": pairs}
        found["to_fourth"] = dual_range_of_sum(
            inside["sigma"].scaled(factors.fourth_inner),
            outer.scaled(factors.fourth_outer),
            pairs.scaled(factors.fourth_pairs),
        )
    found["to_third"] = dual_range_of_sum(inside["tau"].scaled(t), X.scaled(f))
    return found
