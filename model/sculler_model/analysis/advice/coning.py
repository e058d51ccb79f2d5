"""Classical coning through the whole computation, without quantising."""

from __future__ import annotations

from math import atan2, cos, pi, sin, sqrt

import numpy as np

from sculler_model.algorithms import SensorKind, TapTable
from sculler_model.frames import from_rotation_vector, product
from sculler_model.motion import Coning


def coning_drift(
    table: TapTable,
    minors: int,
    half_angle: float,
    omega: float,
    interval: float,
    kind: SensorKind = "increment",
) -> float:
    """Drift about the axis of classical coning, computed minus true, to all orders (rad/s).

    Seen from a frame that goes round with the cone every major interval is the same, so one is
    enough: with D the computed rotation of an interval of length H from cone angle 0,
    ``D Rz(ΩH)`` is a rotation about (nearly) the cone's axis, truly by ΩH, and what it turns
    beyond that is the drift.  Where ΩH is a multiple of 2π it is the size of the whole drift.

    Args:
        table: the tap table.
        minors: M.
        half_angle: rad.
        omega: Ω, rad/s.
        interval: T, s.
        kind: what the samples are (rates pass sinc(ΩT/2)).
    """
    n, reach = table.samples, table.history
    count = n * minors
    motion = Coning(half_angle, omega)
    if kind == "increment":
        s = motion.increments(count + reach, interval, -reach)[:, :3]
    else:
        s = motion.rates(count + reach, interval, 1 - reach)[:, :3] * interval
    phi = np.zeros(3)
    alpha = np.zeros(3)
    for first in range(reach, reach + count, n):
        for k, row in enumerate(table.taps):
            taps = [(d, tap) for d, tap in enumerate(row, start=1) if tap]
            A = sum((tap * s[first + k - d] for d, tap in taps), np.zeros(3))
            phi += np.cross(A, s[first + k]) / table.denominator
        last = first + n - 1
        theta = sum((w * s[last - d] for d, w in enumerate(table.weights) if w), np.zeros(3))
        theta = theta / table.sum_denominator
        phi += 0.5 * np.cross(alpha, theta)
        alpha = alpha + theta
    phi += alpha
    H = count * interval
    turned = (cos(omega * H / 2), 0.0, 0.0, sin(omega * H / 2))
    w, x, y, z = product(from_rotation_vector((phi[0], phi[1], phi[2])), turned)
    # the cone's axis in the body at cone angle 0, where the body is turned about x
    forward = y * sin(half_angle) + z * cos(half_angle) >= 0
    sine = sqrt(x * x + y * y + z * z)
    excess = 2 * atan2(sine if forward else -sine, w) - omega * H
    return ((excess + pi) % (2 * pi) - pi) / H
