"""Worst-case word lengths: why no input sequence can overflow the core.

Every quantity gets the exact interval that integer interval arithmetic gives it over *all* input
sequences, the most negative count included.  A signed register wide enough for the interval
therefore holds every value that can occur: that is the whole proof (docs/explanation/exactness.md).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, reduce

from sculler_model.algorithms import TapTable, scrolling_weights_total
from sculler_model.design.higher_order_words import (
    DualRange,
    HigherOrderWords,
    higher_order_words,
)
from sculler_model.design.interval import ZERO_RANGE, Interval, cross_range, range_of_sum

MAX_BITS = 512
"""Of a result's component, and of the denominators.

The widest published table, filtered-rate with n = p = 16, needs 395 bits for 32-bit counts and
M = 4096.  What is wider comes of a slip in a user's table; its core would take minutes and
gigabytes to make and fit no device, and beyond 1023 bits the host's floats could not hold its
results.
"""


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
    coning_third: Interval | None = None
    """Over `Composition.third`; like the next three, None where the order is lower."""
    sculling_third: Interval | None = None
    coning_fourth: Interval | None = None
    """Over `Composition.fourth`."""
    sculling_fourth: Interval | None = None
    higher: HigherOrderWords | None = None
    """What the terms of higher order are formed from."""


@lru_cache(maxsize=1024)
def word_lengths(
    gyro_bits: int,
    accel_bits: int,
    minors: int,
    table: TapTable,
    high_resolution: bool = False,
    order: int = 2,
) -> WordLengths:
    """Worst-case ranges of a design.

    Every interval below contains 0, because counts take both signs, so the partial sums on the way
    to each total stay inside the total's interval: an accumulator as wide as its total is enough.

    Args:
        gyro_bits, accel_bits: widths of the counts, two's complement.
        minors: M, minor intervals in a major interval.
        table: the tap table.
        high_resolution: whether the design has s_alpha, s_nu and scrolling.
        order: 2, 3 or 4, that of the rotation vector and of velocity.
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
    if order > 2:
        words = _with_higher_order(words, minors, table, order)
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


def _with_higher_order(words: WordLengths, minors: int, table: TapTable, order: int) -> WordLengths:
    """The same with what the terms of third and fourth order add."""
    coning = sculling = ZERO_RANGE
    for row in table.taps:
        a, b = _weighted(words.gyro, row), _weighted(words.accel, row)
        coning += cross_range(a, words.gyro)
        sculling += cross_range(a, words.accel) + cross_range(b, words.gyro)
    kappa = DualRange(coning, sculling)
    higher = higher_order_words(words.gyro, words.accel, kappa, minors, table, order)
    words = replace(
        words,
        coning_third=higher.third.angle,
        sculling_third=higher.third.velocity,
        higher=higher,
    )
    if order == 3:
        return words
    return replace(words, coning_fourth=higher.fourth.angle, sculling_fourth=higher.fourth.velocity)
