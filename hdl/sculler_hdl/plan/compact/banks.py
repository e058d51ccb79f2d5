"""Where each channel's words stand in the left memory, and where those that all of them use.

A channel's own words are those that outlive its sample: the accumulated components and the number
of the major interval.  They stand first in the memory map (`memory_map`), so their numbers within a
bank are those of the result.  All else, constants and sums that one sample needs, is common: one
program runs at a time.
"""

from __future__ import annotations

from dataclasses import dataclass

from sculler_model.design import Design
from sculler_model.golden import words_per_result


@dataclass(frozen=True)
class LeftBanks:
    """The left memory cut into banks, one of each channel.

    Attributes:
        channels: C.
        own: words of a channel that are its own; 0 where there is one channel and no banks.
        common: words that all channels use.
        bank: words of a bank, a power of two.
        common_bank: where the common words stand: in channel 0's bank after its own ones, where
            there is room, else in a bank of their own after all others.
    """

    channels: int
    own: int
    common: int
    bank: int
    common_bank: int

    @property
    def words(self) -> int:
        """Of the whole memory."""
        if self.channels == 1:
            return self.common
        return max(self.channels, self.common_bank + 1) * self.bank

    @property
    def bank_bits(self) -> int:
        """Of the number of a word within a bank."""
        return (self.bank - 1).bit_length()

    def within(self, address: int) -> int:
        """The number within its bank of a word of the memory map."""
        return address if address < self.own or not self.common_bank else address - self.own

    def is_own(self, address: int) -> int:
        """1 where a word of the memory map is a channel's own."""
        return int(address < self.own)


def left_banks(design: Design, words: int) -> LeftBanks:
    """The smaller of both ways to place so many words of a memory map."""
    if design.channels == 1:
        return LeftBanks(1, 0, words, 0, 0)
    own = words_per_result(design)
    common = words - own
    together, apart = (1 << (most - 1).bit_length() for most in (words, max(own, common)))
    if design.channels * together <= (design.channels + 1) * apart:
        return LeftBanks(design.channels, own, common, together, 0)
    return LeftBanks(design.channels, own, common, apart, design.channels)
