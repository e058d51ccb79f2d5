"""Columns as named arrays: NumPy's `.npz` and Apache Parquet.

An `.npz` file holds the arrays

* `gyro` (or `gyr`, `angular_velocity`, `dtheta`) and `accel` (or `acc`, `linear_acceleration`,
  `dvel`), each (N, 3);
* optionally `time` (or `t`, `timestamp`, `timestamps`), (N,): whole numbers count ns, others s;
* optionally `fault`, (N,) of 0 and 1;
* optionally the strings `gyro_unit`, `accel_unit`, `time_unit`, as the options of `convert` name
  them; `dtheta` is in rad and `dvel` in m/s unless they say otherwise.

A Parquet file has a column for each axis, named as in CSV.
"""

from __future__ import annotations

import zipfile
import zlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sculler.logs import COUNTS, FAULT
from sculler.readers import (
    ACCEL_UNITS,
    GYRO_UNITS,
    TIME_UNITS,
    Advance,
    Clock,
    Recording,
    Samples,
    Unit,
)
from sculler.readers.columns import headed, recognise
from sculler.readers.delimited import fault_flags
from sculler_model.errors import InputError

_GYRO_NAMES = ("gyro", "gyr", "angular_velocity", "dtheta")
_ACCEL_NAMES = ("accel", "acc", "linear_acceleration", "dvel")
_TIME_NAMES = ("time", "t", "timestamp", "timestamps")
_CHUNK_ROWS = 1 << 15


def read_npz(
    path: Path, gyro: Unit | None, accel: Unit | None, time_unit: str | None, advance: Advance
) -> Recording:
    """The arrays of an `.npz` file, loaded whole; units given here go before those of the file.

    Raises:
        InputError: the file cannot be read, or lacks an array or a unit, or an array has another
            shape.
    """
    arrays = npz_arrays(path)
    advance(path.stat().st_size)
    names = {
        what: _only(path, arrays, known)
        for what, known in (("gyro", _GYRO_NAMES), ("accel", _ACCEL_NAMES), ("time", _TIME_NAMES))
    }
    missing = [what for what in ("gyro", "accel") if names[what] is None]
    if missing:
        raise InputError(
            f"{path}: no array {missing[0]!r}, the file has {', '.join(arrays)[:200]}; name it so"
        )
    gyro = gyro or _npz_unit(path, arrays, "gyro", GYRO_UNITS, "rad", names["gyro"] == "dtheta")
    accel = accel or _npz_unit(path, arrays, "accel", ACCEL_UNITS, "m/s", names["accel"] == "dvel")
    triples = [_npz_array(path, arrays, names[what], 3) for what in ("gyro", "accel")]
    rows = len(triples[0])
    clock, stamps, faults = None, None, None
    if names["time"] is not None:
        stamps = _npz_array(path, arrays, names["time"], None)
        named = str(arrays["time_unit"]) if "time_unit" in arrays else None
        unit = time_unit or named or ("ns" if stamps.dtype.kind in "iu" else "s")
        if unit not in TIME_UNITS:
            raise InputError(f"{path}: time_unit {unit!r} is not one of {', '.join(TIME_UNITS)}")
        clock = Clock(unit)
    if FAULT in arrays:
        faults = fault_flags(path, _npz_array(path, arrays, FAULT, None).astype(np.float64))
    for array, what in ((triples[1], names["accel"]), (stamps, names["time"]), (faults, FAULT)):
        if array is not None and len(array) != rows:
            raise InputError(
                f"{path}: {what} has {len(array)} rows and {names['gyro']} {rows}, give as many"
            )
    notes = {"columns": ", ".join(name for name in names.values() if name is not None)}

    def chunks() -> Iterator[Samples]:
        for first in range(0, rows, _CHUNK_ROWS):
            part = slice(first, first + _CHUNK_ROWS)
            values = np.hstack([triple[part] for triple in triples]).astype(np.float64)
            require_finite(path, first, values, COUNTS)
            times = None
            if clock is not None and stamps is not None:
                require_finite(path, first, stamps[part, None], ("time",))
                times = clock(_exact(stamps[part]))
            yield Samples(values, None if faults is None else faults[part], times)

    return Recording(gyro, accel, chunks(), faults is not None, clock, notes)


