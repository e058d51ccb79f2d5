"""Truth files: the true states of a run, or a reference's, in columns that have names.

As CSV the header names them; in an `.npz` or MAT file each is an array of its own, in a Parquet
file a column.  They may stand in any order, and others are passed over:

    time_s                              seconds on the log's own clock, running forwards
    q_w,q_x,q_y,q_z                     attitude, body (forward, right, down) to north-east-down
      or roll_deg,pitch_deg,heading_deg   the same as Euler angles; the quaternion goes first
    v_north,v_east,v_down               velocity over the Earth, m/s
    lat_deg,lon_deg,height_m            geodetic, over the WGS-84 ellipsoid
      or x_m,y_m,z_m                    Earth-fixed: x to latitude and longitude 0, z to the pole

Attitude, velocity and position may each be left out, and are NaN in the states then; a row with
NaN, or with no value, in one of the columns is passed over.  `sculler motion` writes them all, and
so does `sculler navigate`, whose output may serve as truth; so may frames of telemetry.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from sculler.formats import telemetry
from sculler.formats.tables import Block, TableReader
from sculler.formats.tables.npz import NpzReader, damage_told
from sculler.formats.tables.parquet import ParquetReader
from sculler.formats.truth_columns import KNOWN, Layout
from sculler.readers.mat import mat_columns
from sculler_model.errors import InputError
from sculler_model.frames import Vector
from sculler_model.inputs import require_file
from sculler_model.navigation import NavHistory
from sculler_model.outputs import open_blocks

Array = NDArray[np.float64]


def read_truth(
    path: str | Path,
    advance: Callable[[int], None] | None = None,
    passed_over: Callable[[int], None] | None = None,
    place: Vector | None = None,
    columns: Callable[[tuple[str, ...]], None] | None = None,
) -> Iterator[NavHistory]:
    """Stream a truth file's states.

    Args:
        path: the file.
        advance: told the rows read.
        passed_over: told how many of them were passed over because of NaN.
        place: that local metres (north_m,east_m,up_m, in the tangent plane) start from: latitude,
            longitude (rad), height (m); None where they are not read.
        columns: told which ones are read.

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
            yield from _states(*_of_arrays(path, tables, place), advance, passed_over, columns)
            return
        with open_blocks(path) as file:
            yield from _states(*_of_text(file, path, place), advance, passed_over, columns)
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
    layout: Layout,
    blocks: Iterator[Array],
    advance: Callable[[int], None] | None,
    passed_over: Callable[[int], None] | None,
    columns: Callable[[tuple[str, ...]], None] | None,
) -> Iterator[NavHistory]:
    """A file's rows as states, checked; there must be some."""
    if columns is not None:
        columns(layout.columns)
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


def _of_arrays(
    path: Path, tables: Callable[[Path], Tables], place: Vector | None
) -> tuple[Layout, Iterator[Array]]:
    """Layout and rows of a file of named arrays."""
    names, blocks = tables(path)
    layout = Layout(str(path), names, "row", place)
    return layout, layout.from_arrays(blocks)


def _of_text(file: BinaryIO, path: Path, place: Vector | None) -> tuple[Layout, Iterator[Array]]:
    """Layout and rows of a CSV."""
    header = file.readline().decode("utf-8-sig")
    if not header.strip():
        raise InputError(f"{path}: the truth is empty, give a header and rows")
    layout = Layout(str(path), [column.strip() for column in header.split(",")], "line", place)
    return layout, layout.from_text(file, path.stat().st_size)
