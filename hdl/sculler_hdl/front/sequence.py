"""Puts samples in their places."""

from __future__ import annotations

from amaranth import C, Module, Mux, Signal, Value, signed, unsigned
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.plan.front import FRONT_COUNTER_BITS, LATENCY_BITS, FrontPlan
from sculler_model.design import AXES, Design

_OWED_BITS = 16
_ALL_OWED = C((1 << _OWED_BITS) - 1)  # or one less
_MOST = C((1 << FRONT_COUNTER_BITS) - 1)


class SampleSequence(wiring.Component):
    """Hands over each sample in its place, and placeholders for those that are missing.

    In the first clock of a frame its count is compared with the expected one, in the second the
    difference becomes a number of samples, in the third the frame is judged and taken.  A clock
    counter, which begins with the last byte of a frame, brings time-outs.  Samples and placeholders
    wait for the core: placeholders that are owed go first, then the sample; a sample that still
    waits when the next frame comes is replaced by a placeholder.  `sample_valid` is low for a clock
    between samples.

    Members:
        data_valid (in): a byte comes.
        idle (in): no byte is yet to be looked at.
        frame_valid, frame_ready: a frame, with gyro_x ... accel_z, count, latency and fault.
        broken (in): a frame has a wrong check.
        sample_valid, sample_ready: to the core, with the counts, `sample_fault`, `sample_latency`.
        frames_taken, frames_bad, frames_missed, frames_late, sensor_faults (out): counters.

    Args:
        design: gives the widths of the core's counts.
        plan: the plan.
    """

    def __init__(self, design: Design, plan: FrontPlan) -> None:
        self.plan = plan
        self.counts = {
            f"{sensor}_{axis}": getattr(design.words, sensor).bits
            for sensor in ("gyro", "accel")
            for axis in AXES
        }
        super().__init__(
            {
                "data_valid": In(1),
                "idle": In(1),
                "frame_valid": In(1),
                "frame_ready": Out(1),
                **{name: In(unsigned(bits)) for name, bits in plan.field_bits.items()},
                "fault": In(1),
                "broken": In(1),
                "sample_valid": Out(1),
                "sample_ready": In(1),
                **{f"sample_{name}": Out(signed(bits)) for name, bits in self.counts.items()},
                "sample_fault": Out(1),
                **({"sample_latency": Out(LATENCY_BITS)} if "latency" in plan.fields else {}),
                **{name: Out(FRONT_COUNTER_BITS) for name in _COUNTERS},
            }
        )

    def elaborate(self, platform: object) -> Module:
        m, link = Module(), self.plan.link
        taken, missing, unused, jumped = self._judge(m)
        late = Signal(range(link.patience + 1))
        self._time_outs(m, late)
        fault = self.fault | jumped
        m.d.comb += self.frame_ready.eq(taken | unused)
        for counter, amount in (
            (self.frames_taken, taken),
            (self.frames_bad, self.broken + unused),
            (self.frames_missed, missing),
            (self.frames_late, late),
            (self.sensor_faults, taken & fault),
        ):
            self._count(m, counter, amount)
        self._hand_over(m, taken, fault, missing, late)
        return m

    @staticmethod
    def _count(m: Module, counter: Value, amount: Value) -> None:
        """Add to a counter, which stays at its highest."""
        total = Signal(FRONT_COUNTER_BITS + 1)
        m.d.comb += total.eq(counter + amount)
        m.d.sync += counter.eq(Mux(total[-1], _MOST, total[:FRONT_COUNTER_BITS]))

    def _judge(self, m: Module) -> tuple[Value, Value, Value, Value]:
        """The frame is taken, after how many missing ones; it is not used; the counter jumped."""
        counter, patience = self.plan.layout.counter, self.plan.link.patience
        if counter is None:
            return self.frame_valid, Value.cast(0), Value.cast(0), Value.cast(0)
        modulus, common = counter.modulus, counter.common_bits
        second, third, started, uneven = Signal(), Signal(), Signal(), Signal()
        difference, self._expected = Signal(counter.bits), Signal(counter.bits, name="expected")
        steps = Signal(counter.bits - common)
        self._ahead = Signal(range(counter.samples // 2 + 1), name="ahead")
        m.d.sync += [
            second.eq(self.frame_valid & ~second & ~third),
            third.eq(second),
            difference.eq(self.count - self._expected),
            uneven.eq(difference[:common].any()),
            steps.eq(
                (difference[common:] * counter.inverse)[: len(steps)]
                if counter.inverse > 1
                else difference[common:]
            ),
        ]
        unused, jumped, taken = Signal(), Signal(), Signal()
        missing = Signal(range(patience + 1))
        too_many = steps > patience if patience < counter.samples - 1 else Value.cast(0)
        m.d.comb += [
            unused.eq(third & started & ~uneven & (steps >= counter.samples - self._ahead)),
            jumped.eq(started & ~unused & (uneven | too_many)),
            taken.eq(third & ~unused),
            missing.eq(Mux(taken & started & ~jumped, steps[: len(missing)], 0)),
        ]
        with m.If(taken):
            m.d.sync += [
                started.eq(1),
                self._ahead.eq(0),
                self._expected.eq(self.count + C(counter.step % modulus, counter.bits)),
            ]
        return taken, missing, unused, jumped

    def _time_outs(self, m: Module, late: Signal) -> None:
        """How many placeholders a time-out brings in this clock."""
        link = self.plan.link
        since = Signal(range(4 * link.layout.longest + 64))  # the last byte
        age = Signal(range(link.time_out + link.interval + 2))
        running, first, due = Signal(), Signal(init=1), Signal()
        limit = Mux(first, link.time_out, link.interval)
        back = Mux(first, *(-limit % (1 << len(age)) for limit in (link.time_out, link.interval)))
        m.d.comb += [
            due.eq(running & self.idle & (age >= limit)),
            late.eq(Mux(due, Mux(first, link.patience, 1), 0)),
        ]
        with m.If(self.data_valid):
            m.d.sync += since.eq(1)
        with m.Elif(~since.all()):
            m.d.sync += since.eq(since + 1)
        with m.If(self.frame_valid & self.frame_ready):
            m.d.sync += [age.eq(since + 1), running.eq(1), first.eq(1)]
        with m.Elif(due):
            m.d.sync += [age.eq((age + back)[: len(age)] + 1), first.eq(0)]
        with m.Else():
            m.d.sync += age.eq(age + 1)
        counter = link.layout.counter
        if counter is not None:
            most = counter.samples // 2
            further = [
                C(count * counter.step % counter.modulus, counter.bits)
                for count in (link.patience, 1)
            ]
            total = self._ahead + late
            with m.If(due):
                m.d.sync += [
                    self._ahead.eq(Mux(total > most, most, total[: len(self._ahead)])),
                    self._expected.eq(self._expected + Mux(first, *further)),
                ]

    def _hand_over(
        self, m: Module, taken: Value, fault: Value, missing: Value, late: Value
    ) -> None:
        """The sample that waits, the placeholders that are owed before it, what the core sees."""
        fields = self.plan.layout
        waiting, moves, owed = Signal(), Signal(), Signal(_OWED_BITS)
        kept = {
            name: Signal(signed(bits), name=f"kept_{name}") for name, bits in self.counts.items()
        }
        kept_fault = Signal()
        free = ~self.sample_valid
        gives, replaced = Signal(), Signal()
        comes = taken | (late != 0)
        total = Signal(_OWED_BITS + 3)
        m.d.comb += [
            gives.eq(free & (owed != 0)),
            moves.eq(free & (owed == 0) & waiting),
            replaced.eq(waiting & ~moves & comes),
            total.eq(Mux(gives, (owed + _ALL_OWED)[:_OWED_BITS], owed) + missing + late + replaced),
        ]
        m.d.sync += owed.eq(Mux(total[_OWED_BITS:].any(), _ALL_OWED, total[:_OWED_BITS]))
        with m.If(taken):
            m.d.sync += [waiting.eq(1), kept_fault.eq(fault)]
            for name, signal in kept.items():
                value = getattr(self, name)
                number = getattr(fields, name[:-2])[0]
                m.d.sync += signal.eq(value.as_signed() if number.signed else value)
        with m.Elif(moves | replaced):
            m.d.sync += waiting.eq(0)
        with m.If(gives):
            m.d.sync += [self.sample_valid.eq(1), self.sample_fault.eq(1)]
        with m.Elif(moves):
            m.d.sync += [self.sample_valid.eq(1), self.sample_fault.eq(kept_fault)]
            for name, signal in kept.items():
                m.d.sync += getattr(self, f"sample_{name}").eq(signal)
        with m.Elif(self.sample_ready):
            m.d.sync += self.sample_valid.eq(0)
        if "latency" in self.plan.fields:
            kept_latency = Signal(LATENCY_BITS)
            with m.If(taken):
                m.d.sync += kept_latency.eq(self.latency)
            with m.If(moves):
                m.d.sync += self.sample_latency.eq(kept_latency)


_COUNTERS = ("frames_taken", "frames_bad", "frames_missed", "frames_late", "sensor_faults")
