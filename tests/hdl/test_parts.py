"""Each part alone against plain integers: exhaustive where it is small, seeded extremes where not.

Every test checks the part's stated clocks as well: a word's bits are put on a port, and read from
one, only in the clocks in which its `arrival` says they are there; at other times inputs are noise.
"""

import itertools
import random

import pytest
from amaranth import Module, ResetInserter, Signal
from amaranth.hdl import Fragment
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from amaranth_runs import drive
from sculler_hdl import TARGETS
from sculler_hdl.lib.accumulator import Accumulator
from sculler_hdl.lib.adder_tree import AdderTree
from sculler_hdl.lib.delay import ControlDelay, SkewedSignal
from sculler_hdl.lib.multiplier import Multiplier, emit_multiplier
from sculler_hdl.lib.running_sum import RunningSum
from sculler_hdl.lib.weighted_sum import WeightedSum
from sculler_hdl.pipelined import stream as stream_module
from sculler_hdl.pipelined.cross_array import CrossArray
from sculler_hdl.pipelined.handover import HandOver
from sculler_hdl.pipelined.sequencer import Sequencer
from sculler_hdl.pipelined.stream import StreamHandOver
from sculler_hdl.plan.accumulator import AccumulatorPlan
from sculler_hdl.plan.adder_tree import Addend, AdderTreePlan
from sculler_hdl.plan.arrival import Limbs, at_once, limbs, spans
from sculler_hdl.plan.cross_array import FOLDINGS, CrossArrayPlan, Folding, Operand
from sculler_hdl.plan.dot_product import signed_digits
from sculler_hdl.plan.multiplier import MultiplierPlan, OperandSplit, operand_splits
from sculler_hdl.plan.running_sum import RunningSumPlan
from sculler_hdl.plan.transfer import HandOverPlan
from sculler_hdl.plan.weighted_sum import WeightedSumPlan, terms_of
from sculler_model.design import AXES, COLUMNS, VECTORS, Interval, word_lengths
from sculler_model.golden import from_words, words_per_column, words_per_result
from strategies import DESIGNS


def extremes(interval, rng, count):
    ends = [interval.lo, interval.hi, 0, -1 if interval.lo < 0 else 0]
    return [rng.choice([*ends, rng.randint(interval.lo, interval.hi)]) for _ in range(count)]


def skewed(bits, limb, clock=0):
    """The arrival of a word whose lowest limb comes at `clock`, the others in their turn."""
    return tuple((hi - lo, clock + q) for q, lo, hi in limbs(bits, limb))


def stream(part, inputs, outputs, clocks, flags=None):
    """Put words on a part's ports and read words from it, each bit at its own clock.

    Args:
        inputs: port -> (arrival, {clock: integer}); the clock is the word's own clock 0.
        outputs: name -> (port, arrival, {clock}), signed words.
        clocks: how long.
        flags: port -> {clocks} in which it is high.

    Returns:
        name -> {clock: integer}.
    """
    rng = random.Random(7)
    seen = {name: [] for name in outputs}

    async def bench(ctx):
        for now in range(clocks):
            for port, (arrival, values) in inputs:
                shown = rng.getrandbits(sum(bits for bits, _ in arrival))
                for lo, hi, clock in spans(arrival):
                    if now - clock in values:
                        mask = (1 << hi) - (1 << lo)
                        shown = (shown & ~mask) | (values[now - clock] & mask)
                ctx.set(port, shown)
            for port, high in flags or ():
                ctx.set(port, int(now in high))
            _, _, *shown = await ctx.tick().sample(*(port for port, *_ in outputs.values()))
            for name, value in zip(outputs, shown, strict=True):
                seen[name].append(value)

    drive(part, bench)
    words = {}
    for name, (_, arrival, when) in outputs.items():
        words[name] = {}
        bits = sum(width for width, _ in arrival)
        for start in when:
            value = sum(
                seen[name][start + clock] & ((1 << hi) - (1 << lo))
                for lo, hi, clock in spans(arrival)
            )
            words[name][start] = value - (1 << bits) if value >> (bits - 1) else value
    return words


