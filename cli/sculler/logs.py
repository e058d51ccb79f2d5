"""IMU logs as the core sees them: CSV of integer counts, one sample a row (DESIGN section 4).

The header names the columns `gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z`, in any order, and
optionally `fault` (0 or 1).  Reading streams in bounded memory: each block of the file goes through
a strict vectorised parser, and only a block that this parser will not take is read again line by
line, to say which value of which line is wrong.
"""

from __future__ import annotations

import re
import sys
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import TracebackType
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_sim.files import open_blocks

COUNTS = ("gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z")
FAULT = "fault"
HEADER = ",".join(COUNTS)

Chunk = tuple[NDArray[np.int64], NDArray[np.uint8] | None]
"""Counts (N, 6) in the order of `COUNTS`, and fault flags (N,) where the log has them."""

BLOCK_BYTES = 1 << 18
"""Bytes of a log parsed at a time: the parser's arrays then stay in the processor's cache."""

_AHEAD = 3  # chunks
_MAX_DIGITS = 10  # a 32-bit count has no more
_INTEGER = re.compile(rb"[ \t]*[+-]?[0-9]+[ \t]*")
_MAX_HEADER = 4096  # bytes; a binary file may have no line end for long
_ZERO, _MINUS = np.uint8(ord("0")), np.uint8(ord("-"))


def read_log(
    path: str | Path, design: Design, advance: Callable[[int], None] | None = None
) -> Iterator[Chunk]:
    """Stream a log's samples, checked against the sensor's widths.

    Args:
        path: the log; `-` for stdin.
        design: its `sensor` gives the widths.
        advance: told the bytes read, block by block.

    Yields:
        (counts, faults): (N, 6) int64 in the order gyro x, y, z, accelerometer x, y, z; and (N,)
        uint8 of 0 and 1, or None if the log has no `fault` column.

    Raises:
        InputError: the log cannot be read or has a fault; names file, line and column.
    """
    name = "stdin" if str(path) == "-" else str(path)
    try:
        if str(path) == "-":
            yield from _chunks(sys.stdin.buffer, _Layout(name, design), advance)
        else:
            with open_blocks(path) as file:
                chunks = _chunks(file, _Layout(name, design), advance)
                # a pipe may wait for ever, and a thread that waits cannot be stopped
                yield from _ahead(chunks) if Path(path).is_file() else chunks
    except OSError as error:
        raise InputError(
            f"{name}: cannot read the log ({error.strerror}), check the path"
        ) from error


class _Layout:
    """What the header and the sensor say about a log's rows."""

    def __init__(self, name: str, design: Design) -> None:
        self.name = name
        self.words = {"gyro": design.words.gyro, "accel": design.words.accel}
        self.columns: list[str] = []

    def read_header(self, line: bytes) -> None:
        try:
            text = line.decode("utf-8-sig")
        except UnicodeDecodeError as error:
            raise InputError(f"{self.name}: not a text file in UTF-8, give a CSV log") from error
        names = [column.strip() for column in text.split(",")]
        if not text.strip():
            raise InputError(f"{self.name}: the log is empty, give the header {HEADER} and samples")
        if not any(column in (*COUNTS, FAULT) for column in names):
            raise InputError(
                f"{self.name}: line 1: no header, give {HEADER} and optionally {FAULT}"
                " (sculler convert reads other formats)"
            )
        for column in COUNTS:
            if column not in names:
                raise InputError(f"{self.name}: line 1: column {column} is missing, add it")
        for column in names:
            if column not in (*COUNTS, FAULT):
                raise InputError(
                    f"{self.name}: line 1: unknown column {column[:40]!r}, give {HEADER} and"
                    f" optionally {FAULT}"
                )
            if names.count(column) > 1:
                raise InputError(f"{self.name}: line 1: column {column} is there twice, drop one")
        self.columns = names
        self.order = [names.index(column) for column in COUNTS]
        self.in_order = self.order == list(range(len(COUNTS)))

    def chunk(self, values: NDArray[np.int64]) -> Chunk | None:
        """Values (N, columns) as a chunk, or None if one is out of its range."""
        picked = values[:, : len(COUNTS)] if self.in_order else values[:, self.order]
        counts = np.ascontiguousarray(picked)
        for first, allowed in ((0, self.words["gyro"]), (3, self.words["accel"])):
            triple = counts[:, first : first + 3]
            if triple.min() < allowed.lo or triple.max() > allowed.hi:
                return None
        if FAULT not in self.columns:
            return counts, None
        faults = values[:, self.columns.index(FAULT)]
        if faults.min() < 0 or faults.max() > 1:
            return None
        return counts, faults.astype(np.uint8)

    def value(self, column: str, cell: bytes, line: int) -> int:
        """One cell of the slow path.

        Raises:
            InputError: it is not a whole number, or does not fit.
        """
        where = f"{self.name}: line {line}: {column}"
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
        allowed = self.words[column.split("_")[0]]
        if value not in allowed:
            shown = cell.decode().strip()
            raise InputError(
                f"{where} = {shown[:40]} does not fit the sensor's {allowed.bits} bits, give"
                f" {allowed.lo} to {allowed.hi}"
            )
        return value

    def read_lines(self, block: bytes, first_line: int) -> NDArray[np.int64]:
        """The slow path: values (N, columns) of whole lines, or what is wrong with them."""
        rows = []
        for number, line in enumerate(block.split(b"\n")[:-1], start=first_line):
            if not line.strip():
                raise InputError(f"{self.name}: line {number}: an empty line, take it out")
            cells = line.split(b",")
            if len(cells) != len(self.columns):
                raise InputError(
                    f"{self.name}: line {number}: {len(cells)} values, give"
                    f" {len(self.columns)}, one for each column of the header"
                )
            rows.append(
                [
                    self.value(column, cell, number)
                    for column, cell in zip(self.columns, cells, strict=True)
                ]
            )
        return np.array(rows, np.int64).reshape(-1, len(self.columns))


