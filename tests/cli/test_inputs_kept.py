"""No output replaces an input, whatever the file is called: status 2, and nothing is changed."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Run = Callable[..., Any]
Refused = Callable[..., str]

PLACE = ("--lat", 47, "--lon", 8, "--height", 400)
WORDS: dict[str, tuple[str, ...]] = {
    "model design": ("model", "D", "log.csv", "-o", "D"),
    "model log": ("model", "D", "log.csv", "-o", "log.csv"),
    "simulate log": ("simulate", "D", "log.csv", "-o", "log.csv", "--engine", "amaranth"),
    "simulate wave": ("simulate", "D", "log.csv", "-o", "o.csv", "--wave", "log.csv"),
    "convert log": ("convert", "log.csv", "-o", "log.csv", "--design", "D", "--gyro-unit", "counts",
                    "--accel-unit", "counts"),
    "convert design": ("convert", "log.csv", "-o", "D", "--design", "D", "--gyro-unit", "counts",
                       "--accel-unit", "counts"),
    "motion log": ("motion", "rest", "--design", "D", "-o", "D", "--truth", "t.csv"),
    "motion truth": ("motion", "rest", "--design", "D", "-o", "o.csv", "--truth", "D"),
    "navigate vectors": ("navigate", "D", "v.csv", "-o", "v.csv", "P"),
    "navigate truth": ("navigate", "D", "v.csv", "--truth", "truth.csv", "-o", "truth.csv"),
    "navigate report": ("navigate", "D", "v.csv", "-o", "o.csv", "P", "--report", "v.csv"),
    "navigate picture": ("navigate", "D", "v.png", "-o", "v.csv", "P"),
    "navigate truth's picture": ("navigate", "D", "v.csv", "--truth", "o_errors.png", "-o",
                                 "o.csv"),
    "advise design": ("advise", "D", "--coning", "0.1", "50", "--drift", "1", "-o", "D"),
    "advise spectrum": ("advise", "D", "--spectrum", "psd.csv", "--drift", "9", "-o", "psd.csv"),
    "analyze spectrum": ("analyze", "vibration", "D", "--spectrum", "psd.png", "-o", "psd.png"),
    "analyze design": ("analyze", "coning", "d.png", "-o", "d.png"),
    "response": ("model", "tuned.toml", "log.csv", "-o", "response.csv"),
}  # fmt: skip


@pytest.fixture
def files(
    tmp_path: Path, run: Run, design: Path, log: Path, monkeypatch: pytest.MonkeyPatch
) -> Path:
    """A folder with a valid input of every kind, and in it we are."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "psd.csv").write_text("freq_hz,psd_g2_per_hz\n20,0.01\n100,0.01\n")
    (tmp_path / "response.csv").write_text("freq_hz,gain\n0,1\n100,0.9\n500,0.5\n")
    tuned = design.read_text().replace("frequency-taylor", "tuned").replace("history = 1", "")
    (tmp_path / "tuned.toml").write_text(
        tuned + 'filter = { kind = "measured", file = "response.csv" }\ndenominator_bits = 12\n'
    )
    assert run("model", design, log, "-o", "v.csv").status == 0
    words = ("motion", "rest", "--design", design, "-o", "x.csv", "--duration", 0.024)
    assert run(*words, "--truth", "truth.csv").status == 0
    for copy, of in (("v.png", "v.csv"), ("o_errors.png", "truth.csv"), ("psd.png", "psd.csv"),
                     ("d.png", design.name)):  # fmt: skip
        (tmp_path / copy).write_bytes((tmp_path / of).read_bytes())
    return tmp_path


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize("case", WORDS)
def test_every_verb_keeps_its_inputs(
    files: Path, refused: Refused, design: Path, case: str
) -> None:
    words: list[object] = []
    for word in WORDS[case]:
        words += PLACE if word == "P" else [design.name if word == "D" else word]
    before = contents(files)
    line = refused(*words)
    assert "this command reads this file" in line
    assert "give the output another name" in line
    assert contents(files) == before


@pytest.mark.parametrize("kind", ["link", "link to a link", "hard link", "spelling", "folder link"])
def test_under_every_name(files: Path, refused: Refused, design: Path, kind: str) -> None:
    other = files / "other.csv"
    if kind.startswith("link"):
        other.symlink_to("log.csv")
    if kind == "link to a link":
        (files / "again.csv").symlink_to(other)
        other = files / "again.csv"
    elif kind == "hard link":
        os.link(files / "log.csv", other)
    elif kind == "spelling":
        (files / "deep").mkdir()
        other = files / "deep" / ".." / "log.csv"
    elif kind == "folder link":
        (files / "here").symlink_to(files)
        other = files / "here" / "log.csv"
    before = contents(files)
    assert "(as " in refused("model", design, "log.csv", "-o", other)
    assert contents(files) == before


def test_standard_input_is_an_input(files: Path, design: Path) -> None:
    before = contents(files)
    with (files / "log.csv").open("rb") as log:
        done = subprocess.run(
            [sys.executable, "-m", "sculler", "model", str(design), "-", "-o", "log.csv"],
            stdin=log, capture_output=True, text=True, cwd=files, check=False,
        )  # fmt: skip
    assert done.returncode == 2
    assert "(as standard input)" in done.stderr
    assert contents(files) == before


def test_a_folder_of_outputs(files: Path, refused: Refused, design: Path) -> None:
    """The design lies where `generate` would write its manifest."""
    (files / "core").mkdir()
    inside = files / "core" / "little.json"
    inside.write_bytes(design.read_bytes())
    assert "this command reads this file" in refused("generate", inside, "-o", files / "core")
    assert sorted(path.name for path in (files / "core").iterdir()) == ["little.json"]
    assert inside.read_bytes() == design.read_bytes()


TWICE: dict[str, tuple[object, ...]] = {
    "wave": ("simulate", "little.toml", "log.csv", "-o", "o.vcd", "--wave", "./o.vcd"),
    "truth": ("motion", "rest", "--design", "little.toml", "-o", "o.csv", "--truth", "o.csv"),
    "report": ("navigate", "little.toml", "v.csv", "-o", "n.csv", *PLACE, "--report", "n.csv"),
    "picture": ("navigate", "little.toml", "v.csv", "-o", "n.png", *PLACE),
}


@pytest.mark.parametrize("case", TWICE)
def test_two_outputs_are_two_files(files: Path, refused: Refused, case: str) -> None:
    assert "two outputs of this command would be this file" in refused(*TWICE[case])


def test_outputs_that_are_no_files_are_free(files: Path, run: Run, design: Path) -> None:
    assert run("simulate", design, "log.csv", "-o", "/dev/null", "--engine", "amaranth",
               "--wave", "w.vcd").status == 0  # fmt: skip
    assert run("model", design, "log.csv", "-o", "o.csv").status == 0
    assert run("model", design, "log.csv", "-o", "o.csv").status == 0  # replaced: it was no input
