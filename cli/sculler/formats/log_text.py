"""IMU logs as CSV: read in bounded memory with every value checked, and written.

Each block of the file goes through a strict parser, compiled (`compiled.scanning`) or in numpy
(`plain_rows`), and only a block that neither will take is read again line by line, to say which
value of which line is wrong.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Iterator, Sequence
from decimal import Decimal
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from sculler.formats import lines
from sculler.formats.compiled import WORTH_READING, Kernels, kernels
from sculler.formats.compiled.printing import FLOAT_BYTES, NO_LIMBS, WHOLE_BYTES
from sculler.formats.compiled.scanning import FAULT as FAULT_KIND
from sculler.formats.compiled.scanning import SEQUENCE as SEQUENCE_KIND
from sculler.formats.compiled.scanning import TIME as TIME_KIND
from sculler.formats.log_columns import (
    CHANNEL,
    COUNTS,
    FAULT,
    HEADER,
    MOST_SECONDS,
    OF_CHANNELS,
    OPTIONAL,
    RESTART,
    SEQUENCE,
    TIME,
    Chunk,
    does_not_fit,
    ranges,
    require_columns,
    too_late,
)
from sculler.formats.plain_rows import Rows, parse
from sculler_model import inputs
from sculler_model.design import Design
from sculler_model.errors import InputError

_INTEGER = re.compile(rb"[ \t]*[+-]?[0-9]+[ \t]*")
_DECIMAL = re.compile(rb"[ \t]*[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?[ \t]*")
_BLOCKS = 8  # of `lines.BLOCK_BYTES` of a large file, which compiled loops parse without arrays
_MAX_HEADER = 4096  # bytes; a binary file may have no line end for long
_KINDS = {FAULT: FAULT_KIND, TIME: TIME_KIND, SEQUENCE: SEQUENCE_KIND}


def read_text_log(
    path: str | Path, design: Design | None, advance: Callable[[int], None] | None
) -> Iterator[Chunk]:
    """Stream a CSV's samples; see `log.read_log`.

    Raises:
        OSError: the file cannot be read.
        InputError: it has a fault; names file, line and column.
    """
    if str(path) == "-":
        yield from _chunks(sys.stdin.buffer, _Layout("stdin", design), 0, advance)
        return
    inputs.note(path)
    with Path(path).open("rb") as file:
        regular = Path(path).is_file()
        size = Path(path).stat().st_size if regular else 0
        chunks = _chunks(file, _Layout(str(path), design), size, advance)
        # a pipe may wait for ever, and a thread that waits cannot be stopped
        yield from lines.ahead(chunks) if regular else chunks


class _Layout:
    """What the header and the sensor say about a log's rows."""

    def __init__(self, name: str, design: Design | None) -> None:
        self.name = name
        self.channels = 1 if design is None else design.channels
        self.allowed = ranges(design)
        self.columns: list[str] = []

    def read_header(self, line: bytes) -> None:
        try:
            text = line.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            raise InputError(f"{self.name}: not a text file in UTF-8, give a CSV log") from error
        names = [column.strip() for column in text.split(",")]
        if not text.strip():
            raise InputError(f"{self.name}: the log is empty, give the header {HEADER} and samples")
        require_columns(f"{self.name}: line 1", names, self.channels)
        self.columns = names
        self.order = [names.index(column) for column in COUNTS]
        self.in_order = self.order == list(range(len(COUNTS)))
        self.fault, self.time, self.sequence = (
            names.index(column) if column in names else None for column in OPTIONAL
        )
        self.of_channels = {c: names.index(c) for c in OF_CHANNELS if c in names}
        if self.of_channels:  # read without compiled loops
            return
        places = {column: place for place, column in enumerate(COUNTS)} | _KINDS
        self.kinds = np.array([places[column] for column in names], np.int64)
        self.limits = np.zeros((len(places), 2), np.int64)
        for column, allowed in self.allowed.items():
            if column in places:
                self.limits[places[column]] = allowed.lo, allowed.hi

    def chunk(self, rows: Rows) -> Chunk | None:
        """Rows of all columns as a chunk, or None if a value is out of its range."""
        values, times = rows
        picked = values[:, : len(COUNTS)] if self.in_order else values[:, self.order]
        counts = np.ascontiguousarray(picked)
        for first, column in ((0, "gyro_x"), (3, "accel_x")):
            triple, allowed = counts[:, first : first + 3], self.allowed[column]
            if triple.min() < allowed.lo or triple.max() > allowed.hi:
                return None
        faults = sequence = None
        if self.fault is not None:
            marks = values[:, self.fault]
            if marks.min() < 0 or marks.max() > 1:
                return None
            faults = marks.astype(np.uint8)
        if self.sequence is not None:
            sequence = values[:, self.sequence].copy()
        if times is not None and np.abs(times).max() > MOST_SECONDS:
            return None
        for column, place in self.of_channels.items():
            told, allowed = values[:, place], self.allowed[column]
            if told.min() < allowed.lo or told.max() > allowed.hi:
                return None
        channels, restarts = (
            values[:, self.of_channels[c]].copy() if c in self.of_channels else None
            for c in (CHANNEL, RESTART)
        )
        again = None if restarts is None else restarts.astype(np.uint8)
        return Chunk(counts, faults, times, sequence, channels, again)

    def value(self, column: str, cell: bytes, line: int) -> int | float:
        """One cell of the slow path.

        Raises:
            InputError: it is not a whole number (a number in `time_s`), or does not fit.
        """
        where = f"{self.name}: line {line}: {column}"
        if column == TIME:
            return _seconds(where, cell)
        if not _INTEGER.fullmatch(cell):
            shown = cell.decode("utf-8", "backslashreplace").strip()
            shown = f"{shown[:40]!r}" if shown else "empty"
            raise InputError(
                f"{where} is {shown}, give a whole number (sculler convert reads other numbers)"
            )
        # more digits than any count has are enough to tell that it does not fit
        value = int(cell) if len(cell) <= 1000 else 10**1000
        if value not in self.allowed[column]:
            raise does_not_fit(where, column, cell.decode().strip()[:40], self.allowed[column])
        return value

    def scan(self, compiled: Kernels, block: bytes) -> Chunk | None:
        """The compiled path: whole lines as a chunk, or None if they are not all plain."""
        most = block.count(b"\n")

        def column(place: int | None, kind: type) -> NDArray[Any]:
            return np.empty(0 if place is None else most, kind)

        counts = np.empty((most, len(COUNTS)), np.int64)
        bits, faults = column(self.time, np.uint64), column(self.fault, np.uint8)
        sequence = column(self.sequence, np.int64)
        rows = compiled.scan_log(
            np.frombuffer(block, np.uint8),
            self.kinds,
            self.limits,
            compiled.lower,
            bits,
            counts,
            faults,
            sequence,
        )
        if rows != most:
            return None
        times = bits.view(np.float64)
        if self.time is not None and np.abs(times).max() > MOST_SECONDS:
            return None
        return Chunk(
            counts,
            None if self.fault is None else faults,
            None if self.time is None else times,
            None if self.sequence is None else sequence,
        )

    def read(self, block: bytes, first_line: int, compiled: Kernels | None) -> Chunk:
        """Whole lines, of which the first has this number.

        Raises:
            InputError: one has a fault.
        """
        chunk = None if compiled is None or self.of_channels else self.scan(compiled, block)
        if chunk is None:
            rows = parse(block, len(self.columns), self.time, self.sequence is not None)
            chunk = None if rows is None else self.chunk(rows)
        if chunk is None:
            chunk = self.chunk(self._read_lines(block, first_line))
        assert chunk is not None  # `_read_lines` has checked every value
        return chunk

    def _read_lines(self, block: bytes, first_line: int) -> Rows:
        """The slow path: the rows of whole lines, or what is wrong with them."""
        rows: list[list[int]] = []
        times: list[float] = []
        for number, line in enumerate(block.split(b"\n")[:-1], start=first_line):
            if not line.strip():
                raise InputError(f"{self.name}: line {number}: an empty line, take it out")
            cells = line.split(b",")
            if len(cells) != len(self.columns):
                raise InputError(
                    f"{self.name}: line {number}: {len(cells)} values, give"
                    f" {len(self.columns)}, one for each column of the header"
                )
            values = [
                self.value(column, cell, number)
                for column, cell in zip(self.columns, cells, strict=True)
            ]
            if self.time is not None:
                times.append(values[self.time])
                values[self.time] = 0
            rows.append([int(value) for value in values])
        whole = np.array(rows, np.int64).reshape(-1, len(self.columns))
        return Rows(whole, None if self.time is None else np.array(times, np.float64))


