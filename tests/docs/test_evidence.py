"""What the page of evidence names is there, and what it says of proofs is what was found."""

from __future__ import annotations

import json
from dataclasses import replace

from studies.evidence import evidence
from studies.evidence.evidence import as_json, dangling, proved, requirements, unclaimed
from studies.evidence.page import page


def test_all_that_requirements_name_is_there():
    listed = requirements()
    assert dangling(listed) == []
    assert len({one.id for one in listed}) == len(listed) > 15
    assert all(one.tests and one.design for one in listed)


def test_what_is_not_there_is_told():
    one = replace(
        requirements()[0],
        design=("hdl/nowhere.py",),
        tests=("model/test_golden.py::test_nothing", "model/nowhere.py::test_it"),
        claims=("luck",),
        faults=("none",),
    )
    assert dangling([one]) == [
        "SUM-1: there is no hdl/nowhere.py",
        "SUM-1: there is no test model/test_golden.py::test_nothing",
        "SUM-1: there is no test model/nowhere.py::test_it",
        "SUM-1: there is no claim luck",
        "SUM-1: there is no fault none",
    ]


def test_every_claim_of_the_core_belongs_to_a_requirement():
    assert unclaimed(requirements())["claims"] == []


def test_proofs_are_read_off_their_page(tmp_path, monkeypatch):
    (tmp_path / "docs/explanation").mkdir(parents=True)
    (tmp_path / evidence.PROOFS).write_text(
        "## What came out\n| shape | `reset` | `arithmetic` |\n|---|---:|---:|\n"
        "| `one` | 130.6 s | - |\n| `two` | *51 clocks* | *not* |\n\n**1 of 3**\n"
    )
    monkeypatch.setattr(evidence, "ROOT", tmp_path)
    found = evidence.proofs()
    assert found == {
        "reset": {"one": "130.6 s", "two": "51 clocks"},
        "arithmetic": {"two": "not"},
    }
    assert proved(found["reset"]) == "proved in 1 of 2 shapes"
    assert proved({}) == "no shape tried"


def test_the_page_and_the_data_have_every_requirement_and_open_point():
    listed = requirements()
    text, data = page(listed), json.loads(json.dumps(as_json(listed)))
    for one in listed:
        assert f"### {one.id}\n{one.says}" in text
        assert one.open in text
    assert [one["id"] for one in data["requirements"]] == [one.id for one in listed]
    assert data["tools"]["amaranth"]
    assert "every count at its lower rail" in data["coverage_goals"]
    assert "a result that is dropped" in text


def test_the_page_of_the_docs_is_what_the_command_writes():
    """But for the tools' versions."""
    written = (evidence.ROOT / "docs/explanation/evidence.md").read_text(encoding="utf-8")
    now = page(requirements())
    assert written.partition("## Tools\n")[0] == now.partition("## Tools\n")[0]
