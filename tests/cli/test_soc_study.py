"""`python -m studies.soc`."""

from __future__ import annotations

from pathlib import Path

from sculler.soc import check_soc
from studies.soc.command import PAGE
from studies.soc.designs import DESIGN
from studies.soc.page import PICTURE

WRITTEN = Path(__file__).parents[2] / "docs" / "explanation" / PAGE


def test_the_page_is_the_commands() -> None:
    text = WRITTEN.read_text(encoding="utf-8")
    assert "python -m studies.soc" in text
    assert "| LFE5U-25F-6 |" in text
    assert (WRITTEN.parents[1] / "images" / PICTURE).is_file()
    check_soc(DESIGN)
