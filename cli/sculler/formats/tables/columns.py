"""What binary tables of ours have in common: their columns, and whole numbers of several limbs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

Block = Mapping[str, NDArray[Any]]
"""Rows of some columns: (R,) numbers, or (R, W) int64 limbs of wide whole numbers."""

BLOCK_ROWS, _BLOCK_BYTES = 1 << 16, 3 << 20
"""Rows read at a time, at most; and bytes, about."""


def rows_together(names: Sequence[str], most: int) -> int:
    """How many rows of some columns to read at a time."""
    return max(1, min(most, _BLOCK_BYTES // (8 * max(len(names), 1))))


class Column(NamedTuple):
    """A column that is written.

    Attributes:
        name: of it.
        kind: numpy's type of its numbers: `int64`, `uint8` or `float64`.
        bits: width of whole numbers; of more than 64 they come as limbs of 64 bits, the lowest
            first, in two's complement.
    """

    name: str
    kind: str = "int64"
    bits: int = 64

    @property
    def limbs(self) -> int:
        """Limbs that such a number takes."""
        return max(1, -(-self.bits // 64))


class TableReader(Protocol):
    """An open file of named columns.

    Attributes:
        names: of all columns.
    """

    names: Sequence[str]

    @property
    def rows(self) -> int:
        """How many."""

    def blocks(self, names: Sequence[str]) -> Iterator[Block]:
        """Some columns, `BLOCK_ROWS` rows at a time."""

    def close(self) -> None:
        """Close the file."""


class TableWriter(Protocol):
    """A file of named columns that is being written."""

    def write(self, block: Block) -> None:
        """Append rows of all columns."""

    def finish(self) -> None:
        """What makes it a whole file."""

    def close(self) -> None:
        """Let go of what was opened, whole or not."""


def limbs_of(column: Column, numbers: NDArray[Any]) -> NDArray[np.int64]:
    """Whole numbers as (R, `column.limbs`) limbs.

    Args:
        column: where they go.
        numbers: (R,) int64, or (R, W) limbs.

    Raises:
        ValueError: one does not fit the column's bits.
    """
    limbs = np.asarray(numbers, np.int64)
    limbs = limbs[:, None] if limbs.ndim == 1 else limbs
    given, wanted = limbs.shape[1], column.limbs
    top = limbs[:, min(given, wanted) - 1]
    sign = top >> 63
    beyond = given >= wanted and (top >> (column.bits - 1) % 64 != sign).any()
    if beyond or (limbs[:, wanted:] != sign[:, None]).any():
        raise ValueError(f"{column.name}: a number of more than {column.bits} bits")
    if given >= wanted:
        return np.ascontiguousarray(limbs[:, :wanted])
    above = np.broadcast_to(sign[:, None], (len(limbs), wanted - given))
    return np.concatenate([limbs, above], axis=1)


def stored(column: Column, numbers: NDArray[Any]) -> NDArray[Any]:
    """Numbers as a file holds them: (R,) of the column's kind, or (R, W) limbs where it is wide.

    Raises:
        ValueError: one does not fit the column's bits.
    """
    if column.bits > 64:
        return limbs_of(column, numbers)
    if numbers.ndim == 2:
        numbers = limbs_of(column, numbers)[:, 0]
    return np.ascontiguousarray(numbers, column.kind)
