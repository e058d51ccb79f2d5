"""A microprogram with one bit turned over, beside itself: the same results, whatever is measured.

Both programs run step by step on symbols in place of numbers.  A sum is a number and products of
symbols; a digit of a sum is a symbol of its own.  What is the same expression has the same symbol,
and a product with 0 is gone, whatever the other factor is.  So results with the same symbols are
equal for all samples.  What is not known may be anything: the sum that a phase begins with, a word
that nobody has written, an address where there is no word.

It begins as after a reset.  Then comes one major interval that stands for all later ones: each word
of a memory is a symbol, the same in both programs if it was equal before.  If it ends with a word
unequal that began as equal, it begins again with that one unequal too, until nothing more changes:
an induction over major intervals.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from sculler_hdl.plan.compact.instructions import When
from sculler_hdl.plan.compact.plan import CompactPlan
from sculler_model.golden import WORD_BITS, words_per_result

_TOP_BITS = 18
"""Of a digit that is a number's top one."""


class NotFollowedError(Exception):
    """The program does what is not followed here; the message says what."""


@dataclass(frozen=True)
class Symbol:
    """A number that is not known, by its number in `Symbols`."""

    number: int


Value = int | Symbol


class Symbols:
    """Gives the same expression the same symbol, in both programs."""

    def __init__(self) -> None:
        self._known: dict[object, Symbol] = {}

    def of(self, *expression: object) -> Symbol:
        """The symbol of an expression."""
        return self._known.setdefault(expression, Symbol(len(self._known)))

    def new(self) -> Symbol:
        """One that nothing else has."""
        return self.of("new", len(self._known))


@dataclass(frozen=True)
class Sum:
    """A number, and products of one or two symbols by how often they are in it."""

    number: int = 0
    products: frozenset[tuple[frozenset[tuple[Symbol, int]], int]] = frozenset()

    def plus(self, factors: Sequence[Value], times: int) -> Sum:
        """The sum with a product more."""
        symbols = Counter(each for each in factors if isinstance(each, Symbol))
        for each in factors:
            times *= each if isinstance(each, int) else 1
        if not symbols or not times:
            return Sum(self.number + times * (not symbols), self.products)
        found = Counter(dict(self.products))
        found[frozenset(symbols.items())] += times
        return Sum(self.number, frozenset(each for each in found.items() if each[1]))


@dataclass(frozen=True)
class Step:
    """One step of a phase's program, gathered from the words in which its parts stand."""

    left: int
    right: int
    when: int
    sample: int
    subtract: int
    keep: int
    shift: int
    address: int
    signed: int
    store_left: int
    store_right: int
    store_result: int


def with_bit(plan: CompactPlan, word: int, bit: int) -> list[dict[str, int]]:
    """The program's words with a bit turned over.

    Args:
        plan: the core's plan.
        word: which one.
        bit: of it, as it stands in the memory.
    """
    words = [dict(each) for each in plan.microcode.words]
    for name, width in (plan.microcode.operands | plan.microcode.actions).items():
        if bit < width:
            words[word][name] = words[word].get(name, 0) ^ 1 << bit
            break
        bit -= width
    return words


def steps(
    plan: CompactPlan, words: Sequence[Mapping[str, int]]
) -> tuple[dict[int, list[Step]], list[dict[str, int]]]:
    """What each phase's program does, by phase, and what is left of the words.

    Args:
        plan: the core's plan, which says when each part of a step acts.
        words: of the program memory.
    """
    code, delays = plan.microcode, plan.pipeline
    acts = {
        **dict.fromkeys(("left", "right"), 0),
        "when": -1,
        "sample": delays.operand - 1,
        "subtract": delays.addend - 1,
        **dict.fromkeys(("keep", "shift"), delays.accumulate - 1),
        **dict.fromkeys(("address", "signed"), delays.store - 1),
        **dict.fromkeys(("store_left", "store_right", "store_result"), delays.store - 1),
    }
    left = [dict(each) for each in words]
    found = {}
    for phase, start in code.starts.items():
        end = start + code.lengths[phase]
        found[phase] = [
            Step(
                **{
                    name: left[first + later].pop(name, 0) if first + later < end else 0
                    for name, later in acts.items()
                }
            )
            for first in range(start + 1, end)
        ]
    return found, [{name: value for name, value in each.items() if value} for each in left]


