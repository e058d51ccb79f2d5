"""Samples that were not taken, told to the next sample of their channel."""

from __future__ import annotations

from amaranth import Module, Mux, Signal, unsigned
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.delay import ControlDelay, SkewedSignal
from sculler_hdl.lib.losses import emit_event_counter
from sculler_hdl.lib.memory import BlockMemory
from sculler_hdl.plan.arrival import at_once
from sculler_hdl.plan.ports import channel_bits
from sculler_hdl.targets import Target
from sculler_model.design import Design
from sculler_model.golden import COUNTER_BITS


class ChannelLosses(wiring.Component):
    """Marks a channel of which a sample is lost; the next one of it that is taken takes the mark.

    A mark is read in the clock after its channel's sample is taken and cleared one clock later; it
    is set in the clock after the loss.  These never meet: between a sample that is taken and a loss
    there is a clock in which the lost one is not taken.

    Members:
        sample_valid, sample_ready, sample_channel, sample_restart, take (in): as of `Front`.
        clearing, place, started (in): as of `Front`; a loss before that marks nothing.
        told (out): the mark of the sample that was taken 1 + `memory_latency` clocks before is
            there, if there was one.
        lost (out): that mark.
        count (out): losses since reset.

    Args:
        design: the design.
        target: whose memory blocks.
    """

    def __init__(self, design: Design, target: Target) -> None:
        self.design = design
        # a small one needs no block, which synthesis finds out
        self.marks = BlockMemory(target, 1, [0] * design.channels, primitive=False)
        number = channel_bits(design)
        super().__init__(
            {
                "sample_valid": In(1),
                "sample_ready": In(1),
                "sample_channel": In(number),
                "sample_restart": In(1),
                "take": In(1),
                "clearing": In(1),
                "place": In(number),
                "started": In(1),
                "told": Out(1),
                "lost": Out(1),
                "count": Out(unsigned(COUNTER_BITS)),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m, marks = Module(), self.marks
        m.submodules.marks = marks
        bits = len(self.sample_channel)
        refused, withdrawn = Signal(), Signal()
        offered, whose = Signal(bits), Signal(bits)
        marked = Signal()
        m.d.sync += [
            refused.eq(self.sample_valid & ~self.sample_ready),
            offered.eq(self.sample_channel),
            withdrawn.eq(refused & ~self.sample_valid),
            whose.eq(offered),
            marked.eq(
                refused & ~self.sample_valid & self.started & (offered < self.design.channels)
            ),
        ]
        taken = ControlDelay(m, "taken", self.take)
        channel = SkewedSignal(m, "channel", self.sample_channel, at_once(bits))
        newest, before = channel.at_clock(1), channel.at_clock(2)
        clear = taken.at_clock(2)
        # the mark that is just being cleared is the sample's before
        again = taken.at_clock(1) & clear & (newest == before)
        there = 1 + marks.latency
        passed = ControlDelay(m, "again", again, 1, cleared=False)
        restart = ControlDelay(m, "restart", self.sample_restart, cleared=False)
        m.d.comb += [
            marks.step.eq(1),
            marks.address.eq(newest),
            marks.write.eq(marked | clear | self.clearing),
            marks.write_address.eq(Mux(marked, whose, before)),
            marks.write_data.eq(marked),
            self.told.eq(taken.at_clock(there)),
            self.lost.eq(marks.data & ~passed.at_clock(there) & ~restart.at_clock(there)),
            self.count.eq(emit_event_counter(m, withdrawn, "samples_lost")),
        ]
        with m.If(self.clearing):
            m.d.comb += marks.write_address.eq(self.place)
        return m
