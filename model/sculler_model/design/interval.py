"""Closed ranges of integers, with exact interval arithmetic."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import reduce


@dataclass(frozen=True)
class Interval:
    """A closed range of integers with exact interval arithmetic.

    Attributes:
        lo, hi: its ends, both in it.

    Raises:
        ValueError: it is empty.
    """

    lo: int
    hi: int

    def __post_init__(self) -> None:
        if self.lo > self.hi:
            raise ValueError(f"empty interval {self.lo}..{self.hi}")

    @classmethod
    def signed(cls, bits: int) -> Interval:
        """All values of a two's-complement word."""
        return cls(-(1 << (bits - 1)), (1 << (bits - 1)) - 1)

    @property
    def bits(self) -> int:
        """Narrowest two's-complement width that holds the interval (at least 1)."""
        return (
            max(
                self.lo.bit_length() if self.lo >= 0 else (~self.lo).bit_length(),
                self.hi.bit_length() if self.hi >= 0 else (~self.hi).bit_length(),
            )
            + 1
        )

    def __contains__(self, value: int) -> bool:
        return self.lo <= value <= self.hi

    def __add__(self, other: Interval) -> Interval:
        return Interval(self.lo + other.lo, self.hi + other.hi)

    def __neg__(self) -> Interval:
        return Interval(-self.hi, -self.lo)

    def __sub__(self, other: Interval) -> Interval:
        return self + -other

    def __mul__(self, other: Interval) -> Interval:
        ends = [a * b for a in (self.lo, self.hi) for b in (other.lo, other.hi)]
        return Interval(min(ends), max(ends))

    def scaled(self, factor: int) -> Interval:
        """The interval of factor * x for one x (not of a sum of different ones)."""
        return self * Interval(factor, factor)

    def repeated(self, count: int) -> Interval:
        """The interval of a sum of `count` values, each anywhere in this one."""
        return Interval(self.lo * count, self.hi * count)

    def __or__(self, other: Interval) -> Interval:
        """The smallest interval holding both."""
        return Interval(min(self.lo, other.lo), max(self.hi, other.hi))


ZERO_RANGE = Interval(0, 0)


def range_of_sum(intervals: Iterable[Interval]) -> Interval:
    """Interval of the sum of independent values."""
    return reduce(Interval.__add__, intervals, ZERO_RANGE)


def cross_range(left: Interval, right: Interval) -> Interval:
    """Interval of one component of a cross product: left_y right_z - left_z right_y."""
    return left * right - left * right
