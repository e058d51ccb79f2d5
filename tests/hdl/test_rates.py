"""The clock rate to count on: the table is that of the page, and no figure comes from elsewhere."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from sculler_hdl import Placed, expected_rate, generate, kind_of, placed_designs
from sculler_hdl.rates import Kind, rate_of
from sculler_model.design import Design
from studies.hardware import counted_on
from studies.hardware.classes import classes
from studies.hardware.points import points

PAGE = Path(__file__).parents[2] / "docs" / "explanation" / "hardware.md"


def cells(heading: str) -> list[list[str]]:
    """The rows of the first table below a heading of the page."""
    text = PAGE.read_text(encoding="utf-8").partition(f"## {heading}\n")[2]
    table = re.search(r"(?:^\|.*\n)+", text, re.MULTILINE)
    assert table
    rows = [line.strip("| ").split(" | ") for line in table[0].splitlines()]
    return rows[2:]


def test_the_table_has_the_figures_of_the_page() -> None:
    untuned = [(row[1], row[2], tuple(map(float, row[3:6]))) for row in cells("Rates that hold")]
    tuned = []
    for what, device, rates, *_ in cells("Designs and devices"):
        if rates != "-":
            median, slowest, fastest = map(float, re.findall(r"[\d.]+\d", rates))
            tuned.append((what, device, (slowest, median, fastest)))
    for found, is_tuned in ((untuned, False), (tuned, True)):
        kept = [one for one in placed_designs() if one.tuned == is_tuned]
        assert [(one.what, one.device, one.mhz) for one in kept] == found


def test_the_page_says_what_the_table_gives() -> None:
    text = PAGE.read_text(encoding="utf-8")
    assert "\n".join(counted_on.section(placed_designs())) in text
    for one in placed_designs():  # the tool that the page names
        assert "{} {}".format(*one.tool.split()) in text.replace("\n", " ")


def test_kinds_in_the_table_are_those_of_the_studys_designs() -> None:
    every = [*points(), *(point for group in classes() for point in group.points)]
    designs = {point.key: point.design for point in every}
    for one in placed_designs():
        assert one.kind == kind_of(designs[one.key]), one.key


def placed(kind: Kind, *mhz: float, **others: Any) -> Placed:
    """A design that was placed."""
    values = {"key": "k", "what": "a design", "device": "D", "tuned": False, "tool": "t 1"}
    return Placed(**values | {"kind": kind, "mhz": mhz} | others)


WIDE = Kind("pipelined", "ecp5", 20)


def test_the_worst_of_a_class_by_its_median() -> None:
    rows = [
        placed(WIDE, 100.0, 210.0, 300.0, what="other"),
        placed(replace(WIDE, bits=24), 190.0, 200.0, 201.0, what="worst"),
        placed(replace(WIDE, bits=24), 1.0, 2.0, 3.0, tuned=True),
        placed(replace(WIDE, bits=18), 1.0, 2.0, 3.0),
        placed(replace(WIDE, bits=25), 1.0, 2.0, 3.0),
        placed(replace(WIDE, target="ice40"), 1.0, 2.0, 3.0),
        placed(replace(WIDE, core="compact"), 1.0, 2.0, 3.0),
        placed(replace(WIDE, further=("dense table",)), 1.0, 2.0, 3.0),
    ]
    found = rate_of(replace(WIDE, bits=19), rows)
    assert found.mhz == 200.0
    assert found.basis == (
        "the worst of 2 placed designs of its class (pipelined, 19 to 24 bits; ecp5): worst, median"
        " of 3 seeds, the slowest 190.0 MHz, D, t 1"
    )


def test_the_compact_core_is_one_class_of_all_widths() -> None:
    compact = Kind("compact", "ice40", 32)
    assert rate_of(compact, [placed(replace(compact, bits=8), 50.0)]).mhz == 50.0


def test_what_was_not_placed_has_no_figure_but_a_neighbour() -> None:
    rows = [
        placed(replace(WIDE, bits=18), 300.0, what="narrow"),
        placed(WIDE, 250.0, what="tuned", tuned=True),
        placed(replace(WIDE, further=("dense table",)), 240.0, what="dense"),
    ]
    found = rate_of(WIDE, rows)
    assert found.mhz is None
    assert found.basis == (
        "not placed: no design of its class (pipelined, 19 to 24 bits; ecp5) was;"
        " the nearest is tuned, 250.0 MHz, D"
    )
    dense = replace(WIDE, bits=32, further=("dense table", "order 3"))
    assert "the nearest is dense" in rate_of(dense, rows).basis
    other = rate_of(Kind("compact", "gowin", 16), rows)
    assert (other.mhz, other.basis) == (
        None,
        "not placed: no compact core with target gowin was",
    )


@pytest.mark.parametrize(
    ("algorithm", "hardware", "further"),
    [
        ({}, {}, ()),
        ({"family": "time-taylor"}, {}, ("dense table",)),
        ({"family": "time-taylor"}, {"core": "compact"}, ()),
        ({"position": "high-resolution"}, {}, ("high-resolution position",)),
        ({"order": 4}, {"core": "compact"}, ("order 4",)),
        ({}, {"core": "compact", "multipliers": 0}, ("no multiplier",)),
        ({}, {"core": "compact", "multipliers": 1}, ()),
        ({}, {"multipliers": 28}, ("limited multipliers",)),
        ({}, {"handover": "stream"}, ("a stream",)),
        ({}, {"overrun": "drop-result"}, ("dropped results",)),
        ({}, {"core": "compact", "channels": 4}, ("channels",)),
        ({}, {"hardening": "detect"}, ("hardening detect",)),
        ({}, {"clock_enable": True, "reset": "async"}, ("a clock enable", "an asynchronous reset")),
    ],
)
def test_what_sets_a_design_apart(
    algorithm: dict[str, Any], hardware: dict[str, Any], further: tuple[str, ...]
) -> None:
    data = {
        "name": "apart",
        "preset": "stim300",
        "algorithm": {"samples": 4, "history": 0, "minors": 5, **algorithm},
        "hardware": {"target": "ecp5", **hardware},
    }
    found = kind_of(Design.parse(data))
    assert found == Kind(hardware.get("core", "pipelined"), "ecp5", 24, further)


def test_the_manifest_has_it() -> None:
    hardware = {"core": "compact", "target": "ecp5"}
    design = Design.parse({"preset": "stim300", "hardware": hardware})
    told = generate(design).manifest.as_json()["expected_rate"]
    expected = expected_rate(design)
    assert told == {"mhz": expected.mhz, "basis": expected.basis}
    assert expected.mhz == min(
        one.median
        for one in placed_designs()
        if one.kind.core == "compact"
        and not one.tuned
        and one.kind.target == "ecp5"
        and not one.kind.further
    )
    plain = generate(Design.preset("stim300")).manifest.as_json()["expected_rate"]
    assert plain == {
        "mhz": None,
        "basis": "not placed: no pipelined core with target generic was",
    }
