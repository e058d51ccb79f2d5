"""The columns of truth files: which ones there are, their cells, and the states they tell."""

from __future__ import annotations

from collections.abc import Iterator
from io import StringIO
from typing import BinaryIO, Literal

import numpy as np
from numpy.typing import NDArray

from sculler.formats import lines
from sculler.formats.compiled import Kernels, kernels
from sculler.formats.tables import Block
from sculler_model.errors import InputError
from sculler_model.frames import Vector, from_euler_rows, from_local, geodetic
from sculler_model.navigation import MAX_HEIGHT, MIN_HEIGHT, NavHistory

Array = NDArray[np.float64]

QUATERNION = ("q_w", "q_x", "q_y", "q_z")
EULER = ("roll_deg", "pitch_deg", "heading_deg")
VELOCITY = ("v_north", "v_east", "v_down")
POSITION = ("lat_deg", "lon_deg", "height_m")
TIME = "time_s"
EARTH_FIXED = ("x_m", "y_m", "z_m")
LOCAL = ("north_m", "east_m", "up_m")
KNOWN = {TIME, *VELOCITY, *POSITION, *EARTH_FIXED, *LOCAL, *QUATERNION, *EULER}

RANGES = {
    "lat_deg": (-90.0, 90.0),
    "lon_deg": (-360.0, 360.0),
    "height_m": (MIN_HEIGHT, MAX_HEIGHT),
    **dict.fromkeys(("v_north", "v_east", "v_down"), (-100000.0, 100000.0)),
    **dict.fromkeys((*EARTH_FIXED, *LOCAL), (-1e8, 1e8)),
    **dict.fromkeys(QUATERNION, (-2.0, 2.0)),
}
"""What is on or near the Earth, at speeds that stay there."""

BLOCK = 20_000
"""Rows of arrays looked at together."""

_BLOCKS = 8  # of `lines.BLOCK_BYTES` read at a time: rows are long

UNIT = 1e-6
"""How far from 1 the length of a quaternion may be."""


