"""Errors of a navigated track against the truth: attitude, velocity, position, and their growth.

An error is estimate less truth, in the true north-east-down axes.  So that it means the same at a
pole as elsewhere, the estimate's north is first carried to the true place the shortest way: what is
left out is the turning of north with longitude, tan(lat)/R for every metre of error east.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import islice
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from sculler_model.errors import InputError
from sculler_model.frames import ECCENTRICITY_SQUARED, conjugate, product, radii, rotate
from sculler_model.navigation.state import NavHistory, NavState

Array = NDArray[np.float64]
Four = tuple[Array, Array, Array, Array]
Triple = tuple[Array, Array, Array]

SAME_INSTANT = 1e-8
"""Two times (s) no further apart are the same instant, while a double has that many places."""


def slack(time: Array) -> Array:
    """How far (s) another time may be from this one and be the same instant.

    Of a clock that counts seconds since 1970 a double has 0.24 µs; four of those.
    """
    spacing: Array = np.maximum(SAME_INSTANT, 4 * np.spacing(np.abs(time)))
    return spacing


NAUTICAL_MILE = 1852.0
"""m."""


@dataclass(frozen=True)
class NavErrors:
    """Errors at N instants, each (N, 3): north, east, down; NaN for what the truth does not tell.

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


QUANTITIES = ("attitude", "velocity", "position")
COMPONENTS = ("north", "east", "down")


def known(truth: NavHistory) -> tuple[str, ...]:
    """Which `QUANTITIES` a truth tells: what it does not is NaN in all of its states."""
    columns = dict(zip(QUANTITIES, (truth.q[:, 0], truth.v[:, 0], truth.lat), strict=True))
    return tuple(name for name, column in columns.items() if not np.isnan(column).any())


