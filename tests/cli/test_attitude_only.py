"""`navigate --attitude-only`, and `--rest`: no place, the Earth's rate by the latitude alone."""

from __future__ import annotations

import json
from collections.abc import Callable
from math import cos, degrees, radians, sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sculler
from sculler_model.frames import EARTH_RATE

Run = Callable[..., Any]
Refused = Callable[..., str]

DESIGN = """
preset = "stim300"
name = "d"
[sensor]
sample_rate_hz = 200.0
gyro = { bits = 32, lsb = 1e-11 }
[sensor.errors]
gyro = { bias = [20.0, -40.0, 10.0] }
"""
WHERE = ("--heading", 30, "--roll", 5, "--lat", 48)


@pytest.fixture
def flown(run: Run, tmp_path: Path) -> tuple[Path, Path, Path]:
    """A design with biases, vectors of two minutes at rest, their truth."""
    design, log = tmp_path / "d.toml", tmp_path / "imu.npz"
    truth, vectors = tmp_path / "truth.npz", tmp_path / "v.npz"
    design.write_text(DESIGN)
    still = ("motion", "rest", "--design", design, "-o", log, "--truth", truth)
    assert run(*still, "--duration", 120, *WHERE).status == 0
    assert run("model", design, log, "-o", vectors).status == 0
    return design, vectors, truth


def told(run: Run, *words: object) -> dict[str, Any]:
    outcome = run("navigate", *words, "--no-plots", "--json")
    assert outcome.status == 0, outcome.err
    found: dict[str, Any] = json.loads(outcome.out)
    return found


def test_bias_at_rest_with_and_without_the_earth(
    run: Run, flown: tuple[Path, Path, Path], tmp_path: Path
) -> None:
    """A window late in the run: the Earth's rate is turned by the attitude there."""
    design, vectors, truth = flown
    out, given = tmp_path / "nav.csv", ("--heading", 30, "--roll", 5)
    only = (design, vectors, "-o", out, "--attitude-only", *given)
    said = told(run, *only, "--lat", 48, "--rest", "60:110", "--truth", truth)
    assert said["rest"]["gyro_bias_deg_per_h"] == pytest.approx([20, -40, 10], abs=1e-4)
    assert said["rest"]["earth_rate_taken_off"]
    assert said["errors"]["attitude_arcsec"]["total"]["max"] < 0.01
    assert "velocity_m_per_s" not in said["errors"]
    assert "end_velocity" not in said
    assert "gravity" not in said

    without = told(run, *only, "--rest", "60:110")["rest"]
    rate = degrees(EARTH_RATE) * 3600 * np.array([cos(radians(48)), 0, -sin(radians(48))])
    roll, heading = radians(5), radians(30)
    north = rate[0] * np.array([cos(heading), -sin(heading)])
    right = north[1] * cos(roll) + rate[2] * sin(roll)
    down = -north[1] * sin(roll) + rate[2] * cos(roll)
    expected = np.array([20 + north[0], -40 + right, 10 + down])
    assert without["gyro_bias_deg_per_h"] == pytest.approx(expected.tolist(), abs=2e-3)


def test_a_truth_gives_the_latitude(
    run: Run, flown: tuple[Path, Path, Path], tmp_path: Path
) -> None:
    """Where no other is given: the gyros' bias at rest has no part of the Earth's rate."""
    design, vectors, truth = flown
    out = tmp_path / "nav.csv"
    only = (design, vectors, "-o", out, "--attitude-only", "--rest", "60:110", "--truth", truth)
    said = told(run, *only)
    assert said["rest"]["earth_rate_taken_off"]
    assert said["rest"]["gyro_bias_deg_per_h"] == pytest.approx([20, -40, 10], abs=1e-4)
    assert said["errors"]["attitude_arcsec"]["total"]["max"] < 0.01
    assert "against the stars" not in run("navigate", *only, "--no-plots").out


def test_columns_and_a_truth_of_attitude_alone(
    run: Run, flown: tuple[Path, Path, Path], tmp_path: Path
) -> None:
    """What it writes is such a truth; pictures and report are drawn of what there is."""
    design, vectors, _ = flown
    out, again, page = tmp_path / "nav.csv", tmp_path / "again.csv", tmp_path / "page.html"
    only = ("navigate", design, vectors, "--attitude-only", "--heading", 30, "--report", page)
    outcome = run(*only, "-o", out)
    assert outcome.status == 0
    assert "against the stars" in outcome.out
    header, first = out.read_text().splitlines()[:2]
    assert header == "time_s,q_w,q_x,q_y,q_z,roll_deg,pitch_deg,heading_deg"
    assert float(first.split(",")[7]) == pytest.approx(30)
    assert out.with_suffix(".png").exists()
    said = told(run, design, vectors, "-o", again, "--attitude-only", "--truth", out)
    assert said["errors"]["attitude_arcsec"]["total"]["max"] < 1e-9
    assert said["start_attitude_deg"]["heading"] == pytest.approx(30)
    assert again.read_text() == out.read_text()


