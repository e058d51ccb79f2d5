"""The core that a design asks for."""

from __future__ import annotations

from sculler_hdl.compact.core import CompactCore
from sculler_hdl.pipelined.core import PipelinedCore
from sculler_model.design import Design

Core = CompactCore | PipelinedCore


def build_core(design: Design, *, primitive: bool = True) -> Core:
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
