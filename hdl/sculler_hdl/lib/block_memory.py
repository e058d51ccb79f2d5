"""Which memories are meant to stand in block memory."""

from __future__ import annotations

LEAST_BITS = 4096
"""Of a memory that is meant for a block: what fills the smallest, iCE40's."""


def memory_attributes(words: int, bits: int) -> dict[str, str]:
    """`attrs` of a memory: it is meant for block memory, if it fills a block.

    The text says it in the words of each vendor's tools (`export.verilog_text`); what is smaller
    is left to their choice.

    Args:
        words: how many.
        bits: of each.
    """
    return {"ram_style": "block"} if words * bits >= LEAST_BITS else {}
