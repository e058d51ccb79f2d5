"""Rows of numbers in text files, streaming, with every fault named by its line and column.

A text is UTF-8, or UTF-16 or UTF-32 with a byte order mark.  What follows a `#` is a comment, on a
line of its own or after a row.  Numbers may have a decimal comma, throughout.
"""

from __future__ import annotations

import codecs
import re
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from decimal import Decimal
from itertools import islice
from math import isfinite
from pathlib import Path
from typing import NamedTuple, TextIO

import numpy as np
from numpy.typing import NDArray

from sculler.formats.compiled import Kernels, kernels
from sculler.readers.recording import Advance
from sculler.readers.signatures import HEAD_BYTES, told
from sculler_model.errors import InputError
from sculler_model.outputs import open_lines

COMMENT = "#"
_CHUNK_ROWS = 1 << 14
_PLAIN_DELIMITERS = (",", ";", "\t", "|")
_DIGITS = 40  # of a text that is given; those beyond are far below any clock's
_MARKS = (  # the longer first: a mark of UTF-32 begins with one of UTF-16
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
_ROUNDED = re.compile(r"[+-]?\d{1,20}(?:\.\d{0,20})?[eE]\+?\d{1,2}")


class Column(NamedTuple):
    """A column to read: what messages call it, and its place in the row, from 0."""

    name: str
    place: int


class Rows(NamedTuple):
    """Consecutive rows: (N, columns) numbers and (N, whole columns) whole numbers.

    `texts` is (N,), the texts of the one column that no digit of may be lost; empty without it.
    `rounded` is the first whole number that was written with an exponent, as spreadsheets do.
    """

    values: NDArray[np.float64]
    whole: NDArray[np.int64]
    texts: NDArray[np.str_]
    rounded: str | None = None


@contextmanager
def open_text(path: Path) -> Iterator[TextIO]:
    """A text file.

    Raises:
        InputError: it cannot be opened, or (within the context) proves to be no such text; names
            what it is, if that is known.
    """
    try:
        with open_lines(path, encoding=_encoding(path)) as file:
            yield file
    except UnicodeError as error:
        where = f" at byte {error.start:,}" if isinstance(error, UnicodeDecodeError) else ""
        raise InputError(
            f"{path}: not a text file in UTF-8{where}, save it as UTF-8 (of raw datagrams say whose"
            " with --format)"
        ) from error
    except OSError as error:
        raise InputError(
            f"{path}: cannot read the log ({error.strerror}), check the path"
        ) from error


def _encoding(path: Path) -> str:
    """How the text is encoded, by its byte order mark.

    Raises:
        InputError: it is no text.
    """
    with path.open("rb") as file:
        head = file.read(HEAD_BYTES)
    for mark, name in _MARKS:
        if head.startswith(mark):
            return name
    known = told(head)
    if known is not None:
        raise InputError(f"{path}: {known}")
    if b"\0" in head:
        raise InputError(
            f"{path}: no text, byte {head.index(0):,} is 0; check --format (of raw datagrams it"
            " says whose they are)"
        )
    return "utf-8-sig"


def number_rows(
    file: TextIO,
    path: Path,
    first_line: int,
    columns: Sequence[Column],
    delimiter: str | None,
    advance: Advance,
    whole: Sequence[Column] = (),
    decimal: str = ".",
    exact: Column | None = None,
) -> Iterator[Rows]:
    """The given columns of the rest of a file, chunk by chunk.

    Args:
        file: open where the first row begins.
        path, first_line: for messages: the file and the number of that row's line.
        columns: which to read.
        delimiter: between values; None for any white space.
        advance: told the characters read.
        whole: columns to read as whole numbers, no digit lost.
        decimal: the mark before the decimals, a point or a comma.
        exact: one of `columns`, to give as texts too, with a point before the decimals.

    Raises:
        InputError: a row is too short, a value is no finite (or whole) number, the last line is cut
            short, or there is no row.
    """
    texts = [] if exact is None else [exact]
    places = [column.place for column in (*columns, *whole, *texts)]
    kinds = np.dtype([
        ("values", np.float64, (len(columns),)),
        ("whole", np.int64, (len(whole),)),
        ("texts", f"U{_DIGITS}", (len(texts),)),
    ])  # fmt: skip
    line, rows, size = first_line, 0, path.stat().st_size
    while lines := list(islice(file, _CHUNK_ROWS)):
        advance(sum(map(len, lines)))
        _require_end(lines, path, line)
        if decimal == ",":
            _require_no_point(lines, path, line, (*columns, *whole), delimiter)
            lines = [text.replace(",", ".") for text in lines]
        rows_of = lines
        if any(COMMENT in text for text in lines):
            rows_of = [text for text in lines if is_content(text)]
        plain = _scanned(lines, len(rows_of), columns, delimiter, whole, exact, kernels(size))
        if plain is not None:
            rows += len(rows_of)
            yield plain
        elif any(not text.isspace() for text in rows_of):
            try:
                table, rounded = _parsed(rows_of, kinds, delimiter, places, whole)
            except (ValueError, OverflowError) as error:
                _explain(lines, path, line, columns, whole, delimiter)
                raise InputError(f"{path}: from line {line} on: {error}") from error
            if not np.isfinite(table["values"]).all():
                _explain(lines, path, line, columns, whole, delimiter)
            rows += len(table)
            yield Rows(
                table["values"], table["whole"], _whole_texts(table, texts, columns), rounded
            )
        line += len(lines)
    if not rows:
        raise InputError(f"{path}: the log has no samples, give some")


def _require_end(lines: list[str], path: Path, first_line: int) -> None:
    """Refuse a last line without an end."""
    if not lines[-1].endswith("\n"):
        raise InputError(
            f"{path}: line {first_line + len(lines) - 1}: the last line has no line end, so the"
            " file seems cut short; write it again (or end the line, if it is whole)"
        )


def _scanned(
    lines: list[str],
    rows: int,
    columns: Sequence[Column],
    delimiter: str | None,
    whole: Sequence[Column],
    exact: Column | None,
    compiled: Kernels | None,
) -> Rows | None:
    """Lines of plain numbers, by compiled loops; None where they are not, or not worth it."""
    if compiled is None or rows != len(lines) or delimiter not in _PLAIN_DELIMITERS:
        return None
    text = "".join(lines)
    if not text.isascii() or COMMENT in text or '"' in text or (exact and " " in text):
        return None
    places = np.full(lines[0].count(delimiter) + 1, -1, np.int64)
    for codes, chosen in ((range(len(columns)), columns), (range(-2, -2 - len(whole), -1), whole)):
        for code, column in zip(codes, chosen, strict=True):
            if column.place >= len(places) or places[column.place] != -1:
                return None
            places[column.place] = code
    bits = np.empty((rows, len(columns)), np.uint64)
    counts = np.empty((rows, len(whole)), np.int64)
    characters = np.frombuffer(text.encode(), np.uint8)
    found = compiled.scan_numbers(characters, ord(delimiter), places, compiled.lower, bits, counts)
    if found != rows:
        return None
    values, texts = bits.view(np.float64), np.empty(0, np.str_)
    if exact is not None:
        cells = [line.rstrip("\n").split(delimiter)[exact.place] for line in lines]
        texts = np.array(cells, f"U{_DIGITS}")
        if max(map(len, cells)) >= _DIGITS:
            return None
    return Rows(values, counts, texts)


def is_content(line: str) -> bool:
    """Whether a line is neither blank nor a comment."""
    text = line.lstrip()
    return bool(text) and not text.startswith(COMMENT)


def _parsed(
    lines: list[str],
    kinds: np.dtype[np.void],
    delimiter: str | None,
    places: Sequence[int],
    whole: Sequence[Column],
) -> tuple[NDArray[np.void], str | None]:
    """The table of some lines, and the first whole number with an exponent, or None.

    Raises:
        ValueError, OverflowError: a value is no number, or no whole one.
    """
    try:
        return _table(lines, kinds, delimiter, places), None
    except (ValueError, OverflowError):
        mended, rounded = _with_whole(lines, whole, delimiter)
        if rounded is None:
            raise
        return _table(mended, kinds, delimiter, places), rounded


def _table(
    lines: list[str], kinds: np.dtype[np.void], delimiter: str | None, places: Sequence[int]
) -> NDArray[np.void]:
    with warnings.catch_warnings():
        # NumPy 1 only warns where it reads a whole number through a float, which loses digits
        warnings.simplefilter("error", DeprecationWarning)
        try:
            table: NDArray[np.void] = np.loadtxt(
                lines,
                dtype=kinds,
                delimiter=delimiter,
                usecols=places,
                ndmin=1,
                comments=COMMENT,
                quotechar='"',
            )
        except DeprecationWarning as warning:
            raise ValueError(str(warning)) from warning
    return table


def _whole_texts(
    table: NDArray[np.void], texts: Sequence[Column], columns: Sequence[Column]
) -> NDArray[np.str_]:
    """The texts; where one is too long for its field, the number instead."""
    if not texts:
        return np.empty(0, np.str_)
    given, values = table["texts"][:, 0], table["values"][:, columns.index(texts[0])]
    cut: NDArray[np.bool_] = np.char.str_len(given) >= _DIGITS
    return np.where(cut, values.astype(np.str_), given) if cut.any() else given


def _with_whole(
    lines: list[str], whole: Sequence[Column], delimiter: str | None
) -> tuple[list[str], str | None]:
    """The lines with whole numbers that have an exponent written out, and the first of them."""
    mended, first = [], None
    places = [column.place for column in whole]
    for line in lines:
        cells = line.split(delimiter)
        for place in places:
            cell = cells[place].strip().strip('"') if place < len(cells) else ""
            if not _ROUNDED.fullmatch(cell):
                continue
            value = Decimal(cell)
            if value == value.to_integral_value() and abs(value) < 2**63:
                first = first or cell
                cells[place] = str(int(value))
        mended.append((delimiter or " ").join(cells).rstrip("\r\n") + "\n")
    return mended, first


def _require_no_point(
    lines: list[str],
    path: Path,
    first: int,
    columns: Sequence[Column],
    delimiter: str | None,
) -> None:
    """Whether no number has a point, in a file of decimal commas: as if for thousands.

    Raises:
        InputError: one has.
    """
    if not any("." in line for line in lines):
        return
    for number, line in enumerate(lines, start=first):
        if "." not in line or not is_content(line):
            continue
        cells = line.partition(COMMENT)[0].split(delimiter)
        for column in columns:
            if column.place < len(cells) and "." in cells[column.place]:
                cell = cells[column.place].strip()
                raise InputError(
                    f"{path}: line {number}: {column.name} is {cell[:40]!r}, but other numbers have"
                    " a decimal comma; write all alike, without marks for thousands"
                )


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
        if not is_content(line):
            continue
        cells = line.partition(COMMENT)[0].split(delimiter)
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
    digits = cell[1:] if cell[:1] in ("+", "-") else cell
    return digits.isascii() and digits.isdecimal() and len(digits) <= 19 and abs(int(cell)) < 2**63
