"""AXI4-Lite, as its slave."""

from __future__ import annotations

from amaranth import Module, Mux, Signal
from amaranth.lib import wiring

from sculler_hdl.bus.registers import slave_members

SLVERR = 0b10
"""The answer to an access that is an error."""


class AxiLite(wiring.Component):
    """AXI4-Lite slave: one read or write at a time; of both at once they take turns.

    No output depends on an input of the same clock.  Address and data of a write may come in any
    order.  An error answers SLVERR.

    Members: those of the standard, without `prot`; request (out), answer (in): the registers.

    Latency: of the registers, and two clocks.

    Args:
        domain: the bus's clock.
    """

    def __init__(self, domain: str = "sync") -> None:
        self.domain = domain
        super().__init__(slave_members("axi-lite"))

    def elaborate(self, platform: object) -> Module:
        m = Module()
        clocked = m.d[self.domain]
        write_address, have_write_address = _held(m, self.domain, self.awvalid, self.awaddr, "aw")
        write_data, have_write_data = _held(m, self.domain, self.wvalid, self.wdata, "w")
        strobe = Signal(4)
        read_address, have_read_address = _held(m, self.domain, self.arvalid, self.araddr, "ar")
        m.d.comb += [
            self.awready.eq(~have_write_address),
            self.wready.eq(~have_write_data),
            self.arready.eq(~have_read_address),
        ]
        with m.If(self.wvalid & self.wready):
            clocked += strobe.eq(self.wstrb)

        # an answer is awaited; to a write
        busy = Signal()
        writing = Signal()
        request, answer = self.request, self.answer
        can_write = Signal()
        can_read = Signal()
        write = Signal()
        m.d.comb += [
            can_write.eq(have_write_address & have_write_data & ~self.bvalid),
            can_read.eq(have_read_address & ~self.rvalid),
            write.eq(can_write & ~(can_read & writing)),  # after a write a read comes first
            request.valid.eq(~busy & (can_write | can_read)),
            request.write.eq(write),
            request.address.eq(Mux(write, write_address, read_address)),
            request.data.eq(write_data),
            request.strobe.eq(strobe),
            answer.ready.eq(1),
        ]
        with m.If(request.valid & request.ready):
            clocked += [busy.eq(1), writing.eq(write)]
            with m.If(write):
                clocked += [have_write_address.eq(0), have_write_data.eq(0)]
            with m.Else():
                clocked += have_read_address.eq(0)
        with m.If(self.bready):
            clocked += self.bvalid.eq(0)
        with m.If(self.rready):
            clocked += self.rvalid.eq(0)
        with m.If(busy & answer.valid):
            clocked += busy.eq(0)
            with m.If(writing):
                clocked += [self.bvalid.eq(1), self.bresp.eq(Mux(answer.error, SLVERR, 0))]
            with m.Else():
                clocked += [
                    self.rvalid.eq(1),
                    self.rdata.eq(answer.data),
                    self.rresp.eq(Mux(answer.error, SLVERR, 0)),
                ]
        return m


def _held(
    m: Module, domain: str, valid: Signal, payload: Signal, name: str
) -> tuple[Signal, Signal]:
    """What has come on a channel, and whether something has; it is cleared by who uses it."""
    held, have = Signal.like(payload, name=f"{name}_held"), Signal(name=f"{name}_have")
    with m.If(valid & ~have):
        m.d[domain] += [held.eq(payload), have.eq(1)]
    return held, have
