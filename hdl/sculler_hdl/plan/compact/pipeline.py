"""When each part of an instruction acts: the one place that knows the engine's delays."""

from __future__ import annotations

from dataclasses import dataclass

from sculler_hdl.plan.compact.digits import OPERAND
from sculler_hdl.plan.multiplier import BLOCK_LATENCY
from sculler_hdl.targets import TARGETS
from sculler_model.design import Design

SERIAL_STEP = 20
"""Clocks per instruction without a multiplier block: one to load, 18 bits, one to spare."""


@dataclass(frozen=True)
class Pipeline:
    """Delays in steps; a step is the time of one instruction.

    An instruction's fields act one after another, each so many steps after the operand addresses:

        -1         the condition on the left operand
        0          operand addresses
        operand    left and right operand arrive, the latter chosen between two memories
        addend     the product arrives and is negated where it is subtracted
        accumulate it is added
        store      the sum's low digit is written

    Attributes:
        step: clocks per instruction.
        memory: from a memory's address to its data.
        product: from the operands to their product.
    """

    step: int
    memory: int
    product: int

    @property
    def operand(self) -> int:
        return 1 + self.memory

    @property
    def addend(self) -> int:
        return self.operand + self.product

    @property
    def accumulate(self) -> int:
        return self.addend + 1

    @property
    def store(self) -> int:
        """Also the distance from an instruction to the first that can read what it stores."""
        return self.accumulate + 1


def engine_pipeline(design: Design) -> Pipeline:
    """The delays of a design's compact core."""
    target = TARGETS[design.hardware.target]
    if design.hardware.multipliers == 0:
        return Pipeline(SERIAL_STEP, target.memory_latency, 0)
    # a narrower block leaves low bits, whose products are added a clock later
    narrow = min(target.multiplier_bits) < OPERAND.bits
    return Pipeline(1, target.memory_latency, BLOCK_LATENCY + narrow)
