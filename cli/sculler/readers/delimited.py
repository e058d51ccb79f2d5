"""CSV and its like: a header (or none), any delimiter, columns picked by name or number.

EuRoC's and ROS's CSV files are such files with known headers (`sculler.readers.columns`).
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from functools import partial
from itertools import islice
from pathlib import Path
from typing import TextIO

import numpy as np
from numpy.typing import NDArray

from sculler.formats.log import CHANNEL, COUNTS, FAULT, OF_CHANNELS, RESTART
from sculler.readers.columns import headed, recognise, stamp_unit
from sculler.readers.format import COLUMNS, TIME, UNITS, Format, Request
from sculler.readers.recording import Clock, Recording, Samples
from sculler.readers.text import COMMENT, Column, Rows, is_content, number_rows, open_text
from sculler_model.errors import InputError

DELIMITERS = {"comma": ",", "semicolon": ";", "tab": "\t", "space": None}
_COMMA = re.compile(r"[+-]?\d*,\d+(?:[eE][+-]?\d+)?")
_HEAD_ROWS = 1000


def read_delimited(path: Path, request: Request, program: str | None) -> Recording:
    """A text file of numbers, one sample a line.

    A column called `fault` is carried along, and for a design with channels `channel` and
    `restart`.  The file is read as the recording's chunks are drawn, but for its head, which is
    read at once.

    Args:
        path: the file.
        request: names or numbers (from 1) of the columns, those of a known program if left out,
            else `COUNTS`; of the time column, that of a known program if left out, else none.
        program: the known program that must have written the file, or None for any.

    Raises:
        InputError: the file cannot be read, or has no such columns.
    """
    units = request.units(*(("rad/s", "m/s2") if program is not None else ()))
    with open_text(path) as file:
        header = _Header(file, path, request, program)
    clock = None if header.time_unit is None else Clock(header.time_unit)
    notes = {"columns": ", ".join(column.name for column in header.columns)}
    warnings: list[str] = []
    if clock is not None:
        names = " and ".join(column.name for column in header.stamps)
        notes["time stamps"] = f"{names}, {clock.unit}"
    if header.decimal == ",":
        notes["numbers"] = "have a decimal comma"
    whole = header.stamps if clock is not None and clock.unit == "ns" else []
    exact = header.stamps[0] if header.stamps and not whole else None

    marks = [column.name for column in header.marks]

    def chunks() -> Iterator[Samples]:
        with open_text(path) as file:
            for _ in islice(file, header.lines):
                pass
            first = [*header.columns, *([] if whole else header.stamps)]
            columns = [*first, *header.marks]
            for rows in number_rows(
                file,
                path,
                header.lines + 1,
                columns,
                header.delimiter,
                request.advance,
                whole,
                header.decimal,
                exact,
            ):
                if rows.rounded is not None and not warnings:
                    warnings.append(_rounded_told(rows.rounded))
                times = None if clock is None else clock(_stamps(rows))
                told = dict(zip(marks, rows.values[:, len(first) :].T, strict=True))
                faults, restarts = (
                    flags(path, name, told[name]) if name in told else None
                    for name in (FAULT, RESTART)
                )
                channels = None
                if CHANNEL in told:
                    channels = _channels(path, told[CHANNEL], request.design.channels)
                values = rows.values[:, : len(COUNTS)]
                yield Samples(values, faults, times, channels, restarts)

    return Recording(
        *units,
        chunks(),
        FAULT in marks,
        clock,
        notes,
        warnings,
        has_channels=CHANNEL in marks,
        has_restarts=RESTART in marks,
    )


def _rounded_told(cell: str) -> str:
    """What is to be said of a stamp in ns with an exponent."""
    mantissa, _, exponent = cell.lower().partition("e")
    decimals = len(mantissa.partition(".")[2])
    step = 10.0 ** (int(exponent) - decimals) * 1e-9
    return (
        f"stamps are rounded, as a spreadsheet shows them ({cell}): they tell times to {step:g} s"
        " only; export them as whole numbers"
    )


def flags(path: Path, column: str, values: NDArray[np.float64]) -> NDArray[np.uint8]:
    """A column of 0 and 1.

    Raises:
        InputError: a value is neither 0 nor 1.
    """
    if not np.isin(values, (0, 1)).all():
        raise InputError(f"{path}: column {column} is not 0 or 1 throughout, mend it")
    return values.astype(np.uint8)


def _channels(path: Path, values: NDArray[np.float64], channels: int) -> NDArray[np.int64]:
    """A column of channels' numbers.

    Raises:
        InputError: one is not a channel of the design.
    """
    good = np.isin(values, np.arange(channels))
    if not good.all():
        raise InputError(
            f"{path}: column {CHANNEL}: {values[~good][0]:.15g} is not one of the design's, give 0"
            f" to {channels - 1}"
        )
    return values.astype(np.int64)


def _stamps(rows: Rows) -> NDArray[np.int64] | NDArray[np.str_]:
    """The stamps, from a column of decimals, or from one or two of whole numbers."""
    if not rows.whole.shape[1]:
        return rows.texts
    if rows.whole.shape[1] == 1:
        return rows.whole[:, 0]
    return rows.whole[:, 0] * 10**9 + rows.whole[:, 1]


def header_cells(line: str, delimiter: str | None) -> list[str]:
    """Names of a header, or values of a row, without the blanks and quotes around them."""
    return [cell.strip().strip('"').strip() for cell in line.split(delimiter)]


class _Header:
    """What the head of the file says.

    Attributes:
        delimiter: between values, None for white space.
        decimal: the mark before the decimals.
        columns: the six of the samples.
        stamps: none, one, or two: whole seconds and nanoseconds.
        time_unit: of the stamps, None if there are none.
        marks: the fault column, and of a design with channels those of `OF_CHANNELS`, as far as
            they are there.
        lines: lines before the first row.
    """

    def __init__(self, file: TextIO, path: Path, request: Request, program: str | None) -> None:
        asked = request.columns(COUNTS)
        names = [*(asked or ()), *(() if request.time is None else (request.time,))]
        given = delimiter_given(request.delimiter)
        skipped = list(islice(file, request.skip_rows))
        line, number = _header_line(file, request.skip_rows + 1, given, names)
        if line is None:
            raise InputError(f"{path}: the log is empty after {len(skipped)} lines, give samples")
        self.delimiter = delimiter_of(given, line)
        cells = header_cells(line, self.delimiter)
        known = recognise(cells)
        if program is not None and (known is None or known.program != program):
            raise InputError(
                f"{path}: line {number}: not the header of a file of format {program}, give"
                " --format csv with the columns"
            )
        columns: Sequence[str] = asked or (COUNTS if known is None else known.columns)
        columns = [headed(name, cells) for name in columns]
        time: Sequence[str] = () if known is None else known.time
        if request.time is not None:
            time = (request.time,)
        known_marks = (*OF_CHANNELS, FAULT) if request.design.channels > 1 else (FAULT,)
        marks = [each for each in known_marks if each in cells and each not in (*columns, *time)]
        wanted = [*columns, *time, *marks]
        named = not all(name.isdecimal() for name in wanted)
        if named and line.lstrip().startswith(COMMENT) and known is None:
            cells = header_cells(line.lstrip().lstrip(COMMENT), self.delimiter)
        found = _places(path, number, cells, wanted, named)
        self.columns = found[: len(columns)]
        self.stamps = found[len(columns) : len(columns) + len(time)]
        self.marks = found[len(columns) + len(time) :]
        plain = header_cells(line.partition(COMMENT)[0], self.delimiter)
        rows = [] if named or not _are_numbers(plain, self.columns) else [line]
        self.lines = number - len(rows)
        rows += [text for text in islice(file, _HEAD_ROWS) if is_content(text)]
        table = [header_cells(row.partition(COMMENT)[0], self.delimiter) for row in rows]
        self.decimal = _decimal(table, [*self.columns, *self.stamps], self.delimiter)
        self.time_unit = None
        if self.stamps:
            place = self.stamps[0].place
            stamp = table[0][place] if table and place < len(table[0]) else ""
            by_known = None
            if known is not None and request.time is None:
                by_known = known.time_unit or stamp_unit(stamp)
            self.time_unit = request.time_unit or by_known or "s"


def _header_line(
    file: TextIO, number: int, delimiter: str | None, names: Sequence[str]
) -> tuple[str | None, int]:
    """The first line that is no comment, or is a header behind a `#`, and its number."""
    for at, line in enumerate(file, start=number):
        if is_content(line):
            return line, at
        if line.isspace():
            continue
        if recognise(header_cells(line, delimiter_of(delimiter, line))) is not None:
            return line, at
        plain = line.lstrip().lstrip(COMMENT)
        cells = header_cells(plain, delimiter_of(delimiter, plain))
        if all(name in cells for name in names or COUNTS):
            return line, at
    return None, number


def _places(
    path: Path, number: int, cells: Sequence[str], wanted: Sequence[str], named: bool
) -> list[Column]:
    """Where the wanted columns are, by the names in a header or by their numbers.

    Raises:
        InputError: one is not there, or twice.
    """
    if named:
        for name in wanted:
            if name not in cells:
                raise InputError(
                    f"{path}: line {number}: no column {name!r}, the header names"
                    f" {', '.join(cells)[:200]}; give --gyro-columns and --accel-columns"
                )
            if cells.count(name) > 1:
                raise InputError(
                    f"{path}: line {number}: column {name!r} is there twice, give"
                    " --gyro-columns and --accel-columns as numbers"
                )
        return [Column(name, cells.index(name)) for name in wanted]
    found = [Column(f"column {name}", int(name) - 1) for name in wanted]
    for column in found:
        if not 0 <= column.place < len(cells):
            raise InputError(f"{path}: line {number}: no {column.name}, the line has {len(cells)}")
    return found


def _are_numbers(cells: Sequence[str], columns: Sequence[Column]) -> bool:
    """Whether the columns' cells of a line are numbers, so that the line is no header."""
    return all(
        column.place < len(cells)
        and (_is_number(cells[column.place]) or _COMMA.fullmatch(cells[column.place]) is not None)
        for column in columns
    )


