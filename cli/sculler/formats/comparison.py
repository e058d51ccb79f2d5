"""First difference of two vectors files."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sculler.formats.vectors import CHANNEL, TIME, open_vectors
from sculler_model.errors import InputError
from sculler_model.fast import Integers, VectorBlock, as_integers, limbs_of


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

    Each may be of any kind.  Where both have times these are compared too; where one has none, that
    is no difference.  The files are streamed.

    Raises:
        InputError: a file cannot be read, is cut short, a header or cell is wrong, or the two have
            other columns.
    """
    with open_vectors(first) as one, open_vectors(second) as other:
        if one.columns != other.columns:
            raise InputError(
                f"{second}: {len(other.columns)} columns for {len(one.columns)} of {first}, give"
                " vectors of one design"
            )
        if one.channels != other.channels:
            named, bare = (first, second) if one.channels else (second, first)
            raise InputError(
                f"{bare}: no column {CHANNEL}, which {named} has, give vectors of one design"
            )
        row = 0
        for ours, theirs in _together(one.blocks(), other.blocks()):
            found = difference(ours, theirs, row)
            if found is not None:
                return found
            row += len(ours)
    return None


def _together(
    one: Iterator[VectorBlock], other: Iterator[VectorBlock]
) -> Iterator[tuple[VectorBlock, VectorBlock]]:
    """Blocks of the same rows of two files; of unlike lengths only where one file has ended."""
    ours, theirs = next(one, None), next(other, None)
    while ours is not None and theirs is not None:
        rows = min(len(ours), len(theirs))
        yield ours[:rows], theirs[:rows]
        ours = ours[rows:] if rows < len(ours) else next(one, None)
        theirs = theirs[rows:] if rows < len(theirs) else next(other, None)
    there = ours or theirs
    if there is not None:
        nothing = there[:0]
        yield (nothing, there) if ours is None else (there, nothing)


def difference(one: VectorBlock, other: VectorBlock, first: int = 0) -> Difference | None:
    """First difference of two blocks of the same columns; `first` is the number of their row."""
    rows = min(len(one), len(other))
    ours, theirs = one[:rows], other[:rows]
    a, b = _same_limbs(ours.components, theirs.components)
    unequal = [ours.major != theirs.major, ours.status != theirs.status]
    unequal += list((a != b).any(axis=2).T)
    names = list(one.columns)
    if ours.channels is not None and theirs.channels is not None:
        unequal.append(ours.channels != theirs.channels)
        names.append(CHANNEL)
    if ours.times is not None and theirs.times is not None:
        unequal.append(ours.times != theirs.times)
        names.append(TIME)
    some = np.logical_or.reduce(unequal)
    if some.any():
        row = int(np.argmax(some))
        column = next(place for place, each in enumerate(unequal) if each[row])
        left, right = (_cell(block, row, names[column]) for block in (ours, theirs))
        return Difference(first + row, int(ours.major[row]), names[column], left, right)
    if len(one) == len(other):
        return None
    longer = one if len(one) > rows else other
    major = int(longer.major[rows])
    values = (major, None) if longer is one else (None, major)
    return Difference(first + rows, major, "major", *values)


def _same_limbs(one: Integers, other: Integers) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The limbs of both, as many of each."""
    words = max(limbs_of(one).shape[-1], limbs_of(other).shape[-1])
    return limbs_of(as_integers(one, words)), limbs_of(as_integers(other, words))


def _cell(block: VectorBlock, row: int, column: str) -> int | float:
    """A value of a block, by the name of its column."""
    if column == TIME:
        assert block.times is not None
        return float(block.times[row])
    if column == CHANNEL:
        assert block.channels is not None
        return int(block.channels[row])
    return next(block[row : row + 1].rows())[block.columns.index(column)]
