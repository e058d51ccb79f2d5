"""The words of the schedule: numbers in memory, products of their digits, instructions."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import Enum, IntEnum
from functools import reduce

from sculler_hdl.plan.compact.digits import MemorySizes
from sculler_model.design import Design, Interval


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
class MemoryWord:
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
    places: tuple[MemoryWord | SampleWord, ...]
    ranges: tuple[Interval, ...]


@dataclass(frozen=True)
class ProductTerm:
    """+- left * right, `left` being 0 unless `when`."""

    left: Number
    right: Number
    subtract: bool = False
    when: When = When.ALWAYS


def digits_reached(terms: Iterable[ProductTerm]) -> int:
    """Digits of the highest place that a product of their digits has."""
    return max(len(term.left.places) + len(term.right.places) - 1 for term in terms)


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

    left: MemoryWord
    right: MemoryWord | SampleWord
    base: Base
    subtract: bool = False
    when: When = When.ALWAYS
    store: Store | None = None
    text: str = ""

    @property
    def reads(self) -> tuple[MemoryWord, ...]:
        """The words it reads, samples apart."""
        return (self.left, self.right) if isinstance(self.right, MemoryWord) else (self.left,)

    @property
    def writes(self) -> tuple[MemoryWord, ...]:
        """The words it writes that instructions can read."""
        if self.store is None:
            return ()
        return tuple(
            MemoryWord(m, self.store.address) for m in ("left", "right") if m in self.store.memories
        )


Block = tuple[Instruction, ...]
"""The instructions that form one number, which stay together."""


@dataclass
class Memory:
    """What stands where in a memory: names by address, and those that are constant."""

    name: str
    names: list[str] = field(default_factory=list)
    constants: dict[int, int] = field(default_factory=dict)

    def place(self, name: str, value: int | None = None) -> MemoryWord:
        """The next free word; constant if it has a value."""
        self.names.append(name)
        address = len(self.names) - 1
        if value is not None:
            self.constants[address] = value
        return MemoryWord(self.name, address)


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
        sizes: of its memories.
        left, right: the memories of left and right operands.
        startup: what is written after each reset, before the first sample.
        phases: the instructions for a sample of phase k, for the phases that have work.
        idle: 0 * 1, which stores nothing.
        accumulator: range of the accumulator, that of a product at least, and with a carry out of
            the low digit to spare, which the engine adds late.
    """

    design: Design
    sizes: MemorySizes
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
