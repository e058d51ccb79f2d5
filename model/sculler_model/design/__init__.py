"""The design file, validated whole, and everything that follows from it in exact integers.

`Design` is the file; `word_lengths` says how wide each number must be so that no input can
overflow; `Result` and the column names say what a core hands over each major interval.
It imports `algorithms`.
"""

from sculler_model.design.design import Design, Hardware
from sculler_model.design.names import SYSTEM_VERILOG, VHDL, fault
from sculler_model.design.options import read_response
from sculler_model.design.presets import PRESETS
from sculler_model.design.result import (
    AXES,
    COLUMNS,
    COMPONENTS,
    HIGH_RESOLUTION_COLUMNS,
    HIGH_RESOLUTION_VECTORS,
    STATUS_BITS,
    STATUS_FAULT,
    STATUS_LOST,
    STATUS_RAIL,
    STATUS_SHORT_HISTORY,
    VECTORS,
    Result,
    columns_of,
)
from sculler_model.design.vendor_blocks import BLOCKS
from sculler_model.design.word_lengths import (
    MAX_BITS,
    ZERO_RANGE,
    Interval,
    WordLengths,
    cross_range,
    total,
    word_lengths,
)

__all__ = [
    "AXES",
    "BLOCKS",
    "COLUMNS",
    "COMPONENTS",
    "HIGH_RESOLUTION_COLUMNS",
    "HIGH_RESOLUTION_VECTORS",
    "MAX_BITS",
    "PRESETS",
    "STATUS_BITS",
    "STATUS_FAULT",
    "STATUS_LOST",
    "STATUS_RAIL",
    "STATUS_SHORT_HISTORY",
    "SYSTEM_VERILOG",
    "VECTORS",
    "VHDL",
    "ZERO_RANGE",
    "Design",
    "Hardware",
    "Interval",
    "Result",
    "WordLengths",
    "columns_of",
    "cross_range",
    "fault",
    "read_response",
    "total",
    "word_lengths",
]
