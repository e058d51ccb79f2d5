"""Counts of flips that are kept: taken for the same Verilog and the same flips, and no other."""

from __future__ import annotations

from pathlib import Path

import pytest

from studies.upsets import kept as module
from studies.upsets.kept import FILE, Count, Flips, Kept
from studies.upsets.shapes import MODES, hardened, places, shapes

ROOT = Path(__file__).parents[2]
SMALL = shapes("off")["8 bits, history, `generic`"]
FLIPS = Flips(1, every_bit=True, seed=1)
COUNT = Count(3, 4, 7, {"masked": 5, "silent": 2}, 1)


@pytest.fixture
def verilog(monkeypatch) -> dict[str, str]:
    """What designs are emitted as, here."""
    text = {"core.v": "module core; endmodule"}
    monkeypatch.setattr(module, "emitted", lambda design: text)
    return text


def test_the_same_is_found_again(verilog, tmp_path) -> None:
    Kept(tmp_path / "k.json").add(SMALL, FLIPS, COUNT)
    assert Kept(tmp_path / "k.json").find(SMALL, FLIPS) == COUNT


@pytest.mark.parametrize(
    "other",
    [Flips(2, every_bit=True, seed=1), Flips(1, every_bit=False, seed=1), Flips(1, True, 2)],
)
def test_other_flips_are_not(other, verilog, tmp_path) -> None:
    kept = Kept(tmp_path / "k.json")
    kept.add(SMALL, FLIPS, COUNT)
    assert kept.find(SMALL, other) is None
    assert kept.find(hardened(SMALL, "detect"), FLIPS) is None
    kept.add(SMALL, other, COUNT)
    assert kept.find(SMALL, FLIPS) == COUNT


def test_another_verilog_takes_the_place_of_the_one_before(verilog, tmp_path) -> None:
    kept = Kept(tmp_path / "k.json")
    kept.add(SMALL, FLIPS, COUNT)
    before = dict(verilog)
    verilog["core.v"] = "module core; wire w; endmodule"
    assert kept.find(SMALL, FLIPS) is None
    later = Count(3, 4, 7, {"masked": 7}, 0)
    kept.add(SMALL, FLIPS, later)
    assert Kept(tmp_path / "k.json").find(SMALL, FLIPS) == later
    verilog.update(before)
    assert kept.find(SMALL, FLIPS) is None


def test_what_is_placed_is_a_plain_core_for_the_device_that_can_be_hardened() -> None:
    for one in places():
        assert one.design.hardware.hardening is None
        assert {hardened(one.design, mode).hardware.hardening or "off" for mode in MODES} == {
            *MODES
        }
        assert one.fits[0] == "off"


@pytest.mark.deep
@pytest.mark.parametrize("mode", MODES)
def test_the_page_is_of_the_verilog_that_is_generated(mode, monkeypatch) -> None:
    """Where this fails, run `make upsets`: it turns over the bits of this core again."""
    kept = Kept(ROOT / FILE)
    unknown = [what for what, one in shapes(mode).items() if kept.find(one, FLIPS) is None]
    assert unknown == []
