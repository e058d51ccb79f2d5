"""`make bench` reports what it measured, and goes on without what it cannot measure."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from sculler.main import run_command
from sculler_model.design import Design
from studies.bench import command as bench
from studies.bench import files
from studies.bench.tasks import Task

COMPARED = {
    "motion": "flight",
    "seconds": 10.0,
    "rate_hz": 100.0,
    "navigators": {
        "ours": {
            "us_per_update": 0.5,
            "updates_per_s": 2e6,
            "horizontal_m": 2e-5,
            "velocity_m_per_s": 1e-7,
        },
        "theirs": {
            "us_per_update": 2.0,
            "updates_per_s": 5e5,
            "horizontal_m": 4e-2,
            "velocity_m_per_s": 1e-4,
        },
        "one by one": {"us_per_update": 20.0, "updates_per_s": 5e4},
    },
    "speed_ratio": 4.0,
    "error_ratio": 2000.0,
}


@pytest.fixture
def report(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Callable[..., str]:
    """What the command prints, of two short measurements."""
    done: list[str] = []

    def short(design: Design, folder: Path) -> list[Task]:
        return [
            Task("plain", 40, lambda: done.append("plain")),
            Task("simulated", 20, lambda: done.append("simulated"), clocks=60),
        ]

    def report(*words: str) -> str:
        done.clear()
        assert run_command(bench.command, list(words), "bench") == 0
        assert done == ["plain", "simulated"] * 6  # once unmeasured, five times in turn
        out, err = capsys.readouterr()
        assert err == ""
        return out

    monkeypatch.setattr(bench, "tasks", short)
    monkeypatch.setattr(bench, "SUBJECTS", {})
    return report


def test_speeds_and_the_comparison_of_navigators(
    report: Callable[..., str], monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = []
    monkeypatch.setattr(bench.navigators, "compare", lambda runs: asked.append(runs) or COMPARED)
    data = json.loads(report("--json"))
    assert asked == [5]
    assert data["navigators"] == COMPARED
    plain, simulated = data["speeds"]["plain"], data["speeds"]["simulated"]
    assert plain["clocks_per_s"] is None
    assert simulated["clocks_per_s"] == pytest.approx(3 * simulated["samples_per_s"], rel=1e-12)
    assert plain["samples_per_s"] == pytest.approx(20 * plain["majors_per_s"], rel=1e-12)
    assert plain["slowest"] <= plain["samples_per_s"] <= plain["fastest"]

    shown = report()
    assert "4 times the updates of python-ins a second, 0.0005 of its horizontal error" in shown
    (theirs,) = (line for line in shown.splitlines() if "theirs" in line)
    assert [cell.strip() for cell in theirs.split("│")[1:-1]] == [
        *("theirs", "500,000", "2", "0.04", "0.0001")
    ]


def test_without_python_ins_one_line_says_so(
    report: Callable[..., str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    line = "pandas is missing, install python-ins (pip install python-ins)"
    assert json.loads(report("--json"))["navigators"] == {"missing": line}
    assert report().splitlines()[-1] == f"navigators not compared: {line}"


@pytest.mark.deep
def test_both_cores_are_simulated(tmp_path: Path) -> None:
    names = [task.name for task in bench.tasks(Design.preset("stim300"), tmp_path) if task.clocks]
    assert names == [
        "pipelined core in Amaranth's simulator",
        "pipelined core in Verilator",
        "compact core in Verilator",
    ]


def test_contests_of_files(tmp_path: Path) -> None:
    """Both sides run; the C program's bytes are held against those of `model` on the way."""
    for contest in files.contests(tmp_path, 2000):
        contest.ours()
        if contest.theirs is not None:
            contest.theirs()
    if (tmp_path / "csv_vectors").exists():
        assert (tmp_path / "ours.csv").read_text().count("\n") == 101
