"""Fine alignment at rest: a Kalman filter on the velocity that a level unit must not gain.

`align` fits one attitude to the whole window and takes the gyros at their word.  Here their
random walk and constant bias have their place, so that the attitude at the END of the window is as
good as the sensors allow:

    heading   sqrt((bias_E)² + N²/T) / (Ω cos lat)      bias_E, N: east gyro's bias, random walk
    level     by the accelerometers' noise over the last seconds, not by gyro drift over them all

A constant accelerometer bias is still taken for tilt, and the east gyro's for heading: nothing at
rest tells them apart.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import cos, isfinite, sin

import numpy as np
from numpy.typing import NDArray

from sculler_model.errors import InputError
from sculler_model.host import MajorIncrements
from sculler_model.navigation.alignment import Alignment, align, attitudes_at_rest
from sculler_model.navigation.earth import EARTH_RATE, gravity, gravity_lean
from sculler_model.navigation.rotation import (
    Quaternion,
    Vector,
    conjugate,
    from_rotation_vector,
    product,
    rotate,
    to_euler,
)
from sculler_model.navigation.state import NavState

Array = NDArray[np.float64]

STEP_SECONDS = 1.0
"""About the time from one look at the velocity to the next."""

_TILT, _HEADING = 0.01, 0.1  # rad, what the coarse attitude surely keeps to


@dataclass(frozen=True)
class SensorNoise:
    """What to expect of the sensors, one standard deviation, each axis.

    Attributes:
        angle_random_walk: N, rad/√s.
        velocity_random_walk: m/s/√s.
        gyro_bias: constant over the window, rad/s.
        velocity_noise: of the velocity at one instant, m/s: quantisation, and sway of the unit.

    Raises:
        InputError: a number is negative or not finite, or `velocity_noise` is 0.
    """

    angle_random_walk: float = 0.002 / 60 * np.pi / 180
    velocity_random_walk: float = 5e-5
    gyro_bias: float = 0.01 / 3600 * np.pi / 180
    velocity_noise: float = 1e-3

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not (isfinite(value) and value >= 0) or (name == "velocity_noise" and value == 0):
                raise InputError(
                    f"sensor noise: {name} {value} is not allowed, give a positive number"
                )


NAVIGATION_GRADE = SensorNoise()
"""0.002 °/√h, 5 µg/√Hz, 0.01 °/h, 1 mm/s."""


@dataclass(frozen=True)
class FineAlignment:
    """The filter's result and what it may be off, one standard deviation.

    Attributes:
        coarse: where it started from.
        q: q_nb at the END of the window, body to north-east-down.
        sigma: of the attitude, rad, about north, east and down (level, level, heading).
        gyro_bias: estimated, rad/s, in body axes; what the gyros show too much.
        gyro_bias_sigma: rad/s, in north, east, down.
        surprise: mean square of what the velocity did against what was expected, in standard
            deviations; about 1 or less if `SensorNoise` is right.
    """

    coarse: Alignment
    q: Quaternion
    sigma: Vector
    gyro_bias: Vector
    gyro_bias_sigma: Vector
    surprise: float

    @property
    def euler(self) -> Vector:
        """Roll, pitch, heading, rad."""
        return to_euler(self.q)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What looks wrong, in words; the coarse stage's first."""
        found = list(self.coarse.warnings)
        if self.surprise > 4:
            found.append(
                f"velocity strays {self.surprise**0.5:.1f} times as far as the stated noise: the"
                " unit moved, or its sensors are worse than stated"
            )
        return tuple(found)

    def corrected(self, increments: MajorIncrements, interval: float) -> MajorIncrements:
        """Increments to navigate with, in body axes, the estimated gyro bias taken out.

        Args:
            increments: φ and α (rad) as the gyros give them; ΔV_SF stays as it is.
            interval: length of a major interval, s.
        """
        turned = interval * np.array(self.gyro_bias)
        return replace(increments, phi=increments.phi - turned, alpha=increments.alpha - turned)

    def state(self, lat: float, lon: float, h: float, start: float = 0.0) -> NavState:
        """State at rest at the end of the window that began at time `start`."""
        at_rest = self.coarse.state(lat, lon, h, start)
        return at_rest._replace(q=self.q)


