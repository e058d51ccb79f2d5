"""Accumulation over a major interval."""

from amaranth import Cat, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.parts.words import (
    Arrival,
    FlagLine,
    Limbs,
    Word,
    add,
    first_limb_clock,
    later,
    limbs,
)
from sculler_model.design import Interval


class Accumulation:
    """The plan of an `Accumulator`.

    Args:
        item: range of one addend.
        arrival: when the bits of `input` are there.
        total: worst-case range of a sum; wide enough for every partial sum (wordlength.py).
        limb: how sums are cut.
        before: range of a sum before its last item, if narrower.
        gap: clocks from one step to the next, at least.
        sums: 1 or 3.
        signs: whether some inputs are to be subtracted; those come inverted, with `carry`.

    Attributes:
        clock: at which `step` is looked at.
        early: clocks before a step at which the sum it adds to is there.
        arrival: when the bits of `newest` are there.
        before_arrival: when the bits of `before` are there.
    """

    def __init__(
        self,
        item: Interval,
        arrival: Arrival,
        total: Interval,
        limb: Limbs,
        before: Interval | None = None,
        sums: int = 1,
        gap: int = 1,
        *,
        signs: bool = False,
    ) -> None:
        if sums not in (1, 3):
            raise ValueError(f"an accumulator makes 1 or 3 sums, not {sums}")
        self.item = item
        self.item_arrival = arrival
        self.total = total
        self.limb = limb
        self.sums = sums
        self.gap = gap
        self.signs = signs
        # where steps are far apart the adder is given registers of its own before it
        self.early = int(sums == 1 and gap > 2)
        self.clock = first_limb_clock(arrival, limb) + self.early
        bits = [(hi - lo, q) for q, lo, hi in limbs(total.bits, limb)]
        self.arrival: Arrival = tuple((width, self.clock + q + 1) for width, q in bits)
        self.before = before or total
        self.before_arrival: Arrival = tuple(
            (hi - lo, self.clock - self.early + q) for q, lo, hi in limbs(self.before.bits, limb)
        )


class Accumulator(wiring.Component):
    """One adder for one running sum, or for three that take turns; restarted by themselves.

    In a clock with `step` the present sum takes in `input`: ``newest' = before + input``.  After a
    step with `last` it starts from 0 again.  Of three sums x, y, z the present one is x, y, z, x,
    ... from step to step, and `last` comes with all three.

    Members:
        step, last, carry: at `plan.clock`.  `carry`, if there are `signs`, is added to the sum.
        input: as it arrives.
        before: the present sum as the step finds it, as `plan.before_arrival` says.
        newest: the sum that the step made, from `plan.arrival` to the next step.

    Latency: 1 clock and one for each limb.

    Args:
        plan: the plan.
        inverted: how its flags are held (`FlagLine`), to keep them apart from another's.
    """

    def __init__(self, plan: Accumulation, *, inverted: bool = False) -> None:
        self.plan = plan
        self.inverted = inverted
        super().__init__(
            {
                "step": In(1),
                "last": In(1),
                "carry": In(1),
                "input": In(plan.item.bits),
                "before": Out(plan.before.bits),
                "newest": Out(plan.total.bits),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m, plan = Module(), self.plan
        step = FlagLine(m, "step", self.step, plan.clock, inverted=self.inverted)
        held = Signal(init=int(not self.inverted), name="restart")  # the newest sum is finished
        with m.If(self.step):
            m.d.sync += held.eq(~self.last if self.inverted else self.last)
        restart = ~held if self.inverted else held
        restarts = FlagLine(m, "restart", restart, plan.clock, inverted=self.inverted)

        # the newest sum goes round through `sums` - 1 registers more
        before: list[Value] = []
        for q, lo, hi in limbs(plan.total.bits, plan.limb):
            present: Value = Signal(hi - lo, name=f"present_{q}")
            m.d.comb += present.eq(Mux(restarts.at(plan.clock + q), 0, self.newest[lo:hi]))
            for place in range(plan.sums - 1, 0, -1):
                register = Signal(hi - lo, name=f"waiting{place}_{q}")
                with m.If(step.at(plan.clock + q)):
                    m.d.sync += register.eq(present)
                present = register
            if plan.sums == 1 and plan.gap > 1:  # there is time for a register before the adder
                register = Signal(hi - lo, name=f"waiting_{q}", reset_less=True)
                m.d.sync += register.eq(present)
                present = register
            before.append(present)
        found = Word(m, "before", Cat(*before), later(plan.arrival, -1 - plan.early))
        made = add(
            found,
            Word(m, "input", self.input, plan.item_arrival),
            "total",
            plan.total.bits,
            plan.clock,
            plan.limb,
            carry=self.carry if plan.signs else None,
            step=lambda q: step.at(plan.clock + q),
        )
        m.d.comb += [
            self.newest.eq(made.value),
            self.before.eq(found.value[: len(self.before)]),
        ]
        return m
