"""CSV and its like: a header (or none), any delimiter, columns picked by name or number.

EuRoC's and ROS's CSV files are such files with known headers (`sculler.readers.columns`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import TextIO

import numpy as np
from numpy.typing import NDArray

from sculler.logs import COUNTS, FAULT
from sculler.readers import Advance, Clock, Recording, Samples, Unit
from sculler.readers.columns import headed, recognise, stamp_unit
from sculler.readers.text import Column, Rows, number_rows, open_text
from sculler_model.errors import InputError

DELIMITERS = {"comma": ",", "semicolon": ";", "tab": "\t", "space": None}


@dataclass(frozen=True)
class Layout:
    """Where in a row to find what.

    Attributes:
        columns: six names or numbers (from 1), gyro x, y, z, accelerometer x, y, z; None for those
            of a known program, else `COUNTS`.
        time: name or number of the time column; None for that of a known program, else none.
        time_unit: of `TIME_UNITS`; None for that of a known program, else s.
        delimiter: between values, a name of `DELIMITERS` or one character; None to find out.
        skip_rows: lines before the header, or before the first row if there is no header.
        program: the known program that must have written the file, or None for any.
    """

    columns: Sequence[str] | None = None
    time: str | None = None
    time_unit: str | None = None
    delimiter: str | None = None
    skip_rows: int = 0
    program: str | None = None


def read_delimited(
    path: Path, layout: Layout, gyro: Unit, accel: Unit, advance: Advance
) -> Recording:
    """A text file of numbers, one sample a line.

    A column called `fault` is carried along.  The file is read as the recording's chunks are drawn,
    but for its head, which is read at once.

    Raises:
        InputError: the file cannot be read, or has no such columns.
    """
    with open_text(path) as file:
        header = _Header(file, path, layout)
    clock = None if header.time_unit is None else Clock(header.time_unit)
    notes = {"columns": ", ".join(column.name for column in header.columns)}
    if clock is not None:
        names = " and ".join(column.name for column in header.stamps)
        notes["time stamps"] = f"{names}, {clock.unit}"
    whole = header.stamps if clock is not None and clock.unit == "ns" else []

    def chunks() -> Iterator[Samples]:
        with open_text(path) as file:
            for _ in islice(file, header.lines):
                pass
            columns = [*header.columns, *([] if whole else header.stamps), *header.faults]
            for rows in number_rows(
                file, path, header.lines + 1, columns, header.delimiter, advance, whole
            ):
                faults = None
                if header.faults:
                    faults = fault_flags(path, rows.values[:, -1])
                times = None if clock is None else clock(_stamps(rows))
                yield Samples(rows.values[:, : len(COUNTS)], faults, times)

    return Recording(gyro, accel, chunks(), bool(header.faults), clock, notes)


def fault_flags(path: Path, values: NDArray[np.float64]) -> NDArray[np.uint8]:
    """A fault column as flags.

    Raises:
        InputError: a value is neither 0 nor 1.
    """
    if not np.isin(values, (0, 1)).all():
        raise InputError(f"{path}: column {FAULT} is not 0 or 1 throughout, mend it")
    return values.astype(np.uint8)


def _stamps(rows: Rows) -> NDArray[np.int64] | NDArray[np.float64]:
    """The stamps, from a column of numbers, or from one or two of whole numbers."""
    if not rows.whole.shape[1]:
        return rows.values[:, len(COUNTS)]
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
        columns: the six of the samples.
        stamps: none, one, or two: whole seconds and nanoseconds.
        time_unit: of the stamps, None if there are none.
        faults: none, or the fault column.
        lines: lines before the first row.
    """

    def __init__(self, file: TextIO, path: Path, layout: Layout) -> None:
        lines = list(islice(file, layout.skip_rows + 2))
        if len(lines) <= layout.skip_rows:
            raise InputError(
                f"{path}: the log is empty after {layout.skip_rows} lines, give samples"
            )
        line = lines[layout.skip_rows]
        number = layout.skip_rows + 1
        self.delimiter = delimiter_of(layout.delimiter, line)
        cells = header_cells(line, self.delimiter)
        known = recognise(cells)
        if layout.program is not None and (known is None or known.program != layout.program):
            raise InputError(
                f"{path}: line {number}: not the header of a file of format {layout.program}, give"
                " --format csv with the columns"
            )
        names: Sequence[str] = layout.columns or (COUNTS if known is None else known.columns)
        names = [headed(name, cells) for name in names]
        time: Sequence[str] = () if known is None else known.time
        if layout.time is not None:
            time = (layout.time,)
        faults = [FAULT] * (FAULT in cells and FAULT not in (*names, *time))
        wanted = [*names, *time, *faults]
        named = not all(name.isdecimal() for name in wanted)
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
            found = [Column(name, cells.index(name)) for name in wanted]
        else:
            found = [Column(f"column {name}", int(name) - 1) for name in wanted]
            for column in found:
                if not 0 <= column.place < len(cells):
                    raise InputError(
                        f"{path}: line {number}: no {column.name}, the line has {len(cells)}"
                    )
        self.columns = found[: len(names)]
        self.stamps = found[len(names) : len(names) + len(time)]
        self.faults = found[len(names) + len(time) :]
        is_header = named or not all(_is_number(cells[column.place]) for column in self.columns)
        self.lines = layout.skip_rows + is_header
        row = header_cells(lines[self.lines], self.delimiter) if len(lines) > self.lines else []
        self.time_unit = None
        if self.stamps:
            place = self.stamps[0].place
            stamp = row[place] if place < len(row) else ""
            by_known = None
            if known is not None and layout.time is None:
                by_known = known.time_unit or stamp_unit(stamp)
            self.time_unit = layout.time_unit or by_known or "s"


def delimiter_of(given: str | None, line: str) -> str | None:
    """The delimiter asked for, or the one that the line shows."""
    if given is not None:
        return DELIMITERS.get(given, given)
    return next((character for character in ",;\t" if character in line), None)


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True
