"""The figures of docs/explanation/core-inside.md are those of the plans."""

import re
from pathlib import Path

from sculler_hdl.plan.compact.plan import plan_compact
from sculler_hdl.plan.pipelined import plan_pipelined
from sculler_model.design import Design
from strategies import with_hardware

PAGE = (Path(__file__).parents[2] / "docs/explanation/core-inside.md").read_text(encoding="utf-8")
DEFAULT = Design.preset("stim300")


def clock_of(words, page=PAGE):
    """The first column of the one row of a table that has these words."""
    (row,) = [line for line in page.splitlines() if line.startswith("|") and words in line]
    return [int(number) for number in re.findall(r"\d+", row.split("|")[1])]


def first(arrival):
    return arrival[0][1]


def test_the_walk_through_the_pipelined_core():
    schedule = plan_pipelined(DEFAULT).schedule
    within, between = schedule.launches["within"], schedule.launches["between"]
    assert clock_of("A and B are there") == [within]
    assert clock_of("theta and v are there") == [between]
    assert clock_of("of the within array are held") == [
        within + first(schedule.arrays["within"].seen["left0"].arrival)
    ]
    assert clock_of("those of the between array are") == [
        between + first(schedule.arrays["between"].seen["left0"].arrival)
    ]
    assert clock_of("alpha and nu are complete") == [first(schedule.integrals["nu"].arrival)]
    (*blocks,) = {first(one.arrival) for one in schedule.arrays["within"].multipliers[0].addends}
    assert clock_of("come to the adders") == [within + first([(0, blocks[0])])]
    assert clock_of("leave the blocks") == [within + blocks[0] - 1]
    assert clock_of("the sum of 8 terms") == [
        within + first(schedule.arrays["within"].sums["coning"].arrival)
    ]
    assert clock_of("coning_within is complete on x") == [
        first(schedule.arrivals["coning_within"][0])
    ]
    assert clock_of("the last bits of the result") == [schedule.handover().complete]
    assert clock_of("HandOver`; `Timing.latency`") == [plan_pipelined(DEFAULT).timing.latency]
    latency = plan_pipelined(with_hardware(DEFAULT, target="ecp5")).timing.latency
    assert f"the latency is {latency} clocks" in PAGE


def test_the_walk_through_the_compact_core():
    plan = plan_compact(with_hardware(DEFAULT, core="compact", target="ecp5"))
    assert clock_of("digits are written") == [1, plan.sizes.sample_words]
    assert clock_of("the engine starts") == [plan.sizes.sample_words + 1]
    assert f"every clock, {plan.resources['instructions']} in all" in PAGE
    assert clock_of("may have been taken") == [plan.timing.work[3]]
    assert clock_of("the bank is shown") == [plan.timing.latency - plan.timing.handover_spacing]
    assert clock_of("with the first word") == [plan.timing.latency]
    delays = plan.pipeline
    assert clock_of("digit arrive") == [delays.operand]
    assert clock_of("product arrives") == [delays.addend]
    assert clock_of("it is added") == [delays.accumulate]
    assert clock_of("low digit is written") == [delays.store]


def test_every_name_of_the_page_is_a_name_of_the_code():
    top = Path(__file__).parents[2]
    package = top / "hdl" / "sculler_hdl"
    names = set()
    for file in package.rglob("*.py"):
        names |= {file.name, *re.findall(r"\w+", file.read_text(encoding="utf-8"))}
    names |= {folder.name for folder in package.iterdir()}
    prose = re.sub(r"```.*?```", "", PAGE, flags=re.S)
    for name in re.findall(r"`([\w./]+?)(?:\(.*?\))?`", prose):
        if "/" in name:
            assert any((place / name).exists() for place in (top, package)), name
        else:
            parts = [name] if name.endswith(".py") else name.split(".")
            assert names.issuperset(parts), name
