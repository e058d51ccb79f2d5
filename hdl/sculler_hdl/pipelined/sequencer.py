"""Sequencing: which sample is which, and when the next one may come."""

from amaranth import C, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.layout import is_one_of
from sculler_model.design import Design


class Sequencer(wiring.Component):
    """Counts samples and minor intervals, and flags each accepted sample.

    `sample_ready` is a register.  It is low for `spacing` - 1 clocks after a sample, and while the
    next sample would end a major interval and as many `results` as there is room for are under way
    or have not been taken: so the result registers cannot be overwritten, unless the design drops
    results.

    Members:
        sample_valid, sample_ready, sample_fault: the sample port's handshake.
        agreed_ready (in), where it is `tied`: a sample that is offered is taken, instead of
            `sample_ready`.
        sample_lost (in): one was lost before the sample taken in this clock.
        result_taken (in): the host takes the waiting result, to its last word, in this clock.
        taken (out): a sample is taken in this clock.
        launch: one whose phase has a non-zero tap row, or is its minor interval's last.
        minor_end, major_end: one that is the last of its minor, major interval.
        phase_now: its k - 1 = 0..n-1.
    In the clock after:
        phase: its k - 1 still.
        first: it is the first of its major interval.
        short: a tap or weight in use, or high-resolution position, reached before the first sample
            since reset.
        fault: the sensor's own mark.
        lost: a sample was lost before it.
    Where no sample was taken these mean nothing.

    Args:
        design: the design.
        spacing: clocks from one sample to the next, at least.
        results: that may be under way or wait to be taken, 1 or 2; 2 needs major intervals of
            three samples or more.
        tied: see `agreed_ready`.
    """

    def __init__(
        self, design: Design, spacing: int, results: int = 1, *, tied: bool = False
    ) -> None:
        self.design = design
        self.tied = tied
        self.spacing = spacing
        self.results = results
        super().__init__(
            {
                "sample_valid": In(1),
                "sample_ready": Out(1, init=1),
                "sample_fault": In(1),
                "sample_lost": In(1),
                "result_taken": In(1),
                "taken": Out(1),
                "launch": Out(1),
                "minor_end": Out(1),
                "major_end": Out(1),
                "phase": Out(range(design.algorithm.samples)),
                "phase_now": Out(range(design.algorithm.samples)),
                "first": Out(1),
                "short": Out(1),
                "fault": Out(1),
                "lost": Out(1),
                **({"agreed_ready": In(1)} if tied else {}),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        n, minors = self.design.table.samples, self.design.algorithm.minors

        accept = Signal()
        ready = self.agreed_ready if self.tied else self.sample_ready
        m.d.comb += accept.eq(self.sample_valid & ready)

        # the place of the next sample, and of the one after it; what they are stands in registers
        phase, minor = Signal(range(n)), Signal(range(minors))
        first = Signal(init=1)  # of its major interval
        ends_minor, then_ends_minor = Signal(init=n == 1), Signal(init=n <= 2)
        launches = [k in self.design.table.active_phases or k == n for k in range(1, n + 1)]
        launch = Signal(init=launches[0])
        last = n * minors - 1  # number of a major interval's last sample, from 0
        before = (last - 2) % (last + 1)  # and of the one two before it
        ends_major, then_ends_major = Signal(init=last == 0), Signal(init=last <= 1)
        with m.If(accept):
            m.d.sync += [
                phase.eq(Mux(ends_minor, 0, (phase + 1)[: len(phase)])),
                first.eq(ends_major),
                ends_minor.eq(then_ends_minor),
                ends_major.eq(then_ends_major),
                launch.eq(is_one_of(phase, [k for k in range(n) if launches[(k + 1) % n]])),
                # two samples on
                then_ends_minor.eq(phase == (n - 3) % n),
                then_ends_major.eq((phase == before % n) & (minor == before // n)),
            ]
            with m.If(ends_minor):
                more = (minor + 1)[: len(minor)]
                # a power of two of them comes to 0 by itself
                m.d.sync += minor.eq(Mux(ends_major, 0, more) if minors & minors - 1 else more)

        if self.design.drops_results:
            m.d.sync += self.sample_ready.eq(1)
        else:
            self._wait_for_room(m, accept, ends_major, then_ends_major, last == 0)
        if self.spacing > 1:
            wait = Signal(range(self.spacing - 1))
            with m.If(accept):
                m.d.sync += [wait.eq(self.spacing - 2), self.sample_ready.eq(0)]
            with m.Elif(wait != 0):
                m.d.sync += [wait.eq(wait - 1), self.sample_ready.eq(0)]

        self._find_short(m, accept)
        m.d.comb += [
            self.taken.eq(accept),
            self.launch.eq(accept & launch),
            self.minor_end.eq(accept & ends_minor),
            self.major_end.eq(accept & ends_major),
            self.phase_now.eq(phase),
        ]
        m.d.sync += [
            self.phase.eq(phase),
            self.first.eq(first),
            self.fault.eq(self.sample_fault),
            self.lost.eq(self.sample_lost),
        ]
        return m

    def _find_short(self, m: Module, accept: Value) -> None:
        """Whether a sample reaches back before the first one: its number after reset says so."""
        short = self.design.short_samples
        if not any(short):
            return
        age = Signal(range(len(short) + 1))
        with m.If(accept & (age != len(short))):
            m.d.sync += age.eq(age + 1)
        is_short = is_one_of(age, [t for t, value in enumerate(short) if value])
        m.d.sync += self.short.eq(is_short)

    def _wait_for_room(
        self, m: Module, accept: Value, ends_major: Value, then_ends_major: Value, always: bool
    ) -> None:
        """Keep an interval's last sample back while there is no room for its result.

        Args:
            accept: a sample is taken.
            ends_major, then_ends_major: the next one is an interval's last; the one after it.
            always: every one is.
        """
        # awaited[i]: more than i results under way or not yet taken; left[i]: after this clock
        ended = accept & ends_major
        awaited = [Signal(name=f"awaited{i}") for i in range(self.results)]
        left = [
            Mux(self.result_taken, more, this)
            for this, more in zip(awaited, [*awaited[1:], C(0, 1)], strict=True)
        ]
        for this, less, remains in zip(awaited, [C(1, 1), *left], left, strict=False):
            m.d.sync += this.eq(remains | (ended & less))
        full = left[-1]
        if always:
            m.d.sync += self.sample_ready.eq(~(accept | full))
        else:  # while an end is awaited `ends_major` keeps samples back
            to_end = ends_major | (self.sample_valid & then_ends_major)
            if self.spacing > 1:
                to_end = ends_major | (accept & then_ends_major)
            m.d.sync += self.sample_ready.eq(~(full & to_end))
