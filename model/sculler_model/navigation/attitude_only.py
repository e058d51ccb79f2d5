"""Attitude alone: carried without a place, a velocity or gravity; and gyro biases seen at rest."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, degrees, isfinite, nan, pi, radians, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from sculler_model.errors import InputError
from sculler_model.frames import (
    Quaternion,
    Vector,
    earth_rate,
    from_rotation_vector,
    normalised,
    product,
)
from sculler_model.host import MajorIncrements
from sculler_model.navigation.state import NavHistory, NavState, told_times

Array = NDArray[np.float64]

NOWHERE: Vector = (nan, nan, nan)
"""A velocity that nobody knows."""


def attitude_state(time: float, q: Quaternion, lat: float | None = None) -> NavState:
    """A state that tells attitude alone: its velocity and place are NaN.

    Args:
        time: s.
        q: body to north-east-down; where north is not known, to a level frame of one's own.
        lat: geodetic latitude, rad, by which the Earth's rate is taken into account; None for none.
    """
    return NavState(time, q, NOWHERE, nan if lat is None else lat, nan, nan)


class AttitudeNavigator:
    """Carries the attitude over major intervals, and nothing else (a `Mechanisation`).

        q(new) = q(-ω_ie T) q(old) q(φ)

    With a latitude, q takes body components to north-east-down of a place at rest on the turning
    Earth, ω_ie = Ω (cos φ, 0, -sin φ) (Savage-98 Eq. 8; no transport rate, for no velocity is
    known).  Without one, ω_ie is left out: q is against the frame of the start, held still among
    the stars, and on the Earth it turns by 15 °/h.

    Args:
        state: of `attitude_state`; time, attitude and, if known, latitude of the start.
        interval: length of a major interval, s.

    Raises:
        InputError: the quaternion is not of length 1 (to 1e-6), the latitude is outside ±90°, or
            the interval is not > 0.

    Examples:
        >>> from sculler_model.navigation import AttitudeNavigator, attitude_state
        >>> carried = AttitudeNavigator(attitude_state(0.0, (1.0, 0.0, 0.0, 0.0)), 0.01)
        >>> state = carried.update((0.0, 0.0, 0.1))
        >>> [round(angle, 12) for angle in state.euler]
        [0.0, 0.0, 0.1]
    """

    def __init__(self, state: NavState, interval: float) -> None:
        length = sqrt(sum(c * c for c in state.q))
        if not abs(length - 1) <= 1e-6:
            raise InputError(
                f"initial attitude: the quaternion has length {length:.6g}, give length 1"
            )
        if not (isfinite(interval) and interval > 0):
            raise InputError(f"interval: {interval} s is not allowed, give a number > 0")
        if abs(state.lat) > pi / 2:
            raise InputError("latitude: give one from -90° to 90°")
        self._state, self._interval = state, interval
        self._start, self._since = state.time, 0
        minus = [-interval * rate for rate in earth_rate_at(state.lat)]
        self._earth = from_rotation_vector((minus[0], minus[1], minus[2]))

    @property
    def state(self) -> NavState:
        """The state at the end of the last major interval."""
        return self._state

    def update(self, phi: Vector) -> NavState:
        """Carry the attitude over one major interval, by its rotation vector (rad)."""
        self._since += 1
        return self._update(phi, self._start + self._since * self._interval)

    def _update(self, phi: Vector, time: float) -> NavState:
        old = self._state
        if not isfinite(sum(phi)):
            raise InputError(
                f"after {old.time:.3f} s: an increment is not finite, mend the vectors"
            )
        q = product(old.q, from_rotation_vector(phi))
        self._state = old._replace(time=time, q=normalised(product(self._earth, q)))
        return self._state

    def run(self, increments: MajorIncrements) -> NavHistory:
        """Carry the attitude over consecutive major intervals; the states at their ends.

        Raises:
            InputError: an interval is of short history, or an increment is not finite.
        """
        increments.require_whole("navigation")
        times = told_times(increments)
        counted = times is None
        if times is None:
            numbers = self._since + np.arange(1.0, len(increments) + 1)
            times = self._start + numbers * self._interval
        states = []
        for phi, time in zip(increments.phi.tolist(), times.tolist(), strict=True):
            states.append(self._update(tuple(phi), time))
            self._since += 1
        if states and not counted:
            self._start, self._since = states[-1].time, 0
        return NavHistory.from_states(states)


def earth_rate_at(lat: float) -> Vector:
    """ω_ie in north, east, down at a geodetic latitude (rad); zeros for NaN."""
    if not isfinite(lat):
        return (0.0, 0.0, 0.0)
    return earth_rate(sin(lat), cos(lat))


@dataclass(frozen=True)
class RestBias:
    """What the gyros say at rest, beyond the Earth's rate.

    Attributes:
        begin, end: the window, s.
        bias: rad/s, about body axes.
        sigma: rad/s, one standard deviation of it, of the noise that the window shows.
        earth: the Earth's rate was taken off.
        warnings: why it may not have been at rest.
    """

    begin: float
    end: float
    bias: Vector
    sigma: Vector
    earth: bool
    warnings: tuple[str, ...] = ()

    def corrected(self, increments: MajorIncrements, interval: float) -> MajorIncrements:
        """Increments in body axes with the bias taken out of φ and α; ΔV_SF stays as it is."""
        return increments.without_bias(self.bias, interval)


class RestWindow:
    """Gathers what a run sees in a window at rest, for `RestBias`.

    Args:
        begin, end: s; intervals that lie inside count.
        interval: length of a major interval, s.
        before: a bias that was taken out already, rad/s.
    """

    def __init__(self, begin: float, end: float, interval: float, before: Vector) -> None:
        self._begin, self._end, self._interval = begin, end, interval
        self._before, self._earth = np.array(before), False
        self._rates: list[Array] = []

    def see(self, increments: MajorIncrements, history: NavHistory) -> None:
        """Take the next intervals, in body axes, and the states at their ends."""
        slack = 1e-3 * self._interval
        inside = history.time - self._interval >= self._begin - slack
        inside &= history.time <= self._end + slack
        if not inside.any():
            return
        rates = increments.phi[inside] / self._interval
        lat = float(history.lat[0])
        if isfinite(lat):
            self._earth = True
            rates = rates - seen_from_body(history.q[inside], np.array(earth_rate_at(lat)))
        self._rates.append(rates + self._before)

    def found(self) -> RestBias:
        """The bias.

        Raises:
            InputError: fewer than eight intervals of the run lie in the window.
        """
        rates = np.concatenate(self._rates) if self._rates else np.zeros((0, 3))
        if len(rates) < 8:
            raise InputError(
                f"rest: {len(rates)} intervals of the run lie in {self._begin:g} to"
                f" {self._end:g} s, give a window of at least 8 of them inside the run"
            )
        mean = rates.mean(axis=0)
        sigma = rates.std(axis=0, ddof=1) / sqrt(len(rates))
        told = _unrest(rates, mean)
        warnings = [] if told is None else [f"rest: {told}: check that the unit rests there"]
        there, asked = len(rates) * self._interval, self._end - self._begin
        if there < 0.99 * asked - 2 * self._interval:
            warnings.append(f"rest: {there:g} s of the {asked:g} s asked for lie in the run")
        return RestBias(
            self._begin, self._end, _three(mean), _three(sigma), self._earth, tuple(warnings)
        )


LARGEST_BIAS = radians(1.0)
"""rad/s; what is more is taken for motion."""

SMOOTH = 0.3
"""Mean square of neighbours' differences over twice the variance: 1 for noise, small for motion
(von Neumann's ratio)."""


def _unrest(rates: Array, mean: Array) -> str | None:
    """What of (R, 3) rates, rad/s, is no gyro at rest; None if nothing is."""
    if (largest := float(np.abs(mean).max())) > LARGEST_BIAS:
        return f"the mean rate is {degrees(largest):.3g} °/s"
    neighbours = np.mean(np.diff(rates, axis=0) ** 2, axis=0)
    spread = rates.var(axis=0)
    if (neighbours < 2 * SMOOTH * spread).any():
        size = degrees(float(np.sqrt(spread.max())))
        return f"the rates wander by {size:.3g} °/s, more smoothly than noise does"
    return None


def seen_from_body(q: Array, vector: Array) -> Array:
    """(R, 3) of a vector (3,) in the frame that q (R, 4) takes the body's components to."""
    w, axis = q[:, :1], -q[:, 1:]
    turned = 2 * np.cross(axis, np.broadcast_to(vector, axis.shape))
    found: Array = vector + w * turned + np.cross(axis, turned)
    return found


def _three(vector: Array) -> Vector:
    x, y, z = vector.tolist()
    return (x, y, z)
