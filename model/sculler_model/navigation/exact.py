"""Major increments of a known motion by no algorithm: what remains is the navigator's own error.

φ is the logarithm of the true turn in inertial space; ΔV_SF is the Gauss-Legendre integral of the
true specific force, turned into the body frame at the interval's start.
"""

from __future__ import annotations

from collections.abc import Callable
from math import pi
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from sculler_model.frames import (
    EARTH_RATE,
    Quaternions,
    Vectors,
    conjugate,
    product,
    rotate,
    rotation_vectors,
)
from sculler_model.host import MajorIncrements
from sculler_model.navigation.state import NavHistory

Array = NDArray[np.float64]

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(4)
_BLOCK = 50_000


class Earthbound(Protocol):
    """A motion over the Earth with known states and sensor inputs, such as `motion.Motion`."""

    def state(self, t: Array) -> NavHistory:
        """True states at times t (N,), s."""

    def sensed(self, t: Array) -> Array:
        """(N, 6) rate against inertial space (rad/s), specific force (m/s²), in the body."""


def exact_increments(motion: Earthbound, count: int, interval: float) -> MajorIncrements:
    """φ, α and ΔV_SF of a motion over the Earth.

    φ is exact to rounding; so is ΔV_SF of motions slower than 0.1 rad of phase in an interval.

    Args:
        motion: the truth.
        count: major intervals, from time 0.
        interval: their length, s.

    Returns:
        φ (rad), α = φ (not the integral of the rate: nobody navigates by it) and ΔV_SF (m/s).
    """

    def sensed(t: Array) -> tuple[Quaternions, Vectors]:
        true = motion.state(t)
        w, x, y, z = true.q.T
        q = product(_north_east_down(true.lat, true.lon + EARTH_RATE * t), (w, x, y, z))
        force_x, force_y, force_z = motion.sensed(t)[:, 3:].T
        return q, (force_x, force_y, force_z)

    return increments_in_inertial_space(sensed, count, interval)


def increments_in_inertial_space(
    sensed: Callable[[Array], tuple[Quaternions, Vectors]], count: int, interval: float
) -> MajorIncrements:
    """The same for a motion told in inertial space.

    Args:
        sensed: at times t (N,): q_ib, body to inertial space, and the specific force in the body
            (m/s²), as arrays for each component.
        count, interval: as for `exact_increments`.
    """
    parts = []
    for first in range(0, max(count, 1), _BLOCK):
        begin = interval * np.arange(first, min(count, first + _BLOCK), dtype=np.float64)
        back = conjugate(sensed(begin)[0])
        phi = rotation_vectors(product(back, sensed(begin + interval)[0]))
        dv_sf = np.zeros((len(begin), 3))
        for node, weight in zip(_NODES.tolist(), _WEIGHTS.tolist(), strict=True):
            q, force = sensed(begin + interval * (0.5 + 0.5 * node))
            turned = rotate(product(back, q), force)
            dv_sf += 0.5 * interval * weight * np.stack(turned, axis=1)
        parts.append(MajorIncrements(phi, phi, dv_sf))
    return MajorIncrements.concatenate(parts)


def _north_east_down(lat: Array, lon: Array) -> Quaternions:
    """q_en: C_en = R_z(lon) R_y(-90° - lat)."""
    zero, turn, tip = np.zeros_like(lat), 0.5 * lon, -0.25 * pi - 0.5 * lat
    east: Quaternions = (np.cos(turn), zero, zero, np.sin(turn))
    return product(east, (np.cos(tip), zero, np.sin(tip), zero))