def require_finite(path: Path, first: int, values: NDArray[Any], names: Sequence[str]) -> None:
    """Refuse a value that is not finite.

    Args:
        path: for the message.
        first: number of the first sample.
        values: (N, columns).
        names: of the columns.

    Raises:
        InputError: names the first such value.
    """
    bad = ~np.isfinite(values)
    if bad.any():
        row, at = (int(i) for i in np.argwhere(bad)[0])
        raise InputError(
            f"{path}: sample {first + row}: {names[at]} is {values[row, at]}, give a finite number"
        )


def _exact(stamps: NDArray[Any]) -> NDArray[np.int64] | NDArray[np.float64]:
    """Stamps without loss: whole numbers stay whole."""
    whole = stamps.dtype.kind in "iu"
    return stamps.astype(np.int64) if whole else stamps.astype(np.float64)


def npz_arrays(path: Path) -> dict[str, NDArray[Any]]:
    """The arrays of an `.npz` file by their names.

    Raises:
        InputError: the file cannot be read, or is no whole `.npz` file.
    """
    try:
        with path.open("rb") as file:
            arrays = np.load(file, allow_pickle=False)
            if not isinstance(arrays, np.lib.npyio.NpzFile):
                raise InputError(f"{path}: one array without names, save it with numpy.savez")
            with arrays:
                return dict(arrays)
    except OSError as error:
        raise InputError(
            f"{path}: cannot read the log ({error.strerror or error}), check the path"
        ) from error
    except (  # RuntimeError: encrypted, or (its child) compressed in a way nobody knows
        ValueError,
        EOFError,
        KeyError,
        RuntimeError,
        zipfile.BadZipFile,
        zlib.error,
    ) as error:
        raise InputError(f"{path}: not a whole .npz file ({error}), write it again") from error


def _only(path: Path, arrays: Mapping[str, Any], known: Sequence[str]) -> str | None:
    found = [name for name in known if name in arrays]
    if len(found) > 1:
        raise InputError(f"{path}: arrays {' and '.join(found)} are both there, keep one")
    return found[0] if found else None


def _npz_array(
    path: Path, arrays: Mapping[str, NDArray[Any]], name: str | None, columns: int | None
) -> NDArray[Any]:
    assert name is not None
    array = arrays[name]
    shape = "(N,)" if columns is None else f"(N, {columns})"
    fits = array.ndim == 1 if columns is None else array.shape[1:] == (columns,)
    if array.dtype.kind not in "iufb" or not fits:
        raise InputError(
            f"{path}: {name} is of type {array.dtype} and shape {array.shape}, give numbers of"
            f" shape {shape}"
        )
    if not len(array):
        raise InputError(f"{path}: {name} has no rows, give samples")
    return array


def _npz_unit(
    path: Path,
    arrays: Mapping[str, NDArray[Any]],
    sensor: str,
    known: Mapping[str, Unit],
    usual: str,
    is_increment: bool,
) -> Unit:
    key = f"{sensor}_unit"
    if key in arrays:
        name = str(arrays[key])
        if name not in known:
            raise InputError(f"{path}: {key} {name!r} is not known, give {', '.join(known)}")
        return known[name]
    if is_increment:
        return known[usual]
    raise InputError(
        f"{path}: the unit of {sensor} is not given, give --{sensor}-unit, one of"
        f" {', '.join(known)}"
    )


