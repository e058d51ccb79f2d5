"""Columns as named arrays: NumPy's `.npz` and Apache Parquet.

An `.npz` file holds the arrays

* `gyro` (or another of `array_choice.GYRO_NAMES`) and `accel` (or another of
  `array_choice.ACCEL_NAMES`), each (N, 3); or others that the user names;
* optionally `time` (or `t`, `timestamp`, `timestamps`), (N,): whole numbers count ns, others s;
* optionally `fault`, (N,) of 0 and 1;
* optionally the strings `gyro_unit`, `accel_unit`, `time_unit`, as the options of `convert` name
  them; `dtheta` is in rad and `dvel` in m/s unless they say otherwise.

A Parquet file has a column for each axis, named as in CSV.
"""

from __future__ import annotations

import zipfile
import zlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sculler.formats.log import COUNTS, FAULT
from sculler.formats.tables.parquet import values
from sculler.readers.apart import Shape
from sculler.readers.columns import headed, recognise
from sculler.readers.delimited import flags
from sculler.readers.format import COLUMNS, Format, Request, begins
from sculler.readers.named import exact, read_named
from sculler.readers.recording import Clock, Recording, Samples, require_finite
from sculler.readers.signatures import is_npz
from sculler_model.errors import InputError

_CHUNK_ROWS = 1 << 15


def read_npz(path: Path, request: Request) -> Recording:
    """The arrays of an `.npz` file, loaded whole; units given here go before those of the file.

    Raises:
        InputError: the file cannot be read, or lacks an array or a unit, or an array has another
            shape.
    """
    recording = read_named(_Npz(path), request, whole_is_ns=True)
    request.advance(path.stat().st_size)
    return recording


class _Npz:
    """The arrays of an `.npz` file."""

    def __init__(self, path: Path) -> None:
        self.path, self._arrays = path, npz_arrays(path)
        self.listing = {
            name: Shape(
                array.shape,
                array.dtype.str,
                str(array.reshape(-1)[0]) if array.dtype.kind == "U" and array.size == 1 else None,
            )
            for name, array in self._arrays.items()
        }

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self._arrays[name]


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


def read_parquet(path: Path, request: Request) -> Recording:
    """A Parquet file, read batch by batch as its samples are drawn.

    Columns are those asked for, else those of a known program (rad/s and m/s²), else `COUNTS`.
    Stamps are s, of whole numbers and time stamps ns, unless the user says otherwise.

    Raises:
        InputError: pyarrow is absent, the file is no Parquet file, or lacks a column or a unit.
    """
    file = _parquet_file(path)
    import pyarrow as pa

    names = list(file.schema_arrow.names)
    known = recognise(names)
    columns: Sequence[str] | None = request.columns(COUNTS)
    usual: tuple[str | None, str | None] = (None, None)
    if columns is None:
        columns = COUNTS if known is None else known.columns
        usual = (None, None) if known is None else ("rad/s", "m/s2")
    columns = [headed(column, names) for column in columns]
    try:
        units = request.units(*usual)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    times = (request.time,) if request.time is not None else () if known is None else known.time
    faults = [FAULT] * (FAULT in names and FAULT not in columns)
    wanted = [*columns, *times, *faults]
    _require_columns(path, names, wanted)
    clock = None
    if times:
        kind = file.schema_arrow.field(times[0]).type
        whole = pa.types.is_integer(kind) or pa.types.is_timestamp(kind)
        usual_unit = "ns" if whole else "s"
        clock = Clock("ns" if len(times) == 2 else request.time_unit or usual_unit)
    share = path.stat().st_size / max(file.metadata.num_rows, 1)
    notes = {"columns": ", ".join(columns)}
    if clock is not None:
        short = pa.types.is_float32(kind) or pa.types.is_float16(kind)
        notes["time stamps"] = f"{' and '.join(times)}, {clock.unit}" + f" ({kind})" * short

    def chunks() -> Iterator[Samples]:
        first = 0
        for arrays in _batches(path, file, wanted):
            values = np.column_stack([arrays[name].astype(np.float64) for name in columns])
            require_finite(path, first, values, columns)
            marks = flags(path, FAULT, arrays[FAULT].astype(np.float64)) if faults else None
            seconds = None
            if clock is not None:
                for name in times:
                    require_finite(path, first, arrays[name][:, None], (name,))
                seconds = clock(_stamps(path, [arrays[name] for name in times]))
            request.advance(round(share * len(values)))
            yield Samples(values, marks, seconds)
            first += len(values)
        if not first:
            raise InputError(f"{path}: the log has no samples, give some")

    return Recording(*units, chunks(), bool(faults), clock, notes)


def _require_columns(path: Path, names: Sequence[str], wanted: Sequence[str]) -> None:
    for name in wanted:
        if names.count(name) != 1:
            raise InputError(
                f"{path}: no column {name!r} of its own, the file has {', '.join(names)[:200]};"
                " give --gyro-columns and --accel-columns"
            )


def _stamps(path: Path, given: list[NDArray[Any]]) -> NDArray[np.int64] | NDArray[np.float64]:
    """Stamps of one column, or of two: whole seconds and nanoseconds.

    Raises:
        InputError: of two, one is not whole.
    """
    if len(given) == 1:
        return exact(path, given[0])
    for stamps in given:
        if (stamps != np.rint(stamps)).any() or (np.abs(stamps.astype(np.float64)) > 9e9).any():
            raise InputError(f"{path}: seconds and nanoseconds are not whole throughout, mend them")
    seconds, nanoseconds = (stamps.astype(np.int64) for stamps in given)
    return seconds * 10**9 + nanoseconds


def _parquet_file(path: Path) -> Any:
    try:
        import pyarrow as pa
        import pyarrow.parquet as pq
    except ImportError as error:
        raise InputError(
            f"{path}: reading Parquet files needs pyarrow, run: pip install 'sculler[formats]'"
        ) from error
    try:
        return pq.ParquetFile(path, pre_buffer=False)  # it would keep all it reads
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
        for batch in file.iter_batches(_CHUNK_ROWS, columns=list(names), use_threads=False):
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
    import pyarrow as pa

    if pa.types.is_integer(array.type) or pa.types.is_floating(array.type):
        return values(array)
    numbers: NDArray[Any] = array.to_numpy(zero_copy_only=False)
    if numbers.dtype.kind == "M":
        numbers = numbers.astype("datetime64[ns]").astype(np.int64)
    if numbers.dtype.kind not in "iufb":
        raise InputError(f"{path}: column {name} holds no numbers, give another")
    return numbers


FORMATS = (
    Format(
        "npz",
        "NumPy's .npz files, an array for each sensor",
        read_npz,
        COLUMNS | {"variable"},
        lambda head: float(head.content.startswith(b"PK\x03\x04") and is_npz(head.content)),
        (".npz",),
    ),
    Format(
        "parquet",
        "Apache Parquet files, a column for each axis",
        read_parquet,
        COLUMNS,
        begins(b"PAR1"),
        (".parquet",),
    ),
)
