"""The vectors CSV (DESIGN section 4): decimal integers of any size, one row per major interval."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager
from itertools import islice
from pathlib import Path
from types import TracebackType

import numpy as np

from sculler_model.blocks import VectorBlock, component_dtype
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.vectors import AXES, COLUMNS, HIGH_RESOLUTION_COLUMNS
from sculler_sim.files import replacing


def _header(columns: Sequence[str]) -> str:
    return ",".join(columns) + "\n"


_CELL = re.compile(r"-?[0-9]+")
_HIGHEST_STATUS = 15
_COLUMNS = {_header(columns): columns for columns in (COLUMNS, HIGH_RESOLUTION_COLUMNS)}
"""The columns that a header stands for."""


class VectorsWriter(AbstractContextManager["VectorsWriter"]):
    """Writes a vectors CSV block by block; the file appears when all of it has been written.

    Attributes:
        path: the file.
        columns: its columns, `Design.columns`.
        rows: rows written so far.

    Raises:
        InputError: on entering: the folder is absent or cannot be written to.
    """

    def __init__(self, path: str | Path, columns: Sequence[str] = COLUMNS) -> None:
        self.path = Path(path)
        self.columns = tuple(columns)
        self._format = ",".join(["%d"] * len(columns)) + "\n"
        self.rows = 0
        self._replacing = replacing(self.path)

    def __enter__(self) -> VectorsWriter:
        self._file = self._replacing.__enter__().open("w", encoding="ascii", newline="\n")
        self._file.write(_header(self.columns))
        return self

    def write(self, block: VectorBlock) -> None:
        """Append the block's rows.

        Raises:
            ValueError: the block has other columns than the file.
        """
        if block.columns != self.columns:
            raise ValueError(f"{self.path}: {len(block.columns)} columns for {len(self.columns)}")
        self._file.writelines(self._format % row for row in block.rows())
        self.rows += len(block)

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self._file.close()
        self._replacing.__exit__(kind, error, traceback)


def read_vectors(
    path: str | Path, design: Design | None = None, chunk: int = 1 << 14
) -> Iterator[VectorBlock]:
    """Read a vectors CSV in blocks of at most `chunk` rows.

    Args:
        path: the file.
        design: the design the vectors come from.  Every component is then checked against its
            width, and the components are int64 where the design's fit it; without it they are
            Python integers (dtype object).
        chunk: rows in a block, which bound the memory.

    Raises:
        InputError: the file cannot be read, is cut short, its header or a cell is wrong, `major`
            does not run 0, 1, 2... (from 0 again after a reset; with gaps where the design drops
            results), or the columns or a component do
            not fit the design.  The line is named.
    """
    lines = VectorLines(path)
    if design is not None and lines.columns != design.columns:
        raise InputError(
            f"{path}: line 1: {len(lines.columns)} columns, but design {design.name} with"
            f' position = "{design.algorithm.position}" gives {len(design.columns)}; is this its'
            " vectors file?"
        )
    gaps = design is not None and design.drops_results
    dtype = np.dtype(object) if design is None else component_dtype(design)
    major = -1
    while numbered := list(islice(lines, chunk)):
        rows = [lines.integers(number, line) for number, line in numbered]
        for (number, _), row in zip(numbered, rows, strict=True):
            if row[0] not in (0, major + 1) and not (gaps and row[0] > major):
                raise InputError(
                    f"{path}: line {number}: major is {row[0]} where {major + 1} should follow,"
                    " rows are missing or out of order"
                )
            if not 0 <= row[1] <= _HIGHEST_STATUS:
                raise InputError(
                    f"{path}: line {number}: status is {row[1]}, must be 0 to {_HIGHEST_STATUS}"
                )
            major = row[0]
        if design is not None:
            _check_widths(path, numbered[0][0], rows, design)
        yield VectorBlock(
            np.array([row[0] for row in rows], np.int64),
            np.array([row[1] for row in rows], np.int64),
            np.array([row[2:] for row in rows], dtype),
        )


class VectorLines(Iterator[tuple[int, str]]):
    """The rows of a vectors CSV as text, with their line numbers.

    Attributes:
        path: the file.
        columns: its columns, from the header.

    Raises (the first at once, the others in the iteration):
        InputError: the file cannot be read, its header is wrong, or its last line has no end.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = path
        self._lines = _lines(Path(path))
        _, header = next(self._lines)
        if header not in _COLUMNS:
            begin = ",".join(COLUMNS)[:26]
            raise InputError(
                f"{path}: line 1: the header is {_shown(header)}, a vectors file begins with"
                f" {begin}..."
            )
        self.columns = _COLUMNS[header]
        self._row = re.compile(rf"-?[0-9]+(?:,-?[0-9]+){{{len(self.columns) - 1}}}")

    def __next__(self) -> tuple[int, str]:
        return next(self._lines)

    def integers(self, number: int, line: str) -> tuple[int, ...]:
        """The integers of a row.

        Raises:
            InputError: too few or too many cells, or one that is not an integer.
        """
        self.check(number, line)
        return tuple(map(int, line.split(",")))

    def check(self, number: int, line: str) -> None:
        """Raise InputError if the line is not as many integers as there are columns."""
        if self._row.fullmatch(line):
            return
        cells = line.split(",")
        for column, cell in zip(self.columns, cells, strict=False):
            if not _CELL.fullmatch(cell):
                raise InputError(
                    f"{self.path}: line {number}: {column} is {_shown(cell)}, must be a whole"
                    " number"
                )
        raise InputError(
            f"{self.path}: line {number}: {len(cells)} cells, must be {len(self.columns)}; is the"
            " file cut short?"
        )


def _lines(path: Path) -> Iterator[tuple[int, str]]:
    """Number and text of each line, the header with its end."""
    try:
        with path.open(encoding="ascii") as file:
            yield 1, file.readline()
            for number, line in enumerate(file, start=2):
                if not line.endswith("\n"):
                    raise InputError(
                        f"{path}: line {number}: the last line has no end, the file is cut short;"
                        " make it again"
                    )
                yield number, line[:-1]
    except OSError as error:
        raise InputError(
            f"{path}: cannot read the vectors file ({error.strerror}), check the path"
        ) from error
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: not a text file, give a vectors CSV") from error


def _check_widths(
    path: str | Path, first_line: int, rows: list[tuple[int, ...]], design: Design
) -> None:
    ranges = [getattr(design.words, vector) for vector in design.vectors for _ in AXES]
    columns = list(zip(*rows, strict=True))[2:]
    for name, column, allowed in zip(design.columns[2:], columns, ranges, strict=True):
        if min(column) < allowed.lo or max(column) > allowed.hi:
            row = next(i for i, value in enumerate(column) if value not in allowed)
            raise InputError(
                f"{path}: line {first_line + row}: {name} is {_shown(column[row])}, more than"
                f" design {design.name} can give ({allowed.bits} bits); is this its vectors file?"
            )


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 40 else text[:37] + "..."
