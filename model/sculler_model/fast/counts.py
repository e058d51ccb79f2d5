"""Arrays of counts as they are given: their form, their rows behind those kept, their extremes."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sculler_model.errors import InputError
from sculler_model.fast.arithmetic import Counts

ROW = 256
"""Samples side by side where extremes are sought: numpy is quick along long rows."""


class Rows:
    """Rows of counts, those that were kept first."""

    def __init__(self, kept: NDArray[np.int64], counts: Counts) -> None:
        self.kept, self.counts = kept, counts

    def __len__(self) -> int:
        return len(self.kept) + len(self.counts)

    def __getitem__(self, part: slice) -> Counts:
        """Rows start..stop-1, both told; a view where none of them was kept."""
        first, last = (max(edge - len(self.kept), 0) for edge in (part.start, part.stop))
        new = self.counts[first:last]
        if part.start >= len(self.kept):
            return new
        return np.concatenate([self.kept[part], new], dtype=np.int64)


def column_extremes(counts: Counts, extreme: np.ufunc) -> list[int]:
    """Least or greatest count of each column; there must be a sample."""
    whole = len(counts) // ROW * ROW
    rows = counts[:whole].reshape(-1, ROW * 6)
    parts = [counts[whole:], *([extreme.reduce(rows).reshape(ROW, 6)] if whole else [])]
    columns: list[int] = extreme.reduce(np.concatenate(parts)).tolist()
    return columns


def as_counts(counts: ArrayLike) -> Counts:
    """The counts as an array (N, 6) of integers.

    Raises:
        InputError: they are none.
    """
    array = np.asarray(counts)
    if array.ndim != 2 or array.shape[1] != 6 or array.dtype.kind not in "iu":
        raise InputError(
            f"counts: an array of shape {array.shape} and type {array.dtype} is not allowed,"
            " give integers of shape (N, 6)"
        )
    return array


def as_faults(faults: ArrayLike | None, samples: int, name: str = "faults") -> NDArray[Any]:
    """The samples' faults, or other marks, as an array (N,); of length 0 where there are none.

    Raises:
        InputError: there are not so many, or they are no integers.
    """
    if faults is None:
        return np.zeros(0, np.bool_)
    array = np.asarray(faults)
    if array.shape != (samples,) or array.dtype.kind not in "iub":
        raise InputError(
            f"{name}: an array of shape {array.shape} and type {array.dtype} is not allowed,"
            f" give {samples} integers or booleans, one per sample"
        )
    return array
