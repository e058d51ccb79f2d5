"""The clocks that a design's core takes."""

from sculler_hdl.plan.compact.plan import plan_compact
from sculler_hdl.plan.pipelined import plan_pipelined
from sculler_model.design import Design
from sculler_model.golden import Timing


def timing(design: Design) -> Timing:
    """The clocks that the design's core takes; planned, not built.

    Raises:
        InputError: `hardware.multipliers` are too few.
    """
    if design.hardware.core == "compact":
        return plan_compact(design).timing
    return plan_pipelined(design).timing
