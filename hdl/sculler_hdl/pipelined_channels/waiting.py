"""The counts and marks of samples that wait to be launched."""

from __future__ import annotations

from amaranth import Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.layout import chosen
from sculler_hdl.plan.pipelined_channels import WAITING


class Waiting(wiring.Component):
    """Samples in the order in which they were taken, in registers.

    Members:
        take, sample (in): a sample is taken in this clock, and all that is known of it.
        told, lost (in): whether a sample was lost before it, for each in turn, some clocks later.
        slot (in): which of them is wanted, counted in turn.
        chosen, chosen_lost (out): that one, in the same clock.

    Args:
        bits: of a sample.
    """

    def __init__(self, bits: int) -> None:
        super().__init__(
            {
                "take": In(1),
                "sample": In(bits),
                "told": In(1),
                "lost": In(1),
                "slot": In(range(WAITING)),
                "chosen": Out(bits),
                "chosen_lost": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        bits = len(self.sample)
        samples = [Signal(bits, name=f"sample_{i}", reset_less=True) for i in range(WAITING)]
        losses = [Signal(name=f"lost_{i}", reset_less=True) for i in range(WAITING)]
        newest, telling = Signal(range(WAITING)), Signal(range(WAITING))
        for number, (sample, lost) in enumerate(zip(samples, losses, strict=True)):
            with m.If(self.take & (newest == number)):
                m.d.sync += sample.eq(self.sample)
            with m.If(self.told & (telling == number)):
                m.d.sync += lost.eq(self.lost)
        with m.If(self.take):
            m.d.sync += newest.eq(newest + 1)
        with m.If(self.told):
            m.d.sync += telling.eq(telling + 1)
        m.d.comb += [
            self.chosen.eq(chosen(self.slot, samples)),
            self.chosen_lost.eq(chosen(self.slot, losses)),
        ]
        return m
