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
from sculler_sim.files import open_lines

_CHUNK_ROWS = 1 << 14


class Column(NamedTuple):
    """A column to read: what messages call it, and its place in the row, from 0."""

    name: str
    place: int


class Rows(NamedTuple):
    """Consecutive rows: (N, columns) numbers and (N, whole columns) whole numbers."""

    values: NDArray[np.float64]
    whole: NDArray[np.int64]


@contextmanager
def open_text(path: Path) -> Iterator[TextIO]:
    """A text file in UTF-8.

    Raises:
        InputError: it cannot be opened, or (within the context) proves to be no such text.
    """
    try:
        with open_lines(path, encoding="utf-8-sig") as file:
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
    whole: Sequence[Column] = (),
) -> Iterator[Rows]:
    """The given columns of the rest of a file, chunk by chunk.

    Args:
        file: open where the first row begins.
        path, first_line: for messages: the file and the number of that row's line.
        columns: which to read.
        delimiter: between values; None for any white space.
        advance: told the characters read.
        whole: columns to read as whole numbers, no digit lost.

    Raises:
        InputError: a row is too short, a value is no finite (or whole) number, the last line is cut
            short, or there is no row.
    """
    places = [column.place for column in (*columns, *whole)]
    kinds = np.dtype([("values", np.float64, (len(columns),)), ("whole", np.int64, (len(whole),))])
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
                table = np.loadtxt(
                    lines,
                    dtype=kinds,
                    delimiter=delimiter,
                    usecols=places,
                    ndmin=1,
                    comments=None,
                    quotechar='"',
                )
            except (ValueError, OverflowError) as error:
                _explain(lines, path, line, columns, whole, delimiter)
                raise InputError(f"{path}: from line {line} on: {error}") from error
            if not np.isfinite(table["values"]).all():
                _explain(lines, path, line, columns, whole, delimiter)
            rows += len(table)
            yield Rows(table["values"], table["whole"])
        line += len(lines)
    if not rows:
        raise InputError(f"{path}: the log has no samples, give some")


def _explain(
    lines: list[str],
    path: Path,
    first: int,
    columns: Sequence[Column],
    whole: Sequence[Column],
    delimiter: str | None,
) -> None:
    """Find the first faulty value and say what it is.

    Raises:
        InputError: there is one.
    """
    for number, line in enumerate(lines, start=first):
        if line.isspace():
            continue
        cells = line.split(delimiter)
        for column in (*columns, *whole):
            where = f"{path}: line {number}: {column.name}"
            if column.place >= len(cells):
                raise InputError(
                    f"{where} (column {column.place + 1}) is missing, the line has only"
                    f" {len(cells)} values; is it cut short?"
                )
            cell = cells[column.place].strip().strip('"')
            good = _is_whole(cell) if column in whole else _is_finite(cell)
            if not good:
                shown = repr(cell[:40]) if cell else "empty"
                wanted = "whole" if column in whole else "finite"
                raise InputError(f"{where} is {shown}, give a {wanted} number")


def _is_finite(cell: str) -> bool:
    try:
        return isfinite(float(cell))
    except ValueError:
        return False


def _is_whole(cell: str) -> bool:
    digits = cell.lstrip("+-")
    return digits.isascii() and digits.isdecimal() and len(digits) <= 19 and abs(int(cell)) < 2**63