def _decimal(
    table: Sequence[Sequence[str]], columns: Sequence[Column], delimiter: str | None
) -> str:
    """The mark before the decimals in the first rows."""
    if delimiter == ",":
        return "."
    cells = [row[column.place] for row in table for column in columns if column.place < len(row)]
    return "," if any(_COMMA.fullmatch(cell) for cell in cells) else "."


def delimiter_given(given: str | None) -> str | None:
    """A delimiter by its name or itself; None to find out.

    Raises:
        InputError: it is neither.
    """
    if given is not None and given not in DELIMITERS and len(given) != 1:
        raise InputError(
            f"--delimiter: {given!r} is not known, give {', '.join(DELIMITERS)} or one character"
        )
    return given


def delimiter_of(given: str | None, line: str) -> str | None:
    """The delimiter asked for, or the one that the line shows.

    Where semicolons or tabs make enough cells, commas are within these: decimal commas.
    """
    if given is not None:
        return DELIMITERS.get(given, given)
    for character in ";\t":
        if line.count(character) >= len(COUNTS) - 1:
            return character
    blank = line.split()
    if len(blank) >= len(COUNTS) and all(_COMMA.fullmatch(cell) for cell in blank):
        return None
    return next((character for character in ",;\t" if character in line), None)


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


_TEXT = frozenset({"delimiter", "skip_rows"})
FORMATS = (
    Format(
        "csv",
        "text with a header or without, any delimiter",
        partial(read_delimited, program=None),
        COLUMNS | _TEXT,
    ),
    Format(
        "euroc",
        "CSV of EuRoC's data sets",
        partial(read_delimited, program="euroc"),
        UNITS | TIME | _TEXT,
    ),
    Format(
        "ros",
        "CSV of ROS sensor_msgs/Imu",
        partial(read_delimited, program="ros"),
        UNITS | TIME | _TEXT,
    ),
)
