"""Initial attitude of a unit at rest: levelled by gravity, turned to north by Earth's rotation."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import atan2, cos, degrees, hypot, sin

import numpy as np
from numpy.typing import NDArray

from sculler_model.errors import InputError
from sculler_model.frames import (
    EARTH_RATE,
    Quaternion,
    Quaternions,
    conjugate,
    from_rotation_vector,
    product,
    repeated,
    rotate,
    to_dcm,
    vectors,
)
from sculler_model.host import MajorIncrements
from sculler_model.navigation.attitude_estimate import AttitudeEstimate
from sculler_model.navigation.gravity import NORMAL, Gravity, gravity_at
from sculler_model.navigation.sensor_noise import SensorNoise, estimated_noise
from sculler_model.navigation.state import NavState

Array = NDArray[np.float64]

MIN_ALIGNMENT_SECONDS = 10.0
"""Shortest window; a good heading takes minutes."""

ESTIMATED = SensorNoise()
"""Nothing known: the window shows the noise."""

MIN_ALIGNMENT_INTERVALS = 10
"""Shortest window of alignment, in major intervals."""

_SEGMENTS = 128  # parts to see the noise's spectrum in, at most


@dataclass(frozen=True)
class Alignment(AttitudeEstimate):
    """An alignment's result and how good it looks.

    Attributes:
        q: q_nb at the END of the window, body to north-east-down.
        seconds: length of the window.
        horizontal_rate: Earth's horizontal rate as the swing of gravity against the gyros shows
            it, rad/s (true: 7.292e-5 cos lat).
        down_rate: mean rate about the vertical, down, rad/s (true: -7.292e-5 sin lat).
        specific_force: magnitude of the mean specific force, m/s².
        gravity: the model's gravity here, m/s².
        noise: of the sensors, as given or as the window shows it.
        covariance: (3, 3) of the attitude, rad², about north, east and down; a constant bias
            does not show in it, but for what `noise` says of it.
        warnings: what looks wrong, in words.
    """

    q: Quaternion
    seconds: float
    horizontal_rate: float
    down_rate: float
    specific_force: float
    gravity: float
    noise: SensorNoise
    covariance: Array
    warnings: tuple[str, ...]

    @property
    def rate(self) -> float:
        """Earth's rate as measured, rad/s (true: 7.292e-5)."""
        return hypot(self.horizontal_rate, self.down_rate)

    @property
    def latitude(self) -> float:
        """Latitude that the measured rates imply, rad."""
        return atan2(-self.down_rate, self.horizontal_rate)

    def state(self, lat: float, lon: float, h: float, start: float = 0.0) -> NavState:
        """State at rest at the end of the window that began at time `start`."""
        return NavState(start + self.seconds, self.q, (0.0, 0.0, 0.0), lat, lon, h)


def align(
    increments: MajorIncrements,
    interval: float,
    lat: float,
    h: float,
    noise: SensorNoise = ESTIMATED,
    gravity: Gravity = NORMAL,
) -> Alignment:
    """Attitude at the end of a window at rest.

    The rotation vectors chain up to the body's attitude against inertial space since the start,
    whatever small sway or vibration there is; in that frame the specific force must swing round
    with the Earth.  The one rotation that lays the measured swing best upon the known one (least
    squares, Wahba's problem) is the attitude at the start, level and heading together; the chain
    carries it to the end.

    Its covariance is that of this estimate for the noise that the window shows, or that is given:
    a random walk of the gyros, noise of the accelerometers (see `sensor_noise`).

    A constant gyro bias east turns the heading by bias/(Earth's horizontal rate), an accelerometer
    bias tilts the level by bias/g: no alignment at rest can tell them from attitude.

    Args:
        increments: all major intervals of the window, in body axes.
        interval: length of a major interval, s.
        lat: geodetic latitude, rad.
        h: height, m.
        noise: what is known of the sensors; the window shows what is left out.
        gravity: the model of gravity.

    Returns:
        Attitude, its covariance and what looks wrong.

    Raises:
        InputError: an interval is of short history, the window is too short, the unit is not at
            rest (specific force more than 2 % off gravity, or rate over 100 times Earth's), or it
            is too near a pole to find north.
    """
    lean, g = gravity_at(gravity, sin(lat), h)
    refuse_unfit_window(increments, interval, lat, g)
    seconds = len(increments) * interval
    true_horizontal = EARTH_RATE * cos(lat)

    start, end, attitude, level = _levelled(increments, interval, lat, cos(lat) * lean / g)
    back = from_rotation_vector((-true_horizontal * seconds, 0.0, EARTH_RATE * sin(lat) * seconds))
    down = _mean_down(attitude)
    noise, tilts, step = _noise_shown(increments, interval, level, g, noise)
    result = Alignment(
        q=product(back, product(start, end)),
        seconds=seconds,
        horizontal_rate=true_horizontal + _slope(level[:, 1], interval) / g,
        down_rate=float(increments.phi.mean(axis=0) @ down) / interval,
        specific_force=float(np.linalg.norm(level.mean(axis=0))),
        gravity=g,
        noise=noise,
        covariance=_covariance(noise, lat, seconds, tilts, step, g),
        warnings=(),
    )
    return replace(result, warnings=alignment_warnings(result, lat))


