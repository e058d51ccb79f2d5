"""The cycle-accurate model of the ports of a compact core with many channels.

The contract is that of `cycles` with these differences:

* A sample is taken in a clock where `sample_valid` and `sample_ready` are both high, whichever
  channel it is of; `sample_ready` does not depend on the channel.  Then the core looks up what it
  keeps of that channel, for `lookup` clocks, and loads the sample, for `loading` clocks.  A sample
  that is its channel's first waits in between until the engine is free, and where the design's
  history can reach before it, it is loaded `clearing` clocks later.
* A loaded sample whose phase has no work is put away at once.  One that has work is launched as
  soon as the engine is free: `work` clocks after it was launched last.  If it is a major interval's
  last it also waits until fewer than two results are under way or not taken to their last word.
  `sample_ready` is high from two clocks after that on.  So a result that nobody takes makes samples
  of all channels wait, in the end.
* `result_valid` rises `latency` - `lookup` - `loading` clocks after the launch, or, where a result
  before it is not taken, `handover_spacing` clocks after the last word of that one was.
* `result_channel` says whose result it is, with every word of it.
* A sample with `sample_restart` makes its channel begin anew: what was summed up, the history, the
  result's number and losses not yet told are gone, and the sample is the channel's first.
* A loss marks the channel that `sample_channel` named in the clock that did not take it.
* A sample of a channel that is not there is taken and dropped; the next may come `ABSENT` clocks
  later.  Its loss is counted and marks nothing.
* After power-up or reset no channel has had a sample.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from sculler_model.design import Design, Result
from sculler_model.golden.channels import ChannelModel, ChannelSample
from sculler_model.golden.cycles import EventCounter, Ports, Timing, result_ports
from sculler_model.golden.stream import to_words

ABSENT = 3
"""Clocks from a sample of a channel that is not there to the next."""

AFTER_LAUNCH = 2
"""Clocks from a sample's launch, or its being put away, to the next."""


@dataclass(frozen=True)
class ChannelTiming(Timing):
    """How many clocks a core with many channels takes.

    Attributes:
        latency, spacing: where nothing waits.
        work: for each phase 1..n, clocks from the launch of a sample of that phase to the next
            launch at the earliest.
        results: how many results may be under way or wait to be taken.
        lookup: clocks from the one that takes a sample to the one in which loading can begin.
        loading: clocks from that to the one in which it can be launched.
        clearing: clocks more for a channel's first sample.
    """

    lookup: int = 1
    loading: int = 1
    clearing: int = 0

    @property
    def longest_wait(self) -> int:
        """As that of `Timing`."""
        return super().longest_wait + self.clearing + max(self.work, default=0)


class _Waiting(NamedTuple):
    """A result that is under way or has not been taken whole."""

    launched: int
    shown: deque[tuple[int, ...]]


