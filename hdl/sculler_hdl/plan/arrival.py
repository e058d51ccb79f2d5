"""Skewed words: integers whose bits do not all arrive at the same clock.

A long addition is cut into limbs (`Limbs`), as in multi-precision arithmetic: limb 0 takes the
lowest bits of the sum and so on.  Every limb is worked on a clock or two after the one below it,
with the carry between them in registers; so a whole tree of additions, however deep, costs these
clocks per further limb once, not at every level.  Bits that are there early wait in registers.

    clock      0        1        2
    limb 0   a0+b0 ─▶ ab0+cd0
    limb 1            a1+b1 ─▶ ab1+cd1
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple


class Limbs(NamedTuple):
    """How long additions are cut.

    Attributes:
        bits: of a limb, at most.
        clocks: from one limb to the next; with 2 the carry has a clock for its way alone.
    """

    bits: int
    clocks: int = 1

    def delay(self, bit: int) -> int:
        """Clocks after limb 0 at which the limb that a bit is in is worked on."""
        return bit // self.bits * self.clocks


def evenly(bits: int, most: int, clocks: int = 1) -> Limbs:
    """The fewest limbs of at most so many bits that make up a word, all of one length."""
    count = -(-bits // most)
    return Limbs(-(-bits // count), clocks)


Arrival = tuple[tuple[int, int], ...]
"""(width, clock) of consecutive bits, lowest first: when the bits of a word are there."""


def width(arrival: Arrival) -> int:
    """Bits of the word."""
    return sum(bits for bits, _ in arrival)


def at_once(bits: int, clock: int = 0) -> Arrival:
    """All bits at the same clock."""
    return ((bits, clock),)


def by_limbs(bits: int, limb: Limbs, clock: int = 0) -> Arrival:
    """Limb after limb, the lowest at a clock."""
    return tuple((hi - lo, clock + q) for q, lo, hi in limbs(bits, limb))


def later(arrival: Arrival, clocks: int) -> Arrival:
    """The same bits so many clocks later."""
    return tuple((bits, clock + clocks) for bits, clock in arrival)


def lowest(arrival: Arrival, bits: int) -> Arrival:
    """Only the lowest bits."""
    return tuple((min(end, bits) - lo, clock) for lo, end, clock in spans(arrival) if lo < bits)


def spans(arrival: Arrival, low: int = 0) -> Iterator[tuple[int, int, int]]:
    """(first bit, end bit, clock) of each piece, when bit 0 of the word weighs 2^low."""
    for bits, clock in arrival:
        yield low, low + bits, clock
        low += bits


def last_clock(arrival: Arrival, lo: int = 0, hi: int | None = None) -> int:
    """The clock at which all of bits lo..hi-1 are there."""
    return max(
        clock for first, end, clock in spans(arrival) if end > lo and (hi is None or first < hi)
    )


def first_limb_clock(arrival: Arrival, limb: Limbs, low: int = 0) -> int:
    """The earliest clock at which limb 0 may be worked on, so that no later limb has to wait."""
    return max(clock - limb.delay(first) for first, _, clock in spans(arrival, low))


def limbs(bits: int, limb: Limbs) -> Iterator[tuple[int, int, int]]:
    """(clocks after limb 0, first bit, end bit) of each limb of a word."""
    for lo in range(0, bits, limb.bits):
        yield limb.delay(lo), lo, min(bits, lo + limb.bits)
