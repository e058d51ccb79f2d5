"""The pipelined core as a whole: its plan against counts by hand, its ports clock by clock."""

import random
import re

import pytest
from amaranth.hdl import ClockDomain, Module

from amaranth_runs import drive
from bench_files import modules_of, places
from position_designs import HIGH_RESOLUTION
from sculler_hdl import counter_ports, timing
from sculler_hdl.pipelined.core import PipelinedCore
from sculler_hdl.plan.cross_array import FOLDINGS
from sculler_hdl.plan.pipelined import LATENCY_GOAL, POSITION_LATENCY_GOAL, plan_pipelined
from sculler_hdl.plan.schedule import Schedule, launch_gap
from sculler_model.design import AXES
from sculler_model.errors import InputError
from sculler_model.golden import CycleModel, Ports, clocks_per_major, result_ports
from sculler_sim.engines.verilator_build import emitted
from strategies import DESIGNS, make_design, samples_of, with_hardware
from tiers import few_of


def test_foldings_do_all_products():
    assert [folding.steps for folding in FOLDINGS] == [1, 2, 3, 6, 9, 18]
    assert all(folding.units * folding.steps == 18 for folding in FOLDINGS)


@pytest.mark.parametrize(
    ("name", "multipliers", "spacing", "within", "between", "tiles"),
    [
        # n = 4, one row: 4 clocks for a launch, 3 steps of 6 products; 33 x 24 and 29 x 26 bits are
        # 4 blocks each, or 2 with 6 or 8 rows
        ("stim300_4x5", None, 1, 3, 3, 48),
        ("stim300_4x5", 47, 1, 3, 3, 24),
        ("stim300_4x5", 28, 1, 3, 3, 24),
        ("stim300_4x5", 24, 1, 3, 3, 24),
        # two clocks per sample: 8 clocks for a launch, 6 steps of 3 products
        ("stim300_4x5", 23, 2, 6, 6, 12),
        # three: 12 clocks, 9 steps of 2 products
        ("stim300_4x5", 11, 3, 9, 9, 8),
        # five: 20 clocks, 18 steps of 1 product
        ("stim300_4x5", 4, 5, 18, 18, 4),
        # a result every sample: nothing to share, and no between array
        ("smallest", None, 1, 1, None, 18),
        ("smallest", 1, 18, 18, None, 1),
        # rows at phases 2 and 3 of 3: one clock for a launch within, three between; products of
        # 31 x 24, 31 x 20, 27 x 24 bits and 28 x 26, 28 x 22, 24 x 26: 4 blocks each, but 2 for
        # 20 = 2 + 18
        ("dense_time_3", None, 1, 1, 3, (4 + 2 + 4) * 6 + (4 + 4 + 4) * 2),
    ],
)
def test_plan(name, multipliers, spacing, within, between, tiles):
    made = plan_pipelined(with_hardware(DESIGNS[name], multipliers=multipliers, target="ecp5"))
    assert made.timing.spacing == spacing
    assert made.configuration.within.steps == within
    assert (made.configuration.between and made.configuration.between.steps) == between
    assert made.block_count == tiles
    assert made.units == 18 // within + (18 // between if between else 0)
    assert multipliers is None or made.block_count <= multipliers


def test_too_few_multipliers_are_refused_with_one_line():
    with pytest.raises(InputError) as caught:
        plan_pipelined(with_hardware(DESIGNS["stim300_4x5"], multipliers=3))
    assert str(caught.value) == (
        "hardware.multipliers: 3 are not enough, the pipelined core of this design needs at least"
        ' 4; give more, or core = "compact"'
    )


def test_launch_gap():
    gaps = {"stim300_4x5": 4, "dense_time_3": 1, "dense_odd_3": 1, "savage_1p1": 1}
    assert {name: launch_gap(DESIGNS[name].table) for name in gaps} == gaps
    # row 1 of 3 alone: launches at phases 1 and, for the interval's end, 3
    sparse = make_design("sparse", 3, 0, 2, (8, 8), denominator=1, taps=[[1], [], []])
    assert launch_gap(sparse.table) == 1