@dataclass
class Machine:
    """Memories of an engine, and what a program makes of them.

    Attributes:
        plan: the core's plan.
        program: the steps of each phase.
        symbols: shared with the program that it is held against.
        memory: words by memory ("left", "right", and "result 0" and so on) and address.
        samples: their digits by time and index; what is not there is a symbol.
        faults: by time, whether a sample of the major interval had fault; else it is a symbol.
        started: whether samples before time 0 are 0.
    """

    plan: CompactPlan
    program: Mapping[int, Sequence[Step]]
    symbols: Symbols
    memory: dict[tuple[str, int], Value] = field(default_factory=dict)
    samples: dict[tuple[int, int], int] = field(default_factory=dict)
    faults: dict[int, int] = field(default_factory=dict)
    started: bool = True

    @cached_property
    def written(self) -> set[tuple[str, int]]:
        """The words of left and right memory that any step writes."""
        every = [step for program in self.program.values() for step in program]
        return {
            (name, step.address)
            for step in every
            for name, stored in (("left", step.store_left), ("right", step.store_right))
            if stored
        }

    def start(self) -> None:
        """As after a reset."""
        for load in self.plan.program.startup:
            name = f"result {load.bank}" if load.memory == "result" else load.memory
            self.memory[name, load.address] = load.value

    def run(self, major: int, *, short: bool) -> list[Value]:
        """Measure a major interval.

        Args:
            major: its number, where it is not the one that stands for all.
            short: whether a tap reaches before the first sample.

        Returns:
            The result's words, without the bits that are put in where the status is stored.
        """
        design = self.plan.design
        bank = f"result {major % self.plan.sizes.result_banks}"
        length, n = design.samples_per_major, design.algorithm.samples
        for t in range(length):
            first, now = t < n, major * length + t
            conditions: dict[When, Value] = {
                When.ALWAYS: 1,
                When.CONTINUED: int(not first),
                When.LATER_MAJOR: int(major > 0),
                When.NEXT_MAJOR: int(first and major > 0),
                When.FAULT: self.faults.get(now, self.symbols.of("fault", now)),
                When.SHORT: int(short),
                When.FIRST_MINOR: int(first),
                When.MAJOR_END: int(t + 1 == length),
            }
            self._phase(self.program.get(t % n + 1, ()), conditions, now, bank)
        words = range(words_per_result(design))
        return [self.memory.get((bank, word), self.symbols.new()) for word in words]

    def _phase(
        self, program: Sequence[Step], conditions: Mapping[When, Value], now: int, bank: str
    ) -> None:
        total = Sum().plus([self.symbols.new()], 1)
        late: list[tuple[int, str, int, Value]] = []
        for number, step in enumerate(program):
            while late and late[0][0] <= number:
                _, name, address, value = late.pop(0)
                self.memory[name, address] = value
            left, right = self._word("left", step.left), self._right(step, now)
            total = self._based(total, step)
            factors = (conditions[When(step.when)], left, right)
            total = total.plus(self._operands(factors), -1 if step.subtract else 1)
            for name, stored in (
                ("left", step.store_left),
                ("right", step.store_right),
                (bank, step.store_result),
            ):
                if stored:
                    self._in_range(name, step.address)
                    wide = step.signed and name in ("left", "right")  # a result has 16 bits
                    digit = self._digit(total, wide=bool(wide))
                    late.append((number + self.plan.pipeline.store, name, step.address, digit))
        for _, name, address, value in late:
            self.memory[name, address] = value

    def _operands(self, factors: tuple[Value, Value, Value]) -> tuple[Value, ...]:
        condition, left, right = factors
        if 0 in factors:
            return (0,)
        if isinstance(condition, Symbol):
            left = self.symbols.of("if", condition, left)
        return left, right

    def _based(self, total: Sum, step: Step) -> Sum:
        if (step.keep and step.shift) or (step.shift and step.subtract):
            raise NotFollowedError("a sum that is kept and shifted, or shifted to subtract from it")
        if step.keep:
            return total
        if not step.shift:
            return Sum()
        if total.products:
            return Sum().plus([self.symbols.of("carry", total)], 1)
        return Sum(total.number >> WORD_BITS)

    def _digit(self, total: Sum, *, wide: bool) -> Value:
        if total.products:
            return self.symbols.of("top" if wide else "digit", total)
        if not wide:
            return total.number & (1 << WORD_BITS) - 1
        half = 1 << _TOP_BITS - 1
        return (total.number + half) % (2 * half) - half

    def _word(self, name: str, address: int) -> Value:
        """What stands there: if nothing writes it the memory's 0, if it is not yet, anything."""
        if (found := self.memory.get((name, address))) is not None:
            return found
        begun = self.plan.design.has_initial_values and (name, address) not in self.written
        return 0 if begun and address < self._words(name) else self.symbols.new()

    def _right(self, step: Step, now: int) -> Value:
        if not step.sample:
            return self._word("right", step.right)
        sizes = self.plan.sizes
        index = step.right % (1 << sizes.index_bits)
        distance = step.right >> sizes.index_bits
        if index >= sizes.sample_words or distance >= sizes.kept_samples:
            return self.symbols.new()
        at = now - distance
        if at < 0 and self.started:
            return 0
        return self.samples.get((at, index), self.symbols.of("sample", at, index))

    def _words(self, name: str) -> int:
        program = self.plan.program
        words = {"left": len(program.left.names), "right": len(program.right.names)}
        return words.get(name, words_per_result(self.plan.design))

    def _in_range(self, name: str, address: int) -> None:
        if address >= self._words(name):
            raise NotFollowedError("a word that is stored where there is none")


