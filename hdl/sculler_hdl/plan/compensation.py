"""What stands before the core where a design has [compensation]: one multiplier that takes turns.

A sample's six sums (`CompensationPlan`) are worked out one product a clock, output after output.
An offset is products too: of constants that are powers of two.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from functools import cached_property, lru_cache
from typing import NamedTuple

from sculler_hdl.plan.accumulator import AccumulatorPlan
from sculler_hdl.plan.adder_tree import AdderTreePlan
from sculler_hdl.plan.arrival import Limbs, at_once, evenly, last_clock, lowest
from sculler_hdl.plan.multiplier import MultiplierPlan
from sculler_hdl.targets import TARGETS, Target
from sculler_model.design import CompensationPlan, Design, Interval

COUNTS = 6
"""Of a sample."""

PLACES = 8
"""Words of a sample in the memory, of which the counts are the first six."""

FIRST_STEP = COUNTS
"""Clock of the first step, after the one that takes the sample: the newest counts are written in
clocks 1 to 6, and the first word is read in the clock after its step."""


class Kind(Enum):
    """What a step does."""

    HOLD = "a gyro's count is read and held"
    PAIR = "two held counts are multiplied, and their product held"
    WAIT = "nothing"
    COUNT = "a count times a factor"
    CONSTANT = "a power of two times a factor, of an offset"
    PRODUCT = "a held product times a factor"


class Step(NamedTuple):
    """What begins in one clock.

    Attributes:
        kind: what it does.
        source, lag: of a count, as `Term` has them.
        power: of a constant.
        pair: the counts that are multiplied.
        product: number of the held product.
        factor: that a count, a constant or a product is multiplied by.
        last: of its output.
    """

    kind: Kind
    source: int = 0
    lag: int = 0
    power: int = 0
    pair: tuple[int, int] = (0, 0)
    product: int = 0
    factor: int = 0
    last: bool = False

    @property
    def adds(self) -> bool:
        """Whether it adds to a sum."""
        return self.kind in (Kind.COUNT, Kind.CONSTANT, Kind.PRODUCT)


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
        words = self.design.words
        gyro, accel = self.plan.ranges(words.gyro, words.accel)
        return gyro | accel

    @cached_property
    def reach(self) -> int:
        """How many samples before the newest the oldest one lies that is used."""
        return self.plan.reach

    @property
    def slot_bits(self) -> int:
        """Of the number of a sample in the memory."""
        return self.reach.bit_length()

    @cached_property
    def plan(self) -> CompensationPlan:
        """The integers."""
        plan = self.design.compensation_plan
        assert plan is not None, "no [compensation]"
        return plan

    @cached_property
    def pairs(self) -> tuple[tuple[int, int], ...]:
        """The gyros whose counts are multiplied with each other."""
        every = {(term.first, term.second) for terms in self.plan.products for term in terms}
        return tuple(sorted(every))

    @cached_property
    def steps(self) -> tuple[Step, ...]:
        """All that begins, clock by clock: held counts and their products first, then the sums."""
        plan = self.plan
        sums: list[Step] = []
        for terms, products, offset in zip(plan.outputs, plan.products, plan.offsets, strict=True):
            steps = [Step(Kind.COUNT, t.source, t.lag, factor=t.factor) for t in terms]
            steps += [Step(Kind.CONSTANT, power=p, factor=d) for p, d in self._digits(offset)]
            steps += [
                Step(Kind.PRODUCT, product=self.pairs.index(t[:2]), factor=t.factor)
                for t in products
            ]
            sums += [*steps[:-1], steps[-1]._replace(last=True)]
        if not self.pairs:
            return tuple(sums)
        held = [Step(Kind.HOLD, axis, plan.delay) for axis in range(COUNTS // 2)]
        held += [Step(Kind.PAIR, pair=pair) for pair in self.pairs]
        first = next(i for i, step in enumerate(sums) if step.kind == Kind.PRODUCT)
        waits = max(0, last_clock(self.product.arrival) + 1 - first)
        return (*held, *[Step(Kind.WAIT)] * waits, *sums)

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
        plan = self.plan
        factors = [term.factor for terms in plan.outputs for term in terms]
        factors += [term.factor for products in plan.products for term in products]
        bits = max(Interval(each, each).bits for each in factors)
        offsets = Interval(min(plan.offsets), max(plan.offsets)).bits
        highest = self.counts.bits - 2
        while True:
            step = min(bits - 1, highest)
            if offsets - highest // step * step <= bits:
                return bits
            bits += 1

    @property
    def left(self) -> Interval:
        """Range of what is multiplied: a count, or a product of two."""
        bits = self.counts.bits
        return Interval.signed(2 * bits if self.pairs else bits)

    @property
    def right(self) -> Interval:
        """Range of what it is multiplied by: a factor, or a count."""
        return Interval.signed(max(self.factor_bits, self.counts.bits * bool(self.pairs)))

    @cached_property
    def limb(self) -> Limbs:
        """How sums are cut: limbs that are neither slow nor many, for those ask for registers."""
        lengths = self.target.limb_bits
        return evenly(self.sums.bits, lengths[len(lengths) // 2])

    @cached_property
    def multiplier(self) -> MultiplierPlan:
        """The multiplier that takes turns."""
        left, right = self.left, self.right
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
        product = self.product
        bits = min(product.result.bits, self.sums.bits)  # the others cannot matter
        item = Interval.signed(bits)
        return AccumulatorPlan(item, lowest(product.arrival, bits), self.sums, self.limb)

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
            "compensation_products": sum(step.adds for step in self.steps),
        }


@lru_cache(maxsize=32)
def plan_compensation(design: Design) -> CompensationStage:
    """The stage of a design that has compensation."""
    return CompensationStage(design)