def cross(a, b):
    """a x b."""
    return [a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2] for i in range(3)]


def test_signed_digits_are_the_value_and_sparse():
    for value in [*range(-300, 301), 10**30 + 7, -(2**90) + 1]:
        digits = signed_digits(value)
        assert sum(sign << shift for shift, sign in digits) == value
        shifts = [shift for shift, _ in digits]
        assert all(b - a >= 2 for a, b in itertools.pairwise(shifts))
        assert {sign for _, sign in digits} <= {1, -1}


@pytest.mark.parametrize("limb", [Limbs(5), Limbs(16, 2), Limbs(7, 3), Limbs(64)], ids=str)
@pytest.mark.parametrize("seed", range(8))
def test_sum_of_any_terms(seed, limb):
    """Signs, shifts and arrivals at random; also all negative, and one term alone."""
    rng = random.Random(seed)
    addends, values = [], []
    for _ in range(1 if seed == 7 else rng.randint(2, 9)):
        bits = rng.randint(3, 40)
        arrival = skewed(bits, limb, rng.randint(0, 4)) if rng.random() < 0.5 else at_once(bits, 2)
        negative = seed == 6 or rng.random() < 0.5
        addends.append(Addend(Interval.signed(bits), arrival, rng.randint(0, 20), negative))
        values.append(dict(enumerate(extremes(Interval.signed(bits), rng, 40))))
    scaled = [a.range.scaled((-1 if a.negative else 1) << a.low) for a in addends]
    part = AdderTree(AdderTreePlan(addends, sum(scaled, Interval(0, 0)), limb))
    inputs = [
        (getattr(part, f"term{i}"), (a.arrival, v))
        for i, (a, v) in enumerate(zip(addends, values, strict=True))
    ]
    clocks = 40 + max(clock for _, clock in part.plan.arrival)
    seen = stream(part, inputs, {"sum": (part.output, part.plan.arrival, range(40))}, clocks)
    signs = [(-1 if a.negative else 1) << a.low for a in addends]
    assert seen["sum"] == {
        t: sum(s * v[t] for s, v in zip(signs, values, strict=True)) for t in range(40)
    }


def test_sum_is_logarithmic_and_skew_costs_once():
    """Ten terms of 64 bits in limbs of 16: four levels, and three clocks for three more limbs."""
    addends = [Addend(Interval.signed(60), at_once(60)) for _ in range(10)]
    made = AdderTreePlan(addends, Interval.signed(64), Limbs(16))
    assert made.arrival == ((16, 4), (16, 5), (16, 6), (16, 7))
    assert AdderTreePlan(addends, Interval.signed(64), Limbs(32, 2)).arrival == ((32, 4), (32, 6))
    late = [*addends, Addend(Interval.signed(60), at_once(60, 3))]
    assert AdderTreePlan(late, Interval.signed(64), Limbs(16)).arrival[0] == (16, 5)


class ProductAlone(wiring.Component):
    """A multiplier's blocks and rows with ports for the operands, added up by the test."""

    def __init__(self, product):
        self.product = product
        widths = [sum(bits for bits, _ in addend.arrival) for addend in product.addends]
        super().__init__(
            {
                "left": In(product.left.bits),
                "right": In(product.right.bits),
                **{f"term{i}": Out(width) for i, width in enumerate(widths)},
            }
        )

    def elaborate(self, platform):
        m = Module()
        product = self.product
        left = SkewedSignal(m, "left", self.left, product.left_arrival)
        right = SkewedSignal(m, "right", self.right, product.right_arrival)
        for i, value in enumerate(
            emit_multiplier(m, "unit", product, left, right, primitive=False)
        ):
            m.d.comb += getattr(self, f"term{i}").eq(value)
        return m


def products_seen(product, lefts, rights):
    part = ProductAlone(product)
    count = len(lefts)
    inputs = [
        (part.left, (product.left_arrival, dict(enumerate(lefts)))),
        (part.right, (product.right_arrival, dict(enumerate(rights)))),
    ]
    outputs = {
        i: (getattr(part, f"term{i}"), addend.arrival, range(count))
        for i, addend in enumerate(product.addends)
    }
    clocks = count + max(c for addend in product.addends for _, c in addend.arrival) + 1
    seen = stream(part, inputs, outputs, clocks)
    assert all(seen[i][t] in a.range for i, a in enumerate(product.addends) for t in range(count))
    return [
        sum(seen[i][t] << addend.low for i, addend in enumerate(product.addends))
        for t in range(count)
    ]


