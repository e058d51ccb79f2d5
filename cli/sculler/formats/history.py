"""Navigation results on their way to files and pictures."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from types import TracebackType

import numpy as np
from numpy.typing import NDArray

from sculler.formats.compiled import kernels
from sculler.formats.compiled.printing import FLOAT_BYTES
from sculler.formats.tables import Column, TableWriter, table_kind, writing_table
from sculler_model.navigation import NavHistory

HEADER = (
    "time_s,q_w,q_x,q_y,q_z,roll_deg,pitch_deg,heading_deg,"
    "v_north,v_east,v_down,lat_deg,lon_deg,height_m"
)
WANDER = "wander_deg"
ATTITUDE = 8
"""Columns of `HEADER` that tell time and attitude."""


class HistoryWriter:
    """Writes states, every number with all its digits; the ending of the name says which kind.

    `.npz` and `.parquet` have a column of float64 for each of `HEADER`, CSV has these as its header
    and goes out line by line.  All of it is of true north, east and down, whatever frame the states
    were carried in.

    Args:
        path: the file.
        wander: a last column `WANDER` tells where that frame's x axis points, from north to east.
        attitude_only: write time and attitude, and nothing else.

    Raises:
        InputError: the library for the kind of file is absent.
    """

    def __init__(self, path: Path, *, wander: bool = False, attitude_only: bool = False) -> None:
        self._names = [*HEADER.split(","), *[WANDER] * wander]
        if attitude_only:
            del self._names[ATTITUDE:]
        self._stack = ExitStack()
        self._table: TableWriter | None = None
        self._written = 0
        if table_kind(path) is not None:
            columns = [Column(name, "float64") for name in self._names]
            self._table = self._stack.enter_context(writing_table(path, columns))
            return
        self._file = self._stack.enter_context(path.open("wb"))
        self._file.write((",".join(self._names) + "\n").encode("ascii"))

    def write(self, part: NavHistory) -> None:
        """Append states."""
        columns = [
            part.time,
            part.q,
            np.degrees(part.euler),
            part.v,
            np.degrees(part.lat),
            np.degrees(part.lon),
            part.h,
        ]
        if WANDER in self._names:
            columns.append(np.degrees(part.wander))
        table = np.column_stack(columns)[:, : len(self._names)]
        if self._table is not None:
            self._table.write(dict(zip(self._names, table.T, strict=True)))
            return
        text = self._printed(table) or _formatted(table)
        self._written += len(text)
        self._file.write(text)

    def _printed(self, table: NDArray[np.float64]) -> memoryview | None:
        """Rows by compiled loops; None where they are not worth it, or a number is not finite."""
        room = table.size * FLOAT_BYTES
        compiled = kernels(self._written + room, writing=True)
        if compiled is None:
            return None
        out = np.empty(room, np.uint8)
        size = compiled.print_floats(table, compiled.upper, out)
        return None if size < 0 else out[:size].data

    def __enter__(self) -> HistoryWriter:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._stack.__exit__(kind, error, trace)


def _formatted(table: NDArray[np.float64]) -> bytes:
    """Rows in Python."""
    return "".join(",".join(map(repr, row)) + "\n" for row in table.tolist()).encode()


class Thinned:
    """Every k-th state of a history of unknown length, k such that they never are many.

    Args:
        most: keep at most this many states.
    """

    def __init__(self, most: int = 20_000) -> None:
        self._most, self._step, self._seen = most, 1, 0
        self._kept: NavHistory | None = None
        self._last: NavHistory | None = None

    def add(self, part: NavHistory) -> None:
        """Take the next states."""
        if not len(part):
            return
        picked = rows(part, slice(-self._seen % self._step, None, self._step))
        self._seen += len(part)
        self._kept = picked if self._kept is None else NavHistory.concatenate([self._kept, picked])
        self._last = rows(part, slice(len(part) - 1, None))
        while len(self._kept) > self._most:
            self._kept = rows(self._kept, slice(None, None, 2))
            self._step *= 2

    def history(self) -> NavHistory:
        """The states kept, and the very last one.

        Raises:
            ValueError: none came.
        """
        if self._kept is None or self._last is None:
            raise ValueError("no states")
        if self._kept.time[-1] == self._last.time[-1]:
            return self._kept
        return NavHistory.concatenate([self._kept, self._last])


def rows(history: NavHistory, part: slice) -> NavHistory:
    """Some states of a history."""
    return NavHistory(
        history.time[part],
        history.q[part],
        history.v[part],
        history.lat[part],
        history.lon[part],
        history.h[part],
        history.wander[part],
    )
