"""APB4, as its completer."""

from __future__ import annotations

from amaranth import Module, Signal
from amaranth.lib import wiring

from sculler_hdl.bus.registers import slave_members


class Apb(wiring.Component):
    """APB4 completer with strobes; an error sets `pslverr`.

    Members: those of the standard, without `pprot`; request (out), answer (in): the registers.

    Latency: `pready` comes as many clocks after the setup phase as the registers take, and one.

    Args:
        domain: the bus's clock.
    """

    def __init__(self, domain: str = "sync") -> None:
        self.domain = domain
        super().__init__(slave_members("apb"))

    def elaborate(self, platform: object) -> Module:
        m = Module()
        clocked = m.d[self.domain]
        request, answer = self.request, self.answer
        busy = Signal()
        m.d.comb += [
            request.valid.eq(self.psel & self.penable & ~busy & ~self.pready),
            request.write.eq(self.pwrite),
            request.address.eq(self.paddr),
            request.data.eq(self.pwdata),
            request.strobe.eq(self.pstrb),
            answer.ready.eq(1),
        ]
        clocked += [self.pready.eq(0), self.pslverr.eq(0)]
        with m.If(request.valid & request.ready):
            clocked += busy.eq(1)
        with m.If(busy & answer.valid):
            clocked += [
                busy.eq(0),
                self.pready.eq(1),
                self.prdata.eq(answer.data),
                self.pslverr.eq(answer.error),
            ]
        return m
