"""Writes a sample's digits into its channel's part of the sample memory."""

from __future__ import annotations

from amaranth import C, Cat, Module, Mux, Signal, Value
from amaranth.lib.wiring import In

from sculler_hdl.compact.loader import Loader
from sculler_hdl.plan.compact.plan import CompactPlan


class ChannelLoader(Loader):
    """As the `Loader` of one channel, but that a sample waits until its slot is known.

    The counts are taken in one clock.  Some clocks later `begin` comes with the slot.  From the
    clock after it on a digit is written each clock; with `zeros`, zeros in all slots before them.

    Members:
        take, gyro, accel, busy, loaded, rail, slot, write, address, data: those of `Loader`; busy
            is low after reset, and slot the one that is written.
        begin, new_slot, zeros (in): as above.
    """

    def __init__(self, plan: CompactPlan) -> None:
        further = {"begin": In(1), "new_slot": In(plan.sizes.slot_bits), "zeros": In(1)}
        super().__init__(plan, further=further)

    def elaborate(self, platform: object) -> Module:
        m = Module()
        counts = self._counts()
        index = Signal(range(self.words))
        clearing, last = Signal(), Signal()
        loads: Value = self.busy & ~clearing
        m.d.comb += [
            last.eq(index == self.words - 1),
            self.loaded.eq(loads & last),
            self.write.eq(self.busy),
            self.address.eq(Cat(index, self.slot)),
            self.data.eq(Mux(clearing, 0, self._digit(counts[0], index))),
        ]
        top = C(1) if self.digits == 1 else index[0]
        self._move(m, counts, loads & top)
        self._find_rail(m, counts[0], loads, index)

        with m.If(self.busy):
            m.d.sync += index.eq(index + 1)
            with m.If(last):
                m.d.sync += index.eq(0)
                with m.If(clearing):
                    m.d.sync += self.slot.eq(self.slot + 1)
                    with m.If(self.slot == self.slots - 1):
                        m.d.sync += clearing.eq(0)
                with m.Else():
                    m.d.sync += self.busy.eq(0)
        with m.If(self.begin):
            m.d.sync += [self.busy.eq(1), self.slot.eq(self.new_slot), clearing.eq(self.zeros)]
        return m
