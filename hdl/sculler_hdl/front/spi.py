"""Reader of bursts over SPI."""

from __future__ import annotations

from amaranth import C, Cat, Module, Signal, unsigned
from amaranth.lib import cdc, wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.plan.front import FrontPlan
from sculler_model.front import Spi

_REQUEST_BITS = 16


class BurstReader(wiring.Component):
    """Reads a burst at each rising edge of data-ready, in SPI mode 3, most significant bit first.

    `sck` is high while idle.  `cs_n` falls half a period before its first edge and rises half a
    period after the last.  `mosi` changes with falling edges; `miso` is looked at while `sck` is
    high, two clocks before it falls.  First go the 16 bits of the request, then zeros while the
    burst comes.  Edges of data-ready in a burst count for nothing.

    Members:
        sck, cs_n, mosi (out), miso, data_ready (in): pins; inputs are synchronised inside.
        start (out): an edge of data-ready, three clocks after it.
        data_valid, data (out): a byte of the burst.

    Args:
        plan: the plan.
    """

    def __init__(self, plan: FrontPlan) -> None:
        assert isinstance(plan.link.wire, Spi)
        self.plan = plan
        self.request = plan.link.wire.request
        super().__init__(
            {
                "sck": Out(1, init=1),
                "cs_n": Out(1, init=1),
                "mosi": Out(1),
                "miso": In(1),
                "data_ready": In(1),
                "start": Out(1),
                "data_valid": Out(1),
                "data": Out(unsigned(8)),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        miso, ready, before = Signal(), Signal(), Signal()
        m.submodules.miso_line = cdc.FFSynchronizer(self.miso, miso, reset_less=False)
        m.submodules.ready_line = cdc.FFSynchronizer(self.data_ready, ready, reset_less=False)
        m.d.sync += before.eq(ready)
        bits = _REQUEST_BITS + 8 * self.plan.layout.longest
        clocks = Signal(range(self.plan.half_period))
        number = Signal(range(bits))
        sending = Signal(_REQUEST_BITS)
        half = clocks == self.plan.half_period - 1
        m.d.sync += self.data_valid.eq(0)
        with m.If(half):
            m.d.sync += clocks.eq(0)
        with m.Else():
            m.d.sync += clocks.eq(clocks + 1)
        with m.FSM():
            with m.State("IDLE"), m.If(ready & ~before):
                m.d.comb += self.start.eq(1)
                m.d.sync += [
                    self.cs_n.eq(0),
                    clocks.eq(0),
                    number.eq(0),
                    sending.eq(self.request),
                ]
                m.next = "SELECTED"
            with m.State("SELECTED"), m.If(half):
                self._fall(m, sending)
                m.next = "LOW"
            with m.State("LOW"), m.If(half):
                m.d.sync += self.sck.eq(1)
                m.next = "HIGH"
            with m.State("HIGH"), m.If(half):
                m.d.sync += [
                    self.data.eq(Cat(miso, self.data[:7])),
                    self.data_valid.eq((number >= _REQUEST_BITS) & (number[:3] == 7)),
                    number.eq(number + 1),
                ]
                with m.If(number == bits - 1):
                    m.d.sync += [self.cs_n.eq(1), self.mosi.eq(0)]
                    m.next = "IDLE"
                with m.Else():
                    self._fall(m, sending)
                    m.next = "LOW"
        return m

    def _fall(self, m: Module, sending: Signal) -> None:
        """A falling edge of `sck`, with which the next bit is shown."""
        m.d.sync += [
            self.sck.eq(0),
            self.mosi.eq(sending[-1]),
            sending.eq(Cat(C(0, 1), sending[:-1])),
        ]
