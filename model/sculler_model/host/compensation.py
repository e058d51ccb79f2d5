"""Rotation compensation: velocity and displacement of a body that turns while the force acts.

Arrays of R intervals, each vector (R, 3), in the body frame at the start of its interval.
"""

from __future__ import annotations

from math import factorial

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def velocity_rotation(alpha: Array, upsilon: Array) -> Array:
    """ΔV_rot(α, υ), exact for constant rate and specific force (Savage-98 Eq. 51).

    Args:
        alpha, upsilon: (R, 3), rad and m/s.

    Returns:
        (R, 3) m/s, in the body frame at the start of the interval.
    """
    angle = np.sqrt(np.sum(alpha * alpha, axis=1, keepdims=True))
    first = np.cross(alpha, upsilon)
    second = np.cross(alpha, first)
    result: Array = one_minus_cosine(angle) * first + one_minus_sine(angle) * second
    return result


def velocity_higher_orders(
    alpha: Array,
    upsilon: Array,
    s_alpha: Array,
    s_upsilon: Array,
    sculling: Array,
    scrolling: Array,
    interval: float,
) -> Array:
    """What ΔV_SF lacks beyond second order, whether or not the axis of the rate turns.

    The double integrals hold the slopes of rate and force over the interval, b T² = 6α - 12 S_α/T
    (α2) and likewise υ2.  Of straight lines, with α1 = α and υ1 = υ, Eq. 51 and sculling leave

        [α1×(α1×υ2) - α2×(α1×υ1)]/24                                              T⁴
        + α1×(α2×υ2)/240 - α2×(α1×υ2)/120 + α2×(α2×υ1)/240                        T⁵
        + α1×[α1×(α1×υ2)/80 + α1×(α2×υ1)/240 - α2×(α1×υ1)/240] - α2×(α1×(α1×υ1))/80

    What sculling and scrolling have beyond straight lines, σ and ρ, is taken for a force that does
    as it likes while the body turns steadily; in the moments of such a force, d = 7/6 σ - ρ/T,

        ½ α×d + α×(α×(d/4 - σ/10))

    which is exact in the third order of products and, in the fourth, for a force that is a
    parabola.  Where both curve, terms of T⁵ are left.  Constant rate and force give 0.

    Args:
        alpha, upsilon: (R, 3) integrals of angular rate (rad) and specific force (m/s).
        s_alpha, s_upsilon: (R, 3) their running integrals (Savage-98 Eq. 85), rad·s and m.
        sculling, scrolling: (R, 3) ΔV_scul, m/s, and ΔR_scrl, m.
        interval: T, length of a major interval, s.

    Returns:
        (R, 3) m/s, in the body frame at the start of the interval.
    """
    alpha2 = 6 * alpha - 12 * s_alpha / interval
    upsilon2 = 6 * upsilon - 12 * s_upsilon / interval
    av, au2 = np.cross(alpha, upsilon), np.cross(alpha, upsilon2)
    a2u, a2u2 = np.cross(alpha2, upsilon), np.cross(alpha2, upsilon2)
    sigma = sculling - (au2 - a2u) / 12
    rho = scrolling / interval - (au2 / 72 - a2u / 36 + a2u2 / 240)
    d = 7 / 6 * sigma - rho
    inner = au2 / 80 + a2u / 240 + d / 4 - sigma / 10
    first = au2 / 24 + a2u2 / 240 + d / 2 + np.cross(alpha, inner) - np.cross(alpha2, av) / 240
    second = av / 24 + au2 / 120 - a2u / 240 + np.cross(alpha, av) / 80
    result: Array = np.cross(alpha, first) - np.cross(alpha2, second)
    return result


def displacement(
    alpha: Array, upsilon: Array, s_alpha: Array, s_upsilon: Array, scrolling: Array
) -> Array:
    """ΔR_SF: the displacement that the specific force adds over each interval (Savage-98 Eq. 84).

        ΔR_SF = S_υ + ΔR_rot + ΔR_scrl

    the running integral of ΔV_SF(t), from the interval's start to its end.

    Args:
        alpha, upsilon: (R, 3) integrals of angular rate (rad) and specific force (m/s).
        s_alpha, s_upsilon: (R, 3) their running integrals (Savage-98 Eq. 85), rad·s and m.
        scrolling: (R, 3) ΔR_scrl (Savage-98 Eq. 86), m.

    Returns:
        (R, 3) m, in the body frame at the START of the interval, held fixed in inertial space.
    """
    rotation = position_rotation(alpha, upsilon, s_alpha, s_upsilon)
    total: Array = s_upsilon + rotation + scrolling
    return total


def position_rotation(alpha: Array, upsilon: Array, s_alpha: Array, s_upsilon: Array) -> Array:
    """ΔR_rot, exact for constant rate and specific force (Savage-98 Eq. 99).

    Args:
        alpha, upsilon, s_alpha, s_upsilon: as for `displacement`.

    Returns:
        (R, 3) m, in the body frame at the start of the interval.
    """
    angle = np.sqrt(np.sum(alpha * alpha, axis=1, keepdims=True))
    first = np.cross(s_alpha, upsilon) + np.cross(alpha, s_upsilon)
    result: Array = one_minus_sine(angle) * first
    result += half_minus_cosine(angle) * np.cross(alpha, first)
    return result


def one_minus_cosine(x: Array) -> Array:
    """(1 - cos x)/x², to rounding for every x: by its series where |x| < 1.

    Elsewhere it is half the square of sin(x/2)/(x/2).
    """
    large = 0.5 * np.sinc(x / (2 * np.pi)) ** 2
    return np.where(np.abs(x) < 1, _series(2, x), large)


def one_minus_sine(x: Array) -> Array:
    """(1 - sin x/x)/x², to rounding for every x: by its series where |x| < 1 (Savage-98 Eq. 52)."""
    large = np.where(np.abs(x) < 1, 1.0, x)
    return np.where(np.abs(x) < 1, _series(3, x), (1 - np.sin(large) / large) / large**2)


def half_minus_cosine(x: Array) -> Array:
    """(½ - (1 - cos x)/x²)/x², to rounding for every x: by its series where |x| < 1 (Eq. 99)."""
    large = np.where(np.abs(x) < 1, 1.0, x)
    return np.where(np.abs(x) < 1, _series(4, x), (0.5 - one_minus_cosine(large)) / large**2)


def _series(first: int, x: Array) -> Array:
    """1/n! - x²/(n+2)! + x⁴/(n+4)! - ... from n = first on; to rounding for |x| < 1."""
    square = np.where(np.abs(x) < 1, x * x, 0.0)
    series = np.zeros_like(square)
    for n in range(first + 18, first - 1, -2):
        series = 1 / factorial(n) - square * series
    return series
