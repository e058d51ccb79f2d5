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

from sculler_model.golden.channel_cycles import ChannelPorts
from sculler_model.golden.channels import ChannelSample
from sculler_model.golden.cycles import Timing
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


class PipelinedChannelModel(ChannelPorts):
    """Clock by clock twin of the ports of a pipelined core with many channels.

    Args, attributes: as of `ChannelPorts`.
    """

    timing: PipelinedChannelTiming

    def _reset(self) -> None:
        super()._reset()
        self._started = self._clock + self.timing.startup
        self._waiting: deque[_Waiting] = deque()
        # of the first of them whose look-up has begun: clocks that it still takes
        self._looked: deque[int] = deque()
        self._pause = 0  # clocks until the next look-up may begin
        self._launched: dict[int, int] = {}  # the clock of each channel's last launch

    @property
    def _is_ready(self) -> bool:
        return self._clock >= self._started and len(self._waiting) < self.timing.waiting

    @property
    def _until_shown(self) -> int:
        return self.timing.latency - self.timing.lookup

    def _mark_loss(self, channel: int) -> None:
        if self._clock >= self._started:
            super()._mark_loss(channel)

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
            if self._is_full:
                return False
            self._put(sample.words, sample.channel)
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
