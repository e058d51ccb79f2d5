"""Sums of samples times constant integers: taps (A, B) and weights (theta, v)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from amaranth import C, Cat, Module, Mux, Signal, Value, signed
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.parts.layout import is_one_of, vector
from sculler_model.wordlength import Interval

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
    """One sample, shifted, added or subtracted, in some phases only."""

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


def tree_latency(terms: Sequence[Term]) -> int:
    """Clocks to add the terms two by two, with a register after every addition; at least 1."""
    return max((len(terms) - 1).bit_length(), 1)


class WeightedSum(wiring.Component):
    """sum over d of c[k][d] * sample[t-d] for three axes, by shifts and additions, no multiplier.

    The coefficients are split into signed digits; the shifted samples are added in a binary tree
    with a register after every addition.  Every node is as wide as the result at most: the true
    sum fits there, so what an intermediate node drops modulo 2^width cannot matter.

    Latency: the depth of the tree (`tree_latency`); one sum per clock.

    Args:
        counts: range of one count.
        reach: furthest distance on the `samples` port.
        rows: the coefficients.  In phases left out the output means nothing.
        result: range of the sum.
        phase_count: n, for the width of `phase`.

    Attributes:
        phased: whether the sum differs from phase to phase, so that `phase` is looked at.
    """

    def __init__(
        self,
        counts: Interval,
        reach: int,
        rows: Rows,
        result: Interval,
        phase_count: int,
    ) -> None:
        self.counts = counts
        self.rows = dict(rows)
        self.result = result
        self.terms = terms_of(self.rows)
        self.latency = tree_latency(self.terms)
        self.phased = any(len(term.phases) < len(self.rows) for term in self.terms)
        super().__init__(
            {
                "samples": In(data.ArrayLayout(vector(counts), reach + 1)),
                "phase": In(range(phase_count)),
                "output": Out(vector(result)),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        gates = {
            phases: is_one_of(self.phase, list(phases))
            for phases in {term.phases for term in self.terms}
            if len(phases) < len(self.rows)
        }
        for axis in range(3):
            leaves = []
            for term in self.terms:
                shifted = Cat(C(0, term.shift), self.samples[term.distance][axis]).as_signed()
                if term.phases in gates:
                    shifted = Mux(gates[term.phases], shifted, 0)
                leaves.append((shifted, term.sign))
            m.d.comb += self.output[axis].eq(self._tree(m, leaves, axis))
        return m

    def _tree(self, m: Module, nodes: list[tuple[Value, int]], axis: int) -> Value:
        """Add (value, sign) pairs level by level; `latency` levels of registers."""
        for level in range(self.latency):
            pairs = [nodes[i : i + 2] for i in range(0, len(nodes), 2)]
            nodes = []
            for number, pair in enumerate(pairs):
                total, sign = _add(pair)
                if level == self.latency - 1 and sign < 0:
                    total, sign = -total, 1
                width = min(len(total), self.result.bits)
                node = Signal(
                    signed(width), name=f"sum{'xyz'[axis]}_{level}_{number}", reset_less=True
                )
                m.d.sync += node.eq(total)
                nodes.append((node, sign))
        ((root, _sign),) = nodes
        return root


def _add(pair: list[tuple[Value, int]]) -> tuple[Value, int]:
    """Add one or two signed nodes without a negation: returns (value, sign of the whole)."""
    if len(pair) == 1:
        return pair[0]
    (a, sign_a), (b, sign_b) = pair
    if sign_a == sign_b:
        return a + b, sign_a
    return (a - b, 1) if sign_a > 0 else (b - a, 1)
