"""High-resolution position from the design file to the track."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from sculler_model.design import COLUMNS, HIGH_RESOLUTION_COLUMNS

Run = Callable[..., Any]
Refused = Callable[..., str]

DESIGN = """
name = "fine"
[sensor]
kind = "increment"
sample_rate_hz = 2000.0
gyro = { bits = 32, lsb = 1e-11 }
accel = { bits = 32, lsb = 1e-9 }
[algorithm]
family = "frequency-taylor"
samples = 4
minors = 10
position = "high-resolution"
[hardware]
core = "compact"
"""


@pytest.fixture
def fine(tmp_path: Path) -> Path:
    path = tmp_path / "fine.toml"
    path.write_text(DESIGN)
    return path


@pytest.fixture
def plain(tmp_path: Path) -> Path:
    """The same without high-resolution position."""
    path = tmp_path / "plain.toml"
    path.write_text(DESIGN.replace("high-resolution", "trapezoidal"))
    return path


def test_model_and_navigate(run: Run, tmp_path: Path, fine: Path, plain: Path) -> None:
    """The demonstration's vibration: the position is nearer to the truth."""
    log, truth = tmp_path / "log.csv", tmp_path / "truth.csv"
    made = ("motion", "demo", "--design", fine, "-o", log, "--truth", truth, "--duration", 4)
    assert run(*made).status == 0
    largest = {}
    cases = [
        (fine, HIGH_RESOLUTION_COLUMNS, "wander", "high-resolution", "of high resolution, by"),
        (fine, HIGH_RESOLUTION_COLUMNS, "geographic", "trapezoidal", "by the trapezoid"),
        (plain, COLUMNS, "wander", "trapezoidal", "by the trapezoid"),
    ]
    for design, columns, mechanisation, algorithm, words in cases:
        vectors, track = tmp_path / "vectors.csv", tmp_path / "track.csv"
        assert run("model", design, log, "-o", vectors).status == 0
        assert vectors.read_text().splitlines()[0] == ",".join(columns)
        options = ("--truth", truth, "--mechanisation", mechanisation, "--no-plots")
        said = run("navigate", design, vectors, "-o", track, *options, "--json")
        assert said.status == 0, said.err
        data = json.loads(said.out)
        assert data["position_algorithm"] == algorithm
        largest[design, mechanisation] = data["errors"]["position_m"]["down"]["max"]
        assert words in run("navigate", design, vectors, "-o", track, *options).out
    assert largest[fine, "wander"] < 0.5 * largest[plain, "wander"]


def test_the_engines_agree(run: Run, tmp_path: Path, fine: Path) -> None:
    log = tmp_path / "log.csv"
    rows = [[(7 * i + k) ** 5 % (2**32) - 2**31 for k in range(6)] for i in range(130)]
    header = "gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z"
    log.write_text("\n".join([header, *(",".join(map(str, row)) for row in rows)]) + "\n")
    a, b = tmp_path / "a.csv", tmp_path / "b.csv"
    assert run("model", fine, log, "-o", a).status == 0
    assert run("model", fine, log, "-o", b, "--engine", "reference").status == 0
    assert run("compare", a, b).status == 0
    assert len(a.read_text().splitlines()) == 4


def test_vectors_of_the_other_kind_are_refused(
    run: Run, refused: Refused, tmp_path: Path, fine: Path, plain: Path
) -> None:
    log = tmp_path / "log.csv"
    header = "gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z"
    log.write_text(header + "\n" + "1,2,3,4,5,6\n" * 80)
    files = {}
    for design in (fine, plain):
        files[design] = tmp_path / f"{design.stem}.csv"
        assert run("model", design, log, "-o", files[design]).status == 0
    where = ("--lat", 48, "--lon", 11, "--height", 500, "--no-plots")
    said = refused("navigate", plain, files[fine], "-o", tmp_path / "nav.csv", *where)
    assert "29 columns, but design fine" in said
    said = refused("compare", files[fine], files[plain])
    assert "20 columns for 29" in said


def test_the_pipelined_core_shows_three_vectors_more(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "fast.toml"
    path.write_text(DESIGN.replace("compact", "pipelined").replace("bits = 32", "bits = 8"))
    assert run("generate", path, "-o", tmp_path / "made").status == 0
    manifest = json.loads((tmp_path / "made" / "fine.json").read_text())
    shown = [port["name"] for port in manifest["ports"] if port["name"].startswith("result_")]
    wanted = [f"result_{column}" for column in HIGH_RESOLUTION_COLUMNS]
    assert shown == ["result_valid", "result_ready", *wanted]
