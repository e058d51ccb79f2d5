"""Samples in their places: what is missing among the frames is told by counter and by clock."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

from sculler_model.front.link import Link

Counts = tuple[int, int, int]


class FrontSample(NamedTuple):
    """A sample as it is handed to the core.

    Attributes:
        gyro, accel: counts x, y, z.
        fault: what `sample_fault` says.
        placeholder: it stands for one that is missing, with the counts of the one before.
        latency: as the frame tells it; 0 where it does not.
    """

    gyro: Counts
    accel: Counts
    fault: bool = False
    placeholder: bool = False
    latency: int = 0


@dataclass
class FrontCounters:
    """What has been counted since reset, as the ports of the same names count.

    Attributes:
        frames_taken: frames whose samples were handed over.
        frames_bad: frames that were not used: their check was wrong, or they came after a
            placeholder had taken their place.
        frames_missed: placeholders for frames that the counter told to be missing.
        frames_late: placeholders put in by time-outs.
        sensor_faults: samples taken whose status raised a flag, or whose counter had jumped.
    """

    frames_taken: int = 0
    frames_bad: int = 0
    frames_missed: int = 0
    frames_late: int = 0
    sensor_faults: int = 0


class Sequence:
    """Puts each sample where it belongs, so that time never slips.

    `expected` is the count that the next sample should have.  A frame whose count is k samples
    further comes after k placeholders, if k is no more than `patience`.  A frame whose count is
    behind was given up by a time-out before, up to as many as were: it is not used.  Any other
    count has jumped: the sensor began anew, the sample is marked and counting goes on from it.

    Without a frame for `time_out` clocks, as many placeholders come as there is `patience`, and
    one more at each `interval` after that.  Nothing comes before the first frame.

    Args:
        link: the sensor on its wire.
        timed: whether bytes have arrival times; without, no time-out ever comes and any k is
            taken for missing frames.

    Attributes:
        counters: all but broken frames.
    """

    def __init__(self, link: Link, timed: bool = True) -> None:
        self.link = link
        self.timed = timed
        self.counters = FrontCounters()
        self._expected: int | None = None
        self._ahead = 0  # placeholders by time-outs since the last sample
        self._last: FrontSample | None = None
        self._due: int | None = None  # clock of the next time-out
        self._first = True  # it is the first one since a frame

    def until(self, clock: int) -> Iterator[FrontSample]:
        """The placeholders whose time-outs come before a clock."""
        while self.timed and self._due is not None and self._due < clock:
            count = self.link.patience if self._first else 1
            self._due += self.link.interval
            self._first = False
            self._ahead += count
            self.counters.frames_late += count
            yield from self._placeholders(count)

    def frame(self, frame: bytes, clock: int) -> Iterator[FrontSample]:
        """The samples that a frame brings whose last byte came in a clock."""
        layout = self.link.layout
        missing, jumped = 0, False
        self._due, self._first = clock + self.link.time_out, True
        if layout.counter is not None:
            found = self._missing(layout.counter.number.of(frame))
            if found is None:
                self.counters.frames_bad += 1
                return
            missing, jumped = found
        self.counters.frames_missed += missing
        yield from self._placeholders(missing)
        fault = jumped or any(flags.raised_in(frame) for flags in layout.faults)
        self.counters.frames_taken += 1
        self.counters.sensor_faults += fault
        self._ahead = 0
        gyro, accel = (
            (axes[0].of(frame), axes[1].of(frame), axes[2].of(frame))
            for axes in (layout.gyro, layout.accel)
        )
        latency = 0 if layout.latency is None else layout.latency.of(frame)
        self._last = FrontSample(gyro, accel, fault, latency=latency)
        if layout.counter is not None:
            self._expected = layout.counter.number.of(frame) + layout.counter.step
        yield self._last

    def _missing(self, count: int) -> tuple[int, bool] | None:
        """How many frames are missing before this one, and whether the counter has jumped.

        None where the frame came after its placeholder.
        """
        counter = self.link.layout.counter
        assert counter is not None
        if self._expected is None:
            return 0, False
        steps = counter.steps(count - self._expected)
        if steps is None:
            return 0, True
        behind = counter.samples - steps
        if steps and behind <= min(self._ahead, counter.samples // 2):
            return None
        if self.timed and steps > self.link.patience:
            return 0, True
        return steps, False

    def _placeholders(self, count: int) -> Iterator[FrontSample]:
        counter = self.link.layout.counter
        if self._expected is not None and counter is not None:
            self._expected += count * counter.step
        for _ in range(count):
            assert self._last is not None
            yield self._last._replace(fault=True, placeholder=True)
