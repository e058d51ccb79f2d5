"""Each part against plain integers: exhaustive where it is small, seeded extremes where not."""

import itertools
import random

import pytest
from amaranth.sim import Simulator

from sculler_hdl.core import PipelinedCore, core_latency
from sculler_hdl.parts.accumulate import Accumulator
from sculler_hdl.parts.cross import CrossSum
from sculler_hdl.parts.delay import Delay
from sculler_hdl.parts.handover import HandOver
from sculler_hdl.parts.history import History
from sculler_hdl.parts.multiply import Multiplier
from sculler_hdl.parts.sequencer import Sequencer
from sculler_hdl.parts.weighted_sum import WeightedSum, signed_digits, terms_of
from sculler_hdl.verilog import generate
from sculler_model.design import Design
from sculler_model.vectors import VECTORS
from sculler_model.wordlength import Interval, word_lengths
from strategies import DESIGNS


def run(part, drive):
    """Run `drive(ctx)` as the test bench of a part."""
    simulator = Simulator(part)
    simulator.add_clock(1e-6)
    simulator.add_testbench(drive)
    simulator.run()


def extremes(interval, rng, count):
    ends = [interval.lo, interval.hi, 0, -1 if interval.lo < 0 else 0]
    return [rng.choice([*ends, rng.randint(interval.lo, interval.hi)]) for _ in range(count)]


def test_signed_digits_are_the_value_and_sparse():
    for value in [*range(-300, 301), 10**30 + 7, -(2**90) + 1]:
        digits = signed_digits(value)
        assert sum(sign << shift for shift, sign in digits) == value
        shifts = [shift for shift, _ in digits]
        assert all(b - a >= 2 for a, b in itertools.pairwise(shifts))
        assert {sign for _, sign in digits} <= {1, -1}


def test_multiplier_every_product_of_small_words():
    left, right = Interval.signed(5), Interval.signed(4)
    part = Multiplier(left, right)
    pairs = list(itertools.product(range(left.lo, left.hi + 1), range(right.lo, right.hi + 1)))
    seen = []

    async def bench(ctx):
        for a, b in pairs + [(0, 0)] * part.latency:
            ctx.set(part.left, a)
            ctx.set(part.right, b)
            _, _, product = await ctx.tick().sample(part.output)
            seen.append(product)

    run(part, bench)
    assert seen[part.latency :] == [a * b for a, b in pairs]


@pytest.mark.parametrize("bits", [(33, 24), (90, 32)])
def test_multiplier_extremes_of_wide_words(bits):
    left, right = map(Interval.signed, bits)
    part = Multiplier(left, right)
    rng = random.Random(1)
    pairs = list(zip(extremes(left, rng, 60), extremes(right, rng, 60), strict=True))
    seen = []

    async def bench(ctx):
        for a, b in pairs + [(0, 0)] * part.latency:
            ctx.set(part.left, a)
            ctx.set(part.right, b)
            _, _, product = await ctx.tick().sample(part.output)
            seen.append(product)

    run(part, bench)
    assert seen[part.latency :] == [a * b for a, b in pairs]


@pytest.mark.parametrize("count", [1, 2])
def test_cross_sum(count):
    pairs = [(Interval.signed(13), Interval(-7, 9)), (Interval.signed(6), Interval.signed(11))]
    pairs = pairs[:count]
    part = CrossSum(*pairs)
    rng = random.Random(2)
    items = [
        [(extremes(left, rng, 3), extremes(right, rng, 3)) for left, right in pairs]
        for _ in range(200)
    ]
    seen = []

    async def bench(ctx):
        for item in items + [items[0]] * part.latency:
            for i, (left, right) in enumerate(item):
                for axis in range(3):
                    ctx.set(getattr(part, f"left{i}")[axis], left[axis])
                    ctx.set(getattr(part, f"right{i}")[axis], right[axis])
            _, _, *out = await ctx.tick().sample(*(part.output[axis] for axis in range(3)))
            seen.append(out)

    run(part, bench)
    expected = [
        [
            sum(
                a[(axis + 1) % 3] * b[(axis + 2) % 3] - a[(axis + 2) % 3] * b[(axis + 1) % 3]
                for a, b in item
            )
            for axis in range(3)
        ]
        for item in items
    ]
    assert seen[part.latency :] == expected


ROWS = {
    "one term": {1: [(1, 1)]},
    "negative": {0: [(0, -3)]},
    "compressed": {3: [(1, 214), (2, 92), (3, 54)]},
    "dense": {1: [(1, 57)], 2: [(1, 57), (2, 33)]},
    "mixed signs": {0: [(1, -5), (2, 7)], 1: [(1, 5), (3, -7)], 2: [(2, -1)]},
}


@pytest.mark.parametrize("rows", ROWS.values(), ids=ROWS)
def test_weighted_sum(rows):
    counts, reach, phases = Interval.signed(9), 3, 4
    totals = [sum((counts.scaled(c) for _, c in row), Interval(0, 0)) for row in rows.values()]
    result = Interval(min(t.lo for t in totals), max(t.hi for t in totals))
    part = WeightedSum(counts, reach, rows, result, phases)
    rng = random.Random(3)
    items = [
        (rng.choice(list(rows)), [extremes(counts, rng, 3) for _ in range(reach + 1)])
        for _ in range(300)
    ]
    seen = []

    async def bench(ctx):
        for phase, samples in items + [items[0]] * part.latency:
            ctx.set(part.phase, phase)
            for d, sample in enumerate(samples):
                for axis in range(3):
                    ctx.set(part.samples[d][axis], sample[axis])
            _, _, *out = await ctx.tick().sample(*(part.output[axis] for axis in range(3)))
            seen.append(out)

    run(part, bench)
    assert seen[part.latency :] == [
        [sum(c * samples[d][axis] for d, c in rows[phase]) for axis in range(3)]
        for phase, samples in items
    ]


