"""Numbers as strings of digits of 16 bits, and the memory that a design's numbers take."""

from __future__ import annotations

from dataclasses import dataclass

from sculler_model.design import AXES, Design, Interval
from sculler_model.golden import WORD_BITS

DIGIT = Interval(0, (1 << WORD_BITS) - 1)
"""Range of a digit that is not the top one."""

OPERAND = Interval.signed(18)
"""Range of any digit."""


def digit_count(bits: int) -> int:
    """Digits of a number of so many bits: 16 each, the top one up to 18."""
    return max(1, 1 - (OPERAND.bits - bits) // WORD_BITS)


def digit_ranges(number: Interval, least: int = 1) -> list[Interval]:
    """Range of each digit of a number, least significant first, `least` digits or more."""
    count = max(least, digit_count(number.bits))
    shift = WORD_BITS * (count - 1)
    return [DIGIT] * (count - 1) + [Interval(number.lo >> shift, number.hi >> shift)]


@dataclass(frozen=True)
class MemorySizes:
    """How large the memories of a design's compact core are.

    Attributes:
        digits_per_count: digits that each of a sample's six counts takes in the sample memory.
        sample_words: words of one sample there.
        kept_samples: samples there, a power of two.
        result_banks: results in the result memory.
    """

    digits_per_count: int
    sample_words: int
    kept_samples: int
    result_banks: int

    @property
    def index_bits(self) -> int:
        """Of the number of a word of a sample."""
        return (self.sample_words - 1).bit_length()

    @property
    def slot_bits(self) -> int:
        """Of the number of a sample."""
        return (self.kept_samples - 1).bit_length()

    @property
    def bank_bits(self) -> int:
        """Of the number of a bank of results."""
        return (self.result_banks - 1).bit_length()


def memory_sizes(design: Design) -> MemorySizes:
    """The sizes that a design asks for.

    While a phase's program runs, which reaches `history` back, up to n newer samples come in.  One
    result is shown, one filled; where results are dropped, or are of many channels, one waits.
    Samples are those of a channel.
    """
    digits = digit_count(max(design.words.gyro.bits, design.words.accel.bits))
    least = design.table.history + 1 + design.algorithm.samples
    return MemorySizes(
        digits_per_count=digits,
        sample_words=2 * len(AXES) * digits,
        kept_samples=1 << (least - 1).bit_length(),
        result_banks=3 if design.drops_results or design.channels > 1 else 2,
    )
