"""The geographic mechanisation: north-pointing local level, latitude and longitude themselves.

Simpler than the wander azimuth and independent of it, but it ends at the poles.
"""

from __future__ import annotations

from math import cos, isfinite, pi, sin

import numpy as np

from sculler_model.errors import InputError
from sculler_model.frames import (
    Vector,
    cross,
    earth_rate,
    from_rotation_vector,
    normalised,
    plus,
    product,
    rotate,
    transport_rate,
)
from sculler_model.host import MajorIncrements
from sculler_model.navigation.gravity import NORMAL, Gravity, covers, gravity_at, refuse_outside
from sculler_model.navigation.height import HeightDamping, HeightKeeper, Held
from sculler_model.navigation.state import (
    NavHistory,
    NavState,
    VectorLike,
    check_state,
    three_numbers,
    told_times,
    wrapped,
)
from sculler_model.navigation.wander import above


class GeographicNavigator:
    """Geographic mechanisation: north-pointing local level, trapezoidal position.

    Each update follows the order of Savage-98 Table 1: velocity with gravity and Coriolis at the
    extrapolated middle of the interval (Savage-98 Eq. 7-8; Yang Eq. 16-20), then position by the
    trapezoid, then attitude with the local level's rotation from the new velocity and position.

    Args:
        state: at the start of the first interval.
        interval: length of a major interval, s.
        gravity: the model to navigate by.
        height_damping: a loop that holds the height; none if left out.

    Raises:
        InputError: the state is not one to navigate from (see `check_state`), at a pole, or
            outside a gravity table; the damping is too fast for the intervals.
    """

    def __init__(
        self,
        state: NavState,
        interval: float,
        gravity: Gravity = NORMAL,
        height_damping: HeightDamping | None = None,
    ) -> None:
        check_state(state)
        refuse_outside(gravity, state.time, state.lat, state.h)
        if not abs(state.lat) < pi / 2:
            raise InputError(
                "initial state: at a pole there is no north to point to, use the wander azimuth"
            )
        if not (isfinite(interval) and interval > 0):
            raise InputError(f"interval: {interval} s is not allowed, give a number > 0")
        if height_damping:
            height_damping.fits(interval)
        self._gains = height_damping.gains if height_damping else (0.0, 0.0, 0.0)
        self._keeper, self._offset = HeightKeeper(height_damping, interval), 0.0
        # the time counts from `_start` on, by intervals
        self._start, self._since, self._interval = state.time, 0, interval
        self._gravity = gravity
        self._state = self._past = state._replace(wander=0.0)

    @property
    def state(self) -> NavState:
        """The state at the end of the last update."""
        return self._state

    def update(
        self,
        phi: VectorLike,
        dv_sf: VectorLike,
        *,
        height: float | None = None,
        height_age: float = 0.0,
    ) -> NavState:
        """Carry the state over one major interval; each vector a tuple, list or (3,) array.

        Args:
            phi: rotation vector of the body over the interval, against inertial space, rad.
            dv_sf: integral of the specific force (m/s) in the body frame at the interval's start.
            height, height_age: a measured height (m) and its age (s), as of `Navigator.update`.

        Returns:
            The state at the interval's end.

        Raises:
            InputError: an argument is not three finite numbers; the track has reached a pole,
                where north and longitude end; the height has run away, or the gravity table ends.
        """
        time = self._start + (self._since + 1) * self._interval
        turn, dv = three_numbers("phi", phi), three_numbers("dv_sf", dv_sf)
        if height is not None:
            self._keeper.measured(height, height_age)
        state = self._update(turn, dv, time, self._keeper.held)
        self._keeper.passed()
        self._since += 1
        return state

    def _update(self, phi: Vector, dv_sf: Vector, time: float, held: Held) -> NavState:
        T = self._interval
        past, old = self._past, self._state
        if not isfinite(sum(phi) + sum(dv_sf)):
            raise InputError(
                f"after {old.time:.3f} s: an increment is not finite, mend the vectors"
            )

        # velocity: values at the middle, extrapolated from the past
        v_mid = plus(old.v, plus(old.v, past.v, -1.0), 0.5)
        lat_mid, h_mid = 1.5 * old.lat - 0.5 * past.lat, 1.5 * old.h - 0.5 * past.h
        sin_mid, cos_mid = sin(lat_mid), cos(lat_mid)
        ie_n, ie_e, ie_d = earth_rate(sin_mid, cos_mid)
        en_n, en_e, en_d = transport_rate(sin_mid, cos_mid, h_mid, v_mid)
        zeta = (T * (ie_n + en_n), T * (ie_e + en_e), T * (ie_d + en_d))

        dv = rotate(old.q, dv_sf)
        once = cross(zeta, dv)  # (I - ½ζ× + (ζ×)²/12) C_nb ΔV_SF
        dv = plus(plus(dv, once, -0.5), cross(zeta, once), 1 / 12)
        coriolis = cross((2 * ie_n + en_n, 2 * ie_e + en_e, 2 * ie_d + en_d), v_mid)
        north, east, down = plus(plus(old.v, dv, 1.0), coriolis, -T)
        lean, pulled = gravity_at(self._gravity, sin_mid, h_mid)
        k1, k2, k3 = self._gains
        too_high = above(old.h, old.v[2], held)
        self._offset += T * k3 * too_high
        pulled += k2 * too_high + self._offset
        v: Vector = (north + T * cos_mid * lean, east, down + T * pulled)

        # position: trapezoid, the curvature taken at its middle
        v_mean: Vector = (0.5 * (old.v[0] + v[0]), 0.5 * (old.v[1] + v[1]), 0.5 * (old.v[2] + v[2]))
        h = old.h - T * v_mean[2] - T * k1 * too_high
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
                " mechanisation cannot follow, use the wander azimuth"
            )

        # attitude: q_nb(new) = q(-ζ) q_nb(old) q(φ)
        ie_n, ie_e, ie_d = earth_rate(sin_mid, cos_mid)
        minus_zeta = (-T * (ie_n + en_n), -T * (ie_e + en_e), -T * (ie_d + en_d))
        q = product(old.q, from_rotation_vector(phi))
        q = normalised(product(from_rotation_vector(minus_zeta), q))

        if not covers(self._gravity, lat, h):
            refuse_outside(self._gravity, time, lat, h)
        self._past, self._state = old, NavState(time, q, v, lat, wrapped(lon), h)
        return self._state

    def run(self, increments: MajorIncrements) -> NavHistory:
        """Carry the state over consecutive major intervals; the states at their ends.

        The position is by the trapezoid, whether or not ΔR_SF is there.

        Raises:
            InputError: an interval is of short history, an increment is not finite, or the track
                has reached a pole.
        """
        increments.require_whole("navigation")
        times = told_times(increments)
        count = len(increments)
        heights = np.broadcast_to(self._keeper.told(increments.heights, count), (count, 2))
        counted = times is None
        if times is None:
            times = self._start + (self._since + np.arange(1.0, count + 1)) * self._interval
        vectors = (increments.phi.tolist(), increments.dv_sf.tolist(), heights.tolist())
        states = []
        for p, v, held, time in zip(*vectors, times.tolist(), strict=True):
            states.append(self._update(tuple(p), tuple(v), time, tuple(held)))
            self._since += 1
        if states and not counted:
            self._start, self._since = states[-1].time, 0
        return NavHistory.from_states(states)
