"""From the sample to the components of the result.

                                         alpha, nu
                                   ┌─▶ Accumulator ×6 ─┐
                   ┌▶ theta, v ────┴───────────────────┴─▶ CrossArray "between" ─┐
    SampleRegisters                                                              ├─▶ result
                   └▶ A, B (WeightedSum) ─ s, r delayed ─▶ CrossArray "within"  ─┘

theta and v are a WeightedSum each, or a RunningSum if all samples weigh the same.

High-resolution position is a part beside all this (`Position`), with an array of its own that works
at every sample.  Third and fourth order are another (`VectorEngine`), which takes the sums that all
this makes of a minor interval, and is done with them before the next ones come.

The clocks are those of `Schedule`.
"""

from __future__ import annotations

from typing import NamedTuple

from amaranth import Module, Signal, Value
from amaranth.lib import data

from sculler_hdl.lib.accumulator import Accumulator
from sculler_hdl.lib.delay import ControlDelay, SkewedSignal
from sculler_hdl.lib.running_sum import RunningSum
from sculler_hdl.lib.weighted_sum import WeightedSum
from sculler_hdl.pipelined.cross_array import CrossArray
from sculler_hdl.pipelined.position import Position
from sculler_hdl.pipelined.samples import SampleRegisters
from sculler_hdl.pipelined.sequencer import Sequencer
from sculler_hdl.pipelined.vector_engine import VectorEngine
from sculler_hdl.pipelined.vector_loader import VectorLoader
from sculler_hdl.plan.arrival import at_once, later
from sculler_hdl.plan.running_sum import RunningSumPlan
from sculler_hdl.plan.schedule import MINOR_CLOCK, POSITION_CLOCK, TAP_CLOCK, Schedule
from sculler_hdl.plan.vector.engine import RESULTS, VectorEnginePlan
from sculler_hdl.plan.vector.page import HALVES
from sculler_hdl.plan.weighted_sum import WeightedSumPlan
from sculler_model.design import AXES, HIGH_RESOLUTION_VECTORS

INVERTED = {"gyro": False, "accel": True, "between": False, "within": True}
"""How the flags of a sensor's parts, of an array are held: they stay apart (`ControlDelay`)."""

Vector = list[Value]
"""Three components."""


class SampleControl(NamedTuple):
    """The flags of a sample, for the parts of one sensor, which stand together."""

    taken: ControlDelay
    minor_end: ControlDelay
    major_end: ControlDelay


