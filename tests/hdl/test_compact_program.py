"""The compact core's schedule, run in plain Python against the golden model; no hardware yet."""

import re
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from position_designs import HIGH_RESOLUTION
from sculler_hdl.plan.compact.digits import digit_count, digit_ranges
from sculler_hdl.plan.compact.instructions import (
    Base,
    Instruction,
    MemoryWord,
    SampleWord,
    Store,
)
from sculler_hdl.plan.compact.interpreter import Interpreter
from sculler_hdl.plan.compact.pipeline import Pipeline
from sculler_hdl.plan.compact.plan import plan_compact
from sculler_hdl.plan.compact.scheduling import schedule
from sculler_model.design import Design, Interval
from sculler_model.golden import GoldenModel, to_words
from strategies import DESIGNS, designs, random_counts, with_hardware

ALL = DESIGNS | HIGH_RESOLUTION
EACH = pytest.mark.parametrize("design", ALL.values(), ids=ALL)


def compact(design, **hardware):
    return with_hardware(design, core="compact", **hardware)


def runs_as_the_golden_model(design, samples, seed):
    """Both take the same samples; results equal word by word; the interpreter checks ranges."""
    made = plan_compact(design)
    interpreter = Interpreter(made.program, made.pipeline.store)
    golden = GoldenModel(design)
    rng = np.random.default_rng(seed)
    faults = rng.random(samples) < 0.5 / design.samples_per_major
    results = 0
    for counts, fault in zip(random_counts(design, samples, rng).tolist(), faults, strict=True):
        sample = (tuple(counts[:3]), tuple(counts[3:]), int(fault))
        words, result = interpreter.step(sample), golden.step(*sample)
        assert (words is None) == (result is None)
        if result is not None:
            assert words == to_words(design, result.row())
            results += 1
    return results


@EACH
def test_schedule_gives_the_golden_vectors(design):
    samples = max(3 * design.samples_per_major, 40)
    assert runs_as_the_golden_model(compact(design), samples, 1) >= 3


@settings(deadline=None, max_examples=30)
@given(designs(max_minors=4), st.integers(0, 2**32 - 1), st.sampled_from(["generic", "ice40"]))
def test_schedule_of_any_design_gives_the_golden_vectors(design, seed, target):
    design = compact(design, target=target)
    runs_as_the_golden_model(design, 2 * design.samples_per_major, seed)


def test_instructions_of_the_default_design():
    """Counted by hand: 24-bit counts have 2 digits, A and B (33 bits) 2, theta and v (26) 2."""
    design = compact(Design.preset("stim300"))
    by_number = {}
    for instruction in plan_compact(design).program.phases[4]:
        name = re.match(r"\w+", instruction.text)[0]
        by_number[name] = by_number.get(name, 0) + 1
    expected = dict.fromkeys(("A", "B"), 3 * 2)  # three taps, two digits
    expected |= dict.fromkeys(("theta", "v"), 4 * 2)  # four weights
    expected |= dict.fromkeys(("coning_within", "coning_between"), 4 + 2 * 4)  # state, 2 products
    expected |= dict.fromkeys(("sculling_within", "sculling_between"), 4 + 4 * 4)
    expected |= dict.fromkeys(("alpha", "nu"), 2 * 2 + 2)  # state and sum, two words of sign
    wanted = {f"{name}_{axis}": count for name, count in expected.items() for axis in "xyz"}
    assert by_number == wanted | {"major": 4 + 1, "status": 1}
    # and the last one's way: 8 to its store, 2 to its fetch, 1 to begin
    assert plan_compact(design).timing.work == (0, 0, 0, sum(by_number.values()) + 8 + 2 + 1)
    assert plan_compact(design).resources["clocks_per_minor"] == 329


def test_no_between_products_in_a_major_interval_of_one_minor():
    names = [
        i.text
        for phase in plan_compact(compact(DESIGNS["smallest"])).program.phases.values()
        for i in phase
    ]
    assert not any(name.startswith(("coning_between", "sculling_between")) for name in names)


@pytest.mark.parametrize(
    ("bits", "digits"), [(1, 1), (16, 1), (18, 1), (19, 2), (34, 2), (35, 3), (50, 3), (51, 4)]
)
def test_digits_of_a_number(bits, digits):
    """16 bits each, up to 18 the top one."""
    assert digit_count(bits) == digits
    number = Interval.signed(bits)
    ranges = digit_ranges(number)
    assert len(ranges) == digits
    for value in (number.lo, -1, 0, number.hi):
        low = [value >> 16 * i & 0xFFFF for i in range(digits - 1)]
        top = value >> 16 * (digits - 1)
        assert top in ranges[-1]
        assert ranges[-1].bits <= 18
        assert sum(digit << 16 * i for i, digit in enumerate([*low, top])) == value


def brute_short_majors(design):
    """By the definition of status bit 0, from the golden model run on zeros."""
    golden = GoldenModel(design)
    majors = design.table.history // design.samples_per_major + 3
    zero = (0, 0, 0)
    steps = (golden.step(zero, zero) for _ in range(majors * design.samples_per_major))
    return [result.status for result in steps if result is not None]


