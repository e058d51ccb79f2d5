"""Classical motions in inertial space, in closed form: no Earth, no gravity."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np

from sculler_model.frames import Vector
from sculler_model.host import one_minus_cosine, one_minus_sine
from sculler_model.motion.curves import Array


@dataclass(frozen=True)
class Coning:
    """Classical coning in inertial space: rotation vector half_angle·(cos Ωt, sin Ωt, 0).

    The angular rate in the body frame (Zeng Eq. 3, his axes x, y, z being z, x, y here) is
    ``(-Ω sin a sin Ωt, Ω sin a cos Ωt, -2Ω sin²(a/2))``: the third part is the cone's constant
    rate, which the two oscillations together undo.

    Attributes:
        half_angle: a, rad.
        omega: Ω, rad/s.
    """

    half_angle: float
    omega: float

    def increments(self, samples: int, interval: float, first: int = 0) -> Array:
        """(N, 6) exact increments over sample intervals, as `Motion.increments`; zeros for m/s."""
        middle = self.omega * interval * (first + 0.5 + np.arange(samples))
        size = 2 * sin(self.half_angle) * sin(0.5 * self.omega * interval)
        out = np.zeros((samples, 6))
        out[:, 0] = -size * np.sin(middle)
        out[:, 1] = size * np.cos(middle)
        out[:, 2] = -2 * self.omega * interval * sin(self.half_angle / 2) ** 2
        return out

    def rates(self, samples: int, interval: float, first: int = 0, filtered: bool = True) -> Array:
        """(N, 6) rate samples, as `Motion.rates`; zeros for m/s²."""
        phase = self.omega * interval * (first + np.arange(samples))
        size = self.omega * sin(self.half_angle)
        if filtered:
            size *= float(np.sinc(self.omega * interval / (2 * pi)))
        out = np.zeros((samples, 6))
        out[:, 0] = -size * np.sin(phase)
        out[:, 1] = size * np.cos(phase)
        out[:, 2] = -2 * self.omega * sin(self.half_angle / 2) ** 2
        return out

    def attitude(self, t: Array) -> Array:
        """(N, 4) quaternions at times t, body to inertial."""
        size = sin(self.half_angle / 2)
        zero = np.zeros_like(t)
        w = zero + cos(self.half_angle / 2)
        x, y = size * np.cos(self.omega * t), size * np.sin(self.omega * t)
        return np.stack((w, x, y, zero), axis=1)


@dataclass(frozen=True)
class Sculling:
    """Classical sculling in inertial space: turning about x and specific force along y, in phase.

    The angle about x is A sin Ωt, the specific force along body y is B sin Ωt.  In inertial space
    the force along z is B sin Ωt sin(A sin Ωt), whose mean is B J1(A): about A B/2.

    Attributes:
        angle: A, rad.
        force: B, m/s².
        omega: Ω, rad/s.
    """

    angle: float
    force: float
    omega: float

    def increments(self, samples: int, interval: float, first: int = 0) -> Array:
        """(N, 6) exact increments over sample intervals (rad, m/s), as `Motion.increments`."""
        middle = self.omega * interval * (first + 0.5 + np.arange(samples))
        half = sin(0.5 * self.omega * interval)
        out = np.zeros((samples, 6))
        out[:, 0] = 2 * self.angle * half * np.cos(middle)
        out[:, 4] = 2 * self.force / self.omega * half * np.sin(middle)
        return out

    @property
    def mean_force(self) -> float:
        """Rectified specific force along inertial z, m/s²: B J1(A), by the series of J1."""
        half, term, total = self.angle / 2, self.angle / 2, 0.0
        for k in range(1, 40):
            total += term
            term *= -half * half / (k * (k + 1))
        return self.force * total


@dataclass(frozen=True)
class SpinAccel:
    """Constant rate and constant specific force in body axes, in inertial space.

    Attitude, velocity and position have closed forms; from rest at time 0, where body and inertial
    axes agree.

    Attributes:
        rate: ω, rad/s, body axes.
        force: f, m/s², body axes.
    """

    rate: Vector
    force: Vector

    def increments(self, samples: int, interval: float, first: int = 0) -> Array:
        """(N, 6) exact increments over sample intervals (rad, m/s), as `Motion.increments`."""
        return np.tile(interval * np.array([*self.rate, *self.force]), (samples, 1))

    def attitude(self, t: Array) -> Array:
        """(N, 4) quaternions at times t, body to inertial."""
        half = 0.5 * np.outer(t, self.rate)
        angle = np.linalg.norm(half, axis=1, keepdims=True)
        return np.hstack((np.cos(angle), half * np.sinc(angle / pi)))

    def velocity(self, t: Array) -> Array:
        """(N, 3) m/s at times t, inertial: t f + (1-cos x)/x² a×f t + (1-sin x/x)/x² a×(a×f) t.

        a = ω t, x = |a|.
        """
        angle, once, twice = self._products(t)
        column = np.asarray(t)[:, None]
        turned: Array = column * (
            np.array(self.force) + one_minus_cosine(angle) * once + one_minus_sine(angle) * twice
        )
        return turned

    def position(self, t: Array) -> Array:
        """(N, 3) m at times t, inertial: the integral of `velocity`."""
        angle, once, twice = self._products(t)
        square = np.asarray(t)[:, None] ** 2
        moved: Array = square * (
            0.5 * np.array(self.force)
            + one_minus_sine(angle) * once
            + _position_share(angle) * twice
        )
        return moved

    def _products(self, t: Array) -> tuple[Array, Array, Array]:
        """|ωt|, ωt×f, ωt×(ωt×f)."""
        turned = np.outer(t, self.rate)
        once = np.cross(turned, np.array(self.force))
        return np.linalg.norm(turned, axis=1, keepdims=True), once, np.cross(turned, once)


def _position_share(x: Array) -> Array:
    """(x²/2 - 1 + cos x)/x⁴, to rounding for every x: by its series where |x| < 1."""
    small = np.abs(x) < 1
    square, large = np.where(small, x * x, 0.0), np.where(small, 1.0, x)
    series, term = np.zeros_like(square), np.full_like(square, 1 / 24)
    for k in range(2, 12):
        series = series + term
        term = term * -square / ((2 * k + 1) * (2 * k + 2))
    closed = (0.5 - 0.5 * np.sinc(large / (2 * pi)) ** 2) / large**2
    return np.where(small, series, closed)
