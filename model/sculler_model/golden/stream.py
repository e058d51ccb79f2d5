"""The result as a stream of words, for buses that need to know only one thing.

Every column of a design, in order, takes the same number of 16-bit words, least significant first,
two's complement, extended by its sign.  `major` is shown modulo 2 to the bits of a column.
"""

from __future__ import annotations

from collections.abc import Sequence

from sculler_model.design import Design

WORD_BITS = 16
"""Width of a word."""


def words_per_column(design: Design) -> int:
    """Words that each column takes: as many as the widest component of the design needs."""
    widest: int = max(getattr(design.words, vector).bits for vector in design.vectors)
    return -(-widest // WORD_BITS)


def words_per_result(design: Design) -> int:
    """Words of one whole result."""
    return len(design.columns) * words_per_column(design)


def to_words(design: Design, row: Sequence[int]) -> list[int]:
    """A result's columns as the unsigned words of its stream, in the order they are sent.

    Args:
        design: the design.
        row: integers in the order of the design's columns (`Result.row`).
    """
    count = words_per_column(design)
    return [column >> WORD_BITS * i & (1 << WORD_BITS) - 1 for column in row for i in range(count)]


def from_words(design: Design, words: Sequence[int]) -> tuple[int, ...]:
    """The columns of a result, from its words; `major` modulo 2 to the bits of a column.

    Args:
        design: the design.
        words: unsigned, in the order they are sent.

    Raises:
        ValueError: not as many words as a result has.
    """
    if len(words) != words_per_result(design):
        raise ValueError(f"{len(words)} words, not {words_per_result(design)}")
    count = words_per_column(design)
    row: list[int] = []
    for start in range(0, len(words), count):
        value = sum(word << WORD_BITS * i for i, word in enumerate(words[start : start + count]))
        signed = len(row) > 1 and value >> WORD_BITS * count - 1  # major and status are unsigned
        row.append(value - (1 << WORD_BITS * count) if signed else value)
    return tuple(row)
