"""The design file, validated whole, and everything that follows from it in exact integers.

`Design` is the file; `word_lengths` says how wide each number must be so that no input can
overflow; `Result` and the column names say what a core hands over each major interval.
It imports `algorithms`.
"""

from sculler_model.design.bus import Bus
from sculler_model.design.compensation import Compensation
from sculler_model.design.compensation_plan import CompensationPlan, Term
from sculler_model.design.design import Design
from sculler_model.design.filters import at_another_rate
from sculler_model.design.hardware import Hardware
from sculler_model.design.higher_order_words import DualRange, HigherOrderWords
from sculler_model.design.interval import (
    ZERO_RANGE,
    Interval,
    cross_range,
    range_of_sum,
)
from sculler_model.design.names import RESERVED_WORDS, name_fault
from sculler_model.design.presets import PRESETS
from sculler_model.design.reading import faults_of
from sculler_model.design.result import (
    AXES,
    COLUMNS,
    COMPONENTS,
    EVERY_COLUMNS,
    FOURTH_ORDER_COLUMNS,
    FOURTH_ORDER_VECTORS,
    HIGH_RESOLUTION_COLUMNS,
    HIGH_RESOLUTION_VECTORS,
    STATUS_BITS,
    STATUS_FAULT,
    STATUS_LOST,
    STATUS_RAIL,
    STATUS_SHORT_HISTORY,
    STATUS_UPSET,
    THIRD_ORDER_COLUMNS,
    THIRD_ORDER_VECTORS,
    VECTORS,
    Result,
    columns_of,
)
from sculler_model.design.scales import scales_hash
from sculler_model.design.sensor_errors import (
    AxisErrors,
    Drawn,
    SensorErrors,
    why_not_undone,
)
from sculler_model.design.word_lengths import (
    MAX_BITS,
    WordLengths,
    word_lengths,
)

__all__ = [
    "AXES",
    "COLUMNS",
    "COMPONENTS",
    "EVERY_COLUMNS",
    "FOURTH_ORDER_COLUMNS",
    "FOURTH_ORDER_VECTORS",
    "HIGH_RESOLUTION_COLUMNS",
    "HIGH_RESOLUTION_VECTORS",
    "MAX_BITS",
    "PRESETS",
    "RESERVED_WORDS",
    "STATUS_BITS",
    "STATUS_FAULT",
    "STATUS_LOST",
    "STATUS_RAIL",
    "STATUS_SHORT_HISTORY",
    "STATUS_UPSET",
    "THIRD_ORDER_COLUMNS",
    "THIRD_ORDER_VECTORS",
    "VECTORS",
    "ZERO_RANGE",
    "AxisErrors",
    "Bus",
    "Compensation",
    "CompensationPlan",
    "Design",
    "Drawn",
    "DualRange",
    "Hardware",
    "HigherOrderWords",
    "Interval",
    "Result",
    "SensorErrors",
    "Term",
    "WordLengths",
    "at_another_rate",
    "columns_of",
    "cross_range",
    "faults_of",
    "name_fault",
    "range_of_sum",
    "scales_hash",
    "why_not_undone",
    "word_lengths",
]
