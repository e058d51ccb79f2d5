"""First difference of two vectors files."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path

from sculler.formats.vectors import TIME, VectorLines
from sculler_model.errors import InputError


@dataclass(frozen=True)
class Difference:
    """Where two vectors files first differ.

    Attributes:
        row: row counted from 0.
        major: the row's `major` (the first file's, where it has the row).
        column: name of the first unequal column; `major` where one file has ended.
        first, second: the two values, a float for `time_s`; None where that file has ended.

    Examples:
        >>> import numpy as np, sculler
        >>> design, counts = sculler.Design.preset("stim300"), np.ones((40, 6), int)
        >>> block = sculler.FastModel(design).feed(counts)
        >>> found = sculler.compare(block, sculler.FastModel(design).feed(counts[:20]))
        >>> isinstance(found, sculler.Difference), found.describe("this", "that")
        (True, 'that ends after 1 rows, this goes on with major 1')
    """

    row: int
    major: int
    column: str
    first: int | float | None
    second: int | float | None

    def describe(self, first: str | Path, second: str | Path) -> str:
        """One line for people, the files under the given names."""
        for value, ended, other in ((self.first, first, second), (self.second, second, first)):
            if value is None:
                return (
                    f"{ended} ends after {self.row} rows, {other} goes on with major {self.major}"
                )
        return (
            f"major {self.major} (row {self.row}), {self.column}: {self.first} in {first},"
            f" {self.second} in {second}"
        )


def compare(first: str | Path, second: str | Path) -> Difference | None:
    """First difference of two vectors files, or None where every integer is the same.

    Where both files have times these are compared too; where one has none, that is no difference.
    The files are streamed.  Rows whose text is equal are not taken apart, only checked for form.

    Raises:
        InputError: a file cannot be read, is cut short, a header or cell is wrong, or the two have
            other columns.
    """
    one, other = VectorLines(first), VectorLines(second)
    if one.columns != other.columns:
        raise InputError(
            f"{second}: {len(other.columns)} columns for {len(one.columns)} of {first}, give"
            " vectors of one design"
        )
    for row, (ours, theirs) in enumerate(zip_longest(one, other)):
        if ours is None or theirs is None:
            there, _ = one.row(*ours) if ours else other.row(*theirs)
            values = (there[0], None) if ours else (None, there[0])
            return Difference(row, there[0], "major", *values)
        if ours[1] == theirs[1]:
            one.check(*ours)
            continue
        (a, time), (b, other_time) = one.row(*ours), other.row(*theirs)
        for column, left, right in zip(one.columns, a, b, strict=True):
            if left != right:
                return Difference(row, a[0], column, left, right)
        if time is not None and other_time is not None and time != other_time:
            return Difference(row, a[0], TIME, time, other_time)
    return None