def refuse_unfit_window(increments: MajorIncrements, interval: float, lat: float, g: float) -> None:
    """See that a window can be aligned on.

    Raises:
        InputError: as `align`.
    """
    increments.require_whole("alignment")
    count = len(increments)
    seconds = count * interval
    if seconds < MIN_ALIGNMENT_SECONDS or count < MIN_ALIGNMENT_INTERVALS:
        raise InputError(
            f"alignment: {seconds:.3g} s of data in {count} major intervals is too short, give at"
            f" least {MIN_ALIGNMENT_SECONDS:.0f} s and {MIN_ALIGNMENT_INTERVALS} intervals (minutes"
            " for a good heading)"
        )
    if EARTH_RATE * cos(lat) < 0.01 * EARTH_RATE:
        raise InputError(
            f"alignment: at latitude {degrees(lat):.4g}° Earth's horizontal rate is too small to"
            " find north by, align away from the poles or give the attitude"
        )
    mean_rate = float(np.linalg.norm(increments.phi.mean(axis=0))) / interval
    if mean_rate > 100 * EARTH_RATE:
        raise InputError(
            f"alignment: mean rate {degrees(mean_rate):.4g} °/s is over 100 times Earth's, align"
            " at rest, or check the gyro's LSB"
        )
    specific_force = float(np.linalg.norm(increments.dv_sf.mean(axis=0))) / interval
    if abs(specific_force / g - 1) > 0.02:
        raise InputError(
            f"alignment: specific force {specific_force:.5g} m/s² is more than 2 % off gravity"
            f" ({g:.5g} m/s²), align at rest, or check the accelerometer's LSB"
        )


def _levelled(
    increments: MajorIncrements, interval: float, lat: float, leaning: float
) -> tuple[Quaternion, Quaternion, Quaternions, Array]:
    """The attitude that lays the swing of the specific force upon gravity's.

    Args:
        increments, interval, lat: as for `align`.
        leaning: gravity's part north over its part down.

    Returns:
        q_nb at the start; how the body turned from start to end, in inertial space; q_nb before
        every interval; (R, 3) the specific force in north-east-down, m/s².
    """
    count = len(increments)
    # specific force in the inertial frame that the body left, at the middle of every interval
    chain, end = _chain(increments)
    force = np.stack(rotate(chain, vectors(increments.dv_sf / interval)), axis=1)
    # what it must be: against gravity, in the inertial frame that north-east-down left at the start
    swing = _earth_turn(lat, (np.arange(count, dtype=np.float64) + 0.5) * interval)
    up = np.stack(rotate(swing, vectors(np.tile([-leaning, 0.0, -1.0], (count, 1)))), axis=1)
    start = _wahba(force, up)
    # the specific force in north-east-down: constant, but for errors and disturbances
    to_level = product(conjugate(swing), repeated(start, count))
    level = np.stack(rotate(to_level, vectors(force)), axis=1)
    return start, end, product(to_level, chain), level


