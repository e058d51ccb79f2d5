"""Changed microprograms on symbols: what is called the same is, and what is not is told."""

from __future__ import annotations

import numpy as np
import pytest

from sculler_hdl.plan.compact.plan import CompactPlan, plan_compact
from sculler_model.design import STATUS_RAIL
from sculler_model.golden import GoldenModel, to_words, words_per_column
from sculler_sim.prove.shapes import SHAPES
from strategies import random_counts
from studies.mutate.microprogram import (
    Machine,
    NotFollowedError,
    Sum,
    Symbols,
    same_results,
    steps,
    with_bit,
)

COMPACT = {name: shape for name, shape in SHAPES.items() if shape.hardware.core == "compact"}
EACH = pytest.mark.parametrize("name", COMPACT)
MAJORS = 4


def bit_of(plan: CompactPlan, field: str, bit: int = 0) -> int:
    """Where a bit of a field stands in a word."""
    widths = plan.microcode.operands | plan.microcode.actions
    return sum(widths[each] for each in list(widths)[: list(widths).index(field)]) + bit


def word_of(plan: CompactPlan, text: str) -> int:
    """The word with the operands of the one step with this text."""
    ((phase, number),) = [
        (phase, number)
        for phase, program in plan.program.phases.items()
        for number, step in enumerate(program)
        if step.text == text
    ]
    return plan.microcode.starts[phase] + 1 + number


def runs_as_the_golden_model(plan, words) -> bool:
    """Whether results of some random intervals are the golden model's, but for the rails' mark."""
    design = plan.design
    golden, length = GoldenModel(design), design.samples_per_major
    rng = np.random.default_rng(7)
    counts = random_counts(design, MAJORS * length, rng).tolist()
    faults = (rng.random(len(counts)) < 0.5 / length).tolist()
    machine = Machine(plan, steps(plan, words)[0], Symbols())
    machine.start()
    sizes, expected = plan.sizes, []
    for t, row in enumerate(counts):
        digits = sizes.digits_per_count
        for i in range(sizes.sample_words):
            count, digit = row[i // digits], i % digits
            value = count >> 16 * digit
            machine.samples[t, i] = value if digit == digits - 1 else value & 0xFFFF
        machine.faults[t] = int(any(faults[t - t % length : t + 1]))
        result = golden.step(tuple(row[:3]), tuple(row[3:]), int(faults[t]))
        if result is not None:
            found = to_words(design, result.row())
            found[design.columns.index("status") * words_per_column(design)] &= ~STATUS_RAIL
            expected.append(found)
    short = design.short_majors
    return expected == [machine.run(major, short=major < short) for major in range(MAJORS)]


@EACH
def test_numbers_in_place_of_symbols_give_the_golden_vectors(name) -> None:
    plan = plan_compact(COMPACT[name])
    assert runs_as_the_golden_model(plan, plan.microcode.words)


@EACH
def test_what_is_the_same_on_symbols_is_with_numbers(name) -> None:
    plan = plan_compact(COMPACT[name])
    words, width = len(plan.microcode.words), bit_of(plan, "publish")
    rng = np.random.default_rng(3)
    said = []
    for word, bit in zip(rng.integers(words, size=25), rng.integers(width, size=25), strict=True):
        try:
            said.append(same_results(plan, int(word), int(bit)))
        except NotFollowedError:
            continue
        if said[-1]:
            assert runs_as_the_golden_model(plan, with_bit(plan, int(word), int(bit)))
    assert {True, False} == set(said)


def test_a_factor_of_nothing_may_be_anything_and_one_that_counts_may_not() -> None:
    plan = plan_compact(COMPACT["compact_plain"])
    carry = word_of(plan, "nu_z.1 = carry + 0 * 1")
    counts = word_of(plan, "sculling_within_y.0 += B_z * s_x[t]")
    right = bit_of(plan, "right")
    assert same_results(plan, carry, right)
    assert not same_results(plan, counts, right)
    assert not same_results(plan, counts, bit_of(plan, "left"))


def test_what_nobody_knows_is_not_taken_for_nothing() -> None:
    """The sum before a phase's first step, and a word of the left memory behind its last one."""
    plan = plan_compact(COMPACT["compact_one"])
    (start,) = plan.microcode.starts.values()
    first = start + plan.pipeline.accumulate  # word in which the first step's sum begins
    assert not same_results(plan, first, bit_of(plan, "keep"))
    assert len(plan.program.left.names) == 49
    carry = word_of(plan, "alpha_y.1 = carry + 0 * 1")
    assert plan.microcode.words[carry]["left"] == 40
    assert not same_results(plan, carry, bit_of(plan, "left", 4))  # 56
    assert same_results(plan, carry, bit_of(plan, "right", 2))  # a known 0 times anything


def test_what_shows_in_a_later_interval_only_is_told() -> None:
    """A state that is not begun anew is the same 0 in the first major interval."""
    plan = plan_compact(COMPACT["compact_one"])
    state = word_of(plan, "alpha_x.0 = alpha_x * 1")
    continued = bit_of(plan, "when")
    kept, changed = with_bit(plan, 0, 0)[state - 1], with_bit(plan, state - 1, continued)[state - 1]
    assert (kept["when"], changed["when"]) == (1, 0)
    assert not same_results(plan, state - 1, continued)


def test_what_belongs_to_no_step_is_not_followed() -> None:
    plan = plan_compact(COMPACT["compact_one"])
    for word, field in ((0, "left"), (len(plan.microcode.words) - 1, "last")):
        with pytest.raises(NotFollowedError, match="start-up"):
            same_results(plan, word, bit_of(plan, field))


def test_sums_of_products() -> None:
    """2ab - 3 + ab = 3ab - 3, in any order; less 3ab it is a number."""
    symbols = Symbols()
    a, b = symbols.of("a"), symbols.of("b")
    total = Sum().plus([a, b, 2], 1).plus([3], -1).plus([b, a], 1)
    assert total == Sum(-3).plus([a, 3, b], 1)
    assert total.plus([a, b], -3) == Sum(-3)
    assert total.plus([0, symbols.new()], 1) == total
    assert Sum().plus([a, a], 1) != Sum().plus([a], 2)
