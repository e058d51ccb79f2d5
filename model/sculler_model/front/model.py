"""`FrontModel`: bytes in, samples and counters out."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from sculler_model.front.link import Link
from sculler_model.front.receiver import Receiver
from sculler_model.front.sequence import FrontCounters, FrontSample, Sequence


class FrontModel:
    """The golden model of a front end: what its samples and counters are, from the bytes alone.

    Args:
        link: the sensor on its wire.
        timed: whether bytes come with their clocks, so that there are time-outs.

    Examples:
        >>> from sculler_model.design import Design
        >>> design = Design.parse({
        ...     "preset": "stim300", "hardware": {"front": {"sensor": "stim300", "clock_hz": 1e8}}
        ... })
        >>> model = FrontModel(design.front)
        >>> list(model.take(0x91, clock=0))
        []
    """

    def __init__(self, link: Link, timed: bool = True) -> None:
        self._receiver = Receiver(link.layout)
        self._sequence = Sequence(link, timed)

    @property
    def counters(self) -> FrontCounters:
        """What has been counted."""
        own = self._sequence.counters
        return replace(own, frames_bad=own.frames_bad + self._receiver.broken)

    def take(self, byte: int, clock: int = 0) -> Iterator[FrontSample]:
        """The samples that follow from a byte that is whole in a clock, and from the time till it.

        Args:
            byte: 0 to 255.
            clock: growing; any, if bytes have no times.
        """
        yield from self._sequence.until(clock)
        for kind, frame in self._receiver.take(byte):
            absent = any(flags.raised_in(frame) for flags in self._receiver.layout.absent)
            if kind.sample and not absent:
                yield from self._sequence.frame(frame, clock)

    def until(self, clock: int) -> Iterator[FrontSample]:
        """The placeholders of time-outs before a clock."""
        return self._sequence.until(clock)

    def run(self, content: Iterable[int]) -> Iterator[FrontSample]:
        """The samples of bytes without times, such as a recorder's file."""
        for byte in content:
            yield from self.take(byte)
