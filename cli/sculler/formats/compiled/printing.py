"""Rows of numbers as text, at machine speed: the very bytes that Python's `%d` and `repr` write.

Plain Python on arrays of bytes, made to be compiled (`sculler.formats.compiled`).  A function that
puts something into `out` at a place returns the place after it.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sculler.formats.compiled.decimals import Words, shortest

Bytes = NDArray[np.uint8]
Whole = NDArray[np.int64]
Floats = NDArray[np.float64]

NO_LIMBS: Whole = np.empty((0, 0, 1), np.int64)
"""Of rows without wide numbers."""

WHOLE_BYTES, FLOAT_BYTES = 21, 26
"""Most bytes that a whole number of 64 bits and a float take, the separator after it too."""

_TEN, _HUNDRED, _THOUSAND, _MYRIAD = (np.uint64(10**k) for k in (1, 2, 3, 4))
_PAIRS = np.frombuffer("".join(f"{pair:02}" for pair in range(100)).encode(), np.uint8)
_NINE_DIGITS = np.uint64(10**9)  # nine nanosecond digits too
_LOW, _HALF = np.uint64(0xFFFFFFFF), np.uint64(32)


def digits_of(value: Any) -> int:
    """How many decimal digits a word of 64 bits has."""
    count = 1
    while value >= _MYRIAD:
        value = value // _MYRIAD
        count += 4
    if value >= _TEN:
        count += 1
    if value >= _HUNDRED:
        count += 1
    if value >= _THOUSAND:
        count += 1
    return count


def put_digits(out: Bytes, at: int, value: Any, count: int) -> int:
    """A word of 64 bits in so many digits."""
    end = at + count
    place = end
    while place > at + 1:
        rest = value // _HUNDRED
        pair = 2 * np.int64(value - rest * _HUNDRED)
        place -= 2
        out[place], out[place + 1] = _PAIRS[pair], _PAIRS[pair + 1]
        value = rest
    if place > at:
        out[at] = np.uint8(48) + np.uint8(value)
    return end


def put_whole(out: Bytes, at: int, value: Any) -> int:
    """A whole number of 64 bits."""
    magnitude = np.uint64(value)
    if value < 0:
        out[at] = 45
        at += 1
        magnitude = ~magnitude + np.uint64(1)
    return put_digits(out, at, magnitude, digits_of(magnitude))


def put_wide(out: Bytes, at: int, limbs: Any, figures: Any) -> int:
    """A whole number of several words of 64 bits, lowest first, in two's complement.

    `figures` is room for (2 W + 1, 2) words: halves of the magnitude, and its digits nine by nine.
    """
    words = len(limbs)
    negative = limbs[words - 1] < 0
    carry = np.uint64(1)
    for k in range(words):
        word = np.uint64(limbs[k])
        if negative:
            word = ~word + carry
            carry = np.uint64(carry != 0 and word == 0)
        figures[2 * k, 0] = word & _LOW
        figures[2 * k + 1, 0] = word >> _HALF
    if negative:
        out[at] = 45
        at += 1
    left, nines = 2 * words, 0
    while left > 0 and figures[left - 1, 0] == 0:
        left -= 1
    while left > 0:
        rest = np.uint64(0)
        for k in range(left - 1, -1, -1):
            rest = (rest << _HALF) | figures[k, 0]
            share = rest // _NINE_DIGITS
            figures[k, 0] = share
            rest -= share * _NINE_DIGITS
        figures[nines, 1] = rest
        nines += 1
        if figures[left - 1, 0] == 0:
            left -= 1
    if nines == 0:
        figures[0, 1], nines = np.uint64(0), 1
    at = put_digits(out, at, figures[nines - 1, 1], digits_of(figures[nines - 1, 1]))
    for k in range(nines - 2, -1, -1):
        at = put_digits(out, at, figures[k, 1], 9)
    return at


def put_float(out: Bytes, at: int, value: Any, bits: Any, powers: Words) -> int:
    """A float as `repr` shows it; -1 for one that is not finite.

    Args:
        out, at: where.
        value, bits: of the float.
        powers: of `decimals.upper_powers`.
    """
    if not abs(value) <= 1.7976931348623157e308:
        return -1
    if bits >> np.uint64(63):
        out[at] = 45
        at += 1
    if value == 0.0:
        out[at], out[at + 1], out[at + 2] = 48, 46, 48
        return at + 3
    figures, k = shortest(bits & np.uint64((1 << 63) - 1), powers)
    while True:
        tenth = figures // _TEN
        if tenth * _TEN != figures:
            break
        figures = tenth
        k += 1
    count = digits_of(figures)
    point = count + k  # digits before the point
    if not -4 < point <= 16:
        return _put_scientific(out, at, figures, count, point - 1)
    if point <= 0:  # 0.000ddd
        out[at], out[at + 1] = 48, 46
        for place in range(-point):
            out[at + 2 + place] = 48
        return put_digits(out, at + 2 - point, figures, count)
    if point >= count:  # ddd000.0
        at = put_digits(out, at, figures, count)
        for place in range(point - count):
            out[at + place] = 48
        at += point - count
        out[at], out[at + 1] = 46, 48
        return at + 2
    put_digits(out, at + 1, figures, count)
    for place in range(point):
        out[at + place] = out[at + place + 1]
    out[at + point] = 46
    return at + count + 1


def _put_scientific(out: Bytes, at: int, figures: Any, count: int, exponent: int) -> int:
    put_digits(out, at + 1, figures, count)
    out[at] = out[at + 1]
    if count > 1:
        out[at + 1] = 46
        at += count
    out[at + 1] = 101
    out[at + 2] = 45 if exponent < 0 else 43
    size = np.uint64(abs(exponent))
    return put_digits(out, at + 3, size, max(2, digits_of(size)))


def print_rows(whole: Whole, limbs: Whole, times: Floats, powers: Words, out: Bytes) -> int:
    """Rows of whole numbers.

    Args:
        whole: (R, C) of 64 bits.
        limbs: (R, D, W) of W words, after them; D may be 0.
        times: a float in the end of each row, where it has some.
        powers: of `decimals.upper_powers`.
        out: room for the text.

    Returns:
        The bytes written; -1 if a time is not finite.
    """
    at, bits = 0, times.view(np.uint64)
    figures = np.zeros((5 * limbs.shape[2] + 1, 2), np.uint64)
    for row in range(len(whole)):
        for column in range(whole.shape[1]):
            at = put_whole(out, at, whole[row, column])
            out[at] = 44
            at += 1
        for column in range(limbs.shape[1]):
            at = put_wide(out, at, limbs[row, column], figures)
            out[at] = 44
            at += 1
        if len(times):
            at = put_float(out, at, times[row], bits[row], powers)
            if at < 0:
                return -1
            at += 1
        out[at - 1] = 10
    return at


def print_stamped(whole: Whole, nanoseconds: Whole, out: Bytes) -> int:
    """Rows of whole numbers (R, C), and (R,) nanoseconds, not negative, as seconds."""
    at = 0
    for row in range(len(whole)):
        for column in range(whole.shape[1]):
            at = put_whole(out, at, whole[row, column])
            out[at] = 44
            at += 1
        size = np.uint64(nanoseconds[row])
        seconds = size // _NINE_DIGITS
        at = put_digits(out, at, seconds, digits_of(seconds))
        out[at] = 46
        at = put_digits(out, at + 1, size - seconds * _NINE_DIGITS, 9)
        while out[at - 1] == 48 and out[at - 2] != 46:
            at -= 1
        out[at] = 10
        at += 1
    return at


def print_floats(table: Floats, powers: Words, out: Bytes) -> int:
    """Rows of floats (R, C); -1 if one is not finite."""
    at, bits = 0, table.view(np.uint64)
    for row in range(table.shape[0]):
        for column in range(table.shape[1]):
            at = put_float(out, at, table[row, column], bits[row, column], powers)
            if at < 0:
                return -1
            out[at] = 44
            at += 1
        out[at - 1] = 10
    return at
