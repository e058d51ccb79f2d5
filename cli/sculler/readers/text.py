"""Rows of numbers in text files, streaming, with every fault named by its line and column."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import islice
from math import isfinite
from pathlib import Path
from typing import NamedTuple, TextIO

import numpy as np
from numpy.typing import NDArray

from sculler.readers import Advance
from sculler_model.errors import InputError

_CHUNK_ROWS = 1 << 14


class Column(NamedTuple):
    """A column to read: what messages call it, and its place in the row, from 0."""

    name: str
    place: int


@contextmanager
def open_text(path: Path) -> Iterator[TextIO]:
    """A text file in UTF-8.

    Raises:
        InputError: it cannot be opened, or (within the context) proves to be no such text.
    """
    try:
        with path.open(encoding="utf-8-sig") as file:
            yield file
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: not a text file in UTF-8, check --format") from error
    except OSError as error:
        raise InputError(
            f"{path}: cannot read the log ({error.strerror}), check the path"
        ) from error


def number_rows(
    file: TextIO,
    path: Path,
    first_line: int,
    columns: Sequence[Column],
    delimiter: str | None,
    advance: Advance,
) -> Iterator[NDArray[np.float64]]:
    """The given columns of the rest of a file, (N, len(columns)), chunk by chunk.

    Args:
        file: open where the first row begins.
        path, first_line: for messages: the file and the number of that row's line.
        columns: which to read.
        delimiter: between values; None for any white space.
        advance: told the characters read.

    Raises:
        InputError: a row is too short, a value is no finite number, the last line is cut short, or
            there is no row.
    """
    places = [column.place for column in columns]
    line, rows = first_line, 0
    while lines := list(islice(file, _CHUNK_ROWS)):
        advance(sum(map(len, lines)))
        if not lines[-1].endswith("\n"):
            raise InputError(
                f"{path}: line {line + len(lines) - 1}: the last line has no line end, so the file"
                " seems cut short; write it again (or end the line, if it is whole)"
            )
        if any(not text.isspace() for text in lines):
            try:
                values = np.loadtxt(
                    lines,
                    delimiter=delimiter,
                    usecols=places,
                    ndmin=2,
                    comments=None,
                    quotechar='"',
                )
            except ValueError as error:
                _explain(lines, path, line, columns, delimiter)
                raise InputError(f"{path}: from line {line} on: {error}") from error
            if not np.isfinite(values).all():
                _explain(lines, path, line, columns, delimiter)
            rows += len(values)
            yield values
        line += len(lines)
    if not rows:
        raise InputError(f"{path}: the log has no samples, give some")


def _explain(
    lines: list[str], path: Path, first: int, columns: Sequence[Column], delimiter: str | None
) -> None:
    """Find the first faulty value and say what it is.

    Raises:
        InputError: there is one.
    """
    for number, line in enumerate(lines, start=first):
        if line.isspace():
            continue
        cells = line.split(delimiter)
        for column in columns:
            where = f"{path}: line {number}: {column.name}"
            if column.place >= len(cells):
                raise InputError(
                    f"{where} (column {column.place + 1}) is missing, the line has only"
                    f" {len(cells)} values; is it cut short?"
                )
            cell = cells[column.place].strip().strip('"')
            try:
                good = isfinite(float(cell))
            except ValueError:
                good = False
            if not good:
                shown = repr(cell[:40]) if cell else "empty"
                raise InputError(f"{where} is {shown}, give a finite number")
