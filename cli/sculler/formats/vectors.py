"""Vectors files (docs/reference/vectors.md): exact integers of any size, a row an interval.

The ending of the file's name says what it is: `.npz`, `.parquet`, and CSV for all others.  Where
the log had stamps there is one more column, the last: `time_s`, the instant of the interval's end
on the log's clock.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack
from pathlib import Path
from types import TracebackType

import numpy as np
from numpy.typing import NDArray

from sculler.formats import lines
from sculler.formats.tables import open_table, table_kind
from sculler.formats.vectors_table import TableVectors, TableVectorsWriter
from sculler.formats.vectors_text import TIME, TextVectors, TextVectorsWriter
from sculler_model.design import COLUMNS, Design, Interval
from sculler_model.errors import InputError
from sculler_model.fast import (
    VectorBlock,
    as_integers,
    component_limbs,
    from_limbs,
    limbs_of,
)
from sculler_model.outputs import replacing

__all__ = ["TIME", "VectorsFile", "VectorsWriter", "open_vectors", "read_vectors", "results_in"]

VectorsFile = TextVectors | TableVectors
_HIGHEST_STATUS = 15


class VectorsWriter(AbstractContextManager["VectorsWriter"]):
    """Writes a vectors file block by block; it appears when all of it has been written.

    Args:
        path: the file; its ending says which kind.
        columns: its columns of integers, `Design.columns`.
        times: whether it has the column `time_s`; None until a block with rows or times settles it.
        design: tells a binary file how wide each column is; None for the first block's width.

    Attributes:
        path, columns, times: the same.
        rows: rows written so far.

    Raises:
        InputError: on entering: the folder is absent or cannot be written to.
    """

    def __init__(
        self,
        path: str | Path,
        columns: Sequence[str] = COLUMNS,
        times: bool | None = None,
        design: Design | None = None,
    ) -> None:
        self.path = Path(path)
        self.columns = tuple(columns)
        self.times = times
        self.rows = 0
        self._design = design

    def __enter__(self) -> VectorsWriter:
        with ExitStack() as stack:
            self._temporary = stack.enter_context(replacing(self.path))
            self._file: TextVectorsWriter | TableVectorsWriter | None = None
            self._stack = stack.pop_all()
        return self

    def write(self, block: VectorBlock) -> None:
        """Append the block's rows.

        Raises:
            ValueError: the block has other columns than the file, or times where the file has none,
                or none where it has.
        """
        if block.columns != self.columns:
            raise ValueError(f"{self.path}: {len(block.columns)} columns for {len(self.columns)}")
        if not len(block) and block.times is None:
            return
        if self.times is None:
            self.times = block.times is not None
        file = self._opened(64 * limbs_of(block.components).shape[-1])
        if (block.times is not None) != self.times:
            raise ValueError(f"{self.path}: give blocks times exactly where the file has them")
        file.write(block)
        self.rows += len(block)

    def _opened(self, widest: int) -> TextVectorsWriter | TableVectorsWriter:
        """The file; its header goes out when it is opened."""
        if self._file is None:
            times = bool(self.times)
            if table_kind(self.path) is None:
                self._file = TextVectorsWriter(self._temporary, self.columns, times)
            else:
                self._file = TableVectorsWriter(
                    self._temporary, self.columns, times, self._design, widest
                )
            self._stack.push(self._file.close)
        return self._file

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        with self._stack:
            if kind is None:
                self._opened(64)
            self._stack.__exit__(kind, error, traceback)


def open_vectors(path: str | Path) -> VectorsFile:
    """A vectors file to read, its columns known; a context, at whose end it is closed.

    Raises:
        InputError: it cannot be read, or has other columns.
    """
    return TextVectors(path) if table_kind(path) is None else TableVectors(path)


def read_vectors(
    path: str | Path, design: Design | None = None, chunk: int = 1 << 14, *, missing: bool = False
) -> Iterator[VectorBlock]:
    """Read a vectors file in blocks of at most `chunk` rows.

    Args:
        path: the file, `.npz`, `.parquet` or CSV.
        design: the design the vectors come from.  Every component is then checked against its
            width, and has as many limbs as the design says; without it as many as a block needs.
        chunk: rows in a block, which bound the memory.
        missing: let rows be missing, that is, `major` jump forwards, as where the design drops
            results.

    Raises:
        InputError: the file cannot be read, is cut short, its header or a cell is wrong, `major`
            does not run 0, 1, 2... (from 0 again after a reset), or the columns or a component do
            not fit the design.  The line is named (of a binary file the row, from 1).
    """
    with open_vectors(path) as file:
        if design is not None and file.columns != design.columns:
            where = f"{path}: line 1" if file.unit == "line" else str(path)
            raise InputError(
                f"{where}: {len(file.columns)} columns, but design {design.name} with"
                f" {_told(design)} gives {len(design.columns)}; is this its vectors file?"
            )
        missing = missing or (design is not None and design.drops_results)
        checks = _Checks(f"{path}: {file.unit}", file.first, design, missing)
        for block in file.blocks():
            for begin in range(0, len(block), chunk):
                yield checks(rows_of(block, slice(begin, begin + chunk)))


def _told(design: Design) -> str:
    """What its columns depend on."""
    if design.order > 2:
        return f"order = {design.order}"
    return f'position = "{design.algorithm.position or "trapezoidal"}"'


class _Checks:
    """Holds blocks of rows that come in order against each other and a design.

    Args:
        where: the file and what its rows are counted in, for messages.
        number: of the first row.
        design, missing: see `read_vectors`.
    """

    def __init__(self, where: str, number: int, design: Design | None, missing: bool) -> None:
        self._where, self._number = where, number
        self._design, self._missing = design, missing
        self._major = -1

    def __call__(self, block: VectorBlock) -> VectorBlock:
        """The block, its components in the design's limbs."""
        self._check_order(block)
        if self._design is not None:
            self._check_widths(block, self._design)
        self._number += len(block)
        self._major = int(block.major[-1])
        if self._design is None:
            return block
        limbs = component_limbs(self._design)
        narrow = from_limbs(limbs_of(block.components)[..., :limbs])
        return VectorBlock(block.major, block.status, as_integers(narrow, limbs), block.times)

    def _check_order(self, block: VectorBlock) -> None:
        before = np.concatenate([[self._major], block.major[:-1]])
        follows = (block.major == 0) | (block.major == before + 1)
        if self._missing:
            follows |= block.major > before
        known = (block.status >= 0) & (block.status <= _HIGHEST_STATUS)
        if (follows & known).all():
            return
        row = int(np.argmin(follows & known))
        where = f"{self._where} {self._number + row}"
        if not follows[row]:
            raise InputError(
                f"{where}: major is {block.major[row]} where {before[row] + 1} should follow,"
                " rows are missing or out of order"
            )
        raise InputError(f"{where}: status is {block.status[row]}, must be 0 to {_HIGHEST_STATUS}")

    def _check_widths(self, block: VectorBlock, design: Design) -> None:
        limbs = limbs_of(block.components)
        for place, name in enumerate(design.columns[2:]):
            allowed: Interval = getattr(design.words, name[:-2])
            beyond = _outside(limbs[:, place], allowed)
            if beyond.any():
                row = int(np.argmax(beyond))
                shown = repr(from_limbs(limbs[row : row + 1, place]).tolist()[0])
                shown = shown if len(shown) <= 40 else shown[:37] + "..."
                raise InputError(
                    f"{self._where} {self._number + row}: {name} is {shown}, more than"
                    f" design {design.name} can give ({allowed.bits} bits); is this its vectors"
                    " file?"
                )


