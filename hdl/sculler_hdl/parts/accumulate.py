"""Accumulation over a major interval."""

from amaranth import Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.parts.layout import vector
from sculler_model.wordlength import Interval


class Accumulator(wiring.Component):
    """Three running sums, restarted at each major interval's first sample.

    In a clock with `step`, ``after = (0 if start else before) + (input if add else 0)``; `before`
    shows that clock's addend base, `total` holds `after` from the next clock on.

    Latency 1 from `input` to `total`, 0 to `before`.

    Args:
        item: range of one addend.
        total: worst-case range of the sum; wide enough for every partial sum (wordlength.py).
    """

    latency = 1

    def __init__(self, item: Interval, total: Interval) -> None:
        self.range = total
        super().__init__(
            {
                "step": In(1),
                "start": In(1),
                "add": In(1),
                "input": In(vector(item)),
                "before": Out(vector(total)),
                "total": Out(vector(total)),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        for axis, name in enumerate("xyz"):
            held = Signal.like(self.total[axis], name=f"held_{name}", reset_less=True)
            before = Signal.like(held, name=f"before_{name}")
            after = (before + self.input[axis])[: len(held)].as_signed()
            m.d.comb += [
                before.eq(Mux(self.start, 0, held)),
                self.before[axis].eq(before),
                self.total[axis].eq(held),
            ]
            with m.If(self.step):
                m.d.sync += held.eq(Mux(self.add, after, before))
        return m
