"""IMU logs as the core sees them: CSV of counts, one sample a row (docs/reference/imu-log.md).

The header names the columns `gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z`, in any order, and
optionally `fault` (0 or 1), `time_s` (the stamp, decimal seconds of the log's own clock) and
`sequence` (a whole number that counts samples).  Reading streams in bounded memory: each block of
the file goes through a strict vectorised parser (`plain_rows`), and only a block that this parser
will not take is read again line by line, to say which value of which line is wrong.

The stamp of an increment is the end of its step, that of a rate the instant it holds at.
"""

from __future__ import annotations

import re
import sys
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from decimal import Decimal
from pathlib import Path
from types import TracebackType
from typing import BinaryIO, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sculler.formats.plain_rows import Rows, parse
from sculler_model import inputs
from sculler_model.design import Design, Interval
from sculler_model.errors import InputError
from sculler_model.outputs import MAX_LINE, endless_line

COUNTS = ("gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z")
FAULT, TIME, SEQUENCE = "fault", "time_s", "sequence"
OPTIONAL = (FAULT, TIME, SEQUENCE)
HEADER = ",".join(COUNTS)


class Chunk(NamedTuple):
    """Consecutive samples of a log.

    `counts` is (N, 6) in the order of `COUNTS`.  The others are (N,), and None where the log has
    no such column: `faults` of 0 and 1; `times`, the stamps, s; `sequence`, the sample counter.
    """

    counts: NDArray[np.int64]
    faults: NDArray[np.uint8] | None = None
    times: NDArray[np.float64] | None = None
    sequence: NDArray[np.int64] | None = None


BLOCK_BYTES = 1 << 18
"""Bytes of a log parsed at a time: the parser's arrays then stay in the processor's cache."""

_AHEAD = 3  # chunks
_INTEGER = re.compile(rb"[ \t]*[+-]?[0-9]+[ \t]*")
_DECIMAL = re.compile(rb"[ \t]*[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?[ \t]*")
_MOST_SECONDS = 1e12  # 30,000 years: a stamp beyond is in another unit
_MOST_SEQUENCE = 10**18
_MAX_HEADER = 4096  # bytes; a binary file may have no line end for long


def read_log(
    path: str | Path, design: Design | None, advance: Callable[[int], None] | None = None
) -> Iterator[Chunk]:
    """Stream a log's samples, checked against the sensor's widths.

    Args:
        path: the log; `-` for stdin.
        design: its `sensor` gives the widths; None for counts of up to 64 bits.
        advance: told the bytes read, block by block.

    Yields:
        The samples, each value checked by itself; whether stamps and counter run on is another
        matter (`sculler.checks.breaks`).

    Raises:
        InputError: the log cannot be read or has a fault; names file, line and column.
    """
    name = "stdin" if str(path) == "-" else str(path)
    try:
        if str(path) == "-":
            yield from _chunks(sys.stdin.buffer, _Layout(name, design), advance)
        else:
            inputs.note(path)
            with Path(path).open("rb") as file:
                chunks = _chunks(file, _Layout(name, design), advance)
                # a pipe may wait for ever, and a thread that waits cannot be stopped
                yield from _ahead(chunks) if Path(path).is_file() else chunks
    except OSError as error:
        raise InputError(
            f"{name}: cannot read the log ({error.strerror}), check the path"
        ) from error


class _Layout:
    """What the header and the sensor say about a log's rows."""

    def __init__(self, name: str, design: Design | None) -> None:
        self.name = name
        widest = Interval.signed(64)
        words = (widest, widest) if design is None else (design.words.gyro, design.words.accel)
        self.words = dict(zip(("gyro", "accel"), words, strict=True))
        self.columns: list[str] = []

    def read_header(self, line: bytes) -> None:
        try:
            text = line.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            raise InputError(f"{self.name}: not a text file in UTF-8, give a CSV log") from error
        names = [column.strip() for column in text.split(",")]
        if not text.strip():
            raise InputError(f"{self.name}: the log is empty, give the header {HEADER} and samples")
        if not any(column in (*COUNTS, *OPTIONAL) for column in names):
            raise InputError(
                f"{self.name}: line 1: no header, give {HEADER} and optionally"
                f" {', '.join(OPTIONAL)}"
                " (sculler convert reads other formats)"
            )
        for column in COUNTS:
            if column not in names:
                raise InputError(f"{self.name}: line 1: column {column} is missing, add it")
        for column in names:
            if column not in (*COUNTS, *OPTIONAL):
                raise InputError(
                    f"{self.name}: line 1: unknown column {column[:40]!r}, give {HEADER} and"
                    f" optionally {', '.join(OPTIONAL)}"
                )
            if names.count(column) > 1:
                raise InputError(f"{self.name}: line 1: column {column} is there twice, drop one")
        self.columns = names
        self.order = [names.index(column) for column in COUNTS]
        self.in_order = self.order == list(range(len(COUNTS)))
        self.fault, self.time, self.sequence = (
            names.index(column) if column in names else None for column in OPTIONAL
        )

    def chunk(self, rows: Rows) -> Chunk | None:
        """Rows of all columns as a chunk, or None if a value is out of its range."""
        values, times = rows
        picked = values[:, : len(COUNTS)] if self.in_order else values[:, self.order]
        counts = np.ascontiguousarray(picked)
        for first, allowed in ((0, self.words["gyro"]), (3, self.words["accel"])):
            triple = counts[:, first : first + 3]
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
        if times is not None and np.abs(times).max() > _MOST_SECONDS:
            return None
        return Chunk(counts, faults, times, sequence)

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
        if column == FAULT:
            if value not in (0, 1):
                raise InputError(f"{where} is {value}, give 0 or 1")
            return value
        if column == SEQUENCE:
            if abs(value) > _MOST_SEQUENCE:
                raise InputError(f"{where} has more than 18 digits, give a smaller counter")
            return value
        allowed = self.words[column.split("_")[0]]
        if value not in allowed:
            shown = cell.decode().strip()
            raise InputError(
                f"{where} = {shown[:40]} does not fit the sensor's {allowed.bits} bits, give"
                f" {allowed.lo} to {allowed.hi}"
            )
        return value

    def parse(self, block: bytes) -> Rows | None:
        """The fast path: the rows of whole lines, or None if they are not all plain."""
        return parse(block, len(self.columns), self.time, self.sequence is not None)

    def read_lines(self, block: bytes, first_line: int) -> Rows:
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
    if abs(value) > _MOST_SECONDS:
        raise InputError(
            f"{where} = {value:.9g} is more than {_MOST_SECONDS:g} s, give seconds (not"
            " nanoseconds)"
        )
    return value


