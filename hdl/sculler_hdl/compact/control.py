"""Which sample is which, when the next may come, and what the engine has to know of it."""

from __future__ import annotations

from amaranth import Module, Signal
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.delay import ControlDelay
from sculler_hdl.plan.compact.plan import CompactPlan

CONDITIONS = data.StructLayout(
    {
        "first_minor": 1,
        "first_major": 1,
        "major_end": 1,
        "fault": 1,
        "short": 1,
        "lost": 1,
    }
)
"""What the engine knows of the sample it works on.

first_minor: in the first minor interval of its major interval; first_major: in the first major
interval since reset; major_end: the last of its major interval; fault: the sensor marked a sample
of the major interval; short: a tap or weight used in the major interval reaches before the first
sample; lost: a sample was lost since the last sample of the one before.
"""


class Control(wiring.Component):
    """Counts samples and minor intervals.

    Members:
        take, fault (in): a sample is taken in this clock, and the sensor's mark.
        lost (in): one was lost before it.
        rail (in): the count that was being loaded two clocks before is at its rail.
        loaded (in): it is in the sample memory from the next clock on.
        result_taken (in): the last word of a result is taken in this clock.
        has_work (out): the phase of the sample that is being loaded, or comes next, has work.
        blocked (out): that sample ends a major interval, and the previous result is not taken
            whole, not in this clock either; never where the design drops results.
        conditions (out): of that sample.
        at_rail (out): a count of its major interval so far stood at its rail; looked at in the
            second clock after `loaded`.

    Args:
        plan: the plan.
    """

    def __init__(self, plan: CompactPlan) -> None:
        self.plan = plan
        super().__init__(
            {
                "take": In(1),
                "fault": In(1),
                "lost": In(1),
                "rail": In(1),
                "loaded": In(1),
                "result_taken": In(1),
                "has_work": Out(1),
                "blocked": Out(1),
                "conditions": Out(CONDITIONS),
                "at_rail": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        design = self.plan.design
        n, minors = design.algorithm.samples, design.algorithm.minors
        phase = Signal(range(n))
        minor = Signal(range(minors))
        short = design.short_majors
        major = Signal(range(max(short, 1) + 1))  # stays at its largest
        awaited = Signal()  # a major interval has ended and its result is not yet taken whole
        fault, lost, rail = Signal(), Signal(), Signal()
        ended = ControlDelay(m, "ended", self.loaded & self.conditions.major_end)
        minor_end = Signal()
        m.d.comb += [
            minor_end.eq(phase == n - 1),
            self.has_work.eq(phase.matches(*(k - 1 for k in self.plan.program.phases))),
            self.conditions.first_minor.eq(minor == 0),
            self.conditions.first_major.eq(major == 0),
            self.conditions.major_end.eq(minor_end & (minor == minors - 1)),
            self.conditions.fault.eq(fault),
            self.conditions.short.eq(major < short if short else 0),
            self.at_rail.eq(rail | self.rail),
            self.conditions.lost.eq(lost),
        ]
        if not design.drops_results:
            m.d.comb += self.blocked.eq(self.conditions.major_end & awaited & ~self.result_taken)
        with m.If(self.result_taken):
            m.d.sync += awaited.eq(0)
        m.d.sync += rail.eq(self.at_rail & ~ended.at_clock(2))
        with m.If(self.take):
            m.d.sync += [fault.eq(fault | self.fault), lost.eq(lost | self.lost)]
        with m.If(self.loaded):
            m.d.sync += phase.eq(phase + 1)
            with m.If(minor_end):
                m.d.sync += [phase.eq(0), minor.eq(minor + 1)]
            with m.If(self.conditions.major_end):
                m.d.sync += [minor.eq(0), awaited.eq(1)]
                m.d.sync += [fault.eq(0), lost.eq(0)]
                with m.If(major != max(short, 1)):
                    m.d.sync += major.eq(major + 1)
        return m