class Datapath:
    """The parts that calculate, put into the core's own module and wired.

    Args:
        m: the core.
        schedule: the parts and their clocks.
        sequencer: where the samples' flags come from.
        counts: the sample port's counts, by sensor.
        results: where the components of the result go, each at the clocks that
            `schedule.arrivals` says.
        primitive: whether to instantiate the target's own multiplier blocks.

    Attributes:
        control: the flags of a sample, by sensor.
        samples: the newest sample in registers.
        finishing: the results of the vector engine come, if there is one.
    """

    def __init__(
        self,
        m: Module,
        schedule: Schedule,
        sequencer: Sequencer,
        counts: dict[str, list[Value]],
        results: data.View,
        *,
        primitive: bool,
    ) -> None:
        self.m = m
        self.schedule = schedule
        self.sequencer = sequencer
        self.results = results
        self.primitive = primitive
        self.control = {
            sensor: SampleControl(
                *(
                    ControlDelay(
                        m, f"{sensor}_{flag}", getattr(sequencer, flag), inverted=INVERTED[sensor]
                    )
                    for flag in SampleControl._fields
                )
            )
            for sensor in counts
        }
        self.samples = SampleRegisters(m, counts)
        phase, after = sequencer.phase_now, sequencer.phase
        self.phase = SkewedSignal(m, "phase", phase, at_once(len(phase)), later=after)
        self.finishing: Value | None = None

    def emit(self) -> None:
        """Put everything in."""
        schedule, samples = self.schedule, self.samples
        A, B = (
            self._weighted_sum(f"{sensor}_taps", plan, sensor, TAP_CLOCK)
            for sensor, plan in schedule.taps.items()
        )
        theta = self._minor_sum("theta", "gyro")
        v = self._minor_sum("v", "accel")
        alpha = self._integral("alpha", theta, "gyro")
        nu = self._integral("nu", v, "accel")
        s, r = (samples.at_clock(sensor, schedule.sample_clock) for sensor in ("gyro", "accel"))
        self._array("within", (A, B, s, r), self.sequencer.launch)
        if "between" in schedule.arrays:
            self._array("between", (alpha, nu, theta, v), self.sequencer.minor_end)
        self._position()
        if schedule.engine is not None:
            loads: dict[str, tuple[Vector, ...]] = {"theta": (theta, v), "alpha": (alpha, nu)}
            for place in schedule.arrays:
                loads[place] = tuple(
                    [self.results[f"{kind}_{place}"][i] for i in range(3)]
                    for kind in ("coning", "sculling")
                )
            self._engine(schedule.engine, loads)

    def _weighted_sum(self, name: str, plan: WeightedSumPlan, sensor: str, clock: int) -> Vector:
        """A weighted sum of a sensor's samples, which takes them at a clock."""
        m = self.m
        m.submodules[name] = part = WeightedSum(plan, inverted=INVERTED[sensor])
        m.d.comb += part.step.eq(self.control[sensor].taken.at_clock(clock))
        if plan.is_gated:
            m.d.comb += part.phase.eq(self.phase.at_clock(clock - 1))
        for i, sample in enumerate(self.samples.at_clock(sensor, clock)):
            m.d.comb += part.samples[i].eq(sample)
        return [Value.cast(part.output[i]) for i in range(3)]

    def _minor_sum(self, name: str, sensor: str) -> Vector:
        """Theta or v."""
        m, plan, control = self.m, self.schedule.minors[name], self.control[sensor]
        if not isinstance(plan, RunningSumPlan):
            return self._weighted_sum(name, plan, sensor, MINOR_CLOCK)
        outputs: Vector = []
        for axis, sample in zip(AXES, self.samples.at_clock(sensor, MINOR_CLOCK), strict=True):
            m.submodules[f"{name}_{axis}"] = part = RunningSum(plan, inverted=INVERTED[sensor])
            m.d.comb += [
                part.step.eq(control.taken.at_clock(MINOR_CLOCK)),
                part.last.eq(control.minor_end.at_clock(MINOR_CLOCK)),
                part.sample.eq(sample),
            ]
            outputs.append(part.output)
        return outputs

    def _integral(self, name: str, items: Vector, sensor: str) -> Vector:
        """Alpha or nu; returns what they were before the newest minor interval."""
        m, plan, control = self.m, self.schedule.integrals[name], self.control[sensor]
        before: Vector = []
        for i, axis in enumerate(AXES):
            part = Accumulator(plan, inverted=INVERTED[sensor])
            m.submodules[f"{name}_{axis}"] = part
            m.d.comb += [
                part.step.eq(control.minor_end.at_clock(plan.clock)),
                part.last.eq(control.major_end.at_clock(plan.clock)),
                part.input.eq(items[i]),
                self.results[name][i].eq(part.newest),
            ]
            before.append(part.before)
        return before

    def _array(self, place: str, operands: tuple[Vector, ...], launch: Value) -> None:
        """An array of cross products, whose flags leave the sequencer without delay."""
        m, plan = self.m, self.schedule.arrays[place]
        m.submodules[f"cross_{place}"] = array = CrossArray(
            plan,
            self.schedule.launches[place],
            primitive=self.primitive,
            inverted=INVERTED[place],
            tell_unread=self.schedule.engine is not None,
        )
        m.d.comb += [array.launch.eq(launch), array.last.eq(self.sequencer.major_end)]
        for name, components in zip(plan.operands, operands, strict=True):
            for i in range(3):
                m.d.comb += getattr(array, name)[i].eq(components[i])
        for total, lanes in plan.results.items():
            for i, (lane, _) in enumerate(lanes):
                m.d.comb += self.results[f"{total}_{place}"][i].eq(getattr(array, total)[lane])

    def _position(self) -> None:
        """High-resolution position, if the design has it."""
        m, plan, control = self.m, self.schedule.position, self.control["gyro"]
        if plan is None:
            return
        m.submodules.position = position = Position(plan, primitive=self.primitive)
        first = ControlDelay(m, "first", self.sequencer.first, 1)
        m.d.comb += [
            position.step.eq(control.taken.at_clock(POSITION_CLOCK)),
            position.first.eq(first.at_clock(POSITION_CLOCK)),
            position.last.eq(control.major_end.at_clock(POSITION_CLOCK)),
        ]
        for sensor in self.control:
            for i, sample in enumerate(self.samples.at_clock(sensor, POSITION_CLOCK)):
                m.d.comb += getattr(position, sensor)[i].eq(sample)
        for i, lane in enumerate(plan.lanes):
            for name, component in zip(HIGH_RESOLUTION_VECTORS, (i, i, lane), strict=True):
                m.d.comb += self.results[name][i].eq(getattr(position, name)[component])

    def _engine(self, plan: VectorEnginePlan, given: dict[str, tuple[Vector, ...]]) -> None:
        """Third and fourth order, of what is given: angles and velocities by name."""
        m, control = self.m, self.control["gyro"]
        start = self.schedule.engine_clock
        m.submodules.engine = engine = VectorEngine(plan, primitive=self.primitive)
        begins = Signal(init=1, name="engine_first")  # the next minor interval begins a major one
        starts = control.minor_end.at_clock(start)
        ends_major = control.major_end.at_clock(start)
        with m.If(starts):
            m.d.sync += begins.eq(ends_major)
        m.d.comb += [
            engine.taken.eq(control.taken.at_clock(MINOR_CLOCK)),
            engine.ends_minor.eq(control.minor_end.at_clock(MINOR_CLOCK)),
            engine.phase.eq(self.phase.at_clock(MINOR_CLOCK)),
            engine.start.eq(starts),
            engine.first.eq(begins),
            engine.ends_major.eq(ends_major),
        ]
        for late, sensor in enumerate(("gyro", "accel")):
            for i, count in enumerate(self.samples.at_clock(sensor, MINOR_CLOCK + late)):
                m.d.comb += getattr(engine, sensor)[i].eq(count)
        for side in plan.loads:
            self._loader(engine, side, given)
        for target in plan.sums:
            for i in range(3):
                total = engine.totals[i if plan.lanes == 3 else 0]
                m.d.comb += self.results[RESULTS[target]][i].eq(total)
        self.finishing = engine.finishing

    def _loader(
        self, engine: VectorEngine, side: str, given: dict[str, tuple[Vector, ...]]
    ) -> None:
        """What the engine loads on a side."""
        m, names = self.m, engine.plan.loads[side]
        arrivals = self.schedule.loads(engine.plan)
        come = [arrivals[name] for name in names]
        first = min(clock for three in come for one in three for _, clock in one)
        for i, axis in enumerate(AXES):
            loader = VectorLoader([later(three[i], -first) for three in come])
            m.submodules[f"engine_{side}_{axis}"] = loader
            m.d.comb += [
                loader.load.eq(self.control["gyro"].minor_end.at_clock(first)),
                loader.shift.eq(engine.shift),
                getattr(engine, f"{side}_words")[i].eq(loader.output),
            ]
            for number, name in enumerate(names):
                letter, half = name.split(".")
                word = given[letter][HALVES.index(half)][i]
                m.d.comb += getattr(loader, f"word{number}").eq(word)