def _outside(limbs: NDArray[np.int64], allowed: Interval) -> NDArray[np.bool_]:
    """Which integers of (R, W) limbs are outside an interval."""
    words = limbs.shape[1]
    whole = Interval.signed(64 * words)
    lo, hi = max(allowed.lo, whole.lo), min(allowed.hi, whole.hi)
    if words == 1:
        return (limbs[:, 0] < lo) | (limbs[:, 0] > hi)
    bounds = limbs_of(as_integers(np.array([lo, hi], object), words))
    return _below(limbs, bounds[:1]) | _below(bounds[1:], limbs)


def _below(one: NDArray[np.int64], other: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Whether integers of (R, W) limbs are less than others."""
    less = one[:, -1] < other[:, -1]
    equal = one[:, -1] == other[:, -1]
    for word in range(one.shape[1] - 2, -1, -1):  # the bits of the lower limbs have no sign
        left = np.ascontiguousarray(one[:, word]).view(np.uint64)
        right = np.ascontiguousarray(other[:, word]).view(np.uint64)
        less |= equal & (left < right)
        equal &= left == right
    return less


def rows_of(block: VectorBlock, part: slice) -> VectorBlock:
    """Some rows of a block."""
    times = None if block.times is None else block.times[part]
    return VectorBlock(block.major[part], block.status[part], block.components[part], times)


def results_in(path: str | Path) -> int | None:
    """Results in a vectors file; None where it cannot be told beforehand."""
    path = Path(path)
    if not path.is_file():  # a pipe can be read but once
        return None
    try:
        if table_kind(path) is not None:
            with open_table(path, "vectors file") as table:
                return table.rows
        with path.open("rb") as file:
            blocks = iter(lambda: file.read(lines.BLOCK_BYTES), b"")
            return sum(block.count(b"\n") for block in blocks) - 1
    except (OSError, InputError):  # told where it is read
        return None
