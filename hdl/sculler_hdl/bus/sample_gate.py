"""Which samples go to the core: the sensor's, those that the host pushes, or none."""

from __future__ import annotations

from amaranth import Module, Mux, Signal, unsigned
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out


class SampleGate(wiring.Component):
    """The way of samples to the core.

    Members:
        hold (in): the core is in reset; nothing is taken.
        enable (in): the sensor's samples go to the core; else they are thrown away.
        inject (in): samples that are pushed go to the core, and the sensor's are thrown away.
        sample_valid, sample_ready, sample: the sensor's handshake; counts and fault mark as bits.
        push (in), pushed (in): a sample of the host's is there from the next clock on; its bits.
        core_valid, core_ready, core: the core's handshake.
        waits (out): a pushed sample has not been taken.
        taken (out): the core takes a sample.

    Latency: none.

    Args:
        width: bits of a sample.
    """

    def __init__(self, width: int) -> None:
        self.width = width
        super().__init__(
            {
                "hold": In(1),
                "enable": In(1),
                "inject": In(1),
                "sample_valid": In(1),
                "sample_ready": Out(1),
                "sample": In(unsigned(width)),
                "push": In(1),
                "pushed": In(unsigned(width)),
                "core_valid": Out(1),
                "core_ready": In(1),
                "core": Out(unsigned(width)),
                "waits": Out(1),
                "taken": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        ready = Signal()
        m.d.comb += [
            ready.eq(self.core_ready & ~self.hold),
            self.core_valid.eq(Mux(self.inject, self.waits, self.sample_valid & self.enable)),
            self.core.eq(Mux(self.inject, self.pushed, self.sample)),
            self.sample_ready.eq(ready | self.inject | ~self.enable),
            self.taken.eq(self.core_valid & ready),
        ]
        with m.If(self.taken | ~self.inject):
            m.d.sync += self.waits.eq(0)
        with m.If(self.push & self.inject):
            m.d.sync += self.waits.eq(1)
        return m
