"""Increments as KF-GINS and the i2Nav group's data sets have them.

Text: seven columns between blanks, no header.  Binary: the same seven as 8-byte floats, least
significant byte first, row after row.  The columns are the time (GPS seconds of the week) at the
end of the interval, the angle increments x, y, z (rad) and the velocity increments x, y, z (m/s)
over it.  The axes are forward, right, down as a rule.  Further columns of the text are left unread.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from sculler.formats.log import COUNTS
from sculler.readers.format import UNITS, Format, Head, Request
from sculler.readers.recording import Clock, Recording, Samples
from sculler.readers.text import Column, number_rows, open_text
from sculler_model.errors import InputError

COLUMNS = ("time", *COUNTS)
_UNITS = ("rad", "m/s")

_ROW = np.dtype("<f8")
_ROW_BYTES = len(COLUMNS) * _ROW.itemsize
_CHUNK_ROWS = 1 << 14
_NOTES = {"time stamps": "column 1, s (end of each interval)"}


def read_kfgins(path: Path, request: Request) -> Recording:
    """A text file of increments, read as its samples are drawn.

    Raises:
        InputError: the file cannot be read, or a row is at fault.
    """
    with open_text(path) as file:
        if not file.readline():
            raise InputError(f"{path}: the log is empty, give samples")
    units, clock = request.units(*_UNITS), Clock("s")

    def chunks() -> Iterator[Samples]:
        columns = [Column(name, at) for at, name in enumerate(COLUMNS)]
        with open_text(path) as file:
            for rows in number_rows(
                file, path, 1, columns, None, request.advance, exact=columns[0]
            ):
                yield Samples(rows.values[:, 1:], times=clock(rows.texts))

    return Recording(*units, chunks(), clock=clock, notes=_NOTES)


def read_kfgins_binary(path: Path, request: Request) -> Recording:
    """The same in binary.

    Raises:
        InputError: the file cannot be read, is cut short, or holds a value that is not finite.
    """
    try:
        size = path.stat().st_size
    except OSError as error:
        raise InputError(
            f"{path}: cannot read the log ({error.strerror}), check the path"
        ) from error
    if size == 0:
        raise InputError(f"{path}: the log is empty, give samples")
    if size % _ROW_BYTES:
        raise InputError(
            f"{path}: {size} bytes are not a whole number of rows of {_ROW_BYTES}, the file is cut"
            " short or of another format"
        )
    units, clock = request.units(*_UNITS), Clock("s")

    def chunks() -> Iterator[Samples]:
        first = 0
        with path.open("rb") as file:
            while block := file.read(_CHUNK_ROWS * _ROW_BYTES):
                request.advance(len(block))
                rows = np.frombuffer(block, _ROW).reshape(-1, len(COLUMNS)).astype(np.float64)
                if not np.isfinite(rows).all():
                    row, at = (int(i) for i in np.argwhere(~np.isfinite(rows))[0])
                    raise InputError(
                        f"{path}: sample {first + row}: {COLUMNS[at]} is {rows[row, at]}, give a"
                        " finite number (or another --format)"
                    )
                yield Samples(rows[:, 1:], times=clock(rows[:, 0]))
                first += len(rows)

    return Recording(*units, chunks(), clock=clock, notes=_NOTES)


def looks_like_text(lines: list[str]) -> bool:
    """Whether the first lines are rows of this text: seven numbers, of which the first grows."""
    try:
        rows = [[float(cell) for cell in line.split()] for line in lines]
    except ValueError:
        return False
    times = [row[0] for row in rows if len(row) >= len(COLUMNS)]
    return len(times) == len(rows) >= 2 and bool((np.diff(times) > 0).all())


def looks_like_binary(head: bytes, size: int) -> bool:
    """Whether the first bytes of a file of this size are rows of the binary format."""
    rows = np.frombuffer(head[: len(head) // _ROW_BYTES * _ROW_BYTES], _ROW)
    rows = rows.reshape(-1, len(COLUMNS))
    if size % _ROW_BYTES or len(rows) < 2 or not np.isfinite(rows).all():
        return False
    steps = np.diff(rows[:, 0])
    # intervals of 10 µs to 10 s, and numbers that are increments: bytes of anything else are not
    return bool(((steps > 1e-5) & (steps < 10)).all() and (np.abs(rows[:, 1:]) < 1e3).all())


def _looks(head: Head) -> float:
    return 0.5 * looks_like_binary(head.content, head.size)


FORMATS = (
    Format("kfgins", "text of KF-GINS: time and increments", read_kfgins, UNITS),
    Format(
        "kfgins-binary",
        "the same in binary, 7 floats of 8 bytes",
        read_kfgins_binary,
        UNITS,
        _looks,
    ),
)
