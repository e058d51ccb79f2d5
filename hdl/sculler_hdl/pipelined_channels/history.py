"""The last samples of many channels, in block memory."""

from __future__ import annotations

from amaranth import Cat, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.delay import ControlDelay, SkewedSignal
from sculler_hdl.lib.memory import BlockMemory
from sculler_hdl.plan.arrival import at_once
from sculler_hdl.plan.pipelined_channels import history_clock
from sculler_hdl.targets import Target


class History(wiring.Component):
    """What a channel's samples were before its newest one.

    A word of memory holds a channel's last samples.  It is read, put to 0 where the channel begins,
    and written again with the newest sample in place of the oldest.

    Members:
        step, fresh, channel (clock 0): a sample comes; it is its channel's first; whose it is.
        sample (clock `history_clock`): its counts, one after another.
        before (the same clock): those of the sample one before, of the one two before, ...

    One sample per clock; two of one channel `target.memory_latency` + 2 clocks apart.

    Args:
        target: whose memory blocks.
        channels: how many channels.
        bits: of a sample's counts together.
        length: samples before the newest, at least one.
        primitive: whether to instantiate the target's memory blocks.
    """

    def __init__(
        self, target: Target, channels: int, bits: int, length: int, *, primitive: bool
    ) -> None:
        self.target = target
        self.bits = bits
        self.length = length
        self.memory = BlockMemory(target, bits * length, [0] * channels, primitive=primitive)
        super().__init__(
            {
                "step": In(1),
                "fresh": In(1),
                "channel": In(range(channels)),
                "sample": In(bits),
                "before": Out(bits * length),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m, memory, clock = Module(), self.memory, history_clock(self.target)
        m.submodules.samples = memory
        step = ControlDelay(m, "step", self.step)
        fresh = ControlDelay(m, "fresh", self.fresh, cleared=False)
        channel = SkewedSignal(m, "channel", self.channel, at_once(len(self.channel)))
        held = Signal(len(self.before), name="held", reset_less=True)
        m.d.sync += held.eq(Mux(fresh.at_clock(clock - 1), 0, memory.data))
        following: Value = Cat(self.sample, held)[: len(held)]
        m.d.comb += [
            self.before.eq(held),
            memory.step.eq(1),
            memory.address.eq(self.channel),
            memory.write.eq(step.at_clock(clock)),
            memory.write_address.eq(channel.at_clock(clock)),
            memory.write_data.eq(following),
        ]
        return m