def test_product_of_every_pair_of_small_words():
    left, right = Interval.signed(5), Interval.signed(4)
    pairs = list(itertools.product(range(left.lo, left.hi + 1), range(right.lo, right.hi + 1)))
    product = MultiplierPlan(TARGETS["generic"], left, right, at_once(5), at_once(4))
    assert (product.block_count, product.rows) == (1, 0)
    lefts, rights = zip(*pairs, strict=True)
    assert products_seen(product, lefts, rights) == [a * b for a, b in pairs]


@pytest.mark.parametrize(
    ("target", "bits", "tiles", "rows"),
    [
        ("generic", (18, 18), 1, 0),
        ("ecp5", (33, 24), 2, 6),  # 24 = 6 + 18, 33 = 17 + 16
        ("ecp5", (26, 18), 1, 8),
        ("ecp5", (27, 18), 2, 0),
        ("ecp5", (29, 26), 2, 8),
        ("ecp5", (41, 32), 4, 6),
        ("ice40", (33, 24), 3, 8),  # 33 = 15 + 15 + 3, 24 = 8 + 16
        ("xilinx", (33, 24), 2, 0),  # 33 = 17 + 16 on the narrow side, 24 whole on the wide one
        ("generic", (90, 32), 10, 4),  # 90 = 4 + 4 * 17 + 18, 32 = 17 + 15
    ],
)
def test_product_of_wide_words(target, bits, tiles, rows):
    left, right = map(Interval.signed, bits)
    limb = Limbs(20)
    product = MultiplierPlan(
        TARGETS[target], left, right, skewed(bits[0], limb, 1), skewed(bits[1], limb)
    )
    assert (product.block_count, product.rows) == (tiles, rows)
    rng = random.Random(1)
    lefts, rights = extremes(left, rng, 80), extremes(right, rng, 80)
    assert products_seen(product, lefts, rights) == [
        a * b for a, b in zip(lefts, rights, strict=True)
    ]


def test_operands_are_cut_whole():
    for block in (16, 18, 25):
        for bits in range(2, 120):
            for cut in operand_splits(bits, block, 8):
                assert cut.ends[0] == cut.residue
                assert cut.ends[-1] == bits
                widths = [hi - lo for lo, hi in cut.pieces]
                assert all(width == block - 1 for width in widths[:-1])
                assert 1 <= widths[-1] <= block
    assert operand_splits(24, 18, 8) == [OperandSplit(0, (0, 17, 24)), OperandSplit(6, (6, 24))]
    assert operand_splits(24, 18, 4) == [OperandSplit(0, (0, 17, 24))]


def test_multiplier_alone_gives_the_product_when_it_says():
    """33 x 24 bits: 2 blocks and 6 rows, 8 terms; 3 + 1 clocks for a block, then the additions."""
    left, right, limb = Interval.signed(33), Interval.signed(24), Limbs(64)
    plan = MultiplierPlan(TARGETS["ecp5"], left, right, at_once(33), at_once(24))
    part = Multiplier(plan, limb, primitive=False)
    # the rows, there at clock 1, are added up while the blocks work: 2 blocks and a sum are left
    assert part.arrival == ((57, 4 + 2),)
    rng = random.Random(9)
    lefts, rights = extremes(left, rng, 60), extremes(right, rng, 60)
    inputs = [
        (part.left, (plan.left_arrival, dict(enumerate(lefts)))),
        (part.right, (plan.right_arrival, dict(enumerate(rights)))),
    ]
    seen = stream(part, inputs, {"product": (part.output, part.arrival, range(60))}, 70)
    assert list(seen["product"].values()) == [a * b for a, b in zip(lefts, rights, strict=True)]


