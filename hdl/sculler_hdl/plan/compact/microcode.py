"""The schedule as the words of the program memory, and the clocks that follow from it.

A word says what every stage of the engine does in one step (horizontal microcode): the parts of an
instruction stand in different words, each as many words later as its stage comes after the first
(`Pipeline`).  So nothing needs to travel beside the data.  A word has two halves: `operands` acts
when it is fetched, `actions` one step later, out of a register.

First stands the start-up program, which runs once after reset.  In it a word's operands are a
constant, which stands in the product's place.  Then the programs of the phases stand one after
another.  Each begins with a word that does nothing, on which the engine waits; the
next sample with work sets it going; after the last phase's it goes to the first phase's again.
"""

from __future__ import annotations

from dataclasses import dataclass

from sculler_hdl.plan.compact.banks import LeftBanks, left_banks
from sculler_hdl.plan.compact.instructions import (
    Base,
    Instruction,
    Load,
    Program,
    SampleWord,
    When,
)
from sculler_hdl.plan.compact.pipeline import Pipeline
from sculler_model.golden import ChannelTiming, Dropping, Timing


@dataclass(frozen=True)
class Microcode:
    """The program memory.

    Attributes:
        operands, actions: bits of each field of a word's halves, in the order they stand, least
            significant first.
        words: each word's fields that are not 0.
        startup: words of the start-up program, which stands first.
        release: for each phase that has work, the step of its program that lets the next sample
            with work in.
        lengths: for each phase that has work, the words of its program, the first one included.
        banks: where the words of the left memory stand.
    """

    operands: dict[str, int]
    actions: dict[str, int]
    words: tuple[dict[str, int], ...]
    startup: int
    release: dict[int, int]
    lengths: dict[int, int]
    banks: LeftBanks

    @property
    def starts(self) -> dict[int, int]:
        """For each phase that has work, the first word of its program."""
        found, start = {}, self.startup
        for phase, length in self.lengths.items():
            found[phase] = start
            start += length
        return found

    def packed(self) -> list[int]:
        """The words as integers."""
        packed = []
        for word in self.words:
            value = position = 0
            for name, width in (self.operands | self.actions).items():
                value |= word.get(name, 0) << position
                position += width
            packed.append(value)
        return packed


def _bits(largest: int) -> int:
    return max(1, largest.bit_length())


def field_widths(program: Program, banks: LeftBanks) -> tuple[dict[str, int], dict[str, int]]:
    """Bits of each field of a program word: of its operands and of its actions."""
    sizes = program.sizes
    left, right = _bits(len(program.left.names) - 1), _bits(len(program.right.names) - 1)
    if banks.own:
        left = banks.bank_bits
    when = _bits(max(When))
    sample = sizes.index_bits + sizes.slot_bits
    operands = {
        "left": left,
        # or a sample's index, then distance; all three together hold a constant of start-up
        "right": max(right, sample, program.constant_bits - left - when),
        "when": when,
    }
    flags = ["sample", "subtract", "keep", "shift", "store_left", "store_right", "store_result"]
    flags += ["signed", "release", "last", "publish"]
    actions = {"address": max(left, right), **dict.fromkeys(flags, 1)}
    if banks.own:  # the left word, read or stored, is the channel's own
        return operands | {"own": 1}, actions | {"store_own": 1}
    return operands, actions


def encode(program: Program, delays: Pipeline) -> Microcode:
    """Encode a schedule for an engine with these delays."""
    banks = left_banks(program.design, len(program.left.names))
    widths = field_widths(program, banks)
    words = _encode_startup(program.startup, widths[0], banks)
    words[-1]["last"] = 1
    words += [{} for _ in range(1 + delays.memory)]
    startup = len(words)
    release, lengths = {}, {}
    for phase, instructions in program.phases.items():
        block = _encode_phase(instructions, delays, program.sizes.index_bits, banks)
        # The next program may be set going when the last word has acted, `memory` words later than
        # it is fetched.  Its sample may be let in as much earlier as it takes to load.
        # With channels it is loaded before.
        early = 0 if banks.own else (program.sizes.sample_words + 2) // delays.step
        end = max(len(block) - 1, 1 + early)
        block += [{} for _ in range(end + 1 + delays.memory - len(block))]
        release[phase], lengths[phase] = end - early, len(block)
        block[release[phase] - 1]["release"] = 1
        block[end - 1]["last"] = 1
        if phase == program.design.algorithm.samples:
            block[end - 1]["publish"] = 1
        words += block
    return Microcode(*widths, tuple(words), startup, release, lengths, banks)


