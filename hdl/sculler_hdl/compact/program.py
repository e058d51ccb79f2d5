"""The schedule compiler: DESIGN section 3 as a list of digit products, fixed once and for all.

Every number is a string of digits of 16 bits, least significant first: unsigned but for the top
one, which is signed and has up to 18 bits.  So one signed 18 x 18 multiplier forms every product.
A sum of products is formed column by column (product scanning, Comba 1990): all digit products
of weight 2^(16 c) are added up in the accumulator, whose low digit then is digit c of the sum; the
rest, shifted down one digit, is where column c + 1 begins.  One instruction is

    accumulator = (0 | accumulator | accumulator >> 16) +- left * right
    optionally: store the accumulator's low digit

An accumulated vector adds to itself: `state * 1` is one more product, and 0 takes the state's
place where a major interval begins, so nothing needs clearing.

Nothing relies on what a memory holds at first: what no instruction writes before it counts, such as
constants and words of a result that are always 0, is written after each reset (`Program.startup`).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum, IntEnum
from functools import lru_cache, reduce

from sculler_hdl.compact.pipeline import pipeline
from sculler_hdl.compact.position import (
    C_0,
    C_1,
    C_ALPHA,
    D_1,
    D_NU,
    FIRST_WEIGHT,
    LEFT_WEIGHTED,
    S_WEIGHT,
    WEIGHTS,
    W,
    Weight,
    factor_ranges,
)
from sculler_model.design import (
    AXES,
    STATUS_FAULT,
    STATUS_SHORT_HISTORY,
    ZERO_RANGE,
    Design,
    Interval,
)
from sculler_model.golden import WORD_BITS, words_per_column, words_per_result

DIGIT = Interval(0, (1 << WORD_BITS) - 1)
"""Range of a digit that is not the top one."""

OPERAND = Interval.signed(18)
"""Range of any digit."""


class Base(Enum):
    """What a product is added to."""

    CLEAR = "0"
    KEEP = "accumulator"
    SHIFT = "accumulator >> 16"


class When(IntEnum):
    """When the left operand counts; else 0 takes its place."""

    ALWAYS = 0
    CONTINUED = 1
    LATER_MAJOR = 2
    NEXT_MAJOR = 3
    FAULT = 4
    SHORT = 5
    FIRST_MINOR = 6
    MAJOR_END = 7

    @property
    def meaning(self) -> str:
        """In words, for the listing."""
        return (
            "always",
            "not in the major interval's first minor interval",
            "not in the first major interval",
            "in the first minor interval of a later major interval",
            "if a sample of the major interval had fault",
            "if a tap or weight reached before the first sample",
            "in the major interval's first minor interval",
            "in the major interval's last sample",
        )[self]


@dataclass(frozen=True)
class Word:
    """A word of the left or of the right memory."""

    memory: str
    address: int


@dataclass(frozen=True)
class SampleWord:
    """A digit of the sample `distance` samples back: number `index` among the sample's digits."""

    distance: int
    index: int


@dataclass(frozen=True)
class Number:
    """A number's name, and where its digits stand with their ranges, least significant first."""

    name: str
    places: tuple[Word | SampleWord, ...]
    ranges: tuple[Interval, ...]


@dataclass(frozen=True)
class Term:
    """+- left * right, `left` being 0 unless `when`."""

    left: Number
    right: Number
    subtract: bool = False
    when: When = When.ALWAYS


@dataclass(frozen=True)
class Store:
    """Write the accumulator's low digit.

    Attributes:
        address: in each of the memories.
        memories: of "left", "right", "result".
        signed: it is a number's top digit, 18 bits instead of 16.
    """

    address: int
    memories: frozenset[str]
    signed: bool


@dataclass(frozen=True)
class Instruction:
    """One product, as in the module's docstring; `text` says it with names.

    The first of a column, whose base is SHIFT, never subtracts: the engine relies on it.
    """

    left: Word
    right: Word | SampleWord
    base: Base
    subtract: bool = False
    when: When = When.ALWAYS
    store: Store | None = None
    text: str = ""

    @property
    def reads(self) -> tuple[Word, ...]:
        """The words it reads, samples apart."""
        return (self.left, self.right) if isinstance(self.right, Word) else (self.left,)

    @property
    def writes(self) -> tuple[Word, ...]:
        """The words it writes that instructions can read."""
        if self.store is None:
            return ()
        return tuple(
            Word(m, self.store.address) for m in ("left", "right") if m in self.store.memories
        )


