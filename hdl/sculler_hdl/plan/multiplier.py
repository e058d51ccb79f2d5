"""How a product of any width is made of multiplier blocks of fixed width.

The top piece of an operand is signed and the others are not; the product is the sum of the pieces'
products, each in a block of its own.  A few low bits that would need blocks of their own are
multiplied by rows of AND gates instead (the residue).

    left  = l1 l0 r     l1 x r1, l1 x r0, l0 x r1, l0 x r0   blocks
    right = r1 r0       r x right                            a row for each bit of the residue
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import product

from sculler_hdl.plan.adder_tree import Addend
from sculler_hdl.plan.arrival import Arrival, at_once, last_clock, spans
from sculler_hdl.targets import Target
from sculler_model.design import ZERO_RANGE, Interval

BLOCK_LATENCY = 3
"""Clocks of one multiplier block: registers before, inside and behind the multiplier."""

RESIDUE_BITS = (2, 4, 8)
"""Most low bits of an operand that rows of AND gates multiply, to save blocks: from few to many."""


@dataclass(frozen=True)
class OperandSplit:
    """An operand cut into its residue and the pieces that go to multiplier blocks.

    Attributes:
        residue: low bits, each of which gives a row of AND gates.
        ends: first bit of each piece, and the end of the last.  All but the last are unsigned.
    """

    residue: int
    ends: tuple[int, ...]

    @property
    def pieces(self) -> list[tuple[int, int]]:
        """(first bit, end bit) of each piece."""
        return list(zip(self.ends[:-1], self.ends[1:], strict=True))


def operand_splits(bits: int, block: int, residue: int) -> list[OperandSplit]:
    """The ways to cut an operand for a block's signed operand: without a residue, and with one.

    A residue has at most `residue` bits, and those it has spare a piece.

    Unsigned pieces have one bit less than the block takes.
    """
    found = []
    spare = (bits - 1) % (block - 1)  # bits that would need a piece of their own
    for low in sorted({0, spare} if bits > block and spare <= residue else {0}):
        inner = range(low + block - 1, bits - 1, block - 1)
        found.append(OperandSplit(low, (low, *inner, bits)))
    return found


@dataclass(frozen=True)
class MultiplierPlan:
    """The plan of one exact product: blocks for the pieces' products, rows for the residues.

    The product is the sum of `addends`, one for each block and then one for each row.

    A block's product is there `BLOCK_LATENCY` + 1 = 4 clocks after its operands, a row 1 clock.
    One product a clock.

    Attributes:
        target: whose multiplier blocks.
        left, right: ranges of the operands.
        left_arrival, right_arrival: when their bits are there.
        residue: most low bits of an operand that may go to rows.
    """

    target: Target
    left: Interval
    right: Interval
    left_arrival: Arrival
    right_arrival: Arrival
    residue: int = max(RESIDUE_BITS)

    @cached_property
    def _choice(self) -> tuple[bool, OperandSplit, OperandSplit]:
        first, second = self.target.multiplier_bits
        found = [
            (turned, a, b)
            for turned, x, y in ((False, first, second), (True, second, first))
            for a in operand_splits(self.left.bits, x, self.residue)
            for b in operand_splits(self.right.bits, y, self.residue)
            if a.residue + b.residue <= max(RESIDUE_BITS)
        ]
        return min(
            found,
            key=lambda way: (
                len(way[1].pieces) * len(way[2].pieces),
                way[1].residue + way[2].residue,
                way[0],
            ),
        )

    @property
    def turned(self) -> bool:
        """Whether the operands change places at the blocks."""
        return self._choice[0]

    @property
    def left_split(self) -> OperandSplit:
        """How the left operand is cut."""
        return self._choice[1]

    @property
    def right_split(self) -> OperandSplit:
        """How the right operand is cut."""
        return self._choice[2]

    @property
    def block_count(self) -> int:
        """Multiplier blocks."""
        return len(self.piece_pairs)

    @property
    def rows(self) -> int:
        """Rows of AND gates."""
        return self.left_split.residue + self.right_split.residue

    @property
    def piece_pairs(self) -> list[tuple[tuple[int, int], tuple[int, int]]]:
        """The pieces of left and right that each block multiplies."""
        return list(product(self.left_split.pieces, self.right_split.pieces))

    @cached_property
    def addends(self) -> list[Addend]:
        """What the product is the sum of."""
        left, right = self.left_split, self.right_split
        found = []
        for a, b in self.piece_pairs:
            span = _piece(self.left, *a) * _piece(self.right, *b)
            clock = self.block_clock(a, b) + BLOCK_LATENCY + 1
            found.append(Addend(span, at_once(span.bits, clock), a[0] + b[0]))
        for bit in range(left.residue):
            arrival = _row_arrival(self.left_arrival, bit, self.right_arrival, 0)
            found.append(Addend(self.right | ZERO_RANGE, arrival, bit))
        upper = Interval(self.left.lo >> left.residue, self.left.hi >> left.residue) | ZERO_RANGE
        for bit in range(right.residue):
            arrival = _row_arrival(self.right_arrival, bit, self.left_arrival, left.residue)
            found.append(Addend(upper, arrival, left.residue + bit))
        return found

    def block_clock(self, a: tuple[int, int], b: tuple[int, int]) -> int:
        """The clock at which a block takes its pieces of left and right."""
        return max(last_clock(self.left_arrival, *a), last_clock(self.right_arrival, *b))

    def block_names(self, name: str) -> list[str]:
        """Names of the submodules for the addends that come from blocks."""
        pieces = product(range(len(self.left_split.pieces)), range(len(self.right_split.pieces)))
        return [f"{name}_tile{i}{j}" for i, j in pieces]


def _row_arrival(bits: Arrival, bit: int, others: Arrival, low: int) -> Arrival:
    there = last_clock(bits, bit, bit + 1)
    return tuple(
        (end - max(first, low), max(clock, there) + 1)
        for first, end, clock in spans(others)
        if end > low
    )


def _piece(operand: Interval, lo: int, hi: int) -> Interval:
    """Range of an operand's piece: the top one is signed, the others are not."""
    if hi < operand.bits:
        return Interval(0, (1 << (hi - lo)) - 1)
    return Interval(operand.lo >> lo, operand.hi >> lo) | ZERO_RANGE
