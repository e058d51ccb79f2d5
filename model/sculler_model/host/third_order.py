"""Terms of third order, from the increments of three major intervals: of φ and of ΔV_SF."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sculler_model.host.increments import MajorIncrements

Array = NDArray[np.float64]


class ThirdOrder:
    """The triple products of rotation vector and velocity, from what is handed over alone.

    The core's φ is of second order (Savage-20 Eq. 2 against Eq. 3).  If the rate is a smooth
    function over three major intervals, their α show its slope and curvature, and with them what
    is left out (see `third_order_terms`).  In manoeuvres that takes the error from the fourth to
    the fifth power of the interval.  Vibration inside an interval it cannot see, and vibration
    above about a third of the update rate it takes for something else: there a shorter interval
    helps, this does not.

    Call it with the increments of consecutive intervals, in blocks of any length; it keeps the
    last two.  Attitude is causal: no interval waits for a later one.  An interval of short history
    tells no rate, so it begins anew after one.
    """

    def __init__(self) -> None:
        self._before = np.zeros((2, 0, 3))

    def __call__(self, increments: MajorIncrements) -> MajorIncrements:
        """The increments, corrected; the first two whole intervals stay as they are."""
        first = increments.leading_short
        turns, velocities = increments.alpha[first:], increments.dv_sf[first:]
        # in the body's own axes, to second order
        now = np.stack((turns, velocities - 0.5 * np.cross(turns, velocities)))
        before = np.zeros((2, 0, 3)) if first else self._before
        alpha, upsilon = both = np.concatenate((before, now), axis=1)
        self._before = both[:, -2:]
        terms = third_order_terms(alpha)
        phi = increments.phi.copy()
        phi[len(phi) - len(terms) :] += terms
        if increments.dr_sf is not None:
            return replace(increments, phi=phi)
        dv_sf = increments.dv_sf.copy()
        dv_sf[len(dv_sf) - len(terms) :] += velocity_terms(alpha, upsilon)
        return replace(increments, phi=phi, dv_sf=dv_sf)


def third_order_terms(alpha: Array) -> Array:
    """What the second-order φ lacks where the rate is a parabola over three major intervals.

    With ω = a + bτ + cτ², τ from the middle of an interval T, and α1 = aT, α2 = bT², α3 = cT³,

        φ - (α + ½∫α×ω dt) = α1×(α1×α3)/360 - α2×(α1×α2)/240 - α1×(α1×(α1×α2))/720 + O(T⁷)

    the third- and fourth-order terms of the Magnus series for a rate in body axes.

    Args:
        alpha: (R, 3) rad, of consecutive intervals.

    Returns:
        (R - 2, 3) rad for the intervals from the third on; none if there are fewer.
    """
    alpha1, alpha2, alpha3 = _parabola(alpha)
    once = np.cross(alpha1, alpha2)
    terms: Array = (
        np.cross(alpha1, np.cross(alpha1, alpha3)) / 360
        - np.cross(alpha2, once) / 240
        - np.cross(alpha1, np.cross(alpha1, once)) / 720
    )
    return terms


def velocity_terms(alpha: Array, upsilon: Array) -> Array:
    """What ΔV_SF of second order lacks where rate and force are parabolas over three intervals.

    With α1 = aT, α2 = bT², α3 = cT³ of ω = a + bτ + cτ², and υ1, υ2, υ3 of the specific force
    likewise, τ from the middle of an interval,

        ΔV_SF - (υ + ΔV_rot + ΔV_scul) =
            [α1×(α1×υ2) - α2×(α1×υ1)]/24
            + α1×(α1×υ3)/360 + α1×(α2×υ2)/240 - α1×(α3×υ1)/180
            - α2×(α1×υ2)/120 + α2×(α2×υ1)/240 + α3×(α1×υ1)/360
            + α1×[α1×(α1×υ2)/80 + α1×(α2×υ1)/240 - α2×(α1×υ1)/240] - α2×(α1×(α1×υ1))/80 + O(T⁶)

    the third and fourth order of the series of nested integrals ∫ω×∫ω× ... f.

    Args:
        alpha, upsilon: (R, 3) integrals of rate (rad) and specific force (m/s) in body axes, of
            consecutive intervals.

    Returns:
        (R - 2, 3) m/s for the intervals from the third on; none if there are fewer.
    """
    (a1, a2, a3), (u1, u2, u3) = _parabola(alpha), _parabola(upsilon)
    once, slope, turned = np.cross(a1, u1), np.cross(a1, u2), np.cross(a2, u1)
    inner = slope / 80 + turned / 240
    first = slope / 24 + np.cross(a1, u3) / 360 + np.cross(a2, u2) / 240 - np.cross(a3, u1) / 180
    first = first + np.cross(a1, inner) - np.cross(a2, once) / 240
    second = once / 24 + slope / 120 - turned / 240 + np.cross(a1, once) / 80
    terms: Array = np.cross(a1, first) - np.cross(a2, second) + np.cross(a3, once) / 360
    return terms


def _parabola(sums: Array) -> tuple[Array, Array, Array]:
    """aT, bT² and cT³ at the middles of the intervals from the third on, of integrals over all."""
    oldest, before, now = sums[:-2], sums[1:-1], sums[2:]
    if len(sums) < 3:
        oldest = before = now
    second = 1.5 * now - 2 * before + 0.5 * oldest
    third = 0.5 * now - before + 0.5 * oldest
    return now - third / 12, second, third
