"""Vectors as `.npz` and `.parquet`: the columns of the CSV, exact integers of any width."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sculler.formats.tables import Block, Column, open_table, seconds, whole, writing_table
from sculler.formats.vectors_text import CHANNEL, TIME, trimmed
from sculler_model.design import COLUMNS, EVERY_COLUMNS, Design
from sculler_model.errors import InputError
from sculler_model.fast import VectorBlock, limbs_of

_TOGETHER = 1 << 14  # rows written together


class TableVectors(AbstractContextManager["TableVectors"]):
    """A binary vectors file to read; a context with the attributes of `TextVectors`.

    Raises:
        InputError: the file cannot be read, or a column is missing or unknown.
    """

    unit, first = "row", 1

    def __init__(self, path: str | Path) -> None:
        self.path = path
        with ExitStack() as stack:
            self._table = stack.enter_context(open_table(path, "vectors file"))
            names = list(self._table.names)
            self.times, self.channels = TIME in names, CHANNEL in names
            further = [each for each in EVERY_COLUMNS[1:] if set(each[len(COLUMNS) :]) & {*names}]
            whole_there = [each for each in further if {*each} <= {*names}]
            self.columns = [COLUMNS, *further[:1], *whole_there][-1]
            self._require(names)
            self._stack = stack.pop_all()

    def __exit__(self, *error: object) -> None:
        self._stack.close()

    def _require(self, names: Sequence[str]) -> None:
        for name in self.columns:
            if name not in names:
                raise InputError(f"{self.path}: column {name} is missing; is this a vectors file?")
        for name in names:
            if name not in (*self.columns, CHANNEL, TIME):
                raise InputError(
                    f"{self.path}: unknown column {name[:40]!r}, a vectors file has"
                    f" {','.join(COLUMNS)[:26]}..."
                )
            if names.count(name) > 1:
                raise InputError(f"{self.path}: column {name} is there twice, drop one")

    def blocks(self) -> Iterator[VectorBlock]:
        """All rows; whether they follow each other and fit a design is another matter.

        Raises:
            InputError: a column holds other numbers, or the file is damaged.
        """
        first = self.first
        names = [*self.columns, *[CHANNEL] * self.channels, *[TIME] * self.times]
        for block in self._table.blocks(names):
            major, status = (
                whole(self.path, name, block[name], first) for name in self.columns[:2]
            )
            times = seconds(self.path, TIME, block[TIME], first) if self.times else None
            channels = None
            if self.channels:
                channels = whole(self.path, CHANNEL, block[CHANNEL], first)
            yield VectorBlock(major, status, self._components(block, first), times, channels)
            first += len(major)

    def _components(self, block: Block, first: int) -> Any:
        """The integers of the components, in as few limbs as they need."""
        columns = [self._limbs(name, block[name], first) for name in self.columns[2:]]
        words = max(column.shape[1] for column in columns)
        limbs = np.empty((len(columns[0]), len(columns), words), np.int64)
        for place, column in enumerate(columns):
            given = column.shape[1]
            limbs[:, place, :given] = column
            limbs[:, place, given:] = (column[:, -1] >> 63)[:, None]
        return trimmed(limbs)

    def _limbs(self, name: str, numbers: NDArray[Any], first: int) -> NDArray[np.int64]:
        if numbers.ndim == 1:
            return whole(self.path, name, numbers, first)[:, None]
        if numbers.dtype != np.int64 or not numbers.shape[1]:
            raise InputError(f"{self.path}: {name} has limbs of type {numbers.dtype}, give int64")
        return numbers


class TableVectorsWriter:
    """Writes a binary vectors file; see `vectors.VectorsWriter`.

    A column is as wide as its component in the design; where none is known, as `widest`.
    """

    def __init__(
        self,
        path: Path,
        columns: Sequence[str],
        times: bool,
        channels: bool,
        design: Design | None,
        widest: int,
    ) -> None:
        made = [Column(columns[0]), Column(columns[1])]
        for name in columns[2:]:
            bits = widest if design is None else getattr(design.words, name[:-2]).bits
            made.append(Column(name, bits=max(bits, 64)))
        made += [Column(CHANNEL)] * channels + [Column(TIME, "float64")] * times
        self._columns = tuple(columns)
        self._waiting: list[VectorBlock] = []
        self._rows = 0
        self._stack = ExitStack()
        self._table = self._stack.enter_context(writing_table(path, made))

    def write(self, block: VectorBlock) -> None:
        """Append the block's rows."""
        self._waiting.append(block)
        self._rows += len(block)
        if self._rows >= _TOGETHER:
            self._flush()

    def _flush(self) -> None:
        """Write the blocks that wait; many small ones would take long."""
        block = VectorBlock.concatenate(self._waiting)
        self._waiting, self._rows = [], 0
        limbs = limbs_of(block.components)
        turned = np.ascontiguousarray(limbs.transpose(1, 0, 2))
        rows: dict[str, NDArray[Any]] = {"major": block.major, "status": block.status}
        for name, numbers in zip(self._columns[2:], turned, strict=True):
            rows[name] = numbers if numbers.shape[1] > 1 else numbers[:, 0]
        if block.channels is not None:
            rows[CHANNEL] = block.channels
        if block.times is not None:
            rows[TIME] = block.times
        self._table.write(rows)

    def close(self, kind: Any, error: Any, trace: Any) -> None:
        """Make the file whole, or let go of it after an error (its kind, it, its trace)."""
        with self._stack:
            if kind is None and self._waiting:
                self._flush()
            self._stack.__exit__(kind, error, trace)
