"""Sample history: the newest counts and as many older ones as any tap or weight reaches."""

from amaranth import Module, Signal
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.parts.layout import vector
from sculler_model.wordlength import Interval


class History(wiring.Component):
    """Shift register of three-axis counts: `output[d]` is the sample d accepted samples back.

    Reset clears it, because samples before the first one count as zero.

    Args:
        counts: range of one count.
        reach: furthest distance kept.
    """

    latency = 1

    def __init__(self, counts: Interval, reach: int) -> None:
        self.counts = counts
        self.reach = reach
        super().__init__(
            {
                "shift": In(1),
                "input": In(vector(counts)),
                "output": Out(data.ArrayLayout(vector(counts), reach + 1)),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        newer = self.input
        for d in range(self.reach + 1):
            sample = Signal(vector(self.counts), name=f"back{d}")
            with m.If(self.shift):
                m.d.sync += sample.eq(newer)
            m.d.comb += self.output[d].eq(sample)
            newer = sample
        return m
