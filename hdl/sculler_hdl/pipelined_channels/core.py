"""The pipelined core with many channels: up to one sample of some channel per clock.

sample ─▶ Waiting ─────────▶ ChannelDatapath ─▶ StreamHandOver ─▶ result
          Front, ChannelLosses
"""

from __future__ import annotations

from amaranth import Cat, Module, Signal, Value
from amaranth.lib import wiring

from sculler_hdl.lib.delay import SkewedSignal
from sculler_hdl.lib.layout import core_members, sample_counts
from sculler_hdl.pipelined.rails import emit_newest_rail
from sculler_hdl.pipelined.stream import StreamHandOver
from sculler_hdl.pipelined_channels.datapath import ChannelDatapath, Vector
from sculler_hdl.pipelined_channels.front import Front
from sculler_hdl.pipelined_channels.losses import ChannelLosses
from sculler_hdl.pipelined_channels.status import ChannelStatus
from sculler_hdl.pipelined_channels.waiting import Waiting
from sculler_hdl.plan.arrival import at_once
from sculler_hdl.plan.pipelined_channels import STATUS_CLOCK, plan_pipelined_channels
from sculler_hdl.plan.ports import channel_bits
from sculler_hdl.plan.transfer import RAIL_DELAY
from sculler_model.design import Design


class PipelinedChannelCore(wiring.Component):
    """Coning and sculling accumulators of many sensors, each for itself, exact in every bit.

    What outlives a sample stands in block memory, a word for each channel: where the channel stands
    in its intervals, its last samples, and each sum.  Samples of different channels follow each
    other in every clock (`timing.spacing`), those of one channel `timing.apart` clocks apart.

    Ports (clock `clk`, synchronous `rst`; the contract is
    `sculler_model.golden.pipelined_channels`):
        sample_valid, sample_ready; sample_gyro_x..z, sample_accel_x..z (signed counts),
        sample_fault, sample_channel, sample_restart.
        result_valid, result_ready, result_data, result_last, result_channel: the words of
        `sculler_model.golden`, and whose they are.
        samples_lost.

    Latency: `timing.latency`, from an interval's last sample to `result_valid`, if nothing waits.

    Args:
        design: the design.
        primitive: as for `PipelinedCore`.

    Attributes:
        plan, timing, resources, block_groups, listing: as those of `PipelinedCore`.

    Raises:
        InputError: see `plan_pipelined_channels`.
    """

    def __init__(self, design: Design, *, primitive: bool = True) -> None:
        self.design = design
        self.primitive = primitive
        self.plan = plan_pipelined_channels(design)
        self.timing = self.plan.timing
        self.resources = self.plan.resources
        self.block_groups = tuple(map(tuple, self.plan.schedule.block_groups))
        self.listing = None
        super().__init__(core_members(design))

    def elaborate(self, platform: object) -> Module:
        m, design, plan = Module(), self.design, self.plan
        m.submodules.front = front = Front(plan)
        m.submodules.losses = losses = ChannelLosses(design, plan.target)
        m.submodules.handover = handover = StreamHandOver(plan.schedule.handover())
        ports = sample_counts(self)
        flat = Cat(*ports["gyro"], *ports["accel"], self.sample_fault)
        m.submodules.waiting = waiting = Waiting(len(flat))
        m.d.comb += [
            front.sample_valid.eq(self.sample_valid),
            front.sample_channel.eq(self.sample_channel),
            front.sample_restart.eq(self.sample_restart),
            front.result_taken.eq(handover.taken),
            self.sample_ready.eq(front.sample_ready),
            losses.sample_valid.eq(self.sample_valid),
            losses.sample_ready.eq(front.sample_ready),
            losses.sample_channel.eq(self.sample_channel),
            losses.sample_restart.eq(self.sample_restart),
            losses.take.eq(front.take),
            losses.clearing.eq(front.clearing),
            losses.place.eq(front.place),
            losses.started.eq(front.started),
            self.samples_lost.eq(losses.count),
            waiting.take.eq(front.take),
            waiting.sample.eq(flat),
            waiting.told.eq(losses.told),
            waiting.lost.eq(losses.lost),
            waiting.slot.eq(front.slot),
        ]
        counts, low = dict[str, Vector](), 0
        for sensor, three in ports.items():
            counts[sensor] = []
            for port in three:
                counts[sensor].append(waiting.chosen[low : low + len(port)])
                low += len(port)
        datapath = ChannelDatapath(m, plan, front, counts, handover.input, primitive=self.primitive)
        datapath.emit()
        marks = Cat(waiting.chosen[-1], waiting.chosen_lost)
        self._status(m, datapath, handover, marks)
        self._results(m, datapath, handover)
        return m

    def _status(
        self, m: Module, datapath: ChannelDatapath, handover: StreamHandOver, marks: Value
    ) -> None:
        """The status of a channel's interval so far, to the hand-over at the clocks it asks for."""
        target, clock = self.plan.target, STATUS_CLOCK - 1
        status = ChannelStatus(target, self.design.channels, 3)
        m.submodules.status = status
        own = SkewedSignal(m, "marks", marks, at_once(2))
        rail = emit_newest_rail(m, datapath.samples)
        m.d.comb += [
            status.channel.eq(datapath.channel.at_clock(clock - target.memory_latency)),
            status.step.eq(datapath.flags["taken"].at_clock(clock)),
            status.first.eq(datapath.flags["first"].at_clock(clock)),
            status.marks.eq(Cat(own.at_clock(clock), rail)),
        ]
        fault, lost, at_rail = status.told
        told = SkewedSignal(m, "told_rail", at_rail, at_once(1, STATUS_CLOCK))
        short = datapath.flags["short"].at_clock(STATUS_CLOCK)
        m.d.comb += [
            handover.status.eq(Cat(short, fault, 0, lost)),
            handover.rail.eq(told.at_clock(STATUS_CLOCK + RAIL_DELAY)),
        ]

    def _results(self, m: Module, datapath: ChannelDatapath, handover: StreamHandOver) -> None:
        """From the hand-over to the ports."""
        whose = Signal(channel_bits(self.design))
        front = datapath.front
        with m.If(front.major_end):
            m.d.sync += whose.eq(front.channel)
        ends = datapath.flags["major_end"].at_clock(handover.plan.clock)
        m.d.comb += [
            handover.major_end.eq(ends),
            handover.number.eq(datapath.number()),
            handover.ready.eq(self.result_ready),
            self.result_valid.eq(handover.valid),
            self.result_data.eq(handover.data),
            self.result_last.eq(handover.last),
            self.result_channel.eq(whose),
        ]
