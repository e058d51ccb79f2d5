"""Finds frames in a stream of bytes."""

from __future__ import annotations

from amaranth import Cat, Module, Mux, Signal, Value, unsigned
from amaranth.lib import memory, wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.front.check import FrameCheck
from sculler_hdl.lib.block_memory import memory_attributes
from sculler_hdl.plan.front import FrontPlan


class FrameReceiver(wiring.Component):
    """Takes bytes into a memory and looks for frames in it.

    A byte is looked at in two clocks: its place in the frame tells what it is.  After the last one,
    and the zeros that the check covers beyond it, the check is compared.  If it is wrong, or as
    soon as no kind of frame begins so, the frame that may begin one byte further is looked at from
    the memory.  Bytes come slowly enough that this is done before the next one.

    Members:
        data_valid, data (in): a byte comes.
        held (out): bytes of a frame have come, or of what may be one.
        idle (out): all bytes have been looked at, and none comes.
        frame_valid, frame_ready: a whole frame with a sample, kept until taken.
        gyro_x ... accel_z, count, latency (out): its numbers as they stand there; `count` and
            `latency` where it has them.
        fault (out): a status flag of the frame is raised.
        broken (out): a frame has a wrong check; once for the bytes it would have had.

    Args:
        plan: the plan.
    """

    def __init__(self, plan: FrontPlan) -> None:
        self.plan = plan
        self.layout = plan.layout
        self.head = len(self.layout.kinds[0].first)
        super().__init__(
            {
                "data_valid": In(1),
                "data": In(unsigned(8)),
                "held": Out(1),
                "idle": Out(1),
                "frame_valid": Out(1),
                "frame_ready": In(1),
                **{name: Out(unsigned(bits)) for name, bits in plan.field_bits.items()},
                "fault": Out(1),
                "broken": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m, layout = Module(), self.layout
        longest = layout.longest
        self._begin = Signal(range(self.plan.ring), name="begin")
        self._at = Signal(range(self.plan.ring), name="at")
        self._index = Signal(range(longest + 1), name="index")  # in the frame, of the byte `at`
        self._left = Signal(range(longest + 1), name="left", init=longest)  # with that byte
        self._kinds = Signal(len(layout.kinds), name="kinds", init=-1)  # that it may be of
        self._in_head = Value.cast(0) if layout.aligned else self._index < self.head
        use, skip, again = Signal(), Signal(), Signal()
        end, byte = self._memory(m)
        fits = self._find_kind(m, byte, use)
        is_last = (self._left == 1) & ~self._in_head
        zeros = Signal(range(1 + max(kind.zeros for kind in layout.kinds)))
        m.d.comb += [
            self.held.eq(self._begin != end),
        ]
        covers, more_zeros = Signal(), Signal()
        wrong, empty = self._look(m, byte, use, skip | again)
        wrong = wrong | self._check(m, byte, use, covers | more_zeros, skip | again)
        with m.FSM():
            with m.State("WAIT"):
                m.d.comb += self.idle.eq((self._at == end) & ~self.data_valid)
                with m.If(self._at != end):
                    m.next = "USE"
            with m.State("USE"):
                m.d.comb += [use.eq(1), skip.eq(~fits), covers.eq(fits & self._is_covered())]
                m.d.sync += zeros.eq(self._of_kind("zeros"))
                m.next = "WAIT"
                with m.If(fits & is_last):
                    m.next = "CHECK"
            with m.State("CHECK"):
                m.next = "WAIT"
                with m.If(zeros != 0):
                    m.d.sync += zeros.eq(zeros - 1)
                    m.d.comb += more_zeros.eq(1)
                    m.next = "CHECK"
                with m.Elif(wrong):
                    m.d.comb += (again if layout.aligned else skip).eq(1)
                with m.Elif(empty | ~self._of_kind("sample").any()):
                    m.d.comb += again.eq(1)
                with m.Else():
                    m.next = "SHOW"
                failed = (zeros == 0) & wrong
            with m.State("SHOW"):
                m.d.comb += self.frame_valid.eq(1)
                with m.If(self.frame_ready):
                    m.d.comb += again.eq(1)
                    m.next = "WAIT"
        in_check = Signal()
        m.d.comb += in_check.eq((skip | again) & ~use & ~self.frame_valid & failed)
        self._go_on(m, use, skip, again, in_check)
        return m

    def _memory(self, m: Module) -> tuple[Signal, Value]:
        """Where the next byte goes, and the byte that was at `at` in the clock before."""
        end = Signal(range(self.plan.ring), name="end")
        depth = self.plan.ring
        m.submodules.bytes = bytes_ = memory.Memory(
            shape=unsigned(8), depth=depth, init=[], attrs=memory_attributes(depth, 8)
        )
        write, read = bytes_.write_port(), bytes_.read_port()
        m.d.comb += [
            write.addr.eq(end),
            write.data.eq(self.data),
            write.en.eq(self.data_valid),
            read.addr.eq(self._at),
        ]
        with m.If(self.data_valid):
            m.d.sync += end.eq(end + 1)
        return end, read.data

    def _find_kind(self, m: Module, byte: Value, use: Signal) -> Value:
        """Whether a kind of frame begins with the bytes so far and this one."""
        if self.layout.aligned:
            return Value.cast(1)
        fitting = Signal(len(self.layout.kinds))
        with m.Switch(self._index):
            for place in range(self.head):
                with m.Case(place):
                    same = Cat(byte == kind.first[place] for kind in self.layout.kinds)
                    m.d.comb += fitting.eq(self._kinds & same)
            with m.Default():
                m.d.comb += fitting.eq(self._kinds)
        with m.If(use):
            m.d.sync += self._kinds.eq(fitting)
            with m.If(self._index == self.head - 1):
                m.d.sync += self._left.eq(self._of_kind("length", fitting) - self.head)
        return fitting.any()

    def _of_kind(self, attribute: str, kinds: Value | None = None) -> Value:
        """A number of the kind that is left of all."""
        chosen = self._kinds if kinds is None else kinds
        value = Value.cast(0)
        for bit, kind in zip(chosen, self.layout.kinds, strict=True):
            value |= Mux(bit, int(getattr(kind, attribute)), 0)
        return value

    def _check(self, m: Module, byte: Value, use: Signal, valid: Value, start: Value) -> Value:
        """Whether the check, where there is one, is wrong."""
        parameters = self.layout.check
        if parameters is None:
            return Value.cast(0)
        m.submodules.check = check = FrameCheck(parameters)
        m.d.comb += [
            check.start.eq(start),
            check.valid.eq(valid),
            check.data.eq(Mux(use, byte, 0)),
            check.high.eq((self._index[0] ^ (parameters.first & 1)) == parameters.little),
        ]
        return check.value != self._given

    def _is_covered(self) -> Value:
        """Whether the check covers the byte."""
        check = self.layout.check
        if check is None:
            return Value.cast(0)
        until = self._in_head | (self._left >= -check.last)
        return (self._index >= check.first) & until if check.first else until

    def _is_at(self, place: int) -> Value:
        """Whether the byte stands at a place of the frame."""
        if place >= 0:
            return self._index == place
        return (self._left == -place) & ~self._in_head

    def _look(self, m: Module, byte: Value, use: Signal, anew: Value) -> tuple[Value, Value]:
        """Keep what a byte says.  Whether the frame is wrong, and whether it holds no sample."""
        layout = self.layout
        some, absent = Signal(), Signal()
        numbers = [(getattr(self, name), number) for name, number in self.plan.fields.items()]
        if layout.check is not None:
            self._given = Signal(unsigned(layout.check.bits), name="given")
            numbers.append((self._given, layout.check.given))
        with m.If(use):
            for signal, number in numbers:
                for low, place in enumerate(reversed(number.places)):
                    part = signal[8 * low : 8 * low + 8]
                    with m.If(self._is_at(place) if len(part) else 0):
                        m.d.sync += part.eq(byte[: len(part)])
            for into, every in ((self.fault, layout.faults), (absent, layout.absent)):
                for flags in every:
                    raised = ((byte ^ flags.normal) & flags.mask).any()
                    with m.If(self._is_at(flags.place) & raised):
                        m.d.sync += into.eq(1)
            m.d.sync += some.eq(some | byte.any())
        with m.If(anew):
            m.d.sync += [some.eq(0), absent.eq(0), self.fault.eq(0)]
        return ~some if layout.some_set else Value.cast(0), absent

    def _go_on(self, m: Module, use: Signal, skip: Signal, again: Signal, failed: Signal) -> None:
        """The next byte; or the next frame: after this one, or one byte further."""
        counted = Signal(range(self.layout.longest + 1))  # bytes of a broken frame told of
        m.d.comb += self.broken.eq(failed & (counted == 0))
        with m.If(use):
            m.d.sync += [self._at.eq(self._at + 1), self._index.eq(self._index + 1)]
            with m.If(~self._in_head):
                m.d.sync += self._left.eq(self._left - 1)
        with m.If(skip | again):
            m.d.sync += [
                self._index.eq(0),
                self._kinds.eq(-1),
                self._left.eq(self.layout.longest),
            ]
        with m.If(again):
            m.d.sync += [self._begin.eq(self._at), counted.eq(0)]
        with m.If(skip):
            m.d.sync += [self._begin.eq(self._begin + 1), self._at.eq(self._begin + 1)]
            with m.If(counted != 0):
                m.d.sync += counted.eq(counted - 1)
            with m.Elif(failed):
                m.d.sync += counted.eq(self._index - 1)
