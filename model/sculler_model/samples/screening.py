"""A look through samples, compiled by Numba (the extra `fast`), that tells where to look closely.

`Plausibility` looks closely only where it says so.  The functions are plain Python.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import cache

import numpy as np
from numpy.typing import NDArray

from sculler_model import machine_code

RAILS, RUNS, SPIKES = 1, 2, 4
"""What there may be: counts at their rails, long runs that ended, lone spikes."""

_TOGETHER = 256
"""Rows turned together, so that each column lies in a row, along which a processor is quick."""


def screen(
    rows: NDArray[np.int64],
    new: int,
    begins: NDArray[np.int64],
    long: int,
    ends: NDArray[np.int64],
    spike: float,
) -> int:
    """Look at samples once.

    Args:
        rows: (N, 6) samples; those before row `new` have been looked at for rails and runs.
        new: the first of the others, not 0.
        begins: (7,) rows at which the runs of each column, and of all, began; set to the last ones.
        long: samples of a run that is looked at closely.
        ends: (2, 6) least and greatest count of each column.
        spike: a step that is no spike.

    Returns:
        The sum of `RAILS`, `RUNS` and `SPIKES`, of what there may be.
    """
    count = len(rows)
    total, largest = np.zeros(6, np.int64), np.zeros(6, np.int64)
    least, most = ends[1].copy(), ends[0].copy()
    turned = np.empty((6, _TOGETHER + 1), np.int64)
    first = 1
    while first < count:
        last = min(first + _TOGETHER, count if first >= new else new)
        for place in range(last - first + 1):
            for column in range(6):
                turned[column, place] = rows[first - 1 + place, column]
        for column in range(6):
            values = turned[column]
            low = high = values[1]
            steps = greatest = high - high
            for place in range(1, last - first + 1):
                step = abs(values[place] - values[place - 1])
                steps += step
                greatest = max(greatest, step)
                low, high = min(low, values[place]), max(high, values[place])
            total[column] += steps
            largest[column] = max(largest[column], greatest)
            if first >= new:
                least[column], most[column] = min(least[column], low), max(most[column], high)
        first = last
    found, times = 0, min(100.0, count / 8)
    for column in range(6):
        if least[column] <= ends[0, column] or most[column] >= ends[1, column]:
            found |= RAILS
        mean = total[column] / max(count - 1, 1)
        if largest[column] > times * mean and largest[column] > spike:
            found |= SPIKES
    for column in range(7):
        found |= _follow(rows, new, begins, long, column)
    return found


def _follow(
    rows: NDArray[np.int64], new: int, begins: NDArray[np.int64], long: int, column: int
) -> int:
    """Follow the runs of a column, or (6) those in which all stand still.

    Where the last row that may belong to a run, if it is not long, begins the next one, no other
    row of it is looked at.

    Returns:
        `RUNS` if a long one ended, else 0.
    """
    found, begin, last = 0, begins[column], len(rows) - 1
    while True:
        end = min(begin + long - 1, last)
        row = end
        while row > begin and row >= new and _is_as_before(rows, row, column):
            row -= 1
        if row > begin and row >= new:  # the run ended here or earlier, but it was not long
            begin = row
            continue
        row = max(end + 1, new)
        while row <= last and _is_as_before(rows, row, column):
            row += 1
        if row > last:
            begins[column] = begin
            return found
        if row - begin >= long:
            found = RUNS
        begin = row


def _is_as_before(rows: NDArray[np.int64], row: int, column: int) -> bool:
    """Whether a column, or (6) all of them, stands still from the row before to this one."""
    if column < 6:
        return bool(rows[row, column] == rows[row - 1, column])
    still = True
    for each in range(6):
        still = still and rows[row, each] == rows[row - 1, each]
    return still


def noisy(rows: NDArray[np.int64], least: float, known: NDArray[np.bool_]) -> None:
    """Mark in `known` (6,) the columns that show noise.

    Args:
        rows: (N, 6) samples.
        least: second differences up to it, by their median, are none.
        known: those marked already are passed over.
    """
    for column in range(6):
        if known[column]:
            continue
        values = rows[:, column].astype(np.float64)
        second = np.diff(np.diff(values))
        size = np.median(np.abs(second))
        if size > least and np.median(np.abs(np.diff(second))) > size:
            known[column] = True


@cache
def compiled() -> tuple[Callable[..., int], Callable[..., None]] | None:
    """`screen` and `noisy`, compiled; None where Numba is missing."""
    try:
        machine_code.callable_when_compiled(sys.modules[__name__])
        screening, noise = (machine_code.compiled(each, nogil=True) for each in (screen, noisy))
        return screening, noise
    except ImportError:
        return None
