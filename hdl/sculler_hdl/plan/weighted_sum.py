"""What a `WeightedSum` is built of: taps (A, B) and weights (theta, v)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import reduce

from sculler_hdl.plan.adder_tree import Addend, AdderTreePlan
from sculler_hdl.plan.arrival import Arrival, Limbs, at_once, by_limbs, first_limb_clock
from sculler_hdl.plan.dot_product import signed_digits
from sculler_model.design import ZERO_RANGE, Interval

Rows = Mapping[int, Sequence[tuple[int, int]]]
"""Phase (0..n-1) -> pairs (distance, coefficient) that are not zero."""

Gate = tuple[int, ...]
"""The phases in which a sample passes; in the others 0 takes its place."""


@dataclass(frozen=True)
class ShiftedSample:
    """One sample, shifted, added or subtracted, for sums of some phases only."""

    distance: int
    shift: int
    sign: int
    phases: tuple[int, ...]


def terms_of(rows: Rows) -> list[ShiftedSample]:
    """The shifted samples that make up the rows.

    Args:
        rows: the coefficients; phases left out do not matter.
    """
    phases: dict[tuple[int, int, int], list[int]] = {}
    for phase, row in rows.items():
        for distance, coefficient in row:
            for shift, sign in signed_digits(coefficient):
                phases.setdefault((distance, shift, sign), []).append(phase)
    return [ShiftedSample(*key, tuple(when)) for key, when in sorted(phases.items())]


class WeightedSumPlan:
    """The plan of a `WeightedSum`.

    Args:
        counts: range of one count.
        rows: the coefficients.  In phases left out the output means nothing.
        result: range of the sum.
        phase_count: n.
        limb: how sums are cut.

    Attributes:
        arrival: clocks from a sample's `step` at which the bits of its sum are there.
        clock: from a sample's `step` to when the chain's lowest limb takes it in.
        distances: of the partial sums, the oldest first.
        terms: what a sample adds to the partial sum of each distance.
        products: the additions of those terms, where there are any.
    """

    def __init__(
        self, counts: Interval, rows: Rows, result: Interval, phase_count: int, limb: Limbs
    ) -> None:
        self.counts = counts
        self.rows = dict(rows)
        self.result = result
        self.phase_count = phase_count
        self.limb = limb
        terms = terms_of(self.rows)
        distances = {term.distance for term in terms}
        self.newest = 0 if 0 in distances else 1
        self.distances = range(max(distances, default=1), self.newest - 1, -1)
        self.terms = {d: [term for term in terms if term.distance == d] for d in self.distances}
        self.products = {
            d: AdderTreePlan(
                self._addends(terms), Interval.signed(self.bits(d)), limb, counts | ZERO_RANGE
            )
            for d, terms in self.terms.items()
            if terms
        }
        arrivals = [product.arrival for product in self.products.values()]
        self.clock = max((first_limb_clock(bits, limb) for bits in arrivals), default=0)
        self.arrival: Arrival = by_limbs(result.bits, limb, self.clock + 1 - self.newest)

    @property
    def gates(self) -> list[Gate]:
        """Each set of phases in which alone some term takes up a sample."""
        gates = [self.gate(term) for terms in self.terms.values() for term in terms]
        return list(dict.fromkeys(gate for gate in gates if gate is not None))

    @property
    def is_gated(self) -> bool:
        """Whether it makes a difference in which phase a sample comes."""
        return bool(self.gates)

    def gate(self, term: ShiftedSample) -> Gate | None:
        """The phases of a sample that the term takes up; None if it may take all."""
        if len(term.phases) == len(self.rows):
            return None
        return tuple(sorted((k - term.distance) % self.phase_count for k in term.phases))

    def _addends(self, terms: Sequence[ShiftedSample]) -> list[Addend]:
        """The terms of one distance: multiples of one sample, if all take up the same phases."""
        gates = [self.gate(term) for term in terms]
        multiple = 1 if len(set(gates)) == 1 else None
        return [
            Addend(
                self.counts | ZERO_RANGE,
                at_once(self.counts.bits, int(gate is not None)),
                term.shift,
                term.sign < 0,
                multiple,
                source="every phase" if gate is None else gate,
            )
            for term, gate in zip(terms, gates, strict=True)
        ]

    def bits(self, distance: int) -> int:
        """Width of the partial sum of a distance: what has come in from there on back."""
        if distance == self.newest:
            return self.result.bits
        partial = [
            sum((self.counts.scaled(c) for d, c in row if d >= distance), ZERO_RANGE)
            for row in self.rows.values()
        ]
        return reduce(Interval.__or__, partial, ZERO_RANGE).bits
