"""Sums of the last n samples, where all of them weigh the same."""

from amaranth import Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.parts.words import (
    Arrival,
    FlagLine,
    Limbs,
    Word,
    add,
    at_once,
    later,
    limbs,
    spans,
)
from sculler_model.design import Interval


class Running:
    """The plan of a `RunningSum`.

    Args:
        counts: range of one count.
        result: range of the sum.
        limb: how sums are cut.

    Attributes:
        arrival: clocks from the last sample's `step` at which the bits of the sum are there.
    """

    def __init__(self, counts: Interval, result: Interval, limb: Limbs) -> None:
        self.counts = counts
        self.result = result
        self.limb = limb
        self.total_arrival: Arrival = tuple(
            (hi - lo, q + 1) for q, lo, hi in limbs(result.bits, limb)
        )
        self.arrival: Arrival = later(self.total_arrival, 1)


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
        inverted: how its flags are held (`FlagLine`), to keep them apart from another's.
    """

    def __init__(self, plan: Running, *, inverted: bool = False) -> None:
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
        step = FlagLine(m, "step", self.step, inverted=self.inverted)
        last = FlagLine(m, "last", self.last, inverted=self.inverted)
        bits = plan.result.bits
        total = Signal(bits)
        made = add(
            Word(m, "total", total, later(plan.total_arrival, -1)),
            Word(m, "sample", self.sample, at_once(plan.counts.bits)),
            "total",
            bits,
            0,
            plan.limb,
            step=step.at,
        )
        m.d.comb += total.eq(made.value)
        before = Signal(bits)
        for lo, hi, clock in spans(plan.total_arrival):
            with m.If(last.at(clock)):
                m.d.sync += before[lo:hi].eq(total[lo:hi])
        grown = add(
            Word(m, "total", total, plan.total_arrival),
            Word(m, "before", before, plan.total_arrival),
            "grown",
            bits,
            1,
            plan.limb,
            subtract=True,
        )
        m.d.comb += self.output.eq(grown.value)
        return m