def _seconds(where: str, cell: bytes) -> float:
    """One stamp of the slow path."""
    if not _DECIMAL.fullmatch(cell) or len(cell) > 1000:
        shown = cell.decode("utf-8", "backslashreplace").strip()
        shown = f"{shown[:40]!r}" if shown else "empty"
        raise InputError(f"{where} is {shown}, give decimal seconds")
    value = float(cell)
    if abs(value) > MOST_SECONDS:
        raise too_late(where, value)
    return value


def _chunks(
    file: BinaryIO, layout: _Layout, size: int, advance: Callable[[int], None] | None
) -> Iterator[Chunk]:
    header = file.readline(_MAX_HEADER)
    layout.read_header(header.rstrip(b"\r\n"))
    if len(header) == _MAX_HEADER and not header.endswith(b"\n"):
        raise InputError(
            f"{layout.name}: line 1: more than {_MAX_HEADER} bytes, shorten the header"
        )
    line, seen = 2, 0
    large = size >= WORTH_READING and kernels(size) is not None
    together = lines.BLOCK_BYTES * (_BLOCKS if large else 1)
    for block in lines.whole_lines(file, layout.name, together):
        seen += len(block)
        if advance is not None:
            advance(len(block))
        if not block.endswith(b"\n"):
            raise InputError(
                f"{layout.name}: line {line}: the last line has no line end, so the file seems cut"
                " short; write it again (or end the line, if it is whole)"
            )
        plain = block.replace(b"\r\n", b"\n") if b"\r" in block else block
        chunk = layout.read(plain, line, kernels(max(size, seen)))
        yield chunk
        line += len(chunk.counts)
    if line == 2:
        raise InputError(f"{layout.name}: the log has a header and no samples, give some")