@pytest.mark.parametrize("target", few_of(["generic", "ecp5", "ice40", "xilinx"], ["ecp5"]))
@pytest.mark.parametrize("design", DESIGNS.values(), ids=DESIGNS)
def test_every_design_takes_a_sample_a_clock(design, target):
    made = plan_pipelined(with_hardware(design, target=target))
    assert made.timing.spacing == 1
    assert made.configuration.within.steps <= launch_gap(design.table)
    assert made.timing.latency <= LATENCY_GOAL


def test_latency_by_hand():
    """STIM300, generic, no skew: the clocks one after another as the core's figure has them."""
    sample, running = 1 + 1, 2  # theta, a clock after A: a total, and what it has grown by
    held, block = 1, 3 + 1  # the block's own registers, and the way from it
    terms = 4  # sculling: 4 products of 4 blocks, 16 addends: 4 levels
    steps, accumulate, show = 2, 1, 1
    total = sample + running + held + block + terms + steps + accumulate + show
    assert timing(DESIGNS["stim300_4x5"]).latency == total


@pytest.mark.parametrize(
    ("multipliers", "spacing", "position", "tiles"),
    [
        # 24 for coning and sculling; 12 products of 42 x 24 bits, 3 blocks each with 6 rows, and 6
        # of 26 x 24, 2 blocks
        (72, 1, 1, 24 + 12 * 3 + 6 * 2),
        (48, 2, 2, 12 + (12 * 3 + 6 * 2) // 2),
        # 18 steps, one unit for all
        (7, 18, 18, 4 + 3),
    ],
)
def test_plan_with_high_resolution_position(multipliers, spacing, position, tiles):
    design = HIGH_RESOLUTION["stim300_hr"]
    hardware = {"core": "pipelined", "handover": "stream", "target": "ecp5"}
    made = plan_pipelined(with_hardware(design, **hardware, multipliers=multipliers))
    found = (made.timing.spacing, made.configuration.position.steps, made.block_count)
    assert found == (spacing, position, tiles)
    assert multipliers < 8 or made.timing.latency <= POSITION_LATENCY_GOAL


def test_room_for_a_second_result_buys_time_for_additions():
    """24 clocks to a result, 20 from one to the next: without it samples would wait."""
    design = DESIGNS["stim300_4x5"]
    found = timing(with_hardware(design, target="ecp5"))
    assert (found.results, found.latency, found.spacing) == (2, LATENCY_GOAL, 1)
    assert clocks_per_major(design, found) == design.samples_per_major == 20
    # a stream has no such room, and a family with fewer flip-flops does without
    streaming = timing(with_hardware(design, target="ecp5", handover="stream"))
    assert streaming.results == 1
    assert timing(design).results == 1


@pytest.mark.parametrize(
    "name",
    few_of(
        ["stim300_4x5", "dense_time_3", "taylor_3p3", "wide_5p0", "dense_odd_3"], ["dense_odd_3"]
    ),
)
def test_every_block_is_named_once_where_it_stands(name):
    design = with_hardware(DESIGNS[name], target="ecp5")
    plan = plan_pipelined(design)
    groups = plan.schedule.block_groups
    modules = modules_of(emitted(design)[f"{design.name}.v"])
    instances = [path for kind, path in places(design.name, modules) if kind == "MULT18X18D"]
    assert sorted(f"{block}.dsp" for group in groups for block in group) == sorted(instances)
    assert len(instances) == plan.resources["multipliers"]
    for group in groups:
        assert len({block.partition(".")[0] for block in group}) == 1


def test_blocks_of_a_long_array_are_grouped_by_total():
    """32 bits: A x r and B x s, then what the between array has, then A x s."""
    design = with_hardware(DESIGNS["wide_5p0"], target="ecp5")
    groups = plan_pipelined(design).schedule.block_groups
    found = [{re.match(r"(\w+\.unit\d)_", block)[1] for block in group} for group in groups]
    assert found == [
        {"cross_within.unit1", "cross_within.unit2"},
        {"cross_between.unit0", "cross_between.unit1", "cross_between.unit2"},
        {"cross_within.unit0"},
    ]
    assert [len(group) for group in groups] == [24, 24, 12]


def test_blocks_of_a_long_array_that_is_not_folded_are_grouped_by_axis():
    """24 bits, dense: the units of an axis together, then what the between array has."""
    design = with_hardware(DESIGNS["dense_time_3"], target="ecp5")
    schedule = plan_pipelined(design).schedule
    assert schedule.configuration.within.steps == 1
    found = [
        {re.match(r"(\w+)\.unit\d_(\w)", block).groups() for block in group}
        for group in schedule.block_groups
    ]
    assert found == [{("cross_between", "x")}, *({("cross_within", axis)} for axis in "xyz")]


def test_totals_that_work_side_by_side_have_marked_flags_of_their_own():
    design = with_hardware(DESIGNS["dense_time_3"], target="ecp5")
    text = emitted(design)[f"{design.name}.v"]
    for total in ("coning", "sculling"):
        flag = rf"\(\* keep\b[^\n]*\*\)\s*reg launch_{total}_0to0_\d+_{total}_(.);"
        assert sorted(re.findall(flag, text)) == ["x", "y", "z"]


def test_operands_are_spread_where_results_lose_no_time_by_it():
    taken = plan_pipelined(with_hardware(DESIGNS["dense_time_3"], target="ecp5"))
    assert taken.schedule.arrays["within"].spread
    assert not taken.schedule.arrays["between"].spread  # folded, its operands are held anyway
    assert taken.timing.latency <= LATENCY_GOAL
    # a major interval of 10 samples, its results as close as they may be
    short = make_design("short", 5, 0, 2, (32, 32), "uncompressed", hardware={"target": "ecp5"})
    left = plan_pipelined(short)
    other = Schedule(short, left.configuration._replace(spread=True))
    assert not left.configuration.spread
    pace = [
        clocks_per_major(short, one) for one in (left.timing, other.timing(left.timing.spacing))
    ]
    assert pace == [11, 21]


def test_no_addition_is_long_where_shorter_ones_are_as_soon_done():
    """16 bits, n = 6: A and B have 32 bits, and 24 clocks are enough for all sums in thirds."""
    design = make_design("long_taps", 6, 0, 5, (16, 16), hardware={"target": "ecp5"})
    made = plan_pipelined(design)
    assert made.schedule.taps["gyro"].result.bits == 32
    assert max(made.schedule.longest) <= 16
    assert made.timing.latency <= LATENCY_GOAL


def test_a_sum_of_every_clock_has_no_flag_that_restarts_it():
    """One sample a minor interval: what a sum goes on from is cleared instead."""
    design = with_hardware(DESIGNS["savage_1p1"], target="ecp5")
    plan = plan_pipelined(design).schedule
    assert all(part.cleared for part in plan.integrals.values())
    assert all(
        part.cleared for array in plan.arrays.values() for part in array.accumulators.values()
    )
    assert not re.search(r"reg restart", emitted(design)[f"{design.name}.v"])
    other = with_hardware(DESIGNS["stim300_4x5"], target="ecp5")
    assert re.search(r"reg restart", emitted(other)[f"{other.name}.v"])


def test_a_sum_of_every_clock_is_shown_by_an_adder_of_its_own_where_results_lose_no_time():
    """What goes round drives its own adder alone; the sum that is shown comes a clock later."""
    taken = plan_pipelined(with_hardware(DESIGNS["savage_1p1"], target="ecp5"))
    sums = [*taken.schedule.integrals.values()]
    sums += [one for array in taken.schedule.arrays.values() for one in array.accumulators.values()]
    assert all(one.apart for one in sums)
    assert taken.timing.latency <= LATENCY_GOAL
    # of three sums that take turns none goes round in a clock
    three = plan_pipelined(with_hardware(DESIGNS["stim300_4x5"], target="ecp5")).schedule
    assert not any(
        one.apart for array in three.arrays.values() for one in array.accumulators.values()
    )
    # results every 11 clocks: with a clock more there is no room for two of them
    short = make_design("short", 5, 0, 2, (32, 32), "uncompressed", hardware={"target": "ecp5"})
    left = plan_pipelined(short)
    assert not left.configuration.apart
    assert clocks_per_major(short, left.timing) == 11


VARIANTS = [
    ("stim300_4x5", {}),
    ("stim300_4x5", {"target": "ecp5"}),
    ("stim300_4x5", {"target": "ecp5", "multipliers": 11, "handover": "stream"}),
    ("taylor_2p1", {"target": "ecp5", "multipliers": 8}),
    ("dense_odd_3", {"target": "ice40", "multipliers": 12}),
    ("dense_odd_3", {"handover": "stream"}),
    ("late_sum_2", {"target": "xilinx", "multipliers": 4}),
    ("rate_1p0", {"target": "ecp5"}),
    ("smallest", {}),
    ("smallest", {"multipliers": 1, "handover": "stream"}),
    ("smallest_hr", {"handover": "stream"}),
    ("smallest_hr", {"multipliers": 2, "handover": "stream"}),
    ("taylor_2p1_hr", {"multipliers": 20, "target": "ecp5", "handover": "stream"}),
    ("sparse", {"target": "ecp5"}),
]
QUICK = ("dense_odd_3", "late_sum_2", "rate_1p0", "smallest", "smallest_hr", "sparse")


@pytest.mark.parametrize(
    ("name", "hardware"),
    [pytest.param(*v, marks=[] if v[0] in QUICK else pytest.mark.deep) for v in VARIANTS],
)
def test_ports_on_every_clock(name, hardware):
    """Against the cycle-accurate model, under stalls on both sides and a reset."""
    sparse = make_design("sparse", 3, 0, 2, (8, 8), denominator=1, taps=[[1], [], []])
    designs = {**DESIGNS, **HIGH_RESOLUTION, "sparse": sparse}
    design = with_hardware(designs[name], core="pipelined", **hardware)
    core = PipelinedCore(design, primitive=False)
    model = CycleModel(design, core.timing)
    clocks = 4 * design.samples_per_major * core.timing.spacing + 400
    rng = random.Random(1)
    counts = samples_of(design, clocks, 1)[0].tolist()
    inputs = [
        getattr(core, f"sample_{sensor}_{axis}") for sensor in ("gyro", "accel") for axis in AXES
    ]
    outputs = [core.sample_ready, core.result_valid]
    outputs += [getattr(core, f"result_{port}") for port in result_ports(design)]
    counters = [getattr(core, port.name) for port in counter_ports(design)]
    top, domain = Module(), ClockDomain("sync")
    top.domains += domain
    top.submodules.core = core
    # words, or whole results, are taken so seldom that samples have to wait
    taking = 0.5 if design.hardware.handover == "stream" else 0.02
    results = lost = 0

    async def bench(ctx):
        nonlocal results, lost
        taken, offered, fault = 0, False, 0
        for now in range(clocks):
            calm = now < clocks // 2  # first without stalls, then with
            if offered is None:
                offered = False
            elif not offered:
                offered, fault = calm or rng.random() < 0.6, int(rng.random() < 0.02)
            ready, rst = int(calm or rng.random() < taking), int(now == clocks * 2 // 3)
            sample = counts[taken]
            for port, count in zip(inputs, sample, strict=True):
                ctx.set(port, count if offered else ~count)
            ctx.set(core.sample_valid, int(offered))
            ctx.set(core.sample_fault, fault if offered else 1)
            ctx.set(core.result_ready, ready)
            ctx.set(domain.rst, rst)
            _, _, *shown = await ctx.tick().sample(*counters, *outputs)
            counted, (ready_now, valid, *result) = shown[: len(counters)], shown[len(counters) :]
            result = tuple(result) if valid else (0,) * len(result)  # they mean nothing
            item = (tuple(sample[:3]), tuple(sample[3:]), fault) if offered else None
            expected = model.clock(item, ready, rst)
            assert Ports(ready_now, valid, result, *counted) == expected, now
            results += bool(expected.result_valid and ready)
            lost += expected.samples_lost > 0
            if offered and expected.sample_ready and not rst:
                taken, offered = taken + 1, False
            elif offered and not calm and rng.random() < 0.2:
                offered = None  # withdrawn, for a clock at least

    drive(top, bench)
    assert results >= 3
    assert lost
