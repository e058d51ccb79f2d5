"""Wishbone B4, as its slave."""

from __future__ import annotations

from amaranth import Module, Signal
from amaranth.lib import wiring

from sculler_hdl.bus.registers import slave_members


class Wishbone(wiring.Component):
    """Wishbone B4 slave, classic or pipelined, 32 bits wide with bytes of 8.

    One access at a time: the classic one waits for `ack` or `err`, the pipelined one is stalled
    until the one before is answered.  If `cyc` falls first, the access is done and not answered.

    Members: those of the standard; `stall` of the pipelined kind only.  `adr` is that of a byte.
        request (out), answer (in): the registers.

    Latency: of the registers, and one clock.

    Args:
        pipelined: which kind.
        domain: the bus's clock.
    """

    def __init__(self, *, pipelined: bool, domain: str = "sync") -> None:
        self.pipelined = pipelined
        self.domain = domain
        super().__init__(slave_members("wishbone-pipelined" if pipelined else "wishbone"))

    def elaborate(self, platform: object) -> Module:
        m = Module()
        clocked = m.d[self.domain]
        request, answer = self.request, self.answer
        # an answer is awaited; and the master still wants it
        busy = Signal()
        wanted = Signal()
        done = Signal()
        m.d.comb += [
            done.eq(self.ack | self.err),
            request.valid.eq(self.cyc & self.stb & ~busy & ~done),
            request.write.eq(self.we),
            request.address.eq(self.adr),
            request.data.eq(self.dat_w),
            request.strobe.eq(self.sel),
            answer.ready.eq(1),
        ]
        if self.pipelined:
            m.d.comb += self.stall.eq(busy | done | ~request.ready)
        clocked += [self.ack.eq(0), self.err.eq(0)]
        with m.If(~self.cyc):
            clocked += wanted.eq(0)
        with m.If(request.valid & request.ready):
            clocked += [busy.eq(1), wanted.eq(1)]
        with m.If(busy & answer.valid):
            clocked += [
                busy.eq(0),
                self.dat_r.eq(answer.data),
                self.ack.eq(wanted & self.cyc & ~answer.error),
                self.err.eq(wanted & self.cyc & answer.error),
            ]
        return m
