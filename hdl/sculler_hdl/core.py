"""The core that a design asks for."""

from amaranth.lib import wiring

from sculler_hdl import pipelined
from sculler_hdl.compact import microcode
from sculler_hdl.compact.core import CompactCore
from sculler_hdl.pipelined import PipelinedCore
from sculler_model.design import Design
from sculler_model.golden import Timing


def build_core(design: Design, *, primitive: bool = True) -> wiring.Component:
    """The Amaranth component of a design.

    Args:
        design: the design; `hardware.core` says which core.
        primitive: whether to instantiate the target's own blocks; False for Amaranth's simulator,
            which cannot run instances, with the same behaviour on every clock.

    Raises:
        InputError: `hardware.multipliers` are too few.
    """
    if design.hardware.core == "compact":
        return CompactCore(design, primitive=primitive)
    return PipelinedCore(design, primitive=primitive)


def timing(design: Design) -> Timing:
    """The clocks that the design's core takes.

    Raises:
        InputError: as `build_core`.
    """
    if design.hardware.core == "compact":
        return microcode.timing(design)
    return pipelined.timing(design)
