"""The cycle-accurate model of a core's ports: what every output shows on every clock.

It knows the handshake contract, the golden model and the few numbers of `Timing`; nothing of what
is inside.  The contract of both cores:

* A sample is taken in a clock where `sample_valid` and `sample_ready` are both high; a result, or
  a word of it, in a clock where `result_valid` and `result_ready` are.
* `sample_ready` is low exactly when one of these holds: the clocks after power-up or reset
  (`Timing.startup`) are not over; the clocks between samples (`spacing`) are not over; the next
  sample's phase has work and the engine is still busy (`work`); the next sample would be a major
  interval's last and the previous interval's result has not been taken, to its last word, yet.
  It does not depend on `sample_valid`, nor, within the clock, on `result_ready`.
* `result_valid` rises `latency` clocks after the clock in which the interval's last sample was
  taken, and stays high until the result, or its word, is taken.
* Stream hand-over: the words of a result (`sculler_model.stream`) come one after another, a word
  `handover_spacing` clocks after the one before it was taken; `result_last` marks the last.
* While `result_valid` is low the other result ports mean nothing.
* In a clock with `rst` high nothing is taken; afterwards every output is as at power-up.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import NamedTuple

from sculler_model.design import Design
from sculler_model.golden import GoldenModel, Sample
from sculler_model.stream import to_words
from sculler_model.vectors import Result

PORT_MAJOR_BITS = 64
"""Width of the parallel `result_major` port; `major` is shown modulo 2**64."""

STREAM_PORTS = ("data", "last")
"""The result ports of the stream hand-over, without their `result_`."""


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
    """

    latency: int
    spacing: int = 1
    startup: int = 0
    work: tuple[int, ...] = ()
    handover_spacing: int = 1
    results: int = 1

    def __post_init__(self) -> None:
        least = {"latency": 1, "spacing": 1, "startup": 0, "handover_spacing": 1, "results": 1}
        for name, lowest in least.items():
            if getattr(self, name) < lowest:
                raise ValueError(f"{name}: {getattr(self, name)} is not allowed, give >= {lowest}")
        if any(clocks < 0 for clocks in self.work):
            raise ValueError(f"work: {self.work} is not allowed, give whole numbers >= 0")

    @property
    def longest_wait(self) -> int:
        """Clocks within which something is taken, if samples are offered and results taken."""
        busy = max(self.work, default=0)
        return self.startup + self.spacing + busy + self.latency + self.handover_spacing


class Ports(NamedTuple):
    """The output ports during one clock."""

    sample_ready: int
    result_valid: int
    result: tuple[int, ...]
    """The result ports in the order of `result_ports`; put to 0 while `result_valid` is low, for
    then they mean nothing."""


def result_ports(design: Design) -> tuple[str, ...]:
    """Names, without `result_`, of the ports in `Ports.result`."""
    return STREAM_PORTS if design.hardware.handover == "stream" else design.columns


class CycleModel:
    """Clock by clock twin of a core's ports.

    Args:
        design: the design; its `hardware.handover` says which result ports there are.
        timing: the core's own figures, as in the manifest.

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
        self._reset()

    def _reset(self) -> None:
        """As at power-up, from the present clock on."""
        self._golden = GoldenModel(self.design)
        self._next_sample = self._clock + self.timing.startup  # clock from which one may come
        self._engine_free = self._clock  # clock from which the engine is
        # what the result ports are to show, each with the clock from which it may
        self._waiting: deque[tuple[int, tuple[int, ...]]] = deque()
        self._ports_free = self._clock  # clock from which the ports are free for the first of it
        self._results = 0  # under way or not taken whole

    def ports(self) -> Ports:
        """What the outputs show during the present clock, before its inputs are known."""
        t = self._golden.t
        last_is_next = (t + 1) % self.design.samples_per_major == 0
        has_work = self._work[t % len(self._work)] > 0
        ready = (
            self._clock >= self._next_sample
            and not (has_work and self._clock < self._engine_free)
            and not (last_is_next and self._results == self.timing.results)
        )
        if self._waiting:
            valid_from, shown = self._waiting[0]
            if self._clock >= max(valid_from, self._ports_free):
                return Ports(int(ready), 1, shown)
        return Ports(int(ready), 0, (0,) * len(result_ports(self.design)))

    def clock(self, offered: Sample | None, result_ready: int, rst: int = 0) -> Ports:
        """Run one clock.

        Args:
            offered: the sample on the port where `sample_valid` is high, else None.
            result_ready, rst: the inputs' levels.

        Returns:
            The outputs as they were during this clock.
        """
        shown = self.ports()
        if rst:
            self._clock += 1
            self._reset()
            return shown
        if shown.result_valid and result_ready:
            self._take_result()
        if offered is not None and shown.sample_ready:
            self._take_sample(offered)
        self._clock += 1
        return shown

    def _take_sample(self, sample: Sample) -> None:
        work = self._work[self._golden.t % len(self._work)]
        self._next_sample = self._clock + self.timing.spacing
        if work:
            self._engine_free = self._clock + work
        result = self._golden.step(*sample)
        if result is not None:
            valid_from = self._clock + self.timing.latency
            self._waiting.extend((valid_from, shown) for shown in self._shown_as(result))
            self._results += 1

    def _take_result(self) -> None:
        """The result, or its next word."""
        _, shown = self._waiting.popleft()
        self._ports_free = self._clock + self.timing.handover_spacing
        whole = shown[-1] if self._stream else 1  # of a stream, with the last word
        self._results -= whole

    def _shown_as(self, result: Result) -> list[tuple[int, ...]]:
        """What the result ports show of a result, one after another."""
        row = result.row()
        if not self._stream:
            return [(row[0] % (1 << PORT_MAJOR_BITS), *row[1:])]
        words = to_words(self.design, row)
        return [*((word, 0) for word in words[:-1]), (words[-1], 1)]
