"""Errors of a navigated track against the truth: attitude, velocity, position, and their growth.

An error is estimate less truth, in the true north-east-down axes.  So that it means the same at a
pole as elsewhere, the estimate's north is first carried to the true place the shortest way: what is
left out is the turning of north with longitude, tan(lat)/R for every metre of error east.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from sculler_model.errors import InputError
from sculler_model.navigation import NavHistory
from sculler_model.navigation.earth import ECCENTRICITY_SQUARED, radii
from sculler_model.navigation.rotation import conjugate, product, rotate

Array = NDArray[np.float64]
Four = tuple[Array, Array, Array, Array]
Triple = tuple[Array, Array, Array]

SAME_INSTANT = 1e-8
"""Two times (s) no further apart are the same instant."""

NAUTICAL_MILE = 1852.0
"""m."""


@dataclass(frozen=True)
class NavErrors:
    """Errors at N instants, each (N, 3): north, east, down.

    Attributes:
        time: (N,) s.
        attitude: rotation vector from the true to the estimated body, rad: tilt about north, tilt
            about east, heading.
        velocity: m/s.
        position: m.
    """

    time: Array
    attitude: Array
    velocity: Array
    position: Array

    @property
    def horizontal(self) -> Array:
        """(N,) distance between true and estimated place, over ground, m."""
        return np.hypot(self.position[:, 0], self.position[:, 1])


def navigation_errors(estimate: NavHistory, truth: NavHistory) -> NavErrors:
    """Errors of states at the same instants."""
    level_e, level_t = _level_frame(estimate), _level_frame(truth)
    # the estimate's level frame against the true one, of which only the part about down is kept
    w, _, _, z = product(conjugate(level_t), level_e)
    length = np.hypot(w, z)
    twist: Four = (w / length, 0 * w, 0 * w, z / length)

    q = product(product(twist, _four(estimate.q)), conjugate(_four(truth.q)))
    attitude = _rotation_vectors(q)
    turned = rotate(twist, _three(estimate.v))
    velocity = np.stack(turned, 1) - truth.v
    gap = np.stack(_cartesian(estimate), 1) - np.stack(_cartesian(truth), 1)
    north, east, _ = rotate(conjugate(level_t), _three(gap))
    position = np.stack((north, east, truth.h - estimate.h), 1)
    return NavErrors(truth.time, attitude, velocity, position)


def _level_frame(history: NavHistory) -> Four:
    """Quaternions from north-east-down to Earth axes."""
    # down is turned by -(lat + 90°) about east, east by longitude about the axis
    half_lon, half_lat = 0.5 * history.lon, -0.5 * (history.lat + 0.5 * np.pi)
    zero = np.zeros_like(half_lon)
    about_axis: Four = (np.cos(half_lon), zero, zero, np.sin(half_lon))
    about_east: Four = (np.cos(half_lat), zero, np.sin(half_lat), zero)
    return product(about_axis, about_east)


def _cartesian(history: NavHistory) -> Triple:
    """Position in Earth axes, m."""
    sin_lat, cos_lat = np.sin(history.lat), np.cos(history.lat)
    _, prime_vertical = radii(sin_lat)
    across = (prime_vertical + history.h) * cos_lat
    along = ((1 - ECCENTRICITY_SQUARED) * prime_vertical + history.h) * sin_lat
    return across * np.cos(history.lon), across * np.sin(history.lon), along


def _rotation_vectors(q: Four) -> Array:
    """(N, 3) rad, the short way round."""
    sine = np.sqrt(q[1] ** 2 + q[2] ** 2 + q[3] ** 2)
    small = sine < 1e-150
    scale = np.where(small, 2.0, 2 * np.arctan2(sine, np.abs(q[0])) / np.where(small, 1.0, sine))
    scale = np.copysign(scale, q[0])
    return np.stack((scale * q[1], scale * q[2], scale * q[3]), 1)


def _four(table: Array) -> Four:
    return table[:, 0], table[:, 1], table[:, 2], table[:, 3]


def _three(table: Array) -> Triple:
    return table[:, 0], table[:, 1], table[:, 2]


Index = TypeVar("Index", slice, NDArray[np.intp], NDArray[np.bool_])


def rows(history: NavHistory, which: Index) -> NavHistory:
    """Some of the states."""
    return NavHistory(
        history.time[which],
        history.q[which],
        history.v[which],
        history.lat[which],
        history.lon[which],
        history.h[which],
        history.wander[which],
    )


def interpolated(history: NavHistory, times: Array) -> tuple[NavHistory, int]:
    """States at other times, all inside the history's.

    A state that is there (to `SAME_INSTANT`) is taken as it is.  Between two states the position is
    the cubic with their positions and velocities, the velocity goes in a straight line, and the
    attitude turns evenly the short way.

    Returns:
        The states, and how many had to be interpolated.
    """
    left = np.searchsorted(history.time, times + SAME_INSTANT, side="right") - 1
    left = np.clip(left, 0, len(history) - 1)
    exact = rows(history, left)
    between = np.abs(exact.time - times) > SAME_INSTANT
    if not between.any():
        return exact, 0
    first = left[between]
    a, b = rows(history, first), rows(history, np.minimum(first + 1, len(history) - 1))
    step = (b.time - a.time)[:, None]
    u = ((times[between] - a.time) / step[:, 0])[:, None]

    turned = _rotation_vectors(product(conjugate(_four(a.q)), _four(b.q))) * u
    angle = np.linalg.norm(turned, axis=1)
    sine = 0.5 * np.sinc(angle / (2 * np.pi))
    part: Four = (np.cos(0.5 * angle), *_three(turned * sine[:, None]))
    place, far = _place(a), _place(b)
    far[:, 1] = place[:, 1] + np.mod(far[:, 1] - place[:, 1] + np.pi, 2 * np.pi) - np.pi
    cubic = (
        (1 + 2 * u) * (1 - u) ** 2 * place
        + u * u * (3 - 2 * u) * far
        + step * u * (1 - u) * ((1 - u) * _place_rate(a) - u * _place_rate(b))
    )
    # fields beside each other, so that both kinds go back to their rows
    table = np.column_stack((exact.q, exact.v, exact.lat, exact.lon, exact.h))
    table[between] = np.column_stack(
        (np.stack(product(_four(a.q), part), 1), (1 - u) * a.v + u * b.v, cubic)
    )
    states = NavHistory(times, table[:, :4], table[:, 4:7], *table[:, 7:].T)
    return states, int(between.sum())


def _place(history: NavHistory) -> Array:
    return np.column_stack((history.lat, history.lon, history.h))


def _place_rate(history: NavHistory) -> Array:
    meridian, prime_vertical = radii(np.sin(history.lat))
    east = (prime_vertical + history.h) * np.cos(history.lat)
    return np.column_stack(
        (history.v[:, 0] / (meridian + history.h), history.v[:, 1] / east, -history.v[:, 2])
    )


QUANTITIES = ("attitude", "velocity", "position")
COMPONENTS = ("north", "east", "down")


@dataclass(frozen=True)
class Figures:
    """What a quantity came to over a run.

    Attributes:
        rms: root mean square.
        largest: largest magnitude.
        final: at the end.
    """

    rms: float
    largest: float
    final: float


class Comparison:
    """Errors of a run against its truth, block by block, in bounded memory.

    Errors are formed at the instants of whichever of the two is sparser; the other one is
    interpolated (see `interpolated`) where it has no state at such an instant.

    Args:
        truth: the true states, in blocks, times running forwards.
        interval: between the run's states, s.
        name: of the truth, for messages.

    Attributes:
        first: the truth's first state.
        step: between its first two states, s.
        instants, interpolated: how many were compared so far, how many of them by interpolation.

    Raises:
        InputError: there are not two states.
    """

    def __init__(self, truth: Iterator[NavHistory], interval: float, name: str) -> None:
        self._truth, self._interval, self._name = truth, interval, name
        self._waiting = next(self._truth, None)
        if self._waiting is not None and len(self._waiting) < 2:
            self._waiting = NavHistory.concatenate([self._waiting, *islice(self._truth, 1)])
        if self._waiting is None or len(self._waiting) < 2:
            raise InputError(f"{name}: a truth of fewer than two rows is not allowed, give more")
        self.first = self._waiting.state(0)
        self.step = float(self._waiting.time[1] - self._waiting.time[0])
        self._sparse_truth = self.step > 0.999 * interval
        self._tail: NavHistory | None = None
        self._start = 0.0
        self._seen = float(self._waiting.time[-1])
        self._sums, self._largest = np.zeros(12), np.zeros(12)
        self._final = np.zeros(12)
        self._growth = np.zeros(2)
        self.instants = self.interpolated = 0

    def add(self, part: NavHistory) -> tuple[NavHistory, NavHistory]:
        """Take the run's next states.

        Returns:
            Estimate and truth at the instants compared, which may be none.

        Raises:
            InputError: the truth does not reach back to the run's start or on to its present.
        """
        if self._tail is None:
            self._begin(part)
            run = part
        else:
            run = NavHistory.concatenate([self._tail, part])
        waiting = self._reach(float(run.time[-1]))
        end = float(run.time[-1]) + SAME_INSTANT
        if self._sparse_truth:
            ready = waiting.time <= end
            fresh = ready & (waiting.time >= self._start - SAME_INSTANT)
            truth = rows(waiting, fresh)
            estimate, count = interpolated(run, truth.time)
            self._waiting = rows(waiting, ~ready)
        else:
            estimate = part
            truth, count = interpolated(waiting, part.time)
            behind = int(np.searchsorted(waiting.time, end, side="right")) - 1
            self._waiting = rows(waiting, slice(max(behind, 0), None))
        self._tail = rows(part, slice(len(part) - 1, None))
        self.interpolated += count
        self._account(navigation_errors(estimate, truth))
        return estimate, truth

    def finish(self) -> None:
        """Say that the run is over.

        Raises:
            InputError: the truth ends earlier than the run or goes on longer.
        """
        end = float(self._tail.time[-1]) if self._tail is not None else self._start
        slack = max(self.step, self._interval) + SAME_INSTANT
        left = [part for part in (self._waiting, next(self._truth, None)) if part is not None]
        last = max((float(part.time[-1]) for part in left if len(part)), default=end)
        if last > end + slack:
            raise InputError(
                f"{self._name}: the truth goes on to {last:.9g} s or longer, but the run ends at"
                f" {end:.9g} s; give the truth of this run"
            )
        if not self.instants:
            raise InputError(f"{self._name}: no instant of the run is in the truth")

    def figures(self) -> dict[str, dict[str, Figures]]:
        """Root mean square, largest and final errors.

        Returns:
            By quantity (attitude in rad, velocity in m/s, position in m), by component (north,
            east, down, and `total`; the position's is the horizontal one).
        """
        rms = np.sqrt(self._sums / max(self.instants, 1))
        table = [
            Figures(*map(float, three))
            for three in zip(rms, self._largest, self._final, strict=True)
        ]
        return {
            quantity: dict(zip((*COMPONENTS, "total"), table[4 * k : 4 * k + 4], strict=True))
            for k, quantity in enumerate(QUANTITIES)
        }

    @property
    def growth(self) -> float:
        """Growth of the horizontal error, m/s: the line through zero at the start that fits best.

        Least squares over all instants compared.
        """
        products, squares = self._growth.tolist()
        return products / squares if squares else 0.0

    def _begin(self, part: NavHistory) -> None:
        assert self._waiting is not None
        self._start = float(part.time[0])
        first, slack = float(self._waiting.time[0]), max(self.step, self._interval)
        if first > self._start + slack + SAME_INSTANT or (
            not self._sparse_truth and first > self._start + SAME_INSTANT
        ):
            raise InputError(
                f"{self._name}: the truth begins at {first:.9g} s, but the run at"
                f" {self._start:.9g} s; give the truth of this run"
            )

    def _reach(self, time: float) -> NavHistory:
        """The truth's states not yet used, as far as a time."""
        assert self._waiting is not None
        parts = [self._waiting]
        while not len(parts[-1]) or parts[-1].time[-1] < time - SAME_INSTANT:
            more = next(self._truth, None)
            if more is None:
                break
            parts.append(more)
        waiting = NavHistory.concatenate(parts)
        last = float(waiting.time[-1]) if len(waiting) else self._seen
        slack = self.step if self._sparse_truth else 0.0
        if last < time - slack - SAME_INSTANT:
            raise InputError(
                f"{self._name}: the truth ends at {last:.9g} s, but the run goes on; give the truth"
                " of this run"
            )
        self._seen = last
        return waiting

    def _account(self, errors: NavErrors) -> None:
        if not len(errors.time):
            return
        sizes = (
            np.linalg.norm(errors.attitude, axis=1),
            np.linalg.norm(errors.velocity, axis=1),
            errors.horizontal,
        )
        columns = []
        for table, size in zip(
            (errors.attitude, errors.velocity, errors.position), sizes, strict=True
        ):
            columns.append(np.column_stack((table, size)))
        flat = np.hstack(columns)
        self._sums += (flat**2).sum(axis=0)
        self._largest = np.maximum(self._largest, np.abs(flat).max(axis=0))
        self._final = flat[-1]
        since = errors.time - self._start
        self._growth += (float(since @ errors.horizontal), float(since @ since))
        self.instants += len(errors.time)