def _chunks(
    file: BinaryIO, layout: _Layout, advance: Callable[[int], None] | None
) -> Iterator[Chunk]:
    header = file.readline(_MAX_HEADER)
    layout.read_header(header.rstrip(b"\r\n"))
    line = 2
    for block in _whole_lines(file):
        if advance is not None:
            advance(len(block))
        if not block.endswith(b"\n"):
            raise InputError(
                f"{layout.name}: line {line}: the last line has no line end, so the file seems cut"
                " short; write it again (or end the line, if it is whole)"
            )
        lines = block.replace(b"\r\n", b"\n") if b"\r" in block else block
        values = _parse(lines, len(layout.columns))
        chunk = None if values is None else layout.chunk(values)
        if chunk is None:
            chunk = layout.chunk(layout.read_lines(lines, line))
            assert chunk is not None  # read_lines has checked every value
        yield chunk
        line += len(chunk[0])
    if line == 2:
        raise InputError(f"{layout.name}: the log has a header and no samples, give some")


def _whole_lines(file: BinaryIO) -> Iterator[bytes]:
    """Blocks of about `BLOCK_BYTES` that end with a line end, and what is left after the last."""
    rest = b""
    while block := file.read(BLOCK_BYTES):
        block = rest + block
        end = block.rfind(b"\n") + 1
        rest = block[end:]
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


def _parse(block: bytes, fields: int) -> NDArray[np.int64] | None:
    """Values (N, fields) of lines of plain integers, or None if anything else is in the block.

    Plain: an optional minus and 1 to 10 digits, `fields` of them to a line with commas between, and
    nothing else.  Every byte is accounted for: it is a digit, a separator where the layout wants
    that separator, or a minus at the head of a number.
    """
    text = np.frombuffer(block, np.uint8)
    ends = np.flatnonzero(text < _MINUS)  # commas and line ends; spaces and + fail the next check
    layout = np.frombuffer(b"," * (fields - 1) + b"\n", np.uint8)
    if len(ends) % fields or (text[ends].reshape(-1, fields) != layout).any():
        return None
    starts = np.empty_like(ends)
    starts[0] = 0
    np.add(ends[:-1], 1, out=starts[1:])
    negative = text[starts] == _MINUS
    digits = ends - starts - negative
    longest = int(digits.max())
    figure = text - _ZERO  # wraps for all that is no digit, so those are > 9
    known = np.count_nonzero(figure < 10) + len(ends) + np.count_nonzero(negative)
    if digits.min() < 1 or longest > _MAX_DIGITS or known != len(text):
        return None
    values = np.zeros(len(ends), np.int64)
    at = ends
    for place in range(longest):
        at = at - 1
        values += (figure.take(at, mode="clip") * (digits > place)) * np.int64(10**place)
    np.negative(values, out=values, where=negative)
    return values.reshape(-1, fields)


class LogWriter:
    """Writes a log, chunk by chunk; the header goes out when it is opened.

    Args:
        path: the file.
        faults: write the `fault` column too.
    """

    def __init__(self, path: Path, faults: bool = False) -> None:
        self._faults = faults
        self._file = path.open("w", encoding="ascii", newline="")
        self._file.write(HEADER + (f",{FAULT}" if faults else "") + "\n")

    def write(self, counts: NDArray[np.int64], faults: NDArray[np.uint8] | None = None) -> None:
        """Append samples: counts (N, 6), and faults (N,) if the log has that column (None: 0)."""
        if self._faults:
            flags = np.zeros(len(counts), np.int64) if faults is None else faults
            counts = np.column_stack([counts, flags])
        row = ",".join(["%d"] * counts.shape[1]) + "\n"
        self._file.write(row * len(counts) % tuple(counts.ravel().tolist()))

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
