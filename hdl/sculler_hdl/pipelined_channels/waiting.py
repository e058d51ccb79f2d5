"""The counts and marks of samples that wait to be launched."""

from __future__ import annotations

from amaranth import Array, Cat, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

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
        samples = Array(Signal(bits, name=f"sample_{i}", reset_less=True) for i in range(WAITING))
        losses = Array(Signal(name=f"lost_{i}", reset_less=True) for i in range(WAITING))
        newest, telling = Signal(range(WAITING)), Signal(range(WAITING))
        with m.If(self.take):
            m.d.sync += [samples[newest].eq(self.sample), newest.eq(newest + 1)]
        with m.If(self.told):
            m.d.sync += [losses[telling].eq(self.lost), telling.eq(telling + 1)]
        chosen = Cat(samples[self.slot], losses[self.slot])
        m.d.comb += Cat(self.chosen, self.chosen_lost).eq(chosen)
        return m
