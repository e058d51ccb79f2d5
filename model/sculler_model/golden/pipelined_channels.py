"""The cycle-accurate model of the ports of a pipelined core with many channels.

The contract is that of `cycles` with these differences:

* Samples wait in the core in the order in which they were taken.  `sample_ready` is high in a clock
  if fewer than `waiting` samples waited at the end of the clock before; it does not depend on the
  channel.
* A sample that waits is looked up: what the core keeps of its channel comes `lookup` clocks after
  the sample was taken, and then it is launched.  Samples are looked up and launched in order, each
  `spacing` clocks after the one before it at the earliest.
* A sample's look-up begins `apart` - `lookup` + 1 clocks after the launch of the last sample of its
  own channel, at the earliest: so samples of one channel are launched `apart` clocks apart, samples
  of different channels `spacing` clocks apart.
* A major interval's last sample is not launched while `results` results are under way or have not
  been taken to their last word.  As long as it is kept back no other sample's look-up begins or
  goes on.  So a result that nobody takes makes samples of all channels wait, in the end.
* `result_valid` rises `latency` - `lookup` clocks after the launch of an interval's last sample.
* `result_channel` says whose result it is, with every word of it.
* A sample with `sample_restart` makes its channel begin anew: what was summed up, the history, the
  result's number and losses not yet told are gone, and the sample is the channel's first.
* A loss marks the channel that `sample_channel` named in the clock that did not take it.  A loss
  in the clocks after reset in which nothing is taken (`startup`) is counted and marks nothing.
* A sample of a channel that is not there is taken and dropped.  Its loss is counted and marks
  nothing.
* After power-up or reset no channel has had a sample.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import NamedTuple

from sculler_model.design import Design
from sculler_model.golden.channels import ChannelModel, ChannelSample
from sculler_model.golden.cycles import EventCounter, Ports, Timing, result_ports
from sculler_model.golden.stream import to_words


@dataclass(frozen=True)
class PipelinedChannelTiming(Timing):
    """How many clocks a pipelined core with many channels takes.

    Attributes:
        latency: where nothing waits.
        spacing: from one launch to the next, at least.
        lookup: clocks from the one that takes a sample to its launch, where nothing waits.
        apart: clocks between the launches of two samples of one channel, at least.
        waiting: samples that may wait to be launched.
    """

    lookup: int = 2
    apart: int = 3
    waiting: int = 4

    @property
    def longest_wait(self) -> int:
        """As that of `Timing`."""
        return super().longest_wait + self.waiting * (self.apart + self.lookup)

    @property
    def beside(self) -> int:
        """As that of `Timing`: the next result's last sample is looked up meanwhile."""
        return self.lookup


class _Waiting(NamedTuple):
    """A sample that has been taken."""

    channel: int
    words: list[int] | None
    """Of the result that it completes."""


class _Result(NamedTuple):
    """A result that is under way or has not been taken whole."""

    launched: int
    shown: deque[tuple[int, ...]]


class PipelinedChannelModel:
    """Clock by clock twin of the ports of a pipelined core with many channels.

    Args:
        design: the design, which hands over a stream.
        timing: the core's own figures, as in the manifest.

    Attributes:
        golden: the models behind the ports, which have taken the samples that they took.
    """

    def __init__(self, design: Design, timing: PipelinedChannelTiming) -> None:
        self.design = design
        self.timing = timing
        self._clock = 0
        self._reset()

    def _reset(self) -> None:
        """As at power-up, from the present clock on."""
        self.golden = ChannelModel(self.design)
        self._started = self._clock + self.timing.startup
        self._waiting: deque[_Waiting] = deque()
        # of the first of them whose look-up has begun: clocks that it still takes
        self._looked: deque[int] = deque()
        self._pause = 0  # clocks until the next look-up may begin
        self._launched: dict[int, int] = {}  # the clock of each channel's last launch
        self._results: deque[_Result] = deque()
        self._ports_free = self._clock
        self._refused: int | None = None  # channel of a sample that was not taken a clock before
        self._lost = EventCounter()

    def ports(self) -> Ports:
        """What the outputs show during the present clock, before its inputs are known."""
        ready = self._clock >= self._started and len(self._waiting) < self.timing.waiting
        valid, shown = 0, (0,) * len(result_ports(self.design))
        if self._results:
            first = self._results[0]
            there = first.launched + self.timing.latency - self.timing.lookup
            if self._clock >= max(there, self._ports_free):
                valid, shown = 1, first.shown[0]
        return Ports(int(ready), valid, shown, self._lost.at(self._clock))

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
            if self._refused < self.design.channels and self._clock >= self._started:
                self.golden.lose(self._refused)
            shown_from = self._clock + 2
            self._lost.count(shown_from)
        takes = offered is not None and shown.sample_ready
        self._refused = None if offered is None or takes else offered.channel
        if offered is not None and takes:
            self._take_sample(offered)
        self._clock += 1
        return shown

    def _take_sample(self, sample: ChannelSample) -> None:
        if sample.channel >= self.design.channels:
            return
        result = self.golden.step(*sample)
        words = None if result is None else to_words(self.design, result.row())
        self._waiting.append(_Waiting(sample.channel, words))

    def _launch(self) -> None:
        """Launch the first sample that waits, if it is looked up; go on with the others' look-up.

        A sample whose look-up begins in a clock is launched `lookup` - 1 clocks later.
        """
        if self._looked and self._looked[0] == 0:
            if not self._goes(self._waiting[0]):
                return
            self._looked.popleft()
            self._waiting.popleft()
        self._looked = deque(left - 1 for left in self._looked)
        self._look_up()

    def _goes(self, sample: _Waiting) -> bool:
        """Launch a sample in this clock, unless there is no room for its result."""
        if sample.words is not None:
            if len(self._results) == self.timing.results:
                return False
            last = len(sample.words) - 1
            shown = [(word, int(i == last), sample.channel) for i, word in enumerate(sample.words)]
            self._results.append(_Result(self._clock, deque(shown)))
        self._launched[sample.channel] = self._clock
        return True

    def _look_up(self) -> None:
        """Begin the look-up of the next sample, if it may."""
        self._pause = max(self._pause - 1, 0)
        begun = len(self._looked)
        if len(self._waiting) == begun or self._pause:
            return
        sample = self._waiting[begun]
        if any(self._waiting[i].channel == sample.channel for i in range(begun)):
            return
        last = self._launched.get(sample.channel)
        after = self.timing.apart - self.timing.lookup + 1
        if last is not None and self._clock < last + after:
            return
        self._looked.append(self.timing.lookup - 2)
        self._pause = self.timing.spacing

    def _take_word(self) -> None:
        shown = self._results[0].shown
        shown.popleft()
        self._ports_free = self._clock + self.timing.handover_spacing
        if not shown:
            self._results.popleft()
