"""Vectors files (docs/reference/vectors.md): exact integers of any size, a row an interval.

The ending of the file's name says what it is: `.npz`, `.parquet`, and CSV for all others.  Where
the log had stamps there is one more column, the last: `time_s`, the instant of the interval's end
on the log's clock.  Where the core has many sensors `channel`, whose result it is, stands after the
components.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack
from dataclasses import replace
from pathlib import Path
from types import TracebackType

import numpy as np
from numpy.typing import NDArray

from sculler.formats import lines
from sculler.formats.tables import open_table, table_kind
from sculler.formats.vectors_table import TableVectors, TableVectorsWriter
from sculler.formats.vectors_text import CHANNEL, TIME, TextVectors, TextVectorsWriter
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

__all__ = [
    "CHANNEL",
    "TIME",
    "VectorsFile",
    "VectorsWriter",
    "open_vectors",
    "read_vectors",
    "results_in",
]

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
        channels: whether it has the column `channel`, as a design with channels or, without a
            design, the first block says.
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
        self.channels: bool | None = None if design is None else design.channels > 1
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
            ValueError: the block has other columns than the file, or times or channels where the
                file has none, or none where it has.
        """
        if block.columns != self.columns:
            raise ValueError(f"{self.path}: {len(block.columns)} columns for {len(self.columns)}")
        if not len(block) and block.times is None:
            return
        if self.times is None:
            self.times = block.times is not None
        if self.channels is None:
            self.channels = block.channels is not None
        file = self._opened(64 * limbs_of(block.components).shape[-1])
        if (block.times is not None) != self.times:
            raise ValueError(f"{self.path}: give blocks times exactly where the file has them")
        if len(block) and (block.channels is not None) != self.channels:
            raise ValueError(f"{self.path}: give blocks channels exactly where the file has them")
        file.write(block)
        self.rows += len(block)

    def _opened(self, widest: int) -> TextVectorsWriter | TableVectorsWriter:
        """The file; its header goes out when it is opened."""
        if self._file is None:
            times, channels = bool(self.times), bool(self.channels)
            if table_kind(self.path) is None:
                self._file = TextVectorsWriter(self._temporary, self.columns, times, channels)
            else:
                self._file = TableVectorsWriter(
                    self._temporary, self.columns, times, channels, self._design, widest
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
    path: str | Path,
    design: Design | None = None,
    chunk: int = 1 << 14,
    *,
    missing: bool = False,
    channel: int | None = None,
) -> Iterator[VectorBlock]:
    """Read a vectors file in blocks of at most `chunk` rows.

    Args:
        path: the file, `.npz`, `.parquet` or CSV.
        design: the design the vectors come from.  Every component is then checked against its
            width, and has as many limbs as the design says; without it as many as a block needs.
        chunk: rows in a block, which bound the memory.
        missing: let rows be missing, that is, `major` jump forwards, as where the design drops
            results.
        channel: the one to read, of a file of many.

    Raises:
        InputError: the file cannot be read, is cut short, its header or a cell is wrong, `major`
            does not run 0, 1, 2... (from 0 again after a reset), or the columns or a component do
            not fit the design.  The line is named (of a binary file the row, from 1).  Or it has
            channels and none is given, or not that one.
    """
    with open_vectors(path) as file:
        if design is not None and file.columns != design.columns:
            where = f"{path}: line 1" if file.unit == "line" else str(path)
            raise InputError(
                f"{where}: {len(file.columns)} columns, but design {design.name} with"
                f" {_told(design)} gives {len(design.columns)}; is this its vectors file?"
            )
        _require_channel(file, design, channel)
        missing = missing or (design is not None and design.drops_results)
        checks = _Checks(f"{path}: {file.unit}", design, missing)
        number, found = file.first, channel is None
        for block in file.blocks():
            rows = np.arange(len(block))
            if channel is not None:
                rows = np.flatnonzero(block.channels == channel)
                found |= len(rows) > 0
            mine = block if channel is None else replace(block[rows], channels=None)
            for begin in range(0, len(mine), chunk):
                part = slice(begin, begin + chunk)
                yield checks(mine[part], number + rows[part])
            number += len(block)
        if not found:
            raise InputError(f"{path}: no result of channel {channel}, give one that is there")


def _require_channel(file: VectorsFile, design: Design | None, channel: int | None) -> None:
    """See that a channel is asked for exactly where there are some, and one of the design's."""
    if channel is None and file.channels:
        raise InputError(
            f"{file.path}: results of many channels, name one (sculler navigate --channel)"
        )
    if channel is not None and not file.channels:
        raise InputError(f"{file.path}: results of one sensor, leave the channel out")
    if channel is not None and design is not None and not 0 <= channel < design.channels:
        raise InputError(
            f"{file.path}: channel {channel} is not one of design {design.name}, give 0 to"
            f" {design.channels - 1}"
        )


def _told(design: Design) -> str:
    """What its columns depend on."""
    if design.order > 2:
        return f"order = {design.order}"
    return f'position = "{design.algorithm.position or "trapezoidal"}"'


class _Checks:
    """Holds blocks of rows that come in order against each other and a design.

    Args:
        where: the file and what its rows are counted in, for messages.
        design, missing: see `read_vectors`.
    """

    def __init__(self, where: str, design: Design | None, missing: bool) -> None:
        self._where = where
        self._design, self._missing = design, missing
        self._major = -1

    def __call__(self, block: VectorBlock, numbers: NDArray[np.int64]) -> VectorBlock:
        """The block, its components in the design's limbs; `numbers` are those of its rows."""
        self._numbers = numbers
        self._check_order(block)
        if self._design is not None:
            self._check_widths(block, self._design)
        self._major = int(block.major[-1])
        if self._design is None:
            return block
        limbs = component_limbs(self._design)
        narrow = from_limbs(limbs_of(block.components)[..., :limbs])
        return replace(block, components=as_integers(narrow, limbs))

    def _check_order(self, block: VectorBlock) -> None:
        before = np.concatenate([[self._major], block.major[:-1]])
        follows = (block.major == 0) | (block.major == before + 1)
        if self._missing:
            follows |= block.major > before
        known = (block.status >= 0) & (block.status <= _HIGHEST_STATUS)
        if (follows & known).all():
            return
        row = int(np.argmin(follows & known))
        where = f"{self._where} {self._numbers[row]}"
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
                    f"{self._where} {self._numbers[row]}: {name} is {shown}, more than"
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