@pytest.mark.parametrize("inverted", [False, True])
def test_delays_give_what_was_so_many_clocks_before(inverted):
    """A flag and a skewed word, each seen at several clocks; a slice, its sign, zeros below."""
    m, flag, word = Module(), Signal(), Signal(9)
    line = ControlDelay(m, "flag", flag, 2, inverted=inverted)
    skewed_word = SkewedSignal(m, "word", word, ((4, 0), (5, 1)), low=3)
    flags = {clock: line.at_clock(clock) for clock in (5, 2, 3)}
    shown = Signal(16)
    m.d.comb += shown.eq(skewed_word.slice_at(1, 17, 3))
    rng, seen = random.Random(10), []
    given = [(rng.getrandbits(1), rng.getrandbits(9)) for _ in range(60)]

    async def bench(ctx):
        for high, bits in given:
            ctx.set(flag, high)
            ctx.set(word, bits)
            _, _, *now = await ctx.tick().sample(*flags.values(), shown)
            seen.append(now)

    drive(m, bench)
    for now in range(3, 60):
        *at_clocks, value = seen[now]
        assert [value & 1 for value in at_clocks] == [given[now - clock + 2][0] for clock in flags]
        whole = (given[now - 3][1] & 0xF) | (given[now - 2][1] & 0x1F0)
        signed = whole - (whole >> 8 << 9)
        assert value == (signed << 2) & 0xFFFF


def test_delays_are_refused_inside_a_conditional():
    """There a register would move only where the condition holds."""
    m, flag, word = Module(), Signal(), Signal(8)
    line = ControlDelay(m, "flag", flag)
    kept = SkewedSignal(m, "word", word, at_once(8))
    made = line.at_clock(1)
    with m.If(flag):
        assert line.at_clock(1) is made  # nothing is emitted
        kept.slice_at(0, 8, 0)
        with pytest.raises(RuntimeError, match="flag: delayed inside"):
            line.at_clock(2)
        with pytest.raises(RuntimeError, match="word: delayed inside"):
            kept.slice_at(0, 8, 1)
    with m.Switch(word), m.Case(1), pytest.raises(RuntimeError, match="flag: delayed inside"):
        line.at_clock(2)
    with pytest.raises(ValueError, match="2 clocks too late"):
        kept.slice_at(0, 8, -2)
    line.at_clock(2)
    kept.slice_at(0, 8, 1)
    Fragment.get(m, None)  # Amaranth warns of a module that is never used


ROWS = {
    "one term": {1: [(1, 1)]},
    "negative": {0: [(0, -3)]},
    "minus one": {0: [(1, -1)]},
    "compressed": {3: [(1, 214), (2, 92), (3, 54)]},
    "weights": {3: [(0, 1), (1, 1), (2, 1), (3, 1)]},
    "dense": {1: [(1, 57)], 2: [(1, 57), (2, 33)]},
    # sums that look alike, of samples that are taken up in different phases
    "alike": {0: [(1, 3)], 2: [(2, 3)]},
    "mixed signs": {0: [(1, -5), (2, 7)], 1: [(1, 5), (3, -7)], 2: [(2, -1)], 3: []},
}


@pytest.mark.parametrize("limb", [Limbs(7), Limbs(7, 2), Limbs(64)], ids=str)
@pytest.mark.parametrize("rows", ROWS.values(), ids=ROWS)
def test_weighted_sum(rows, limb):
    counts, phases = Interval.signed(9), 4
    totals = [sum((counts.scaled(c) for _, c in row), Interval(0, 0)) for row in rows.values()]
    result = Interval(min(t.lo for t in totals), max(t.hi for t in totals))
    plan = WeightedSumPlan(counts, rows, result, phases, limb)
    part = WeightedSum(plan)
    rng = random.Random(3)
    samples = [extremes(counts, rng, 3) for _ in range(160)]
    taken = sorted(rng.sample(range(1, 301), len(samples)))  # clocks, some one after another
    phase_of = {clock: i % phases for i, clock in enumerate(taken)}
    inputs = [(part.phase, (at_once(2, -1), phase_of))]
    for axis in range(3):
        values = {clock: sample[axis] for clock, sample in zip(taken, samples, strict=True)}
        inputs.append((part.samples[axis], (at_once(counts.bits), values)))
    shown = [clock for clock in taken if phase_of[clock] in rows]
    outputs = {axis: (part.output[axis], plan.arrival, shown) for axis in range(3)}
    seen = stream(part, inputs, outputs, 340, [(part.step, set(taken))])

    def weighted(i, axis):
        row = rows[i % phases]
        return sum(c * (samples[i - d][axis] if i >= d else 0) for d, c in row)

    for axis in range(3):
        assert seen[axis] == {
            clock: weighted(i, axis) for i, clock in enumerate(taken) if i % phases in rows
        }


