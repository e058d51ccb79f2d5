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
    alpha: Array, sculling: Array, scrolling: Array, interval: float
) -> Array:
    """What ΔV_SF lacks beyond second order where the body turns steadily, whatever the force does.

    At a constant rate, α(t) = α t/T, sculling and scrolling are α × moments of the force about the
    interval's start.  With m_k = ∫ t^k f dt,

        ΔV_scul = α×(m_1/T - m_0/2)         d = 7/6 ΔV_scul - ΔR_scrl/T = α×(m_2/T² - m_0/3)

    and what Eq. 51 leaves of the third and fourth order is

        ½ α×(α×(m_2/T² - m_0/3)) + 1/6 α×(α×(α×(m_3/T³ - m_0/4)))
            = ½ α×d + α×(α×(d/4 - ΔV_scul/10))

    exactly in third order; in fourth with m_3 as a force has that is a parabola over the interval,
    m_3/T³ = 3/2 m_2/T² - 3/5 m_1/T + m_0/20.  Constant rate and force give 0.

    Args:
        alpha: (R, 3) integral of the angular rate, rad.
        sculling, scrolling: (R, 3) ΔV_scul, m/s, and ΔR_scrl, m.
        interval: T, length of a major interval, s.

    Returns:
        (R, 3) m/s, in the body frame at the start of the interval.
    """
    d = 7 / 6 * sculling - scrolling / interval
    fourth = np.cross(alpha, d / 4 - sculling / 10)
    result: Array = np.cross(alpha, d / 2 + fourth)
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
