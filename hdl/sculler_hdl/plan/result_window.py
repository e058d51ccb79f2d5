"""How a result stands in words of 32 bits: in the register window, and in a packet.

Each column of the design, in order, takes the same number of words, least significant first,
extended by its sign.  Time stamps follow.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from sculler_model.design import Design
from sculler_model.golden import WORD_BITS, words_per_column

STAMPS = (
    ("sample_time", 2, "clocks since reset when the interval's last sample came"),
    ("result_time", 2, "clocks since reset when the result was whole"),
    ("pulse_time", 2, "clocks since reset at the last pulse before that"),
    ("pulses", 1, "pulses before that, modulo 2^32"),
)
"""The time stamps of a result: name, words, meaning."""


class Entry(NamedTuple):
    """A column, or a time stamp.

    Attributes:
        name: of the column, as in the vectors file; of the stamp, as in `STAMPS`.
        first, words: its first word, and how many it has.
        signed: whether it is two's complement.
        meaning: in words.
    """

    name: str
    first: int
    words: int
    signed: bool
    meaning: str


@dataclass(frozen=True)
class ResultWindow:
    """The words of a design's result.

    Attributes:
        design: the design.
    """

    design: Design

    @property
    def time_stamps(self) -> bool:
        """Whether there are any."""
        bus = self.design.hardware.bus
        return bus is not None and bus.time_stamps

    @property
    def words_per_column(self) -> int:
        """Of 32 bits."""
        return -(-words_per_column(self.design) * WORD_BITS // 32)

    @cached_property
    def entries(self) -> tuple[Entry, ...]:
        """All of it, in order."""
        each = self.words_per_column
        found = [
            Entry(name, number * each, each, number > 1, f"column {name} of the result")
            for number, name in enumerate(self.design.columns)
        ]
        for name, words, meaning in STAMPS if self.time_stamps else ():
            last = found[-1]
            found.append(Entry(name, last.first + last.words, words, False, meaning))
        return tuple(found)

    @property
    def words(self) -> int:
        """Of a result with its stamps."""
        last = self.entries[-1]
        return last.first + last.words
