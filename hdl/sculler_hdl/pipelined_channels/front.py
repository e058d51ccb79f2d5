"""Which sample is which of its channel, and when it is launched."""

from __future__ import annotations

from itertools import pairwise

from amaranth import C, Cat, Module, Mux, Signal, Value
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.layout import chosen, is_one_of
from sculler_hdl.lib.memory import BlockMemory
from sculler_hdl.plan.pipelined_channels import WAITING, PipelinedChannelPlan
from sculler_hdl.plan.ports import channel_bits
from sculler_hdl.plan.schedule import tap_rows
from sculler_model.design import Design


def place_layout(design: Design) -> data.StructLayout:
    """What is kept of a channel that has had a sample.

    phase, minor, major: of its next sample, the last staying at its largest.  ends_major: that one
    is its major interval's last.  What is always 0 is left out.
    """
    algorithm = design.algorithm
    bits = {
        "phase": (algorithm.samples - 1).bit_length(),
        "minor": (algorithm.minors - 1).bit_length(),
        "major": max(design.short_majors, 1).bit_length(),
        "ends_major": 1,
    }
    return data.StructLayout({name: width for name, width in bits.items() if width})


class Front(wiring.Component):
    """Lets samples wait, looks up the place of each in its channel's intervals, and launches it.

        sample ─▶ waiting ─▶ look-up: memory, `memory_latency` clocks ─▶ launch ─▶ flags
                                  ▲                                          │
                                  └────────────── place of the next ◀────────┘

    A sample is launched in the clock in which its channel's word is there; its flags come in the
    next, in which the word for the channel's next sample is written, too.  While a launch waits for
    room for a result all look-ups stand still.

    After reset it writes 0 to all words, one a clock.  Nothing is taken meanwhile.

    Members:
        sample_valid, sample_ready, sample_channel, sample_restart: of the sample port.
        result_taken (in): the host takes the last word of a result in this clock.
        take (out): a sample of a channel that is there is taken in this clock.
        clearing (out): the words are written after reset; place: where.
        started (out): that is over: from the first clock on in which a sample may be taken.
    In the clock after a launch (clock 0 of the datapath):
        taken: that is so.
        slot, channel: which of the samples that waited it is, in turn; whose.
        fresh: it is the channel's first, since reset or because it restarts.
        phase: its k - 1 = 0..n-1.
        launch: its phase has a non-zero tap row, or is its minor interval's last.
        minor_end, major_end: it is the last of its minor, major interval.
        first: it is the first of its major interval.
        first_launch, first_minor: no `launch`, `minor_end` came before in its major interval.
        first_major: its major interval is the channel's first.
        short: a tap or weight in use in its interval reaches before the channel's first sample.

    Args:
        plan: the plan.
    """

    def __init__(self, plan: PipelinedChannelPlan) -> None:
        self.plan = plan
        self.design = design = plan.design
        self.layout = place_layout(design)
        # small ones need no block, which synthesis finds out
        self.places = BlockMemory(
            plan.target, self.layout.size + 1, [0] * design.channels, primitive=False
        )
        number = channel_bits(design)
        flags = "taken fresh launch minor_end major_end first first_launch first_minor first_major"
        super().__init__(
            {
                "sample_valid": In(1),
                "sample_ready": Out(1),
                "sample_channel": In(number),
                "sample_restart": In(1),
                "result_taken": In(1),
                "take": Out(1),
                "clearing": Out(1, init=1),
                "place": Out(number),
                "started": Out(1),
                "slot": Out(range(WAITING)),
                "channel": Out(number),
                "phase": Out(range(design.algorithm.samples)),
                "short": Out(1),
                **{flag: Out(1) for flag in flags.split()},
            }
        )

    def elaborate(self, platform: object) -> Module:
        m, design = Module(), self.design
        m.submodules.places = places = self.places
        goes, enters = Signal(), Signal()
        legal = self.sample_channel < design.channels
        m.d.comb += self.take.eq(self.sample_valid & self.sample_ready & legal)
        there, head = self._waiting(m, enters, goes)

        # the samples that are looked up, and the one whose flags are shown
        tag = data.StructLayout({"valid": 1, "restart": 1, "channel": len(self.channel)})
        row = [Signal(tag, name=f"looked_up_{i}") for i in range(places.latency)]
        now, moves = row[-1], Signal()
        clash = [(one.valid & (one.channel == head.channel)) for one in row]
        clash.append(self.taken & (self.channel == head.channel))
        m.d.comb += [
            enters.eq(there & ~self._any(clash) & moves & self._apart(m, enters, moves)),
            places.step.eq(moves),
            places.address.eq(head.channel),
        ]
        with m.If(moves):
            m.d.sync += row[0].eq(Cat(enters, head))
            m.d.sync += [after.eq(before) for before, after in pairwise(row)]

        found = Signal(self.layout)
        fresh = now.restart | ~places.data[-1]
        at_start = self.layout.const({"ends_major": int(design.samples_per_major == 1)})
        m.d.comb += found.eq(Mux(fresh, at_start.as_value(), places.data[:-1]))
        full = Signal()  # a result is under way or has not been taken whole
        waits = now.valid & found.ends_major & full
        m.d.comb += [moves.eq(~waits), goes.eq(now.valid & moves)]
        m.d.sync += full.eq((full & ~self.result_taken) | (goes & found.ends_major))
        m.d.sync += [self.taken.eq(goes), self.channel.eq(now.channel), self.fresh.eq(fresh)]
        self._tell(m, found, goes)
        self._keep(m, found)
        return m

    @staticmethod
    def _any(flags: list[Value]) -> Value:
        """Whether one of them is high."""
        found = flags[0]
        for flag in flags[1:]:
            found = found | flag
        return found

    def _waiting(self, m: Module, enters: Value, goes: Value) -> tuple[Value, data.View]:
        """Whether the look-up of a sample that waits has not begun, and the first such one."""
        tag = data.StructLayout({"restart": 1, "channel": len(self.channel)})
        tags = [Signal(tag, name=f"waits_{i}") for i in range(WAITING)]
        newest, looked, going = (
            Signal(range(WAITING), name=name) for name in ("newest", "looked", "going")
        )
        ahead, held = (Signal(range(WAITING + 1), name=name) for name in ("ahead", "held"))
        for number, one in enumerate(tags):
            with m.If(self.take & (newest == number)):
                m.d.sync += one.eq(Cat(self.sample_restart, self.sample_channel))
        with m.If(self.take):
            m.d.sync += newest.eq(newest + 1)
        with m.If(enters):
            m.d.sync += looked.eq(looked + 1)
        with m.If(goes):
            m.d.sync += going.eq(going + 1)
        then = Signal(range(WAITING + 1))
        m.d.comb += then.eq(_counted(held, self.take, goes))
        m.d.sync += [
            ahead.eq(_counted(ahead, self.take, enters)),  # wait for their look-up
            held.eq(then),  # wait for their launch
            self.slot.eq(going),
            self.started.eq(~self.clearing),
            self.sample_ready.eq(~self.clearing & (then != WAITING)),
        ]
        initial = Signal(len(self.place), name="initial")
        m.d.comb += self.place.eq(initial)
        with m.If(self.clearing):
            m.d.sync += initial.eq(initial + 1)
            with m.If(initial == self.design.channels - 1):
                m.d.sync += self.clearing.eq(0)
        head = Signal(tag, name="head")
        m.d.comb += head.eq(chosen(looked, [one.as_value() for one in tags]))
        return ahead != 0, head

    def _apart(self, m: Module, enters: Value, moves: Value) -> Value:
        """Whether look-ups have gone on for `spacing` clocks since the last one began."""
        spacing = self.plan.timing.spacing
        if spacing == 1:
            return Value.cast(1)
        left = Signal(range(spacing))
        with m.If(enters):
            m.d.sync += left.eq(spacing - 1)
        with m.Elif(moves & (left != 0)):
            m.d.sync += left.eq(left - 1)
        return left == 0

    def _field(self, place: data.View, name: str) -> Value:
        """What is kept by this name, 0 where nothing is."""
        return place[name] if name in self.layout.members else C(0, 1)

    def _tell(self, m: Module, found: data.View, goes: Value) -> None:
        """The flags of the sample that is launched."""
        design = self.design
        n, short = design.algorithm.samples, design.short_majors
        launched = sorted(tap_rows(design.table))
        phase, minor = (self._field(found, name) for name in ("phase", "minor"))
        begins, ends = minor == 0, phase == n - 1
        m.d.sync += [
            self.phase.eq(phase),
            self.launch.eq(is_one_of(phase, launched) & goes),
            self.minor_end.eq(ends & goes),
            self.major_end.eq(found.ends_major & goes),
            self.first.eq(begins & (phase == 0)),
            self.first_launch.eq(begins & (phase == launched[0])),
            self.first_minor.eq(begins),
            self.first_major.eq(found.major == 0),
            self.short.eq(found.major < short if short else 0),
        ]

    def _keep(self, m: Module, found: data.View) -> None:
        """Write the place of the channel's next sample; after reset clear all."""
        design, places = self.design, self.places
        n, minors = design.algorithm.samples, design.algorithm.minors
        last = n * minors - 1  # number of a major interval's last sample, from 0
        before = (last - 1) % (last + 1)
        phase, minor = (self._field(found, name) for name in ("phase", "minor"))
        ends, largest = phase == n - 1, max(design.short_majors, 1)
        more = found.ends_major & (found.major != largest)
        then = {
            "phase": Mux(ends, 0, _sum(phase, 1)),
            "minor": Mux(found.ends_major, 0, _sum(minor, ends)),
            "major": Mux(more, _sum(found.major, 1), found.major),
            "ends_major": (phase == before % n) & (minor == before // n),
        }
        following = Signal(self.layout, reset_less=True)
        m.d.sync += [following[name].eq(then[name]) for name in self.layout.members]
        m.d.comb += [
            places.write.eq(self.taken | self.clearing),
            places.write_address.eq(Mux(self.clearing, self.place, self.channel)),
            places.write_data.eq(Mux(self.clearing, 0, Cat(following, 1))),
        ]


def _sum(value: Value, more: Value | int) -> Value:
    """The sum, modulo what the value's bits hold."""
    return (value + more)[: len(value)]


def _counted(number: Value, more: Value, less: Value) -> Value:
    """One more, one less, or the same if both or neither are."""
    below = _sum(number, (1 << len(number)) - 1)
    return Mux(more == less, number, Mux(more, _sum(number, 1), below))
