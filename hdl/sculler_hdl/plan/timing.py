"""The clocks that a design's core takes."""

from dataclasses import replace

from sculler_hdl.plan.compact.plan import plan_compact
from sculler_hdl.plan.compensation import plan_compensation
from sculler_hdl.plan.pipelined import plan_pipelined
from sculler_hdl.plan.pipelined_channels import plan_pipelined_channels
from sculler_model.design import Design
from sculler_model.golden import Timing

LOOKING = 3
"""Clocks that a hardened pipelined core of two copies looks at a result before it shows it."""


def timing(design: Design) -> Timing:
    """The clocks that the design's core takes; planned, not built.

    Raises:
        InputError: `hardware.multipliers` are too few.
    """
    if design.compensation is not None:
        return replace(timing(design.inner), compensation=plan_compensation(design).clocks)
    if design.hardware.core == "compact":
        return plan_compact(design).timing
    if design.channels > 1:
        return plan_pipelined_channels(design).timing
    made = plan_pipelined(design).timing
    if design.hardware.hardening != "detect":
        return made
    return replace(
        made,
        latency=made.latency + LOOKING,
        handover_spacing=made.handover_spacing + LOOKING,
    )
