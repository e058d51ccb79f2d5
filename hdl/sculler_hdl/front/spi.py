"""Reader of words over SPI."""

from __future__ import annotations

from amaranth import C, Cat, Module, Mux, Signal, Value, unsigned
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.crossing import Synchroniser
from sculler_hdl.plan.front import FrontPlan
from sculler_model.front import Spi

_WORD_BITS = 16


class WordReader(wiring.Component):
    """Reads the words of a sample at each rising edge of data-ready, in SPI mode 3.

    The most significant bit goes first.  `sck` is high while idle.  `cs_n` falls half a period
    before its first edge and rises half a period after the last.  `mosi` changes with falling
    edges; `miso` is looked at while `sck` is high, two clocks before it falls.  The requests go out
    one after the other, then zeros; what comes with the first is nothing, after it come the words
    of the frame.  With a pause, `cs_n` is high for so many clocks between two words.  Edges of
    data-ready in between count for nothing.

    Members:
        sck, cs_n, mosi (out), miso, data_ready (in): pins; inputs are synchronised inside.
        start (out): an edge of data-ready, three clocks after it.
        data_valid, data (out): a byte of the frame.

    Args:
        plan: the plan.
    """

    def __init__(self, plan: FrontPlan) -> None:
        assert isinstance(plan.link.wire, Spi)
        self.plan = plan
        self.requests = plan.link.wire.requests
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
        m.submodules.miso_line = miso_line = Synchroniser(1)
        m.submodules.ready_line = ready_line = Synchroniser(1)
        m.d.comb += [
            miso_line.data_in.eq(self.miso),
            miso.eq(miso_line.data_out),
            ready_line.data_in.eq(self.data_ready),
            ready.eq(ready_line.data_out),
        ]
        m.d.sync += before.eq(ready)
        bits = _WORD_BITS + 8 * self.plan.layout.longest
        clocks = Signal(range(max(self.plan.half_period, self.plan.pause)))
        number = Signal(range(bits))
        sending = Signal(_WORD_BITS)
        half = clocks == self.plan.half_period - 1
        m.d.sync += self.data_valid.eq(0)
        pausing = Signal()
        with m.If(half & ~pausing):
            m.d.sync += clocks.eq(0)
        with m.Else():
            m.d.sync += clocks.eq(clocks + 1)
        with m.FSM() as states:
            with m.State("IDLE"), m.If(ready & ~before):
                m.d.comb += self.start.eq(1)
                m.d.sync += [
                    self.cs_n.eq(0),
                    clocks.eq(0),
                    number.eq(0),
                    sending.eq(self.requests[0]),
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
                    self.data_valid.eq((number >= _WORD_BITS) & (number[:3] == 7)),
                    number.eq(number + 1),
                ]
                with m.If(number == bits - 1):
                    m.d.sync += [self.cs_n.eq(1), self.mosi.eq(0)]
                    m.next = "IDLE"
                if self.plan.pause:
                    with m.Elif(number[:4] == _WORD_BITS - 1):
                        m.d.sync += [self.cs_n.eq(1), sending.eq(self._next_request(number))]
                        m.next = "PAUSE"
                with m.Else():
                    self._fall(m, sending)
                    m.next = "LOW"
            if self.plan.pause:
                with m.State("PAUSE"), m.If(clocks == self.plan.pause - 1):
                    m.d.sync += [clocks.eq(0), self.cs_n.eq(0)]
                    m.next = "SELECTED"
            if self.plan.pause:
                m.d.comb += pausing.eq(states.ongoing("PAUSE"))
        return m

    def _next_request(self, number: Signal) -> Value:
        """What follows the word whose last bit this is."""
        value = Value.cast(0)
        for place, request in enumerate(self.requests[1:]):
            value |= Mux(number[4:] == place, C(request, _WORD_BITS), 0)
        return value

    def _fall(self, m: Module, sending: Signal) -> None:
        """A falling edge of `sck`, with which the next bit is shown."""
        m.d.sync += [
            self.sck.eq(0),
            self.mosi.eq(sending[-1]),
            sending.eq(Cat(C(0, 1), sending[:-1])),
        ]
