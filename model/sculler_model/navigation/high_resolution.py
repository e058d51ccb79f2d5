"""High-resolution position: the host's half of Savage-98 section IV.C.

The sample-rate half delivers, once a major interval of length T, the doubly integrated increments
and the scrolling (`sculler_model.scrolling`); scaled to SI units they are

    S_α = ∫ α(t) dt, rad·s      S_υ = ∫ υ(t) dt, m      ΔR_scrl, m      (Savage-98 Eq. 85, 86)

each over the major interval, in body axes.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sculler_model.host import one_minus_cosine, one_minus_sine

Array = NDArray[np.float64]


def displacement(
    alpha: Array, upsilon: Array, s_alpha: Array, s_upsilon: Array, scrolling: Array
) -> Array:
    """ΔR_SF: what the specific force adds to the way over each interval (Savage-98 Eq. 84).

        ΔR_SF = S_υ + ΔR_rot + ΔR_scrl

    the running integral of ΔV_SF(t), from the interval's start to its end.

    Args:
        alpha, upsilon: (R, 3) integrals of angular rate (rad) and specific force (m/s).
        s_alpha, s_upsilon: (R, 3) their running integrals, rad·s and m.
        scrolling: (R, 3) ΔR_scrl, m.

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


_SERIES = 1 / np.cumprod([24.0] + [(2 * k + 3) * (2 * k + 4) for k in range(1, 10)])


def half_minus_cosine(x: Array) -> Array:
    """(½ - (1 - cos x)/x²)/x², to rounding for every x: by its series where |x| < 1 (Eq. 99)."""
    small = np.abs(x) < 1
    square = np.where(small, x * x, 0.0)
    series = np.zeros_like(square)
    for coefficient in _SERIES[::-1]:  # 1/4!, 1/6!, 1/8!, ...
        series = coefficient - square * series
    large = np.where(small, 1.0, x)
    return np.where(small, series, (0.5 - one_minus_cosine(large)) / large**2)
