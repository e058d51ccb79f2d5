"""A run of the navigator over vectors: where it begins, what it does at a break, where it ends."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from math import nan

import numpy as np
from numpy.typing import NDArray

from sculler.checks.first_seconds import FirstSeconds
from sculler.checks.oddities import Oddities
from sculler.checks.vector_breaks import Break, Stretches, begins_at
from sculler.formats.tables import counting
from sculler.runs.navigation.against_truth import AgainstTruth
from sculler.runs.navigation.heights import HeightWatch
from sculler.runs.navigation.hosts import host_of
from sculler.runs.navigation.plan import Plan, completed
from sculler.runs.navigation.seen import (
    ALIGNED,
    BEFORE,
    BREAKS_TOLD,
    CARRIED,
    FROM_TRUTH,
    NOTHING,
    STATUSES,
    Seen,
)
from sculler.words import plural
from sculler_model.errors import InputError
from sculler_model.fast import VectorBlock
from sculler_model.host import MajorIncrements
from sculler_model.navigation import (
    FineAlignment,
    Mechanisation,
    NavHistory,
    NavState,
    attitude_state,
    trajectory,
)

Array = NDArray[np.float64]


class NavigationRun:
    """Carries a state over vectors that come in blocks; `seen` tells what happened.

    It begins at the first instant from which on no result is of short history (status bit 0); the
    given initial state holds there.  With a truth it begins where the truth has a state.

    Args:
        plan: how.
        sink: told the states, the first one and those at the interval ends.
        reference: the truth, or None.
        telemetry: told the states as frames; None for no such.
        watch: told the increments that are navigated with, and the states at their ends.
    """

    def __init__(
        self,
        plan: Plan,
        sink: Callable[[NavHistory], None],
        reference: AgainstTruth | None = None,
        telemetry: Callable[[bytes], object] | None = None,
        watch: Callable[[MajorIncrements, NavHistory], None] | None = None,
    ) -> None:
        self._watch = watch
        self._plan, self._sink, self._reference = plan, sink, reference
        self._telemetry, self._frames = telemetry, 0
        self._heights = HeightWatch(plan)
        self._T, self._half = plan.design.major_interval, 0.5 * plan.design.sample_interval
        self.seen = Seen()
        self._oddities = Oddities(plan.design)
        self._stretches = Stretches(plan.design, plan.name)
        self._unit = counting(plan.name).unit
        self._first: FirstSeconds | None = None
        self._span: tuple[float, float] | None = None  # of the vectors so far
        self._over = False
        self._bias: FineAlignment | None = None
        self._host = host_of(plan)
        self._third_order = (0, 0)  # counts of the stretches before
        self._begin()

    def _begin(self) -> None:
        """A new stretch."""
        self._navigator: Mechanisation | None = None
        self._edge: float | None = None  # where the next interval begins
        self._window: list[MajorIncrements] = []  # to align with
        self._window_from = 0.0
        self._gathered = 0  # intervals in it
        self._third_order = self.seen.third_order
        self._host.begin()
        self._left_out = 0

    def take(self, blocks: Iterable[VectorBlock]) -> None:
        """Run over all blocks, or as far as the plan says.

        Raises:
            InputError: there is nothing to run over, a break that is refused, a start that is not
                there, or what alignment and navigator refuse.
        """
        for block in blocks:
            self.feed(block)
            if self._over:
                break
        self._finish()

    def feed(self, block: VectorBlock) -> None:
        """Run over the next block, which may be of any size; what comes after the end is left out.

        Raises:
            InputError: as `take`, but for what only the end of the vectors shows.
        """
        for part in self._stretches(block):
            if self._over:
                break
            if isinstance(part, Break):
                self._after_break(part)
            else:
                self._take(part)

    def _take(self, block: VectorBlock) -> None:
        """The next consecutive intervals."""
        plan = self._plan
        increments = self._host.increments(block)
        times = increments.times
        assert times is not None
        edge = begins_at(plan.design, float(times[0])) if self._edge is None else self._edge
        begins = np.concatenate([[edge], times[:-1]])
        if plan.height_reference is not None:
            increments = replace(increments, heights=plan.height_reference.at(begins))
        self._edge = float(times[-1])
        self._span = (edge if self._span is None else self._span[0], self._edge)
        if self._navigator is None:
            anew = self.seen.start is not None and self._reference is not None
            align = plan.align is not None and not anew
            align = align and (plan.realign or self.seen.start is None)
            begin = self._aligned if align else self._started
            increments = self._from_here(block, begin(increments, begins))
        if self._navigator is not None and len(increments):
            self._carry(self._navigator, increments)
        if plan.third_order:
            before, now = self._third_order, self._host.third_order_count()
            self.seen.third_order = before[0] + now[0], before[1] + now[1]

    def _from_here(self, block: VectorBlock, increments: MajorIncrements) -> MajorIncrements:
        """The block's last intervals, which the run begins with: so does the third order."""
        if self._navigator is None or not self._plan.third_order:
            return increments
        self._host.begin()
        if not len(increments):
            return increments
        last = block[len(block) - len(increments) :]
        return replace(self._host.increments(last), heights=increments.heights)

    def _started(self, increments: MajorIncrements, begins: Array) -> MajorIncrements:
        """Begin at one of the intervals' beginnings, if the run does; the intervals after it."""
        lead = increments.leading_short
        self._left_out += lead
        found = self._choose(begins[lead:], lead > 0) if lead < len(begins) else None
        if found is None:
            return increments[len(increments) :]
        row, state = found
        if self.seen.start is None and self._plan.start is None and row == 0:
            self.seen.left_out = self._left_out
        self._go(state)
        return increments[lead + row :]

    def _choose(self, begins: Array, cut: bool) -> tuple[int, NavState] | None:
        """Which of some instants to begin at, and the state there; None to go on looking."""
        plan, reference, last = self._plan, self._reference, self.seen.end
        if plan.start is not None and last is None:
            row = self._asked(plan.start, begins, cut)
            if row is None:
                return None
            time = float(begins[row])
            start = None if reference is None else reference.start(begins[row : row + 1])
            if reference is not None and start is None:
                raise InputError(
                    f"{reference.path}: the truth has no state at {time:.15g} s, where --start"
                    " begins the run; give a time inside the truth"
                )
            told = None if start is None else start.state
            return row, plan.initial(time, told, self._latitude)
        start = None if reference is None else reference.start(begins)
        if start is not None:
            time = float(begins[start.row])
            if start.interpolated and last is None:
                self.seen.warnings.append(
                    "the truth has no row at the end of a major interval, so the state at"
                    f" {time:.15g} s, with which the run begins, is interpolated between two"
                )
            if last is None:
                return start.row, plan.initial(time, start.state, self._latitude)
            # what the truth does not tell goes on as without it
            self._then(FROM_TRUTH)
            return start.row, completed(start.state, self._host.coasted(last, time - last.time))
        time = float(begins[0])
        if reference is not None and not (last is not None and reference.ended(time)):
            return None  # it may begin later
        if last is None:
            return 0, plan.initial(time, None)
        self._then(CARRIED)
        return 0, self._host.coasted(last, time - last.time)

    def _then(self, how: str) -> None:
        """Say what became of the last break."""
        found = self.seen.breaks[-1]
        found["then"] = how
        if len(self.seen.breaks) <= BREAKS_TOLD:
            self.seen.warnings.append(
                f"a break of {found['seconds']:.6g} s before {self._unit} {found['line']}"
                f" ({found['what']}): {how}"
            )

    @property
    def _latitude(self) -> float:
        """What the truth of a run of attitude alone tells, rad, or NaN."""
        return nan if self._reference is None else self._reference.latitude

    def _asked(self, start: float, begins: Array, cut: bool) -> int | None:
        """The row at which --start wants to begin; None if it comes later."""
        row = int(np.argmin(np.abs(begins - start)))
        if abs(begins[row] - start) <= self._half:
            return row
        first = float(begins[0])
        if start > begins[-1]:
            # the end of this block's last interval is the beginning of the next one's first
            if self._edge is not None and start < self._edge - self._half:
                raise self._off_grid(start)
            return None
        if start > first:
            raise self._off_grid(start)
        why = "there is no result before"
        if cut:
            why = "the result before reaches before the first sample (status bit 0)"
        raise InputError(
            f"--start: the run cannot begin at {start:.15g} s, but from {first:.15g} s on:"
            f" {why}; give a later time"
        )

    def _off_grid(self, start: float) -> InputError:
        return InputError(
            f"--start: the run cannot begin at {start:.15g} s, which is not the end of a major"
            f" interval of {self._T:g} s; give another time"
        )

    def _aligned(self, increments: MajorIncrements, begins: Array) -> MajorIncrements:
        """Gather the window, and begin at its end once it is whole; the intervals after it."""
        plan = self._plan
        assert plan.align is not None
        if not self._window:
            lead = increments.leading_short
            self._left_out += lead
            increments, begins = increments[lead:], begins[lead:]
            if not len(increments):
                return increments
            self._window_from = float(begins[0])
        wanted = max(1, round(plan.align / self._T)) - self._gathered
        self._window.append(increments[:wanted])
        self._gathered += len(self._window[-1])
        if len(increments) < wanted:
            return increments[len(increments) :]
        window = MajorIncrements.concatenate(self._window)
        assert window.times is not None
        self._count(window)
        place = self._place()
        coarse = self._host.aligned(window, place[0], place[2])
        state = coarse.state(*place)
        if plan.fine:
            self._bias = self._host.finely_aligned(window, place[0], place[2])
            state = self._bias.state(*place)
        if self.seen.start is None:
            self.seen.alignment, self.seen.fine = coarse, self._bias
            self.seen.left_out = self._left_out
        self.seen.warnings += (self._bias or coarse).warnings
        if self.seen.start is not None:
            self._then(ALIGNED)
        end = float(window.times[-1])
        if plan.attitude_only:
            state = attitude_state(end, state.q, place[0])
        self._go(state._replace(time=end))
        return increments[wanted:]

    def _place(self) -> tuple[float, float, float]:
        """Where a unit at rest stands: as given, by the truth, or where the run has come to."""
        if self._plan.attitude_only:
            lat, _, h = self._plan.given.place
            return lat or 0.0, 0.0, h or 0.0
        if self.seen.end is not None:
            return self.seen.end.lat, self.seen.end.lon, self.seen.end.h
        return self._plan.given.position(None if self._reference is None else self._reference.first)

    def _go(self, state: NavState) -> None:
        """Navigate from a state on."""
        plan = self._plan
        if self.seen.start is None:
            self.seen.start = state
            if plan.align is None and not plan.attitude_only:  # it looks at the force itself
                self._first = FirstSeconds(state, self._T, plan.gravity, plan.axes)
        self._navigator = self._host.navigator(state, self.seen.start.h)
        self.seen.end = state
        self._show(NavHistory.from_states([state]))

    def _carry(self, navigator: Mechanisation, increments: MajorIncrements) -> None:
        """Navigate over the next intervals."""
        times = increments.times
        assert times is not None
        if self._plan.stop is not None:
            rows = int(np.count_nonzero(times <= self._plan.stop + self._half))
            self._over = rows < len(increments)
            increments = increments[:rows]
        self._count(increments)
        if self._first is not None:
            self._first.see(increments)
        if self._bias is not None:
            increments = self._bias.corrected(increments, self._T)
        if self._plan.bias is not None:
            increments = self._plan.bias.corrected(increments, self._T)
        before, start = navigator.state, self.seen.start
        for part in trajectory(navigator, [increments] if len(increments) else []):
            self._show(part, increments.status)
            if self._watch is not None:
                self._watch(increments, part)
            if start is not None and not self._plan.attitude_only:
                self._heights.see(start, before, part, increments)
        self.seen.end = navigator.state

    def _show(self, part: NavHistory, status: NDArray[np.int64] | None = None) -> None:
        self._sink(part)
        if self._telemetry is not None:
            bits = np.zeros(len(part), np.int64) if status is None else status
            self._telemetry(self._host.telemetry(part, bits, self._frames))
            self._frames += len(part)
        if self._reference is not None:
            self._reference.add(part)

    def _count(self, increments: MajorIncrements) -> None:
        """Look at intervals that are used."""
        self._oddities.see(increments)
        if increments.status is None or increments.times is None:
            return
        for key, (bit, _) in STATUSES.items():
            marked = (increments.status & bit) != 0
            if marked.any():
                first = float(increments.times[np.argmax(marked)])
                count, time = self.seen.statuses.get(key, (0, first))
                self.seen.statuses[key] = (count + int(marked.sum()), time)

    def _after_break(self, found: Break) -> None:
        """Refuse it, or begin anew."""
        plan = self._plan
        where = f"{plan.name}: {self._unit} {found.line}: {found.what}"
        if not plan.split:
            raise InputError(
                f"{where}; mend the log, or give --breaks split to begin anew after it"
            )
        if found.seconds is None:
            raise InputError(
                f"{where}: how long that took is not known, so neither is the time after it; give"
                " the log a column time_s"
            )
        if found.seconds < -self._half:
            raise InputError(f"{where}: time runs back; put the log in order")
        if self._window and self._navigator is None and plan.realign:
            raise InputError(
                f"{where}, inside the window of --align; give a shorter one, or cut the log"
            )
        then = BEFORE if self.seen.start is None else NOTHING
        self.seen.breaks.append(
            {"line": found.line, "what": found.what, "seconds": found.seconds, "then": then}
        )
        self._oddities.begin()
        if self._reference is not None:
            self._reference.begin()
        self._begin()

    @property
    def height_warnings(self) -> list[str]:
        """What there is to say of a damped height so far."""
        start = self.seen.start
        if start is None or self._plan.attitude_only:
            return []
        return self._heights.warnings(start)

    def _finish(self) -> None:
        plan, seen = self._plan, self.seen
        seen.warnings += self.height_warnings
        if seen.breaks and seen.breaks[-1]["then"] == NOTHING and self._reference is not None:
            self._then(NOTHING)
        elif plan.align is not None and self._navigator is None:
            seconds = sum(map(len, self._window)) * self._T
            after = " after the last break" if seen.breaks else ""
            raise InputError(
                f"--align: {plan.align:g} s are more than the {seconds:g} s of vectors{after},"
                " give less"
            )
        if seen.start is None or seen.end is None or seen.end == seen.start:
            nowhere = seen.start is None and plan.start is None
            if nowhere and self._reference is not None and self._span is not None:
                raise self._reference.no_overlap(*self._span)
            if seen.start is not None and plan.stop is not None:
                raise InputError(
                    f"--stop: {plan.stop:.15g} s is not after the run's beginning at"
                    f" {seen.start.time:.15g} s, give a later time"
                )
            raise InputError(f"{plan.name}: no results to navigate with, give a longer log")
        if self._reference is not None:
            self._reference.finish()
        if self._first is not None and self._first.warning is not None:
            seen.warnings.append(self._first.warning)
        seen.warnings += seen.status_warnings()
        if len(seen.breaks) > BREAKS_TOLD:
            seen.warnings.append(f"{plural(len(seen.breaks) - BREAKS_TOLD, 'more break')}")
        seen.warnings += self._oddities.finish()
