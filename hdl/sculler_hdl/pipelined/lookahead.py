"""One axis of high-resolution position: the sums that count with the samples to come.

`sculler_hdl.plan.position` has the algebra.
"""

from __future__ import annotations

from amaranth import Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.accumulator import Accumulator
from sculler_hdl.lib.adder_tree import emit_adder_tree, emit_dot_product
from sculler_hdl.lib.delay import ControlDelay, SkewedSignal
from sculler_hdl.lib.hold import emit_gated, emit_previous
from sculler_hdl.plan.accumulator import AccumulatorPlan
from sculler_hdl.plan.position import GATED, LookaheadPlan


class LookaheadAxis(wiring.Component):
    """s_alpha and C of one axis of the gyro, or s_nu and D of one of the accelerometer.

    Members:
        step (clock 0): a sample stands on `sample`.
        first, last (clock 0): it is the first, the last of its major interval.
        weight, sample (clock 0): p and the sample.
        doubly: s_alpha or s_nu, as `plan.arrival` says.
        factor: C or D, as `plan.factor` says.

    One sample every `gap` clocks.  Reset makes the sample before the first one 0.

    Latency: `plan.arrival` and `plan.factor`, from a sample's step.

    Args:
        plan: the plan.
    """

    def __init__(self, plan: LookaheadPlan) -> None:
        self.plan = plan
        super().__init__(
            {
                "step": In(1),
                "first": In(1),
                "last": In(1),
                "weight": In(plan.weight_bits),
                "sample": In(plan.counts.bits),
                "doubly": Out(plan.doubly.total.bits),
                "factor": Out(plan.factor.range.bits),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m, plan = Module(), self.plan
        step, last = ControlDelay(m, "step", self.step), ControlDelay(m, "last", self.last)
        values: dict[str, Value] = {"sample": self.sample}

        def word(name: str) -> SkewedSignal:
            return SkewedSignal(m, name, values[name], plan.words[name].arrival)

        def accumulate(name: str, part: AccumulatorPlan, item: Value) -> Accumulator:
            m.submodules[name] = adder = Accumulator(part, apart=part.gap == 1)
            m.d.comb += [
                adder.step.eq(step.at_clock(part.clock)),
                adder.last.eq(last.at_clock(part.clock)),
                adder.input.eq(item),
            ]
            return adder

        rows = []
        for bit in range(plan.weight_bits):
            row = Signal(plan.counts.bits, name=f"row{bit}", reset_less=True)
            m.d.sync += row.eq(Mux(self.weight[bit], self.sample, 0))
            rows.append(row)
        values["product"] = emit_adder_tree(m, "product", plan.product, rows).value
        values["before"] = emit_previous(word("sample"), step)
        values["product_before"] = emit_previous(word("product"), step)
        start = Signal(plan.counts.bits, reset_less=True)
        with m.If(self.step & self.first):
            m.d.sync += start.eq(values["before"])
        values["start"] = start
        values["sum"] = accumulate("sum", plan.sum, self.sample).before
        used = {*plan.side.ahead, *plan.side.factor}
        for name, gated in GATED.items():
            if name in used:
                values[name] = emit_gated(last, word(gated.word), level=int(gated.last))

        item = emit_dot_product(m, "trend_item", plan.trend_item, values)
        values["trend"] = accumulate("trend", plan.trend, item).before
        values["ahead"] = emit_dot_product(m, "ahead", plan.ahead, values)
        doubly = accumulate(
            "doubly_sum", plan.doubly, emit_dot_product(m, "doubly_item", plan.doubly_item, values)
        )
        m.d.comb += [
            self.factor.eq(emit_dot_product(m, "whole", plan.whole, values)),
            self.doubly.eq(doubly.newest),
        ]
        return m
