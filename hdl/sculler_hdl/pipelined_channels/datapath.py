"""From a channel's sample to the components of its result.

                                         alpha, nu
                            ┌─▶ ChannelAccumulator ×6 ─┐
                   ┌▶ theta, v ────────┴───────────────┴─▶ ChannelCrossArray "between" ─┐
    sample, History                                                                     ├─▶ result
                   └▶ A, B ──────── s, r delayed ────────▶ ChannelCrossArray "within"  ─┘

All four sums of samples are DirectSums.  The clocks are those of `ChannelSchedule`; clock 0 is that
in which the `Front` shows the sample's flags.
"""

from __future__ import annotations

from amaranth import Cat, Module, Signal, Value
from amaranth.lib import data

from sculler_hdl.lib.delay import ControlDelay, SkewedSignal
from sculler_hdl.pipelined_channels.accumulator import ChannelAccumulator
from sculler_hdl.pipelined_channels.cross_array import ChannelCrossArray
from sculler_hdl.pipelined_channels.direct_sum import DirectSum
from sculler_hdl.pipelined_channels.front import Front
from sculler_hdl.pipelined_channels.history import History
from sculler_hdl.plan.arrival import at_once
from sculler_hdl.plan.direct_sum import DirectSumPlan
from sculler_hdl.plan.pipelined_channels import PipelinedChannelPlan, history_clock
from sculler_model.design import AXES

Vector = list[Value]
"""Three components."""


