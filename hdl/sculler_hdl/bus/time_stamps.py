"""When samples came and results were made, in clocks since reset."""

from __future__ import annotations

from amaranth import Cat, Module, Mux, Signal, unsigned
from amaranth.lib import memory, wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.crossing import Synchroniser
from sculler_model.design import Design
from sculler_model.golden import WORD_BITS, Timing

TIME_BITS = 64


def intervals_under_way(design: Design, timing: Timing) -> int:
    """Intervals, a power of two, that may end between a result's last sample and its first word.

    While a result is made, or waits behind one, further intervals may end.  A core that drops
    results then drops those between, so no result is older than this when it is first shown.
    """
    late = timing.latency
    if timing.dropping is not None:
        late += timing.dropping.refill + timing.dropping.claim
    intervals = -(-late // (design.samples_per_major * timing.spacing)) + 3
    return 1 << (intervals - 1).bit_length()


class TimeStamps(wiring.Component):
    """A counter of clocks, and what it was at samples, results and pulses.

    The time of a result's last sample is kept, by the low bits of the result's number, until the
    result's words come.

    Members:
        restart (in): the core begins anew with interval 0; the clock goes on.
        taken (in): the core takes a sample.
        instant (in), from_instant (in): the moment that belongs to the next sample; whether it
            counts, and not the clock in which the core takes the sample.
        begins (in), number (in): a result's first word is shown.
        result (in): a result's last word is taken.
        pulse (in): a pulse per second, of any clock; its rising edge counts.
        now (out): clocks since reset.
        pulse_time (out), pulses (out), pulse_came (out): of the last pulse, how many, and that
            one came.
        stamps (out): the words behind a result's columns (`plan.result_window.STAMPS`).

    Latency: `pulse_time` is that of the clock in which the pulse is seen, two clocks after the
    input rose.

    Args:
        design: the design.
        timing: the core's clocks.
    """

    def __init__(self, design: Design, timing: Timing) -> None:
        self.per_interval = design.samples_per_major
        self.kept = intervals_under_way(design, timing)
        super().__init__(
            {
                "restart": In(1),
                "taken": In(1),
                "instant": In(1),
                "from_instant": In(1),
                "begins": In(1),
                "number": In(unsigned(WORD_BITS)),
                "result": In(1),
                "pulse": In(1),
                "now": Out(unsigned(TIME_BITS)),
                "pulse_time": Out(unsigned(TIME_BITS)),
                "pulses": Out(unsigned(32)),
                "pulse_came": Out(1),
                "stamps": Out(unsigned(3 * TIME_BITS + 32)),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        self._count(m)
        self._pulse(m)
        sample_time = self._samples(m)
        stamps = Signal(unsigned(2 * TIME_BITS + 32))
        with m.If(self.result):
            m.d.sync += stamps.eq(Cat(self.now, self.pulse_time, self.pulses))
        m.d.comb += self.stamps.eq(Cat(sample_time, stamps))
        return m

    def _count(self, m: Module) -> None:
        """Two halves; that the upper one moves is known a clock ahead."""
        low = Signal(32)
        high = Signal(32)
        wraps = Signal()
        m.d.sync += [low.eq(low + 1), wraps.eq(low == (1 << 32) - 2)]
        with m.If(wraps):
            m.d.sync += high.eq(high + 1)
        m.d.comb += self.now.eq(Cat(low, high))

    def _pulse(self, m: Module) -> None:
        m.submodules.pulse_input = settled = Synchroniser(1)
        before = Signal()
        m.d.comb += [
            settled.data_in.eq(self.pulse),
            self.pulse_came.eq(settled.data_out & ~before),
        ]
        m.d.sync += before.eq(settled.data_out)
        with m.If(self.pulse_came):
            m.d.sync += [self.pulse_time.eq(self.now), self.pulses.eq(self.pulses + 1)]

    def _samples(self, m: Module) -> Signal:
        """The time of the last sample of the result whose words come."""
        m.submodules.kept = kept = memory.Memory(shape=unsigned(64), depth=self.kept, init=[])
        write, read = kept.write_port(), kept.read_port()
        instant = Signal(TIME_BITS)
        ended = Signal()
        place = Signal(range(self.per_interval))
        interval = Signal(range(self.kept))
        with m.If(self.instant):
            m.d.sync += instant.eq(self.now)
        m.d.sync += [
            ended.eq(self.taken & (place == self.per_interval - 1)),
            write.data.eq(Mux(self.from_instant, instant, self.now)),
        ]
        with m.If(self.taken):
            m.d.sync += place.eq(place + 1)
            with m.If(place == self.per_interval - 1):
                m.d.sync += place.eq(0)
        with m.If(ended):
            m.d.sync += interval.eq(interval + 1)
        with m.If(self.restart):
            m.d.sync += [place.eq(0), interval.eq(0), ended.eq(0)]
        m.d.comb += [
            write.en.eq(ended),
            write.addr.eq(interval),
            read.en.eq(self.begins),
            read.addr.eq(self.number),
        ]
        return read.data
