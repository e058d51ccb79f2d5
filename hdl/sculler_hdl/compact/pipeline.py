"""When each part of an instruction acts: the one place that knows the engine's delays."""

from __future__ import annotations

from dataclasses import dataclass

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


def memory_latency(target: str) -> int:
    """Clocks from a block memory's address to its data.

    2 uses the output register inside the block, without which it is slow.  The iCE40 has none.
    """
    return 1 if target == "ice40" else 2


def product_latency(target: str) -> int:
    """Clocks of an 18 x 18 product: one multiplier block, and its fringe where it is narrower."""
    return 4 if target == "ice40" else 3


def pipeline(design: Design) -> Pipeline:
    """The delays of a design's compact core."""
    hardware = design.hardware
    memory = memory_latency(hardware.target)
    if hardware.multipliers == 0:
        return Pipeline(SERIAL_STEP, memory, 0)
    return Pipeline(1, memory, product_latency(hardware.target))