def test_weighted_sum_tree_is_logarithmic():
    assert len(terms_of(ROWS["compressed"])) == 10  # 54, 92, 214 have 3, 3 and 4 signed digits
    part = WeightedSum(Interval.signed(8), 3, ROWS["compressed"], Interval.signed(20), 4)
    assert part.latency == 4

    async def bench(ctx):
        await ctx.tick()

    run(part, bench)


def test_accumulator_restarts_adds_and_holds():
    item = Interval(-10, 10)
    part = Accumulator(item, item.repeated(5))
    rng = random.Random(4)
    total, log = [0, 0, 0], []

    async def bench(ctx):
        nonlocal total
        since_start = 0
        for _ in range(500):
            start = since_start >= 5 or rng.random() < 0.1
            step, add = rng.random() < 0.8, rng.random() < 0.7
            value = [rng.randint(-10, 10) for _ in range(3)]
            ctx.set(part.step, step)
            ctx.set(part.start, start)
            ctx.set(part.add, add)
            for axis in range(3):
                ctx.set(part.input[axis], value[axis])
            _, _, *shown = await ctx.tick().sample(
                *(port[axis] for port in (part.total, part.before) for axis in range(3))
            )
            before = [0, 0, 0] if start else total
            log.append((shown, [*total, *before]))
            if step:
                since_start = 1 if start else since_start + 1
                total = [b + v * add for b, v in zip(before, value, strict=True)]

    run(part, bench)
    assert all(shown == expected for shown, expected in log)


@pytest.mark.parametrize("latency", [1, 4])
def test_delay(latency):
    part = Delay(8, latency)
    seen = []

    async def bench(ctx):
        for value in range(20):
            ctx.set(part.input, value + 100)
            _, _, out = await ctx.tick().sample(part.output)
            seen.append(out)

    run(part, bench)
    assert seen == [0] * latency + list(range(100, 120 - latency))


def test_history_shifts_only_when_told():
    part = History(Interval.signed(8), 2)
    kept, log = [0, 0, 0], []

    async def bench(ctx):
        nonlocal kept
        rng = random.Random(5)
        for value in range(-50, 50):
            shift = rng.random() < 0.5
            ctx.set(part.shift, shift)
            ctx.set(part.input[1], value)
            _, _, *out = await ctx.tick().sample(*(part.output[d][1] for d in range(3)))
            log.append((out, list(kept)))
            if shift:
                kept = [value, *kept[:2]]

    run(part, bench)
    assert all(out == expected for out, expected in log)


def test_handover_holds_one_result_and_counts():
    words = word_lengths(8, 8, 1, DESIGNS["taylor_2p0"].table)
    part = HandOver(words)
    log = []

    async def bench(ctx):
        async def clock(load, ready, value):
            ctx.set(part.load, load)
            ctx.set(part.ready, ready)
            ctx.set(part.input_status, value & 3)
            for name in VECTORS:
                ctx.set(part.input[name][2], value if name == "alpha" else 0)
            _, _, *shown = await ctx.tick().sample(
                part.valid, part.taken, part.major, part.status, part.output.alpha[2]
            )
            log.append(tuple(shown))

        for load, ready, value in [
            (0, 1, 9),
            (1, 0, 7),
            (0, 0, 5),
            (0, 1, 5),
            (1, 1, 6),
            (0, 1, 0),
        ]:
            await clock(load, ready, value)
        await clock(0, 0, 0)

    run(part, bench)
    assert log == [
        (0, 0, 0, 0, 0),
        (0, 0, 0, 0, 0),
        (1, 0, 0, 3, 7),
        (1, 1, 0, 3, 7),
        (0, 0, 0, 3, 7),
        (1, 1, 1, 2, 6),
        (0, 0, 1, 2, 6),
    ]


def uses_the_past(design, t):
    """Does a non-zero tap or weight of sample t reach before sample 0, from the page."""
    table = design.table
    k = t % table.samples + 1
    tap = any(c and d > t for d, c in enumerate(table.taps[k - 1], start=1))
    weight = any(w and d > t for d, w in enumerate(table.weights))
    return tap or (k == table.samples and weight)


@pytest.mark.parametrize("design", DESIGNS.values(), ids=DESIGNS)
def test_sequencer_knows_when_history_is_short(design):
    part = Sequencer(design)
    seen = []

    async def bench(ctx):
        ctx.set(part.sample_valid, 1)
        ctx.set(part.result_taken, 1)
        for _ in range(100):
            _, _, accept, short = await ctx.tick().sample(part.accept, part.flags.short)
            if accept:
                seen.append(short)

    run(part, bench)
    assert seen == [uses_the_past(design, t) for t in range(len(seen))]
    assert len(seen) > design.table.history


def test_core_latency_is_the_sum_of_its_parts():
    design = Design.preset("stim300")
    core = PipelinedCore(design)
    assert core.latency == core_latency(design) == 1 + 4 + 5 + 1 + 1
    assert generate(design).manifest["latency_clocks"] == core.latency

    async def bench(ctx):
        await ctx.tick()

    run(core, bench)
