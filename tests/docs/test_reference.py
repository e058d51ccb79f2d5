"""Tables of docs/reference that are written by hand name what the program has, all of it."""

from __future__ import annotations

import json
import re
from fnmatch import fnmatch
from pathlib import Path

import pytest

from sculler.formats import gravity, history, log, truth_columns
from sculler_hdl import generate
from sculler_model import design as design_room
from sculler_model.analysis.flight import PROFILE_COLUMNS
from sculler_model.analysis.vibration import SPECTRUM_COLUMNS
from sculler_model.design import COLUMNS, FOURTH_ORDER_COLUMNS, HIGH_RESOLUTION_COLUMNS, Design

REFERENCE = Path(__file__).parents[2] / "docs" / "reference"


def first_column(page: str, after: str = "") -> list[str]:
    """The words in `code` of the first column of a page's tables, patterns among them whole."""
    text = (REFERENCE / page).read_text(encoding="utf-8")
    rows = re.findall(r"^\| (?!---)([^|]*)\|", text[text.index(after) :], re.MULTILINE)
    words: list[str] = []
    for row in rows:
        for word in re.findall(r"`([^`]+)`", row):
            # `alpha_x`, `_y`, `_z`
            words.append(words[-1][: -len(word)] + word if word.startswith("_") else word)
    return words


@pytest.mark.parametrize(
    ("page", "columns", "besides"),
    [
        ("imu-log.md", [*log.COUNTS, *log.OPTIONAL, *log.OF_CHANNELS], []),
        (
            "vectors.md",
            [*HIGH_RESOLUTION_COLUMNS, *FOURTH_ORDER_COLUMNS[len(COLUMNS) :]],
            ["channel", "time_s"],
        ),
        ("navigation-output.md", [*history.HEADER.split(","), history.WANDER], []),
        ("truth-files.md", sorted(truth_columns.KNOWN), []),
        (
            "small-files.md",
            [*gravity.COLUMNS, *SPECTRUM_COLUMNS, *PROFILE_COLUMNS],
            ["gain", "phase_deg"],
        ),
    ],
)
def test_columns_of_files(page: str, columns: list[str], besides: list[str]) -> None:
    said = first_column(page)
    for column in columns:
        assert any(fnmatch(column, word) for word in said), column
    for word in said:
        assert any(fnmatch(column, word) for column in [*columns, *besides]), word


def test_status_bits() -> None:
    text = (REFERENCE / "status-bits.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (\d+) \| (\d+) \| `(\w+)` \|", text, re.MULTILINE)
    assert len(rows) == design_room.STATUS_BITS + 1  # hardened cores have one more
    for bit, value, name in rows:
        assert getattr(design_room, name) == int(value) == 1 << int(bit)


def test_the_manifest_has_the_keys_that_its_page_names() -> None:
    manifest = json.loads(json.dumps(generate(Design.preset("stim300")).manifest.as_json()))
    assert {key for key in first_column("manifest.md") if key in manifest} == set(manifest)
