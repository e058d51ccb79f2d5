"""The core that a design asks for."""

from __future__ import annotations

from sculler_hdl.channels.core import ChannelCore
from sculler_hdl.compact.core import CompactCore
from sculler_hdl.compensated.core import CompensatedCore
from sculler_hdl.hardened.compact import HardenedCompactCore
from sculler_hdl.hardened.pipelined import HardenedPipelinedCore
from sculler_hdl.pipelined.core import PipelinedCore
from sculler_hdl.pipelined_channels.core import PipelinedChannelCore
from sculler_model.design import Design

Core = (
    CompactCore
    | PipelinedCore
    | HardenedCompactCore
    | HardenedPipelinedCore
    | CompensatedCore
    | ChannelCore
    | PipelinedChannelCore
)


def build_core(design: Design, *, primitive: bool = True) -> Core:
    """The Amaranth component of a design.

    Args:
        design: the design; `hardware.core` says which core.
        primitive: whether to instantiate the target's own blocks; False for Amaranth's simulator,
            which cannot run instances, with the same behaviour on every clock.

    Raises:
        InputError: `hardware.multipliers` are too few.
    """
    if design.compensation is not None:
        return CompensatedCore(design, primitive=primitive)
    if design.channels > 1 and design.hardware.core == "pipelined":
        return PipelinedChannelCore(design, primitive=primitive)
    if design.channels > 1:
        return ChannelCore(design, primitive=primitive)
    if design.hardware.hardening is not None:
        compact = design.hardware.core == "compact"
        made = HardenedCompactCore if compact else HardenedPipelinedCore
        return made(design, primitive=primitive)
    if design.hardware.core == "compact":
        return CompactCore(design, primitive=primitive)
    return PipelinedCore(design, primitive=primitive)
