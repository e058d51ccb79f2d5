"""AccumulatorPlan over a major interval."""

from collections.abc import Callable
from functools import partial

from amaranth import Cat, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.lib.adder import add
from sculler_hdl.lib.delay import APART, ControlDelay, SkewedSignal
from sculler_hdl.plan.accumulator import AccumulatorPlan
from sculler_hdl.plan.arrival import at_once, by_limbs, limbs


class Accumulator(wiring.Component):
    """One adder for one running sum, or for three that take turns; restarted by themselves.

    In a clock with `step` the present sum takes in `input`: ``newest' = before + input``.  After a
    step with `last` it starts from 0 again.  Of three sums x, y, z the present one is x, y, z, x,
    ... from step to step, and `last` comes with all three.

    Members:
        step, last, carry: at `plan.clock`; where the plan is `cleared`, `last` comes with steps
            only.  `carry`, if there are `signs`, is added to the sum.
        initial, if the plan has it (`plan.clock`): what a sum starts from, in its first
            step, else 0.
        input: as it arrives.
        before: the present sum as the step finds it, as `plan.before_arrival` says.
        newest: the sum that the step made, from `plan.arrival` to the next step.

    Latency: 1 clock and one for each limb, and one where the plan has the sum `apart`.

    Args:
        plan: the plan.
        inverted: how its flags are held (`ControlDelay`), to keep them apart from another's.
        apart: whether the flag that restarts it is marked, to be its own: others that are restarted
            at the same time may stand far from it.
    """

    def __init__(
        self, plan: AccumulatorPlan, *, inverted: bool = False, apart: bool = False
    ) -> None:
        self.plan = plan
        self.inverted = inverted
        self.apart = apart
        super().__init__(
            {
                "step": In(1),
                "last": In(1),
                "carry": In(1),
                **({"initial": In(plan.total.bits)} if plan.initial else {}),
                "input": In(plan.item.bits),
                "before": Out(plan.before.bits),
                "newest": Out(plan.total.bits),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m, plan = Module(), self.plan
        step = ControlDelay(m, "step", self.step, plan.clock, inverted=self.inverted)
        going = Signal(plan.total.bits)  # what the next step adds to
        before = [going] if plan.cleared else self._before(m, step)
        arrival = by_limbs(plan.total.bits, plan.limb, plan.clock - plan.early)
        found = SkewedSignal(m, "before", Cat(*before), arrival)
        item = SkewedSignal(m, "input", self.input, plan.item_arrival)
        carry = self.carry if plan.signs else None
        add_up = partial(add, found, item, top=plan.total.bits, limb=plan.limb)
        clock = plan.clock

        def at(flag: ControlDelay, first: int) -> Callable[[int], Value]:
            return lambda q: flag.at_clock(first + q)

        also = None
        if plan.cleared:
            last = ControlDelay(m, "last", self.last, clock, inverted=self.inverted, apart=True)
            if plan.apart:
                steps, ends = at(step, clock), at(last, clock)
                turn = add_up(name="going", clock=clock, carry=carry, step=steps, clear=ends)
                m.d.comb += going.eq(turn.value)
                clock += 1
                if carry is not None:
                    carry, early = Signal(name="carry_later", reset_less=True), carry
                    m.d.sync += carry.eq(early)
            else:
                also = self._going(m, step, last, going)
        made = add_up(name="total", clock=clock, carry=carry, step=at(step, clock), also=also)
        m.d.comb += [
            self.newest.eq(made.value),
            self.before.eq(found.value[: len(self.before)]),
        ]
        return m

    def _going(
        self, m: Module, step: ControlDelay, last: ControlDelay, going: Signal
    ) -> Callable[[int, int, int, Value], None]:
        """What puts each limb into the registers that the sum goes on from, or clears them."""
        clock = self.plan.clock

        def take(q: int, lo: int, hi: int, made: Value) -> None:
            with m.If(last.at_clock(clock + q)):
                m.d.sync += going[lo:hi].eq(0)
            with m.Elif(step.at_clock(clock + q)):
                m.d.sync += going[lo:hi].eq(made)

        return take

    def _before(self, m: Module, step: ControlDelay) -> list[Value]:
        """The limbs of the present sum where it waits, 0 in a sum's first step."""
        plan = self.plan
        # the newest sum is finished
        attrs = APART if self.apart else {}
        held = Signal(init=int(not self.inverted), name="restart", attrs=attrs)
        with m.If(self.step):
            m.d.sync += held.eq(~self.last if self.inverted else self.last)
        restart = ~held if self.inverted else held
        restarts = ControlDelay(m, "restart", restart, plan.clock, inverted=self.inverted)

        initial = None
        if plan.initial:
            bits = at_once(plan.total.bits, plan.clock)
            initial = SkewedSignal(m, "initial", self.initial, bits)
        # the newest sum goes round through `sums` - 1 registers more
        before: list[Value] = []
        for q, lo, hi in limbs(plan.total.bits, plan.limb):
            present: Value = Signal(hi - lo, name=f"present_{q}")
            m.d.comb += present.eq(Mux(restarts.at_clock(plan.clock + q), 0, self.newest[lo:hi]))
            for place in range(plan.sums - 1, 0, -1):
                register = Signal(hi - lo, name=f"waiting{place}_{q}")
                with m.If(step.at_clock(plan.clock + q)):
                    m.d.sync += register.eq(present)
                present = register
            if plan.sums == 1 and plan.gap > 1:  # there is time for a register before the adder
                register = Signal(hi - lo, name=f"waiting_{q}", reset_less=True)
                m.d.sync += register.eq(present)
                present = register
            if initial is not None:  # the present sum is 0 where this is not
                present = present | initial.slice_at(lo, hi, plan.clock + q)
            before.append(present)
        return before
