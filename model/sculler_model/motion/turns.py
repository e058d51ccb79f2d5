"""Attitude as a product of turns about fixed axes: quaternion, rate and angular acceleration."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from sculler_model.frames import Quaternions, Vector, Vectors
from sculler_model.motion.compiled import Loops
from sculler_model.motion.curves import Array, Curve, Smooth
from sculler_model.motion.kinematics import turned


@dataclass(frozen=True)
class Turn:
    """A rotation about a fixed axis by an angle that is a function of time.

    Attributes:
        axis: unit vector.
        angle: rad.
    """

    axis: Vector
    angle: Smooth

    def jet(self, t: Array) -> tuple[Quaternions, Vectors, Vectors]:
        """Quaternion, rate (rad/s) in the turned axes, and the rate's derivative (rad/s²)."""
        angle, speed, gain = self.angle.jet(t)
        sine = np.sin(0.5 * angle)
        x, y, z = self.axis
        q: Quaternions = (np.cos(0.5 * angle), x * sine, y * sine, z * sine)
        return q, (x * speed, y * speed, z * speed), (x * gain, y * gain, z * gain)

    @property
    def highest(self) -> float:
        """The highest frequency in it that matters, rad/s."""
        return self.angle.highest

    @property
    def steepest(self) -> float:
        """A bound on the rate of turning, rad/s."""
        return self.angle.steepest

    @property
    def rough(self) -> float:
        """Its highest frequency (rad/s) if it has knots; 0 if it is analytic."""
        return self.angle.rough


class Rotation(Protocol):
    """A rotation that is a smooth function of time, such as a `Turn`."""

    def jet(self, t: Array) -> tuple[Quaternions, Vectors, Vectors]:
        """Quaternion, rate (rad/s) in the turned axes, and the rate's derivative (rad/s²)."""

    @property
    def highest(self) -> float:
        """The highest frequency in it that matters, rad/s."""

    @property
    def steepest(self) -> float:
        """A bound on the rate of turning, rad/s."""

    @property
    def rough(self) -> float:
        """Its highest frequency (rad/s) if it has knots; 0 if it is analytic."""


X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


def coning_turns(half_angle: float, omega: float, phase: float = 0.0) -> tuple[Turn, Turn, Turn]:
    """Classical coning as turns: the rotation vector half_angle·(cos, sin, 0)(Ωt + phase)."""
    spin = Curve((phase, omega))
    back = Curve((0.0 - phase, -omega))
    return Turn(Z, spin), Turn(X, Curve((half_angle,))), Turn(Z, back)


def steady_attitude(roll: float, pitch: float, heading: float) -> tuple[Turn, Turn, Turn]:
    """Constant Euler angles (rad) as turns."""
    return euler_turns(Curve((roll,)), Curve((pitch,)), Curve((heading,)))


def euler_turns(roll: Smooth, pitch: Smooth, heading: Smooth) -> tuple[Turn, Turn, Turn]:
    """Euler angles (rad) as turns: heading outermost, then pitch, then roll."""
    return Turn(Z, heading), Turn(Y, pitch), Turn(X, roll)


def attitude(turns: Sequence[Rotation], t: Array) -> tuple[Quaternions, Vectors]:
    """Product of the turns, first one outermost, and its angular rate.

    Args:
        turns: rotations; the product takes body components to the reference frame.
        t: (N,) times, s.

    Returns:
        Quaternion (four arrays), and the rate (rad/s) of the body against the reference frame in
        the body frame (three arrays).
    """
    q, rate, _ = attitude_jet(turns, t)
    return q, rate


def attitude_jet(
    turns: Sequence[Rotation], t: Array, loops: Loops | None = None
) -> tuple[Quaternions, Vectors, Vectors]:
    """As `attitude`, and the derivative of the rate (rad/s²), component by component.

    Args:
        turns, t: as of `attitude`.
        loops: does the arithmetic, if given; the numbers are the same.
    """
    one, zero = np.ones_like(t), np.zeros_like(t)
    found: tuple[Quaternions, Vectors, Vectors]
    if loops is None:
        found = (one, zero, zero, zero), (zero, zero, zero), (zero, zero, zero)
        for turn in turns:
            found = turned(found, turn.jet(t))
        return found
    rows = np.stack((one, *[zero] * 9))
    for turn in turns:
        loops.turn(rows, *turn.jet(t))
    q0, q1, q2, q3, w0, w1, w2, c0, c1, c2 = rows
    return (q0, q1, q2, q3), (w0, w1, w2), (c0, c1, c2)
