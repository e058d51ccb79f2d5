"""The vectors CSV (docs/reference/vectors.md): decimal integers of any size, a row an interval.

Where the log had stamps there is one more column, the last: `time_s`, the instant of the interval's
end on the log's clock, the shortest decimal of the float.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack
from itertools import islice
from math import isfinite
from pathlib import Path
from types import TracebackType

import numpy as np

from sculler_model.design import AXES, COLUMNS, HIGH_RESOLUTION_COLUMNS, Design
from sculler_model.errors import InputError
from sculler_model.fast import VectorBlock, as_integers, component_limbs
from sculler_model.outputs import open_lines, replacing

TIME = "time_s"
"""Name of the optional last column."""


def _header(columns: Sequence[str], times: bool) -> str:
    return ",".join(columns) + f",{TIME}" * times + "\n"


MAX_DIGITS = 4000
"""Of a component, many times what any design gives; Python converts no more than 4300."""

_CELL = re.compile(r"-?[0-9]+")
_TIME = re.compile(r"-?[0-9]+(?:\.[0-9]+)?(?:e[+-]?[0-9]+)?")  # as Python writes floats
_HIGHEST_STATUS = 15
_COLUMNS = {
    _header(columns, times): (columns, times)
    for columns in (COLUMNS, HIGH_RESOLUTION_COLUMNS)
    for times in (False, True)
}
"""The columns of integers that a header stands for, and whether it has times."""


class VectorsWriter(AbstractContextManager["VectorsWriter"]):
    """Writes a vectors CSV block by block; the file appears when all of it has been written.

    Attributes:
        path: the file.
        columns: its columns of integers, `Design.columns`.
        times: whether it has the column `time_s`; None until a block with rows or times settles it.
        rows: rows written so far.

    Raises:
        InputError: on entering: the folder is absent or cannot be written to.
    """

    def __init__(
        self, path: str | Path, columns: Sequence[str] = COLUMNS, times: bool | None = None
    ) -> None:
        self.path = Path(path)
        self.columns = tuple(columns)
        self._format = ",".join(["%d"] * len(columns))
        self.times = times
        self.rows = 0

    def __enter__(self) -> VectorsWriter:
        with ExitStack() as stack:
            temporary = stack.enter_context(replacing(self.path))
            file = temporary.open("w", encoding="ascii", newline="\n")
            self._file = stack.enter_context(file)
            self._headed = False
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
        self._write_header()
        if (block.times is not None) != self.times:
            raise ValueError(f"{self.path}: give blocks times exactly where the file has them")
        rows = (self._format % row for row in block.rows())
        if block.times is None:
            self._file.writelines(row + "\n" for row in rows)
        else:
            stamps = zip(rows, block.times.tolist(), strict=True)
            self._file.writelines(f"{row},{time!r}\n" for row, time in stamps)
        self.rows += len(block)

    def _write_header(self) -> None:
        if not self._headed:
            self._file.write(_header(self.columns, bool(self.times)))
            self._headed = True

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        if kind is None:
            self._write_header()
        self._stack.__exit__(kind, error, traceback)


def read_vectors(
    path: str | Path, design: Design | None = None, chunk: int = 1 << 14, *, missing: bool = False
) -> Iterator[VectorBlock]:
    """Read a vectors CSV in blocks of at most `chunk` rows.

    Args:
        path: the file.
        design: the design the vectors come from.  Every component is then checked against its
            width, and has as many limbs as the design says; without it as many as a block needs.
        chunk: rows in a block, which bound the memory.
        missing: let rows be missing, that is, `major` jump forwards, as where the design drops
            results.

    Raises:
        InputError: the file cannot be read, is cut short, its header or a cell is wrong, `major`
            does not run 0, 1, 2... (from 0 again after a reset), or the columns or a component do
            not fit the design.  The line is named.
    """
    lines = VectorLines(path)
    if design is not None and lines.columns != design.columns:
        raise InputError(
            f"{path}: line 1: {len(lines.columns)} columns, but design {design.name} with"
            f' position = "{design.algorithm.position}" gives {len(design.columns)}; is this its'
            " vectors file?"
        )
    missing = missing or (design is not None and design.drops_results)
    limbs = None if design is None else component_limbs(design)
    major = -1
    while numbered := list(islice(lines, chunk)):
        cells = [lines.row(number, line) for number, line in numbered]
        rows = [integers for integers, _ in cells]
        for (number, _), row in zip(numbered, rows, strict=True):
            if row[0] not in (0, major + 1) and not (missing and row[0] > major):
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
            as_integers(np.array([row[2:] for row in rows], object), limbs),
            np.array([time for _, time in cells], np.float64) if lines.times else None,
        )


class VectorLines(Iterator[tuple[int, str]]):
    """The rows of a vectors CSV as text, with their line numbers.

    Attributes:
        path: the file.
        columns: its columns of integers, from the header.
        times: whether the column `time_s` follows them.

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
        self.columns, self.times = _COLUMNS[header]
        self._row = re.compile(rf"-?[0-9]+(?:,-?[0-9]+){{{len(self.columns) - 1}}}")

    def __next__(self) -> tuple[int, str]:
        return next(self._lines)

    def row(self, number: int, line: str) -> tuple[tuple[int, ...], float | None]:
        """The integers of a row, and its time (s), None where the file has no times.

        Raises:
            InputError: too few or too many cells, or one that is no number of its kind.
        """
        self.check(number, line)
        cells = line.split(",")
        time = float(cells.pop()) if self.times else None
        return tuple(map(int, cells)), time

    def check(self, number: int, line: str) -> None:
        """Raise InputError if the line is not as many numbers as there are columns."""
        integers, _, time = line.rpartition(",") if self.times else (line, "", "0")
        cells, names = line.split(","), (*self.columns, *[TIME] * self.times)
        if self._row.fullmatch(integers) and _is_time(time):
            longest = max(map(len, cells))
            if longest <= MAX_DIGITS:
                return
            column = names[[len(cell) for cell in cells].index(longest)]
            raise InputError(
                f"{self.path}: line {number}: {column} has {longest} digits, more than any design"
                " gives; is this a vectors file?"
            )
        for column, cell in zip(names, cells, strict=False):
            good = _is_time(cell) if column == TIME else _CELL.fullmatch(cell)
            if not good:
                kind = "decimal seconds" if column == TIME else "a whole number"
                raise InputError(
                    f"{self.path}: line {number}: {column} is {_shown(cell)}, must be {kind}"
                )
        raise InputError(
            f"{self.path}: line {number}: {len(cells)} cells, must be {len(names)}; is the"
            " file cut short?"
        )


def _is_time(cell: str) -> bool:
    return _TIME.fullmatch(cell) is not None and isfinite(float(cell))


def _lines(path: Path) -> Iterator[tuple[int, str]]:
    """Number and text of each line, the header with its end."""
    try:
        with open_lines(path, encoding="ascii") as file:
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


def results_in(path: str | Path) -> int | None:
    """Results in a vectors file, by its lines; None where it cannot be told beforehand."""
    path = Path(path)
    if not path.is_file():  # a pipe can be read but once
        return None
    try:
        with path.open("rb") as file:
            return sum(block.count(b"\n") for block in iter(lambda: file.read(1 << 20), b"")) - 1
    except OSError:  # told where it is read
        return None