@pytest.mark.parametrize("limb", [Limbs(4), Limbs(7, 2), Limbs(64)], ids=str)
@pytest.mark.parametrize("samples", [1, 2, 5])
def test_running_sum(samples, limb):
    """Each sum of so many samples, although the total behind it wraps many times."""
    counts = Interval.signed(9)
    plan = RunningSumPlan(counts, counts.repeated(samples), limb)
    part = RunningSum(plan)
    rng = random.Random(4)
    values = [-256] * 40 + extremes(counts, rng, 160)  # the lowest sum there is, again and again
    taken = sorted(rng.sample(range(350), len(values)))  # clocks, some one after another
    ends = taken[samples - 1 :: samples]
    inputs = [(part.sample, (at_once(9), dict(zip(taken, values, strict=True))))]
    flags = [(part.step, set(taken)), (part.last, set(ends))]
    outputs = {"sum": (part.output, plan.arrival, ends)}
    seen = stream(part, inputs, outputs, 400, flags)["sum"]
    assert (
        list(seen.values())
        == [sum(values[i : i + samples]) for i in range(0, len(values), samples)][: len(ends)]
    )


def test_weighted_sum_is_there_when_its_largest_coefficient_is():
    """54, 92, 214 have 3, 3 and 4 signed digits: two levels, whatever the number of samples."""
    assert len(terms_of(ROWS["compressed"])) == 10
    plan = WeightedSumPlan(
        Interval.signed(8), ROWS["compressed"], Interval.signed(20), 4, Limbs(64)
    )
    assert plan.arrival == ((20, 2),)
    # the newest sample's product joins in at clock 0
    plan = WeightedSumPlan(Interval.signed(8), ROWS["weights"], Interval.signed(10), 4, Limbs(64))
    assert plan.arrival == ((10, 1),)


@pytest.mark.parametrize("limb", [Limbs(4), Limbs(4, 2), Limbs(64)], ids=str)
@pytest.mark.parametrize(("sums", "signs"), [(1, False), (3, False), (1, True), (3, True)])
@pytest.mark.parametrize(("cleared", "apart"), [(False, False), (True, False), (True, True)])
def test_accumulator(sums, signs, cleared, apart, limb):
    item = Interval.signed(9)
    arrival, total = skewed(9, limb, 2), item.repeated(5)
    plan = AccumulatorPlan(
        item, arrival, total, limb, sums=sums, signs=signs, cleared=cleared, apart=apart
    )
    assert plan.cleared == (cleared and sums == 1)  # the others look at a flag
    assert plan.apart == (apart and sums == 1)
    part = Accumulator(plan)
    rng = random.Random(4)
    steps, last, carry, values, after = set(), set(), set(), {}, {}
    totals, clock = [0] * sums, 0
    for launch in range(60):
        for i in range(sums):
            value, minus = extremes(item, rng, 1)[0], signs and rng.random() < 0.5
            values[clock] = ~value if minus else value
            steps.add(clock + plan.clock)
            if minus:
                carry.add(clock + plan.clock)
            totals[i] += -value if minus else value
            after[clock] = totals[i]
            if launch % 5 == 4:
                last.add(clock + plan.clock)
                totals[i] = 0
            clock += 1
        clock += rng.choice([0, 0, 1, 3])
    flags = [(part.step, steps), (part.last, last), (part.carry, carry)]
    inputs = [(part.input, (plan.item_arrival, values))]
    outputs = {"newest": (part.newest, plan.arrival, after)}
    assert stream(part, inputs, outputs, clock + 20, flags)["newest"] == after


