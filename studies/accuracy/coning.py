"""Drift of classical coning: by closed form, and of the attitude that a host puts together."""

from __future__ import annotations

from math import pi, sin
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from sculler_model.algorithms import TapTable
from sculler_model.analysis.advice import PER_HOUR, coning_drift
from sculler_model.analysis.closed_form import drift_rate
from sculler_model.design import Design
from sculler_model.frames import Quaternion
from sculler_model.motion import Coning

Array = NDArray[np.float64]
Kind = Literal["increment", "rate"]


def fine_design(
    family: str, n: int, p: int, M: int, rate: float, kind: Kind = "increment", **options: Any
) -> Design:
    """A design on a sensor so fine that its LSB does not show."""
    scale = rate if kind == "rate" else 1.0
    return Design.parse(
        {
            "name": "fine",
            "sensor": {
                "kind": kind,
                "sample_rate_hz": rate,
                "gyro": {"bits": 32, "lsb": 1e-12 * scale},
                "accel": {"bits": 32, "lsb": 1e-9 * scale},
            },
            "algorithm": {"family": family, "samples": n, "history": p, "minors": M, **options},
        }
    )


def coning_left(
    table: TapTable, half_angle: float, hertz: float, T: float, kind: Kind = "increment"
) -> float:
    """°/h by closed form, second order."""
    a = sin(half_angle)
    return float(drift_rate(table, a, a, 2 * pi * hertz, T, kind)) * PER_HOUR


def drift_curve(
    table: TapTable, half_angle: float, hertz: Array, T: float, kind: Kind = "increment"
) -> Array:
    """`coning_left` over the frequencies (N,)."""
    a = sin(half_angle)
    drift: Array = PER_HOUR * drift_rate(table, a, a, 2 * pi * hertz, T, kind)
    return drift


def coning_whole(
    table: TapTable,
    minors: int,
    half_angle: float,
    hertz: float,
    T: float,
    kind: Kind = "increment",
) -> float:
    """°/h of the attitude."""
    return coning_drift(table, minors, half_angle, 2 * pi * hertz, T, kind) * PER_HOUR


def true_attitude(motion: Coning, t: float) -> Quaternion:
    """Of the motion at a time, s."""
    w, x, y, z = motion.attitude(np.array([t]))[0].tolist()
    return w, x, y, z
