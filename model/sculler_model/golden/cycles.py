"""The cycle-accurate model of a core's ports: what every output shows on every clock.

It knows the handshake contract, the golden model and the few numbers of `Timing`; nothing of what
is inside.  The contract of both cores:

* A sample is taken in a clock where `sample_valid` and `sample_ready` are both high; a result, or
  a word of it, in a clock where `result_valid` and `result_ready` are.
* `sample_ready` is low exactly when one of these holds: the clocks after power-up or reset
  (`Timing.startup`) are not over; the clocks between samples (`spacing`) are not over; the next
  sample's phase has work and the engine is still busy (`work`); the next sample would be a major
  interval's last and there is no room for its result: `results` are under way or have not been
  taken, to their last word, yet.  With `overrun = "drop-result"` that last reason never holds.
  It does not depend on `sample_valid`, nor, within the clock, on `result_ready`.
* A sample is lost when `sample_valid` was high with `sample_ready` low in one clock and
  `sample_valid` is low in the next.  A source that can wait holds its offer until it is taken and
  so loses nothing; a sensor that cannot must let `sample_valid` fall between samples, for a sample
  that changes while `sample_valid` stays high cannot be told from one that waits.
* Each loss marks, by status bit 3, the interval whose last sample is the first such to be taken
  after it.  `samples_lost` counts losses since reset, two clocks after the one in which
  `sample_valid` has fallen; it stays at its highest value, which means so many or more.
* `result_valid` rises `latency` clocks after the clock in which the interval's last sample was
  taken, and stays high until the result, or its word, is taken.
* Stream hand-over: the words of a result (`stream`) come one after another, a word
  `handover_spacing` clocks after the one before it was taken; `result_last` marks the last.
* While `result_valid` is low the other result ports mean nothing.
* `overrun = "drop-result"`: behind the result that is being handed over there is room for one that
  waits, whose place a later one takes.  An interval whose last sample is taken in clock c drops the
  result that waits behind one which has not been taken whole before clock c + `claim`; in clock
  c + `claim` + 2 `results_dropped` counts it, as `samples_lost` counts.  What has been shown of a
  result is never taken back.  After a whole result the next is valid `refill` clocks later at the
  earliest.  `major` counts dropped results too.
* In a clock with `rst` high nothing is taken; afterwards every output is as at power-up.
* `[compensation]`: a sample of the sensor is taken when none is under way; so the next is ready to
  be taken in the clock after the core has taken the compensated one, which is offered to it from
  `Timing.compensation` clocks after the first was taken.  All of the above that is said of samples
  taken, but for what is lost, is said of that one.
* `hardening`: `upset` is low and status bit 4 is 0 as long as no bit of the core's state turns
  over.  When one has and the core has seen it, `upset` is high, and status bit 4 is set wherever a
  status is shown, from the next clock on until `Timing.under_way` results have been taken whole.
* `reset = "async"`: every output is as at power-up at once, in the clock in which `rst` rises, and
  stays so in the `RELEASE` clocks after it has fallen, and after power-up; in all of them
  `sample_ready` is low.  What is offered there counts for nothing.
* `clock_enable = true`: a clock with `clk_en` low does not count.  Nothing is taken in it and no
  output changes; but for a reset, which acts in such a clock too.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import NamedTuple

from sculler_model.design import STATUS_UPSET, Design, Result
from sculler_model.golden.reference import GoldenModel, Sample
from sculler_model.golden.stream import to_words, words_per_column

PORT_MAJOR_BITS = 64
"""Width of the parallel `result_major` port; `major` is shown modulo 2**64."""

COUNTER_BITS = 16
"""Width of `samples_lost` and `results_dropped`, one word of the stream."""

COUNTER_MAX = (1 << COUNTER_BITS) - 1
"""Where they stay: so many or more."""

RELEASE = 2
"""Clocks for which a core that resets at once stays in reset after its reset port, or power-up."""

STREAM_PORTS = ("data", "last")
"""The result ports of the stream hand-over, without their `result_`."""


@dataclass(frozen=True)
class Dropping:
    """How many clocks it takes to drop a result where `overrun = "drop-result"`.

    Attributes:
        claim: clocks from the one that takes an interval's last sample to the one before which the
            result that is being handed over must have been taken whole, lest the one that waits
            behind it be dropped.
        refill: a result taken whole in clock c: the next is valid in clock c + refill at the
            earliest.
    """

    claim: int
    refill: int

    def __post_init__(self) -> None:
        for name, lowest in {"claim": 0, "refill": 1}.items():
            if getattr(self, name) < lowest:
                raise ValueError(f"{name}: {getattr(self, name)} is not allowed, give >= {lowest}")


@dataclass(frozen=True)
class Timing:
    """How many clocks a core takes for what it does.

    Attributes:
        latency: clocks from the one that takes an interval's last sample to the first in which
            `result_valid` is high.
        spacing: a sample taken in clock c: the next at the earliest in clock c + spacing.
        startup: clocks after power-up or reset during which `sample_ready` is low.
        work: for each phase 1..n, clocks for which a sample of that phase keeps the engine: one
            taken in clock c with work w > 0, the next that has work at the earliest in clock
            c + w.  Empty: no sample has work.
        handover_spacing: a result, or a word of it, taken in clock c: the next is valid in clock
            c + handover_spacing at the earliest; 1 leaves `result_valid` high from word to word.
        results: how many results may be under way or wait to be taken.
        dropping: of a core that drops results instead of making samples wait for them; for such a
            core `results` means nothing.
        compensation: clocks from the one that takes a sample of the sensor to the first that offers
            the core behind it, which all else is of, the compensated one; None without that.
    """

    latency: int
    spacing: int = 1
    startup: int = 0
    work: tuple[int, ...] = ()
    handover_spacing: int = 1
    results: int = 1
    dropping: Dropping | None = None
    compensation: int | None = None

    def __post_init__(self) -> None:
        least = {"latency": 1, "spacing": 1, "startup": 0, "handover_spacing": 1, "results": 1}
        for name, lowest in least.items():
            if getattr(self, name) < lowest:
                raise ValueError(f"{name}: {getattr(self, name)} is not allowed, give >= {lowest}")
        if any(clocks < 0 for clocks in self.work):
            raise ValueError(f"work: {self.work} is not allowed, give whole numbers >= 0")

    @property
    def under_way(self) -> int:
        """Results under way at most: those not taken whole, and that of the present interval."""
        return 3 if self.dropping else self.results + 1

    @property
    def longest_wait(self) -> int:
        """Clocks within which something is taken, if samples are offered and results taken."""
        busy = max(self.work, default=0)
        refill = self.dropping.refill if self.dropping else 0
        own = self.startup + self.spacing + busy + self.latency + self.handover_spacing + refill
        return own + self.before

    @property
    def beside(self) -> int:
        """Clocks of the latency that pass while the result before is still handed over."""
        return 0

    @property
    def before(self) -> int:
        """Clocks that a sample spends before the core, at least."""
        return self.compensation or 0

    @property
    def samples_apart(self) -> int:
        """Clocks from a sample taken to the next, at least."""
        return max(self.spacing, self.compensation + 1 if self.compensation else 0)


class Ports(NamedTuple):
    """The output ports during one clock."""

    sample_ready: int
    result_valid: int
    result: tuple[int, ...]
    """The result ports in the order of `result_ports`; put to 0 while `result_valid` is low, for
    then they mean nothing."""
    samples_lost: int = 0
    results_dropped: int = 0
    """0 where the core has no such port."""
    upset: int = 0
    """0 where the core has no such port."""


def result_ports(design: Design) -> tuple[str, ...]:
    """Names, without `result_`, of the ports in `Ports.result`."""
    if design.hardware.handover != "stream":
        return design.columns
    return STREAM_PORTS if design.channels == 1 else (*STREAM_PORTS, "channel")


class EventCounter:
    """A counter that shows each event from a clock of its own on, and stays at its highest value.

    Reset clears it, events that it does not show yet included.
    """

    def __init__(self) -> None:
        self._shown = 0
        self._coming: deque[int] = deque()  # clocks from which they are shown, in order

    def count(self, from_clock: int) -> None:
        """An event that is shown from a clock on."""
        self._coming.append(from_clock)

    def at(self, clock: int) -> int:
        """What it shows; clocks never go back."""
        while self._coming and self._coming[0] <= clock:
            self._coming.popleft()
            self._shown = min(self._shown + 1, COUNTER_MAX)
        return self._shown


class _Waiting(NamedTuple):
    """A result that is under way or has not been taken whole."""

    ended: int
    """The clock that took its interval's last sample."""
    shown: deque[tuple[int, ...]]
    """What the result ports are still to show of it, one after another."""