def navigation_errors(estimate: NavHistory, truth: NavHistory) -> NavErrors:
    """Errors of states at the same instants.

    A truth without position is taken to be at the estimate's place, so that its north is the same.
    """
    if "position" not in known(truth):
        told = replace(truth, lat=estimate.lat, lon=estimate.lon, h=estimate.h)
        return replace(navigation_errors(estimate, told), position=np.full((len(truth), 3), np.nan))
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
    attitude turns evenly the short way.  Without velocities the position goes in a straight line.

    Returns:
        The states, and how many had to be interpolated.
    """
    left = np.searchsorted(history.time, times + slack(times), side="right") - 1
    left = np.clip(left, 0, len(history) - 1)
    exact = rows(history, left)
    between = np.abs(exact.time - times) > slack(times)
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
    rates = [(far - place) / step] * 2
    if "velocity" in known(history):
        rates = [_place_rate(a), _place_rate(b)]
    cubic = (
        (1 + 2 * u) * (1 - u) ** 2 * place
        + u * u * (3 - 2 * u) * far
        + step * u * (1 - u) * ((1 - u) * rates[0] - u * rates[1])
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


class Start(NamedTuple):
    """Where a run can begin by its truth.

    Attributes:
        row: of the instants asked about.
        state: the true one; NaN for what the truth does not tell.
        interpolated: between two of the truth's rows.
    """

    row: int
    state: NavState
    interpolated: bool


class LeftOut(NamedTuple):
    """Seconds that only one of the two has.

    Attributes:
        run_before, run_after: the run, before the truth begins and after it ends.
        truth_before, truth_after: the truth, before the run begins and after it ends.
        run_in_gaps: the run, where the truth's rows are too far apart.
    """

    run_before: float
    run_after: float
    truth_before: float
    truth_after: float
    run_in_gaps: float


_ROWS_TO_START = 20
"""Rows of a truth among which one at the end of a major interval is looked for."""

_WIDEST = 3.5
"""Steps of a truth over which it is interpolated: what is further apart is a gap."""


class Comparison:
    """Errors of a run against its truth over what they have in common, in bounded memory.

    Errors are formed at the instants of whichever of the two is sparser; the other one is
    interpolated (see `interpolated`) where it has no state at such an instant, but not over a gap.

    Args:
        truth: the true states, in blocks, times running forwards; NaN all through in what it does
            not tell.
        interval: between the run's states, s.
        name: of the truth, for messages.

    Attributes:
        first: the truth's first state.
        known: which `QUANTITIES` it tells.
        step: between its states, s.
        instants, interpolated: how many were compared so far, how many of them by interpolation.

    Raises:
        InputError: there are not two states.
    """

    def __init__(self, truth: Iterator[NavHistory], interval: float, name: str) -> None:
        self._truth, self._interval, self._name = truth, interval, name
        waiting = next(self._truth, None)
        if waiting is not None and len(waiting) < 2:
            waiting = NavHistory.concatenate([waiting, *islice(self._truth, 1)])
        if waiting is None or len(waiting) < 2:
            raise InputError(f"{name}: a truth of fewer than two rows is not allowed, give more")
        self._waiting = waiting
        self.first = waiting.state(0)
        self.known = known(waiting)
        self.step = float(np.median(np.diff(waiting.time[:_ROWS_TO_START])))
        self._sparse_truth = self.step > 0.999 * interval
        self._last = float(waiting.time[-1])  # of the truth's times so far
        self._tail: NavHistory | None = None
        self._span: tuple[float, float] | None = None  # of the run
        self._stretch = 0.0
        self._sums, self._largest = np.zeros(12), np.zeros(12)
        self._final = np.zeros(12)
        self._growth = np.zeros(2)
        self._in_gaps = 0.0  # s
        self._before: Array = np.zeros(0)  # the time of the last true state compared with
        self.instants = self.interpolated = 0

    def start(self, instants: Array) -> Start | None:
        """The true state at the first of some instants at which the run could begin.

        An instant at which the truth has a row is preferred, if one of its next rows
        (`_ROWS_TO_START`) is; else it is the first instant between two of its rows.

        Args:
            instants: running forwards, none earlier than any asked about or added before.

        Returns:
            None if the truth begins after all of them or ends before.
        """
        waiting = self._reach(float(instants[-1]))
        there, exact = self._inside(waiting, instants)
        places = np.flatnonzero(there)
        if not len(places):
            return None
        first = float(instants[places[0]])
        near = first + _ROWS_TO_START * max(self.step, self._interval)
        wanted = exact[places] & (instants[places] <= near)
        row = int(places[np.argmax(wanted)])
        found, count = interpolated(self._waiting, instants[row : row + 1])
        return Start(row, found.state(0)._replace(time=float(instants[row])), bool(count))

    def _inside(
        self, truth: NavHistory, instants: Array
    ) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Which instants have a true state, by a row or between two that are close; by a row."""
        if not len(truth):
            none = np.zeros(len(instants), np.bool_)
            return none, none
        times, near = truth.time, slack(instants)
        after = np.minimum(np.searchsorted(times, instants - near), len(times) - 1)
        before = np.maximum(after - 1, 0)
        exact = np.abs(times[after] - instants) <= near
        between = (times[before] < instants) & (instants < times[after])
        between &= times[after] - times[before] <= _WIDEST * self.step
        return exact | between, exact

    def ended(self, time: float) -> bool:
        """Whether the truth ends before a time, which is none earlier than any asked about."""
        self._reach(time)
        return self._last < time - SAME_INSTANT

    def begin(self) -> None:
        """A new stretch of the run: nothing lies between it and what came before."""
        self._tail, self._before = None, np.zeros(0)

    def add(self, part: NavHistory) -> tuple[NavHistory, NavHistory]:
        """Take the run's next states.

        Returns:
            Estimate and truth at the instants compared, which may be none.
        """
        if not len(part):
            return part, part
        run = part if self._tail is None else NavHistory.concatenate([self._tail, part])
        if self._tail is None:
            self._stretch = float(part.time[0])
        begin, end = float(part.time[0]), float(part.time[-1])
        self._span = (begin if self._span is None else self._span[0], end)
        waiting = self._reach(end)
        last = end + float(slack(part.time[-1:])[0])
        if self._sparse_truth:
            ready = waiting.time <= last
            truth = rows(waiting, ready & (waiting.time >= self._stretch - slack(waiting.time)))
            estimate, count = interpolated(run, truth.time) if len(truth) else (truth, 0)
            self._waiting = rows(waiting, ~ready)
            steps = np.diff(np.concatenate([self._before, truth.time]))
            self._in_gaps += float(steps[steps > _WIDEST * self.step].sum())
            self._before = truth.time[-1:] if len(truth) else self._before
        else:
            inside, _ = self._inside(waiting, part.time)
            if len(waiting):
                over = (part.time > waiting.time[0]) & (part.time < waiting.time[-1]) & ~inside
                self._in_gaps += self._interval * np.count_nonzero(over)
            estimate = rows(part, inside)
            truth, count = interpolated(waiting, estimate.time) if inside.any() else (estimate, 0)
            behind = int(np.searchsorted(waiting.time, last, side="right")) - 1
            self._waiting = rows(waiting, slice(max(behind, 0), None))
        self._tail = rows(part, slice(len(part) - 1, None))
        self.interpolated += count
        self._account(navigation_errors(estimate, truth))
        return estimate, truth

    def finish(self) -> None:
        """Say that the run is over; the rest of the truth is read.

        Raises:
            InputError: run and truth have no instant in common.
        """
        for part in self._truth:
            self._last = float(part.time[-1])
        if not self.instants:
            begin, end = self._span or (0.0, 0.0)
            raise self.no_overlap(begin, end)

    def no_overlap(self, begin: float, end: float) -> InputError:
        """What to say of a run from `begin` to `end` that has nothing in common with the truth."""
        return InputError(
            f"{self._name}: the truth goes from {self.first.time:.9g} s to {self._last:.9g} s"
            f" and has nothing in common with the run from {begin:.9g} s to {end:.9g} s; both are"
            " on the log's clock: give the truth of this run, or its times on that clock"
        )

    @property
    def left_out(self) -> LeftOut:
        """What was not compared, after `finish`."""
        begin, end = self._span or (self.first.time, self._last)
        first, last = self.first.time, self._last
        pairs = ((begin, first), (last, end), (first, begin), (end, last))
        ends = [max(0.0, float(b - a)) for a, b in pairs]
        return LeftOut(ends[0], ends[1], ends[2], ends[3], self._in_gaps)

    def figures(self) -> dict[str, dict[str, Figures]]:
        """Root mean square, largest and final errors of what the truth tells.

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
            if quantity in self.known
        }

    @property
    def growth(self) -> float:
        """Growth of the horizontal error, m/s: the line through zero at the start that fits best.

        Least squares over all instants compared; 0 where the truth tells no position.
        """
        products, squares = self._growth.tolist()
        return products / squares if squares and "position" in self.known else 0.0

    def _reach(self, time: float) -> NavHistory:
        """The truth's states not yet used, as far as a time."""
        parts = [self._waiting]
        while self._last < time:
            more = next(self._truth, None)
            if more is None:
                break
            parts.append(more)
            self._last = float(more.time[-1])
        if len(parts) > 1:
            self._waiting = NavHistory.concatenate(parts)
        return self._waiting

    def _account(self, errors: NavErrors) -> None:
        if not len(errors.time):
            return
        assert self._span is not None
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
        since = errors.time - self._span[0]
        self._growth += (float(since @ errors.horizontal), float(since @ since))
        self.instants += len(errors.time)
