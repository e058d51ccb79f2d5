"""MATLAB's MAT files (up to version 7): one matrix, a sample a row, columns by number."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sculler.readers import Advance, Clock, Recording, Samples, Unit
from sculler_model.errors import InputError

_CHUNK_ROWS = 1 << 16


def read_mat(
    path: Path,
    variable: str | None,
    columns: Sequence[int],
    time: int | None,
    gyro: Unit,
    accel: Unit,
    time_unit: str,
    advance: Advance,
) -> Recording:
    """A variable of a MAT file.

    Args:
        path: the file.
        variable: its name.
        columns: six column numbers (from 1), gyro x, y, z, accelerometer x, y, z.
        time: number of the time column, or None.
        gyro, accel: the units.
        time_unit: of the time column, of `TIME_UNITS`.
        advance: told the bytes read: the whole file, once it is loaded.

    Raises:
        InputError: scipy is absent, the file is no MAT file or of version 7.3, or there is no such
            matrix.
    """
    matrix = _matrix(path, variable)
    wanted = [*columns, *([] if time is None else [time])]
    for column in wanted:
        if not 1 <= column <= matrix.shape[1]:
            raise InputError(
                f"{path}: {variable} has columns 1 to {matrix.shape[1]}, not {column}; give"
                " --gyro-columns and --accel-columns"
            )
    advance(path.stat().st_size)
    clock = None if time is None else Clock(time_unit)
    notes = {"columns": f"{variable}: " + ", ".join(map(str, columns))}
    if time is not None:
        notes["time stamps"] = f"column {time}, {time_unit}"

    def chunks() -> Iterator[Samples]:
        for first in range(0, len(matrix), _CHUNK_ROWS):
            part = matrix[first : first + _CHUNK_ROWS, [column - 1 for column in wanted]]
            if not np.isfinite(part).all():
                row, at = (int(i) for i in np.argwhere(~np.isfinite(part))[0])
                raise InputError(
                    f"{path}: {variable}({first + row + 1}, {wanted[at]}) is"
                    f" {part[row, at]}, give a finite number"
                )
            times = None if clock is None else clock(part[:, len(columns)])
            yield Samples(part[:, : len(columns)], times=times)

    return Recording(gyro, accel, chunks(), clock=clock, notes=notes)


def mat_vector(path: Path, variable: str) -> tuple[float, float, float]:
    """A vector of three numbers of a MAT file.

    Raises:
        InputError: as `read_mat`, or the variable is no such vector.
    """
    matrix = _matrix(path, variable)
    if matrix.size != 3 or not np.isfinite(matrix).all():
        raise InputError(f"{path}: {variable} is not a vector of three finite numbers")
    x, y, z = matrix.ravel().tolist()
    return x, y, z


def mat_columns(path: Path) -> dict[str, NDArray[np.float64]]:
    """The vectors of real numbers of a MAT file by their names, each (N,).

    Raises:
        InputError: scipy is absent, or the file is no MAT file or of version 7.3.
    """
    return {
        name: value.astype(np.float64).ravel()
        for name, value in _load(path, None).items()
        if _is_matrix(value) and 1 in value.shape
    }


def _matrix(path: Path, variable: str | None) -> NDArray[np.float64]:
    """The variable as a matrix of floats."""
    if variable is None:
        raise InputError(f"{path}: give --variable, one of {', '.join(_load(path, None))}")
    variables = _load(path, variable)
    if variable not in variables:
        raise InputError(
            f"{path}: no variable {variable!r}, give --variable, one of"
            f" {', '.join(_load(path, None))}"
        )
    value = variables[variable]
    if not _is_matrix(value):
        raise InputError(f"{path}: {variable} is not a matrix of real numbers, give another")
    if not len(value):
        raise InputError(f"{path}: {variable} has no rows, give samples")
    matrix: NDArray[np.float64] = value.astype(np.float64)
    return matrix


def _is_matrix(value: Any) -> bool:
    return isinstance(value, np.ndarray) and value.ndim == 2 and value.dtype.kind in "iuf"


def _load(path: Path, variable: str | None) -> dict[str, Any]:
    """A variable of the file, or all of them."""
    try:
        from scipy.io import loadmat
        from scipy.io.matlab import MatReadError
    except ImportError as error:
        raise InputError(
            f"{path}: reading MAT files needs scipy, run: pip install 'sculler[formats]'"
        ) from error
    try:
        found = loadmat(path, variable_names=None if variable is None else [variable])
    except NotImplementedError as error:
        raise InputError(
            f"{path}: a MAT file of version 7.3, save it again with MATLAB's save -v7"
        ) from error
    except OSError as error:
        if error.strerror is None:  # scipy's own
            raise _not_whole(path, error) from error
        raise InputError(
            f"{path}: cannot read the log ({error.strerror}), check the path"
        ) from error
    except (MatReadError, ValueError, TypeError, KeyError, struct.error, zlib.error) as error:
        raise _not_whole(path, error) from error
    return {name: value for name, value in found.items() if not name.startswith("__")}


def _not_whole(path: Path, error: Exception) -> InputError:
    return InputError(f"{path}: not a whole MAT file ({error}), write it again")
