"""Vectors as CSV: decimal integers of any size, a row an interval, and perhaps its time.

Blocks of whole lines go through a strict parser, compiled (`compiled.scanning`) or in numpy
(`plain_rows`); a block that neither will take is read line by line, to say what is wrong with it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack
from math import isfinite
from pathlib import Path

import numpy as np

from sculler.formats import lines
from sculler.formats.compiled import Kernels, kernels
from sculler.formats.compiled.printing import FLOAT_BYTES, NO_LIMBS, WHOLE_BYTES
from sculler.formats.plain_rows import parse
from sculler_model import inputs
from sculler_model.design import COLUMNS, EVERY_COLUMNS
from sculler_model.errors import InputError
from sculler_model.fast import VectorBlock, WideIntegers, from_limbs, limbs_of

TIME = "time_s"
"""Name of the optional last column."""

CHANNEL = "channel"
"""Name of the column before it, of a core with many sensors."""

MAX_DIGITS = 4000
"""Of a component, many times what any design gives; Python converts no more than 4300."""

_DIGIT_BITS = 3.3219280948873626
_MOST_LIMBS = 32  # read by compiled loops; any design's components have fewer
_LIMB_BYTES = 20  # decimal digits that a limb adds, at most
_BLOCKS = 8  # of `lines.BLOCK_BYTES` read at a time: rows are long
_MAX_HEADER = 4096
_CELL = re.compile(r"-?[0-9]+")
_TIME = re.compile(r"-?[0-9]+(?:\.[0-9]+)?(?:e[+-]?[0-9]+)?")  # as Python writes floats
_LARGEST = (1 << 63) - 1


def header(columns: Sequence[str], times: bool, channels: bool = False) -> str:
    """The first line."""
    return ",".join(columns) + f",{CHANNEL}" * channels + f",{TIME}" * times + "\n"


_COLUMNS = {
    header(columns, times, channels): (columns, times, channels)
    for columns in EVERY_COLUMNS
    for times in (False, True)
    for channels in (False, True)
}
"""What a header stands for: columns of integers, whether it has times, and channels."""


class TextVectors(AbstractContextManager["TextVectors"]):
    """A vectors CSV to read; a context, at whose end it is closed.

    Attributes:
        path: the file.
        columns: its columns of integers, from the header.
        channels: whether the column `channel` follows them.
        times: whether the column `time_s` follows.
        unit, first: what messages count, and the number of the first row.

    Raises:
        InputError: the file cannot be read or its header is wrong.
    """

    unit, first = "line", 2

    def __init__(self, path: str | Path) -> None:
        self.path = path
        with ExitStack() as stack:
            try:
                inputs.note(path)
                self._file = stack.enter_context(Path(path).open("rb"))
                self._size = Path(path).stat().st_size if Path(path).is_file() else 0
                begins = self._file.readline(_MAX_HEADER)
            except OSError as error:
                raise self._unreadable(error) from error
            self._read_header(begins)
            self._stack = stack.pop_all()

    def _read_header(self, begins: bytes) -> None:
        try:
            line = begins.decode("ascii").replace("\r\n", "\n")
        except UnicodeDecodeError as error:
            raise self._no_text() from error
        if line not in _COLUMNS:
            raise InputError(
                f"{self.path}: line 1: the header is {_shown(line)}, a vectors file begins with"
                f" {','.join(COLUMNS)[:26]}..."
            )
        self.columns, self.times, self.channels = _COLUMNS[line]
        self._whole = (*self.columns, *[CHANNEL] * self.channels)  # whole numbers of a line
        self._row = re.compile(rf"-?[0-9]+(?:,-?[0-9]+){{{len(self._whole) - 1}}}")

    def __exit__(self, *error: object) -> None:
        self._stack.close()

    def _unreadable(self, error: OSError) -> InputError:
        return InputError(
            f"{self.path}: cannot read the vectors file ({error.strerror}), check the path"
        )

    def _no_text(self) -> InputError:
        return InputError(f"{self.path}: not a text file, give a vectors CSV")

    def blocks(self) -> Iterator[VectorBlock]:
        """All rows, in form; whether they follow each other and fit a design is another matter.

        Raises:
            InputError: a cell is wrong, or the last line has no end; the line is named.
        """
        number, seen = self.first, 0
        texts = lines.whole_lines(self._file, str(self.path), _BLOCKS * lines.BLOCK_BYTES)
        while True:
            try:
                text = next(texts, None)
            except OSError as error:
                raise self._unreadable(error) from error
            if text is None:
                return
            seen += len(text)
            if not text.endswith(b"\n"):
                self._refuse_cut(text, number)
            plain = text.replace(b"\r\n", b"\n") if b"\r" in text else text
            block = self._read(plain, number, kernels(max(self._size, seen)))
            yield block
            number += len(block)

    def _refuse_cut(self, text: bytes, number: int) -> None:
        """Raise InputError: a line without end is cut short, if it is text at all."""
        if not text.isascii():
            raise self._no_text()
        raise InputError(
            f"{self.path}: line {number}: the last line has no end, the file is cut short;"
            " make it again"
        )

    def _read(self, text: bytes, number: int, compiled: Kernels | None) -> VectorBlock:
        """Whole lines, of which the first has this number."""
        block = self._parsed(text) if compiled is None else self._scanned(text, compiled)
        return self._line_by_line(text, number) if block is None else block

    def _scanned(self, text: bytes, compiled: Kernels) -> VectorBlock | None:
        """By compiled loops; None if the text is not plain."""
        rows, columns = text.count(b"\n"), len(self._whole)
        characters = np.frombuffer(text, np.uint8)
        bits = np.empty(rows if self.times else 0, np.uint64)
        times = bits.view(np.float64) if self.times else None
        whole, none = np.empty((rows, columns), np.int64), NO_LIMBS.view(np.uint64)
        found = compiled.scan_rows(characters, self.times, compiled.lower, whole, none, bits)
        if found == rows:
            return self._of_whole(whole, times)
        longest = compiled.longest(characters)
        limbs = int(longest * _DIGIT_BITS + 1) // 64 + 1
        if limbs > _MOST_LIMBS:
            return None
        head = np.empty((rows, 2), np.int64)
        wide = np.empty((rows, columns - 2, limbs), np.uint64)
        found = compiled.scan_rows(characters, self.times, compiled.lower, head, wide, bits)
        if found != rows:
            return None
        numbers = wide.view(np.int64)
        channels = numbers[:, -1, 0].copy() if self.channels else None
        components = trimmed(numbers[:, :-1] if self.channels else numbers)
        return VectorBlock(head[:, 0].copy(), head[:, 1].copy(), components, times, channels)

    def _of_whole(self, whole: np.ndarray, times: np.ndarray | None) -> VectorBlock:
        """A block of a table of whole numbers."""
        columns = len(self.columns)
        channels = whole[:, columns].copy() if self.channels else None
        components = whole[:, 2:columns].copy() if self.channels else whole[:, 2:]
        return VectorBlock(whole[:, 0].copy(), whole[:, 1].copy(), components, times, channels)

    def _parsed(self, text: bytes) -> VectorBlock | None:
        """In numpy; None if the text is not plain, or a number has more than 18 digits."""
        if self.times and b".\n" in text:
            return None
        columns = len(self._whole)
        place = columns if self.times else None
        rows = parse(text, columns + self.times, place, long=True)
        if rows is None:
            return None
        return self._of_whole(rows.whole[:, :columns].copy(), rows.decimals)

    def _line_by_line(self, text: bytes, number: int) -> VectorBlock:
        """In Python; says which cell of which line is wrong."""
        try:
            written = text.decode("ascii").split("\n")[:-1]
        except UnicodeDecodeError as error:
            raise self._no_text() from error
        rows, times, channels = [], [], []
        for line_number, line in enumerate(written, start=number):
            row, time = self._numbers(line_number, line)
            channel = row[-1] if self.channels else 0
            named = ("major", row[0]), ("status", row[1]), (CHANNEL, channel)
            for column, value in named:
                if abs(value) > _LARGEST:
                    raise InputError(
                        f"{self.path}: line {line_number}: {column} is {_shown(value)}, more than"
                        " any run gives"
                    )
            rows.append(row[: len(self.columns)])
            times.append(time)
            channels.append(channel)
        block = VectorBlock.from_rows(rows)
        stamps = np.array(times, np.float64) if self.times else None
        whose = np.array(channels, np.int64) if self.channels else None
        return VectorBlock(block.major, block.status, block.components, stamps, whose)

    def _numbers(self, number: int, line: str) -> tuple[tuple[int, ...], float | None]:
        """The integers of a line, and its time (s), None where the file has no times."""
        self._check(number, line)
        cells = line.split(",")
        time = float(cells.pop()) if self.times else None
        return tuple(map(int, cells)), time

    def _check(self, number: int, line: str) -> None:
        """Raise InputError if the line is not as many numbers as there are columns."""
        integers, _, time = line.rpartition(",") if self.times else (line, "", "0")
        cells, names = line.split(","), (*self._whole, *[TIME] * self.times)
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


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 40 else text[:37] + "..."


def trimmed(limbs: np.ndarray) -> np.ndarray | WideIntegers:
    """Integers of (R, C, W) limbs in as few as the widest of them needs."""
    words = limbs.shape[-1]
    while words > 1 and (limbs[..., words - 1] == limbs[..., words - 2] >> 63).all():
        words -= 1
    return from_limbs(limbs[..., :words])


class TextVectorsWriter:
    """Writes a vectors CSV, the header first; see `vectors.VectorsWriter`."""

    def __init__(self, path: Path, columns: Sequence[str], times: bool, channels: bool) -> None:
        self._format = ",".join(["%d"] * len(columns))
        self._file = path.open("wb")
        self._file.write(header(columns, times, channels).encode("ascii"))
        self._written = 0

    def write(self, block: VectorBlock) -> None:
        """Append the block's rows."""
        text = self._printed(block) or self._formatted(block)
        self._written += len(text)
        self._file.write(text)

    def _printed(self, block: VectorBlock) -> memoryview | None:
        """By compiled loops; None where they are not worth it."""
        limbs = limbs_of(block.components)
        if block.channels is not None:  # one more number of a row
            last = np.zeros_like(limbs[:, :1])
            last[:, 0, 0] = block.channels
            limbs = np.concatenate([limbs, last], axis=1)
        rows, columns, words = limbs.shape
        wide = columns * (WHOLE_BYTES + _LIMB_BYTES * (words - 1))
        room = rows * (2 * WHOLE_BYTES + wide + FLOAT_BYTES)
        compiled = kernels(self._written + room, writing=True)
        if compiled is None:
            return None
        out = np.empty(room, np.uint8)
        times = np.zeros(0) if block.times is None else np.ascontiguousarray(block.times)
        if words == 1:
            whole, limbs = np.column_stack([block.major, block.status, limbs[..., 0]]), NO_LIMBS
        else:
            whole = np.column_stack([block.major, block.status])
            limbs = np.ascontiguousarray(limbs)
        size = compiled.print_rows(whole, limbs, times, compiled.upper, out)
        return None if size < 0 else out[:size].data

    def _formatted(self, block: VectorBlock) -> bytes:
        """In Python."""
        rows = (self._format % row for row in block.rows())
        if block.channels is not None:
            whose = block.channels.tolist()
            rows = (f"{row},{channel}" for row, channel in zip(rows, whose, strict=True))
        if block.times is None:
            return "".join(row + "\n" for row in rows).encode("ascii")
        stamps = zip(rows, block.times.tolist(), strict=True)
        return "".join(f"{row},{time!r}\n" for row, time in stamps).encode("ascii")

    def close(self, *error: object) -> None:
        """Flush and close the file, be it whole or not."""
        self._file.close()