class ChannelPorts(ABC):
    """Clock by clock twin of the ports of a core with many channels, whichever core it is.

    What both have in common: resets, losses, and results that are shown word by word.

    Args:
        design: the design, which hands over a stream.
        timing: the core's own figures, as in the manifest.

    Attributes:
        golden: the models behind the ports, which have taken the samples that they took.
    """

    timing: Timing

    def __init__(self, design: Design, timing: Timing) -> None:
        self.design = design
        self.timing = timing
        self._clock = 0
        self._reset()

    def _reset(self) -> None:
        """As at power-up, from the present clock on."""
        self.golden = ChannelModel(self.design)
        self._results: deque[_Waiting] = deque()
        self._ports_free = self._clock
        self._refused: int | None = None  # channel of a sample that was not taken a clock before
        self._lost = EventCounter()

    @property
    @abstractmethod
    def _is_ready(self) -> bool:
        """Whether `sample_ready` is high."""

    @property
    @abstractmethod
    def _until_shown(self) -> int:
        """Clocks from the launch of an interval's last sample to `result_valid`."""

    @abstractmethod
    def _launch(self) -> None:
        """Launch what may go in this clock."""

    @abstractmethod
    def _take_sample(self, sample: ChannelSample) -> None:
        """Take a sample of any channel, also of one that is not there."""

    def _mark_loss(self, channel: int) -> None:
        """Mark the channel of which a sample is lost."""
        if channel < self.design.channels:
            self.golden.lose(channel)

    def ports(self) -> Ports:
        """What the outputs show during the present clock, before its inputs are known."""
        valid, shown = 0, (0,) * len(result_ports(self.design))
        if self._results:
            first = self._results[0]
            if self._clock >= max(first.launched + self._until_shown, self._ports_free):
                valid, shown = 1, first.shown[0]
        return Ports(int(self._is_ready), valid, shown, self._lost.at(self._clock))

    def clock(
        self, offered: ChannelSample | None, result_ready: int, rst: int = 0, clk_en: int = 1
    ) -> Ports:
        """Run one clock; see `CycleModel.clock`.  There is no clock enable."""
        shown = self.ports()
        if rst:
            self._clock += 1
            self._reset()
            return shown
        self._launch()
        if shown.result_valid and result_ready:
            self._take_word()
        if self._refused is not None and offered is None:
            self._mark_loss(self._refused)
            from_clock = self._clock + 2
            self._lost.count(from_clock)
        takes = offered is not None and shown.sample_ready
        self._refused = None if offered is None or takes else offered.channel
        if offered is not None and takes:
            self._take_sample(offered)
        self._clock += 1
        return shown

    @property
    def _is_full(self) -> bool:
        """Whether there is no room for a result."""
        return len(self._results) == self.timing.results

    def _put(self, words: Sequence[int], channel: int) -> None:
        """Put a result, whose last sample is launched in this clock, behind the others."""
        last = len(words) - 1
        shown = ((word, int(i == last), channel) for i, word in enumerate(words))
        self._results.append(_Waiting(self._clock, deque(shown)))

    def _take_word(self) -> None:
        shown = self._results[0].shown
        shown.popleft()
        self._ports_free = self._clock + self.timing.handover_spacing
        if not shown:
            self._results.popleft()


class ChannelCycleModel(ChannelPorts):
    """Clock by clock twin of the ports of a compact core with many channels.

    Args, attributes: as of `ChannelPorts`.
    """

    timing: ChannelTiming

    def _reset(self) -> None:
        super()._reset()
        self._next_sample = self._clock + self.timing.startup
        self._engine_free = self._clock
        self._loaded: tuple[int, int, int, Result | None] | None = None
        """Clock from which the sample in the core can be launched; its work, channel, result."""

    @property
    def _is_ready(self) -> bool:
        return self._loaded is None and self._clock >= self._next_sample

    @property
    def _until_shown(self) -> int:
        return self.timing.latency - self.timing.lookup - self.timing.loading

    def _take_sample(self, sample: ChannelSample) -> None:
        if sample.channel >= self.design.channels:
            self._next_sample = self._clock + ABSENT
            return
        model, works = self.golden.models[sample.channel], self.timing.work
        first = sample.restart or model.t == 0
        work = works[0 if first else model.t % len(works)]
        there = self._clock + self.timing.lookup
        if first:
            there = max(there, self._engine_free) + self.timing.clearing
        there += self.timing.loading
        self._loaded = (there, work, sample.channel, self.golden.step(*sample))

    def _launch(self) -> None:
        """Launch the sample in the core, or put it away, if it may go in this clock."""
        if self._loaded is None:
            return
        there, work, channel, result = self._loaded
        full = result is not None and self._is_full
        if self._clock < there or (work and (self._clock < self._engine_free or full)):
            return
        if work:
            self._engine_free = self._clock + work
        if result is not None:
            self._put(to_words(self.design, result.row()), channel)
        self._loaded = None
        self._next_sample = self._clock + AFTER_LAUNCH
