"""Lines of plain numbers to arrays, vectorised and strict: the fast path of the log reader.

Plain means: whole numbers with an optional minus, in one column also decimals, with commas between
and nothing else.  Every byte is accounted for: it is a digit, a separator where the layout wants
that separator, a minus at the head of a number, or the one point of a decimal.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

_ZERO, _MINUS, _POINT = np.uint8(ord("0")), np.uint8(ord("-")), np.uint8(ord("."))
_WHOLE_DIGITS = 10  # a 32-bit count has no more
_COUNTER_DIGITS = 18  # of a column of 64-bit numbers; 10**18 fits them
_EXACT_DIGITS = 15  # 10**15 < 2**53: such whole numbers are exact as floats


class Rows(NamedTuple):
    """Values of consecutive lines.

    `whole` is (N, fields), 0 in the decimal column.  `decimals` is (N,), the floats nearest to that
    column's text; None where no column is decimal.
    """

    whole: NDArray[np.int64]
    decimals: NDArray[np.float64] | None


def parse(block: bytes, fields: int, decimal: int | None = None, long: bool = False) -> Rows | None:
    """The values of a block of whole lines, or None if anything else is in it.

    Args:
        block: lines with their ends, line feeds.
        fields: numbers in a line.
        decimal: the column that may have a point, from 0; None if there is none.
        long: whole numbers may have 18 digits, else 10.
    """
    text = np.frombuffer(block, np.uint8)
    ends = np.flatnonzero(text < _MINUS)  # commas and line ends; spaces and + fail the next check
    layout = np.frombuffer(b"," * (fields - 1) + b"\n", np.uint8)
    if len(ends) % fields or (text[ends].reshape(-1, fields) != layout).any():
        return None
    starts = np.empty_like(ends)
    starts[0] = 0
    np.add(ends[:-1], 1, out=starts[1:])
    negative = text[starts] == _MINUS
    digits = ends - starts - negative
    figure = text - _ZERO  # wraps for all that is no digit, so those are > 9
    known = np.count_nonzero(figure < 10) + len(ends) + np.count_nonzero(negative)
    cells = slice(decimal, None, fields)
    points = np.zeros(0, np.int64)
    if decimal is not None:
        points = np.flatnonzero(text == _POINT)
        digits[cells] = 1  # no matter what: the column's whole number becomes 0
    longest = int(digits.max())
    if digits.min() < 1 or longest > (_COUNTER_DIGITS if long else _WHOLE_DIGITS):
        return None
    if known + len(points) != len(text):
        return None
    decimals = None
    if decimal is not None:
        head = starts[cells] + negative[cells]
        decimals = _decimals(block, figure, points, head, ends[cells])
        if decimals is None:
            return None
        np.negative(decimals, out=decimals, where=negative[cells])
    values = _whole(figure, ends, digits, longest)
    np.negative(values, out=values, where=negative)
    values = values.reshape(-1, fields)
    if decimal is not None:
        values[:, decimal] = 0
    return Rows(values, decimals)


def _whole(
    figure: NDArray[np.uint8], ends: NDArray[np.int64], digits: NDArray[np.int64], longest: int
) -> NDArray[np.int64]:
    """The numbers whose last digits stand before `ends`, of up to `longest` digits."""
    values = np.zeros(len(ends), np.int64)
    at = ends
    for place in range(longest):
        at = at - 1
        digit = figure.take(at, mode="clip") * (digits > place)
        # the product in 64 bits: before numpy 2 an array of bytes times a scalar stays in bytes
        values += np.multiply(digit, np.int64(10**place), dtype=np.int64)
    return values


def _decimals(
    block: bytes,
    figure: NDArray[np.uint8],
    points: NDArray[np.int64],
    starts: NDArray[np.int64],
    ends: NDArray[np.int64],
) -> NDArray[np.float64] | None:
    """The floats nearest to the decimals from `starts` to `ends`, without their signs.

    A decimal w.f with k digits after the point is w + f/10**k.  Where all its digits together are
    an exact float, their division by 10**k rounds once, and so to the nearest.  Else w is exact,
    f/10**k is off by half a unit of its own last place, and the sum's rounding error is known
    exactly; only where that error is as near to half a unit as f/10**k is unsure could the nearest
    be the neighbour, and those few are left to Python, as are those of more digits.

    Returns:
        (N,); None if a cell is no such decimal.
    """
    row = np.searchsorted(ends, points)
    if len(row) and (row[-1] >= len(ends) or (np.diff(row) <= 0).any()):
        return None
    point = ends.copy()
    point[row] = points
    whole_digits, places = point - starts, np.maximum(ends - point - 1, 0)
    if whole_digits.min() < 1 or whole_digits.max() > _EXACT_DIGITS:
        return None
    figured = np.minimum(places, _EXACT_DIGITS)
    whole = _whole(figure, point, whole_digits, int(whole_digits.max()))
    fraction = _whole(figure, ends, figured, int(figured.max()))
    scale = np.power(10.0, figured)  # exact up to 10**22

    together = whole < np.floor(2.0**53 / scale) - 1
    joined = np.where(together, whole, 0) * scale.astype(np.int64) + fraction
    large, small = whole.astype(np.float64), fraction / scale
    total = large + small
    error = np.abs(small - (total - large))
    half = 0.5 * np.spacing(total)  # below a power of two the spacing is half of that above it
    unsure = np.minimum(np.abs(error - half), np.abs(error - 0.5 * half)) <= np.spacing(small)
    values: NDArray[np.float64] = np.where(together, joined / scale, total)
    for at in np.flatnonzero((unsure & ~together) | (places > _EXACT_DIGITS)).tolist():
        values[at] = float(block[starts[at] : ends[at]])
    return values
