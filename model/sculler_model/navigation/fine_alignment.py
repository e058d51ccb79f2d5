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

from dataclasses import dataclass
from math import cos, nan, sin

import numpy as np
from numpy.typing import NDArray

from sculler_model.frames import (
    EARTH_RATE,
    Quaternion,
    Vector,
    conjugate,
    from_rotation_vector,
    product,
    rotate,
    vectors,
)
from sculler_model.host import MajorIncrements
from sculler_model.navigation.alignment import (
    ESTIMATED,
    Alignment,
    align,
    attitudes_at_rest,
)
from sculler_model.navigation.attitude_estimate import AttitudeEstimate
from sculler_model.navigation.gravity import NORMAL, Gravity, gravity_at
from sculler_model.navigation.sensor_noise import SensorNoise
from sculler_model.navigation.state import NavState

Array = NDArray[np.float64]

STEP_SECONDS = 1.0
"""About the time from one look at the velocity to the next."""

_TILT, _HEADING = 0.01, 0.1  # rad, what a good coarse attitude surely keeps to
_SURELY = 10  # sigmas of the coarse attitude, which is of the same data: no knowledge of its own
_ANY_BIAS = 10 * EARTH_RATE
_ROUNDING = 1e-7  # m/s


@dataclass(frozen=True)
class FineAlignment(AttitudeEstimate):
    """The filter's result and what it may be off, one standard deviation.

    Attributes:
        coarse: where it started from.
        q: q_nb at the END of the window, body to north-east-down.
        covariance: (3, 3) of the attitude, rad², about north, east and down.
        gyro_bias: estimated, rad/s, in body axes; what the gyros show too much.
        gyro_bias_sigma: rad/s, in north, east, down; NaN where it cannot be seen and nothing is
            known of it: it is then taken to be 0.
        surprise: mean normalised innovation squared: of what the velocity did against what was
            expected, in standard deviations; about 1 or less if the noise is what it was said to
            be.
    """

    coarse: Alignment
    q: Quaternion
    covariance: Array
    gyro_bias: Vector
    gyro_bias_sigma: Vector
    surprise: float

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
        return increments.without_bias(self.gyro_bias, interval)

    def state(self, lat: float, lon: float, h: float, start: float = 0.0) -> NavState:
        """State at rest at the end of the window that began at time `start`."""
        at_rest = self.coarse.state(lat, lon, h, start)
        return at_rest._replace(q=self.q)


def align_finely(
    increments: MajorIncrements,
    interval: float,
    lat: float,
    h: float,
    noise: SensorNoise = ESTIMATED,
    gravity: Gravity = NORMAL,
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
        noise: what is known of the sensors; the window shows what is left out.  Without a
            `gyro_bias` the one about north is found, for the level drifts by it, and the others
            are taken for none.
        gravity: the model of gravity.

    Returns:
        Attitude and gyro bias with their covariance, and how well the noise explains the window.

    Raises:
        InputError: as `align`.
    """
    coarse = align(increments, interval, lat, h, noise, gravity)
    noise = coarse.noise
    lean, g = gravity_at(gravity, sin(lat), h)
    q, end = attitudes_at_rest(increments, interval, lat, coarse)
    gained = np.stack(rotate(q, vectors(increments.dv_sf)), axis=1)[:, :2]
    gained[:, 0] += interval * cos(lat) * lean
    per_step = max(1, round(STEP_SECONDS / interval))
    steps = len(gained) // per_step
    first = len(gained) - steps * per_step  # the odd ones go at the beginning
    velocity = np.cumsum(gained[first:].reshape(steps, per_step, 2).sum(axis=1), axis=0)

    transition, spread = _discrete(_dynamics(lat, g), noise, per_step * interval)
    x, P, surprise = _filtered(velocity, transition, spread, coarse)
    psi_n, psi_e, psi_d, _, _, bias_n, bias_e, bias_d = x.tolist()
    fine = product(from_rotation_vector((-psi_n, -psi_e, -psi_d)), end)
    spread_n, spread_e, spread_d = np.sqrt(np.diag(P)[5:]).tolist()
    unseen = noise.gyro_bias is None
    return FineAlignment(
        coarse=coarse,
        q=fine,
        covariance=P[:3, :3] + _tilts(noise, g),
        gyro_bias=rotate(conjugate(fine), (bias_n, bias_e, bias_d)),
        gyro_bias_sigma=(spread_n, nan if unseen else spread_e, nan if unseen else spread_d),
        surprise=surprise,
    )


def _filtered(
    velocity: Array, transition: Array, spread: Array, coarse: Alignment
) -> tuple[Array, Array, float]:
    """The Kalman filter over all steps: the states, their covariance, and the surprise.

    Args:
        velocity: (S, 2) that the unit seems to have gained, north and east, m/s.
        transition, spread: (8, 8) over a step, and the covariance of its noise.
        coarse: where it starts.
    """
    noise, steps = coarse.noise, len(velocity)
    x = np.zeros(8)
    seen_at_once = max(noise.velocity_noise or 0.0, _ROUNDING)
    bias = [noise.gyro_bias] * 3 if noise.gyro_bias is not None else [_ANY_BIAS, 0.0, 0.0]
    least = (_TILT, _TILT, _HEADING)
    attitude = [max(a, _SURELY * b) for a, b in zip(least, coarse.sigma, strict=True)]
    P = np.diag(np.square([*attitude, seen_at_once, seen_at_once, *bias]))
    R = seen_at_once**2 * np.eye(2)
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
    return x, P, surprise


def _tilts(noise: SensorNoise, g: float) -> Array:
    """(3, 3) of the attitude that the accelerometers' biases are taken for, rad²."""
    tilt = (noise.accel_bias or 0.0) / g
    return np.diag([tilt**2, tilt**2, 0.0])


def _dynamics(lat: float, g: float) -> Array:
    """F of x' = F x; x is ψ (3), δv north and east, ε (3)."""
    north, down = EARTH_RATE * cos(lat), -EARTH_RATE * sin(lat)
    F = np.zeros((8, 8))
    F[:3, :3] = -np.array([[0, -down, 0], [down, 0, -north], [0, north, 0]])
    F[:3, 5:] = np.eye(3)
    F[3, 1], F[4, 0] = -g, g
    return F


def _discrete(F: Array, noise: SensorNoise, seconds: float) -> tuple[Array, Array]:
    """Transition over so many seconds, and the covariance of the noise that comes in meanwhile."""
    walk, force = noise.angle_random_walk or 0.0, noise.velocity_random_walk or 0.0
    rates = [walk**2] * 3 + [force**2] * 2 + [0.0] * 3
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