def read_parquet(
    path: Path,
    columns: Sequence[str] | None,
    time: str | None,
    time_unit: str | None,
    gyro: Unit | None,
    accel: Unit | None,
    advance: Advance,
) -> Recording:
    """A Parquet file, read batch by batch as its samples are drawn.

    Args:
        path: the file.
        columns: six names, gyro x, y, z, accelerometer x, y, z; None for those of a known program
            (rad/s and m/s²), else `COUNTS`.
        time: name of the time column; None for that of a known program, else none.
        time_unit: of `TIME_UNITS`; None for s, of whole numbers and time stamps ns.
        gyro, accel: the units; None for those of a known program.
        advance: told the bytes read, estimated by the rows.

    Raises:
        InputError: pyarrow is absent, the file is no Parquet file, or lacks a column or a unit.
    """
    file = _parquet_file(path)
    import pyarrow as pa

    names = list(file.schema_arrow.names)
    known = recognise(names)
    if columns is None:
        columns = COUNTS if known is None else known.columns
        if known is not None:
            gyro, accel = gyro or GYRO_UNITS["rad/s"], accel or ACCEL_UNITS["m/s2"]
    columns = [headed(column, names) for column in columns]
    for unit, sensor in ((gyro, "gyro"), (accel, "accel")):
        if unit is None:
            raise InputError(f"{path}: the unit of {sensor} is not given, give --{sensor}-unit")
    assert gyro is not None
    assert accel is not None
    times = (time,) if time is not None else () if known is None else known.time
    faults = [FAULT] * (FAULT in names and FAULT not in columns)
    wanted = [*columns, *times, *faults]
    for name in wanted:
        if names.count(name) != 1:
            raise InputError(
                f"{path}: no column {name!r} of its own, the file has {', '.join(names)[:200]};"
                " give --gyro-columns and --accel-columns"
            )
    clock = None
    if times:
        kind = file.schema_arrow.field(times[0]).type
        whole = pa.types.is_integer(kind) or pa.types.is_timestamp(kind)
        clock = Clock("ns" if len(times) == 2 else time_unit or ("ns" if whole else "s"))
    share = path.stat().st_size / max(file.metadata.num_rows, 1)
    notes = {"columns": ", ".join(columns)}
    if clock is not None:
        notes["time stamps"] = f"{' and '.join(times)}, {clock.unit}"

    def chunks() -> Iterator[Samples]:
        first = 0
        for arrays in _batches(path, file, wanted):
            values = np.column_stack([arrays[name].astype(np.float64) for name in columns])
            require_finite(path, first, values, columns)
            flags = fault_flags(path, arrays[FAULT].astype(np.float64)) if faults else None
            seconds = None
            if clock is not None:
                stamps = [_exact(arrays[name]) for name in times]
                require_finite(path, first, stamps[0][:, None], times)
                seconds = clock(stamps[0] * 10**9 + stamps[1] if len(stamps) == 2 else stamps[0])
            advance(round(share * len(values)))
            yield Samples(values, flags, seconds)
            first += len(values)
        if not first:
            raise InputError(f"{path}: the log has no samples, give some")

    return Recording(gyro, accel, chunks(), bool(faults), clock, notes)


def parquet_names(path: Path) -> list[str]:
    """Names of the columns of a Parquet file.

    Raises:
        InputError: pyarrow is absent, or the file is no Parquet file.
    """
    return list(_parquet_file(path).schema_arrow.names)


def parquet_columns(path: Path, names: Sequence[str]) -> Iterator[dict[str, NDArray[Any]]]:
    """Columns of a Parquet file by their names, batch by batch.

    Raises:
        InputError: pyarrow is absent, the file is no whole Parquet file, or a column holds
            anything but numbers.
    """
    yield from _batches(path, _parquet_file(path), names)


def _parquet_file(path: Path) -> Any:
    try:
        import pyarrow as pa
        import pyarrow.parquet as pq
    except ImportError as error:
        raise InputError(
            f"{path}: reading Parquet files needs pyarrow, run: pip install 'sculler[formats]'"
        ) from error
    try:
        return pq.ParquetFile(path)
    except OSError as error:
        raise InputError(
            f"{path}: cannot read the log ({error.strerror or error}), check the path"
        ) from error
    except pa.ArrowException as error:
        raise InputError(f"{path}: not a whole Parquet file ({error}), write it again") from error


def _batches(path: Path, file: Any, names: Sequence[str]) -> Iterator[dict[str, NDArray[Any]]]:
    import pyarrow as pa

    first = 0
    try:
        for batch in file.iter_batches(_CHUNK_ROWS, columns=list(names)):
            if batch.num_rows:
                yield {name: _arrow_numbers(path, first, batch, name) for name in names}
            first += batch.num_rows
    except (OSError, pa.ArrowException) as error:
        raise InputError(f"{path}: not a whole Parquet file ({error}), write it again") from error


def _arrow_numbers(path: Path, first: int, batch: Any, name: str) -> NDArray[Any]:
    """A column of a batch as an array of numbers; time stamps as whole nanoseconds."""
    array = batch.column(name)
    if array.null_count:
        row = first + int(np.argmax(array.is_null().to_numpy(zero_copy_only=False)))
        raise InputError(f"{path}: sample {row}: {name} is empty, give a finite number")
    numbers: NDArray[Any] = array.to_numpy(zero_copy_only=False)
    if numbers.dtype.kind == "M":
        numbers = numbers.astype("datetime64[ns]").astype(np.int64)
    if numbers.dtype.kind not in "iufb":
        raise InputError(f"{path}: column {name} holds no numbers, give another")
    return numbers
