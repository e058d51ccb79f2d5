"""NumPy's `.npz`, read and written block by block: each column an array of its own.

The file is a ZIP archive of `.npy` arrays, one after the other, so a writer keeps each column in a
temporary file until all rows are there.  What it writes is stored, not compressed; compressed files
are read too.  Wide whole numbers are arrays (R, W) of int64 limbs, the lowest first.
"""

from __future__ import annotations

import shutil
import struct
import tempfile
import zipfile
import zlib
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.lib import format as npy

from sculler.formats.tables.columns import BLOCK_ROWS, Block, Column, rows_together, stored
from sculler_model.errors import InputError

_IN_MEMORY = 1 << 20  # bytes of a column, before it goes to a file
_STAMP = (1980, 1, 1, 0, 0, 0)  # the same bytes at any time

DAMAGED = (
    ValueError,
    EOFError,
    KeyError,
    RuntimeError,  # encrypted, or (its child) compressed in a way nobody knows
    zipfile.BadZipFile,
    zlib.error,
    struct.error,
)
"""What reading raises of a file that is no whole `.npz`."""


class NpzReader:
    """An `.npz` file of columns; see `TableReader`.

    Args:
        path: the file.

    Raises:
        OSError: it cannot be read.
        InputError: it is no whole `.npz` file, or its columns are of several lengths.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        with damage_told(path):
            self._archive = zipfile.ZipFile(path)
        self._files = {name.removesuffix(".npy"): name for name in self._archive.namelist()}
        self.names: Sequence[str] = list(self._files)

    @property
    def rows(self) -> int:
        """Of the first column."""
        with damage_told(self._path):
            return self._length(self.names[0]) if self.names else 0

    def _length(self, name: str) -> int:
        with self._archive.open(self._files[name]) as file:
            shape, _ = self._header(name, file)
        if not 1 <= len(shape) <= 2:
            raise InputError(f"{self._path}: {name} is of shape {shape}, give a column (N,)")
        return shape[0]

    def _header(self, name: str, file: IO[bytes]) -> tuple[tuple[int, ...], np.dtype[Any]]:
        version = npy.read_magic(file)
        read: Callable[[IO[bytes]], tuple[tuple[int, ...], bool, np.dtype[Any]]]
        read = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
        shape, fortran, kind = read(file)
        if fortran and len(shape) > 1:
            raise InputError(f"{self._path}: {name} is stored column by column, give rows")
        if kind.hasobject:
            raise InputError(f"{self._path}: {name} is of type {kind}, give numbers")
        return shape, kind

    def blocks(self, names: Sequence[str]) -> Iterator[Block]:
        """Columns, some rows at a time.

        Raises:
            InputError: they are of several lengths, or the file is damaged.
        """
        with damage_told(self._path), ExitStack() as stack:
            length = self._common_length(names)
            files = {}
            for name in names:
                file = stack.enter_context(self._archive.open(self._files[name]))
                files[name] = (file, *self._header(name, file))
            together = rows_together(names, BLOCK_ROWS)
            for first in range(0, length, together):
                rows = min(together, length - first)
                yield {name: _rows(*each, rows) for name, each in files.items()}
            for file, *_ in files.values():
                if file.read(1):  # in the end the archive holds the sum of the bytes against ours
                    raise ValueError("more bytes than its shape says")

    def _common_length(self, names: Sequence[str]) -> int:
        lengths = {name: self._length(name) for name in names}
        first = names[0]
        for name, length in lengths.items():
            if length != lengths[first]:
                raise InputError(
                    f"{self._path}: {name} has {length} rows and {first} {lengths[first]}, give as"
                    " many"
                )
        return lengths[first]

    def close(self) -> None:
        """Close the file."""
        self._archive.close()


def _rows(file: IO[bytes], shape: tuple[int, ...], kind: np.dtype[Any], rows: int) -> Any:
    width = shape[1] if len(shape) > 1 else 1
    wanted = rows * width * kind.itemsize
    content = file.read(wanted)
    if len(content) < wanted:
        raise EOFError("it ends too early")
    return np.frombuffer(content, kind).reshape(rows, *shape[1:])


@contextmanager
def damage_told(path: Path) -> Iterator[None]:
    """Within it, what a damaged `.npz` file makes Python raise becomes one line."""
    try:
        yield
    except InputError:
        raise
    except DAMAGED as error:
        told = str(error).strip() or type(error).__name__
        raise InputError(
            f"{path}: not a whole .npz file ({told.splitlines()[0]}), write it again"
        ) from error


class NpzWriter:
    """Writes an `.npz` file of columns; see `TableWriter`."""

    def __init__(self, path: Path, columns: Sequence[Column]) -> None:
        self._path, self._columns = path, columns
        self._rows = 0
        self._stack = ExitStack()
        self._files: dict[str, IO[bytes]] = {}
        for column in columns:
            file = tempfile.SpooledTemporaryFile(_IN_MEMORY, dir=str(path.parent))  # noqa: SIM115
            self._files[column.name] = self._stack.enter_context(file)

    def write(self, block: Block) -> None:
        """Append rows."""
        for column in self._columns:
            numbers = stored(column, block[column.name])
            content = numbers.astype(numbers.dtype.newbyteorder("<"), copy=False)
            self._files[column.name].write(content.data)
        self._rows += len(numbers)

    def finish(self) -> None:
        """Put the columns together."""
        with zipfile.ZipFile(self._path, "w", zipfile.ZIP_STORED) as archive:
            for column in self._columns:
                shape = (self._rows,) if column.bits <= 64 else (self._rows, column.limbs)
                kind = np.dtype(column.kind).newbyteorder("<")
                header = {
                    "descr": npy.dtype_to_descr(kind),
                    "fortran_order": False,
                    "shape": shape,
                }
                entry = zipfile.ZipInfo(f"{column.name}.npy", _STAMP)
                with archive.open(entry, "w", force_zip64=True) as member:
                    npy.write_array_header_1_0(member, header)
                    file = self._files[column.name]
                    file.seek(0)
                    shutil.copyfileobj(file, member, 1 << 18)

    def close(self) -> None:
        """Let go of the temporary files."""
        self._stack.close()