def same_results(plan: CompactPlan, word: int, bit: int) -> bool:
    """Whether a core with a bit of its microprogram turned over has the same results for ever.

    Args:
        plan: the core's plan; without channels.
        word: of the program memory.
        bit: of it.

    Returns:
        True if it is shown; False if it is not, which does not say that results differ.

    Raises:
        NotFollowedError: the bit is none of those that belong to a step of a phase.
    """
    kept, rest = steps(plan, plan.microcode.words)
    changed, changed_rest = steps(plan, with_bit(plan, word, bit))
    if rest != changed_rest:
        raise NotFollowedError("a bit of start-up, or of what begins and ends a program")
    symbols = Symbols()
    one, other = Machine(plan, kept, symbols), Machine(plan, changed, symbols)
    one.start()
    other.start()
    short = plan.design.short_majors
    for major in range(max(short, 1)):
        if one.run(major, short=major < short) != other.run(major, short=major < short):
            return False
    return _for_ever(one, other)


def _for_ever(one: Machine, other: Machine) -> bool:
    """Whether results are the same in every major interval from now on."""
    symbols, banks = one.symbols, one.plan.sizes.result_banks
    known = {at: value for at, value in one.memory.items() if isinstance(value, int)}
    unlike: set[tuple[str, int]] = set()
    places = one.memory.keys() | other.memory.keys()
    one.started = other.started = False
    while True:
        unlike |= {at for at in places if one.memory.get(at) != other.memory.get(at)}
        known = {at: value for at, value in known.items() if at not in unlike}
        before = len(unlike), len(known)
        ends = []
        for bank in range(banks):
            for machine in (one, other):
                machine.memory = {
                    at: symbols.new() if at in unlike else known.get(at, symbols.of("word", at))
                    for at in places
                }
            if one.run(banks + bank, short=False) != other.run(banks + bank, short=False):
                return False
            ends.append((one.memory, other.memory))
        for mine, others in ends:
            unlike |= {at for at in mine.keys() | others.keys() if mine.get(at) != others.get(at)}
            known = {at: v for at, v in known.items() if mine[at] == v and others[at] == v}
        if before == (len(unlike), len(known)):
            return True
