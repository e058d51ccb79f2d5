"""Wide numbers in digits, so narrow that sums of their products stay within 64 bits."""

from __future__ import annotations

from typing import Any, TypeVar

from numpy.typing import NDArray

from sculler_model.design import Interval

Number = TypeVar("Number", int, NDArray[Any])


def split_digits(x: Number, bits: int, count: int) -> list[Number]:
    """x in digits of `bits`, lowest first.  The highest keeps x's sign, the others are >= 0."""
    digits: list[Number] = []
    for _ in range(count - 1):
        digits.append(x & ((1 << bits) - 1))
        x = x >> bits
    digits.append(x)
    return digits


def digit_count(interval: Interval, bits: int) -> int:
    """How many digits of `bits` hold the interval."""
    return max(-(-(interval.bits - 1) // bits), 1)
