"""Exact products of any widths from multiplier blocks of fixed width."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import product

from amaranth import C, Cat, Module, Signal, Value

from sculler_hdl.parts.tile import Tile
from sculler_hdl.parts.words import Addend, Arrival, Word, at_once, last_clock, spans
from sculler_hdl.target import Target
from sculler_model.design import ZERO_RANGE, Interval

FRINGES = (2, 4, 8)
"""Most low bits of an operand that rows of AND gates multiply, to save blocks: from few to many."""


@dataclass(frozen=True)
class Cut:
    """An operand cut into its fringe and the pieces that go to multiplier blocks.

    Attributes:
        fringe: low bits, each of which gives a row of AND gates.
        ends: first bit of each piece, and the end of the last.  All but the last are unsigned.
    """

    fringe: int
    ends: tuple[int, ...]

    @property
    def pieces(self) -> list[tuple[int, int]]:
        """(first bit, end bit) of each piece."""
        return list(zip(self.ends[:-1], self.ends[1:], strict=True))


def cuts(bits: int, block: int, fringe: int) -> list[Cut]:
    """The ways to cut an operand for a block's signed operand: without a fringe, and with one.

    A fringe has at most `fringe` bits, and those it has spare a piece.

    Unsigned pieces have one bit less than the block takes.
    """
    ways = []
    spare = (bits - 1) % (block - 1)  # bits that would need a piece of their own
    for low in sorted({0, spare} if bits > block and spare <= fringe else {0}):
        inner = range(low + block - 1, bits - 1, block - 1)
        ways.append(Cut(low, (low, *inner, bits)))
    return ways


@dataclass(frozen=True)
class Product:
    """The plan of one exact product: blocks for the pieces' products, rows for the fringes.

    The product is the sum of `addends`, one for each block and then one for each row.

    A block's product is there 4 clocks after its operands, a row 1 clock.  One product a clock.

    Attributes:
        target: whose multiplier blocks.
        left, right: ranges of the operands.
        left_arrival, right_arrival: when their bits are there.
        fringe: most low bits of an operand that may go to rows.
    """

    target: Target
    left: Interval
    right: Interval
    left_arrival: Arrival
    right_arrival: Arrival
    fringe: int = max(FRINGES)

    @cached_property
    def _choice(self) -> tuple[bool, Cut, Cut]:
        """Whether the operands change places at the blocks, and how they are cut."""
        first, second = self.target.tile_bits
        ways = [
            (turned, a, b)
            for turned, x, y in ((False, first, second), (True, second, first))
            for a in cuts(self.left.bits, x, self.fringe)
            for b in cuts(self.right.bits, y, self.fringe)
            if a.fringe + b.fringe <= max(FRINGES)
        ]
        return min(
            ways,
            key=lambda way: (
                len(way[1].pieces) * len(way[2].pieces),
                way[1].fringe + way[2].fringe,
                way[0],
            ),
        )

    @property
    def tiles(self) -> int:
        """Multiplier blocks."""
        _, left, right = self._choice
        return len(left.pieces) * len(right.pieces)

    @property
    def rows(self) -> int:
        """Rows of AND gates."""
        _, left, right = self._choice
        return left.fringe + right.fringe

    @cached_property
    def addends(self) -> list[Addend]:
        """What the product is the sum of."""
        _, left, right = self._choice
        found = []
        for a in left.pieces:
            for b in right.pieces:
                span = _piece(self.left, *a) * _piece(self.right, *b)
                clock = self._tile_clock(a, b) + Tile.latency + 1
                found.append(Addend(span, at_once(span.bits, clock), a[0] + b[0]))
        for bit in range(left.fringe):
            arrival = self._row_arrival(self.left_arrival, bit, self.right_arrival, 0)
            found.append(Addend(self.right | ZERO_RANGE, arrival, bit))
        upper = Interval(self.left.lo >> left.fringe, self.left.hi >> left.fringe) | ZERO_RANGE
        for bit in range(right.fringe):
            arrival = self._row_arrival(self.right_arrival, bit, self.left_arrival, left.fringe)
            found.append(Addend(upper, arrival, left.fringe + bit))
        return found

    def _tile_clock(self, a: tuple[int, int], b: tuple[int, int]) -> int:
        return max(last_clock(self.left_arrival, *a), last_clock(self.right_arrival, *b))

    @staticmethod
    def _row_arrival(bits: Arrival, bit: int, others: Arrival, low: int) -> Arrival:
        there = last_clock(bits, bit, bit + 1)
        return tuple(
            (end - max(first, low), max(clock, there) + 1)
            for first, end, clock in spans(others)
            if end > low
        )

    def block_names(self, name: str) -> list[str]:
        """Names of the submodules that `build` makes for the addends that come from blocks."""
        _, left, right = self._choice
        pieces = product(range(len(left.pieces)), range(len(right.pieces)))
        return [f"{name}_tile{i}{j}" for i, j in pieces]

    def build(
        self, m: Module, name: str, left: Word, right: Word, *, primitive: bool
    ) -> list[Value]:
        """Put the blocks and rows into a module; the values of the addends."""
        turned, left_cut, right_cut = self._choice
        values: list[Value] = []
        pieces = product(left_cut.pieces, right_cut.pieces)
        for block, (a, b) in zip(self.block_names(name), pieces, strict=True):
            clock = self._tile_clock(a, b)
            first, second = _operand(left, *a, clock), _operand(right, *b, clock)
            if turned:
                first, second = second, first
            bits = self.addends[len(values)].range.bits
            tile = Tile(self.target, len(first), len(second), bits, primitive=primitive)
            m.submodules[block] = tile
            m.d.comb += [tile.left.eq(first), tile.right.eq(second)]
            # the block may stand far from the adder: the way there has a clock of its own
            behind = Signal.like(tile.output, name=f"{block}_product", reset_less=True)
            m.d.sync += behind.eq(tile.output)
            values.append(behind)
        for word, other, low, fringe in (
            (left, right, 0, left_cut.fringe),
            (right, left, left_cut.fringe, right_cut.fringe),
        ):
            for bit in range(fringe):
                addend = self.addends[len(values)]
                row: list[Value] = []
                for first, end, clock in spans(addend.arrival, low):
                    gate = word.window(bit, bit + 1, clock - 1)
                    bits, row_name = end - first, f"{name}_row{len(values)}_{first}"
                    part = Signal(bits, name=row_name, reset_less=True)
                    # not a Mux with 0: synthesis would make it a reset, one wire to all the row
                    gated = other.window(first, end, clock - 1) & gate.replicate(bits)
                    m.d.sync += part.eq(gated)
                    row.append(part)
                values.append(Cat(*row))
        return values


def _piece(operand: Interval, lo: int, hi: int) -> Interval:
    """Range of an operand's piece: the top one is signed, the others are not."""
    if hi < operand.bits:
        return Interval(0, (1 << (hi - lo)) - 1)
    return Interval(operand.lo >> lo, operand.hi >> lo) | ZERO_RANGE


def _operand(word: Word, lo: int, hi: int, clock: int) -> Value:
    """A piece as a signed operand."""
    bits = word.window(lo, hi, clock)
    return bits if hi == len(word.value) else Cat(bits, C(0, 1))
