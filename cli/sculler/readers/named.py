"""Samples from a file of named arrays, loaded whole."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sculler.formats.log import COUNTS, FAULT
from sculler.readers.array_choice import Choice, Column, Source
from sculler.readers.delimited import flags
from sculler.readers.format import Request
from sculler.readers.recording import (
    ACCEL_UNITS,
    GYRO_UNITS,
    Clock,
    Recording,
    Samples,
    require_finite,
)
from sculler_model.errors import InputError

_RADIANS = ("dtheta",)  # names that say a unit
_METRES = ("dvel",)
_CHUNK_ROWS = 1 << 15


def read_named(source: Source, request: Request, whole_is_ns: bool) -> Recording:
    """The samples in named arrays, loaded whole.

    Args:
        source: the arrays.
        request: which of them, and their units, where it says so.
        whole_is_ns: stamps of whole numbers are ns, if nothing says otherwise; else s.

    Raises:
        InputError: the arrays are not there, or not of one length; names what is.
    """
    found = Choice(source, request)
    path = source.path
    units = (
        found.unit("gyro", request.gyro, GYRO_UNITS, "rad", _RADIANS, request.gyro_scale),
        found.unit("accel", request.accel, ACCEL_UNITS, "m/s", _METRES, request.accel_scale),
    )
    loaded = {column.name: source[column.name] for column in found.columns}
    columns = [_values(loaded[column.name], column) for column in found.samples]
    rows = len(columns[0])
    stamps = None if found.time is None else _values(loaded[found.time.name], found.time)
    faults = None
    if found.fault is not None:
        fault = _values(loaded[found.fault.name], found.fault)
        faults = flags(path, FAULT, fault.astype(np.float64))
    others = [
        *zip(columns, found.samples, strict=True),
        (stamps, found.time),
        (faults, found.fault),
    ]
    for array, column in others:
        if array is not None and column is not None and len(array) != rows:
            raise InputError(
                f"{path}: {column.name} has {len(array)} rows and {found.samples[0].name} {rows},"
                " give as many"
            )
    if not rows:
        raise InputError(f"{path}: {found.samples[0].name} has no rows, give samples")
    clock = None
    notes = {"columns": found.told()}
    if stamps is not None:
        assert found.time is not None
        clock = Clock(found.time_unit(stamps, whole_is_ns))
        notes["time stamps"] = f"{found.time}, {clock.unit}{_coarse(stamps, clock.unit)}"

    def chunks() -> Iterator[Samples]:
        for first in range(0, rows, _CHUNK_ROWS):
            part = slice(first, first + _CHUNK_ROWS)
            values = np.column_stack([column[part] for column in columns]).astype(np.float64)
            _require_finite(path, found, first, values)
            times = None
            if clock is not None and stamps is not None:
                require_finite(path, first, stamps[part, None], (str(found.time),))
                times = clock(exact(path, stamps[part]))
            yield Samples(values, None if faults is None else faults[part], times)

    return Recording(*units, chunks(), faults is not None, clock, notes)


def _require_finite(path: Path, found: Choice, first: int, values: NDArray[np.float64]) -> None:
    bad = ~np.isfinite(values)
    if bad.any() and found.matrix is not None:
        row, at = (int(i) for i in np.argwhere(bad)[0])
        place = found.samples[at].place
        assert place is not None
        raise InputError(
            f"{path}: {found.samples[at].name}({first + row + 1}, {place + 1}) is"
            f" {values[row, at]}, give a finite number"
        )
    require_finite(path, first, values, COUNTS)


def exact(path: Path, stamps: NDArray[Any]) -> NDArray[np.int64] | NDArray[np.float64]:
    """Stamps by their value and without loss: whole numbers stay whole.

    Raises:
        InputError: a whole number is too large for any clock.
    """
    if stamps.dtype.kind not in "iu":
        return stamps.astype(np.float64)
    if len(stamps) and int(stamps.max()) > 2**63 - 1:
        raise InputError(f"{path}: a stamp is {int(stamps.max())}, more than any clock shows")
    return stamps.astype(np.int64)


def _coarse(stamps: NDArray[Any], unit: str) -> str:
    """What is to be said of stamps in short floats."""
    if stamps.dtype.kind != "f" or stamps.dtype.itemsize > 4 or not len(stamps):
        return ""
    step = float(np.spacing(np.abs(stamps[np.isfinite(stamps)]).max(initial=0)))
    return f" (float{8 * stamps.dtype.itemsize}: in steps of {step:.3g} {unit})"


def _values(array: NDArray[Any], column: Column) -> NDArray[Any]:
    """The numbers (N,) of a column."""
    if column.place is None:
        return array.reshape(-1)
    return array[column.place] if column.lies else array[:, column.place]
