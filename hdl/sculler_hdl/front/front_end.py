"""The sensor front end of a design."""

from __future__ import annotations

from amaranth import Module, signed, unsigned
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.front.frames import FrameReceiver
from sculler_hdl.front.sequence import SampleSequence
from sculler_hdl.front.spi import WordReader
from sculler_hdl.front.uart import UartReceiver
from sculler_hdl.plan.front import FrontPlan, front_ports, pin_ports
from sculler_model.design import Design
from sculler_model.front import Uart


class FrontEnd(wiring.Component):
    """From the sensor's pins to the core's sample port (`sculler_model.front.FrontModel`).

    pins -> UartReceiver or WordReader -> FrameReceiver -> SampleSequence -> sample port

    Ports (clock `clk`, reset): `sculler_hdl.plan.front.front_ports`; and `clk_en`, where the core
    has a clock enable: the wire is read in every clock, and a sample taken in those that are
    enabled.

    Args:
        design: a design with a front end.

    Attributes:
        plan: what it is built of.
    """

    def __init__(self, design: Design) -> None:
        if design.front is None:
            raise ValueError(f"{design.name} has no [hardware.front]")
        self.design = design
        self.plan = FrontPlan(design.front)
        self.enables = design.hardware.clock_enable is True
        members = {
            port.name: (Out if port.output else In)(
                signed(port.bits) if port.declared_signed else unsigned(port.bits)
            )
            for port in front_ports(design)
        }
        super().__init__(({"clk_en": In(1)} if self.enables else {}) | members)

    def elaborate(self, platform: object) -> Module:
        m = Module()
        is_uart = isinstance(self.plan.link.wire, Uart)
        m.submodules.wire = wire = (UartReceiver if is_uart else WordReader)(self.plan)
        m.submodules.frames = frames = FrameReceiver(self.plan)
        m.submodules.sequence = sequence = SampleSequence(self.design, self.plan)
        for port in pin_ports(self.design):
            inner, outer = getattr(wire, port.name), getattr(self, port.name)
            m.d.comb += outer.eq(inner) if port.output else inner.eq(outer)
        m.d.comb += [
            self.sample_instant.eq(wire.start & ~frames.held),
            frames.data_valid.eq(wire.data_valid),
            frames.data.eq(wire.data),
            sequence.data_valid.eq(wire.data_valid),
            sequence.idle.eq(frames.idle),
            sequence.frame_valid.eq(frames.frame_valid),
            frames.frame_ready.eq(sequence.frame_ready),
            sequence.fault.eq(frames.fault),
            sequence.broken.eq(frames.broken),
            *(getattr(sequence, name).eq(getattr(frames, name)) for name in self.plan.fields),
            sequence.sample_ready.eq(
                self.sample_ready & self.clk_en if self.enables else self.sample_ready
            ),
        ]
        shown = {port.name for port in front_ports(self.design) if port.output}
        for name in sequence.signature.members:
            if name in shown:
                m.d.comb += getattr(self, name).eq(getattr(sequence, name))
        return m