def test_alignment_needs_the_latitude_alone(
    run: Run, flown: tuple[Path, Path, Path], tmp_path: Path
) -> None:
    design, vectors, _ = flown
    words = (design, vectors, "-o", tmp_path / "nav.csv", "--attitude-only", "--align", 20)
    said = told(run, *words, "--lat", 48)
    assert said["start_s"] == 20
    assert said["start_attitude_deg"]["roll"] == pytest.approx(5, abs=0.1)


REFUSALS: dict[tuple[object, ...], str] = {
    ("--attitude-only", "--vn", 3): "--vn is not for --attitude-only",
    ("--attitude-only", "--align", 10): "finds north by the Earth's rate, give --lat too",
    ("--attitude-only", "--height-damping", 10): "--height-damping is not for --attitude-only",
    ("--attitude-only", "--telemetry", "x.bin"): "--telemetry is not for --attitude-only",
    ("--attitude-only", "--engine", "c"): "--attitude-only is for the engine python",
    ("--attitude-only", "--rest", "200:300"): "0 intervals of the run lie in 200 to 300 s",
    ("--attitude-only", "--rest", "9:5"): "'9:5' is not a span, give A:B in seconds",
    ("--attitude-only", "--rest", "a:5"): "'a:5' is not a span",
    ("--align", 9, "--fine", "--rest", "0:9", "--lat", 1, "--lon", 1, "--height", 1): (
        "--rest and --fine both take out the gyros' bias"
    ),
    ("--rest", "0:30"): "Missing option '--lat'",
}


def test_refuses(refused: Refused, flown: tuple[Path, Path, Path], tmp_path: Path) -> None:
    design, vectors, _ = flown
    for words, message in REFUSALS.items():
        assert message in refused("navigate", design, vectors, "-o", tmp_path / "n.csv", *words)
    only = ("-o", tmp_path / "n.csv", "--attitude-only", "--rest", "1:9")
    assert "more than once" in refused("navigate", design, "-", *only)
    assert not (tmp_path / "n.csv").exists()


def test_motion_in_the_rest_window_is_told() -> None:
    design = sculler.Design.preset("stim300")
    log = sculler.record(design, sculler.motion("spin-rock-size", lat=48, lon=11, height=0), 3)
    vectors = sculler.FastModel(design).feed(log.counts)
    for seconds, words in ((1.5, "the mean rate is 36"), (0.2, "the mean rate is")):
        found = sculler.navigate(design, vectors, attitude_only=True, rest=(0.0, seconds))
        assert found.rest is not None
        assert words in found.rest.warnings[0]
    log = sculler.record(design, sculler.motion("coning", lat=48, lon=11, height=0, hertz=3), 3)
    vectors = sculler.FastModel(design).feed(log.counts)
    found = sculler.navigate(design, vectors, attitude_only=True, rest=(0.0, 2.0))
    assert found.rest is not None
    assert "the rates wander by 13.3" in found.rest.warnings[0]
    assert len(found.rest.warnings) == 1
    found = sculler.navigate(design, vectors, attitude_only=True, rest=(1.0, 60.0))
    assert found.rest is not None
    assert found.rest.warnings[-1] == "rest: 2 s of the 59 s asked for lie in the run"
    assert np.isnan(found.history.v).all()


def test_live_and_in_memory_are_one() -> None:
    """A body that spins: attitude against the turning Earth, result by result."""
    design = sculler.Design.preset("stim300")
    motion = sculler.motion("spin-cone", lat=48, lon=11, height=0)
    log = sculler.record(design, motion, 2)
    true = motion.state(np.array([0.0, 2.0]))
    start = {"attitude_only": True, "lat": 48.0}
    angles = dict(zip(("roll", "pitch", "heading"), np.degrees(true.euler[0]), strict=True))
    vectors = sculler.FastModel(design).feed(log.counts)
    whole = sculler.navigate(design, vectors, **start, **angles)  # type: ignore[arg-type]
    live = sculler.LiveNavigator(design, **start, **angles)  # type: ignore[arg-type]
    for part in np.array_split(log.counts, 7):
        live.feed(part)
    assert live.state is not None
    assert live.state.q == whole.end.q
    assert abs(abs(np.dot(whole.end.q, true.q[1])) - 1) < 1e-9
    with pytest.raises(sculler.InputError, match="a live run cannot go back"):
        sculler.LiveNavigator(design, rest=(0.0, 1.0), **start)  # type: ignore[arg-type]