@pytest.mark.parametrize("apart", [False, True])
@pytest.mark.parametrize(
    ("gap", "cleared"), [(1, False), (1, True), (2, True), (3, True), (4, True)]
)
def test_accumulator_shows_the_sum_before(gap, cleared, apart):
    item = Interval(-10, 10)
    plan = AccumulatorPlan(
        item,
        at_once(item.bits),
        item.repeated(5),
        Limbs(3),
        item.repeated(4),
        gap=gap,
        cleared=cleared,
        apart=apart,
    )
    part = Accumulator(plan)
    steps = range(0, 30 * gap, gap)
    values = {t: (7 * t) % 21 - 10 for t in steps}
    before = {t: sum(values[i] for i in steps if t - t % (5 * gap) <= i < t) for t in steps}
    flags = [
        (signal, {t + plan.clock for t in at})
        for signal, at in ((part.step, steps), (part.last, steps[4::5]))
    ]
    outputs = {"before": (part.before, plan.before_arrival, steps)}
    inputs = [(part.input, (plan.item_arrival, values))]
    assert stream(part, inputs, outputs, 30 * gap + 10, flags)["before"] == before


OPERANDS = [
    # widths of left0, left1, right0, right1; limb; target
    pytest.param((33, 33, 24, 24), Limbs(20), "ecp5", marks=pytest.mark.deep),
    ((28, 20, 25, 17), Limbs(20, 2), "ecp5"),
    ((12, 40, 9, 33), Limbs(16), "ice40"),
    ((9, 8, 8, 9), Limbs(64), "generic"),
]


@pytest.mark.parametrize("folding", FOLDINGS, ids=lambda s: f"{s.steps} steps")
@pytest.mark.parametrize(("bits", "limb", "target"), OPERANDS)
@pytest.mark.parametrize(
    ("lead", "inverted", "spread"),
    [(0, False, True), pytest.param(3, True, False, marks=pytest.mark.deep)],
)
def test_cross_array(folding, bits, limb, target, lead, inverted, spread):
    """Launches as close as they may be, a total restarted after every third."""
    ranges = [Interval.signed(width) for width in bits]
    left0, left1, right0, right1 = (
        Operand(span, skewed(width, limb) if i < 2 else at_once(width, i % 2))
        for i, (span, width) in enumerate(zip(ranges, bits, strict=True))
    )

    def span(left, right):
        return (left.range * right.range - left.range * right.range).repeated(3)

    totals = (span(left0, right0), span(left0, right1) + span(left1, right0))
    plan = CrossArrayPlan(
        (left0, left1), (right0, right1), totals, folding, TARGETS[target], limb, 8, spread=spread
    )
    part = CrossArray(plan, lead, primitive=False, inverted=inverted)
    rng = random.Random(5)
    launches = [lead + i * folding.steps for i in range(9)]
    items = {t: [extremes(span, rng, 3) for span in ranges] for t in launches}
    inputs = [
        (getattr(part, name)[axis], (operand.arrival, {t: v[i][axis] for t, v in items.items()}))
        for i, (name, operand) in enumerate(plan.operands.items())
        for axis in range(3)
    ]
    ends = launches[2::3]
    outputs = {
        (name, axis): (getattr(part, name)[lane], arrival, ends)
        for name, components in plan.results.items()
        for axis, (lane, arrival) in enumerate(components)
    }
    flags = [(part.launch, {t - lead for t in launches}), (part.last, {t - lead for t in ends})]
    seen = stream(part, inputs, outputs, launches[-1] + 60, flags)
    for end in ends:
        three = [items[end - back * folding.steps] for back in range(3)]
        coning = [cross(a, s) for a, _, s, _ in three]
        sculling = [cross(a, r) for a, _, _, r in three] + [cross(b, s) for _, b, s, _ in three]
        for name, vectors in (("coning", coning), ("sculling", sculling)):
            for axis in range(3):
                assert seen[name, axis][end] == sum(vector[axis] for vector in vectors)