def _mean_down(attitude: Quaternions) -> Array:
    """(3,) the mean of the down axis in the body."""
    one = np.ones(len(attitude[0]))
    down = np.stack(rotate(conjugate(attitude), (0 * one, 0 * one, one)), axis=1)
    mean: Array = down.mean(axis=0)
    return mean


def _noise_shown(
    increments: MajorIncrements, interval: float, level: Array, g: float, given: SensorNoise
) -> tuple[SensorNoise, int, float]:
    """The noise as given, the rest as the window shows it; in how many parts, of how many s.

    Args:
        increments, interval: of the window.
        level: (R, 3) specific force in north-east-down, m/s².
        g: gravity, m/s².
        given: what is known.
    """
    # ψ turns gravity into the level: -g ψ_E north, g ψ_N east
    tilts, step = _means(level[:, [1, 0]] / (g, -g), interval)
    each = round(step / interval)
    angles = np.cumsum(increments.phi, axis=0)[len(increments) % each + each - 1 :: each]
    return given.completed(estimated_noise(tilts, angles, step, g)), len(tilts), step


def alignment_warnings(found: Alignment, lat: float) -> tuple[str, ...]:
    """What an engineer would want to look at before trusting the attitude."""
    warnings = []
    for name, rate, true in (
        ("horizontal", found.horizontal_rate, EARTH_RATE * cos(lat)),
        ("vertical", found.down_rate, -EARTH_RATE * sin(lat)),
    ):
        if abs(rate - true) > 0.02 * EARTH_RATE:
            warnings.append(
                f"{name} rate {degrees(rate) * 3600:.3f} °/h, but Earth's is"
                f" {degrees(true) * 3600:.3f} °/h here: gyro bias, motion or a wrong latitude"
            )
    excess = found.specific_force / found.gravity - 1
    if abs(excess) > 1e-3:
        warnings.append(
            f"specific force {found.specific_force:.5f} m/s² is {1e3 * excess:+.2f} mg off gravity"
            f" ({found.gravity:.5f} m/s²): accelerometer scale or bias"
        )
    if found.heading_sigma > 0.01:
        warnings.append(
            f"heading is known to {degrees(found.heading_sigma):.2f}° only (1 σ): align longer, or"
            " the sensors are not good enough to find north by"
        )
    return tuple(warnings)


def attitudes_at_rest(
    increments: MajorIncrements, interval: float, lat: float, found: Alignment
) -> tuple[Quaternions, Quaternion]:
    """An alignment's q_nb all through its window, as the gyros carry it.

    Args:
        increments, interval, lat: as `align` had them.
        found: the alignment.

    Returns:
        q_nb at the beginning of every interval, in north-east-down of its MIDDLE, so that it takes
        ΔV_SF to the force over the interval (four arrays); and q_nb at the window's end.
    """
    chain, end = _chain(increments)
    count = len(increments)
    half = -0.5 * EARTH_RATE * count * interval
    back: Quaternion = (cos(half), cos(lat) * sin(half), 0.0, -sin(lat) * sin(half))
    start = product(conjugate(back), product(found.q, conjugate(end)))
    times = (np.arange(count, dtype=np.float64) + 0.5) * interval
    swing = conjugate(_earth_turn(lat, times))
    return product(swing, product(repeated(start, count), chain)), found.q


def _chain(increments: MajorIncrements) -> tuple[Quaternions, Quaternion]:
    """Body attitude since the start, in inertial space: before every interval, and at the end."""
    attitudes: list[Quaternion] = [(1.0, 0.0, 0.0, 0.0)]
    for phi in increments.phi.tolist():
        attitudes.append(product(attitudes[-1], from_rotation_vector(tuple(phi))))
    w, x, y, z = np.array(attitudes[:-1]).T
    return (w, x, y, z), attitudes[-1]


