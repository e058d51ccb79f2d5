"""Worst-case word lengths: why no input sequence can overflow the core.

Every quantity gets the exact interval that integer interval arithmetic gives it over *all* input
sequences, the most negative count included.  A signed register wide enough for the interval
therefore holds every value that can occur: that is the whole proof (docs/explanation/exactness.md).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, reduce

from sculler_model.algorithms import TapTable, scrolling_weights_total

MAX_BITS = 512
"""Of a result's component, and of the denominators.

The widest published table, filtered-rate with n = p = 16, needs 395 bits for 32-bit counts and
M = 4096.  What is wider comes of a slip in a user's table; its core would take minutes and
gigabytes to make and fit no device, and beyond 1023 bits the host's floats could not hold its
results.
"""


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


@dataclass(frozen=True)
class WordLengths:
    """Ranges of everything the high-rate algorithm holds, per vector component.

    Built by `word_lengths`; widths are ``.bits`` of each, two's complement.
    """

    gyro: Interval
    accel: Interval
    gyro_taps: Interval
    """A, the tapped gyro sum (any phase with a non-zero row)."""
    accel_taps: Interval
    """B, the tapped accelerometer sum."""
    theta: Interval
    v: Interval
    alpha: Interval
    nu: Interval
    coning_within: Interval
    coning_between: Interval
    sculling_within: Interval
    sculling_between: Interval
    s_alpha: Interval | None = None
    """Over 12; like the next two, None without high-resolution position."""
    s_nu: Interval | None = None
    scrolling: Interval | None = None
    """Over 4320."""


@lru_cache(maxsize=1024)
def word_lengths(
    gyro_bits: int, accel_bits: int, minors: int, table: TapTable, high_resolution: bool = False
) -> WordLengths:
    """Worst-case ranges of a design.

    Every interval below contains 0, because counts take both signs, so the partial sums on the way
    to each total stay inside the total's interval: an accumulator as wide as its total is enough.

    Args:
        gyro_bits, accel_bits: widths of the counts, two's complement.
        minors: M, minor intervals in a major interval.
        table: the tap table.
        high_resolution: whether the design has s_alpha, s_nu and scrolling.
    """
    gyro, accel = Interval.signed(gyro_bits), Interval.signed(accel_bits)
    phases = [(_weighted(gyro, row), _weighted(accel, row)) for row in table.taps if any(row)]
    coning_within = sculling_within = ZERO_RANGE
    for a, b in phases:
        coning_within += cross_range(a, gyro).repeated(minors)
        sculling_within += (cross_range(a, accel) + cross_range(b, gyro)).repeated(minors)

    theta, v = _weighted(gyro, table.weights), _weighted(accel, table.weights)
    coning_between = sculling_between = ZERO_RANGE
    for minor in range(minors):
        alpha, nu = theta.repeated(minor), v.repeated(minor)
        coning_between += cross_range(alpha, theta)
        sculling_between += cross_range(alpha, v) + cross_range(nu, theta)
    words = WordLengths(
        gyro=gyro,
        accel=accel,
        gyro_taps=reduce(Interval.__or__, (a for a, _ in phases), ZERO_RANGE),
        accel_taps=reduce(Interval.__or__, (b for _, b in phases), ZERO_RANGE),
        theta=theta,
        v=v,
        alpha=theta.repeated(minors),
        nu=v.repeated(minors),
        coning_within=coning_within,
        coning_between=coning_between,
        sculling_within=sculling_within,
        sculling_between=sculling_between,
    )
    return _with_position(words, table.samples * minors) if high_resolution else words


def _weighted(counts: Interval, coefficients: Sequence[int]) -> Interval:
    """The range of a weighted sum of independent counts."""
    return range_of_sum(counts.scaled(c) for c in coefficients)


def _with_position(words: WordLengths, samples: int) -> WordLengths:
    """The same with what high-resolution position adds, for so many samples a major interval."""
    # of N samples each counts 12 times for every later one and 6 times for itself; of the last
    # those are 5 and the sample before the interval has the one that lacks
    doubly = 6 * samples**2
    return replace(
        words,
        s_alpha=words.gyro.repeated(doubly),
        s_nu=words.accel.repeated(doubly),
        # bilinear in the samples: each product of two may be extreme with its weight's sign
        scrolling=cross_range(words.gyro, words.accel).repeated(scrolling_weights_total(samples)),
    )