def test_a_launch_after_a_reset_is_not_moved_by_the_one_before():
    """A launch, a reset in the clock after it, the next launch in the clock after that."""
    ranges = [Interval.signed(33), Interval.signed(40)]
    left, right = (Operand(item, at_once(item.bits)) for item in ranges)
    total = (ranges[0] * ranges[1] - ranges[0] * ranges[1]).repeated(2)
    plan = CrossArrayPlan(
        (left, left),
        (right, right),
        (total, total),
        Folding(sides=2, axes=3),
        TARGETS["ice40"],
        Limbs(64),
        0,
    )
    assert plan.copied
    part, reset = CrossArray(plan, primitive=False), Signal()
    rng = random.Random(6)
    items = {
        t: {name: extremes(o.range, rng, 3) for name, o in plan.operands.items()} for t in (0, 2)
    }
    inputs = [
        (getattr(part, name)[axis], (operand.arrival, {t: v[name][axis] for t, v in items.items()}))
        for name, operand in plan.operands.items()
        for axis in range(3)
    ]
    outputs = {
        (name, axis): (getattr(part, name)[lane], arrival, {2})
        for name, components in plan.results.items()
        for axis, (lane, arrival) in enumerate(components)
    }
    flags = [(part.launch, {0, 2}), (part.last, {2}), (reset, {1})]
    seen = stream(ResetInserter(reset)(part), inputs, outputs, 60, flags)
    a, b, s, r = (items[2][name] for name in ("left0", "left1", "right0", "right1"))
    wanted = {
        "coning": cross(a, s),
        "sculling": [one + two for one, two in zip(cross(a, r), cross(b, s), strict=True)],
    }
    assert {key: seen[key][2] for key in seen} == {
        (name, axis): three[axis] for name, three in wanted.items() for axis in range(3)
    }


def small_words():
    return word_lengths(8, 8, 1, DESIGNS["taylor_2p0"].table)


def arrivals_of(words):
    """Every vector arrives in its own clocks, in limbs of 7 bits."""
    return {
        name: [skewed(getattr(words, name).bits, Limbs(7), 3 + i + axis) for axis in range(3)]
        for i, name in enumerate(VECTORS)
    }


def result_of(words, rng):
    return {name: extremes(getattr(words, name), rng, 3) for name in VECTORS}


