"""Files of named columns, binary: `.npz` and `.parquet`, by the ending of their name.

Logs, vectors, truths and states have the same columns, names and units in them as in CSV.  Both
kinds are read and written block by block, so that a long file needs no more memory than a short
one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sculler.formats.tables.columns import Block, Column, TableReader, TableWriter
from sculler_model import inputs
from sculler_model.errors import InputError

__all__ = [
    "Block",
    "Column",
    "Counting",
    "TableReader",
    "TableWriter",
    "counting",
    "open_table",
    "seconds",
    "table_kind",
    "whole",
    "writing_table",
]

Kind = Literal["npz", "parquet"]
_ENDINGS: dict[str, Kind] = {".npz": "npz", ".parquet": "parquet"}


def table_kind(path: str | Path) -> Kind | None:
    """Which binary kind a file is of, by its ending; None for text."""
    return _ENDINGS.get(Path(path).suffix.lower())


class Counting(NamedTuple):
    """How messages count the rows of a file.

    Attributes:
        unit: `line` or `row`.
        first: number of the first row; a CSV has its header in line 1.
    """

    unit: str
    first: int


def counting(path: str | Path) -> Counting:
    """How the rows of a file are counted, by its ending."""
    return Counting("line", 2) if table_kind(path) is None else Counting("row", 1)


@contextmanager
def open_table(path: str | Path, what: str) -> Iterator[TableReader]:
    """A binary file to read, noted as an input of the run.

    Args:
        path: the file, which `table_kind` knows.
        what: it is, for messages: "log".

    Raises:
        InputError: it cannot be read, is no whole file of its kind, or is a pipe; or the library
            for it is absent.
    """
    inputs.note(path)
    path = Path(path)
    inputs.require_file(path, what)
    try:
        with path.open("rb"):
            pass
        if table_kind(path) == "npz":
            from sculler.formats.tables.npz import NpzReader

            table: TableReader = NpzReader(path)
        else:
            from sculler.formats.tables.parquet import ParquetReader

            table = ParquetReader(path)
    except OSError as error:
        raise InputError(
            f"{path}: cannot read the {what} ({error.strerror or error}), check the path"
        ) from error
    try:
        yield table
    finally:
        table.close()


@contextmanager
def writing_table(path: Path, columns: Sequence[Column]) -> Iterator[TableWriter]:
    """A binary file to write; it is whole where the body ends without an error.

    Args:
        path: the file, which `table_kind` knows.
        columns: of it.

    Raises:
        InputError: the library for it is absent, or the path is that of a pipe or device.
    """
    if path.exists() and not path.is_file():
        raise InputError(f"{path}: is no file, and only CSV can go into a pipe or device")
    if table_kind(path) == "npz":
        from sculler.formats.tables.npz import NpzWriter

        table: TableWriter = NpzWriter(path, columns)
    else:
        from sculler.formats.tables.parquet import ParquetWriter

        table = ParquetWriter(path, columns)
    try:
        yield table
        table.finish()
    finally:
        table.close()


def whole(path: str | Path, name: str, numbers: NDArray[Any], first: int) -> NDArray[np.int64]:
    """A column of whole numbers of 64 bits, exactly.

    Args:
        path, name: of file and column, for messages.
        numbers: (R,), or (R, W) limbs.
        first: number of its first row, from 1.

    Raises:
        InputError: they are of another type, or one does not fit.
    """
    if numbers.dtype.kind not in "iu" or numbers.dtype == np.dtype(np.bool_):
        raise InputError(f"{path}: {name} is of type {numbers.dtype}, give whole numbers")
    if numbers.ndim == 1 and numbers.dtype.kind == "i":
        return numbers.astype(np.int64, copy=False)
    if numbers.ndim == 1:
        beyond = numbers > np.uint64(2**63 - 1)
        found = numbers.astype(np.int64)
    else:
        found = np.ascontiguousarray(numbers[:, 0]).astype(np.int64)
        beyond = (numbers[:, 1:] != (found >> 63)[:, None]).any(axis=1)
    if beyond.any():
        row = first + int(np.argmax(beyond))
        raise InputError(f"{path}: row {row}: {name} does not fit 64 bits, give a smaller number")
    return found


def seconds(path: str | Path, name: str, numbers: NDArray[Any], first: int) -> NDArray[np.float64]:
    """A column of times, s.

    Args:
        path, name, first: as `whole`.
        numbers: (R,) float64.

    Raises:
        InputError: they are of another type, or one is not finite.
    """
    if numbers.dtype.kind != "f" or numbers.dtype.itemsize != 8 or numbers.ndim != 1:
        raise InputError(f"{path}: {name} is of type {numbers.dtype}, give float64")
    bad = ~np.isfinite(numbers)
    if bad.any():
        row = int(np.argmax(bad))
        raise InputError(f"{path}: row {first + row}: {name} is {numbers[row]}, give seconds")
    return numbers.astype(np.float64, copy=False)
