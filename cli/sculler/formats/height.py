"""A measured height as a file: a CSV with the columns `time_s` and `height_m`."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from sculler.readers.text import Column, number_rows, open_text
from sculler.words import silent
from sculler_model.errors import InputError
from sculler_model.navigation import HeightReference

COLUMNS = ("time_s", "height_m")
"""In any order; others are passed over, so that a truth or a run's states serve too."""


def read_height_reference(path: Path, lag: float = 0.0, noise: float = 0.0) -> HeightReference:
    """The reference that a CSV tells.

    Args:
        path: its rows are in order of time, which is on the log's own clock.
        lag, noise: as of `HeightReference`.

    Raises:
        InputError: it cannot be read, lacks a column, or its numbers are not allowed.
    """
    if not path.is_file():
        raise InputError(f"--height-reference {path}: no such file, give a CSV with {COLUMNS[1]}")
    with open_text(path) as file:
        names = [name.strip() for name in file.readline(10_000).rstrip("\n").split(",")]
        missing = [name for name in COLUMNS if name not in names]
        if missing:
            raise InputError(f"{path}: no column {missing[0]}, give the header {','.join(COLUMNS)}")
        columns = [Column(name, names.index(name)) for name in COLUMNS]
        parts = [rows.values for rows in number_rows(file, path, 2, columns, ",", silent)]
    times, heights = np.concatenate(parts).T
    try:
        return HeightReference(times, heights, lag=lag, noise=noise)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
