"""Sequencing: which sample is which, and when the next one may come."""

from amaranth import C, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.parts.layout import is_one_of
from sculler_model.design import Design


class Sequencer(wiring.Component):
    """Counts samples and minor intervals, and flags each accepted sample.

    `sample_ready` is a register.  It is low for `spacing` - 1 clocks after a sample, and while the
    next sample would end a major interval whose predecessor's result has not been taken: so at
    most one result is ever under way or waiting, and the result registers cannot be overwritten.

    Members:
        sample_valid, sample_ready, sample_fault: the sample port's handshake.
        result_taken (in): the host takes the waiting result, to its last word, in this clock.
        taken (out): a sample was taken in the clock before.  What follows is of that sample.
        launch: its phase has a non-zero tap row, or is its minor interval's last.
        minor_end, major_end: it is the last of its minor, major interval.
        phase: k - 1 = 0..n-1.
        first: it is the first of its major interval.
        short: a tap or weight in use reached before the first sample since reset.
        fault: the sensor's own mark.
    Where no sample was taken, launch, minor_end and major_end are 0 and the others mean nothing.

    Latency 1 from a sample to its flags.

    Args:
        design: the design.
        spacing: clocks from one sample to the next, at least.
    """

    latency = 1

    def __init__(self, design: Design, spacing: int) -> None:
        self.design = design
        self.spacing = spacing
        super().__init__(
            {
                "sample_valid": In(1),
                "sample_ready": Out(1, init=1),
                "sample_fault": In(1),
                "result_taken": In(1),
                "taken": Out(1),
                "launch": Out(1),
                "minor_end": Out(1),
                "major_end": Out(1),
                "phase": Out(range(design.algorithm.samples)),
                "first": Out(1),
                "short": Out(1),
                "fault": Out(1),
            }
        )

    def short_samples(self) -> list[bool]:
        """For each t from reset, whether a tap or weight in use then reach before sample 0."""
        table = self.design.table
        short = []
        for t in range(table.history):
            k = t % table.samples + 1
            used = [d for d, c in enumerate(table.taps[k - 1], start=1) if c]
            if k == table.samples:
                used += [d for d, w in enumerate(table.weights) if w]
            short.append(max(used, default=0) > t)
        return short

    def elaborate(self, platform: object) -> Module:
        m = Module()
        n, minors = self.design.table.samples, self.design.algorithm.minors

        accept = Signal()
        m.d.comb += accept.eq(self.sample_valid & self.sample_ready)

        # the place of the next sample, and what the place after it will be
        phase, minor = Signal(range(n)), Signal(range(minors))
        first = Signal(init=1)  # of its major interval
        ends_minor = Signal(init=n == 1)
        in_last_minor = Signal(init=minors == 1)
        ends_major = Signal()
        then_ends_minor, then_in_last_minor = Signal(), Signal()
        m.d.comb += [
            ends_major.eq(ends_minor & in_last_minor),
            then_ends_minor.eq(C(1) if n == 1 else phase == n - 2),
            then_in_last_minor.eq(
                C(1) if minors == 1 else Mux(ends_minor, minor == minors - 2, in_last_minor)
            ),
        ]
        with m.If(accept):
            m.d.sync += [
                phase.eq(Mux(ends_minor, 0, (phase + 1)[: len(phase)])),
                first.eq(ends_major),
                ends_minor.eq(then_ends_minor),
                in_last_minor.eq(then_in_last_minor),
            ]
            with m.If(ends_minor):
                m.d.sync += minor.eq(Mux(in_last_minor, 0, (minor + 1)[: len(minor)]))

        # whether it may come
        awaited = Signal()  # a major interval has ended and its result is not yet taken
        still_awaited, then_ends_major = Signal(), Signal()
        m.d.comb += [
            still_awaited.eq((accept & ends_major) | (awaited & ~self.result_taken)),
            then_ends_major.eq(Mux(accept, then_ends_minor & then_in_last_minor, ends_major)),
        ]
        m.d.sync += [
            awaited.eq(still_awaited),
            self.sample_ready.eq(~(then_ends_major & still_awaited)),
        ]
        if self.spacing > 1:
            wait = Signal(range(self.spacing - 1))
            with m.If(accept):
                m.d.sync += [wait.eq(self.spacing - 2), self.sample_ready.eq(0)]
            with m.Elif(wait != 0):
                m.d.sync += [wait.eq(wait - 1), self.sample_ready.eq(0)]

        short = self.short_samples()
        if any(short):
            age = Signal(range(len(short) + 1))
            with m.If(accept & (age != len(short))):
                m.d.sync += age.eq(age + 1)
            is_short = is_one_of(age, [t for t, value in enumerate(short) if value])
            m.d.sync += self.short.eq(is_short)

        launches = [k - 1 for k in self.design.table.active_phases]
        m.d.sync += [
            self.taken.eq(accept),
            self.launch.eq(accept & (is_one_of(phase, launches) | ends_minor)),
            self.minor_end.eq(accept & ends_minor),
            self.major_end.eq(accept & ends_major),
            self.phase.eq(phase),
            self.first.eq(first),
            self.fault.eq(self.sample_fault),
        ]
        return m
