"""Sums of samples times constant integers: taps (A, B) and weights (theta, v)."""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce

from amaranth import C, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.parts.layout import is_one_of, vector
from sculler_hdl.parts.words import (
    Addend,
    Arrival,
    FlagLine,
    Limbs,
    Sum,
    Word,
    add,
    at_once,
    first_limb_clock,
    later,
    limbs,
)
from sculler_model.design import AXES, ZERO_RANGE, Interval

Rows = Mapping[int, Sequence[tuple[int, int]]]
"""Phase (0..n-1) -> pairs (distance, coefficient) that are not zero."""


def signed_digits(value: int) -> list[tuple[int, int]]:
    """Canonical signed digits of an integer as (shift, +1 or -1), fewest possible, low first."""
    digits = []
    shift = 0
    while value:
        if value & 1:
            digit = 2 - value % 4  # +1 where the next bit is 0, else -1 and a carry
            digits.append((shift, digit))
            value -= digit
        value >>= 1
        shift += 1
    return digits


@dataclass(frozen=True)
class Term:
    """One sample, shifted, added or subtracted, for sums of some phases only."""

    distance: int
    shift: int
    sign: int
    phases: tuple[int, ...]


def terms_of(rows: Rows) -> list[Term]:
    """The shifted samples that make up the rows.

    Args:
        rows: the coefficients; phases left out do not matter.
    """
    phases: dict[tuple[int, int, int], list[int]] = {}
    for phase, row in rows.items():
        for distance, coefficient in row:
            for shift, sign in signed_digits(coefficient):
                phases.setdefault((distance, shift, sign), []).append(phase)
    return [Term(*key, tuple(when)) for key, when in sorted(phases.items())]


class Weighting:
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
            d: Sum(self._addends(terms), Interval.signed(self.bits(d)), limb, counts | ZERO_RANGE)
            for d, terms in self.terms.items()
            if terms
        }
        arrivals = [product.arrival for product in self.products.values()]
        self.clock = max((first_limb_clock(bits, limb) for bits in arrivals), default=0)
        shown = self.clock + 1 - self.newest
        self.arrival: Arrival = tuple(
            (hi - lo, shown + q) for q, lo, hi in limbs(result.bits, limb)
        )

    @property
    def is_gated(self) -> bool:
        """Whether it makes a difference in which phase a sample comes."""
        return any(self.gate(term) is not None for terms in self.terms.values() for term in terms)

    def gate(self, term: Term) -> tuple[int, ...] | None:
        """The phases of a sample that the term takes up; None if it may take all."""
        if len(term.phases) == len(self.rows):
            return None
        return tuple(sorted((k - term.distance) % self.phase_count for k in term.phases))

    def _addends(self, terms: Sequence[Term]) -> list[Addend]:
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


class WeightedSum(wiring.Component):
    """sum over d of c[k][d] * sample[t-d] for three axes, by shifts and additions, no multiplier.

    The coefficients are split into signed digits.  Each sample is multiplied by the coefficients
    of all distances when it comes, and the products wait in a chain of partial sums that moves
    on by one distance with every sample (the transposed form of a filter):

        sample ─┬─────────┬─────────┐
               c[2]      c[1]      c[0]
                └▶ sum 2 ─▶ sum 1 ──▶ sum 0

    So the chain holds the history, and what earlier samples add to a sum has long been added when
    the sum's last sample comes.  A sum without distance 0 is there before its own sample's step.

    Members:
        step (clock 0): a sample stands on `samples`.
        phase (clock 0): the sample's phase, 0..n-1; not looked at unless `plan.is_gated`.
        samples (clock 0): the newest sample, three axes.
        output: the sum that belongs to the sample, for each sample in turn, as `plan.arrival` says.

    Latency: `plan.arrival`; one sum per clock.  Reset makes all earlier samples 0.

    Args:
        plan: the plan.
        inverted: how its flags are held (`FlagLine`), to keep them apart from another's.
    """

    def __init__(self, plan: Weighting, *, inverted: bool = False) -> None:
        self.plan = plan
        self.inverted = inverted
        super().__init__(
            {
                "step": In(1),
                "phase": In(range(plan.phase_count)),
                "samples": In(vector(plan.counts)),
                "output": Out(vector(plan.result)),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m, plan = Module(), self.plan
        step = FlagLine(m, "step", self.step, inverted=self.inverted)
        gates: dict[tuple[int, ...], Value] = {}
        for terms in plan.terms.values():
            for term in terms:
                gate = plan.gate(term)
                if gate is not None:
                    gates.setdefault(gate, is_one_of(self.phase, list(gate)))
        for i, axis in enumerate(AXES):
            sample = self.samples[i]
            gated: dict[tuple[int, ...], Value] = {}
            for number, (gate, is_open) in enumerate(gates.items()):
                register = Signal.like(sample, name=f"gated{number}_{axis}", reset_less=True)
                m.d.sync += register.eq(Mux(is_open, sample, 0))
                gated[gate] = register
            total: Word | None = None
            products: dict[int, Word] = {}
            shared: dict[Hashable, Word] = {}
            for d in sorted(plan.products):  # the widest first, for the others to share its sums
                gates_of = [plan.gate(term) for term in plan.terms[d]]
                taken = [sample if gate is None else gated[gate] for gate in gates_of]
                products[d] = plan.products[d].build(m, f"product{d}_{axis}", taken, shared)
            for d in plan.distances:
                bits = plan.bits(d)
                nothing = Word(m, "nothing", C(0, 0), (), low=bits)
                product = products.get(d, nothing)
                moved = add(
                    total or nothing,
                    product,
                    f"sum{d}_{axis}",
                    bits,
                    plan.clock,
                    plan.limb,
                    step=lambda q: step.at(plan.clock + q),
                )
                # its step is the last clock that shows a partial sum of the samples before
                total = Word(m, f"sum{d}_{axis}", moved.value, later(moved.arrival, -1))
            if total is not None:
                m.d.comb += self.output[i].eq(total.value)
        return m
