"""Classical coning through the whole computation, without quantising."""

from __future__ import annotations

from math import atan2, cos, pi, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from sculler_model import host
from sculler_model.algorithms import (
    DUAL_ZERO,
    Dual,
    HigherOrder,
    Response,
    SensorKind,
    TapTable,
    composition,
    dual_cross,
    dual_sum,
    dual_times,
)
from sculler_model.frames import from_rotation_vector, product
from sculler_model.motion import Coning

Array = NDArray[np.float64]


def coning_drift(
    table: TapTable,
    minors: int,
    half_angle: float,
    omega: float,
    interval: float,
    kind: SensorKind = "increment",
    passed: Response | None = None,
    order: int = 2,
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
        order: of the rotation vector; 3 and 4 are for increments that count once each.
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
    if order > 2:
        samples = s[reach:].reshape(minors, n, 3)
        phi = phi + _higher_orders(table, order, samples, theta, within)
    H = count * interval
    turned = (cos(omega * H / 2), 0.0, 0.0, sin(omega * H / 2))
    w, x, y, z = product(from_rotation_vector((phi[0], phi[1], phi[2])), turned)
    # the cone's axis in the body at cone angle 0, where the body is turned about x
    forward = y * sin(half_angle) + z * cos(half_angle) >= 0
    sine = sqrt(x * x + y * y + z * z)
    excess = 2 * atan2(sine if forward else -sine, w) - omega * H
    return ((excess + pi) % (2 * pi) - pi) / H


def _higher_orders(
    table: TapTable, order: int, samples: Array, theta: Array, within: Array
) -> Array:
    """What the rotation vector has above second order, rad: the page in floats.

    Args:
        table: the tap table.
        order: 3 or 4.
        samples: (M, n, 3), rad.
        theta, within: of each minor interval: its angle, and Dc times what it adds within, (M, 3).
    """
    page, factors = HigherOrder(table, order), composition(table)
    alpha = inside = between = DUAL_ZERO
    for rows, turned, kappa in zip(samples, map(_dual, theta), map(_dual, within), strict=True):
        page.step(list(map(_dual, rows)), alpha, inside, between, kappa)
        between = dual_sum(between, dual_cross(alpha, turned))
        alpha, inside = dual_sum(alpha, turned), dual_sum(inside, kappa)
    beta = dual_sum(inside, dual_times(factors.within / 2, between))  # type: ignore[arg-type]
    orders = [
        np.array([alpha.angle]),
        np.array([beta.angle]) / factors.within,
        np.array([page.third.angle]) / factors.third,
        np.array([page.fourth.angle]) / factors.fourth,
    ][:order]
    none = np.zeros((1, 3))
    following, _ = host.next_orders([(each, none) for each in orders])
    found: Array = (sum(orders[2:], none) + following)[0]
    return found


def _dual(angle: Array) -> Dual:
    """An angle alone."""
    x, y, z = angle.tolist()
    return Dual((x, y, z), (0, 0, 0))
