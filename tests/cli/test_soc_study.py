"""`python -m studies.soc`."""

from __future__ import annotations

import re
from pathlib import Path

from sculler.soc import check_soc
from studies.soc.command import PAGE
from studies.soc.designs import DESIGN, ORDER_FOUR, SLOW, TOO_SLOW, spi_design
from studies.soc.page import PICTURE
from studies.soc.place import DEVICES

WRITTEN = Path(__file__).parents[2] / "docs" / "explanation" / PAGE


def section(heading: str) -> str:
    text = WRITTEN.read_text(encoding="utf-8")
    return text.split(f"\n## {heading}\n")[1].split("\n## ")[0]


def test_the_page_is_the_commands() -> None:
    assert "python -m studies.soc" in WRITTEN.read_text(encoding="utf-8")
    assert (WRITTEN.parents[1] / "images" / PICTURE).is_file()
    assert all(f"\n| {device}-" in section("In real parts") for device in DEVICES)
    assert section("More flights").count("\n| ") >= 7
    for design in (DESIGN, SLOW, ORDER_FOUR, TOO_SLOW, spi_design("adis16505")):
        check_soc(design)


def test_the_page_on_time_has_the_times_measured() -> None:
    rows = re.findall(r"^\| [a-z].*\|$", section("Times"), re.MULTILINE)
    assert len(rows) == 6
    text = (WRITTEN.parent / "time.md").read_text(encoding="utf-8")
    for row in rows[1:]:
        assert row in text
