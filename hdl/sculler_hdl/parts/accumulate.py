"""Accumulation over a major interval."""

from amaranth import C, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.parts.layout import vector
from sculler_model.wordlength import Interval


class Accumulator(wiring.Component):
    """Three running sums, restarted at each major interval's first sample.

    In a clock with `step`, ``total' = before + (input if add else 0)``, where `before` is 0 at
    `start`, else `total`; total' shows on `total` from the next clock on.

    Latency 1 from `input` to `total`, 0 to `before`.

    Args:
        item: range of one addend.
        total: worst-case range of the sum; wide enough for every partial sum (wordlength.py).
        before: range of the sum before its last item, if narrower.
    """

    latency = 1

    def __init__(self, item: Interval, total: Interval, before: Interval | None = None) -> None:
        super().__init__(
            {
                "step": In(1),
                "start": In(1),
                "add": In(1),
                "input": In(vector(item)),
                "before": Out(vector(before or total)),
                "total": Out(vector(total)),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        for axis, name in enumerate("xyz"):
            held = Signal.like(self.total[axis], name=f"held_{name}", reset_less=True)
            before = Signal.like(self.before[axis], name=f"before_{name}")
            after = (before + self.input[axis])[: len(held)].as_signed()
            m.d.comb += [
                before.eq(Mux(self.start, C(0, before.shape()), held[: len(before)].as_signed())),
                self.before[axis].eq(before),
                self.total[axis].eq(held),
            ]
            with m.If(self.step):
                m.d.sync += held.eq(Mux(self.add, after, before))
        return m
