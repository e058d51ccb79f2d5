"""What Python's navigator makes of the results that a chip took, as its firmware says it should."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sculler.soc.plan import SocPlan
from sculler.soc.telemetry import ChipRecord
from sculler_model.errors import InputError
from sculler_model.frames import conjugate, product, to_rotation_vector
from sculler_model.host import MajorIncrements, major_increments
from sculler_model.navigation import (
    Alignment,
    FineAlignment,
    NavHistory,
    Navigator,
    NavState,
    align,
    align_finely,
    coasted,
    navigate,
)


@dataclass(frozen=True)
class Aligned:
    """An alignment that a chip told.

    Attributes:
        told: its frame (`sculler.soc.ALIGNMENT`).
        expected: Python's of the same window; None where it refuses the window.
    """

    told: np.void
    expected: Alignment | FineAlignment | None

    @property
    def same_end(self) -> bool:
        """Whether both found an attitude, or neither."""
        return bool(self.told["error"]) == (self.expected is None)

    @property
    def apart(self) -> float:
        """Between the two attitudes, rad; 0 where there are none."""
        if self.expected is None or self.told["error"]:
            return 0.0
        x, y, z, w = self.told["q"].tolist()
        return float(
            np.linalg.norm(to_rotation_vector(product(self.expected.q, conjugate((w, x, y, z)))))
        )


@dataclass(frozen=True)
class Followed:
    """What should have been told.

    Attributes:
        states: (K,) after results that were navigated with.
        rows: (K,) which of the record's results these are.
        alignments: of windows that were whole, in turn.
        coasted: s, over results that are missing.
    """

    states: NavHistory
    rows: NDArray[np.int64]
    alignments: tuple[Aligned, ...]
    coasted: float


def follow(plan: SocPlan, record: ChipRecord) -> Followed:
    """Navigate with a record's results.

    An alignment's attitude and bias are those that the chip told: a state after it is held against
    the same beginning.

    Args:
        plan: of the chip.
        record: what it sent, with no frame missing.

    Raises:
        InputError: a window was whole, and the chip told no alignment.
    """
    return _Follower(plan, record).run()


class _Follower:
    def __init__(self, plan: SocPlan, record: ChipRecord) -> None:
        self._plan, self._record = plan, record
        self._interval = plan.design.major_interval
        self._increments = major_increments(plan.design, record.results)
        self._ends = (np.asarray(record.results.major) + 1.0) * self._interval
        self._state: NavState | None = None
        self._bias = np.zeros(3)
        self._states: list[NavHistory] = []
        self._rows: list[NDArray[np.int64]] = []
        self._alignments: list[Aligned] = []
        self._coasted = 0.0

    def run(self) -> Followed:
        """All of it."""
        lead = self._increments.leading_short
        if self._plan.align is None:
            for row in range(lead):
                self._begin(row, self._plan.start._replace(time=float(self._ends[row])))
        for first, stop, missing in self._stretches(lead):
            self._take(first, stop, missing)
        empty = [NavHistory.from_table(np.zeros(0), np.zeros((0, 11)))]
        return Followed(
            NavHistory.concatenate(self._states or empty),
            np.concatenate([np.zeros(0, np.int64), *self._rows]),
            tuple(self._alignments),
            self._coasted,
        )

    def _stretches(self, lead: int) -> Iterator[tuple[int, int, float]]:
        """First row, row behind the last, and seconds missing before, of results without a gap."""
        major = np.asarray(self._record.results.major)
        missing = (np.diff(major, prepend=major[:1] - 1) - 1) * self._interval
        edges = [lead, *(row for row in np.flatnonzero(missing).tolist() if row > lead)]
        for first, stop in zip(edges, [*edges[1:], len(missing)], strict=True):
            if first < stop:
                yield first, stop, float(missing[first]) if first else 0.0

    def _take(self, first: int, stop: int, missing: float) -> None:
        if self._state is not None and missing:
            self._coasted += missing
            self._state = coasted(self._state, missing)
        if self._state is None and self._plan.align is not None:
            first = self._align(first, stop)
        elif self._state is None:
            start = float(self._ends[first]) - self._interval
            self._state = self._plan.start._replace(time=start)
        if self._state is None or first == stop:
            return
        every = self._plan.position_every
        history = navigate(
            self._state,
            self._interval,
            self._increments[first:stop].without_bias(self._bias, self._interval),
            lambda state, interval: Navigator(state, interval, position_every=every),
        ).rows(slice(1, None))
        self._states.append(history)
        self._rows.append(np.arange(first, stop))
        self._state = history.state(len(history) - 1)

    def _begin(self, row: int, state: NavState) -> None:
        self._state = state
        self._states.append(NavHistory.from_states([state]))
        self._rows.append(np.array([row]))

    def _align(self, row: int, stop: int) -> int:
        """Window by window, until one shows rest; the row after it."""
        asked, record = self._plan.align, self._record
        assert asked is not None
        while stop - row >= asked.results:
            last = row + asked.results - 1
            told = record.alignments[record.alignments["number"] == record.numbers[last]]
            if not len(told):
                raise InputError(f"the chip told no alignment with result {record.numbers[last]}")
            self._alignments.append(
                Aligned(told[0], self._expected(self._increments[row : last + 1]))
            )
            row = last + 1
            if told[0]["error"] == 0:
                x, y, z, w = told[0]["q"].tolist()
                state = self._plan.start._replace(
                    time=float(self._ends[last]), q=(w, x, y, z), v=(0.0, 0.0, 0.0)
                )
                self._bias = told[0]["gyro_bias"]
                self._begin(last, state)
                return row
        return stop

    def _expected(self, window: MajorIncrements) -> Alignment | FineAlignment | None:
        asked, start = self._plan.align, self._plan.start
        assert asked is not None
        find = align_finely if asked.fine else align
        try:
            return find(window, self._interval, start.lat, start.h, asked.noise)
        except InputError:
            return None