Block = tuple[Instruction, ...]
"""The instructions that form one number, which stay together."""


@dataclass
class Memory:
    """What stands where in a memory: names by address, and those that are constant."""

    name: str
    names: list[str] = field(default_factory=list)
    constants: dict[int, int] = field(default_factory=dict)

    def place(self, name: str, value: int | None = None) -> Word:
        """The next free word; constant if it has a value."""
        self.names.append(name)
        address = len(self.names) - 1
        if value is not None:
            self.constants[address] = value
        return Word(self.name, address)


@dataclass(frozen=True)
class Load:
    """A word that is written after each reset.

    Attributes:
        memory: "left", "right" or "result".
        address, value: in it.
        bank: of the result memory; 0 is the one that is being filled.
    """

    memory: str
    address: int
    value: int
    bank: int = 0


@dataclass(frozen=True)
class Program:
    """A design's schedule.

    Attributes:
        design: the design.
        left, right: the memories of left and right operands.
        startup: what is written after each reset, before the first sample.
        phases: the instructions for a sample of phase k, for the phases that have work.
        idle: 0 * 1, which stores nothing.
        accumulator: range of the accumulator, that of a product at least, and with a carry out of
            the low digit to spare, which the engine adds late.
    """

    design: Design
    left: Memory
    right: Memory
    startup: tuple[Load, ...]
    phases: Mapping[int, tuple[Instruction, ...]]
    idle: Instruction
    accumulator: Interval

    @property
    def constant_bits(self) -> int:
        """Bits, the sign's included, of what start-up writes."""
        return reduce(
            Interval.__or__, (Interval(load.value, load.value) for load in self.startup)
        ).bits