class TextLogWriter:
    """Writes a log as CSV; see `log.LogWriter`."""

    def __init__(self, path: Path, marks: Sequence[str], times: bool) -> None:
        self._file = path.open("wb")
        self._file.write((",".join([HEADER, *marks, *[TIME] * times]) + "\n").encode())
        self._written = 0

    def write(self, chunk: Chunk, origin: float) -> None:
        """Append samples; `origin` is added to their times."""
        times, marks = chunk.times, chunk.marks
        whole = np.column_stack([chunk.counts, *marks]) if marks else chunk.counts
        text = self._printed(whole, times, origin) or _formatted(whole, times, origin)
        self._written += len(text)
        self._file.write(text)

    def _printed(
        self, whole: NDArray[np.int64], times: NDArray[np.float64] | None, origin: float
    ) -> memoryview | None:
        """By compiled loops; None where they are not worth it, or for some time not enough."""
        room = whole.size * WHOLE_BYTES + (0 if times is None else len(times) * FLOAT_BYTES)
        compiled = kernels(self._written + room, writing=True)
        if compiled is None:
            return None
        out = np.empty(room, np.uint8)
        rows = np.ascontiguousarray(whole, np.int64)
        if times is not None and is_far(origin):
            since = _nanoseconds(times, origin)
            size = -1 if since is None else compiled.print_stamped(rows, since, out)
            return None if size < 0 else out[:size].data
        stamps = np.zeros(0) if times is None else times + origin
        plain = (stamps == 0) | (np.abs(stamps) >= 1e-4) & (np.abs(stamps) < 1e16)
        if not plain.all():  # `repr` would have an exponent
            return None
        return out[: compiled.print_rows(rows, NO_LIMBS, stamps, compiled.upper, out)].data

    def close(self, *error: object) -> None:
        """Flush and close the file, be it whole or not."""
        self._file.close()


def _formatted(whole: NDArray[np.int64], times: NDArray[np.float64] | None, origin: float) -> bytes:
    """Rows as text, one Python number after the other."""
    row = ",".join(["%d"] * whole.shape[1])
    cells = whole
    if times is not None:
        row += ",%s"
        cells = np.empty((len(whole), whole.shape[1] + 1), object)
        cells[:, :-1], cells[:, -1] = whole, decimals(times, origin)
    return ((row + "\n") * len(whole) % tuple(cells.ravel().tolist())).encode()


def is_far(origin: float) -> bool:
    """Whether floats at an origin are further apart than a nanosecond."""
    return bool(np.spacing(abs(origin)) >= 1e-9)


def _nanoseconds(times: NDArray[np.float64], origin: float) -> NDArray[np.int64] | None:
    """Times from an origin in whole nanoseconds, rounded as decimals are; None if one is unsure.

    The product is off by half a unit of its last place, so only near a half could the rounding of
    the exact product be another.
    """
    product = times * 1e9
    near = np.rint(product)
    sure = np.abs(np.abs(product - near) - 0.5) > np.spacing(np.abs(product))
    if not sure.all() or np.abs(times).max(initial=0) > 1e6 or abs(origin) > 9e9:
        return None
    whole: NDArray[np.int64] = near.astype(np.int64) + int(origin) * 10**9
    return whole if (whole >= 0).all() else None


def decimals(times: NDArray[np.float64], origin: float) -> list[str]:
    """Times from an origin, each to 1 ns at least."""
    if not is_far(origin):
        return [_decimal(time) for time in (times + origin if origin else times).tolist()]
    whole, since = int(origin), [Decimal(f"{time:.9f}") for time in times.tolist()]
    texts = (f"{whole + time:f}".rstrip("0") for time in since)
    return [text + "0" * text.endswith(".") for text in texts]


def _decimal(value: float) -> str:
    """The shortest decimal that is read as this float again, without an exponent."""
    text = repr(value)
    return np.format_float_positional(value, trim="0") if "e" in text else text
