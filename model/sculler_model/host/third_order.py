"""The third-order terms of the rotation vector, from the increments of three major intervals."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sculler_model.host.increments import MajorIncrements

Array = NDArray[np.float64]


class ThirdOrder:
    """The triple products of the rotation vector equation, from what is handed over alone.

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
        self._before = np.zeros((0, 3))

    def __call__(self, increments: MajorIncrements) -> MajorIncrements:
        """The increments with φ corrected; the first two whole intervals stay as they are."""
        first = increments.leading_short
        before = np.zeros((0, 3)) if first else self._before
        alpha = np.concatenate((before, increments.alpha[first:]))
        self._before = alpha[-2:]
        terms = third_order_terms(alpha)
        phi = increments.phi.copy()
        phi[len(phi) - len(terms) :] += terms
        return replace(increments, phi=phi)


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
    if len(alpha) < 3:
        return np.zeros((0, 3))
    oldest, before, now = alpha[:-2], alpha[1:-1], alpha[2:]
    alpha2 = 1.5 * now - 2 * before + 0.5 * oldest
    alpha3 = 0.5 * now - before + 0.5 * oldest
    alpha1 = now - alpha3 / 12
    once = np.cross(alpha1, alpha2)
    terms: Array = (
        np.cross(alpha1, np.cross(alpha1, alpha3)) / 360
        - np.cross(alpha2, once) / 240
        - np.cross(alpha1, np.cross(alpha1, once)) / 720
    )
    return terms
