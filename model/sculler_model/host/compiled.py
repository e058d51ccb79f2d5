"""φ, α and ΔV_SF of many intervals in one pass, compiled by Numba: `scaling` with its arithmetic.

Every operation is that of `scaling` and `compensation`, in the same order, so the numbers are the
same to the last bit.  What the series of `compensation` do not cover, intervals in which the body
turns by 1 rad or more, is left to them.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import cache
from math import factorial
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sculler_model.machine_code import callable_when_compiled, compiled

Array = NDArray[np.float64]

Scale: TypeAlias = Callable[
    [NDArray[Any], tuple[float, ...], Array, Array, Array], NDArray[np.bool_]
]

_COSINE = np.array([1 / factorial(n) for n in range(20, 1, -2)])
_SINE = np.array([1 / factorial(n) for n in range(21, 2, -2)])
"""Coefficients of the series, the last term's first."""


@cache
def compiled_scale() -> Scale | None:
    """What fills in φ, α and ΔV_SF; None where Numba is missing.

    It takes the six vectors (R, C) with α's components first, int64 or, rounded, float64; the units
    (`scaling`); and three arrays (R, 3).  It returns (R,), whether ΔV_SF is left to do.
    """
    scale: Scale | None = _compiled(_scale)
    return scale


@cache
def compiled_floats() -> Callable[[NDArray[np.int64], Array], None] | None:
    """What fills in (R, C) with the floats nearest to (R, C, W) limbs; None without Numba."""
    floats: Callable[[NDArray[np.int64], Array], None] | None = _compiled(_floats)
    return floats


def _compiled(function: Callable[..., Any]) -> Any:
    try:
        callable_when_compiled(sys.modules[__name__])
        return compiled(function, nogil=True)
    except ImportError:
        return None


def _scale(numbers: Any, units: Any, phi: Array, alpha: Array, dv_sf: Array) -> NDArray[np.bool_]:
    alpha_unit, nu_unit, within, between, coning, sculling = units
    left = np.zeros(len(numbers), np.bool_)
    for row in range(len(numbers)):
        ax = float(numbers[row, 0]) * alpha_unit
        ay = float(numbers[row, 1]) * alpha_unit
        az = float(numbers[row, 2]) * alpha_unit
        ux = float(numbers[row, 9]) * nu_unit
        uy = float(numbers[row, 10]) * nu_unit
        uz = float(numbers[row, 11]) * nu_unit
        alpha[row, 0], alpha[row, 1], alpha[row, 2] = ax, ay, az
        for axis in range(3):
            correction = _correction(numbers, row, 3 + axis, within, between)
            phi[row, axis] = alpha[row, axis] + coning * correction
        angle = np.sqrt(ax * ax + ay * ay + az * az)
        if angle >= 1:
            left[row] = True
            continue
        square = angle * angle
        cosine, sine = 0.0, 0.0
        for term in range(len(_COSINE)):
            cosine = _COSINE[term] - square * cosine
            sine = _SINE[term] - square * sine
        fx, fy, fz = ay * uz - az * uy, az * ux - ax * uz, ax * uy - ay * ux
        gx, gy, gz = ay * fz - az * fy, az * fx - ax * fz, ax * fy - ay * fx
        dv_sf[row, 0] = ux + (cosine * fx + sine * gx)
        dv_sf[row, 1] = uy + (cosine * fy + sine * gy)
        dv_sf[row, 2] = uz + (cosine * fz + sine * gz)
        for axis in range(3):
            correction = _correction(numbers, row, 12 + axis, within, between)
            dv_sf[row, axis] = dv_sf[row, axis] + sculling * correction
    return left


def _correction(numbers: Any, row: int, first: int, within: float, between: float) -> float:
    """Within and, three columns on, between; in counts²."""
    correction: float = float(numbers[row, first]) / within
    rest = float(numbers[row, first + 3])
    if rest != 0:  # it is 0 where there is one minor interval, and division slow
        correction += rest / between
    return correction


def _floats(limbs: NDArray[np.int64], numbers: Array) -> None:
    for row in range(len(limbs)):
        for column in range(limbs.shape[1]):
            numbers[row, column] = nearest_float(limbs[row, column])


def nearest_float(limbs: Any) -> float:
    """The float nearest to an integer of (W,) limbs, ties to even; see `fast.wide.nearest_floats`.

    The 64 bits from the highest set one on are taken, and their last bit is set where any bit below
    them is, so that the one rounding of 64 bits to a float is that of the whole integer.
    """
    words = len(limbs)
    if words == 1:
        return float(limbs[0])
    narrow = True
    for word in range(1, words):
        narrow = narrow and limbs[word] == limbs[0] >> 63
    if narrow:
        return float(limbs[0])
    flip = np.uint64(limbs[words - 1] >> 63)  # all ones where it is below 0
    carry, before, lower = flip & np.uint64(1), np.uint64(0), False
    top, below, sticky, place = before, before, False, 0
    for word in range(words):  # the last one that is not zero wins
        limb = (np.uint64(limbs[word]) ^ flip) + carry
        carry = np.uint64(carry == np.uint64(1) and limb == np.uint64(0))
        if limb != np.uint64(0):
            top, below, sticky, place = limb, before, lower, word
        lower = lower or before != np.uint64(0)
        before = limb
    bits = 0
    while (top >> np.uint64(63 - bits)) == np.uint64(0):
        bits += 1
    if bits:
        shifted = (top << np.uint64(bits)) | (below >> np.uint64(64 - bits))
        sticky = sticky or (below << np.uint64(bits)) != np.uint64(0)
    else:
        shifted = top
        sticky = sticky or below != np.uint64(0)
    if sticky:
        shifted = shifted | np.uint64(1)
    size = float(shifted) * 0.5**bits
    for _ in range(place):
        size *= 18446744073709551616.0  # 2^64, exact
    return -size if flip else size
