"""Floats to the shortest decimals that are read as them again, and decimals to the nearest floats.

Both are exact: the digits are those of Python's `repr`, the floats those of Python's `float`.  The
functions are plain Python on 64-bit words, made to be compiled (`sculler.formats.compiled`).

Sources: R. Giulietti, "The Schubfach way to render doubles" (2020), in the form of A. Neumann's
Drachennest; D. Lemire, "Number parsing at a gigabyte per second" (2021).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Words = NDArray[np.uint64]

MOST = 345
"""The largest exponent of ten, either way, that the tables of powers hold."""

_LOW = np.uint64(0xFFFFFFFF)
_HALF = np.uint64(32)
_HIDDEN = np.uint64(1 << 52)
_MANTISSA = np.uint64((1 << 52) - 1)


def upper_powers() -> Words:
    """10^k for k from -`MOST` to `MOST`, (2 `MOST` + 1, 2): the first 128 bits, rounded up."""
    return _words(lambda k: _leading_bits(k, up=True))


def lower_powers() -> Words:
    """The same rounded down, but for k from -27 to -1."""
    return _words(lambda k: _leading_bits(k, up=-27 <= k < 0))


def _words(bits: Any) -> Words:
    low = (1 << 64) - 1
    return np.array(
        [(word >> 64, word & low) for word in map(bits, range(-MOST, MOST + 1))], np.uint64
    )


def _leading_bits(k: int, up: bool) -> int:
    """The first 128 bits of 10^k, the highest of them 1."""
    above, below = (10**k, 1) if k >= 0 else (1, 10**-k)
    shift = 128 - above.bit_length() if k >= 0 else 127 + below.bit_length()
    above, below = (above << shift, below) if shift >= 0 else (above, below << -shift)
    return -(-above // below) if up else above // below


def high_product(a: Any, b: Any) -> Any:
    """The high 64 bits of the product of two words of 64 bits."""
    a_low, a_high, b_low, b_high = a & _LOW, a >> _HALF, b & _LOW, b >> _HALF
    first, second = a_high * b_low, a_low * b_high
    carry = ((a_low * b_low) >> _HALF) + (first & _LOW) + (second & _LOW)
    return a_high * b_high + (first >> _HALF) + (second >> _HALF) + (carry >> _HALF)


def _rounded_to_odd(high: Any, low: Any, factor: Any) -> Any:
    """The product of 128 and 64 bits over 2^128, its last bit 1 where the rest is not nothing."""
    below = high_product(low, factor)
    middle = high * factor + below
    above = high_product(high, factor)
    if middle < below:
        above += np.uint64(1)
    return above | np.uint64(middle > np.uint64(1))


def shortest(bits: Any, powers: Words) -> tuple[Any, Any]:
    """The shortest decimal d·10^k that is read as a float again, the nearest to it of these.

    Args:
        bits: of the float, finite, not 0, without its sign.
        powers: of `upper_powers`.

    Returns:
        d (uint64) and k.
    """
    fraction, exponent = bits & _MANTISSA, np.int64(bits >> np.uint64(52))
    c, q = fraction, np.int64(-1074)
    if exponent != 0:
        c, q = fraction | _HIDDEN, exponent - 1075
        if -53 < q <= 0 and (c >> np.uint64(-q)) << np.uint64(-q) == c:  # a whole number
            return c >> np.uint64(-q), np.int64(0)
    odd = c & np.uint64(1)
    closer = fraction == 0 and exponent > 1  # a power of two: the float below is nearer
    k = (q * 1262611 - (524031 if closer else 0)) >> 22
    h = np.uint64(q + ((-k * 1741647) >> 19) + 1)
    high, low = powers[MOST - k, 0], powers[MOST - k, 1]
    four = c << np.uint64(2)
    lower = _rounded_to_odd(high, low, (four - np.uint64(1 if closer else 2)) << h) + odd
    value = _rounded_to_odd(high, low, four << h)
    upper = _rounded_to_odd(high, low, (four + np.uint64(2)) << h) - odd
    s = value >> np.uint64(2)
    if s >= np.uint64(10):
        tens = s // np.uint64(10)
        forty = np.uint64(40) * tens
        down, up = lower <= forty, forty + np.uint64(40) <= upper
        if down != up:
            return tens + np.uint64(up), k + 1
    down, up = lower <= s << np.uint64(2), (s << np.uint64(2)) + np.uint64(4) <= upper
    if down != up:
        return s + np.uint64(up), k
    middle = (s << np.uint64(2)) + np.uint64(2)
    return s + np.uint64(value > middle or (value == middle and (s & np.uint64(1)) != 0)), k


def nearest(digits: Any, k: Any, powers: Words) -> Any:
    """The bits of the float nearest to digits·10^k.

    Args:
        digits: uint64, not 0.
        k: the exponent.
        powers: of `lower_powers`.

    Returns:
        uint64; 0 where it cannot be told so, or the float is no normal one.
    """
    if k < -MOST + 3 or k > 308:
        return np.uint64(0)
    zeros = 0
    for step in (32, 16, 8, 4, 2, 1):
        if digits >> np.uint64(64 - step) == 0:
            digits = digits << np.uint64(step)
            zeros += step
    high_power, low_power = powers[MOST + k, 0], powers[MOST + k, 1]
    high, low = high_product(digits, high_power), digits * high_power
    if high & np.uint64(0x1FF) == np.uint64(0x1FF):
        below = high_product(digits, low_power)
        low += below
        if below > low:
            high += np.uint64(1)
    upper = high >> np.uint64(63)
    shift = upper + np.uint64(9)
    mantissa = high >> shift
    exponent = ((217706 * k) >> 16) + 63 + np.int64(upper) - zeros + 1023
    if exponent <= 0 or exponent >= 2046:
        return np.uint64(0)
    halfway = low <= np.uint64(1) and -4 <= k <= 23 and mantissa & np.uint64(3) == np.uint64(1)
    if halfway and mantissa << shift == high:
        mantissa -= np.uint64(1)
    mantissa = (mantissa + (mantissa & np.uint64(1))) >> np.uint64(1)
    if mantissa >= _HIDDEN << np.uint64(1):
        mantissa = _HIDDEN
        exponent += 1
    return (np.uint64(exponent) << np.uint64(52)) | (mantissa & _MANTISSA)
