"""What each order leaves of a cone's rotation in an interval, without samples: the series alone.

A cone looks the same from interval to interval but for a turn about its axis, so the error of one
interval's rotation vector tells the drift of all of them.  The orders are integrals of the true
rate, solved to rounding on Chebyshev points.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, cos, pi, sin, sqrt

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from sculler_model import host
from sculler_model.frames import from_rotation_vector, product

Array = NDArray[np.float64]

_POINTS = 60


@dataclass(frozen=True)
class ConeOrders:
    """Drift about the cone's axis in an interval, rad, after so many orders.

    Attributes:
        second: α and β alone, as every two-rate algorithm has them.
        third: γ besides.
        fourth: δ besides.
        order_3, order_4: what a design of that order leaves: α to γ, or to δ, and the first terms
            of the next orders, which the host adds.
    """

    second: float
    third: float
    fourth: float
    order_3: float
    order_4: float


def cone_orders(half_angle: float, turned: float, spin: float = 0.0) -> ConeOrders:
    """What the orders leave of a cone.

    Args:
        half_angle: of the cone, rad.
        turned: angle by which the cone's axis goes round in an interval, rad, below 2 pi.
        spin: rate about the axis that goes round, in rates of its going round.
    """
    points = np.cos(pi * (np.arange(_POINTS) + 0.5) / _POINTS)
    phase = (1 - spin) * turned * (points + 1) / 2
    side = np.full(_POINTS, sin(half_angle))
    along = np.full(_POINTS, cos(half_angle) - (1 - spin))
    rate = np.stack([-side * np.sin(phase), side * np.cos(phase), along], axis=1)
    # the equations of the orders, docs/explanation/higher-order.md
    alpha, a = _integral(rate, turned)
    beta, b = _integral(0.5 * np.cross(alpha, rate), turned)
    gamma, c = _integral(
        0.5 * np.cross(beta, rate) + np.cross(alpha, np.cross(alpha, rate)) / 12, turned
    )
    mixed = np.cross(alpha, np.cross(beta, rate)) + np.cross(beta, np.cross(alpha, rate))
    _, d = _integral(0.5 * np.cross(gamma, rate) + mixed / 12, turned)
    dual = [(each[np.newaxis], np.zeros((1, 3))) for each in (a, b, c, d)]
    back = (1 - spin) * turned
    return ConeOrders(
        *(
            _angle(phi, back) - turned
            for phi in (
                a + b,
                a + b + c,
                a + b + c + d,
                a + b + c + host.next_orders(dual[:3])[0][0],
                a + b + c + d + host.next_orders(dual)[0][0],
            )
        )
    )


def _integral(values: Array, length: float) -> tuple[Array, Array]:
    """Of a function on the points of [0, length], from 0: at the points, and at the end."""
    points = np.cos(pi * (np.arange(_POINTS) + 0.5) / _POINTS)
    matrix = chebyshev.chebvander(points, _POINTS)
    series = chebyshev.chebint(np.linalg.solve(matrix[:, :-1], values), axis=0, lbnd=-1)
    return matrix @ series * length / 2, series.sum(axis=0) * length / 2


def _angle(phi: Array, back: float) -> float:
    """Of a rotation by phi and one about the cone's axis, rad."""
    x, y, z = phi.tolist()
    w, x, y, z = product(from_rotation_vector((x, y, z)), (cos(back / 2), 0.0, 0.0, sin(back / 2)))
    return 2 * atan2(sqrt(x * x + y * y + z * z), w)
