"""Navigation results on their way to files and pictures."""

from __future__ import annotations

from pathlib import Path
from types import TracebackType

import numpy as np

from sculler_model.navigation import NavHistory

HEADER = (
    "time_s,q_w,q_x,q_y,q_z,roll_deg,pitch_deg,heading_deg,"
    "v_north,v_east,v_down,lat_deg,lon_deg,height_m"
)
WANDER = "wander_deg"


class HistoryWriter:
    """Writes states as CSV, every number with all its digits; the header goes out on opening.

    All of `HEADER` is of true north, east and down, whatever frame the states were carried in.

    Args:
        path: the file.
        wander: a last column `WANDER` tells where that frame's x axis points, from north to east.
    """

    def __init__(self, path: Path, *, wander: bool = False) -> None:
        self._wander = wander
        self._file = path.open("w", encoding="ascii", newline="")
        self._file.write(HEADER + (f",{WANDER}" if wander else "") + "\n")

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
        if self._wander:
            columns.append(np.degrees(part.wander))
        table = np.column_stack(columns)
        self._file.writelines(",".join(map(repr, row)) + "\n" for row in table.tolist())

    def __enter__(self) -> HistoryWriter:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._file.close()


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
        picked = _rows(part, slice(-self._seen % self._step, None, self._step))
        self._seen += len(part)
        self._kept = picked if self._kept is None else NavHistory.concatenate([self._kept, picked])
        self._last = _rows(part, slice(len(part) - 1, None))
        while len(self._kept) > self._most:
            self._kept = _rows(self._kept, slice(None, None, 2))
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


def _rows(history: NavHistory, rows: slice) -> NavHistory:
    return NavHistory(
        history.time[rows],
        history.q[rows],
        history.v[rows],
        history.lat[rows],
        history.lon[rows],
        history.h[rows],
        history.wander[rows],
    )