def _chunks(
    file: BinaryIO, layout: _Layout, advance: Callable[[int], None] | None
) -> Iterator[Chunk]:
    header = file.readline(_MAX_HEADER)
    layout.read_header(header.rstrip(b"\r\n"))
    line = 2
    for block in _whole_lines(file, layout.name):
        if advance is not None:
            advance(len(block))
        if not block.endswith(b"\n"):
            raise InputError(
                f"{layout.name}: line {line}: the last line has no line end, so the file seems cut"
                " short; write it again (or end the line, if it is whole)"
            )
        lines = block.replace(b"\r\n", b"\n") if b"\r" in block else block
        rows = layout.parse(lines)
        chunk = None if rows is None else layout.chunk(rows)
        if chunk is None:
            chunk = layout.chunk(layout.read_lines(lines, line))
            assert chunk is not None  # read_lines has checked every value
        yield chunk
        line += len(chunk.counts)
    if line == 2:
        raise InputError(f"{layout.name}: the log has a header and no samples, give some")


def _whole_lines(file: BinaryIO, name: str) -> Iterator[bytes]:
    """Blocks of about `BLOCK_BYTES` that end with a line end, and what is left after the last.

    Raises:
        InputError: a line is longer than `MAX_LINE`.
    """
    rest = b""
    while block := file.read(BLOCK_BYTES):
        block = rest + block
        end = block.rfind(b"\n") + 1
        rest = block[end:]
        if len(rest) > MAX_LINE:
            raise endless_line(name)
        if end:
            yield block[:end]
    if rest:
        yield rest


def _ahead(chunks: Iterator[Chunk]) -> Iterator[Chunk]:
    """The same chunks, the next ones made in a second thread meanwhile.

    Parsing and what is done with the chunks are mostly arithmetic of numpy and of the simulator,
    during which Python's threads do run side by side.
    """
    with ThreadPoolExecutor(max_workers=1) as reader:
        coming = deque(reader.submit(next, chunks, None) for _ in range(_AHEAD))
        while (chunk := coming.popleft().result()) is not None:
            coming.append(reader.submit(next, chunks, None))
            yield chunk


class LogWriter:
    """Writes a log, chunk by chunk; the header goes out when it is opened.

    Args:
        path: the file.
        faults: write the `fault` column too.
        times: write the `time_s` column too.
    """

    def __init__(self, path: Path, faults: bool = False, times: bool = False) -> None:
        self._faults, self._times = faults, times
        self._file = path.open("w", encoding="ascii", newline="")
        self._file.write(HEADER + f",{FAULT}" * faults + f",{TIME}" * times + "\n")

    def write(
        self,
        counts: NDArray[np.int64],
        faults: NDArray[np.uint8] | None = None,
        times: NDArray[np.float64] | None = None,
        origin: float = 0.0,
    ) -> None:
        """Append samples.

        Args:
            counts: (N, 6).
            faults: (N,), if the log has that column (None: 0).
            times: (N,) stamps, s from the origin; exactly if the log has that column.
            origin: a whole number of s.

        Raises:
            ValueError: stamps are missing or too many.
        """
        if (times is not None) != self._times:
            raise ValueError("times: give them exactly where the log has the column time_s")
        if self._faults:
            flags = np.zeros(len(counts), np.int64) if faults is None else faults
            counts = np.column_stack([counts, flags])
        row = ",".join(["%d"] * counts.shape[1])
        cells = counts
        if times is not None:
            row += ",%s"
            cells = np.empty((len(counts), counts.shape[1] + 1), object)
            cells[:, :-1], cells[:, -1] = counts, _decimals(times, origin)
        self._file.write((row + "\n") * len(counts) % tuple(cells.ravel().tolist()))

    def close(self) -> None:
        """Flush and close the file."""
        self._file.close()

    def __enter__(self) -> LogWriter:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


def _decimals(times: NDArray[np.float64], origin: float) -> list[str]:
    """Times from an origin, each to 1 ns at least."""
    if np.spacing(abs(origin)) < 1e-9:
        return [_decimal(time) for time in (times + origin if origin else times).tolist()]
    whole, since = int(origin), [Decimal(f"{time:.9f}") for time in times.tolist()]
    texts = (f"{whole + time:f}".rstrip("0") for time in since)
    return [text + "0" * text.endswith(".") for text in texts]


def _decimal(value: float) -> str:
    """The shortest decimal that is read as this float again, without an exponent."""
    text = repr(value)
    return np.format_float_positional(value, trim="0") if "e" in text else text
