"""The algorithm as blocks of instructions: what a sample of each phase asks for."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from sculler_hdl.plan.compact.higher_order import HigherOrderCompiler
from sculler_hdl.plan.compact.instructions import (
    Base,
    Block,
    Instruction,
    MemoryWord,
    Number,
    ProductTerm,
    Store,
    When,
    digits_reached,
)
from sculler_hdl.plan.compact.memory_map import MemoryMap
from sculler_hdl.plan.compact.scrolling import (
    C_0,
    C_1,
    C_ALPHA,
    D_1,
    D_NU,
    FIRST_WEIGHT,
    LEFT_WEIGHTED,
    S_WEIGHT,
    W,
    Weight,
)
from sculler_model.design import AXES, STATUS_FAULT, STATUS_SHORT_HISTORY, ZERO_RANGE, Design


class Compiler:
    """Writes the blocks of each phase.

    Args:
        design: the design.
        memory: where its numbers stand; constants that instructions need are added.
    """

    def __init__(self, design: Design, memory: MemoryMap) -> None:
        self.design = design
        self.map = memory
        self._higher = HigherOrderCompiler(self) if design.order > 2 else None

    def phase(self, k: int) -> list[Block]:
        """What a sample of phase k asks for, one number after another."""
        table, minors = self.design.table, self.design.algorithm.minors
        active = table.active_phases
        blocks: list[Block] = []
        if self.design.high_resolution:
            blocks += self._position(k)
        if k in active:
            restart = When.CONTINUED if k == active[0] else When.ALWAYS
            row = list(enumerate(table.taps[k - 1], start=1))
            blocks += self.weighted_sums(self.map.A, "s", row)
            blocks += self.weighted_sums(self.map.B, "r", row)
            if self._higher is not None:
                blocks += self._higher.within_products(first=k == active[0])
            else:
                blocks += self._within(restart)
        if k == table.samples and active and k not in active and self.design.channels > 1:
            blocks += self._shown_again()
        if k == table.samples:
            weights = list(enumerate(table.weights))
            blocks += self.weighted_sums(self.map.theta, "s", weights)
            blocks += self.weighted_sums(self.map.v, "r", weights)
            alpha, nu = self.map.accumulator("alpha"), self.map.accumulator("nu")
            if self._higher is not None:
                blocks += self._higher.minor_end()
            elif minors > 1:
                # all the same with theta and v in alpha and nu already: theta x v + v x theta = 0
                between = [(alpha, self.map.theta)]
                blocks += self.crosses("coning_between", When.CONTINUED, between, When.CONTINUED)
                between = [(alpha, self.map.v), (nu, self.map.theta)]
                blocks += self.crosses("sculling_between", When.CONTINUED, between, When.CONTINUED)
            if not self.design.high_resolution:
                blocks += self.increments(alpha, self.map.theta, When.CONTINUED)
                blocks += self.increments(nu, self.map.v, When.CONTINUED)
            blocks += [self._major(), self._status()]
        return blocks

    def _within(self, restart: When) -> Iterator[Block]:
        """The products within of a sample."""
        s, r = self.map.samples("s", 0), self.map.samples("r", 0)
        yield from self.crosses("coning_within", restart, [(self.map.A, s)])
        yield from self.crosses("sculling_within", restart, [(self.map.A, r), (self.map.B, s)])

    def _shown_again(self) -> Iterator[Block]:
        """The products within as they are, for the result: another channel's stood there since."""
        for vector in ("coning_within", "sculling_within"):
            for state in self.map.accumulator(vector):
                yield self.accumulated(state, [], When.ALWAYS)

    def _position(self, k: int) -> Iterator[Block]:
        """High-resolution position as `position` has it; alpha and nu take each sample at once."""
        s, r, s_1, r_1 = (self.map.samples(sensor, d) for d in (0, 1) for sensor in "sr")
        alpha, nu, s_alpha, s_nu = map(self.map.accumulator, ("alpha", "nu", "s_alpha", "s_nu"))
        first, last = k == 1, k == self.design.algorithm.samples
        running = When.CONTINUED if first else When.ALWAYS

        def beginning(factor: int, sample: Number) -> list[ProductTerm]:
            """What there is besides in the interval's first sample."""
            return (
                [ProductTerm(self.map.coefficient(factor), sample, when=When.FIRST_MINOR)]
                if first
                else []
            )

        for weight in self.map.weight:
            yield self._count_down(weight, k)
        for axis in range(3):
            terms = [
                ProductTerm(alpha[axis], self.map.weight[C_ALPHA], when=running),
                ProductTerm(self.map.weight[C_1], s_1[axis]),
                ProductTerm(self.map.weight[C_0], s[axis]),
                ProductTerm(s_alpha[axis], self.map.factor[-S_WEIGHT], when=running),
                *beginning(-S_WEIGHT, s_1[axis]),
            ]
            yield self.sum_of(self.map.C[axis], terms)
        for axis in range(3):
            terms = [
                ProductTerm(nu[axis], self.map.weight[D_NU], when=running),
                ProductTerm(self.map.weight[D_1], r_1[axis]),
                ProductTerm(s_nu[axis], self.map.factor[S_WEIGHT], when=running),
                *beginning(S_WEIGHT, r_1[axis]),
            ]
            yield self.sum_of(self.map.D[axis], terms)
        products = [(self.map.C, r), (self.map.D, s)]
        if first:
            for axis in range(3):
                yield self.sum_of(self.map.E[axis], beginning(FIRST_WEIGHT, s_1[axis]))
            products.append((self.map.E, r_1))
        for doubly, newest, before in ((s_alpha, s, s_1), (s_nu, r, r_1)):
            for axis in range(3):
                terms = [ProductTerm(self.map.weight[W], newest[axis]), *beginning(1, before[axis])]
                yield self.accumulated(doubly[axis], terms, running, shown=last)
        yield from self.increments(alpha, s, running, shown=last)
        yield from self.increments(nu, r, running, shown=last)
        yield from self.crosses("scrolling", running, products, shown=last)

    def _count_down(self, weight: Weight, k: int) -> Block:
        """A weight of high-resolution position, in the interval's first sample from its start."""
        number = self.map.weight[weight]
        running = When.CONTINUED if k == 1 else When.ALWAYS
        before = ProductTerm(number, self.map.unity, when=running)
        if weight in LEFT_WEIGHTED:
            before = ProductTerm(self.map.coefficient(1), number, when=running)
        terms = [
            before,
            ProductTerm(self.map.coefficient(-weight.step), self.map.unity, when=running),
        ]
        if k == 1:
            start = self.map.coefficient(weight.at(self.design.samples_per_major - 1))
            terms.append(ProductTerm(start, self.map.unity, when=When.FIRST_MINOR))
        if k == self.design.algorithm.samples and weight.last:
            terms.append(
                ProductTerm(self.map.coefficient(weight.last), self.map.unity, when=When.MAJOR_END)
            )
        return self.sum_of(number, terms)

    def increments(
        self, sums: list[Number], increments: list[Number], restart: When, shown: bool = True
    ) -> Iterator[Block]:
        """sums += increments."""
        for total, increment in zip(sums, increments, strict=True):
            add = ProductTerm(self.map.coefficient(1), increment)
            yield self.accumulated(total, [add], restart, shown)

    def weighted_sums(
        self, sums: list[Number], sensor: str, coefficients: Iterable[tuple[int, int]]
    ) -> Iterator[Block]:
        """A, B, theta or v: coefficients (distance, c) times samples."""
        terms = [(self.map.coefficient(c), d) for d, c in coefficients if c]
        for axis, total in enumerate(sums):
            yield self.sum_of(
                total, [ProductTerm(c, self.map.sample(sensor, axis, d)) for c, d in terms]
            )

    def sum_of(self, total: Number, terms: list[ProductTerm]) -> Block:
        """total = terms."""
        stores = [
            Store(place.address, frozenset([place.memory]), signed=place is total.places[-1])
            for place in total.places
            if isinstance(place, MemoryWord)
        ]
        return self._block(total.name, terms, stores)

    def crosses(
        self,
        vector: str,
        restart: When,
        products: Sequence[tuple[list[Number], list[Number]]],
        when: When = When.ALWAYS,
        shown: bool = True,
    ) -> Iterator[Block]:
        """vector += sum of left x right, whose left is 0 unless `when`."""
        for axis, name in enumerate(AXES):
            y, z = (axis + 1) % 3, (axis + 2) % 3
            terms = []
            for left, right in products:
                terms.append(ProductTerm(left[y], right[z], when=when))
                terms.append(ProductTerm(left[z], right[y], subtract=True, when=when))
            yield self.accumulated(self.map.state[f"{vector}_{name}"], terms, restart, shown)

    def accumulated(
        self, state: Number, terms: list[ProductTerm], restart: When, shown: bool = True
    ) -> Block:
        """state += terms; if it is `shown`, with as many words as a column of the result has."""
        terms = [ProductTerm(state, self.map.unity, when=restart), *terms]
        if digits_reached(terms) > len(state.places):
            raise AssertionError(f"{state.name}: its digits do not hold what is added")
        if not shown:
            return self.sum_of(state, terms)
        first = self.map.first_word(state.name)
        stores = []
        for i in range(self.map.words_per_column):
            memories = {"left", "result"} if i < len(state.places) else {"result"}
            signed = i == len(state.places) - 1 and state.name != "major"
            stores.append(Store(first + i, frozenset(memories), signed))
        return self._block(state.name, terms, stores)

    def _major(self) -> Block:
        """The number of the major interval: one more in each but the first since reset."""
        count = ProductTerm(self.map.coefficient(1), self.map.unity, when=When.NEXT_MAJOR)
        return self.accumulated(self.map.state["major"], [count], When.LATER_MAJOR)

    def _status(self) -> Block:
        bits = {STATUS_FAULT: When.FAULT}
        if self.design.short_majors:
            bits[STATUS_SHORT_HISTORY] = When.SHORT
        address = self.map.first_word("status")
        return self._block(
            "status",
            [
                ProductTerm(self.map.coefficient(bit), self.map.unity, when=when)
                for bit, when in bits.items()
            ],
            [Store(address, frozenset(["result"]), signed=False)],
        )

    def _block(self, name: str, terms: list[ProductTerm], stores: Sequence[Store]) -> Block:
        """Column by column, as in the module's docstring; column c ends with stores[c]."""
        nothing = self.map.number("0", [self.map.zero], [ZERO_RANGE])
        if digits_reached(terms) > len(stores):
            raise AssertionError(f"{name}: {len(stores)} digits do not hold its products")
        block: list[Instruction] = []
        for column, store in enumerate(stores):
            products = [
                (term, i, column - i)
                for term in terms
                for i in range(len(term.left.places))
                if 0 <= column - i < len(term.right.places)
            ] or [(ProductTerm(nothing, self.map.unity), 0, 0)]
            products.sort(key=lambda product: product[0].subtract)  # as Instruction asks
            base = Base.SHIFT if column else Base.CLEAR
            for term, i, j in products:
                left, right = term.left.places[i], term.right.places[j]
                assert isinstance(left, MemoryWord)
                sign = "-" if term.subtract else "+"
                start = {
                    Base.CLEAR: "= -" if term.subtract else "=",
                    Base.KEEP: f"{sign}=",
                    Base.SHIFT: f"= carry {sign}",
                }[base]
                text = f"{name}.{column} {start} {_digit(term.left, i)} * {_digit(term.right, j)}"
                block.append(Instruction(left, right, base, term.subtract, term.when, text=text))
                base = Base.KEEP
            block[-1] = replace(block[-1], store=store)
        return tuple(block)


def _digit(number: Number, i: int) -> str:
    return number.name if len(number.places) == 1 else f"{number.name}.{i}"
