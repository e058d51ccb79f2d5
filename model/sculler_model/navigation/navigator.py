"""The float low-rate updater: attitude, velocity and position once a major interval.

Frames: body b is x forward, y right, z down; navigation n is north, east, down at the present
geodetic position on WGS-84; q_nb takes body components to navigation components.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import cos, isfinite, pi, sin, sqrt
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from sculler_model.errors import InputError
from sculler_model.host import MajorIncrements
from sculler_model.navigation.earth import earth_rate, gravity, transport_rate
from sculler_model.navigation.rotation import (
    Quaternion,
    Vector,
    cross,
    euler_angles,
    from_rotation_vector,
    product,
    rotate,
)

MIN_HEIGHT, MAX_HEIGHT = -10e3, 1000e3
"""Heights (m) for which the gravity formula is meant."""


class NavState(NamedTuple):
    """Where the body is at one instant.

    Attributes:
        time: s.
        q: q_nb (w, x, y, z), body to north-east-down.
        v: velocity over the Earth (m/s) north, east, down.
        lat, lon: geodetic, rad; lon in -pi..pi.
        h: height above the ellipsoid, m.
    """

    time: float
    q: Quaternion
    v: Vector
    lat: float
    lon: float
    h: float


class Mechanisation(Protocol):
    """Anything that carries a `NavState` over major intervals.

    `Navigator` is the geographic one; `navigate` and `trajectory` take any other.
    """

    @property
    def state(self) -> NavState:
        """The state at the end of the last update."""

    def update(self, phi: Vector, dv_sf: Vector) -> NavState:
        """Carry the state over one major interval; the state at its end."""


class Navigator:
    """Geographic mechanisation: north-pointing local level, trapezoidal position.

    Each update follows the order of Savage-98 Table 1: velocity with gravity and Coriolis at the
    extrapolated middle of the interval (Savage-98 Eq. 7-8; Yang Eq. 16-20), then position by the
    trapezoid, then attitude with the local level's rotation from the new velocity and position.

    Args:
        state: at the start of the first interval.
        interval: length of a major interval, s.

    Raises:
        InputError: the state is not one to navigate from (see `check_state`).
    """

    def __init__(self, state: NavState, interval: float) -> None:
        check_state(state)
        if not (isfinite(interval) and interval > 0):
            raise InputError(f"interval: {interval} s is not allowed, give a number > 0")
        self._start, self._updates, self._interval = state.time, 0, interval
        self._state = self._past = state

    @property
    def state(self) -> NavState:
        """The state at the end of the last update."""
        return self._state

    def update(self, phi: Vector, dv_sf: Vector) -> NavState:
        """Carry the state over one major interval.

        Args:
            phi: rotation vector of the body over the interval, against inertial space, rad.
            dv_sf: integral of the specific force (m/s) in the body frame at the interval's start.

        Returns:
            The state at the interval's end.

        Raises:
            InputError: the track has reached a pole, where north and longitude end.
        """
        T = self._interval
        past, old = self._past, self._state

        # velocity: values at the middle, extrapolated from the past
        v_mid: Vector = (
            1.5 * old.v[0] - 0.5 * past.v[0],
            1.5 * old.v[1] - 0.5 * past.v[1],
            1.5 * old.v[2] - 0.5 * past.v[2],
        )
        lat_mid, h_mid = 1.5 * old.lat - 0.5 * past.lat, 1.5 * old.h - 0.5 * past.h
        sin_mid, cos_mid = sin(lat_mid), cos(lat_mid)
        ie_n, ie_e, ie_d = earth_rate(sin_mid, cos_mid)
        en_n, en_e, en_d = transport_rate(sin_mid, cos_mid, h_mid, v_mid)
        half_zeta = (0.5 * T * (ie_n + en_n), 0.5 * T * (ie_e + en_e), 0.5 * T * (ie_d + en_d))

        dv_n, dv_e, dv_d = dv = rotate(old.q, dv_sf)
        turn_n, turn_e, turn_d = cross(half_zeta, dv)  # (I - ½ζ×) C_nb ΔV_SF
        coriolis = cross((2 * ie_n + en_n, 2 * ie_e + en_e, 2 * ie_d + en_d), v_mid)
        v: Vector = (
            old.v[0] + dv_n - turn_n - T * coriolis[0],
            old.v[1] + dv_e - turn_e - T * coriolis[1],
            old.v[2] + dv_d - turn_d - T * coriolis[2] + T * gravity(sin_mid, h_mid),
        )

        # position: trapezoid, the curvature taken at its middle
        v_mean: Vector = (0.5 * (old.v[0] + v[0]), 0.5 * (old.v[1] + v[1]), 0.5 * (old.v[2] + v[2]))
        h = old.h - T * v_mean[2]
        h_mid = 0.5 * (old.h + h)
        _, en_e, _ = transport_rate(sin_mid, cos_mid, h_mid, v_mean)
        lat = old.lat - T * en_e
        lat_mid = 0.5 * (old.lat + lat)
        sin_mid, cos_mid = sin(lat_mid), cos(lat_mid)
        en_n, en_e, en_d = transport_rate(sin_mid, cos_mid, h_mid, v_mean)
        lon = old.lon + T * en_n / cos_mid
        if not abs(lat) < pi / 2 or abs(lon - old.lon) > 1:
            raise InputError(
                f"time {old.time:.3f} s: the track has reached a pole, where the north-pointing"
                " navigator cannot follow; keep the track away from the poles"
            )

        # attitude: q_nb(new) = q(-ζ) q_nb(old) q(φ)
        ie_n, ie_e, ie_d = earth_rate(sin_mid, cos_mid)
        minus_zeta = (-T * (ie_n + en_n), -T * (ie_e + en_e), -T * (ie_d + en_d))
        q = product(old.q, from_rotation_vector(phi))
        q = normalised(product(from_rotation_vector(minus_zeta), q))

        self._updates += 1
        time = self._start + self._updates * T
        self._past, self._state = old, NavState(time, q, v, lat, _wrapped(lon), h)
        return self._state


def normalised(q: Quaternion) -> Quaternion:
    """q brought back to length 1 from a rounding error away."""
    w, x, y, z = q
    scale = 1.5 - 0.5 * (w * w + x * x + y * y + z * z)
    return (w * scale, x * scale, y * scale, z * scale)


def _wrapped(lon: float) -> float:
    if lon > pi:
        return lon - 2 * pi
    return lon + 2 * pi if lon < -pi else lon


def check_state(state: NavState) -> None:
    """Refuse a state that cannot be navigated from.

    Raises:
        InputError: a number is not finite, the latitude is not below ±90° (longitude and north
            end there), the longitude is outside ±180°, the height is outside
            `MIN_HEIGHT`..`MAX_HEIGHT`, or the quaternion is not of length 1 (to 1e-6).
    """
    numbers = (state.time, *state.q, *state.v, state.lat, state.lon, state.h)
    if not all(isfinite(number) for number in numbers):
        raise InputError(f"initial state: a value is not finite in {state}, give numbers")
    if not abs(state.lat) < pi / 2:
        raise InputError(
            f"initial state: latitude {state.lat * 180 / pi:.6g}° is not allowed, give one between"
            " -90° and 90°, the poles left out"
        )
    if abs(state.lon) > pi:
        raise InputError(
            f"initial state: longitude {state.lon * 180 / pi:.6g}° is not allowed, give one from"
            " -180° to 180°"
        )
    if not MIN_HEIGHT <= state.h <= MAX_HEIGHT:
        raise InputError(
            f"initial state: height {state.h:.6g} m is not allowed, give one from"
            f" {MIN_HEIGHT:.0f} m to {MAX_HEIGHT:.0f} m above the ellipsoid"
        )
    length = sqrt(sum(c * c for c in state.q))
    if abs(length - 1) > 1e-6:
        raise InputError(f"initial state: the quaternion has length {length:.6g}, give length 1")


@dataclass(frozen=True)
class NavHistory:
    """States at many instants, as arrays (see `NavState` for frames and units).

    Attributes:
        time: (N,) s.
        q: (N, 4) body to north-east-down, scalar first.
        v: (N, 3) m/s north, east, down.
        lat, lon: (N,) rad.
        h: (N,) m.
    """

    time: NDArray[np.float64]
    q: NDArray[np.float64]
    v: NDArray[np.float64]
    lat: NDArray[np.float64]
    lon: NDArray[np.float64]
    h: NDArray[np.float64]

    @classmethod
    def from_states(cls, states: Sequence[NavState]) -> NavHistory:
        """Collect states."""
        flat = np.array([(s.time, *s.q, *s.v, s.lat, s.lon, s.h) for s in states]).reshape(-1, 11)
        return cls(flat[:, 0], flat[:, 1:5], flat[:, 5:8], *flat[:, 8:].T)

    @classmethod
    def concatenate(cls, parts: Sequence[NavHistory]) -> NavHistory:
        """Join in order.

        Raises:
            ValueError: there is no part.
        """
        fields = ("time", "q", "v", "lat", "lon", "h")
        return cls(*(np.concatenate([getattr(part, name) for part in parts]) for name in fields))

    def __len__(self) -> int:
        return len(self.time)

    def state(self, row: int) -> NavState:
        """The state of one row."""
        w, x, y, z = self.q[row].tolist()
        north, east, down = self.v[row].tolist()
        return NavState(
            float(self.time[row]),
            (w, x, y, z),
            (north, east, down),
            float(self.lat[row]),
            float(self.lon[row]),
            float(self.h[row]),
        )

    @property
    def euler(self) -> NDArray[np.float64]:
        """(N, 3) roll, pitch, heading, rad."""
        return euler_angles(self.q)


def trajectory(
    mechanisation: Mechanisation, increments: Iterable[MajorIncrements]
) -> Iterator[NavHistory]:
    """States at the end of every major interval, one `NavHistory` for each block of increments.

    Memory holds one block at a time, so a day-long log runs in as little as a short one.

    Raises:
        InputError: an increment is not finite, or the mechanisation cannot follow the track.
    """
    for block in increments:
        if not (np.isfinite(block.phi).all() and np.isfinite(block.dv_sf).all()):
            raise InputError(
                f"after {mechanisation.state.time:.3f} s: an increment is not finite, mend the"
                " vectors"
            )
        yield NavHistory.from_states(
            [
                mechanisation.update(tuple(phi), tuple(dv_sf))
                for phi, dv_sf in zip(block.phi.tolist(), block.dv_sf.tolist(), strict=True)
            ]
        )


def navigate(
    initial: NavState,
    interval: float,
    increments: MajorIncrements | Iterable[MajorIncrements],
    mechanisation: Callable[[NavState, float], Mechanisation] = Navigator,
) -> NavHistory:
    """The whole track: the initial state, then the state at the end of every major interval.

    Args:
        initial: state at the start of the first interval.
        interval: length of a major interval, s.
        increments: in body axes; one block or several in order.
        mechanisation: what carries the state.

    Raises:
        InputError: see `check_state` and `trajectory`.
    """
    blocks = [increments] if isinstance(increments, MajorIncrements) else increments
    parts = trajectory(mechanisation(initial, interval), blocks)
    return NavHistory.concatenate([NavHistory.from_states([initial]), *parts])
