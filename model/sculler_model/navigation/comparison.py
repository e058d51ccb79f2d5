"""A run held against its truth over what they have in common: `Comparison`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sculler_model.errors import InputError
from sculler_model.navigation.errors import (
    NORTH_EAST_DOWN,
    QUANTITIES,
    NavErrors,
    known_quantities,
    navigation_errors,
)
from sculler_model.navigation.interpolation import SAME_INSTANT, interpolated, slack
from sculler_model.navigation.state import NavHistory, NavState

Array = NDArray[np.float64]


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
        self.known = known_quantities(waiting)
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
            truth = waiting.rows(ready & (waiting.time >= self._stretch - slack(waiting.time)))
            estimate, count = interpolated(run, truth.time) if len(truth) else (truth, 0)
            self._waiting = waiting.rows(~ready)
            steps = np.diff(np.concatenate([self._before, truth.time]))
            self._in_gaps += float(steps[steps > _WIDEST * self.step].sum())
            self._before = truth.time[-1:] if len(truth) else self._before
        else:
            inside, _ = self._inside(waiting, part.time)
            if len(waiting):
                over = (part.time > waiting.time[0]) & (part.time < waiting.time[-1]) & ~inside
                self._in_gaps += self._interval * np.count_nonzero(over)
            estimate = part.rows(inside)
            truth, count = interpolated(waiting, estimate.time) if inside.any() else (estimate, 0)
            behind = int(np.searchsorted(waiting.time, last, side="right")) - 1
            self._waiting = waiting.rows(slice(max(behind, 0), None))
        self._tail = part.rows(slice(len(part) - 1, None))
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
            quantity: dict(zip((*NORTH_EAST_DOWN, "total"), table[4 * k : 4 * k + 4], strict=True))
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
        # sums, not products of vectors: those would start BLAS and its threads for a few numbers
        self._growth += (float((since * errors.horizontal).sum()), float((since * since).sum()))
        self.instants += len(errors.time)
