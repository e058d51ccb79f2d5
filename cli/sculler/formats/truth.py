"""Truth files: the true states of a run, or a reference's, in columns that have names.

As CSV the header names them; in an `.npz` or MAT file each is an array of its own, in a Parquet
file a column.  They may stand in any order, and others are passed over:

    time_s                              seconds on the log's own clock, running forwards
    q_w,q_x,q_y,q_z                     attitude, body (forward, right, down) to north-east-down
      or roll_deg,pitch_deg,heading_deg   the same as Euler angles; the quaternion goes first
    v_north,v_east,v_down               velocity over the Earth, m/s
    lat_deg,lon_deg,height_m            geodetic, over the WGS-84 ellipsoid

Attitude, velocity and position may each be left out, and are NaN in the states then; a row with
NaN, or with no value, in one of the columns is passed over.  `sculler motion` writes them all, and
so does `sculler navigate`, whose output may serve as truth; so may frames of telemetry.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import closing
from io import StringIO
from pathlib import Path
from typing import BinaryIO, Literal

import numpy as np
from numpy.typing import NDArray

from sculler.formats import lines, telemetry
from sculler.formats.compiled import Kernels, kernels
from sculler.formats.tables import Block, TableReader
from sculler.formats.tables.npz import NpzReader, damage_told
from sculler.formats.tables.parquet import ParquetReader
from sculler.readers.mat import mat_columns
from sculler_model.errors import InputError
from sculler_model.frames import from_euler
from sculler_model.inputs import require_file
from sculler_model.navigation import MAX_HEIGHT, MIN_HEIGHT, NavHistory
from sculler_model.outputs import open_blocks

Array = NDArray[np.float64]

QUATERNION = ("q_w", "q_x", "q_y", "q_z")
EULER = ("roll_deg", "pitch_deg", "heading_deg")
VELOCITY = ("v_north", "v_east", "v_down")
POSITION = ("lat_deg", "lon_deg", "height_m")
TIME = "time_s"
KNOWN = {TIME, *VELOCITY, *POSITION, *QUATERNION, *EULER}

RANGES = {
    "lat_deg": (-90.0, 90.0),
    "lon_deg": (-360.0, 360.0),
    "height_m": (MIN_HEIGHT, MAX_HEIGHT),
    **dict.fromkeys(("v_north", "v_east", "v_down"), (-100000.0, 100000.0)),
    **dict.fromkeys(QUATERNION, (-2.0, 2.0)),
}
"""What is on or near the Earth, at speeds that stay there."""

BLOCK = 20_000
"""Rows of arrays looked at together."""

_BLOCKS = 8  # of `lines.BLOCK_BYTES` read at a time: rows are long

UNIT = 1e-6
"""How far from 1 the length of a quaternion may be."""


def read_truth(
    path: str | Path,
    advance: Callable[[int], None] | None = None,
    passed_over: Callable[[int], None] | None = None,
) -> Iterator[NavHistory]:
    """Stream a truth file's states.

    Args:
        path: the file.
        advance: told the rows read.
        passed_over: told how many of them were passed over because of NaN.

    Yields:
        States, times running forwards; NaN in what the file does not tell.

    Raises:
        InputError: the file cannot be read or has a fault; names file, line and column.
    """
    path = Path(path)
    require_file(path, "truth")
    try:
        with path.open("rb") as binary:
            begins = binary.read(8)
        tables = next((read for magic, read in _TABLES if begins.startswith(magic)), None)
        if tables is not None:
            yield from _states(*_of_arrays(path, tables), advance, passed_over)
            return
        with open_blocks(path) as file:
            yield from _states(*_of_text(file, path), advance, passed_over)
    except OSError as error:
        raise InputError(
            f"{path}: cannot read the truth ({error.strerror}), check the path"
        ) from error
    except UnicodeDecodeError as error:
        raise InputError(
            f"{path}: not a text file in UTF-8, give a CSV, npz, MAT or Parquet truth file"
        ) from error


Tables = tuple[list[str], Iterator[Block]]
"""Names of all columns, and the columns, block by block."""


def _npz(path: Path) -> Tables:
    with damage_told(path):
        return _streamed(NpzReader(path))


def _parquet(path: Path) -> Tables:
    return _streamed(ParquetReader(path))


def _streamed(table: TableReader) -> Tables:
    """The columns of a file that is read block by block."""

    def blocks() -> Iterator[Block]:
        with closing(table):
            yield from table.blocks([name for name in table.names if name in KNOWN])

    return list(table.names), blocks()


def _mat(path: Path) -> Tables:
    columns = mat_columns(path)
    return list(columns), iter([columns])


_TABLES = (
    (b"PK\x03\x04", _npz),
    (b"MATLAB ", _mat),
    (b"PAR1", _parquet),
    (telemetry.BEGINNING, telemetry.telemetry_columns),
)
"""How such files begin, and what reads them."""


def _states(
    layout: _Layout,
    blocks: Iterator[Array],
    advance: Callable[[int], None] | None,
    passed_over: Callable[[int], None] | None,
) -> Iterator[NavHistory]:
    """A file's rows as states, checked; there must be some."""
    number, before, whole = layout.first, -np.inf, 0
    for table in blocks:
        numbers = np.arange(number, number + len(table))
        number += len(table)
        good = ~np.isnan(table).any(axis=1)
        rows = table[good]
        if advance is not None:
            advance(len(table))
        if passed_over is not None and len(rows) < len(table):
            passed_over(len(table) - len(rows))
        if not len(rows):
            continue
        layout.check(rows, numbers[good], before)
        before = float(rows[-1, 0])
        whole += len(rows)
        yield layout.history(rows)
    if number == layout.first:
        raise InputError(f"{layout.name}: the truth has no rows, give one for every instant")
    if not whole:
        raise InputError(
            f"{layout.name}: every row of the truth has NaN, give numbers, or leave out the"
            f" columns that have none ({', '.join(layout.columns[1:])} are read)"
        )