class Layout:
    """What the columns' names say about a file's rows.

    Args:
        name: of the file.
        names: of its columns.
        unit: what messages count: a `line` of text or a `row` of arrays.
        place: that local metres start from, latitude, longitude (rad) and height (m); None where
            they are not read.

    Attributes:
        first: number of the first row, the header being line 1.
    """

    def __init__(
        self, name: str, names: list[str], unit: Literal["line", "row"], place: Vector | None = None
    ) -> None:
        self.name, self.unit, self.place = name, unit, place
        self.first = 2 if unit == "line" else 1
        where = f"{name}: line 1" if unit == "line" else name
        places = (POSITION, EARTH_FIXED) if place is None else (POSITION, EARTH_FIXED, LOCAL)
        self.attitude, self.velocity, self.position = (
            self._group(where, names, *groups)
            for groups in ((QUATERNION, EULER), (VELOCITY,), places)
        )
        told = (*self.attitude, *self.velocity, *self.position)
        self.columns = (TIME, *told)
        if TIME not in names:
            raise InputError(f"{where}: column {TIME} is missing, add it")
        if not told:
            raise InputError(
                f"{where}: neither attitude ({','.join(QUATERNION)} or {','.join(EULER)}) nor"
                f" velocity ({','.join(VELOCITY)}) nor position ({','.join(POSITION)}) is there,"
                " add what is known"
            )
        for column in self.columns:
            if names.count(column) > 1:
                raise InputError(f"{where}: column {column} is there twice, drop one")
        self.width = len(names)
        self.places = [names.index(column) for column in self.columns]

    @staticmethod
    def _group(where: str, names: list[str], *groups: tuple[str, ...]) -> tuple[str, ...]:
        """The first of some groups of columns that is there whole, or none."""
        for group in groups:
            if all(column in names for column in group):
                return group
        for group in groups:
            missing = [column for column in group if column not in names]
            if len(missing) < len(group):
                raise InputError(
                    f"{where}: column {missing[0]} is missing, add it or leave out all of"
                    f" {','.join(group)}"
                )
        return ()

    def from_text(self, file: BinaryIO, size: int) -> Iterator[Array]:
        """The wanted columns of the lines below the header, block by block."""
        number, compiled = self.first, kernels(size)
        for text in lines.whole_lines(file, self.name, _BLOCKS * lines.BLOCK_BYTES):
            table = None if compiled is None else self._scanned(text, compiled)
            if table is None:
                table = self._table(list(StringIO(text.decode("utf-8"), newline="")), number)
            number += len(table)
            yield table

    def _scanned(self, text: bytes, compiled: Kernels) -> Array | None:
        """The wanted columns of whole lines, by compiled loops; None if they are not plain."""
        plain = text.replace(b"\r\n", b"\n") if b"\r" in text else text
        rows = plain.count(b"\n")
        if not plain.endswith(b"\n"):
            return None
        places = np.full(self.width, -1, np.int64)
        places[self.places] = np.arange(len(self.places))
        bits = np.empty((rows, len(self.places)), np.uint64)
        characters, none = np.frombuffer(plain, np.uint8), np.empty((0, 0), np.int64)
        found = compiled.scan_numbers(characters, ord(","), places, compiled.lower, bits, none)
        return bits.view(np.float64) if found == rows else None

    def _table(self, written: list[str], first: int) -> Array:
        """The wanted columns of some lines, of which the first is line `first` of the file."""
        if all(line.strip() for line in written):
            try:
                return np.loadtxt(
                    written, np.float64, comments=None, delimiter=",", usecols=self.places, ndmin=2
                )
            except ValueError:
                pass  # line by line, to say where
        return np.array([self._row(line, first + k) for k, line in enumerate(written)])

    def from_arrays(self, blocks: Iterator[Block]) -> Iterator[Array]:
        """The wanted columns of arrays, at most `BLOCK` rows at a time."""
        for columns in blocks:
            table = self._stacked(columns)
            for first in range(0, len(table), BLOCK):
                yield table[first : first + BLOCK]

    def _stacked(self, columns: Block) -> Array:
        """The wanted columns of arrays, side by side."""
        for column in self.columns:
            array, time = columns[column], columns[TIME]
            if array.ndim != 1 or array.dtype.kind not in "iuf":
                raise InputError(
                    f"{self.name}: {column} is of type {array.dtype} and shape {array.shape}, give"
                    " numbers of shape (N,)"
                )
            if len(array) != len(time):
                raise InputError(
                    f"{self.name}: {column} has {len(array)} rows and {TIME} {len(time)}, give as"
                    " many"
                )
        return np.column_stack([columns[column].astype(np.float64) for column in self.columns])

    def _row(self, line: str, number: int) -> list[float]:
        cells = line.rstrip("\r\n").split(",")
        if len(cells) != self.width:
            raise self._fault(
                number, f"{len(cells)} values for {self.width} columns of the header, mend it"
            )
        row = []
        for column, place in zip(self.columns, self.places, strict=True):
            try:
                row.append(float(cells[place]) if cells[place].strip() else np.nan)
            except ValueError:
                shown = cells[place].strip()[:40]
                raise self._fault(number, f"{column} is {shown!r}, give a number") from None
        return row

    def check(self, table: Array, numbers: NDArray[np.int64], before: float) -> None:
        """Refuse what cannot be a state.

        Args:
            table: rows.
            numbers: of their lines or rows in the file.
            before: time of the row before.
        """
        row, column = _where(~np.isfinite(table))
        if row is not None:
            raise self._fault(
                numbers[row], f"{self.columns[column]} is {table[row, column]}, give a number"
            )
        time = table[:, 0]
        earlier = np.concatenate(([before], time[:-1]))
        row, _ = _where((time <= earlier)[:, None])
        if row is not None:
            raise self._fault(
                numbers[row],
                f"time {time[row]:.9g} s does not come after {earlier[row]:.9g} s, put the rows in"
                " order of time",
            )
        for name in filter(RANGES.__contains__, self.columns):
            low, high = RANGES[name]
            cells = table[:, self.columns.index(name)]
            row, _ = _where(((cells < low) | (cells > high))[:, None])
            if row is not None:
                raise self._fault(
                    numbers[row],
                    f"{name} {cells[row]:.9g} is not allowed, give one from {low:g} to {high:g}",
                )
        if self.position in (EARTH_FIXED, LOCAL):
            height = self._places(table)[2]
            row, _ = _where(((height < MIN_HEIGHT) | (height > MAX_HEIGHT))[:, None])
            if row is not None:
                raise self._fault(
                    numbers[row],
                    f"{','.join(self.position)} is {height[row]:.6g} m over the ellipsoid, give"
                    f" metres from {MIN_HEIGHT:g} to {MAX_HEIGHT:g} over it",
                )
        if self.attitude == QUATERNION:
            length = np.linalg.norm(self._part(table, QUATERNION, 4), axis=1)
            row, _ = _where((np.abs(length - 1) > UNIT)[:, None])
            if row is not None:
                raise self._fault(
                    numbers[row], f"the quaternion has length {length[row]:.7g}, give length 1"
                )

    def _part(self, table: Array, group: tuple[str, ...], width: int) -> Array:
        """The columns of a group, NaN where the file does not tell them."""
        if not group:
            return np.full((len(table), width), np.nan)
        first = self.columns.index(group[0])
        return table[:, first : first + width]

    def history(self, table: Array) -> NavHistory:
        """Rows as states."""
        attitude = self._part(table, self.attitude, 4 if self.attitude != EULER else 3)
        if self.attitude == EULER:
            q = from_euler_rows(np.radians(attitude))
        else:
            q = attitude / np.linalg.norm(attitude, axis=1, keepdims=True)
        lat, lon, h = self._places(table)
        return NavHistory(
            time=table[:, 0],
            v=self._part(table, self.velocity, 3),
            lat=lat,
            lon=lon,
            h=h,
            q=q,
        )

    def _places(self, table: Array) -> tuple[Array, Array, Array]:
        """Geodetic latitude, longitude (rad) and height (m)."""
        a, b, c = self._part(table, self.position, 3).T
        if self.position == EARTH_FIXED:
            return geodetic(a, b, c)
        if self.position == LOCAL and self.place is not None:
            return from_local(self.place, a, b, c)
        return np.radians(a), np.radians(b - 360 * np.round(b / 360)), c

    def _fault(self, line: int | np.int64, what: str) -> InputError:
        return InputError(f"{self.name}: {self.unit} {line}: {what}")


def _where(bad: NDArray[np.bool_]) -> tuple[int | None, int]:
    """Row and column of the first fault; row None if there is none."""
    if not bad.any():
        return None, 0
    row, column = divmod(int(np.argmax(bad)), bad.shape[1])
    return row, column
