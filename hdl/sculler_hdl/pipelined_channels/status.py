"""What is told of the present major interval of many channels."""

from __future__ import annotations

from amaranth import Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.delay import ControlDelay, SkewedSignal
from sculler_hdl.lib.memory import BlockMemory
from sculler_hdl.plan.arrival import at_once
from sculler_hdl.targets import Target


class ChannelStatus(wiring.Component):
    """Marks of samples, those of a channel's interval put together.

    Members:
        channel (clock -`memory_latency`): whose sample comes.
        step, first (clock 0): it is there; it is the first of its interval.
        marks (clock 0): its own.
        told (clock 1): of its interval so far, this sample included.

    Args:
        target: whose memory blocks.
        channels: how many channels.
        bits: how many marks.
    """

    def __init__(self, target: Target, channels: int, bits: int) -> None:
        # a small one needs no block, which synthesis finds out
        self.memory = BlockMemory(target, bits, [0] * channels, primitive=False)
        super().__init__(
            {
                "channel": In(range(channels)),
                "step": In(1),
                "first": In(1),
                "marks": In(bits),
                "told": Out(bits),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m, memory = Module(), self.memory
        m.submodules.marks = memory
        clock = -memory.latency
        channel = SkewedSignal(m, "channel", self.channel, at_once(len(self.channel), clock))
        told = Signal(len(self.told), reset_less=True)
        m.d.sync += told.eq(Mux(self.first, 0, memory.data) | self.marks)
        m.d.comb += [
            memory.step.eq(1),
            memory.address.eq(self.channel),
            memory.write.eq(ControlDelay(m, "step", self.step).at_clock(1)),
            memory.write_address.eq(channel.at_clock(1)),
            memory.write_data.eq(told),
            self.told.eq(told),
        ]
        return m