def digit_count(bits: int) -> int:
    """Digits of a number of so many bits: 16 each, the top one up to 18."""
    return max(1, 1 - (OPERAND.bits - bits) // WORD_BITS)


def digit_ranges(number: Interval, least: int = 1) -> list[Interval]:
    """Range of each digit of a number, least significant first, `least` digits or more."""
    count = max(least, digit_count(number.bits))
    shift = WORD_BITS * (count - 1)
    return [DIGIT] * (count - 1) + [Interval(number.lo >> shift, number.hi >> shift)]


def digits_per_count(design: Design) -> int:
    """Digits that each of a sample's six counts takes in the sample memory."""
    return digit_count(max(design.words.gyro.bits, design.words.accel.bits))


def sample_words(design: Design) -> int:
    """Words of one sample in the sample memory."""
    return 2 * len(AXES) * digits_per_count(design)


def kept_samples(design: Design) -> int:
    """Samples in the sample memory, a power of two.

    While a phase's program runs, which reaches `history` back, up to n newer ones come in.
    """
    least = design.table.history + 1 + design.algorithm.samples
    return 1 << (least - 1).bit_length()


def result_banks(design: Design) -> int:
    """Results in the result memory: one shown, one filled; where results are dropped one waits."""
    return 3 if design.drops_results else 2


def short_majors(design: Design) -> int:
    """How many major intervals from reset have a tap or weight that reaches before sample 0.

    A phase that reaches far enough back in some interval does so in every earlier one.
    High-resolution position reaches one sample back.
    """
    table, count = design.table, int(design.high_resolution)
    for t in range(table.history):
        k = t % table.samples + 1
        used = [d for d, c in enumerate(table.taps[k - 1], start=1) if c]
        if k == table.samples:
            used += [d for d, w in enumerate(table.weights) if w]
        if max(used, default=0) > t:
            count = t // design.samples_per_major + 1
    return count


class _Compiler:
    """Places a design's numbers in memory and writes the blocks of each phase."""

    def __init__(self, design: Design) -> None:
        self.design = design
        self.words_per_column = words_per_column(design)
        self.left, self.right = Memory("left"), Memory("right")
        self.ranges: dict[Word | SampleWord, Interval] = {}
        # the results stand first, as they are streamed out
        for column in design.columns:
            for word in range(self.words_per_column):
                self.left.place(f"{column}.{word}")
        self.constants: dict[int, Word] = {}
        self.zero = self._constant(0)
        self.one = self.right.place("1", 1)
        self.unity = self._number("1", [self.one], [Interval(1, 1)])

        words = design.words
        self.A = self._vector("A", words.gyro_taps, self.left)
        self.B = self._vector("B", words.accel_taps, self.left)
        self.theta = self._vector("theta", words.theta, self.right)
        self.v = self._vector("v", words.v, self.right)
        self.state = {c: self._state(c) for c in design.columns if c != "status"}
        if design.high_resolution:
            samples = design.samples_per_major
            self.E = self._vector("E", words.gyro.scaled(FIRST_WEIGHT), self.left)
            self.weight = {
                weight: self._placed(
                    weight.name,
                    weight.range(samples),
                    self.right if weight in LEFT_WEIGHTED else self.left,
                )
                for weight in WEIGHTS
            }
            self.factor = {
                value: self._number(
                    str(value), [self.right.place(str(value), value)], [Interval(value, value)]
                )
                for value in (S_WEIGHT, -S_WEIGHT)
            }
            c, d = factor_ranges(words.gyro, words.accel, samples)
            self.C = self._factor("C", c, self.weight[C_ALPHA], self.state["alpha_x"])
            self.D = self._factor("D", d, self.weight[D_NU], self.state["nu_x"])

    # where numbers stand

    def _number(
        self, name: str, places: Iterable[Word | SampleWord], ranges: Sequence[Interval]
    ) -> Number:
        number = Number(name, tuple(places), tuple(ranges))
        self.ranges |= zip(number.places, number.ranges, strict=True)
        return number

    def _constant(self, value: int) -> Word:
        if value not in self.constants:
            self.constants[value] = self.left.place(str(value), value)
        return self.constants[value]

    def _coefficient(self, value: int) -> Number:
        """A tap or weight as a constant."""
        digits = [value >> WORD_BITS * i for i in range(len(digit_ranges(Interval(value, value))))]
        digits[:-1] = [digit & DIGIT.hi for digit in digits[:-1]]
        places = [self._constant(digit) for digit in digits]
        return self._number(str(value), places, [Interval(digit, digit) for digit in digits])

    def _placed(self, name: str, number: Interval, memory: Memory, least: int = 1) -> Number:
        ranges = digit_ranges(number, least)
        places = [memory.place(f"{name}.{i}") for i in range(len(ranges))]
        return self._number(name, places, ranges)

    def _factor(
        self, name: str, components: Interval, weight: Number, number: Number
    ) -> list[Number]:
        """C or D, with the digits that weight * number, one of its terms, reaches."""
        digits = len(weight.places) + len(number.places) - 1
        return [self._placed(f"{name}_{axis}", components, self.left, digits) for axis in AXES]

    def _vector(self, name: str, components: Interval, memory: Memory) -> list[Number]:
        return [self._placed(f"{name}_{axis}", components, memory) for axis in AXES]

    def _state(self, column: str) -> Number:
        """An accumulated component, or the number of the major interval."""
        first = self._first_word(column)
        if column == "major":  # counts modulo 2^(16 K)
            ranges = [DIGIT] * self.words_per_column
        else:
            ranges = digit_ranges(getattr(self.design.words, column[:-2]))
        places = [Word("left", first + i) for i in range(len(ranges))]
        return self._number(column, places, ranges)

    def _first_word(self, column: str) -> int:
        return self.design.columns.index(column) * self.words_per_column

    def _accumulator(self, vector: str) -> list[Number]:
        return [self.state[f"{vector}_{axis}"] for axis in AXES]

    def _sample(self, sensor: str, axis: int, distance: int) -> Number:
        """A count of the sample `distance` samples back; s is the gyro, r the accelerometer."""
        words = self.design.words
        counts, first = (words.gyro, 0) if sensor == "s" else (words.accel, len(AXES))
        start = (first + axis) * digits_per_count(self.design)
        back = f"t-{distance}" if distance else "t"
        ranges = digit_ranges(counts)
        places = [SampleWord(distance, start + i) for i in range(len(ranges))]
        return self._number(f"{sensor}_{AXES[axis]}[{back}]", places, ranges)

    def _samples(self, sensor: str, distance: int) -> list[Number]:
        return [self._sample(sensor, axis, distance) for axis in range(3)]

    # the algorithm

    def phase(self, k: int) -> list[Block]:
        """What a sample of phase k asks for, in the order of DESIGN section 3."""
        table, minors = self.design.table, self.design.algorithm.minors
        active = table.active_phases
        s, r = self._samples("s", 0), self._samples("r", 0)
        blocks: list[Block] = []
        if self.design.high_resolution:
            blocks += self._position(k)
        if k in active:
            restart = When.CONTINUED if k == active[0] else When.ALWAYS
            row = list(enumerate(table.taps[k - 1], start=1))
            blocks += self._weighted_sums(self.A, "s", row)
            blocks += self._weighted_sums(self.B, "r", row)
            blocks += self._crosses("coning_within", restart, [(self.A, s)])
            blocks += self._crosses("sculling_within", restart, [(self.A, r), (self.B, s)])
        if k == table.samples:
            weights = list(enumerate(table.weights))
            blocks += self._weighted_sums(self.theta, "s", weights)
            blocks += self._weighted_sums(self.v, "r", weights)
            alpha, nu = self._accumulator("alpha"), self._accumulator("nu")
            if minors > 1:
                # all the same with theta and v in alpha and nu already: theta x v + v x theta = 0
                between = [(alpha, self.theta)]
                blocks += self._crosses("coning_between", When.CONTINUED, between, When.CONTINUED)
                between = [(alpha, self.v), (nu, self.theta)]
                blocks += self._crosses("sculling_between", When.CONTINUED, between, When.CONTINUED)
            if not self.design.high_resolution:
                blocks += self._increments(alpha, self.theta, When.CONTINUED)
                blocks += self._increments(nu, self.v, When.CONTINUED)
            blocks += [self._major(), self._status()]
        return blocks

    def _position(self, k: int) -> Iterator[Block]:
        """High-resolution position as `position` has it; alpha and nu take each sample at once."""
        s, r, s_1, r_1 = (self._samples(sensor, d) for d in (0, 1) for sensor in "sr")
        alpha, nu, s_alpha, s_nu = map(self._accumulator, ("alpha", "nu", "s_alpha", "s_nu"))
        first, last = k == 1, k == self.design.algorithm.samples
        running = When.CONTINUED if first else When.ALWAYS

        def beginning(factor: int, sample: Number) -> list[Term]:
            """What there is besides in the interval's first sample."""
            return [Term(self._coefficient(factor), sample, when=When.FIRST_MINOR)] if first else []

        for weight in self.weight:
            yield self._count_down(weight, k)
        for axis in range(3):
            terms = [
                Term(alpha[axis], self.weight[C_ALPHA], when=running),
                Term(self.weight[C_1], s_1[axis]),
                Term(self.weight[C_0], s[axis]),
                Term(s_alpha[axis], self.factor[-S_WEIGHT], when=running),
                *beginning(-S_WEIGHT, s_1[axis]),
            ]
            yield self._sum(self.C[axis], terms)
        for axis in range(3):
            terms = [
                Term(nu[axis], self.weight[D_NU], when=running),
                Term(self.weight[D_1], r_1[axis]),
                Term(s_nu[axis], self.factor[S_WEIGHT], when=running),
                *beginning(S_WEIGHT, r_1[axis]),
            ]
            yield self._sum(self.D[axis], terms)
        products = [(self.C, r), (self.D, s)]
        if first:
            for axis in range(3):
                yield self._sum(self.E[axis], beginning(FIRST_WEIGHT, s_1[axis]))
            products.append((self.E, r_1))
        for doubly, newest, before in ((s_alpha, s, s_1), (s_nu, r, r_1)):
            for axis in range(3):
                terms = [Term(self.weight[W], newest[axis]), *beginning(1, before[axis])]
                yield self._accumulated(doubly[axis], terms, running, shown=last)
        yield from self._increments(alpha, s, running, shown=last)
        yield from self._increments(nu, r, running, shown=last)
        yield from self._crosses("scrolling", running, products, shown=last)

    def _count_down(self, weight: Weight, k: int) -> Block:
        """A weight of high-resolution position, in the interval's first sample from its start."""
        number = self.weight[weight]
        running = When.CONTINUED if k == 1 else When.ALWAYS
        before = Term(number, self.unity, when=running)
        if weight in LEFT_WEIGHTED:
            before = Term(self._coefficient(1), number, when=running)
        terms = [before, Term(self._coefficient(-weight.step), self.unity, when=running)]
        if k == 1:
            start = self._coefficient(weight.at(self.design.samples_per_major - 1))
            terms.append(Term(start, self.unity, when=When.FIRST_MINOR))
        if k == self.design.algorithm.samples and weight.last:
            terms.append(Term(self._coefficient(weight.last), self.unity, when=When.MAJOR_END))
        return self._sum(number, terms)

    def _increments(
        self, sums: list[Number], increments: list[Number], restart: When, shown: bool = True
    ) -> Iterator[Block]:
        """sums += increments."""
        for total, increment in zip(sums, increments, strict=True):
            add = Term(self._coefficient(1), increment)
            yield self._accumulated(total, [add], restart, shown)

    def _weighted_sums(
        self, sums: list[Number], sensor: str, coefficients: Iterable[tuple[int, int]]
    ) -> Iterator[Block]:
        """A, B, theta or v: coefficients (distance, c) times samples."""
        terms = [(self._coefficient(c), d) for d, c in coefficients if c]
        for axis, total in enumerate(sums):
            yield self._sum(total, [Term(c, self._sample(sensor, axis, d)) for c, d in terms])

    def _sum(self, total: Number, terms: list[Term]) -> Block:
        """total = terms."""
        stores = [
            Store(place.address, frozenset([place.memory]), signed=place is total.places[-1])
            for place in total.places
            if isinstance(place, Word)
        ]
        return self._block(total.name, terms, stores)

    def _crosses(
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
                terms.append(Term(left[y], right[z], when=when))
                terms.append(Term(left[z], right[y], subtract=True, when=when))
            yield self._accumulated(self.state[f"{vector}_{name}"], terms, restart, shown)

    def _accumulated(
        self, state: Number, terms: list[Term], restart: When, shown: bool = True
    ) -> Block:
        """state += terms; if it is `shown`, with as many words as a column of the result has."""
        terms = [Term(state, self.unity, when=restart), *terms]
        if not shown:
            return self._sum(state, terms)
        first = self._first_word(state.name)
        stores = []
        for i in range(self.words_per_column):
            memories = {"left", "result"} if i < len(state.places) else {"result"}
            signed = i == len(state.places) - 1 and state.name != "major"
            stores.append(Store(first + i, frozenset(memories), signed))
        return self._block(state.name, terms, stores)

    def _major(self) -> Block:
        """The number of the major interval: one more in each but the first since reset."""
        count = Term(self._coefficient(1), self.unity, when=When.NEXT_MAJOR)
        return self._accumulated(self.state["major"], [count], When.LATER_MAJOR)

    def _status(self) -> Block:
        bits = {STATUS_FAULT: When.FAULT}
        if short_majors(self.design):
            bits[STATUS_SHORT_HISTORY] = When.SHORT
        address = self._first_word("status")
        return self._block(
            "status",
            [Term(self._coefficient(bit), self.unity, when=when) for bit, when in bits.items()],
            [Store(address, frozenset(["result"]), signed=False)],
        )

    def _block(self, name: str, terms: list[Term], stores: Sequence[Store]) -> Block:
        """Column by column, as in the module's docstring; column c ends with stores[c]."""
        nothing = self._number("0", [self.zero], [ZERO_RANGE])
        highest = max(len(term.left.places) + len(term.right.places) - 2 for term in terms)
        if highest >= len(stores):
            raise AssertionError(f"{name}: {len(stores)} digits do not hold its products")
        block: list[Instruction] = []
        for column, store in enumerate(stores):
            products = [
                (term, i, column - i)
                for term in terms
                for i in range(len(term.left.places))
                if 0 <= column - i < len(term.right.places)
            ] or [(Term(nothing, self.unity), 0, 0)]
            products.sort(key=lambda product: product[0].subtract)  # as Instruction asks
            base = Base.SHIFT if column else Base.CLEAR
            for term, i, j in products:
                left, right = term.left.places[i], term.right.places[j]
                assert isinstance(left, Word)
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


def schedule(blocks: Sequence[Block], delay: int, idle: Instruction) -> tuple[Instruction, ...]:
    """Blocks one after another such that none reads a word less than `delay` after its store.

    A block may overtake an earlier one unless it reads what that writes or writes what that reads.
    Where no block can begin at once, `idle` instructions wait for the one that can soonest.
    """
    order: list[Instruction] = []
    stored: dict[Word, int] = {}  # when each word was last written
    behind = _precedence(blocks)
    waiting = list(range(len(blocks)))
    while waiting:
        stalls = {
            i: max(0, *(stored.get(word, -delay) + delay - len(order) - at for at, word in reads))
            for i in waiting
            if behind[i].isdisjoint(waiting)
            for reads in [[(at, word) for at, one in enumerate(blocks[i]) for word in one.reads]]
        }
        best = min(stalls, key=lambda i: (stalls[i], i))
        waiting.remove(best)
        order += [idle] * stalls[best]
        for instruction in blocks[best]:
            stored |= dict.fromkeys(instruction.writes, len(order))
            order.append(instruction)
    return tuple(order)


def _precedence(blocks: Sequence[Block]) -> list[set[int]]:
    """For each block, the numbers of the earlier ones that it must stay behind."""
    reads = [{word for instruction in block for word in instruction.reads} for block in blocks]
    writes = [{word for instruction in block for word in instruction.writes} for block in blocks]
    return [
        {
            earlier
            for earlier in range(later)
            if writes[earlier] & (reads[later] | writes[later]) or reads[earlier] & writes[later]
        }
        for later in range(len(blocks))
    ]


def accumulator_range(
    instructions: Iterable[Instruction], ranges: Mapping[Word | SampleWord, Interval]
) -> Interval:
    """What the accumulator can hold, by interval arithmetic over every digit's range."""
    now = widest = ZERO_RANGE
    for instruction in instructions:
        product = ranges[instruction.left] * ranges[instruction.right]
        if instruction.when is not When.ALWAYS:
            product |= ZERO_RANGE
        if instruction.base is Base.CLEAR:
            now = ZERO_RANGE
        elif instruction.base is Base.SHIFT:
            now = Interval(now.lo >> WORD_BITS, now.hi >> WORD_BITS)
        now += -product if instruction.subtract else product
        widest |= now
    return widest


def _startup(
    design: Design, memories: Iterable[Memory], instructions: Sequence[Instruction]
) -> Iterator[Load]:
    """What no instruction writes before it counts.

    The constants; 0 in right words that are first multiplied by 0, which would do without, were it
    not that simulators take 0 times unknown for unknown; and 0 in those words of all banks of
    results that no instruction writes.

    Args:
        design: the design.
        memories: of its operands.
        instructions: of all phases, in their order.
    """
    for memory in memories:
        for address, value in memory.constants.items():
            yield Load(memory.name, address, value)
    known = {Word(memory.name, address) for memory in memories for address in memory.constants}
    for instruction in instructions:
        right = instruction.right
        if isinstance(right, Word) and right not in known:
            known.add(right)
            yield Load(right.memory, right.address, 0)
        known.update(instruction.writes)
    results = {
        instruction.store.address
        for instruction in instructions
        if instruction.store is not None and "result" in instruction.store.memories
    }
    for address in range(words_per_result(design)):
        if address not in results:
            for bank in range(result_banks(design)):
                yield Load("result", address, 0, bank)


@lru_cache(maxsize=32)
def program(design: Design) -> Program:
    """Compile a design's schedule."""
    compiler = _Compiler(design)
    idle = Instruction(compiler.zero, compiler.one, Base.CLEAR, text="wait")
    delay = pipeline(design).store
    phases = {
        k: schedule(blocks, delay, idle)
        for k in range(1, design.algorithm.samples + 1)
        if (blocks := compiler.phase(k))
    }
    ranges = [accumulator_range(phase, compiler.ranges) for phase in phases.values()]
    accumulator = reduce(Interval.__or__, ranges, OPERAND * OPERAND)
    accumulator += Interval(-(1 << WORD_BITS), 0)
    memories = (compiler.left, compiler.right)
    startup = tuple(_startup(design, memories, [i for phase in phases.values() for i in phase]))
    return Program(design, *memories, startup, phases, idle, accumulator)
