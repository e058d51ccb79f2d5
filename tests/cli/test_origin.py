"""From a page back to the first file: versions, hashes and settings of a whole chain."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from typing import Any

import pytest

from sculler.formats.origin import chain, record_path

Run = Callable[..., Any]

DESIGN = """\
name = "d"
[sensor]
kind = "increment"
sample_rate_hz = 100.0
gyro = { bits = 32, lsb = 1e-9 }
accel = { bits = 32, lsb = 1e-7 }
[algorithm]
family = "frequency-taylor"
samples = 2
minors = 1
"""
PLACE = ("--lat", 48, "--lon", 11, "--height", 500)


@pytest.fixture
def made(run: Run, tmp_path: Path) -> dict[str, Path]:
    """A still unit's log in rad/s and g, right, forward, up, through convert and model."""
    files = {name: tmp_path / name for name in ("d.toml", "raw.csv", "imu.csv", "vec.csv")}
    files["d.toml"].write_text(DESIGN)
    rows = (f"{0.01 * k:.2f},0,4.8e-5,5.4e-5,0,0,1.0001" for k in range(1, 501))
    files["raw.csv"].write_text("t,wx,wy,wz,ax,ay,az\n" + "\n".join(rows) + "\n")
    words = ("--gyro-columns", "wx,wy,wz", "--accel-columns", "ax,ay,az", "--time-column", "t")
    words += ("--gyro-unit", "rad/s", "--accel-unit", "g", "--axes", "RFU")
    words += ("--gyro-bias", "1,2,3 deg/h")
    outcome = run(
        *("convert", files["raw.csv"], "-o", files["imu.csv"], "--design", files["d.toml"]), *words
    )
    assert outcome.status == 0, outcome
    assert run("model", files["d.toml"], files["imu.csv"], "-o", files["vec.csv"]).status == 0
    return files


def digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


def page_of(run: Run, made: dict[str, Path], *more: object) -> str:
    page = made["d.toml"].with_name("run.html")
    words = (made["d.toml"], made["vec.csv"], "-o", page.with_name("nav.csv"), *PLACE)
    outcome = run("navigate", *words, "--no-plots", "--report", page, *more)
    assert outcome.status == 0, outcome
    return page.read_text(encoding="utf-8")


def test_the_page_names_the_whole_chain(run: Run, made: dict[str, Path]) -> None:
    text = page_of(run, made)
    for path in made.values():
        assert digest(path) in text
        assert path.name in text
    assert f"This page: sculler {version('sculler')}, Python" in text
    assert f"convert, sculler {version('sculler')}" in text
    assert "model, sculler" in text
    for name, value in (
        ("--axes", "RFU"),
        ("--accel-unit", "g"),
        ("--gyro-bias", "1,2,3 deg/h"),
        ("timing.gap_count", "0"),
        ("sensors.gyro.unit", "rad/s"),
        ("--engine", "fast"),
    ):
        assert f'<td class="name">{name}</td><td>{value}' in text
    assert 'class="warnings"' not in text


def test_a_record_of_another_file_is_no_record(run: Run, made: dict[str, Path]) -> None:
    lines = made["vec.csv"].read_text().splitlines(keepends=True)
    made["vec.csv"].write_text("".join(lines[:-1]))
    text = page_of(run, made)
    words = "vectors vec.csv: vec.csv.origin.json tells of another file"
    assert text.count(words) == 1  # among the warnings
    assert digest(made["vec.csv"]) in text
    assert "convert, sculler" not in text


@pytest.mark.parametrize("junk", ["", "{", "[]", "null", '{"file": 3}', "[" * 100_000])
def test_a_record_that_cannot_be_read(run: Run, made: dict[str, Path], junk: str) -> None:
    record_path(made["vec.csv"]).write_text(junk)
    assert "vec.csv.origin.json cannot be read" in page_of(run, made)


def test_a_record_of_strange_shape_breaks_nothing(run: Run, made: dict[str, Path]) -> None:
    path = record_path(made["vec.csv"])
    odd = {"file": {"sha256": digest(made["vec.csv"])}, "inputs": [3, {"origin": 4}], "result": [1]}
    path.write_text(json.dumps(odd))
    assert "?, ?" in page_of(run, made)


def test_no_record_is_said(run: Run, made: dict[str, Path]) -> None:
    record_path(made["imu.csv"]).unlink()
    assert run("model", made["d.toml"], made["imu.csv"], "-o", made["vec.csv"]).status == 0
    assert "no record beside it" in page_of(run, made)
    steps = chain("vectors", made["vec.csv"])
    assert [(step.name, step.sha256) for step in steps] == [
        (f"{kind} {name}", digest(made[name]))
        for kind, name in (("vectors", "vec.csv"), ("log", "imu.csv"), ("design", "d.toml"))
    ]


def test_motions_and_simulations_have_records_too(run: Run, tmp_path: Path) -> None:
    (tmp_path / "d.toml").write_text(DESIGN)
    log, truth = tmp_path / "imu.csv", tmp_path / "truth.csv"
    words = ("motion", "rest", "--design", "stim300", "-o", log, "--truth", truth)
    assert run(*words, "--duration", "0.1", "--lat", 47).status == 0
    record = json.loads(record_path(log).read_text(encoding="utf-8"))
    assert record["verb"] == "motion"
    assert record["settings"]["--lat"] == 47
    assert record["file"] == {"name": "imu.csv", "sha256": digest(log)}
    assert record["inputs"] == [{"kind": "design", "name": "stim300", "sha256": None}]


def test_a_pipe_gets_no_record(run: Run, made: dict[str, Path]) -> None:
    outcome = run("model", made["d.toml"], made["imu.csv"], "-o", "/dev/stdout", "--json")
    assert outcome.status == 0
    assert not Path("/dev/stdout.origin.json").exists()
