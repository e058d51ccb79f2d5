"""What a `DirectSum` is built of: sums of samples that all stand there at once."""

from __future__ import annotations

from sculler_hdl.plan.adder_tree import Addend, AdderTreePlan
from sculler_hdl.plan.arrival import Limbs, at_once
from sculler_hdl.plan.weighted_sum import Gate, Rows, ShiftedSample, WeightedSumPlan, terms_of
from sculler_model.design import ZERO_RANGE, Interval


class DirectSumPlan(WeightedSumPlan):
    """The plan of a `DirectSum`, which gives what a `WeightedSum` gives.

    Args:
        counts, rows, result, phase_count, limb: as of `WeightedSumPlan`.

    Attributes:
        shifted: the samples that are added, shifted.
        tree: the additions.
        arrival: clocks from a sample's `step` at which the bits of its sum are there.
    """

    def __init__(
        self, counts: Interval, rows: Rows, result: Interval, phase_count: int, limb: Limbs
    ) -> None:
        self.counts = counts
        self.rows = dict(rows)
        self.result = result
        self.phase_count = phase_count
        self.limb = limb
        self.shifted = terms_of(self.rows)
        self.tree = AdderTreePlan(
            [self._addend(term) for term in self.shifted] or [Addend(ZERO_RANGE, at_once(1))],
            result,
            limb,
        )
        self.arrival = self.tree.arrival

    @property
    def oldest(self) -> int:
        """The distance of the oldest sample that is added."""
        return max((term.distance for term in self.shifted), default=0)

    @property
    def gates(self) -> list[Gate]:
        """Each set of phases in which alone some sample is added."""
        gates = [self.gate(term) for term in self.shifted]
        return list(dict.fromkeys(gate for gate in gates if gate is not None))

    def gate(self, term: ShiftedSample) -> Gate | None:
        """The phases, of the newest sample, in which a sample is added; None if in all."""
        return None if len(term.phases) == len(self.rows) else term.phases

    def _addend(self, term: ShiftedSample) -> Addend:
        gate = self.gate(term)
        return Addend(
            self.counts | ZERO_RANGE,
            at_once(self.counts.bits, int(gate is not None)),
            term.shift,
            term.sign < 0,
            source=(term.distance, gate),
        )
