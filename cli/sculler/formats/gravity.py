"""Models of gravity as a user names them, and tables of it as CSV."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sculler.readers.text import Column, number_rows, open_text
from sculler.words import silent
from sculler_model.errors import InputError
from sculler_model.navigation import NORMAL, Gravity, constant_gravity, table_of_gravity

COLUMNS = ("lat_deg", "height_m", "gravity")
"""Of a table."""

_MOST_POINTS = 1_000_000

Array = NDArray[np.float64]


def gravity_model(text: str) -> Gravity:
    """The model that a text asks for: `normal`, `constant`, `constant:G` or a table's path.

    Raises:
        InputError: it is none of them, or the table has a fault.
    """
    if text == "normal":
        return NORMAL
    if text == "constant":
        return constant_gravity()
    if text.startswith("constant:"):
        try:
            value = float(text.removeprefix("constant:"))
        except ValueError:
            raise InputError(
                f"--gravity {text}: not a number, give m/s² as in constant:9.81"
            ) from None
        return constant_gravity(value)
    return read_gravity_table(Path(text))


def read_gravity_table(path: Path) -> Gravity:
    """Gravity at the points of a CSV with the columns `COLUMNS`, in any order of rows.

    The points are all pairs of some latitudes and some heights; one latitude is a profile over
    height, one point a measured local gravity.

    Raises:
        InputError: it cannot be read, is not such a grid, or its values are no gravity.
    """
    if not path.is_file():
        raise InputError(
            f"--gravity {path}: no such file, give one, or normal, constant or constant:9.81"
        )
    lats, heights, grid = _grid(path, *_points(path).T)
    try:
        return table_of_gravity(np.radians(lats), heights, grid)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def _points(path: Path) -> Array:
    """(P, 3) latitude, height and gravity of each row."""
    with open_text(path) as file:
        names = [name.strip() for name in file.readline(1000).rstrip("\n").split(",")]
        missing = [name for name in COLUMNS if name not in names]
        if missing:
            raise InputError(f"{path}: no column {missing[0]}, give the header {','.join(COLUMNS)}")
        columns = [Column(name, names.index(name)) for name in COLUMNS]
        parts: list[Array] = []
        for rows in number_rows(file, path, 2, columns, ",", silent):
            parts.append(rows.values)
            if sum(map(len, parts)) > _MOST_POINTS:
                raise InputError(f"{path}: more than {_MOST_POINTS:,} points, give fewer")
    return np.concatenate(parts)


def _grid(path: Path, lat: Array, height: Array, value: Array) -> tuple[Array, Array, Array]:
    """The points as latitudes, heights and the values at every pair of them."""
    lats, i = np.unique(lat, return_inverse=True)
    heights, j = np.unique(height, return_inverse=True)
    if len(lats) * len(heights) > _MOST_POINTS:
        raise InputError(f"{path}: more than {_MOST_POINTS:,} points in the grid, give fewer")
    counts = np.zeros((len(lats), len(heights)), np.int64)
    np.add.at(counts, (i, j), 1)
    if (counts != 1).any():
        row, column = np.argwhere(counts != 1)[0]
        word = "missing" if counts[row, column] == 0 else "there more than once"
        raise InputError(
            f"{path}: the point at latitude {lats[row]:g}°, height {heights[column]:g} m is {word};"
            " give every pair of the latitudes and heights once"
        )
    grid = np.empty(counts.shape)
    grid[i, j] = value
    return lats, heights, grid
