"""Files block by block: whole lines of a text, and two threads at work."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import BinaryIO, TypeVar

from sculler_model.outputs import MAX_LINE, endless_line

BLOCK_BYTES = 1 << 18
"""Bytes of a text read at a time: the parsers' arrays then stay in the processor's cache."""

_AHEAD = 3  # blocks
T = TypeVar("T")


def whole_lines(file: BinaryIO, name: str, size: int | None = None) -> Iterator[bytes]:
    """Blocks of about `size` bytes that end with a line end, and what is left after the last.

    Args:
        file, name: to read, and its name for messages.
        size: `BLOCK_BYTES` if left out.

    Raises:
        InputError: a line is longer than `MAX_LINE`.
    """
    rest = b""
    while block := file.read(size or BLOCK_BYTES):
        block = rest + block
        end = block.rfind(b"\n") + 1
        rest = block[end:]
        if len(rest) > MAX_LINE:
            raise endless_line(name)
        if end:
            yield block[:end]
    if rest:
        yield rest


def ahead(items: Iterator[T]) -> Iterator[T]:
    """The same items, none of them None, the next ones made in a second thread meanwhile.

    Parsing and what is done with its numbers are mostly arithmetic of compiled loops and of the
    simulator, during which Python's threads do run side by side.
    """
    with ThreadPoolExecutor(max_workers=1) as reader:
        coming = deque(reader.submit(next, items, None) for _ in range(_AHEAD))
        while (item := coming.popleft().result()) is not None:
            coming.append(reader.submit(next, items, None))
            yield item
