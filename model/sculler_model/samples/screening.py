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
    found, count = 0, len(rows)
    times = min(100.0, count / 8)
    for column in range(6):
        low, high, begin = ends[0, column], ends[1, column], begins[column]
        before = rows[0, column]
        largest = total = before - before
        for row in range(count):
            value = rows[row, column]
            step = abs(value - before)
            before = value
            total += step
            largest = max(largest, step)
            if row >= new:
                if value <= low or value >= high:
                    found |= RAILS
                if step != 0:
                    if row - begin >= long:
                        found |= RUNS
                    begin = row
        begins[column] = begin
        if largest > times * (total / max(count - 1, 1)) and largest > spike:
            found |= SPIKES
    return found | _all_still(rows, new, begins, long)


def _all_still(rows: NDArray[np.int64], new: int, begins: NDArray[np.int64], long: int) -> int:
    """Follow the run in which all columns stand still; `RUNS` if a long one ended."""
    found, begin = 0, begins[6]
    for row in range(new, len(rows)):
        for column in range(6):
            if rows[row, column] != rows[row - 1, column]:
                if row - begin >= long:
                    found = RUNS
                begin = row
                break
    begins[6] = begin
    return found


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
