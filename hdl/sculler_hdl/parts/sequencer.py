"""Sequencing: which sample is which, and when the next one may come."""

from amaranth import C, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.parts.layout import FLAGS, is_one_of
from sculler_model.design import Design


class Sequencer(wiring.Component):
    """Counts samples and minor intervals, and flags each accepted sample.

    `sample_ready` depends on registers only.  It is low while the next sample would end a major
    interval whose predecessor's result has not been taken: so at most one result is ever under
    way or waiting, and the result registers cannot be overwritten.

    Members:
        sample_valid, sample_ready, sample_fault: the sample port's handshake.
        result_taken (in): the host takes the waiting result in this clock.
        accept (out): a sample is taken in this clock.
        phase (out): the present sample's phase, k - 1 = 0..n-1.
        flags (out): the present sample's flags; all 0 when none is taken.
    """

    latency = 0

    def __init__(self, design: Design) -> None:
        self.design = design
        super().__init__(
            {
                "sample_valid": In(1),
                "sample_ready": Out(1),
                "sample_fault": In(1),
                "result_taken": In(1),
                "accept": Out(1),
                "phase": Out(range(design.algorithm.samples)),
                "flags": Out(FLAGS),
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
        table, minors = self.design.table, self.design.algorithm.minors

        minor = Signal(range(minors))
        awaited = Signal()  # a major interval has ended and its result is not yet taken
        minor_end = Signal()
        major_end = Signal()
        m.d.comb += [
            minor_end.eq(self.phase == table.samples - 1),
            major_end.eq(minor_end & (minor == minors - 1)),
            self.sample_ready.eq(~(major_end & awaited)),
            self.accept.eq(self.sample_valid & self.sample_ready),
        ]
        with m.If(self.accept):
            m.d.sync += self.phase.eq(self.phase + 1)
            with m.If(minor_end):
                m.d.sync += [self.phase.eq(0), minor.eq(minor + 1)]
            with m.If(major_end):
                m.d.sync += minor.eq(0)
        with m.If(self.accept & major_end):
            m.d.sync += awaited.eq(1)
        with m.Elif(self.result_taken):
            m.d.sync += awaited.eq(0)

        short = self.short_samples()
        is_short = C(0, 1)
        if any(short):
            age = Signal(range(len(short) + 1))
            with m.If(self.accept & (age != len(short))):
                m.d.sync += age.eq(age + 1)
            is_short = is_one_of(age, [t for t, value in enumerate(short) if value])

        tapped = [k - 1 for k in table.active_phases]
        m.d.comb += [
            self.flags.valid.eq(self.accept),
            self.flags.start.eq((self.phase == 0) & (minor == 0)),
            self.flags.tapped.eq(is_one_of(self.phase, tapped)),
            self.flags.minor_end.eq(self.accept & minor_end),
            self.flags.major_end.eq(self.accept & major_end),
            self.flags.short.eq(is_short),
            self.flags.fault.eq(self.sample_fault),
        ]
        return m
