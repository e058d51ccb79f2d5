"""Skewed words: integers whose bits do not all arrive at the same clock.

A long addition is cut into limbs (`Limbs`): limb 0 takes the lowest bits of the sum and so on.
Every limb is worked on a clock or two after the one below it, with the carry between them in
registers; so a whole tree of additions, however deep, costs these clocks per further limb once, not
at every level.  Bits that are there early wait in registers.

    clock      0        1        2
    limb 0   a0+b0 ─▶ ab0+cd0
    limb 1            a1+b1 ─▶ ab1+cd1
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from amaranth import C, Cat, Module, Signal, Value

from sculler_model.design import ZERO_RANGE, Interval


class Limbs(NamedTuple):
    """How long additions are cut.

    Attributes:
        bits: of a limb, at most.
        clocks: from one limb to the next; with 2 the carry has a clock for its way alone.
    """

    bits: int
    clocks: int = 1


def evenly(bits: int, most: int, clocks: int = 1) -> Limbs:
    """The fewest limbs of at most so many bits that make up a word, all of one length."""
    count = -(-bits // most)
    return Limbs(-(-bits // count), clocks)


Arrival = tuple[tuple[int, int], ...]
"""(width, clock) of consecutive bits, lowest first: when the bits of a word are there."""


def at_once(bits: int, clock: int = 0) -> Arrival:
    """All bits at the same clock."""
    return ((bits, clock),)


def later(arrival: Arrival, clocks: int) -> Arrival:
    """The same bits so many clocks later."""
    return tuple((bits, clock + clocks) for bits, clock in arrival)


def lowest(arrival: Arrival, bits: int) -> Arrival:
    """Only the lowest bits."""
    return tuple((min(end, bits) - lo, clock) for lo, end, clock in spans(arrival) if lo < bits)


def spans(arrival: Arrival, low: int = 0) -> Iterator[tuple[int, int, int]]:
    """(first bit, end bit, clock) of each piece, when bit 0 of the word weighs 2^low."""
    for bits, clock in arrival:
        yield low, low + bits, clock
        low += bits


def last_clock(arrival: Arrival, lo: int = 0, hi: int | None = None) -> int:
    """The clock at which all of bits lo..hi-1 are there."""
    return max(
        clock for first, end, clock in spans(arrival) if end > lo and (hi is None or first < hi)
    )


def first_limb_clock(arrival: Arrival, limb: Limbs, low: int = 0) -> int:
    """The earliest clock at which limb 0 may be worked on, so that no later limb has to wait."""
    return max(clock - _delay(limb, first) for first, _, clock in spans(arrival, low))


def limbs(bits: int, limb: Limbs) -> Iterator[tuple[int, int, int]]:
    """(clocks after limb 0, first bit, end bit) of each limb of a word."""
    for lo in range(0, bits, limb.bits):
        yield _delay(limb, lo), lo, min(bits, lo + limb.bits)


def _delay(limb: Limbs, bit: int) -> int:
    """Clocks after limb 0 at which the limb that a bit is in is worked on."""
    return bit // limb.bits * limb.clocks


class Word:
    """A signed word inside a module: its bits and when they arrive.

    Args:
        m: the module, which gets the registers that delay bits.
        name: for those registers.
        value: the bits.
        arrival: when they are there.
        low: weight of the lowest bit, as a power of two.
    """

    def __init__(self, m: Module, name: str, value: Value, arrival: Arrival, low: int = 0) -> None:
        if len(value) != sum(bits for bits, _ in arrival):
            raise ValueError(f"{name}: {len(value)} bits do not arrive as {arrival}")
        self.m = m
        self.name = name
        self.value = value
        self.arrival = arrival
        self.low = low
        self._made: dict[tuple[int, int, int], Value] = {}

    def window(self, lo: int, hi: int, clock: int) -> Value:
        """Bits of weight 2^lo..2^(hi-1) at a clock: zeros below the word, its sign above.

        Raises:
            ValueError: a bit is not there yet.
        """
        top = self.low + len(self.value)
        parts: list[Value] = []
        if lo < min(hi, self.low):
            parts.append(C(0, min(hi, self.low) - lo))
        for first, end, arrives in spans(self.arrival, self.low):
            begin, stop = max(first, lo), min(end, hi)
            if begin < stop:
                parts.append(self._at(begin, stop, clock - arrives))
        if hi > top:
            sign = self._at(top - 1, top, clock - self.arrival[-1][1])
            parts.append(sign.replicate(hi - max(lo, top)))
        return Cat(*parts)

    def _at(self, lo: int, hi: int, clocks: int) -> Value:
        if clocks < 0:
            raise ValueError(f"{self.name}: bits {lo}..{hi - 1} come {-clocks} clocks too late")
        key = (lo, hi, clocks)
        if key not in self._made:
            if clocks == 0:
                self._made[key] = self.value[lo - self.low : hi - self.low]
            else:
                before = self._at(lo, hi, clocks - 1)
                register = Signal(hi - lo, name=f"{self.name}_later{clocks}_{lo}", reset_less=True)
                self.m.d.sync += register.eq(before)
                self._made[key] = register
        return self._made[key]


def add(
    left: Word,
    right: Word,
    name: str,
    top: int,
    clock: int,
    limb: Limbs,
    *,
    subtract: bool = False,
    carry: Value | None = None,
    step: Callable[[int], Value] | None = None,
) -> Word:
    """left + right or left - right, modulo 2^top, in registers.

    The limb that is worked on q clocks after limb 0 is there at `clock` + q + 1.

    Args:
        left, right: the operands; bits that are worked on q clocks later are there at `clock` + q.
        name: for the registers.
        top: end bit of the result; its lowest, where limb 0 starts, is the lower of the operands'.
        clock: at which limb 0 is added.
        limb: how the sum is cut.
        subtract: the difference instead.
        carry: added, or if `subtract` taken away, at the lowest bit where the operands meet.
        step: the limb of q clocks later is taken only where step(q) is 1, else kept; it starts from
            0 and is reset.
            Without it a sum is taken at every clock.
    """
    m = left.m
    low = min(left.low, right.low)
    start = right.low if subtract else max(left.low, right.low)
    lower = left if subtract or left.low <= right.low else right
    pieces: list[Value] = []
    arrival: list[tuple[int, int]] = []
    for q, first, end in limbs(top - low, limb):
        lo, hi, now = low + first, low + end, clock + q
        begin = min(max(lo, start), hi)
        bits = [lower.window(lo, begin, now)] if lo < begin else []
        more = int(begin < hi < top)  # a carry goes on
        if begin < hi:
            x, y = left.window(begin, hi, now), right.window(begin, hi, now)
            below = 0 if carry is None else 1  # a bit that makes it: 1 + carry, or 0 - carry
            if carry is not None:
                x, y = Cat(C(not subtract, 1), x), Cat(carry, y)
            total = x - y if subtract else x + y
            if below:  # linters let pass what is called unused
                total, made = Signal(total.shape(), name=f"{name}_{q}_unused_below"), total
                m.d.comb += total.eq(made)
            bits.append(total[below : below + hi - begin + more])
        piece = Signal(hi - lo + more, name=f"{name}_{q}", reset_less=step is None)
        if step is None:
            m.d.sync += piece.eq(Cat(*bits))
        else:
            with m.If(step(q)):
                m.d.sync += piece.eq(Cat(*bits))
        pieces.append(piece[: hi - lo])
        carry = piece[-1] if more else None
        for _ in range(1, limb.clocks if more else 1):
            before, carry = carry, Signal(name=f"{name}_{q}_carry", reset_less=True)
            m.d.sync += carry.eq(before)
        arrival.append((hi - lo, now + 1))
    return Word(m, name, Cat(*pieces), tuple(arrival), low)


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
    """

    range: Interval
    arrival: Arrival
    low: int = 0
    negative: bool = False
    multiple: int | None = None


