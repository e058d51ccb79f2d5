"""What is kept of each channel, and when a sample of it is loaded and goes to the engine."""

from __future__ import annotations

from amaranth import Module, Mux, Signal, Value
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.compact.control import CONDITIONS
from sculler_hdl.lib.delay import ControlDelay
from sculler_hdl.lib.memory import BlockMemory
from sculler_hdl.plan.compact.plan import CompactPlan
from sculler_hdl.plan.ports import channel_bits


def kept_layout(plan: CompactPlan) -> data.StructLayout:
    """What is kept of a channel.

    started: it has had a sample.  phase, minor, major: of its next sample, the last staying at its
    largest.  slot: of its newest sample.  fault, lost, rail: of its present major interval.
    """
    algorithm = plan.design.algorithm
    largest = max(plan.design.short_majors, 1)
    return data.StructLayout(
        {
            "started": 1,
            "phase": max(1, (algorithm.samples - 1).bit_length()),
            "minor": max(1, (algorithm.minors - 1).bit_length()),
            "major": largest.bit_length(),
            "slot": plan.sizes.slot_bits,
            "fault": 1,
            "lost": 1,
            "rail": 1,
        }
    )


class ChannelControl(wiring.Component):
    """Looks up what is kept of a sample's channel, has it loaded and launched, and keeps the rest.

    A sample is taken in clock 0.  In clock 1 its channel's word is addressed, and comes as much
    later as the memory takes.  From the clock after that on it can be loaded (`begin`): but for a
    channel's first, which waits for the engine, for its slots may still be read.  When it is loaded
    and may go (`launch`, or nothing where there is no work), the word is written two clocks later.

    After reset it writes 0 to all words, one a clock.  Nothing is taken meanwhile.

    Members:
        take, channel, fault, restart (in): a sample is taken in this clock, whose, and its marks.
        lose, lost_channel (in): a sample of this channel was lost; not in the clocks 1 and 2.
        begin, slot, zeros (out): the sample is to be loaded, where, and zeros before it.
        loaded, rail (in): of the loader.
        busy (in): the engine cannot take another sample.
        result_taken (in): the last word of a result is taken in this clock.
        launch (out): the engine begins with the sample.
        owner (out): the channel of the sample in the core.
        phase, conditions (out): of it, from `begin` to two clocks after `launch`.
        at_rail (out): a count of its major interval so far stood at its rail; looked at in the
            second clock after `launch`.
        waits (out): no sample may be taken from the next clock on.

    Args:
        plan: the plan.
    """

    def __init__(self, plan: CompactPlan) -> None:
        self.plan = plan
        self.layout = kept_layout(plan)
        design = plan.design
        # small ones need no block, which synthesis finds out
        self.kept, self.losses = (
            BlockMemory(plan.target, width, [0] * design.channels, primitive=False)
            for width in (self.layout.size, 1)
        )
        number = channel_bits(design)
        super().__init__(
            {
                "take": In(1),
                "channel": In(number),
                "fault": In(1),
                "restart": In(1),
                "lose": In(1),
                "lost_channel": In(number),
                "begin": Out(1),
                "slot": Out(plan.sizes.slot_bits),
                "zeros": Out(1),
                "loaded": In(1),
                "rail": In(1),
                "busy": In(1),
                "result_taken": In(1),
                "launch": Out(1),
                "owner": Out(number),
                "phase": Out(self.layout["phase"].shape),
                "conditions": Out(CONDITIONS),
                "at_rail": Out(1),
                "waits": Out(1, init=1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        design = self.plan.design
        fault, restart, legal = Signal(), Signal(), Signal(init=1)
        with m.If(self.take):
            m.d.sync += [
                self.owner.eq(self.channel),
                fault.eq(self.fault),
                restart.eq(self.restart),
                legal.eq(self.channel < design.channels),
            ]
        taken = ControlDelay(m, "taken", self.take)
        m.submodules.kept, m.submodules.losses = self.kept, self.losses
        found = data.View(self.layout, self.kept.data)
        now = Signal(self.layout)  # as of the sample in the core; `slot` is its own
        looked, first = Signal(), Signal()
        lost = self.losses.data & ~restart
        fresh: Value = restart | ~found.started
        look = Signal()
        m.d.comb += [
            look.eq(taken.at_clock(1 + self.kept.latency) & legal),
            self.begin.eq(looked & ~(first & self.busy)),
            self.slot.eq(now.slot),
            self.zeros.eq(first if any(design.short_samples) else 0),
        ]
        m.d.sync += looked.eq(look | (looked & ~self.begin))
        away = self._go(m, now, ControlDelay(m, "absent", taken.at_clock(1) & ~legal))
        with m.If(self.rail):
            m.d.sync += now.rail.eq(1)
        with m.If(look):
            m.d.sync += [
                first.eq(fresh),
                now.started.eq(1),
                now.phase.eq(Mux(fresh, 0, found.phase)),
                now.minor.eq(Mux(fresh, 0, found.minor)),
                now.major.eq(Mux(fresh, 0, found.major)),
                now.slot.eq(Mux(fresh, 0, _sum(found.slot, 1))),
                now.fault.eq(fault | (found.fault & ~fresh)),
                now.lost.eq((found.lost & ~fresh) | lost),
                now.rail.eq(found.rail & ~fresh),
            ]
        self._keep(m, now, away.at_clock(2), taken.at_clock(2) & legal)
        return m

    def _go(self, m: Module, now: data.View, absent: ControlDelay) -> ControlDelay:
        """Whether the sample in the core goes in this clock, to the engine or for good."""
        design = self.plan.design
        n, short = design.algorithm.samples, design.short_majors
        held, pending = Signal(), Signal()  # a sample is in the core; it is loaded
        owed = Signal(2)  # results under way or not taken whole
        minor_end, has_work, wanted = Signal(), Signal(), Signal()
        go = Signal()
        m.d.sync += [  # known long before they are needed
            minor_end.eq(now.phase == n - 1),
            has_work.eq(now.phase.matches(*(k - 1 for k in self.plan.program.phases))),
            wanted.eq(self.conditions.major_end),
        ]
        m.d.comb += [
            self.phase.eq(now.phase),
            self.conditions.first_minor.eq(now.minor == 0),
            self.conditions.first_major.eq(now.major == 0),
            self.conditions.major_end.eq(minor_end & (now.minor == design.algorithm.minors - 1)),
            self.conditions.fault.eq(now.fault),
            self.conditions.short.eq(now.major < short if short else 0),
            self.conditions.lost.eq(now.lost),
            go.eq(
                (self.loaded | pending)
                & ~(has_work & self.busy)
                & ~(wanted & (owed == self.plan.timing.results))
            ),
            self.launch.eq(go & has_work),
            self.at_rail.eq(now.rail | self.rail),
        ]
        m.d.sync += [
            pending.eq((self.loaded | pending) & ~go),
        ]
        more = self.launch & wanted
        with m.If(more & ~self.result_taken):
            m.d.sync += owed.eq(_sum(owed, 1))
        with m.Elif(~more & self.result_taken):
            m.d.sync += owed.eq(owed - 1)
        with m.If(self.take):
            m.d.sync += held.eq(1)
        with m.Elif(go | absent.at_clock(0)):
            m.d.sync += held.eq(0)
        initial = Signal(range(max(design.channels, 2)))
        clearing = Signal(init=1)
        self.clearing, self.initial = clearing, initial
        with m.If(clearing):
            m.d.sync += initial.eq(_sum(initial, 1))
            with m.If(initial == design.channels - 1):
                m.d.sync += clearing.eq(0)
        m.d.comb += self.waits.eq(self.take | held | clearing)
        return ControlDelay(m, "gone", go)

    def _keep(self, m: Module, now: data.View, store: Value, forget: Value) -> None:
        """Write what is kept, and a channel's losses; after reset clear both."""
        design = self.plan.design
        largest = max(design.short_majors, 1)
        last, ends = now.phase == design.algorithm.samples - 1, self.conditions.major_end
        following = Signal(self.layout)
        more = ends & (now.major != largest)
        m.d.comb += [
            following.started.eq(1),
            following.phase.eq(Mux(last, 0, _sum(now.phase, 1))),
            following.minor.eq(Mux(ends, 0, _sum(now.minor, last))),
            following.major.eq(Mux(more, _sum(now.major, 1), now.major)),
            following.slot.eq(now.slot),
            following.fault.eq(now.fault & ~ends),
            following.lost.eq(now.lost & ~ends),
            following.rail.eq(self.at_rail & ~ends),
            self.kept.step.eq(1),
            self.kept.address.eq(self.owner),
            self.kept.write.eq(store | self.clearing),
            self.kept.write_address.eq(Mux(self.clearing, self.initial, self.owner)),
            self.kept.write_data.eq(Mux(self.clearing, 0, following)),
            self.losses.step.eq(1),
            self.losses.address.eq(self.owner),
            self.losses.write.eq(self.lose | forget | self.clearing),
            self.losses.write_data.eq(self.lose & ~self.clearing),
            self.losses.write_address.eq(self.owner),
        ]
        with m.If(self.clearing):
            m.d.comb += self.losses.write_address.eq(self.initial)
        with m.Elif(self.lose):
            m.d.comb += self.losses.write_address.eq(self.lost_channel)


def _sum(value: Value, more: Value | int) -> Value:
    """The sum, modulo what the value's bits hold."""
    return (value + more)[: len(value)]
