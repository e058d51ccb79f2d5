"""What comes after the orders that a core hands over, in closed form of these.

If the rate is smooth over a major interval T, the next orders of the rotation vector begin with
terms that products of the lower ones have, exactly:

    δ = -α×(α×β)/60 + O(T⁷)                                          after γ
    ε = -α×(α×γ)/42 - 2 β×(α×β)/105 + O(T⁹)                          after δ
    ζ = α×(α×(α×(α×β)))/2520 + O(T⁹)

with α, β, γ, δ, ε, ζ the orders 1 to 6.  Each letter is a dual vector, an angle (rad) and a
velocity (m/s), as in docs/explanation/higher-order.md.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Dual = tuple[Array, Array]
"""Angle and velocity, each (R, 3)."""


def next_orders(orders: Sequence[Dual]) -> Dual:
    """The first terms of what follows orders 1 to 3, or 1 to 4.

    Args:
        orders: α, β and γ, or these and δ; of R intervals.

    Returns:
        δ, or ε + ζ: rad and m/s.
    """
    alpha, beta, gamma = orders[:3]
    once = _crossed(alpha, beta)
    twice = _crossed(alpha, once)
    if len(orders) == 3:
        return _scaled(-1 / 60, twice)
    fifth = _crossed(alpha, _crossed(alpha, gamma))
    sixth = _crossed(alpha, _crossed(alpha, twice))
    found = _plus(_scaled(-1 / 42, fifth), _scaled(-2 / 105, _crossed(beta, once)))
    return _plus(found, _scaled(1 / 2520, sixth))


def _crossed(a: Dual, b: Dual) -> Dual:
    return np.cross(a[0], b[0]), np.cross(a[0], b[1]) + np.cross(a[1], b[0])


def _plus(a: Dual, b: Dual) -> Dual:
    return a[0] + b[0], a[1] + b[1]


def _scaled(factor: float, a: Dual) -> Dual:
    return factor * a[0], factor * a[1]