def _earth_turn(lat: float, times: Array) -> Quaternions:
    """Attitude of north-east-down at times (s), against where it was at time 0."""
    half = 0.5 * EARTH_RATE * times
    sine = np.sin(half)
    return np.cos(half), cos(lat) * sine, 0 * sine, -sin(lat) * sine


def _wahba(measured: Array, known: Array) -> Quaternion:
    """The rotation that takes measured vectors best upon known ones (Davenport's q-method)."""
    B = known.T @ measured
    z = np.array([B[2, 1] - B[1, 2], B[0, 2] - B[2, 0], B[1, 0] - B[0, 1]])
    K = np.empty((4, 4))
    K[0, 0] = np.trace(B)
    K[0, 1:] = K[1:, 0] = z
    K[1:, 1:] = B + B.T - np.trace(B) * np.eye(3)
    w, x, y, z = np.linalg.eigh(K)[1][:, -1].tolist()
    sign = -1.0 if w < 0 else 1.0  # else the library's whim
    return (sign * w, sign * x, sign * y, sign * z)


def _slope(values: Array, interval: float) -> float:
    """Slope of the straight line that fits best, values in the middle of consecutive intervals."""
    times = (np.arange(len(values), dtype=np.float64) + 0.5) * interval
    centred = times - times.mean()
    return float(centred @ values / (centred @ centred))


def _means(values: Array, interval: float) -> tuple[Array, float]:
    """Means over at most `_SEGMENTS` equal parts, the odd first values left out; a part's s."""
    each = -(-len(values) // _SEGMENTS)
    count = len(values) // each
    return values[-count * each :].reshape(count, each, -1).mean(axis=1), each * interval


def _covariance(
    noise: SensorNoise, lat: float, seconds: float, count: int, step: float, g: float
) -> Array:
    """(3, 3) of the attitude at the end of the window, rad², about north, east and down.

    In the inertial frame that north-east-down left at the start: where the chain of the gyros has
    turned by ψ_k and the tilt noise is η_k when gravity points along u_k, the least squares take

        -Σ A_k (ψ_k + η_k)        A_k = (Σ P)⁻¹ P_k,  P_k = I - u_k u_kᵀ

    for the attitude at the start, and the attitude at the end is off by that and the last ψ.
    """
    times = seconds - step * (np.arange(count, dtype=np.float64)[::-1] + 0.5)
    swing = np.array([to_dcm(_turned(lat, time)) for time in times.tolist()])
    up = -swing[:, :, 2]
    P = np.eye(3) - up[:, :, None] * up[:, None, :]
    A = np.linalg.solve(P.sum(axis=0), P)
    # what the gyros walk or drift in a step stays in ψ from its middle on
    G = np.eye(3) - (np.cumsum(A[::-1], axis=0)[::-1] - 0.5 * A)
    edges = np.diff(np.concatenate((np.zeros((1, 3, 3)), A, np.zeros((1, 3, 3)))), axis=0)
    drift = (G @ swing).sum(axis=0) * step
    tilted = (A @ swing).sum(axis=0)[:, :2]
    walk, bias = noise.angle_random_walk or 0.0, noise.gyro_bias or 0.0
    white = (noise.velocity_random_walk or 0.0) / g
    blue, tilt = (noise.velocity_noise or 0.0) / g, (noise.accel_bias or 0.0) / g
    total = (
        walk**2 * step * _squares(G)
        + white**2 / step * _squares(A)
        + (blue / step) ** 2 * _squares(edges)
        + bias**2 * drift @ drift.T
        + tilt**2 * tilted @ tilted.T
    )
    end = np.array(to_dcm(_turned(lat, seconds)))
    result: Array = end.T @ total @ end
    return result


def _squares(parts: Array) -> Array:
    """Σ X Xᵀ of (S, 3, 3)."""
    total: Array = np.einsum("kij,klj->il", parts, parts)
    return total


def _turned(lat: float, seconds: float) -> Quaternion:
    """`_earth_turn` for one time."""
    w, x, y, z = (float(part[0]) for part in _earth_turn(lat, np.array([seconds])))
    return (w, x, y, z)