def _of_arrays(path: Path, tables: Callable[[Path], Tables]) -> tuple[_Layout, Iterator[Array]]:
    """Layout and rows of a file of named arrays."""
    names, blocks = tables(path)
    layout = _Layout(str(path), names, "row")
    return layout, layout.from_arrays(blocks)


def _of_text(file: BinaryIO, path: Path) -> tuple[_Layout, Iterator[Array]]:
    """Layout and rows of a CSV."""
    header = file.readline().decode("utf-8-sig")
    if not header.strip():
        raise InputError(f"{path}: the truth is empty, give a header and rows")
    layout = _Layout(str(path), [column.strip() for column in header.split(",")], "line")
    return layout, layout.from_text(file, path.stat().st_size)


class _Layout:
    """What the columns' names say about a file's rows.

    Args:
        name: of the file.
        names: of its columns.
        unit: what messages count: a `line` of text or a `row` of arrays.

    Attributes:
        first: number of the first row, the header being line 1.
    """

    def __init__(self, name: str, names: list[str], unit: Literal["line", "row"]) -> None:
        self.name, self.unit = name, unit
        self.first = 2 if unit == "line" else 1
        where = f"{name}: line 1" if unit == "line" else name
        self.attitude, self.velocity, self.position = (
            self._group(where, names, *groups)
            for groups in ((QUATERNION, EULER), (VELOCITY,), (POSITION,))
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
            angles = np.radians(attitude).tolist()
            q = np.array([from_euler(roll, pitch, heading) for roll, pitch, heading in angles])
        else:
            q = attitude / np.linalg.norm(attitude, axis=1, keepdims=True)
        lat, lon, h = self._part(table, self.position, 3).T
        return NavHistory(
            time=table[:, 0],
            v=self._part(table, self.velocity, 3),
            lat=np.radians(lat),
            lon=np.radians(lon - 360 * np.round(lon / 360)),
            h=h,
            q=q,
        )

    def _fault(self, line: int | np.int64, what: str) -> InputError:
        return InputError(f"{self.name}: {self.unit} {line}: {what}")


def _where(bad: NDArray[np.bool_]) -> tuple[int | None, int]:
    """Row and column of the first fault; row None if there is none."""
    if not bad.any():
        return None, 0
    row, column = divmod(int(np.argmax(bad)), bad.shape[1])
    return row, column