@EACH
def test_short_history_is_that_of_the_first_major_intervals(design):
    short = design.short_majors
    statuses = brute_short_majors(design)
    assert statuses == [1] * short + [0] * (len(statuses) - short)


ZERO_TIMES_ONE = Instruction(MemoryWord("left", 0), MemoryWord("right", 0), Base.CLEAR, text="wait")


def making(source, target):
    """A block of one instruction: left word `target` from left word `source`."""
    store = Store(target, frozenset(["left"]), signed=False)
    right = SampleWord(0, 0)
    return (
        Instruction(MemoryWord("left", source), right, Base.CLEAR, store=store, text=f"{target}"),
    )


def test_schedule_fills_the_delay_before_it_waits():
    # 2 needs 1 and must wait 4; 3 and 4 are free; 1 may not be overwritten before 2 has read it
    blocks = [making(0, 1), making(1, 2), making(0, 3), making(0, 4), making(0, 1)]
    order = [instruction.text for instruction in schedule(blocks, 4, ZERO_TIMES_ONE)]
    assert order == ["1", "3", "4", "wait", "2", "1"]


@pytest.mark.parametrize("hardware", [{}, {"target": "ice40"}, {"multipliers": 0}])
@EACH
def test_nothing_is_read_before_it_is_stored(design, hardware):
    design = compact(design, **hardware)
    delay = plan_compact(design).pipeline.store
    for instructions in plan_compact(design).program.phases.values():
        stored = {}
        for now, instruction in enumerate(instructions):
            for word in instruction.reads:
                assert now - stored.get(word, now - delay) >= delay
            stored |= dict.fromkeys(instruction.writes, now)
            assert not (instruction.base is Base.SHIFT and instruction.subtract)


@EACH
def test_newer_samples_spare_what_a_program_reads(design):
    """n newer samples may come before the next program has begun."""
    furthest = max(
        instruction.right.distance
        for instructions in plan_compact(compact(design)).program.phases.values()
        for instruction in instructions
        if isinstance(instruction.right, SampleWord)
    )
    assert furthest + design.algorithm.samples < plan_compact(design).sizes.kept_samples
    assert plan_compact(design).sizes.kept_samples.bit_count() == 1


def test_microcode_puts_every_part_where_its_stage_acts():
    design = compact(DESIGNS["dense_odd_3"])
    code, delays = plan_compact(design).microcode, plan_compact(design).pipeline
    assert delays == Pipeline(step=1, memory=2, product=3)
    start = code.startup
    for phase, instructions in plan_compact(design).program.phases.items():
        words = code.words[start : start + code.lengths[phase]]
        for number, instruction in enumerate(instructions, start=1):
            assert words[number]["left"] == instruction.left.address
            assert words[number - 1]["when"] == instruction.when
            # operands 3 steps on, product 3 more, sum and store 1 each; from a register, 1 less
            assert words[number + 2]["sample"] == isinstance(instruction.right, SampleWord)
            assert words[number + 5]["subtract"] == instruction.subtract
            assert words[number + 6]["shift"] == (instruction.base is Base.SHIFT)
            stores = [name for name in words[number + 7] if name.startswith("store_")]
            memories = instruction.store.memories if instruction.store else ()
            assert {name.removeprefix("store_") for name in stores} == set(memories)
        start += code.lengths[phase]
    assert start == len(code.words)
    # every word fits its fields, and no two fields overlap
    widths = (code.operands | code.actions).items()
    for word, packed in zip(code.words, code.packed(), strict=True):
        for name, width in widths:
            assert packed & (1 << width) - 1 == word.get(name, 0) < 1 << width
            packed >>= width
        assert packed == 0


def test_listing_shows_every_instruction_once_in_order():
    design = compact(DESIGNS["dense_time_3"])
    text = plan_compact(design).listing
    lines = [line for line in text.splitlines() if re.match(r" *\d+  [=+>] [+-] ", line)]
    made = [i for phase in plan_compact(design).program.phases.values() for i in phase]
    assert [line.endswith(f" {i.text}") for line, i in zip(lines, made, strict=True)] == [
        True
    ] * len(made)
    numbers = [int(line.split()[0]) for line in lines]
    assert all(a < b for a, b in pairwise(numbers))
    assert f"latency                     {plan_compact(design).timing.latency} clocks" in text
    assert "A_x.0 = 57 * s_x[t-1].0" in text
    assert "coning_within_y.1 -= A_x.0 * s_z[t].1" in text
    assert max(map(len, text.splitlines())) <= 110


def test_figures_of_the_serial_core():
    made = plan_compact(compact(Design.preset("stim300"), target="ice40", multipliers=0)).resources
    assert made["multipliers"] == 0
    assert made["clocks_per_instruction"] == 20
    assert (
        made["sample_words"]
        == 8 * plan_compact(Design.preset("stim300")).sizes.sample_words
        == 8 * 12
    )
