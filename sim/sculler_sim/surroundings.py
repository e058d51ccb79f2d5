"""The sensor and the host computer around the core, for engines that go clock by clock."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal, NamedTuple

from sculler_model.design import Design
from sculler_model.golden import (
    ChannelSample,
    Ports,
    Sample,
    Timing,
    from_words,
    words_per_result,
)
from sculler_sim.run import RESET, CheckedChunk, Progress, wrong_last
from sculler_sim.stimulus import Stimulus

_LEVELS = 1 << 12  # clocks of stimulus made at a time


_RESET: Literal["reset"] = "reset"  # in the place of a sample
_END: Literal["end"] = "end"


class Inputs(NamedTuple):
    """The core's inputs during one clock."""

    sample_valid: int
    sample: Sample | ChannelSample | None
    """What the sample ports show, valid or not; None leaves them as they are."""
    result_ready: int
    rst: int
    """1 for a reset, whichever level of the port that is."""
    clk_en: int = 1
    """1 where the core has no such port."""


class Surroundings:
    """Drives a core by the rules of `sculler_sim.engine`.

    In each clock the engine drives `inputs` and then gives what the ports showed to `clocked`.

    Args:
        design: the design.
        timing: the core's clocks, which tell a slow core from one that hangs.
        chunks: the samples; `RESET` between two resets the core, once its results are out.
        stimulus: levels of the handshakes and the reset.
        progress: counted up as the run goes on.
        clocks: run this many clocks; None runs until all samples are taken and all results out.

    Attributes:
        inputs: the levels of the present clock.
        taken: results the host has taken, (major, status, 18 components) each, then its channel
            where there are channels; clear at will.

    Raises (by `clocked`):
        SimulationError: the core hangs, or marks a wrong word as a result's last.
    """

    def __init__(
        self,
        design: Design,
        timing: Timing,
        chunks: Iterator[CheckedChunk | None],
        stimulus: Stimulus,
        progress: Progress,
        clocks: int | None = None,
    ) -> None:
        self.taken: list[tuple[int, ...]] = []
        self._can_stop = design.hardware.clock_enable is True
        self._words: list[int] = []  # of the result that is being taken
        self._design = design
        self._timing = timing
        self._stimulus = stimulus
        self._progress = progress
        self._clocks = clocks
        self._levels = self._each_level()
        self._phases = [0] * design.channels  # samples taken of the present major intervals
        self._samples = _each_sample(chunks)
        self._next = next(self._samples, _END)
        self._held = 0
        self._resets = False  # this clock resets the core between two samples
        self._pause = 0  # a sample was given up in the clock before
        self._gives_up = 0
        self.inputs = self._present()

    @property
    def done(self) -> bool:
        """Whether the run has come to its end."""
        if self._clocks is not None:
            return self._progress.clocks >= self._clocks
        return self._next == _END and self._progress.drained

    def clocked(self, ports: Ports) -> None:
        """End the present clock, in which the core showed `ports`."""
        run = self._progress
        run.clocks += 1
        run.idle += 1
        if self.inputs.clk_en or self.inputs.rst:
            self._counted(ports)
        if self._clocks is None:
            run.check_alive(self._stimulus, self._timing)
        self.inputs = self._present()

    def _counted(self, ports: Ports) -> None:
        """A clock in which the core did not stand still."""
        valid, _, take, rst, _ = self.inputs
        run = self._progress
        self._held = valid
        self._pause = 0
        if valid and self._gives_up and (rst or not ports.sample_ready):
            self._next = next(self._samples, _END)
            self._held, self._pause = 0, 1
            run.lost += 1
        if rst:
            run.since_reset = run.intervals_told = run.due = 0
            self._phases = [0] * self._design.channels
            self._words.clear()
            if self._resets:
                self._next = next(self._samples, _END)
                self._resets = False
        else:
            if valid and ports.sample_ready:
                self._count_sample()
                self._next = next(self._samples, _END)
                self._held = 0
                run.samples += 1
                run.since_reset += 1
                run.idle = 0
            if take and ports.result_valid:
                run.idle = 0
                self._take(ports.result)

    def _count_sample(self) -> None:
        """The next sample is taken."""
        channel = 0
        if isinstance(self._next, ChannelSample):
            channel = self._next.channel
            if self._next.restart:
                self._phases[channel] = 0
        self._phases[channel] += 1
        if self._phases[channel] == self._design.samples_per_major:
            self._phases[channel] = 0
            self._progress.due += 1

    def _take(self, shown: tuple[int, ...]) -> None:
        """The host takes what the result ports show: a result, or one of its words."""
        if self._design.hardware.handover == "stream":
            word, last, *channel = shown
            self._words.append(word)
            wanted = words_per_result(self._design)
            if bool(last) != (len(self._words) == wanted):
                raise wrong_last(len(self._words), wanted)
            if not last:
                return
            shown = (*from_words(self._design, self._words), *channel)
            self._words.clear()
        self.taken.append(shown)
        self._progress.results += 1
        self._progress.intervals_told += 1
        if self._design.drops_results:
            self._progress.intervals_told = shown[0] + 1

    def _present(self) -> Inputs:
        offer, take, rst, self._gives_up, enable = next(self._levels)
        enable |= not self._can_stop
        if self._next == _RESET:
            self._resets = self._progress.drained
            return Inputs(0, None, take, int(self._resets) | rst, enable)
        if self._next == _END:
            return Inputs(0, None, take, rst, enable)
        if (offer or self._held) and not self._pause:
            return Inputs(1, self._next, take, rst, enable)
        return Inputs(0, self._not_offered(self._next), take, rst, enable)

    def _not_offered(self, sample: Sample | ChannelSample) -> Sample | ChannelSample:
        """What the ports show while a sample is not offered."""
        if isinstance(sample, ChannelSample):
            highest = (1 << (self._design.channels - 1).bit_length()) - 1
            gyro, accel = _complement(sample.gyro), _complement(sample.accel)
            return ChannelSample(highest - sample.channel, gyro, accel, 1, 1)
        gyro, accel, _ = sample
        return _complement(gyro), _complement(accel), 1

    def _each_level(self) -> Iterator[tuple[int, ...]]:
        start = 0
        while True:
            levels = self._stimulus.levels(start, _LEVELS)
            yield from zip(*(level.tolist() for level in levels), strict=True)
            start += _LEVELS


def sample_levels(sample: Sample | ChannelSample) -> tuple[int, ...]:
    """What the sample ports show of a sample, in the order of `sample_ports`."""
    if isinstance(sample, ChannelSample):
        return (*sample.gyro, *sample.accel, sample.fault, sample.channel, sample.restart)
    gyro, accel, fault = sample
    return (*gyro, *accel, fault)


def _complement(counts: tuple[int, int, int]) -> tuple[int, int, int]:
    x, y, z = counts
    return (~x, ~y, ~z)


def _each_sample(
    chunks: Iterator[CheckedChunk | None],
) -> Iterator[Sample | ChannelSample | Literal["reset"]]:
    for chunk in chunks:
        if chunk is RESET:
            yield _RESET
            continue
        tags = chunk.tags.tolist() or [None] * len(chunk.counts)
        rows = zip(chunk.counts.tolist(), chunk.faults.tolist(), tags, strict=True)
        for (gx, gy, gz, ax, ay, az), fault, tag in rows:
            gyro, accel = (gx, gy, gz), (ax, ay, az)
            if tag is None:
                yield gyro, accel, fault
            else:
                yield ChannelSample(tag >> 1, gyro, accel, fault, tag & 1)