@dataclass(frozen=True, eq=False)
class _Node:
    addend: Addend
    ready: int  # first_limb_clock of its bits, counted from its lowest
    order: int  # of a term among the terms; of a sum among the sums
    parts: tuple[_Node, _Node] | None = None


class Sum:
    """The sum of shifted signed terms, two by two, whatever is there first added first.

    A register stands behind every addition.  Every sum is as wide as its terms demand, and never
    wider than the result: what it then drops modulo 2^width cannot matter.

    Args:
        addends: the terms.
        result: range of the sum.
        limb: how sums are cut.
        number: range of the number that terms are multiples of.

    Attributes:
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
            _Node(term, first_limb_clock(term.arrival, limb), i)
            for i, term in enumerate(self.addends)
            if term.low < result.bits  # the others cannot matter either
        ]
        while len(nodes) > 1:
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
            nodes.append(self._pair(first, second))
        (root,) = nodes
        if root.addend.negative:
            zero = Addend(Interval(0, 0), at_once(1, root.ready), root.addend.low)
            root = self._pair(_Node(zero, root.ready, -1), root)
        self._root = root = self._narrowed(root, sum(bits for bits, _ in root.addend.arrival))
        self.arrival = self._widened(root.addend)

    def _narrowed(self, node: _Node, bits: int) -> _Node:
        """A node of which only so many bits matter: its parts need no more."""
        if node.parts is None:
            return node
        addend = replace(node.addend, arrival=lowest(node.addend.arrival, bits))
        end = addend.low + sum(width for width, _ in addend.arrival)
        a, b = (self._narrowed(part, end - part.addend.low) for part in node.parts)
        return _Node(addend, node.ready, node.order, (a, b))

    @property
    def order(self) -> list[int]:
        """The terms' numbers, those next to each other that are added first."""

        def terms(node: _Node) -> list[int]:
            if node.parts is None:
                return [node.order] if node.order >= 0 else []
            return [number for part in node.parts for number in terms(part)]

        return terms(self._root)

    def _pair(self, a: _Node, b: _Node) -> _Node:
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
        bits = min(total.bits, self.result.bits - low)
        arrival = tuple((hi - lo, ready + q) for q, lo, hi in limbs(bits, self.limb))
        self._sums += 1
        addend = Addend(total, arrival, low, a.addend.negative, multiple)
        return _Node(addend, ready, self._sums, (a, b))

    def _widened(self, addend: Addend) -> Arrival:
        """The arrival of all bits of the result: zeros below and signs above are added."""
        pieces = list(addend.arrival)
        if addend.low:
            pieces.insert(0, (addend.low, pieces[0][1] - _delay(self.limb, addend.low)))
        missing = self.result.bits - sum(bits for bits, _ in pieces)
        while missing < 0:  # a single term may be wider than the result
            bits, clock = pieces.pop()
            kept = max(bits + missing, 0)
            missing += bits - kept
            if kept:
                pieces.append((kept, clock))
        pieces[-1] = (pieces[-1][0] + missing, pieces[-1][1])
        return tuple(pieces)

    def build(
        self,
        m: Module,
        name: str,
        terms: Sequence[Value],
        shared: dict[Hashable, Word] | None = None,
    ) -> Word:
        """Put the sum into a module.

        Args:
            m: the module.
            name: for the registers.
            terms: the bits of the addends.
            shared: sums of the same terms that other sums of the module have built, to be used
                again, shifted, if they are wide enough; those built now are added.
        """
        root = self._build(m, name, self._root, terms, {} if shared is None else shared)
        parts = [
            root.window(lo, hi, clock) for lo, hi, clock in spans(self.arrival) if lo >= root.low
        ]
        zeros = [C(0, root.low)] if root.low else []
        return Word(m, name, Cat(*zeros, *parts), self.arrival)

    def _build(
        self,
        m: Module,
        name: str,
        node: _Node,
        terms: Sequence[Value],
        shared: dict[Hashable, Word],
    ) -> Word:
        addend = node.addend
        if node.parts is None:
            term = C(0, 1) if node.order < 0 else terms[node.order]
            return Word(m, f"{name}_term{node.order}", term, addend.arrival, addend.low)
        key, bits = self._key(node, terms), sum(width for width, _ in addend.arrival)
        if key not in shared or len(shared[key].value) < bits:
            left, right = (self._build(m, name, part, terms, shared) for part in node.parts)
            signs = {part.addend.negative for part in node.parts}
            shared[key] = add(
                left,
                right,
                f"{name}_sum{node.order}",
                addend.low + bits,
                node.ready - 1,
                self.limb,
                subtract=len(signs) == 2,
            )
        made = shared[key].value[:bits]
        return Word(m, f"{name}_sum{node.order}", made, addend.arrival, addend.low)

    def _key(self, node: _Node, terms: Sequence[Value]) -> Hashable:
        """What the node's bits are, whatever they weigh."""
        if node.parts is None:
            return None if node.order < 0 else id(terms[node.order]), node.addend.arrival
        subtracts = len({part.addend.negative for part in node.parts}) == 2
        parts = [(self._key(part, terms), part.addend.low - node.addend.low) for part in node.parts]
        return subtracts, node.ready, *parts


