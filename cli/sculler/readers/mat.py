"""MATLAB's MAT files and HDF5 files: a matrix with a sample a row, or an array for each sensor.

A matrix is named by `--variable`, its columns by number.  Arrays are named by `--gyro-columns` and
its like, as `gyro`, as `imu.gyro` in a structure, or as `gyro:2,gyro:3,gyro:4` where a matrix has
other columns too; or found by their names, if there is one of each.  Stamps are seconds unless the
user says otherwise.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sculler.readers.apart import open_arrays, told
from sculler.readers.format import COLUMNS, Format, Request, begins
from sculler.readers.named import read_named
from sculler.readers.recording import Recording
from sculler_model.errors import InputError

_SMALL = 64  # elements of what may be a vector of biases


def read_mat(path: Path, request: Request) -> Recording:
    """The samples of a MAT or HDF5 file, loaded whole.

    Raises:
        InputError: the library is absent, the file is at fault, or has no such arrays; the message
            lists what it has.
    """
    with open_arrays(path, _enough(request)) as arrays:
        recording = read_named(arrays, request, whole_is_ns=False)
    request.advance(path.stat().st_size)
    return recording


def _enough(request: Request) -> list[str]:
    """The variables that the user names, if these are all that are needed."""
    if request.variable is not None:
        names = [request.variable]
    elif request.gyro_names is not None and request.accel_names is not None:
        names = [*request.gyro_names, *request.accel_names]
        if request.time is None:
            return []
    else:
        return []
    if request.time is not None and not request.time.isdecimal():
        names.append(request.time)
    tops = {name.rpartition(":")[0] or name for name in names}
    return sorted({name.partition(".")[0].partition("(")[0] for name in tops})


def mat_vector(path: Path, variable: str) -> tuple[float, float, float]:
    """A vector of three numbers of a MAT file.

    Raises:
        InputError: as `read_mat`, or the variable is no such vector.
    """
    stat = path.stat() if path.exists() else None
    vectors, listed = _small(path, None if stat is None else (stat.st_mtime_ns, stat.st_size))
    if variable not in vectors:
        raise InputError(
            f"{path}: no variable {variable!r} with a vector of three numbers; the file has"
            f" {listed}"
        )
    value = vectors[variable]
    if value.size != 3 or not np.isfinite(value).all():
        raise InputError(f"{path}: {variable} is not a vector of three finite numbers")
    x, y, z = value.astype(np.float64).ravel().tolist()
    return x, y, z


@lru_cache(maxsize=1)
def _small(path: Path, version: object) -> tuple[dict[str, NDArray[np.generic]], str]:
    """The small arrays of real numbers, and what the file holds; kept while it does not change."""
    with open_arrays(path) as arrays:
        few = [
            name
            for name, shape in arrays.listing.items()
            if shape.is_real and int(np.prod(shape.shape)) <= _SMALL
        ]
        return {name: arrays[name] for name in few}, told(arrays.listing)


def mat_columns(path: Path) -> dict[str, NDArray[np.float64]]:
    """The vectors of real numbers of a MAT file by their names, each (N,).

    Raises:
        InputError: the library is absent, or the file is at fault.
    """
    with open_arrays(path) as arrays:
        return {
            name: arrays[name].astype(np.float64).ravel()
            for name, shape in arrays.listing.items()
            if shape.is_real and len(shape.shape) == 2 and 1 in shape.shape
        }


_OPTIONS = COLUMNS | {"variable"}
FORMATS = (
    Format(
        "mat",
        "MATLAB's MAT files, a matrix or an array for each sensor",
        read_mat,
        _OPTIONS,
        begins(b"MATLAB "),
        (".mat",),
    ),
    Format(
        "hdf5",
        "HDF5 files, likewise",
        read_mat,
        _OPTIONS,
        begins(b"\x89HDF\r\n\x1a\n"),
        (".h5", ".hdf5"),
    ),
)