class ChannelDatapath:
    """The parts that calculate, put into the core's own module and wired.

    Args:
        m: the core.
        plan: its plan.
        front: where the samples' flags come from.
        counts: the counts of the sample whose flags are shown, by sensor.
        results: where the components of the result go, each at the clocks that
            `schedule.arrivals` says.
        primitive: whether to instantiate the target's own blocks.

    Attributes:
        samples: the newest sample's counts, each in a register, by sensor.
        flags: the flags of a sample, by name.
        channel: whose it is.
    """

    def __init__(
        self,
        m: Module,
        plan: PipelinedChannelPlan,
        front: Front,
        counts: dict[str, Vector],
        results: data.View,
        *,
        primitive: bool,
    ) -> None:
        self.m = m
        self.plan = plan
        self.schedule = plan.schedule
        self.front = front
        self.results = results
        self.primitive = primitive
        self.in_blocks = primitive and plan.in_blocks
        names = "taken minor_end major_end first first_minor first_major short"
        self.flags = {
            name: ControlDelay(m, name, getattr(front, name), cleared=not name.startswith("first"))
            for name in names.split()
        }
        bits = len(front.channel)
        self.channel = SkewedSignal(m, "channel", front.channel, at_once(bits))
        self.phase = SkewedSignal(m, "phase", front.phase, at_once(len(front.phase)))
        self.samples: dict[str, list[SkewedSignal]] = {}
        for sensor, three in counts.items():
            self.samples[sensor] = []
            for axis, count in zip(AXES, three, strict=True):
                name = f"{sensor}_{axis}"
                register = Signal(len(count), name=f"{name}_sample", reset_less=True)
                m.d.sync += register.eq(count)
                word = SkewedSignal(m, name, register, at_once(len(count), 1))
                self.samples[sensor].append(word)

    def emit(self) -> None:
        """Put everything in."""
        schedule = self.schedule
        before = self._history()
        A, B = (
            self._sum(f"{sensor}_taps", part, sensor, before)
            for sensor, part in schedule.taps.items()
        )
        theta = self._sum("theta", schedule.minors["theta"], "gyro", before)
        v = self._sum("v", schedule.minors["v"], "accel", before)
        alpha = self._integral("alpha", theta)
        nu = self._integral("nu", v)
        s, r = (
            [word.at_clock(schedule.sample_clock) for word in self.samples[sensor]]
            for sensor in ("gyro", "accel")
        )
        front = self.front
        self._array("within", (A, B, s, r), front.launch, front.first_launch)
        if "between" in schedule.arrays:
            self._array("between", (alpha, nu, theta, v), front.minor_end, front.first_minor)

    def _history(self) -> dict[str, list[Vector]]:
        """For each sensor, from the newest sample on back, its three counts at `history_clock`."""
        m, clock, length = self.m, history_clock(self.plan.target), self.schedule.oldest
        now = {
            sensor: [word.at_clock(clock) for word in words]
            for sensor, words in self.samples.items()
        }
        found = {sensor: [three] for sensor, three in now.items()}
        if length == 0:
            return found
        newest = Cat(*now["gyro"], *now["accel"])
        m.submodules.history = history = History(
            self.plan.target,
            self.plan.design.channels,
            len(newest),
            length,
            primitive=self.in_blocks,
        )
        front = self.front
        m.d.comb += [
            history.step.eq(front.taken),
            history.fresh.eq(front.fresh),
            history.channel.eq(front.channel),
            history.sample.eq(newest),
        ]
        low = 0
        for _ in range(length):
            for sensor, three in now.items():
                older = []
                for count in three:
                    older.append(history.before[low : low + len(count)])
                    low += len(count)
                found[sensor].append(older)
        return found

    def _sum(self, name: str, plan: object, sensor: str, before: dict[str, list[Vector]]) -> Vector:
        """A sum of a sensor's samples."""
        m = self.m
        assert isinstance(plan, DirectSumPlan)
        m.submodules[name] = part = DirectSum(plan)
        if plan.is_gated:
            m.d.comb += part.phase.eq(self.phase.at_clock(history_clock(self.plan.target)))
        for distance in part.distances:
            three = getattr(part, f"sample{distance}")
            for i, count in enumerate(before[sensor][distance]):
                m.d.comb += three[i].eq(count)
        return [Value.cast(part.output[i]) for i in range(3)]

    def _integral(self, name: str, items: Vector) -> Vector:
        """Alpha or nu; returns what they were before the newest minor interval."""
        m, plan, flags = self.m, self.schedule.integrals[name], self.flags
        read = plan.clock - self.plan.target.memory_latency
        before: Vector = []
        for i, axis in enumerate(AXES):
            part = ChannelAccumulator(
                plan, self.plan.target, self.plan.design.channels, primitive=self.in_blocks
            )
            m.submodules[f"{name}_{axis}"] = part
            m.d.comb += [
                part.address.eq(self.channel.at_clock(read)),
                part.step.eq(flags["minor_end"].at_clock(plan.clock)),
                part.restart.eq(flags["first_minor"].at_clock(plan.clock)),
                part.input.eq(items[i]),
                self.results[name][i].eq(part.newest),
            ]
            before.append(part.before)
        return before

    def number(self) -> Value:
        """The number of a channel's result, as `schedule.number_arrival` says."""
        m, plan, target = self.m, self.schedule.number, self.plan.target
        m.submodules.number = part = ChannelAccumulator(
            plan, target, self.plan.design.channels, primitive=self.in_blocks
        )
        m.d.comb += [
            part.address.eq(self.channel.at_clock(plan.clock - target.memory_latency)),
            part.step.eq(self.flags["major_end"].at_clock(plan.clock)),
            part.restart.eq(self.flags["first_major"].at_clock(plan.clock)),
            part.input.eq(1),
        ]
        return Value.cast(part.before)

    def _array(
        self, place: str, operands: tuple[Vector, ...], launch: Value, restart: Value
    ) -> None:
        """An array of cross products, whose flags leave the front without delay."""
        m, plan = self.m, self.schedule.arrays[place]
        m.submodules[f"cross_{place}"] = array = ChannelCrossArray(
            plan,
            self.schedule.launches[place],
            self.plan.target,
            self.plan.design.channels,
            primitive=self.primitive,
            in_blocks=self.in_blocks,
            inverted=place == "within",
        )
        m.d.comb += [
            array.launch.eq(launch),
            array.restart.eq(restart),
            array.channel.eq(self.front.channel),
        ]
        for name, components in zip(plan.operands, operands, strict=True):
            for i in range(3):
                m.d.comb += getattr(array, name)[i].eq(components[i])
        for total, lanes in plan.results.items():
            for i, (lane, _) in enumerate(lanes):
                m.d.comb += self.results[f"{total}_{place}"][i].eq(getattr(array, total)[lane])
