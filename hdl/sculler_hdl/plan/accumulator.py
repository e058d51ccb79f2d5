"""What an `Accumulator` is built of."""

from sculler_hdl.plan.arrival import Arrival, Limbs, by_limbs, first_limb_clock
from sculler_model.design import Interval


class AccumulatorPlan:
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
        initial: whether a sum may start from something else than 0.
        cleared: whether a single sum that may take a step at every clock goes on in registers of
            its own, which its last step clears: as many flip-flops more, and no gate before the
            adder.
        apart: whether such a sum is added up once more to be shown, a clock later: what goes round
            has no wire beyond its own adder then.

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
        initial: bool = False,
        cleared: bool = False,
        apart: bool = False,
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
        self.initial = initial
        self.cleared = cleared and sums == 1 and gap == 1 and not initial
        self.apart = apart and self.cleared
        # where steps are far apart the adder is given registers of its own before it
        self.early = int(sums == 1 and gap > 2)
        self.clock = first_limb_clock(arrival, limb) + self.early
        self.before = before or total
        self.arrival: Arrival = by_limbs(total.bits, limb, self.clock + 1 + self.apart)
        self.before_arrival: Arrival = by_limbs(self.before.bits, limb, self.clock - self.early)
