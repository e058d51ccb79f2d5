"""Classical coning through the whole computation, without quantising."""

from __future__ import annotations

from math import atan2, cos, pi, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from sculler_model.algorithms import Response, SensorKind, TapTable
from sculler_model.frames import from_rotation_vector, product
from sculler_model.motion import Coning


def coning_drift(
    table: TapTable,
    minors: int,
    half_angle: float,
    omega: float,
    interval: float,
    kind: SensorKind = "increment",
    passed: Response | None = None,
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
        kind: what the samples are.
        passed: the filter they passed; None: increments none, rates sinc(ΩT/2).
    """
    n, reach = table.samples, table.history
    count = n * minors
    motion = Coning(half_angle, omega)
    if kind == "increment":
        s = motion.increments(count + reach, interval, -reach)[:, :3]
    else:
        rates = motion.rates(count + reach, interval, 1 - reach, filtered=passed is None)
        s = rates[:, :3] * interval
    if passed is not None:  # both axes pass it alike, so its phase is only a later start
        s[:, :2] *= abs(passed.value(omega * interval))

    def back(k: int, d: int) -> NDArray[np.float64]:
        """s[t-d] at phase k of every minor interval, (M, 3)."""
        return s[reach + k - 1 - d : len(s) - d : n]

    none = np.zeros((minors, 3))
    within = none
    for k in table.active_phases:
        taps = enumerate(table.taps[k - 1], start=1)
        A = sum((tap * back(k, d) for d, tap in taps if tap), none)
        within = within + np.cross(A, back(k, 0))
    theta = sum((w * back(n, d) for d, w in enumerate(table.weights) if w), none)
    theta = theta / table.sum_denominator
    alpha = np.cumsum(theta, axis=0)
    coning = within / table.denominator + 0.5 * np.cross(alpha - theta, theta)
    phi = alpha[-1] + coning.sum(axis=0)
    H = count * interval
    turned = (cos(omega * H / 2), 0.0, 0.0, sin(omega * H / 2))
    w, x, y, z = product(from_rotation_vector((phi[0], phi[1], phi[2])), turned)
    # the cone's axis in the body at cone angle 0, where the body is turned about x
    forward = y * sin(half_angle) + z * cos(half_angle) >= 0
    sine = sqrt(x * x + y * y + z * z)
    excess = 2 * atan2(sine if forward else -sine, w) - omega * H
    return ((excess + pi) % (2 * pi) - pi) / H