class _UnderWay(NamedTuple):
    """A sample that is being compensated, or waits for the core."""

    sample: Sample
    lost: bool
    """One was lost before it."""
    offered: int
    """The clock from which the core may take it."""


class CycleModel:
    """Clock by clock twin of a core's ports.

    Args:
        design: the design; its `hardware.handover` says which result ports there are.
        timing: the core's own figures, as in the manifest.

    Attributes:
        golden: the model behind the ports, which has taken the samples that they took, but for one
            that is being compensated.

    Raises:
        ValueError: `timing.work` is not of as many phases as the design has.
    """

    def __init__(self, design: Design, timing: Timing) -> None:
        phases = design.algorithm.samples
        if len(timing.work) not in (0, phases):
            raise ValueError(f"work: {len(timing.work)} phases are not the design's {phases}")
        self.design = design
        self.timing = timing
        self._stream = design.hardware.handover == "stream"
        self._work = timing.work or (0,) * phases
        self._clock = 0
        self._resets_at_once = design.hardware.resets_at_once
        self._released = RELEASE if self._resets_at_once else 0  # clock that ends a reset
        self._reset()

    def _reset(self) -> None:
        """As at power-up, from the present clock on."""
        self.golden = GoldenModel(self.design)
        self._next_sample = self._clock + self.timing.startup  # clock from which one may come
        self._engine_free = self._clock  # clock from which the engine is
        self._results: deque[_Waiting] = deque()
        self._ports_free = self._clock  # clock from which the ports are free for the first of them
        self._claims: deque[int] = deque()  # clocks at which a result is to take the place behind
        self._refused = False  # the clock before offered a sample that was not taken
        self._under_way: _UnderWay | None = None  # what is being compensated
        self._lost_before = False  # a sample was, and none was taken since
        self._lost, self._dropped = EventCounter(), EventCounter()
        self._told = 0  # results to be taken until nothing tells of an upset any more
        self._seen = False  # an upset, in the present clock

    def ports(self) -> Ports:
        """What the outputs show during the present clock, before its inputs are known.

        A reset that acts at once is among those inputs.
        """
        ready = self._core_ready()
        if self.timing.compensation is not None:
            ready = self._under_way is None and self._clock >= self._released
        valid, shown = 0, (0,) * len(result_ports(self.design))
        if self._results:
            first = self._results[0]
            if self._clock >= max(first.ended + self.timing.latency, self._ports_free):
                valid, shown = 1, first.shown[0]
                if self._told:
                    shown = self._with_upset(shown, len(first.shown))
        lost, dropped = self._lost.at(self._clock), self._dropped.at(self._clock)
        return Ports(int(ready), valid, shown, lost, dropped, int(self._told > 0))

    def _core_ready(self) -> bool:
        """Whether the core takes a sample in the present clock."""
        t = self.golden.t
        last_is_next = (t + 1) % self.design.samples_per_major == 0
        has_work = self._work[t % len(self._work)] > 0
        full = self.timing.dropping is None and len(self._results) == self.timing.results
        return (
            self._clock >= max(self._next_sample, self._released)
            and not (has_work and self._clock < self._engine_free)
            and not (last_is_next and full)
        )

    def upset(self) -> None:
        """A hardened core sees an upset in the present clock."""
        self._seen = True

    def _with_upset(self, shown: tuple[int, ...], left: int) -> tuple[int, ...]:
        """What is shown, with the status' bit 4; `left` is it, and what is shown after it."""
        if not self._stream:
            return (shown[0], shown[1] | STATUS_UPSET, *shown[2:])
        per_column = words_per_column(self.design)
        place = len(self.design.columns) * per_column - left
        return (shown[0] | STATUS_UPSET, shown[1]) if place == per_column else shown

    def clock(
        self, offered: Sample | None, result_ready: int, rst: int = 0, clk_en: int = 1
    ) -> Ports:
        """Run one clock.

        Args:
            offered: the sample on the port where `sample_valid` is high, else None.
            result_ready, rst, clk_en: the inputs' levels; `rst` is 1 for a reset, whichever level
                of the port that is.

        Returns:
            The outputs as they were during this clock.
        """
        if rst and self._resets_at_once:
            self._released = self._clock + 1 + RELEASE
            self._reset()
        shown = self.ports()
        if self._clock < self._released:
            rst = 1
        elif not (rst or clk_en):
            return shown
        takes = offered is not None and shown.sample_ready
        if rst:
            self._clock += 1
            self._reset()
            return shown
        given, lost = (offered, False) if takes else (None, False)
        if self.timing.compensation is not None:
            given, lost = self._compensated()
        if given is not None:
            self._claim()
        self._drop()
        if shown.result_valid and result_ready:
            self._take_result()
        if self._seen:
            self._told, self._seen = self.timing.under_way, False
        if self._refused and offered is None:
            self._lost_before = True
            self._lost.count(self._clock + 2)
        if self.timing.compensation is None and self._lost_before:
            lost, self._lost_before = True, False
        if lost:
            self.golden.lose()
        self._refused = offered is not None and not takes
        if given is not None:
            self._take_sample(given)
        if self.timing.compensation is not None and offered is not None and takes:
            clock = self._clock + self.timing.compensation
            self._under_way = _UnderWay(offered, self._lost_before, clock)
            self._lost_before = False
        self._clock += 1
        return shown

    def _compensated(self) -> tuple[Sample | None, bool]:
        """What the core takes in this clock of what stands before it, and its mark of a loss."""
        waits = self._under_way
        if waits is None or self._clock < waits.offered or not self._core_ready():
            return None, False
        self._under_way = None
        return waits.sample, waits.lost

    def _claim(self) -> None:
        """A sample is taken in this clock; if it is an interval's last, its result wants room."""
        last = (self.golden.t + 1) % self.design.samples_per_major == 0
        if last and self.timing.dropping is not None:
            self._claims.append(self._clock + self.timing.dropping.claim)

    def _drop(self) -> None:
        """In the clock of its claim a result takes the place behind the one being handed over."""
        if not self._claims or self._claims[0] != self._clock:
            return
        assert self.timing.dropping is not None
        ended = self._claims.popleft() - self.timing.dropping.claim
        if len(self._results) > 1 and self._results[1].ended < ended:
            del self._results[1]
            self._dropped.count(self._clock + 2)

    def _take_sample(self, sample: Sample) -> None:
        work = self._work[self.golden.t % len(self._work)]
        self._next_sample = self._clock + self.timing.spacing
        if work:
            self._engine_free = self._clock + work
        result = self.golden.step(*sample)
        if result is not None:
            self._results.append(_Waiting(self._clock, deque(self._shown_as(result))))

    def _take_result(self) -> None:
        """The result, or its next word."""
        shown = self._results[0].shown
        shown.popleft()
        self._ports_free = self._clock + self.timing.handover_spacing
        if not shown:
            self._results.popleft()
            self._told = max(self._told - 1, 0)
            if self.timing.dropping is not None:
                self._ports_free = self._clock + self.timing.dropping.refill

    def _shown_as(self, result: Result) -> list[tuple[int, ...]]:
        """What the result ports show of a result, one after another."""
        row = result.row()
        if not self._stream:
            return [(row[0] % (1 << PORT_MAJOR_BITS), *row[1:])]
        words = to_words(self.design, row)
        return [*((word, 0) for word in words[:-1]), (words[-1], 1)]
