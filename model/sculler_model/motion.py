"""Truth motions: known attitude, velocity and position, and the exact samples a sensor would give.

`Motion` moves over the rotating WGS-84 Earth: a path and an attitude made of analytic curves, from
which angular rate and specific force follow without any integration.  `Coning` and `Sculling` are
the classical pure vibrations in inertial space.  Body frame: x forward, y right, z down;
navigation frame: north, east, down.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import cos, factorial, lgamma, log, pi, radians, sin
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from sculler_model.navigation.earth import (
    ECCENTRICITY_SQUARED,
    earth_rate,
    gravity,
    radii,
    transport_rate,
)
from sculler_model.navigation.navigator import NavHistory
from sculler_model.navigation.rotation import Vector, conjugate, cross, product, rotate

Array = NDArray[np.float64]
Triple = tuple[Array, Array, Array]
Four = tuple[Array, Array, Array, Array]

CHUNK = 1 << 15
"""Samples generated at a time."""


@dataclass(frozen=True)
class Curve:
    """An analytic function of time: Σ c_k t^k + Σ A sin(Ω t + φ).

    Attributes:
        powers: c_0, c_1, ...
        waves: (amplitude, Ω in rad/s, phase in rad) of each wave.
    """

    powers: tuple[float, ...] = ()
    waves: tuple[tuple[float, float, float], ...] = ()

    def __call__(self, t: Array, order: int = 0) -> Array:
        """The order-th time derivative at times t (s)."""
        value = np.zeros_like(t)
        for k in range(len(self.powers) - 1, order - 1, -1):
            value = value * t + self.powers[k] * (factorial(k) // factorial(k - order))
        for amplitude, omega, phase in self.waves:
            value += amplitude * omega**order * np.sin(omega * t + (phase + order * pi / 2))
        return value

    def __add__(self, other: Curve) -> Curve:
        width = max(len(self.powers), len(other.powers))
        powers = [0.0] * width
        for curve in (self, other):
            for k, c in enumerate(curve.powers):
                powers[k] += c
        return Curve(tuple(powers), self.waves + other.waves)

    @property
    def highest(self) -> float:
        """The highest frequency in it, rad/s."""
        return max((abs(omega) for _, omega, _ in self.waves), default=0.0)


ZERO = Curve()


@dataclass(frozen=True)
class Turn:
    """A rotation about a fixed axis by an angle that is a curve.

    Attributes:
        axis: unit vector.
        angle: rad.
    """

    axis: Vector
    angle: Curve


X, Y, Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


def coning_turns(half_angle: float, omega: float) -> tuple[Turn, Turn, Turn]:
    """Classical coning as turns: the rotation vector half_angle·(cos Ωt, sin Ωt, 0)."""
    spin = Curve((0.0, omega))
    back = Curve((0.0, -omega))
    return Turn(Z, spin), Turn(X, Curve((half_angle,))), Turn(Z, back)


def attitude(turns: Sequence[Turn], t: Array) -> tuple[Four, Triple]:
    """Product of the turns, first one outermost, and its angular rate.

    Args:
        turns: rotations; the product takes body components to the reference frame.
        t: (N,) times, s.

    Returns:
        Quaternion (four arrays), and the rate (rad/s) of the body against the reference frame in
        the body frame (three arrays).
    """
    one, zero = np.ones_like(t), np.zeros_like(t)
    q: Four = (one, zero, zero, zero)
    rate: Triple = (zero, zero, zero)
    for turn in turns:
        half, speed = 0.5 * turn.angle(t), turn.angle(t, 1)
        sine = np.sin(half)
        x, y, z = turn.axis
        step: Four = (np.cos(half), x * sine, y * sine, z * sine)
        q = product(q, step)
        old_x, old_y, old_z = rotate(conjugate(step), rate)
        rate = (old_x + x * speed, old_y + y * speed, old_z + z * speed)
    return q, rate


def legendre_nodes(phase: float) -> tuple[Array, Array]:
    """Gauss-Legendre nodes and weights on 0..1, enough for a wave of so many radians.

    The error of n nodes over a wave of phase λ is λ^(2n) (n!)^4 / ((2n+1) ((2n)!)³) of the
    wave's amplitude; n is the first that brings it below 1e-17.
    """
    n = 2
    if phase > 0:
        while (
            2 * n * log(phase) + 4 * lgamma(n + 1) - log(2 * n + 1) - 3 * lgamma(2 * n + 1)
        ) > log(1e-17):
            n += 1
    nodes, weights = np.polynomial.legendre.leggauss(n)
    return 0.5 * (nodes + 1), 0.5 * weights


@dataclass(frozen=True)
class Motion:
    """A body moving over the rotating Earth, all of it analytic.

    Attributes:
        lat, lon, h: geodetic position (rad, rad, m) that the path starts from.
        north, east, up: displacement, m; latitude and longitude are the displacement over the
            radii at the starting point, so the path is exact and the metres are nominal.
        turns: attitude, body to north-east-down (first outermost).
        name: what it is.
    """

    lat: float
    lon: float
    h: float
    north: Curve = ZERO
    east: Curve = ZERO
    up: Curve = ZERO
    turns: tuple[Turn, ...] = ()
    name: str = "motion"

    def state(self, t: Array) -> NavHistory:
        """True states at times t (N,), s."""
        (lat, _, _), (lon, _, _), (h, _, _) = self._position(t)
        velocity, _ = self._velocity(t)
        q, _ = attitude(self.turns, t)
        return NavHistory(np.array(t), np.stack(q, 1), np.stack(velocity, 1), lat, lon, h)

    def sensed(self, t: Array) -> Array:
        """What perfect sensors feel at times t (N,).

        Returns:
            (N, 6): ω_ib (rad/s), then specific force (m/s²), in the body frame.
        """
        (lat, _, _), _, (h, _, _) = self._position(t)
        velocity, acceleration = self._velocity(t)
        sin_lat, cos_lat = np.sin(lat), np.cos(lat)
        ie = earth_rate(sin_lat, cos_lat)
        en = transport_rate(sin_lat, cos_lat, h, velocity)

        q, (rate_x, rate_y, rate_z) = attitude(self.turns, t)
        to_body = conjugate(q)
        frame_x, frame_y, frame_z = rotate(to_body, (ie[0] + en[0], ie[1] + en[1], ie[2] + en[2]))
        coriolis = cross((2 * ie[0] + en[0], 2 * ie[1] + en[1], 2 * ie[2] + en[2]), velocity)
        force = rotate(
            to_body,
            (
                acceleration[0] + coriolis[0],
                acceleration[1] + coriolis[1],
                acceleration[2] + coriolis[2] - gravity(sin_lat, h),
            ),
        )
        return np.stack((frame_x + rate_x, frame_y + rate_y, frame_z + rate_z, *force), axis=1)

    def _position(self, t: Array) -> tuple[Triple, Triple, Triple]:
        """Latitude, longitude, height, each with its first and second time derivative."""
        meridian, prime_vertical = radii(sin(self.lat))
        per_north = 1 / (meridian + self.h)
        per_east = 1 / ((prime_vertical + self.h) * cos(self.lat))
        north, east, up = (
            (curve(t), curve(t, 1), curve(t, 2)) for curve in (self.north, self.east, self.up)
        )
        return (
            (self.lat + per_north * north[0], per_north * north[1], per_north * north[2]),
            (self.lon + per_east * east[0], per_east * east[1], per_east * east[2]),
            (self.h + up[0], up[1], up[2]),
        )

    def _velocity(self, t: Array) -> tuple[Triple, Triple]:
        """Velocity over the Earth (m/s) in north, east, down, and its component-wise derivative."""
        (lat, lat1, lat2), (_, lon1, lon2), (h, h1, h2) = self._position(t)
        sin_lat, cos_lat = np.sin(lat), np.cos(lat)
        meridian, prime_vertical = radii(sin_lat)
        # dR/dlat of R_M ~ squash^(-3/2) and R_N ~ squash^(-1/2), squash = 1 - e² sin² lat
        growth = ECCENTRICITY_SQUARED * sin_lat * cos_lat
        growth = growth / (1 - ECCENTRICITY_SQUARED * sin_lat * sin_lat)
        meridian1 = 3 * growth * meridian * lat1
        prime_vertical1 = growth * prime_vertical * lat1
        over_north, over_east = meridian + h, prime_vertical + h
        velocity = (over_north * lat1, over_east * cos_lat * lon1, -h1)
        acceleration = (
            (meridian1 + h1) * lat1 + over_north * lat2,
            (prime_vertical1 + h1) * cos_lat * lon1
            - over_east * sin_lat * lat1 * lon1
            + over_east * cos_lat * lon2,
            -h2,
        )
        return velocity, acceleration

    def increments(self, samples: int, interval: float, first: int = 0) -> Array:
        """Exact integrals of `sensed` over sample intervals.

        Args:
            samples: N, how many.
            interval: T, s.
            first: number of the first sample; sample i covers the time from i T to (i+1) T.

        Returns:
            (N, 6): angle increments (rad) and velocity increments (m/s), to about 1e-15 of their
            size, vibrations to the rounding of their phase Ω t.
        """
        return interval * self._mean(first + np.arange(samples, dtype=np.float64), interval)

    def rates(self, samples: int, interval: float, first: int = 0, filtered: bool = True) -> Array:
        """What rate sensors deliver.

        Args:
            samples: N, how many.
            interval: T, s.
            first: number of the first sample; sample i is taken at time (i+1) T, the end of the
                interval that an increment of this number would cover.
            filtered: average over T, centred: Zeng's filter sinc(Ω T/2); else the plain value.

        Returns:
            (N, 6): rad/s and m/s².
        """
        number = first + np.arange(samples, dtype=np.float64)
        if filtered:
            return self._mean(number + 0.5, interval)
        return self.sensed((number + 1) * interval)

    def _mean(self, number: Array, interval: float) -> Array:
        """Mean of `sensed` from number·T to (number+1)·T, by Gauss-Legendre quadrature."""
        nodes, weights = legendre_nodes(self._highest * interval)
        total = np.zeros((len(number), 6))
        for node, weight in zip(nodes, weights, strict=True):
            total += weight * self.sensed((number + node) * interval)
        return total

    def chunks(
        self, kind: Literal["increment", "rate"], samples: int, interval: float
    ) -> Iterator[Array]:
        """Samples from time 0 on for a sensor of a kind, at most `CHUNK` at a time."""
        for first in range(0, samples, CHUNK):
            count = min(CHUNK, samples - first)
            if kind == "increment":
                yield self.increments(count, interval, first)
            else:
                yield self.rates(count, interval, first)

    @property
    def _highest(self) -> float:
        """A bound on the frequencies (rad/s) that matter: all of them together, and a harmonic."""
        spins = sum(abs(c) for turn in self.turns for c in turn.angle.powers[1:])
        waves = sum(turn.angle.highest for turn in self.turns)
        waves += max(curve.highest for curve in (self.north, self.east, self.up))
        return 2.0 * (spins + waves)


def steady_attitude(roll: float, pitch: float, heading: float) -> tuple[Turn, Turn, Turn]:
    """Constant Euler angles (rad) as turns."""
    return Turn(Z, Curve((heading,))), Turn(Y, Curve((pitch,))), Turn(X, Curve((roll,)))


def at_rest(
    lat: float, lon: float, h: float, roll: float = 0.0, pitch: float = 0.0, heading: float = 0.0
) -> Motion:
    """Standing still on the Earth; angles in rad, height in m."""
    return Motion(lat, lon, h, turns=steady_attitude(roll, pitch, heading), name="at rest")


def turn_motion(
    lat: float = radians(48.0),
    lon: float = radians(11.0),
    h: float = 500.0,
    speed: float = 30.0,
    turn_rate: float = radians(6.0),
    bank: float = radians(5.0),
    coning_half_angle: float = 0.0,
    coning_hz: float = 50.0,
    rocking: float = 0.0,
    shaking: float = 0.0,
    sculling_hz: float = 35.0,
) -> Motion:
    """A vehicle in a steady level turn to the right, with vibration.

    Args:
        lat, lon, h: starting point, rad, rad, m.
        speed, turn_rate, bank: m/s, rad/s, rad.
        coning_half_angle, coning_hz: classical coning about the body's z axis.
        rocking, shaking, sculling_hz: roll amplitude (rad) and vertical acceleration amplitude
            (m/s²) of one vibration, in phase, so that it rectifies sideways (see `Sculling`).
    """
    radius = speed / turn_rate
    sculling = 2 * pi * sculling_hz
    turns = [Turn(Z, Curve((0.0, turn_rate))), Turn(X, Curve((bank,)))]
    if coning_half_angle:
        turns += coning_turns(coning_half_angle, 2 * pi * coning_hz)
    if rocking:
        turns.append(Turn(X, Curve(waves=((rocking, sculling, 0.0),))))
    return Motion(
        lat,
        lon,
        h,
        north=Curve(waves=((radius, turn_rate, 0.0),)),
        east=Curve((radius,), ((-radius, turn_rate, pi / 2),)),
        up=Curve(waves=((-shaking / sculling**2, sculling, 0.0),) if shaking else ()),
        turns=tuple(turns),
        name="turn with vibration" if coning_half_angle or rocking or shaking else "turn",
    )


def demo_motion() -> Motion:
    """The demonstration: 30 m/s in a 6 °/s turn, 0.1° coning at 50 Hz, sculling at 35 Hz.

    Uncorrected, the coning drifts 99 °/h about the body's z, and 0.1° of roll with 10 m/s² of
    vertical vibration at 35 Hz rectifies to 8.7 mm/s² sideways.
    """
    return turn_motion(coning_half_angle=radians(0.1), rocking=radians(0.1), shaking=10.0)


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
        phase = self.omega * interval * (first + 1 + np.arange(samples))
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
