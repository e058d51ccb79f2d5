"""CSV and its like: a header (or none), any delimiter, columns picked by name or number."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from typing import TextIO

import numpy as np

from sculler.logs import COUNTS, FAULT
from sculler.readers import Advance, Recording, Samples, Unit
from sculler.readers.text import Column, number_rows, open_text
from sculler.readers.timing import TimeCheck
from sculler_model.errors import InputError

DELIMITERS = {"comma": ",", "semicolon": ";", "tab": "\t", "space": None}


@dataclass(frozen=True)
class Layout:
    """Where in a row to find what.

    Attributes:
        columns: six names or numbers (from 1), gyro x, y, z, accelerometer x, y, z.
        time: name or number of the time column, or None.
        delimiter: between values, a name of `DELIMITERS` or one character; None to find out.
        skip_rows: lines before the header, or before the first row if there is no header.
    """

    columns: Sequence[str] = field(default=COUNTS)
    time: str | None = None
    delimiter: str | None = None
    skip_rows: int = 0


def read_delimited(
    path: Path, layout: Layout, gyro: Unit, accel: Unit, time_check: TimeCheck, advance: Advance
) -> Recording:
    """A text file of numbers, one sample a line.

    A column called `fault` is carried along.  The file is read as the recording's chunks are drawn,
    but for its header, which is read at once.

    Raises:
        InputError: the file cannot be read, or has no such columns.
    """
    with open_text(path) as file:
        header = _Header(file, path, layout)
    notes = {"columns": ", ".join(column.name for column in header.columns)}

    def chunks() -> Iterator[Samples]:
        with open_text(path) as file:
            for _ in islice(file, header.lines):
                pass
            for values in number_rows(
                file, path, header.lines + 1, header.columns, header.delimiter, advance
            ):
                rest = list(values[:, len(COUNTS) :].T)
                if layout.time is not None:
                    time_check(rest.pop(0))
                faults = None
                if header.has_faults:
                    flags = rest.pop(0)
                    if not np.isin(flags, (0, 1)).all():
                        raise InputError(
                            f"{path}: column {FAULT} is not 0 or 1 throughout, mend it"
                        )
                    faults = flags.astype(np.uint8)
                yield Samples(values[:, : len(COUNTS)], faults)
        if layout.time is not None:
            notes["time"] = time_check.note()

    return Recording(gyro, accel, chunks(), header.has_faults, notes)


class _Header:
    """What the head of the file says: delimiter, columns, and the lines before the first row."""

    def __init__(self, file: TextIO, path: Path, layout: Layout) -> None:
        lines = list(islice(file, layout.skip_rows + 1))
        if len(lines) <= layout.skip_rows:
            raise InputError(
                f"{path}: the log is empty after {layout.skip_rows} lines, give samples"
            )
        line = lines[-1]
        self.delimiter = _delimiter(layout.delimiter, line)
        cells = [cell.strip().strip('"').strip() for cell in line.split(self.delimiter)]
        wanted = [*layout.columns, *([layout.time] if layout.time is not None else [])]
        self.has_faults = FAULT in cells and FAULT not in wanted
        wanted += [FAULT] * self.has_faults
        named = not all(name.isdecimal() for name in wanted)
        if named:
            for name in wanted:
                if name not in cells:
                    raise InputError(
                        f"{path}: line {len(lines)}: no column {name!r}, the header names"
                        f" {', '.join(cells)[:200]}; give --gyro-columns and --accel-columns"
                    )
            self.columns = [Column(name, cells.index(name)) for name in wanted]
        else:
            self.columns = [Column(f"column {name}", int(name) - 1) for name in wanted]
            for column in self.columns:
                if not 0 <= column.place < len(cells):
                    raise InputError(
                        f"{path}: line {len(lines)}: no {column.name}, the line has {len(cells)}"
                    )
        header = named or not all(_is_number(cells[column.place]) for column in self.columns)
        self.lines = layout.skip_rows + header


def _delimiter(given: str | None, line: str) -> str | None:
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
