"""IMU logs as `.npz` and `.parquet`: the columns of the CSV, whole numbers as integers."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sculler.formats.lines import ahead
from sculler.formats.log_columns import (
    CHANNEL,
    COUNTS,
    FAULT,
    MOST_SECONDS,
    RESTART,
    SEQUENCE,
    TIME,
    Chunk,
    does_not_fit,
    ranges,
    require_columns,
    too_late,
)
from sculler.formats.log_text import decimals, is_far
from sculler.formats.tables import (
    Column,
    TableReader,
    open_table,
    seconds,
    whole,
    writing_table,
)
from sculler_model.design import Design, Interval
from sculler_model.errors import InputError


def read_log_table(
    path: str | Path, design: Design | None, advance: Callable[[int], None] | None
) -> Iterator[Chunk]:
    """Stream a binary log's samples; see `log.read_log`.

    Raises:
        InputError: it cannot be read or has a fault; names file, row and column.
    """
    with open_table(path, "log") as table:
        require_columns(str(path), list(table.names), 1 if design is None else design.channels)
        yield from ahead(_chunks(path, table, _Rows(path, ranges(design)), advance))


def _chunks(
    path: str | Path, table: TableReader, rows: _Rows, advance: Callable[[int], None] | None
) -> Iterator[Chunk]:
    share = Path(path).stat().st_size / max(table.rows, 1)
    first = 1
    for block in table.blocks(table.names):
        chunk = rows.chunk(block, first)
        first += len(chunk.counts)
        if advance is not None:
            advance(round(share * len(chunk.counts)))
        yield chunk
    if first == 1:
        raise InputError(f"{path}: the log has no samples, give some")


class _Rows:
    """Checks the rows of a file against what its columns may hold."""

    def __init__(self, path: str | Path, allowed: dict[str, Interval]) -> None:
        self._path, self._allowed = path, allowed

    def chunk(self, block: Any, first: int) -> Chunk:
        """The columns' rows, of which the first has this number, as a chunk."""
        counts = np.empty((len(block[COUNTS[0]]), len(COUNTS)), np.int64)
        for place, column in enumerate(COUNTS):
            counts[:, place] = self._whole(column, block[column], first)
        faults = times = sequence = None
        if FAULT in block:
            faults = self._whole(FAULT, block[FAULT], first).astype(np.uint8)
        if SEQUENCE in block:
            sequence = self._whole(SEQUENCE, block[SEQUENCE], first)
        if TIME in block:
            times = seconds(self._path, TIME, block[TIME], first)
            late = np.abs(times) > MOST_SECONDS
            if late.any():
                row = int(np.argmax(late))
                raise too_late(f"{self._path}: row {first + row}: {TIME}", float(times[row]))
        channels = restarts = None
        if CHANNEL in block:
            channels = self._whole(CHANNEL, block[CHANNEL], first)
        if RESTART in block:
            restarts = self._whole(RESTART, block[RESTART], first).astype(np.uint8)
        return Chunk(counts, faults, times, sequence, channels, restarts)

    def _whole(self, column: str, given: NDArray[Any], first: int) -> NDArray[np.int64]:
        """A column's whole numbers, each in its range."""
        if column in (FAULT, RESTART) and given.dtype.kind == "b":
            return given.astype(np.int64)
        numbers, allowed = whole(self._path, column, given, first), self._allowed[column]
        if numbers.min() < allowed.lo or numbers.max() > allowed.hi:
            row = int(np.argmax((numbers < allowed.lo) | (numbers > allowed.hi)))
            where = f"{self._path}: row {first + row}: {column}"
            raise does_not_fit(where, column, int(numbers[row]), allowed)
        return numbers


class LogTableWriter:
    """Writes a binary log; see `log.LogWriter`."""

    def __init__(self, path: Path, marks: Sequence[str], times: bool) -> None:
        columns = [Column(name) for name in COUNTS]
        for name in marks:
            columns.append(Column(name) if name == CHANNEL else Column(name, "uint8", 8))
        columns += [Column(TIME, "float64")] * times
        self._stack = ExitStack()
        self._table = self._stack.enter_context(writing_table(path, columns))

    def write(self, chunk: Chunk, origin: float) -> None:
        """Append samples; `origin` is added to their times."""
        block: dict[str, NDArray[Any]] = dict(zip(COUNTS, chunk.counts.T, strict=True))
        marks = {FAULT: chunk.faults, CHANNEL: chunk.channels, RESTART: chunk.restarts}
        block |= {name: column for name, column in marks.items() if column is not None}
        if chunk.times is not None:
            block[TIME] = _stamps(chunk.times, origin)
        self._table.write(block)

    def close(self, *error: Any) -> None:
        """Make the file whole, or let go of it after an error (its kind, it, its trace)."""
        self._stack.__exit__(*error)


def _stamps(times: NDArray[np.float64], origin: float) -> NDArray[np.float64]:
    """The floats that a reader of the CSV gets."""
    if not is_far(origin):
        return times + origin
    return np.array([float(text) for text in decimals(times, origin)])
