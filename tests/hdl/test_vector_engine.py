"""The parts of the pipelined core that make third and fourth order, alone, and the core itself."""

from __future__ import annotations

import random
from typing import Any

import pytest

from amaranth_runs import drive
from higher_order_designs import HIGHER_ORDER, higher
from rtl import check_trace, clocks_of_major
from sculler_hdl import TARGETS
from sculler_hdl.pipelined.vector_lane import VectorLane
from sculler_hdl.pipelined.vector_loader import VectorLoader
from sculler_hdl.plan.pipelined import plan_pipelined
from sculler_hdl.plan.vector.engine import TURNS, VectorEnginePlan
from sculler_model.design import Design
from sculler_model.errors import InputError
from strategies import with_hardware
from tiers import few_of

SMALL = {
    order: higher(f"small_{order}", 2, 0, 2, (8, 8), order, hardware={"core": "pipelined"})
    for order in (3, 4)
}


@pytest.mark.parametrize("turns", TURNS)
def test_lane_adds_up_what_it_says_when_it_says(turns: int) -> None:
    """Sums of 1 to 4 products, gaps between steps, each sign and digit, with and without a start.

    Where axes take turns, three sums of the same steps with operands of their own.
    """
    plan = VectorEnginePlan(HIGHER_ORDER["dense"], TARGETS["generic"], turns)
    lane, rng, page = VectorLane(plan, primitive=False), random.Random(turns), plan.page
    assert page.digit_count > 1
    low, high = plan.accumulator.total.lo, plan.accumulator.total.hi
    steps: list[dict[str, int]] = []  # of each clock
    initials: dict[int, int] = {}
    expected: dict[int, int] = {}
    for _ in range(12):
        totals = [rng.choice([0, rng.randint(low >> 3, high >> 3)]) for _ in range(turns)]
        count = rng.randint(1, 4)
        for number in range(count):
            shared = {"subtract": rng.getrandbits(1), "digit": rng.randrange(page.digit_count)}
            shared |= {"step": 1, "last": int(number == count - 1)}
            for axis in range(turns):
                left = rng.randint(page.left_range.lo, page.left_range.hi) >> 20
                right = rng.randint(page.right_range.lo, page.right_range.hi)
                initials[len(steps)] = totals[axis] if number == 0 else 0
                product = left * right << shared["digit"] * page.digit_bits
                if number == 0:
                    expected[len(steps)] = totals[axis]
                else:
                    expected[len(steps)] = expected[len(steps) - turns]
                expected[len(steps)] += -product if shared["subtract"] else product
                steps.append({"left": left, "right": right, **shared})
            if rng.getrandbits(1) and number < count - 1 and turns == 1:
                expected[len(steps)] = expected[len(steps) - 1]
                steps.append({"step": 0, "left": rng.getrandbits(9)})
    seen: dict[int, int] = {}

    async def bench(ctx: Any) -> None:
        for clock in range(len(steps) + plan.whole + 1):
            for name, value in (steps[clock] if clock < len(steps) else {"step": 0}).items():
                ctx.set(getattr(lane, name), value)
            ctx.set(lane.initial, initials.get(clock - plan.accumulator.clock, 0))
            *_, output = await ctx.tick().sample(lane.output)
            seen[clock - plan.whole] = output

    drive(lane, bench)
    bits = plan.accumulator.total.bits
    for clock, total in expected.items():
        assert (seen[clock] - total) % (1 << bits) == 0, clock


def test_loader_gives_skewed_words_in_turn() -> None:
    arrivals = (((3, 1), (2, 2)), ((4, 0),), ((2, 2), (5, 4)))
    loader, rng = VectorLoader(arrivals), random.Random(3)
    seen: list[int] = []
    words = [[-16, 7, -64], [15, -8, 63], [rng.randint(-16, 15), 0, -1]]

    async def bench(ctx: Any) -> None:
        for three in words:
            for clock in range(9):
                ctx.set(loader.load, clock == 0)
                ctx.set(loader.shift, clock >= 5)
                for i, (word, arrival) in enumerate(zip(three, arrivals, strict=True)):
                    shown, low = rng.getrandbits(7), 0
                    for bits, when in arrival:
                        mask = ((1 << bits) - 1) << low
                        if when == clock:
                            shown = shown & ~mask | word & mask
                        low += bits
                    ctx.set(getattr(loader, f"word{i}"), shown)
                *_, output = await ctx.tick().sample(loader.output)
                if 5 <= clock < 8:
                    seen.append(output - (output >> 6 << 7))

    drive(loader, bench)
    assert seen == [word for three in words for word in three]


@pytest.mark.parametrize(
    ("order", "multipliers", "majors", "seed"),
    [
        (3, None, 5, 0),
        pytest.param(3, 4, 3, 0, id="axes in turn"),
        pytest.param(4, None, 4, 2, marks=pytest.mark.deep),
        pytest.param(4, 6, 3, 0, marks=pytest.mark.deep),
    ],
)
def test_every_port_on_every_clock(
    order: int, multipliers: int | None, majors: int, seed: int
) -> None:
    """The core as the cycle model has it: stalls, lost samples, resets, results that wait."""
    design = with_hardware(SMALL[order], multipliers=multipliers)
    engine = plan_pipelined(design).schedule.engine
    assert engine is not None
    assert engine.lanes == (3 if multipliers is None else 1)
    clocks = majors * clocks_of_major(design)
    check_trace(design, "amaranth", clocks, seeds=[seed], least=2)


COSTS = {
    (3, None): (26, 144, 32, 3, 100),
    (3, 28): (26, 145, 28, 3, 100),
    (3, 16): (63, 273, 16, 1, 82),
    (4, None): (55, 262, 44, 3, 218),
    (4, 28): (143, 594, 20, 1, 189),
    (4, 16): (143, 593, 16, 1, 189),
}
"""Clocks a sample, latency, blocks, lanes, words of the program: by order and multipliers."""


@pytest.mark.parametrize("case", few_of(list(COSTS), [(3, None), (4, 28)]))
def test_costs_that_the_docs_name(case: tuple[int, int | None]) -> None:
    order, multipliers = case
    hardware = {"target": "ecp5", "multipliers": multipliers}
    plan = plan_pipelined(with_hardware(Design.preset("stim300", order=order), **hardware))
    engine, timing = plan.schedule.engine, plan.timing
    assert engine is not None
    found = timing.spacing, timing.latency, plan.block_count, engine.lanes, len(engine.words)
    assert found == COSTS[case]


def test_too_few_multipliers_are_refused_with_one_line() -> None:
    design = with_hardware(Design.preset("stim300", order=4), target="ecp5", multipliers=9)
    with pytest.raises(InputError) as caught:
        plan_pipelined(design)
    assert "9 are not enough" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_hardening_is_refused_with_one_line() -> None:
    with pytest.raises(InputError) as caught:
        plan_pipelined(with_hardware(SMALL[3], hardening="detect"))
    assert str(caught.value) == (
        'hardware.hardening: "detect" is not built for core = "pipelined" with algorithm.order = 3:'
        ' leave one out, or give core = "compact"'
    )


def test_an_order_without_terms_is_refused_with_one_line() -> None:
    with pytest.raises(InputError) as caught:
        plan_pipelined(Design.preset("stim300", order=3, samples=1, history=1, minors=1))
    assert str(caught.value) == (
        "algorithm.order: 3 has no terms with samples = 1 and minors = 1, leave it out, or give"
        ' core = "compact"'
    )
