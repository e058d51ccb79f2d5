"""Rows of text to numbers, in one strict pass: whole numbers, wide ones, decimals.

Plain Python on arrays of bytes, made to be compiled (`sculler.formats.compiled`).  Plain means: an
optional minus and digits, of decimals also a point with digits after it and an exponent; commas
between and a line feed after each row, and nothing else.  Whatever is not plain is refused with a
-1, and read again by those who can say what is wrong with it, or that nothing is.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sculler.formats.compiled.decimals import Words, high_product, nearest

Bytes = NDArray[np.uint8]
Whole = NDArray[np.int64]
Floats = NDArray[np.float64]

FAULT, TIME, SEQUENCE = 6, 7, 8
"""What a column of a log is, the counts being 0 to 5."""

_MOST_DIGITS = 19  # 10**19 < 2**64
_GREATEST = np.uint64(2**63 - 1)
_LIMB_DIGITS = 18  # taken together in a wide number
_EXPONENT_DIGITS = 4
_TEN = np.uint64(10)


def scan_log(
    text: Bytes,
    kinds: Whole,
    limits: Whole,
    powers: Words,
    bits: Words,
    counts: Whole,
    faults: Bytes,
    sequence: Whole,
) -> int:
    """The rows of a log.

    Args:
        text: whole lines.
        kinds: (C,) what each column is: the place of its count, `FAULT`, `TIME` or `SEQUENCE`.
        limits: (9, 2) least and greatest whole number of each kind.
        powers: of `decimals.lower_powers`.
        bits, counts, faults, sequence: filled; the first holds the times.

    Returns:
        The number of rows; -1 if the text is not plain, or a number beyond its limits.
    """
    at, row, end, last = 0, 0, len(text), len(kinds) - 1
    while at < end:
        for column in range(last + 1):
            if at >= end:
                return -1
            kind = kinds[column]
            if kind == TIME:
                bits[row], at = scan_decimal(text, at, powers)
                if at < 0:
                    return -1
            else:
                value, at = scan_word(text, at)
                if at < 0 or value < limits[kind, 0] or value > limits[kind, 1]:
                    return -1
                if kind < FAULT:
                    counts[row, kind] = value
                elif kind == FAULT:
                    faults[row] = value
                else:
                    sequence[row] = value
            if text[at] != (44 if column < last else 10):
                return -1
            at += 1
        row += 1
    return row


def scan_word(text: Bytes, at: int) -> tuple[Any, Any]:
    """A whole number of up to 64 bits at a place, and the place after it; -1 for no such."""
    negative = text[at] == 45
    begin = np.uint64(at) + np.uint64(negative)
    place, value = begin, np.uint64(0)  # unsigned: an index is taken as it is
    while True:
        figure = np.uint8(text[place] - np.uint8(48))
        if figure > 9:
            break
        value = value * _TEN + np.uint64(figure)
        place += np.uint64(1)
    digits = place - begin
    if digits < np.uint64(1) or digits > np.uint64(_MOST_DIGITS) or value > _GREATEST:
        return np.int64(0), -1
    return -np.int64(value) if negative else np.int64(value), np.int64(place)


def scan_decimal(text: Bytes, at: int, powers: Words) -> tuple[Any, int]:
    """A decimal at a place, ended by what is no part of it: the bits of its float, and the end.

    The end is -1 if it is not plain, has more than 19 digits, or no float can be told so.
    """
    sign = np.uint64(0)
    if text[at] == 45:
        sign = np.uint64(1) << np.uint64(63)
        at += 1
    value, begin, point = np.uint64(0), at, 0
    zeros = 0  # leading ones
    while True:
        figure = np.uint8(text[at] - np.uint8(48))
        if figure > 9:
            if text[at] != 46 or point > 0 or at == begin:
                break
            point = at + 1
        else:
            if value == 0 and figure == 0:
                zeros += 1
            value = value * _TEN + np.uint64(figure)
        at += 1
    digits = at - begin - (1 if point > 0 else 0)
    if digits < 1 or digits - zeros > _MOST_DIGITS or at == point:
        return np.uint64(0), -1
    exponent = np.int64(point - at if point > 0 else 0)
    if text[at] == 101:
        at += 1
        negative = text[at] == 45
        if negative or text[at] == 43:
            at += 1
        begin, power = at, np.int64(0)
        while True:
            figure = np.uint8(text[at] - np.uint8(48))
            if figure > 9 or at - begin > _EXPONENT_DIGITS:
                break
            power = power * 10 + np.int64(figure)
            at += 1
        if not 1 <= at - begin <= _EXPONENT_DIGITS:
            return np.uint64(0), -1
        exponent = exponent - power if negative else exponent + power
    if value == 0:
        return sign, at
    found = nearest(value, exponent, powers)
    return found | sign, at if found != 0 else -1


def scan_rows(
    text: Bytes,
    timed: bool,
    powers: Words,
    whole: Whole,
    limbs: NDArray[np.uint64],
    bits: Words,
) -> int:
    """Rows of whole numbers of 64 bits, then of wide ones, and of a decimal if `timed`.

    Args:
        text: whole lines.
        timed: whether a decimal ends each.
        powers: of `decimals.lower_powers`.
        whole: (R, C), filled.
        limbs: (R, D, W), filled in two's complement, lowest first; what is wider is refused.
        bits: (R,) of the decimals' floats, filled if `timed`.

    Returns:
        The number of rows; -1 if the text is not plain.
    """
    at, row, end = 0, 0, len(text)
    narrow, columns = whole.shape[1], whole.shape[1] + limbs.shape[1]
    while at < end:
        for column in range(columns):
            if at >= end:
                return -1
            if column < narrow:
                whole[row, column], at = scan_word(text, at)
            else:
                at = _scan_limbs(text, at, limbs[row, column - narrow])
            if at < 0 or text[at] != (44 if timed or column < columns - 1 else 10):
                return -1
            at += 1
        if timed:
            at = _scan_last(text, at, powers, row, bits)
            if at < 0:
                return -1
        row += 1
    return row


def _scan_last(text: Bytes, at: int, powers: Words, row: int, bits: Words) -> int:
    """The decimal that ends a line; the place after its end, or -1."""
    if at >= len(text):
        return -1
    bits[row], at = scan_decimal(text, at, powers)
    if at < 0 or text[at] != 10:
        return -1
    return at + 1


def longest(text: Bytes) -> int:
    """Bytes of the longest cell."""
    most, begin = 0, 0
    for at in range(len(text)):
        if text[at] == 44 or text[at] == 10:
            most = max(most, at - begin)
            begin = at + 1
    return most


def _scan_limbs(text: Bytes, at: int, limbs: NDArray[np.uint64]) -> int:
    """A wide number at a place; the place after it, or -1."""
    words = len(limbs)
    limbs[:] = 0
    negative = text[at] == 45
    if negative:
        at += 1
    begin = at
    while True:
        piece, scale, first = np.uint64(0), np.uint64(1), at
        while at - first < _LIMB_DIGITS:
            figure = np.uint8(text[at] - np.uint8(48))
            if figure > 9:
                break
            piece = piece * _TEN + np.uint64(figure)
            scale *= _TEN
            at += 1
        if at == first:
            break
        for k in range(words):
            above = high_product(limbs[k], scale)
            below = limbs[k] * scale + piece
            piece = above + np.uint64(below < piece)
            limbs[k] = below
        if piece != 0:
            return -1
    if at == begin or limbs[words - 1] >> np.uint64(63) != 0:
        return -1
    if negative:
        carry = np.uint64(1)
        for k in range(words):
            limbs[k] = ~limbs[k] + carry
            carry = np.uint64(carry != 0 and limbs[k] == 0)
    return at


def scan_numbers(
    text: Bytes,
    separator: int,
    places: Whole,
    powers: Words,
    bits: Words,
    whole: Whole,
) -> int:
    """Rows of decimals and whole numbers, perhaps with blanks around; only some columns are read.

    Args:
        text: whole lines.
        separator: between the columns.
        places: (F,) what becomes of each column: from 0 on the place of its float in the row of
            `bits`, from -2 down that of its whole number in `whole`; -1 for nothing.
        powers: of `decimals.lower_powers`.
        bits, whole: (R, C) and (R, K), filled.

    Returns:
        The number of rows; -1 if the text is not plain.
    """
    at, row, end, last = 0, 0, len(text), len(places) - 1
    while at < end:
        for column in range(last + 1):
            place = places[column]
            while at < end and text[at] == 32:
                at += 1
            if at >= end:
                return -1
            if place >= 0:
                bits[row, place], at = scan_decimal(text, at, powers)
            elif place < -1:
                whole[row, -2 - place], at = scan_word(text, at)
            else:
                while text[at] != separator and text[at] != 10:
                    at += 1
            if at < 0:
                return -1
            while text[at] == 32:
                at += 1
            if text[at] != (separator if column < last else 10):
                return -1
            at += 1
        row += 1
    return row
