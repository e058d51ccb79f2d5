"""Sums of the last n samples, where all of them weigh the same."""

from amaranth import Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.adder import add
from sculler_hdl.lib.delay import ControlDelay, SkewedSignal
from sculler_hdl.plan.arrival import at_once, later, spans
from sculler_hdl.plan.running_sum import RunningSumPlan


class RunningSum(wiring.Component):
    """The sum of one axis over a minor interval: what a total has grown by since the last one.

    The total runs on for ever, modulo what the sum can hold, so nothing is ever cleared:

        sample ─▶ total ─┬─────────────▶ (-) ─▶ output
                         └▶ total before ─┘

    Members:
        step (clock 0): a sample stands on `sample`.
        last (clock 0): it is the last of its minor interval.
        sample (clock 0): the newest sample.
        output: the sum, as `plan.arrival` says after a step with `last`; else it means nothing.

    Args:
        plan: the plan.
        inverted: how its flags are held (`ControlDelay`), to keep them apart from another's.
    """

    def __init__(self, plan: RunningSumPlan, *, inverted: bool = False) -> None:
        self.plan = plan
        self.inverted = inverted
        super().__init__(
            {
                "step": In(1),
                "last": In(1),
                "sample": In(plan.counts.bits),
                "output": Out(plan.result.bits),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m, plan = Module(), self.plan
        step = ControlDelay(m, "step", self.step, inverted=self.inverted)
        last = ControlDelay(m, "last", self.last, inverted=self.inverted)
        bits = plan.result.bits
        total = Signal(bits)
        made = add(
            SkewedSignal(m, "total", total, later(plan.total_arrival, -1)),
            SkewedSignal(m, "sample", self.sample, at_once(plan.counts.bits)),
            "total",
            bits,
            0,
            plan.limb,
            step=step.at_clock,
        )
        m.d.comb += total.eq(made.value)
        before = Signal(bits)
        for lo, hi, clock in spans(plan.total_arrival):
            with m.If(last.at_clock(clock)):
                m.d.sync += before[lo:hi].eq(total[lo:hi])
        grown = add(
            SkewedSignal(m, "total", total, plan.total_arrival),
            SkewedSignal(m, "before", before, plan.total_arrival),
            "grown",
            bits,
            1,
            plan.limb,
            subtract=True,
        )
        m.d.comb += self.output.eq(grown.value)
        return m
