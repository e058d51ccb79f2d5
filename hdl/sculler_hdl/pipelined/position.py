"""High-resolution position: s_alpha, s_nu and scrolling.

`sculler_hdl.plan.position` has the algebra.

    s, r ─┬▶ LookaheadAxis: P, Q, sums ─▶ T, U ─▶ C, D ─┐
          └▶ delayed ───────────────────────────────────┴▶ CrossArray ─▶ times 6
"""

from __future__ import annotations

from amaranth import Module, Mux, Signal, Value
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.adder_tree import emit_dot_product
from sculler_hdl.lib.delay import ControlDelay, SkewedSignal
from sculler_hdl.lib.hold import emit_gated, emit_previous
from sculler_hdl.lib.layout import vector
from sculler_hdl.pipelined.cross_array import CrossArray
from sculler_hdl.pipelined.lookahead import LookaheadAxis
from sculler_hdl.plan.arrival import at_once
from sculler_hdl.plan.position import PositionPlan
from sculler_model.design import AXES


class Position(wiring.Component):
    """s_alpha, s_nu and scrolling of a major interval.

    Members:
        step (clock 0): a sample stands on `gyro` and `accel`.
        first, last (clock 0): it is the first, the last of its major interval.
        gyro, accel (clock 0): the newest sample, three axes.
        s_alpha, s_nu, scrolling: the sums with the last sample, as `plan.arrivals` says; of
            scrolling the components, or the newest of them if axes take turns.

    Latency: `plan.arrivals`, from a sample's step.  One sample every `plan.folding.steps` clocks.
    Reset makes the sample before the first one 0.

    Args:
        plan: the plan.
        primitive: whether to instantiate the target's multiplier blocks.
    """

    def __init__(self, plan: PositionPlan, *, primitive: bool = True) -> None:
        self.plan = plan
        self.primitive = primitive
        lanes = plan.array.lanes
        super().__init__(
            {
                "step": In(1),
                "first": In(1),
                "last": In(1),
                **{name: In(vector(counts)) for name, counts in plan.counts.items()},
                "s_alpha": Out(vector(plan.ranges["s_alpha"])),
                "s_nu": Out(vector(plan.ranges["s_nu"])),
                "scrolling": Out(data.ArrayLayout(plan.ranges["scrolling"].bits, lanes)),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m, plan = Module(), self.plan
        step, first = (ControlDelay(m, name, getattr(self, name)) for name in ("step", "first"))
        weight = Signal(range(plan.samples + 1), init=plan.samples - 1 or plan.samples)
        with m.If(self.step):
            m.d.sync += weight.eq(Mux(weight == 1, plan.samples, weight - 1))

        m.submodules.scrolling = array = CrossArray(
            plan.array, plan.launch, primitive=self.primitive
        )
        m.d.comb += [array.launch.eq(self.step), array.last.eq(self.last)]
        for i in range(3):
            self._axis(m, i, array, weight, step, first)
        for lane in range(plan.array.lanes):
            totals = {"total": array.scrolling[lane]}
            whole = emit_dot_product(m, f"scrolling_{AXES[lane]}", plan.wholes[lane], totals)
            m.d.comb += self.scrolling[lane].eq(whole)
        return m

    def _axis(
        self,
        m: Module,
        i: int,
        array: CrossArray,
        weight: Value,
        step: ControlDelay,
        first: ControlDelay,
    ) -> None:
        """An axis of both sensors, and its components of the array's operands."""
        plan, axis = self.plan, AXES[i]
        factors: dict[str, Value] = {}
        now: dict[str, Value] = {}
        before: dict[str, SkewedSignal] = {}
        for sensor, doubly in (("gyro", "s_alpha"), ("accel", "s_nu")):
            m.submodules[f"{sensor}_{axis}"] = part = LookaheadAxis(plan.sides[sensor])
            sample = Value.cast(getattr(self, sensor)[i])
            m.d.comb += [
                part.step.eq(self.step),
                part.first.eq(self.first),
                part.last.eq(self.last),
                part.weight.eq(weight),
                part.sample.eq(sample),
                getattr(self, doubly)[i].eq(part.doubly),
            ]
            factors[sensor] = part.factor
            word = SkewedSignal(m, f"{sensor}_{axis}", sample, at_once(len(sample)))
            now[sensor] = word.at_clock(plan.launch)
            # the gyro's is a clock early, for a gate is in its way
            clock = plan.launch - (2 if sensor == "gyro" else 0)
            arrival = at_once(len(sample), clock)
            shown = SkewedSignal(m, f"{sensor}_{axis}_now", word.at_clock(clock), arrival)
            name = f"{sensor}_{axis}_before"
            before[sensor] = SkewedSignal(m, name, emit_previous(shown, step), arrival)
        gated = emit_gated(first, before["gyro"])
        operands = {
            "left0": factors["gyro"],
            "left1": factors["accel"],
            "left2": emit_dot_product(m, f"first_{axis}", plan.first, {"before_first": gated}),
            "right0": now["accel"],
            "right1": now["gyro"],
            "right2": before["accel"].value,
        }
        for name, value in operands.items():
            m.d.comb += getattr(array, name)[i].eq(value)
