"""The order in which many shifted signed terms are added, and when the bits of the sum are there.

`sculler_hdl.lib.adder_tree` builds what is planned here.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace

from sculler_hdl.plan.arrival import (
    Arrival,
    Limbs,
    at_once,
    by_limbs,
    first_limb_clock,
    lowest,
    width,
)
from sculler_model.design import ZERO_RANGE, Interval


@dataclass(frozen=True)
class Addend:
    """What a sum knows of a term before it is built.

    Attributes:
        range: of the integer in the term's bits, which weighs 2^low.
        arrival: when its bits are there.
        low: weight of its lowest bit.
        negative: whether it is subtracted.
        multiple: of one number that the sum's terms are multiples of, if so: the integer is
            this many times that number.
        source: what the term's bits are a copy of.  Terms of one source, in sums that are built
            with one `shared`, show the same bits, so that sums of them can be built once.  None: of
            nothing else.
    """

    range: Interval
    arrival: Arrival
    low: int = 0
    negative: bool = False
    multiple: int | None = None
    source: Hashable = None


@dataclass(frozen=True, eq=False)
class Node:
    """A term, or the sum of two nodes.

    Attributes:
        addend: what is known of it.
        ready: the clock at which limb 0 may be worked on, counted from its lowest bit.
        order: number of a term among the terms; of a sum among the sums; -1 is the number 0.
        parts: what a sum is of.
    """

    addend: Addend
    ready: int
    order: int
    parts: tuple[Node, Node] | None = None

    @property
    def bits(self) -> int:
        """Width of its word."""
        return width(self.addend.arrival)

    @property
    def subtracts(self) -> bool:
        """Whether its second part is taken from the first."""
        return len({part.addend.negative for part in self.parts or ()}) == 2

    @property
    def key(self) -> Hashable:
        """What its bits are, whatever they weigh: nodes of one key show the same bits."""
        if self.parts is None:
            source = self.addend.source
            return self.order if source is None else ("source", source), self.addend.arrival
        parts = [(part.key, part.addend.low - self.addend.low) for part in self.parts]
        return self.subtracts, self.ready, *parts


class AdderTreePlan:
    """The sum of shifted signed terms, two by two, whatever is there first added first.

    A register stands behind every addition.  Every sum is as wide as its terms demand, and never
    wider than the result: what it then drops modulo 2^width cannot matter.

    Args:
        addends: the terms.
        result: range of the sum.
        limb: how sums are cut.
        number: range of the number that terms are multiples of.

    Attributes:
        root: the last addition.
        arrival: when the bits of the sum are there; a single positive term is the sum itself.
    """

    def __init__(
        self,
        addends: Sequence[Addend],
        result: Interval,
        limb: Limbs,
        number: Interval = ZERO_RANGE,
    ) -> None:
        self.addends = list(addends)
        self.number = number
        self.result = result
        self.limb = limb
        self._sums = 0
        nodes = [
            Node(term, first_limb_clock(term.arrival, limb), i)
            for i, term in enumerate(self.addends)
            if term.low < result.bits  # the others cannot matter either
        ]
        while len(nodes) > 1:
            nodes.append(self._pair(*_next_two(nodes)))
        (root,) = nodes
        if root.addend.negative:
            zero = Addend(Interval(0, 0), at_once(1, root.ready), root.addend.low)
            root = self._pair(Node(zero, root.ready, -1), root)
        self.root = _narrowed(root, root.bits)
        self.arrival = self._widened(self.root.addend)

    @property
    def order(self) -> list[int]:
        """The terms' numbers, those next to each other that are added first."""

        def terms(node: Node) -> list[int]:
            if node.parts is None:
                return [node.order] if node.order >= 0 else []
            return [number for part in node.parts for number in terms(part)]

        return terms(self.root)

    def _pair(self, a: Node, b: Node) -> Node:
        """The sum of two nodes."""
        if a.addend.negative and not b.addend.negative:
            a, b = b, a
        low = min(a.addend.low, b.addend.low)
        x, y = (node.addend.range.scaled(1 << (node.addend.low - low)) for node in (a, b))
        subtract = a.addend.negative != b.addend.negative
        total, multiple = x - y if subtract else x + y, None
        if a.addend.multiple is not None and b.addend.multiple is not None:
            p, q = a.addend.multiple << a.addend.low - low, b.addend.multiple << b.addend.low - low
            multiple = p - q if subtract else p + q
            total = self.number.scaled(multiple)
        ready = 1 + max(
            first_limb_clock(node.addend.arrival, self.limb, node.addend.low - low)
            for node in (a, b)
        )
        arrival = by_limbs(min(total.bits, self.result.bits - low), self.limb, ready)
        self._sums += 1
        addend = Addend(total, arrival, low, a.addend.negative, multiple)
        return Node(addend, ready, self._sums, (a, b))

    def _widened(self, addend: Addend) -> Arrival:
        """The arrival of all bits of the result: zeros below and signs above are added."""
        pieces = list(addend.arrival)
        if addend.low:
            pieces.insert(0, (addend.low, pieces[0][1] - self.limb.delay(addend.low)))
        missing = self.result.bits - width(tuple(pieces))
        while missing < 0:  # a single term may be wider than the result
            bits, clock = pieces.pop()
            kept = max(bits + missing, 0)
            missing += bits - kept
            if kept:
                pieces.append((kept, clock))
        pieces[-1] = (pieces[-1][0] + missing, pieces[-1][1])
        return tuple(pieces)


def _next_two(nodes: list[Node]) -> tuple[Node, Node]:
    """Take out the two that are there first, of opposite signs and of near weights if possible."""
    nodes.sort(key=lambda node: (node.ready, node.addend.low))
    first = nodes.pop(0)
    soonest = nodes[0].ready
    second = min(
        (node for node in nodes if node.ready == soonest),
        key=lambda node: (
            node.addend.negative == first.addend.negative,
            abs(node.addend.low - first.addend.low),
        ),
    )
    nodes.remove(second)
    return first, second


def _narrowed(node: Node, bits: int) -> Node:
    """A node of which only so many bits matter: its parts need no more."""
    if node.parts is None:
        return node
    addend = replace(node.addend, arrival=lowest(node.addend.arrival, bits))
    end = addend.low + width(addend.arrival)
    a, b = (_narrowed(part, end - part.addend.low) for part in node.parts)
    return Node(addend, node.ready, node.order, (a, b))
