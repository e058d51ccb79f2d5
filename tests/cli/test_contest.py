"""A contest's ratio is the other side's time over ours, both taking turns."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from sculler.main import run_command
from sculler_model.errors import InputError
from studies.bench import before
from studies.bench import command as bench
from studies.bench.contest import Contest, hold


def test_both_sides_take_turns_and_the_medians_make_the_ratio(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    clock = [0.0]
    monkeypatch.setattr(time, "perf_counter", lambda: clock[0])
    turns: list[str] = []
    # the first turn is not measured; medians 2 and 6
    ours, theirs = iter([50.0, 1.0, 2.0, 9.0]), iter([0.0, 6.0, 8.0, 5.0])

    def side(name: str, seconds: object) -> object:
        turns.append(name)
        clock[0] += next(seconds)  # type: ignore[call-overload]
        return None

    contest = Contest(
        "a", "b", 30, "rows", lambda: side("ours", ours), lambda: side("theirs", theirs), 2.5
    )
    (row,) = hold([contest], 3)
    assert turns == ["ours", "theirs"] * 4
    assert row["ratio"] == 3.0
    assert row["per_second"] == 15.0
    assert row["ours_s"] == [1.0, 2.0, 9.0]
    assert row["theirs_s"] == [5.0, 6.0, 8.0]


def test_a_side_that_is_missing_is_said(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    missing = Contest("x", "a C program", 10, "rows", lambda: 0, None, 0.7, "gcc is missing")
    monkeypatch.setitem(bench.SUBJECTS, "files", lambda folder: [missing])
    (option,) = (each for each in bench.command.params if each.name == "only")
    monkeypatch.setattr(option.type, "choices", ["files"])
    assert run_command(bench.command, ["--only", "files"], "bench") == 0
    out, _ = capsys.readouterr()
    (line,) = (line for line in out.splitlines() if " x " in line)
    assert "gcc is missing" in line


def test_a_commit_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="has no commit 0000000, clone the repository whole"):
        before.tree(tmp_path, "0000000")
