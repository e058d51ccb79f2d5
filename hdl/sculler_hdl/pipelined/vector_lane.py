"""A lane of the vector engine: the sum of products, a product a clock."""

from __future__ import annotations

from amaranth import Cat, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.accumulator import Accumulator
from sculler_hdl.lib.adder_tree import emit_adder_tree
from sculler_hdl.lib.delay import ControlDelay, SkewedSignal
from sculler_hdl.lib.multiplier import emit_multiplier
from sculler_hdl.plan.arrival import limbs
from sculler_hdl.plan.vector.engine import VectorEnginePlan


class VectorLane(wiring.Component):
    """total' = total +- left * right * 2^(digit * digit_bits), for one axis or three in turn.

    Members:
        left, right (clock 0): the operands, signed.
        subtract, digit, step, last (clock 0): the product is taken away; its digit; it is taken at
            all; the total that it goes into is finished with it, and the next starts anew.
        initial (clock `plan.accumulator.clock`): what a total starts from, with its first step.
        output (clock `plan.whole`): the total with the step.

    Latency: `plan.whole`; one product a clock.

    Args:
        plan: of the engine.
        primitive: whether to instantiate the target's multiplier blocks.
    """

    def __init__(self, plan: VectorEnginePlan, *, primitive: bool = True) -> None:
        self.plan, self.primitive = plan, primitive
        super().__init__(
            {
                "left": In(plan.multiplier.left.bits),
                "right": In(plan.multiplier.right.bits),
                "subtract": In(1),
                "digit": In(range(plan.page.digit_count)),
                "step": In(1),
                "last": In(1),
                "initial": In(plan.accumulator.total.bits),
                "output": Out(plan.accumulator.total.bits),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m, plan = Module(), self.plan
        made, adder = plan.multiplier, plan.accumulator
        left = SkewedSignal(m, "left", self.left, made.left_arrival)
        right = SkewedSignal(m, "right", self.right, made.right_arrival)
        read = plan.product.result.bits
        terms = emit_multiplier(m, "unit", made, left, right, primitive=self.primitive, read=read)
        product = emit_adder_tree(m, "product", plan.product, terms)
        subtract = ControlDelay(m, "subtract", self.subtract)
        m.submodules.total = total = Accumulator(adder)
        m.d.comb += [
            total.input.eq(self._signed(m, product, subtract)),
            total.carry.eq(subtract.at_clock(adder.clock)),
            total.step.eq(ControlDelay(m, "step", self.step).at_clock(adder.clock)),
            total.last.eq(ControlDelay(m, "last", self.last).at_clock(adder.clock)),
            total.initial.eq(self.initial),
        ]
        whole = SkewedSignal(m, "whole", total.newest, adder.arrival)
        m.d.comb += self.output.eq(whole.at_clock(plan.whole))
        return m

    def _signed(self, m: Module, product: SkewedSignal, subtract: ControlDelay) -> Value:
        """The product in its place, inverted where it is to be subtracted."""
        plan, item = self.plan, self.plan.accumulator.item.bits
        words = [
            SkewedSignal(m, f"digit{i}", product.value, product.arrival, i * plan.page.digit_bits)
            for i in range(plan.page.digit_count)
        ]
        digits = [ControlDelay(m, f"digit_is_{i}", self.digit == i) for i in range(1, len(words))]
        pieces = []
        for q, lo, hi in limbs(item, plan.accumulator.limb):
            clock = plan.signed_clock + q
            chosen = words[0].slice_at(lo, hi, clock)
            for word, digit in zip(words[1:], digits, strict=True):
                chosen = Mux(digit.at_clock(clock), word.slice_at(lo, hi, clock), chosen)
            piece = Signal(hi - lo, name=f"signed_{lo}", reset_less=True)
            m.d.sync += piece.eq(chosen ^ subtract.at_clock(clock).replicate(hi - lo))
            pieces.append(piece)
        return Cat(*pieces)