class FlagLine:
    """A flag of one bit at every clock from `clock` on, in registers.

    Synthesis makes one of registers that are equal, and places far apart then share the wires of
    a single line; lines of one flag that differ in how they hold it stay apart.

    Args:
        m: the module.
        name: for the registers.
        value: the flag.
        clock: at which it is there.
        inverted: whether the registers hold its opposite.
        cleared: whether reset clears them.
    """

    def __init__(
        self,
        m: Module,
        name: str,
        value: Value,
        clock: int = 0,
        *,
        inverted: bool = False,
        cleared: bool = True,
    ) -> None:
        self.m = m
        self.name = name
        self.clock = clock
        self.inverted = inverted
        self.cleared = cleared
        self._taps: list[Value] = [~value if inverted else value]

    def at(self, clock: int) -> Value:
        """The flag at a clock.

        Raises:
            ValueError: a clock before the flag is there.
        """
        if clock < self.clock:
            raise ValueError(f"{self.name}: is there at clock {self.clock}, not at {clock}")
        while len(self._taps) <= clock - self.clock:
            tap = Signal(
                name=f"{self.name}_{self.clock + len(self._taps)}",
                init=int(self.inverted),
                reset_less=not self.cleared,
            )
            self.m.d.sync += tap.eq(self._taps[-1])
            self._taps.append(tap)
        held = self._taps[clock - self.clock]
        return ~held if self.inverted else held