def test_handover_keeps_each_result_until_it_is_taken():
    words, rng = small_words(), random.Random(6)
    arrivals = arrivals_of(words)
    part = HandOver(HandOverPlan(words, arrivals, 2))
    complete = max(c for three in arrivals.values() for one in three for _, c in one)
    assert part.plan.complete == complete
    results = [result_of(words, rng) for _ in range(3)]
    starts = [10, 60, 110]
    log = []

    async def bench(ctx):
        for now in range(160):
            for name in VECTORS:
                for axis in range(3):
                    shown = rng.getrandbits(8)
                    for lo, hi, clock in spans(arrivals[name][axis]):
                        if now - clock in starts:
                            mask = (1 << hi) - (1 << lo)
                            value = results[starts.index(now - clock)][name][axis]
                            shown = (shown & ~mask) | (value & mask)
                    ctx.set(part.input[name][axis], shown)
            ctx.set(part.major_end, int(now - 2 in starts))
            ctx.set(part.status, starts.index(now - 3) + 1 if now - 3 in starts else 0)
            ctx.set(part.ready, int(now % 50 == 45))
            _, _, *shown = await ctx.tick().sample(
                part.valid,
                part.taken,
                part.shown_major,
                part.shown_status,
                *(part.output[name][axis] for name in VECTORS for axis in range(3)),
            )
            log.append(shown)

    drive(part, bench)
    expected = None
    for now, (valid, taken, *shown) in enumerate(log):
        for i, start in enumerate(starts):
            if now == start + complete + 1:
                row = [value for name in VECTORS for value in results[i][name]]
                expected = (i, i + 1, *row)
        waiting = any(start + complete < now <= start // 50 * 50 + 45 for start in starts)
        assert valid == waiting
        assert taken == (waiting and now % 50 == 45)
        assert not valid or tuple(shown) == expected


@pytest.mark.parametrize("chance", [1.0, 0.4])
@pytest.mark.parametrize("moved_together", [stream_module.PART, 3])
def test_stream_handover_gives_the_words(moved_together, chance, monkeypatch):
    monkeypatch.setattr(stream_module, "PART", moved_together)
    design = DESIGNS["taylor_2p0"]
    words, rng = design.words, random.Random(8)
    arrivals = arrivals_of(words)
    columns = words_per_column(design)
    part = StreamHandOver(HandOverPlan(words, arrivals, 2, column_words=columns))
    results = [result_of(words, rng) for _ in range(3)]
    taken_words, gaps = [], 0

    async def bench(ctx):
        nonlocal gaps
        for i, result in enumerate(results):
            ctx.set(part.ready, 0)
            for now in range(40):
                for name in VECTORS:
                    for axis in range(3):
                        shown = rng.getrandbits(8)
                        for lo, hi, clock in spans(arrivals[name][axis]):
                            if now == clock:
                                mask = (1 << hi) - (1 << lo)
                                shown = (shown & ~mask) | (result[name][axis] & mask)
                        ctx.set(part.input[name][axis], shown)
                ctx.set(part.major_end, int(now == 2))
                ctx.set(part.status, i + 1 if now == 3 else 0)
                _, _, valid = await ctx.tick().sample(part.valid)
                assert valid == (now > part.plan.complete)
            count, done = 0, 0
            while not done:
                ready = int(rng.random() < chance)
                ctx.set(part.ready, ready)
                _, _, valid, data, last, done = await ctx.tick().sample(
                    part.valid, part.data, part.last, part.taken
                )
                gaps += not valid
                if ready:
                    taken_words.append(data)
                    count += 1
                    assert last == done == (count == words_per_result(design))
            assert count == words_per_result(design)

    drive(part, bench)
    assert gaps == 0
    each = words_per_result(design)
    for i, result in enumerate(results):
        row = from_words(design, taken_words[i * each : (i + 1) * each])
        columns = {"major": i, "status": i + 1} | {
            f"{name}_{axis}": result[name][j] for name in VECTORS for j, axis in enumerate(AXES)
        }
        assert dict(zip(COLUMNS, row, strict=True)) == columns


def uses_the_past(design, t):
    """Does a non-zero tap or weight of sample t reach before sample 0, from the page."""
    table = design.table
    k = t % table.samples + 1
    tap = any(c and d > t for d, c in enumerate(table.taps[k - 1], start=1))
    weight = any(w and d > t for d, w in enumerate(table.weights))
    return tap or (k == table.samples and weight)


@pytest.mark.parametrize("spacing", [1, 2, 5])
@pytest.mark.parametrize("design", DESIGNS.values(), ids=DESIGNS)
def test_sequencer(design, spacing):
    """Its flags from the page; `sample_ready` low in between, and for good before a second end."""
    part = Sequencer(design, spacing)
    n, whole = design.algorithm.samples, design.samples_per_major
    flags = ("taken", "launch", "minor_end", "major_end", "phase", "first", "short", "fault")
    ready_log, log = [], []

    async def bench(ctx):
        ctx.set(part.sample_valid, 1)
        for now in range(60 * spacing):
            ctx.set(part.sample_fault, now % 2)
            ctx.set(part.result_taken, int(now < 40 * spacing))
            _, _, ready, *shown = await ctx.tick().sample(
                part.sample_ready, *(getattr(part, name) for name in flags)
            )
            ready_log.append(ready)
            log.append(shown)

    drive(part, bench)
    t, awaited, free = 0, False, 0
    for now, ready in enumerate(ready_log[:-1]):
        last = (t + 1) % whole == 0
        assert ready == (now >= free and not (last and awaited))
        if now < 40 * spacing:
            awaited = False
        if ready:
            k = t % n + 1
            launches = any(design.table.taps[k - 1]) or k == n
            assert log[now][:4] == [1, launches, k == n, last]
            assert log[now + 1][4:] == [
                k - 1,
                t % whole == 0,
                uses_the_past(design, t),
                now % 2,
            ]
            awaited |= last
            free = now + spacing
            t += 1
        else:
            assert log[now][:4] == [0, 0, 0, 0]
    assert t > design.table.history
