"""What stands before the core where a design has [compensation]: one multiplier that takes turns.

A sample's six sums (`CompensationPlan`) are worked out one product a clock, output after output.
An offset is products too: of constants that are powers of two.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple

from sculler_hdl.plan.accumulator import AccumulatorPlan
from sculler_hdl.plan.adder_tree import AdderTreePlan
from sculler_hdl.plan.arrival import Limbs, at_once, evenly, last_clock
from sculler_hdl.plan.multiplier import MultiplierPlan
from sculler_hdl.targets import TARGETS, Target
from sculler_model.design import ZERO_RANGE, Design, Interval
from sculler_model.errors import InputError

COUNTS = 6
"""Of a sample."""

PLACES = 8
"""Words of a sample in the memory, of which the counts are the first six."""

FIRST_STEP = COUNTS
"""Clock of the first step, after the one that takes the sample: the newest counts are written in
clocks 1 to 6, and the first word is read in the clock after its step."""


class Step(NamedTuple):
    """One product.

    Attributes:
        source, lag: of the count, as `Term` has them; 0 where it is a constant.
        constant: power of two that is multiplied; None for a count.
        factor: that it is multiplied by.
        last: of its output.
    """

    source: int
    lag: int
    constant: int | None
    factor: int
    last: bool


@dataclass(frozen=True)
class CompensationStage:
    """The plan of the stage.

    Attributes:
        design: the design, with compensation.
    """

    design: Design

    @property
    def target(self) -> Target:
        """Whose blocks it uses."""
        return TARGETS[self.design.hardware.target]

    @cached_property
    def counts(self) -> Interval:
        """Range of a count of either sensor."""
        return self.design.words.gyro | self.design.words.accel

    @cached_property
    def sums(self) -> Interval:
        """Range of an output of either kind; sums on the way may wrap, and wrap back."""
        plan, words = self.design.compensation_plan, self.design.words
        assert plan is not None, "no [compensation]"
        gyro, accel = plan.ranges(words.gyro, words.accel)
        return gyro | accel

    @cached_property
    def reach(self) -> int:
        """How many samples before the newest the oldest one lies that is used."""
        plan = self.design.compensation_plan
        assert plan is not None, "no [compensation]"
        return plan.reach

    @property
    def slot_bits(self) -> int:
        """Of the number of a sample in the memory."""
        return self.reach.bit_length()

    @cached_property
    def steps(self) -> tuple[Step, ...]:
        """The products in their order."""
        plan = self.design.compensation_plan
        assert plan is not None, "no [compensation]"
        found: list[Step] = []
        for terms, offset in zip(plan.outputs, plan.offsets, strict=True):
            steps = [Step(term.source, term.lag, None, term.factor, False) for term in terms]
            steps += [Step(0, 0, power, digit, False) for power, digit in self._digits(offset)]
            found += [*steps[:-1], steps[-1]._replace(last=True)]
        return tuple(found)

    def _digits(self, offset: int) -> Iterator[tuple[int, int]]:
        """The offset as a sum of factors times powers of two that a count's word holds."""
        highest = self.counts.bits - 2
        step, power = min(self.factor_bits - 1, highest), 0
        while offset:
            left = offset >> power
            if power + step > highest or Interval(left, left).bits <= self.factor_bits:
                yield power, left
                return
            digit = left & (1 << step) - 1
            if digit:
                yield power, digit
            power += step

    @cached_property
    def factor_bits(self) -> int:
        """Of a factor: as wide as those of counts, and as the highest power leaves of an offset."""
        plan = self.design.compensation_plan
        assert plan is not None, "no [compensation]"
        factors = [term.factor for terms in plan.outputs for term in terms]
        bits = max(Interval(each, each).bits for each in factors)
        offsets = Interval(min(plan.offsets), max(plan.offsets)).bits
        highest = self.counts.bits - 2
        while True:
            step = min(bits - 1, highest)
            if offsets - highest // step * step <= bits:
                return bits
            bits += 1

    @property
    def factors(self) -> Interval:
        """Range of a factor."""
        return Interval.signed(self.factor_bits)

    @cached_property
    def limb(self) -> Limbs:
        """How sums are cut: into the shortest limbs, for there is time."""
        return evenly(self.sums.bits, min(self.target.limb_bits), 2)

    @cached_property
    def multiplier(self) -> MultiplierPlan:
        """The product of a count and a factor."""
        left, right = self.counts | ZERO_RANGE, self.factors
        return MultiplierPlan(
            self.target, left, right, at_once(left.bits, 0), at_once(right.bits, 0)
        )

    @cached_property
    def product(self) -> AdderTreePlan:
        """Its additions."""
        made = self.multiplier
        return AdderTreePlan(made.addends, made.left * made.right, self.limb)

    @cached_property
    def accumulator(self) -> AccumulatorPlan:
        """What sums the products of an output up."""
        item = self.product.result
        return AccumulatorPlan(item, self.product.arrival, self.sums | ZERO_RANGE, self.limb)

    @property
    def operands(self) -> int:
        """Clocks from a step to its operands at the multiplier."""
        return 1 + self.target.memory_latency + 1

    @property
    def summed(self) -> int:
        """Clocks from a step that is its output's last to the whole sum."""
        return self.operands + last_clock(self.accumulator.arrival)

    @property
    def clocks(self) -> int:
        """From the clock that takes a sample to the first that offers it, compensated."""
        return FIRST_STEP + len(self.steps) - 1 + self.summed + 1

    @property
    def resources(self) -> dict[str, int]:
        """Figures for the manifest."""
        return {
            "compensation_multipliers": self.multiplier.block_count,
            "compensation_products": len(self.steps),
        }


@lru_cache(maxsize=32)
def plan_compensation(design: Design) -> CompensationStage:
    """The stage of a design that has compensation.

    Raises:
        InputError: it has lever arms, which are not built.
    """
    plan = design.compensation_plan
    if plan is not None and plan.has_products:
        raise InputError(
            "compensation.arms_m: is built in the models and the host, not in hardware yet; leave"
            " it out"
        )
    return CompensationStage(design)
