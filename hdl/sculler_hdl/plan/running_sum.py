"""What a `RunningSum` is built of."""

from sculler_hdl.plan.arrival import Arrival, Limbs, by_limbs, later
from sculler_model.design import Interval


class RunningSumPlan:
    """The plan of a `RunningSum`.

    Args:
        counts: range of one count.
        result: range of the sum.
        limb: how sums are cut.

    Attributes:
        total_arrival: clocks from a sample's `step` at which the bits of the total are there.
        arrival: clocks from the last sample's `step` at which the bits of the sum are there.
    """

    def __init__(self, counts: Interval, result: Interval, limb: Limbs) -> None:
        self.counts = counts
        self.result = result
        self.limb = limb
        self.total_arrival: Arrival = by_limbs(result.bits, limb, 1)
        self.arrival: Arrival = later(self.total_arrival, 1)
