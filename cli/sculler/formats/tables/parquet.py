"""Apache Parquet, read and written block by block, through pyarrow (the extra `formats`).

Whole numbers of up to 64 bits are stored as the differences of neighbours, bit by bit: it takes a
third of the room and less time.  Wider ones are decimals without places behind the point:
`decimal128(38, 0)` where 126 bits hold them, for 2^125 < 10^38; `decimal256(76, 0)` up to 252 bits;
beyond, lists of int64 limbs, the lowest first.  Arrow's decimals are such limbs themselves.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sculler.formats.tables.columns import (
    BLOCK_ROWS,
    Block,
    Column,
    limbs_of,
    rows_together,
    stored,
)
from sculler_model.errors import InputError

_GROUP_BYTES = 4 << 20  # of a row group, before it is coded
_BUFFER = 1 << 16  # bytes of a column read at a time
_FLOATS = {"halffloat": "float16", "float": "float32", "double": "float64"}  # numpy's names
_SHORT_BITS, _LONG_BITS = 126, 252  # of decimals with 38 and 76 digits


def _pyarrow(path: Path, verb: str) -> Any:
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError as error:
        raise InputError(
            f"{path}: {verb} Parquet files needs pyarrow, run: pip install 'sculler[formats]'"
        ) from error
    return pyarrow


@contextmanager
def _damage_told(path: Path) -> Iterator[None]:
    import pyarrow as pa

    try:
        yield
    except (pa.ArrowException, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(
            f"{path}: not a whole Parquet file ({str(error).splitlines()[0]}), write it again"
        ) from error


class ParquetReader:
    """A Parquet file of columns; see `TableReader`.

    Args:
        path: the file.

    Raises:
        OSError: it cannot be read.
        InputError: pyarrow is absent, or it is no whole Parquet file.
    """

    def __init__(self, path: Path) -> None:
        pa = _pyarrow(path, "reading")
        self._path = path
        with _damage_told(path):
            self._file = pa.parquet.ParquetFile(path, buffer_size=_BUFFER, pre_buffer=False)
            self.names: Sequence[str] = list(self._file.schema_arrow.names)
            self.rows: int = self._file.metadata.num_rows

    def blocks(self, names: Sequence[str]) -> Iterator[Block]:
        """Columns, some rows at a time."""
        first, together = 0, rows_together(names, BLOCK_ROWS)
        with _damage_told(self._path):
            try:
                for batch in self._file.iter_batches(
                    together, columns=list(names), use_threads=False
                ):
                    if batch.num_rows:
                        yield {name: self._numbers(batch, name, first) for name in names}
                    first += batch.num_rows
            except OSError as error:
                raise ValueError(error) from error
        if first != self.rows:
            raise InputError(f"{self._path}: not a whole Parquet file (rows are missing)")

    def _numbers(self, batch: Any, name: str, first: int) -> NDArray[Any]:
        import pyarrow as pa

        array = batch.column(name)
        if array.null_count:
            row = first + array.is_null().to_pylist().index(True)
            raise InputError(f"{self._path}: row {row + 1}: {name} is empty, give a number")
        kind = array.type
        if pa.types.is_decimal(kind) and kind.scale == 0 and kind.byte_width in (16, 32):
            return values(array, np.int64, kind.byte_width // 8)
        if pa.types.is_fixed_size_list(kind) and pa.types.is_int64(kind.value_type):
            return self._listed(array, name, first)
        if pa.types.is_boolean(kind):
            return values(array.cast(pa.uint8()), np.bool_)
        if pa.types.is_integer(kind) or pa.types.is_floating(kind):
            return values(array)
        raise InputError(f"{self._path}: {name} is of type {kind}, give numbers")

    def _listed(self, array: Any, name: str, first: int) -> NDArray[np.int64]:
        limbs = array.flatten()
        if limbs.null_count:
            raise InputError(
                f"{self._path}: a limb of {name} after row {first} is empty, give int64"
            )
        return values(limbs, np.int64).reshape(len(array), array.type.list_size)

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def values(array: Any, kind: Any = None, width: int = 1) -> NDArray[Any]:
    """The memory of an Arrow array without empty cells, whose `to_numpy` may load pandas.

    Args:
        array: of numbers.
        kind: numpy's type of a number; None for the array's own.
        width: numbers in a cell.
    """
    if kind is None:
        kind = _FLOATS.get(str(array.type), str(array.type))
    cell = width * np.dtype(kind).itemsize
    numbers = np.frombuffer(
        array.buffers()[1], kind, count=width * len(array), offset=array.offset * cell
    )
    return numbers if width == 1 else numbers.reshape(-1, width)


class ParquetWriter:
    """Writes a Parquet file of columns; see `TableWriter`.

    Raises:
        InputError: pyarrow is absent.
    """

    def __init__(self, path: Path, columns: Sequence[Column]) -> None:
        self._pa = pa = _pyarrow(path, "writing")
        self._columns = columns
        schema = pa.schema([pa.field(c.name, self._type(c), nullable=False) for c in columns])
        differences = {
            column.name: "DELTA_BINARY_PACKED"
            for column in columns
            if column.kind != "float64" and column.bits <= 64
        }
        self._writer = pa.parquet.ParquetWriter(
            path,
            schema,
            compression="none",
            use_dictionary=False,
            column_encoding=differences or None,
            write_statistics=False,
        )
        row = sum(8 * column.limbs for column in columns)
        self._group = max(1, _GROUP_BYTES // row)
        self._schema, self._waiting, self._rows = schema, list[Any](), 0

    def _type(self, column: Column) -> Any:
        pa = self._pa
        if column.bits <= 64:
            return pa.from_numpy_dtype(np.dtype(column.kind))
        if column.bits <= _SHORT_BITS:
            return pa.decimal128(38, 0)
        if column.bits <= _LONG_BITS:
            return pa.decimal256(76, 0)
        return pa.list_(pa.field("element", pa.int64(), nullable=False), column.limbs)

    def _array(self, field: Any, column: Column, given: NDArray[Any]) -> Any:
        pa, numbers = self._pa, stored(column, given)
        if np.shares_memory(numbers, given):
            numbers = numbers.copy()  # it waits for its row group
        if column.bits > _LONG_BITS:
            flat = self._from(pa.int64(), numbers.ravel())
            return pa.FixedSizeListArray.from_arrays(flat, type=field.type)
        if column.bits > 64:
            whole = column._replace(bits=8 * field.type.byte_width)
            numbers = np.ascontiguousarray(limbs_of(whole, numbers))
        return self._from(field.type, numbers)

    def _from(self, kind: Any, numbers: NDArray[Any]) -> Any:
        """An array over the same memory; `pyarrow.array` would load pandas where it is there."""
        return self._pa.Array.from_buffers(kind, len(numbers), [None, self._pa.py_buffer(numbers)])

    def write(self, block: Block) -> None:
        """Append rows."""
        arrays = [
            self._array(field, column, block[column.name])
            for field, column in zip(self._schema, self._columns, strict=True)
        ]
        self._waiting.append(self._pa.record_batch(arrays, schema=self._schema))
        self._rows += len(arrays[0])
        if self._rows >= self._group:
            self._flush()

    def _flush(self) -> None:
        table = self._pa.Table.from_batches(self._waiting, self._schema)
        self._writer.write_table(table, row_group_size=self._group)
        self._waiting, self._rows = [], 0

    def finish(self) -> None:
        """Write what waits, and the end of the file."""
        if self._waiting:
            self._flush()
        self._writer.close()

    def close(self) -> None:
        """Let go of the file."""
        self._writer.close()