def align_finely(
    increments: MajorIncrements,
    interval: float,
    lat: float,
    h: float,
    noise: SensorNoise = NAVIGATION_GRADE,
) -> FineAlignment:
    """Attitude at the end of a window at rest, by `align` and then a Kalman filter.

    The coarse attitude, carried on with the gyros, resolves the specific force; its sum with
    gravity is the velocity that the unit seems to gain.  The states are the attitude error ψ, this
    velocity and the gyros' bias ε, in north-east-down:

        ψ' = -ω_ie × ψ + ε + noise      δv_N' = -g ψ_E + noise      δv_E' = g ψ_N + noise

    Args:
        increments: all major intervals of the window, in body axes.
        interval: length of a major interval, s.
        lat: geodetic latitude, rad.
        h: height, m.
        noise: what to expect of the sensors.

    Raises:
        InputError: as `align`.
    """
    coarse = align(increments, interval, lat, h)
    q, end = attitudes_at_rest(increments, interval, lat, coarse)
    gained = np.stack(rotate(q, (*increments.dv_sf.T,)), axis=1)[:, :2]
    gained[:, 0] += interval * cos(lat) * gravity_lean(sin(lat), h)
    per_step = max(1, round(STEP_SECONDS / interval))
    steps = len(gained) // per_step
    first = len(gained) - steps * per_step  # the odd ones go at the beginning
    velocity = np.cumsum(gained[first:].reshape(steps, per_step, 2).sum(axis=1), axis=0)

    rates = _dynamics(lat, h)
    transition, spread = _discrete(rates, noise, per_step * interval)
    x = np.zeros(8)
    sigmas = [_TILT, _TILT, _HEADING, *[noise.velocity_noise] * 2, *[noise.gyro_bias] * 3]
    P = np.diag(np.square(sigmas))
    R = noise.velocity_noise**2 * np.eye(2)
    surprise = 0.0
    for seen in velocity:
        x, P = transition @ x, transition @ P @ transition.T + spread
        strayed, S = seen - x[3:5], P[3:5, 3:5] + R
        gain = np.linalg.solve(S, P[3:5]).T
        surprise += float(strayed @ np.linalg.solve(S, strayed)) / (2 * steps)
        x = x + gain @ strayed
        keep = np.eye(8)
        keep[:, 3:5] -= gain
        P = keep @ P @ keep.T + gain @ R @ gain.T  # Joseph's form stays symmetric and positive
    psi_n, psi_e, psi_d, _, _, *bias = x.tolist()
    fine = product(from_rotation_vector((-psi_n, -psi_e, -psi_d)), end)
    sigma_n, sigma_e, sigma_d, _, _, bias_n, bias_e, bias_d = np.sqrt(np.diag(P)).tolist()
    return FineAlignment(
        coarse=coarse,
        q=fine,
        sigma=(sigma_n, sigma_e, sigma_d),
        gyro_bias=rotate(conjugate(fine), (bias[0], bias[1], bias[2])),
        gyro_bias_sigma=(bias_n, bias_e, bias_d),
        surprise=surprise,
    )


def _dynamics(lat: float, h: float) -> Array:
    """F of x' = F x; x is ψ (3), δv north and east, ε (3)."""
    g, north, down = gravity(sin(lat), h), EARTH_RATE * cos(lat), -EARTH_RATE * sin(lat)
    F = np.zeros((8, 8))
    F[:3, :3] = -np.array([[0, -down, 0], [down, 0, -north], [0, north, 0]])
    F[:3, 5:] = np.eye(3)
    F[3, 1], F[4, 0] = -g, g
    return F


def _discrete(F: Array, noise: SensorNoise, seconds: float) -> tuple[Array, Array]:
    """Transition over so many seconds, and the covariance of the noise that comes in meanwhile."""
    rates = [noise.angle_random_walk**2] * 3 + [noise.velocity_random_walk**2] * 2 + [0.0] * 3
    spread = np.zeros((8, 8))
    for node, weight in zip(*np.polynomial.legendre.leggauss(4), strict=True):
        to_end = _exponential(F * (0.5 + 0.5 * node) * seconds)
        spread += 0.5 * weight * seconds * to_end @ np.diag(rates) @ to_end.T
    return _exponential(F * seconds), spread


def _exponential(A: Array) -> Array:
    """e^A, by its series: the powers of a few seconds' dynamics die out at once."""
    total = term = np.eye(len(A))
    for k in range(1, 12):
        term = term @ A / k
        total = total + term
    return total
