"""`convert --calibration` and `navigate --calibration`: errors of `motion` taken out again."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

Run = Callable[..., Any]
Refused = Callable[..., str]

SENSOR = """
preset = "stim300"
name = "{name}"
[sensor]
sample_rate_hz = 500.0
gyro = {{ bits = 32, lsb = 1e-10 }}
accel = {{ bits = 32, lsb = 1e-8 }}
"""
LINEAR = """
[gyro]
bias = [20.0, -40.0, 10.0]
scale_factor = [500.0, -300.0, 200.0]
misalignment = [1.0, -0.5, 0.3, 0.8, -0.2, 0.4]
[accel]
bias = [2.0, -1.0, 3.0]
"""
PLACED = """
delay_samples = 1.3
arms_m = [[0.1, 0.0, 0.0], [0.0, 0.05, 0.0], [0.0, 0.0, -0.05]]
"""
COUNTS = ("--gyro-unit", "counts", "--accel-unit", "counts")


def flown(run: Run, folder: Path, errors: str) -> dict[str, Path]:
    """A log with errors and what is known of them, its truth, and a perfect one's."""
    paths = {name: folder / name for name in ("raw.csv", "good.csv", "truth.csv", "cal.toml")}
    paths["cal.toml"].write_text(errors)
    for name, more in (("good", ""), ("raw", "[sensor.errors]" + errors)):
        paths[name] = folder / f"{name}.toml"
        more = more.replace("\n[", "\n[sensor.errors.")
        paths[name].write_text(SENSOR.format(name=name) + more)
        words = ("motion", "spin-cone", "--design", paths[name], "--duration", 5)
        assert run(*words, "-o", paths[f"{name}.csv"], "--truth", paths["truth.csv"]).status == 0
    return paths


def final(run: Run, paths: dict[str, Path], log: Path, *words: object) -> tuple[float, float]:
    """Errors of attitude (″) and position (m) at the end."""
    vectors, out = log.with_suffix(".vectors.csv"), log.with_suffix(".nav.csv")
    assert run("model", paths["good"], log, "-o", vectors).status == 0
    truth = ("--truth", paths["truth.csv"], "--no-plots", "--json")
    said = run("navigate", paths["good"], vectors, "-o", out, *truth, *words)
    assert said.status == 0, said.err
    errors = json.loads(said.out)["errors"]
    return errors["attitude_arcsec"]["total"]["max"], errors["position_m"]["horizontal"]["max"]


def test_round_trip(run: Run, tmp_path: Path) -> None:
    """With times and faults; what is left is what the perfect sensor leaves."""
    paths = flown(run, tmp_path, PLACED + LINEAR)
    text = paths["raw.csv"].read_text().splitlines()
    assert text[0].endswith("accel_z")
    rows = [f"{text[0]},time_s,fault"]
    rows += [f"{row},{(k + 1) / 500},{int(k == 70)}" for k, row in enumerate(text[1:])]
    paths["raw.csv"].write_text("\n".join(rows) + "\n")
    clean = tmp_path / "clean.csv"
    words = ("--design", paths["good"], "--calibration", paths["cal.toml"], *COUNTS)
    stamped = ("--time-column", "time_s")
    outcome = run("convert", paths["raw.csv"], "-o", clean, *words, *stamped)
    assert outcome.status == 0, outcome.err
    assert "cal.toml taken out" in " ".join(outcome.out.split())
    table = np.genfromtxt(clean, delimiter=",", names=True)
    assert len(table) == 2500
    assert table["time_s"][-1] == pytest.approx(5.0)
    raw, perfect = final(run, paths, paths["raw.csv"]), final(run, paths, paths["good.csv"])
    found = final(run, paths, clean)
    assert raw[0] > 100 * perfect[0]
    assert found[0] < 1.05 * perfect[0] + 1e-3
    assert raw[1] > 0.3
    assert found[1] < perfect[1] + 2e-3


@pytest.mark.deep
def test_out_of_results(run: Run, tmp_path: Path) -> None:
    paths = flown(run, tmp_path, LINEAR)
    perfect = final(run, paths, paths["good.csv"])
    found = final(run, paths, paths["raw.csv"], "--calibration", paths["cal.toml"])
    assert found[0] < perfect[0] + 0.05
    assert found[1] < perfect[1] + 5e-3


def test_refuses(refused: Refused, run: Run, tmp_path: Path) -> None:
    cal, out = tmp_path / "cal.toml", tmp_path / "out.csv"
    log = tmp_path / "log.csv"
    log.write_text("gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z\n" + "0,0,0,0,0,9\n" * 40)
    convert = ("convert", log, "-o", out, "--design", "stim300", *COUNTS, "--calibration", cal)
    vectors = tmp_path / "v.csv"
    assert run("model", "stim300", log, "-o", vectors).status == 0
    where = ("--lat", 48, "--lon", 11, "--height", 0, "--no-plots")
    navigate = ("navigate", "stim300", vectors, "-o", out, *where, "--calibration", cal)
    for text, message in {
        "[gyro]\nbias = 'x'": "gyro.bias",
        "[gyro]\nflicker = 1.0": "gyro.flicker: is random or a limit, so it cannot be undone",
        "[gyros]\nbias = 1.0": "gyros: unknown key",
        "bias = [": "cal.toml",
    }.items():
        cal.write_text(text)
        assert message in refused(*convert)
        assert message in refused(*navigate)
    cal.write_text("delay_samples = 1.0")
    assert "delay_samples cannot be undone in results" in refused(*navigate)
    cal.write_text("[gyro]\nbias = 1.0")
    assert "--calibration is for the engine python" in refused(*navigate, "--engine", "c")