def _encode_startup(
    loads: tuple[Load, ...], operands: dict[str, int], banks: LeftBanks
) -> list[dict[str, int]]:
    """The words that write constants after a reset, one each step."""
    words: list[dict[str, int]] = [{} for _ in range(len(loads) + _LOAD_STORE)]
    for number, load in enumerate(loads):
        value = load.value & (1 << sum(operands.values())) - 1
        for name, width in operands.items():
            words[number + 1][name] = value & (1 << width) - 1
            value >>= width
        words[number + _LOAD_STORE] |= {
            "address": banks.within(load.address) if load.memory == "left" else load.address,
            "signed": 1,
            f"store_{load.memory}": 1,
            # neither is used so early: there is no operand and nothing to let in
            "sample": load.bank & 1,
            "release": load.bank >> 1,
        }
    return words


_LOAD_STORE = 2
"""Words from the one that acts when a constant is taken to the one that stores it."""


def _encode_phase(
    instructions: tuple[Instruction, ...], delays: Pipeline, index_bits: int, banks: LeftBanks
) -> list[dict[str, int]]:
    """The first, empty word, then those of the instructions."""
    words: list[dict[str, int]] = [{} for _ in range(1 + len(instructions) + delays.store)]
    acting = [{}, *words]  # by the step in which actions act
    for number, instruction in enumerate(instructions, start=1):
        right, store = instruction.right, instruction.store
        from_sample = isinstance(right, SampleWord)
        words[number - 1]["when"] = instruction.when
        words[number] |= {
            "left": banks.within(instruction.left.address),
            "right": (
                right.index | right.distance << index_bits
                if isinstance(right, SampleWord)
                else right.address
            ),
        }
        if banks.own:
            words[number]["own"] = banks.is_own(instruction.left.address)
        acting[number + delays.operand]["sample"] = int(from_sample)
        acting[number + delays.addend]["subtract"] = int(instruction.subtract)
        acting[number + delays.accumulate] |= {
            "keep": int(instruction.base is Base.KEEP),
            "shift": int(instruction.base is Base.SHIFT),
        }
        if store is not None:
            left = banks.own and "left" in store.memories
            acting[number + delays.store] |= {
                "address": banks.within(store.address) if left else store.address,
                "signed": int(store.signed),
            } | {f"store_{memory}": 1 for memory in sorted(store.memories)}
            if left:
                acting[number + delays.store]["store_own"] = banks.is_own(store.address)
    return words


def engine_timing(program: Program, delays: Pipeline, code: Microcode) -> Timing:
    """The clocks the compact core takes (`sculler_model.golden`)."""
    if code.banks.own:
        return _channel_timing(program, delays, code)
    sizes, n = program.sizes, program.design.algorithm.samples
    # clocks from taking a sample, whose digits are written one each, to the engine's first
    loaded = sizes.sample_words + 1
    work = {  # sample_ready follows a clock later, as it does below
        phase: loaded + (release + delays.memory + 1) * delays.step + 1
        for phase, release in code.release.items()
    }
    end = code.lengths[n] - 1 - delays.memory
    published = loaded + (end + delays.memory + 1) * delays.step - 1
    handover = 1 + delays.memory
    return Timing(
        latency=published + handover,
        spacing=loaded + 1,
        startup=max(
            sizes.kept_samples * sizes.sample_words + 1,  # zeros for samples before the first
            code.startup + 1,  # constants
        ),
        work=tuple(work.get(k, 0) for k in range(1, n + 1)),
        handover_spacing=handover,
        dropping=Dropping(published + 1, handover) if program.design.drops_results else None,
    )


def _channel_timing(program: Program, delays: Pipeline, code: Microcode) -> ChannelTiming:
    """The clocks of a core with many channels, of which one sample is loaded at a time."""
    sizes, design = program.sizes, program.design
    n = design.algorithm.samples
    # its channel is known a clock after a sample is taken, then comes what is kept of the channel
    lookup = 2 + delays.memory
    loaded = lookup + sizes.sample_words
    work = {
        phase: 1 + (release + delays.memory + 1) * delays.step
        for phase, release in code.release.items()
    }
    end = code.lengths[n] - 1 - delays.memory
    handover = 1 + delays.memory
    zeros = sizes.kept_samples * sizes.sample_words if any(design.short_samples) else 0
    return ChannelTiming(
        latency=loaded + (end + delays.memory + 1) * delays.step + handover,
        spacing=loaded + 2,
        startup=max(design.channels + 1, code.startup + 1),
        work=tuple(work.get(k, 0) for k in range(1, n + 1)),
        handover_spacing=handover,
        results=2,
        lookup=lookup,
        loading=sizes.sample_words,
        clearing=zeros,
    )
