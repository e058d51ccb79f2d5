"""The schedule of the compact core: the algorithm as a list of digit products, fixed for good.

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
from functools import reduce

from sculler_hdl.plan.compact.compiler import Compiler
from sculler_hdl.plan.compact.digits import OPERAND, MemorySizes
from sculler_hdl.plan.compact.instructions import (
    Base,
    Instruction,
    Load,
    Memory,
    MemoryWord,
    Program,
    SampleWord,
    When,
)
from sculler_hdl.plan.compact.memory_map import MemoryMap
from sculler_hdl.plan.compact.scheduling import schedule
from sculler_model.design import ZERO_RANGE, Design, Interval
from sculler_model.golden import WORD_BITS, words_per_result


def accumulator_range(
    instructions: Iterable[Instruction], ranges: Mapping[MemoryWord | SampleWord, Interval]
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
    design: Design,
    sizes: MemorySizes,
    memories: Iterable[Memory],
    instructions: Sequence[Instruction],
) -> Iterator[Load]:
    """What no instruction writes before it counts.

    The constants; 0 in right words that are first multiplied by 0, which would do without, were it
    not that simulators take 0 times unknown for unknown; and 0 in those words of all banks of
    results that no instruction writes.

    Args:
        design: the design.
        sizes: of its memories.
        memories: of its operands.
        instructions: of all phases, in their order.
    """
    for memory in memories:
        for address, value in memory.constants.items():
            yield Load(memory.name, address, value)
    known = {
        MemoryWord(memory.name, address) for memory in memories for address in memory.constants
    }
    for instruction in instructions:
        right = instruction.right
        if isinstance(right, MemoryWord) and right not in known:
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
            for bank in range(sizes.result_banks):
                yield Load("result", address, 0, bank)


def compile_program(design: Design, sizes: MemorySizes, delay: int) -> Program:
    """Compile a design's schedule.

    Args:
        design: the design.
        sizes: of its memories.
        delay: instructions from one that stores a word to the first that can read it.
    """
    memory = MemoryMap(design, sizes)
    compiler = Compiler(design, memory)
    idle = Instruction(memory.zero, memory.one, Base.CLEAR, text="wait")
    phases = {
        k: schedule(blocks, delay, idle)
        for k in range(1, design.algorithm.samples + 1)
        if (blocks := compiler.phase(k))
    }
    ranges = [accumulator_range(phase, memory.ranges) for phase in phases.values()]
    accumulator = reduce(Interval.__or__, ranges, OPERAND * OPERAND)
    accumulator += Interval(-(1 << WORD_BITS), 0)
    memories = (memory.left, memory.right)
    instructions = [i for phase in phases.values() for i in phase]
    startup = tuple(_startup(design, sizes, memories, instructions))
    return Program(design, sizes, *memories, startup, phases, idle, accumulator)
