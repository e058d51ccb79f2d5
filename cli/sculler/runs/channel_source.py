"""A log of many channels on its way through a core."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sculler.checks.breaks import BreakFinder
from sculler.formats.log import read_log
from sculler.words import Advance
from sculler_model.design import Design
from sculler_model.fast import VectorBlock, channel_runs
from sculler_model.golden import ChannelModel
from sculler_model.samples import end_after_stamp

ChannelChunk = tuple[
    NDArray[np.int64], NDArray[np.int64], NDArray[np.uint8] | None, NDArray[np.uint8] | None
]
"""Consecutive samples: counts (N, 6), channels (N,), faults and restarts (N,) or None for 0."""

NOT_LOOKED_AT = "time_s is not looked at for missing samples where there are channels"


class ChannelSource:
    """A log's samples for a core with channels, and what becomes of them.

    It knows the instants at which major intervals end, in the order of the samples that end them,
    which is the results' order.

    Attributes:
        samples: that went by.
        breaks: nothing; a log of channels is not looked at for breaks.
    """

    def __init__(self, design: Design, log: str | Path, advance: Advance) -> None:
        self._design, self._log, self._advance = design, log, advance
        self._phases = np.zeros(design.channels, np.int64)  # samples of intervals not complete
        self._ends: NDArray[np.float64] | None = None
        self._cut = 0
        self.samples = 0
        self.breaks = BreakFinder(design, str(log))

    def __iter__(self) -> Iterator[ChannelChunk]:
        for chunk in read_log(self._log, self._design, self._advance, channels=True):
            assert chunk.channels is not None  # the log's reader has seen to it
            last = self._ending(chunk.channels, chunk.restarts)
            if chunk.times is not None:
                ends = chunk.times[last] + end_after_stamp(self._design)
                self._ends = ends if self._ends is None else np.concatenate([self._ends, ends])
            self.samples += len(chunk.counts)
            yield chunk.counts, chunk.channels, chunk.faults, chunk.restarts

    def _ending(
        self, channels: NDArray[np.int64], restarts: NDArray[np.uint8] | None
    ) -> NDArray[np.int64]:
        """Which of the samples end a major interval of their channel, in order."""
        span = self._design.samples_per_major
        found = [np.zeros(0, np.int64)]
        for channel, anew, part in channel_runs(channels, restarts):
            if anew:
                self._cut += int(self._phases[channel])
                self._phases[channel] = 0
            found.append(part[span - 1 - self._phases[channel] :: span])
            self._phases[channel] = (self._phases[channel] + len(part)) % span
        return np.sort(np.concatenate(found))

    @property
    def left_out(self) -> int:
        """Samples of intervals that are not complete, those that a restart cut included."""
        return self._cut + int(self._phases.sum())

    @property
    def has_times(self) -> bool:
        """Whether the log has stamps, known from the first samples on."""
        return self._ends is not None

    @property
    def doubts(self) -> list[str]:
        """What the user should know of the log, in words."""
        return [NOT_LOOKED_AT] if self.has_times else []

    def stamped(self, block: VectorBlock) -> VectorBlock:
        """The next results with the instants of their ends, where the log has stamps."""
        if self._ends is None:
            return block
        times, self._ends = self._ends[: len(block)], self._ends[len(block) :]
        return replace(block, times=times)


class ReferenceChannels:
    """`ChannelModel` with the interface of `FastChannels`."""

    def __init__(self, design: Design) -> None:
        self._model = ChannelModel(design)
        self._design = design

    def reset(self) -> None:
        """Forget everything."""
        self._model.reset()

    def feed(
        self,
        counts: NDArray[np.int64],
        channels: NDArray[np.int64],
        faults: NDArray[np.uint8] | None,
        restarts: NDArray[np.uint8] | None,
    ) -> VectorBlock:
        """Take consecutive samples and return the major intervals they complete."""
        nothing = [0] * len(counts)
        marks = (nothing if each is None else each.tolist() for each in (faults, restarts))
        whose, results = [], []
        for row, channel, fault, again in zip(
            counts.tolist(), channels.tolist(), *marks, strict=True
        ):
            gyro, accel = (row[0], row[1], row[2]), (row[3], row[4], row[5])
            result = self._model.step(channel, gyro, accel, fault, again)
            if result is not None:
                whose.append(channel)
                results.append(result)
        block = VectorBlock.from_results(results, self._design)
        return replace(block, channels=np.array(whose, np.int64))
