"""`navigate --gravity` and what is known of the sensors."""

from __future__ import annotations

import json
from collections.abc import Callable
from math import radians, sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sculler.commands.options.navigation import sensor_noise
from sculler.formats.gravity import read_gravity_table
from sculler.formats.log import LogWriter
from sculler_model.design import Design
from sculler_model.frames import gravity
from sculler_model.motion import at_rest
from sculler_model.navigation import gravity_at
from sculler_model.samples import Quantiser

Run = Callable[..., Any]
Refused = Callable[..., str]

PLACE = ("--lat", 48, "--lon", 11, "--height", 500)
HERE = float(gravity(sin(radians(48)), 500.0))


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """60 s at rest, of a STIM300 with its noise."""
    design, rng = Design.preset("stim300"), np.random.default_rng(4)
    where = at_rest(radians(48), radians(11), 500, heading=radians(130))
    path = tmp_path_factory.mktemp("rest") / "log.csv"
    quantise, T = Quantiser(design), design.sample_interval
    noise = np.array([radians(0.15)] * 3 + [0.06] * 3) / 60 * T**0.5
    with LogWriter(path) as writer:
        for chunk in where.chunks("increment", 120_000, T):
            writer.write(quantise(chunk + rng.normal(size=chunk.shape) * noise))
    return path


@pytest.fixture
def resting(run: Run, log: Path) -> Path:
    out = log.with_name("rest.csv")
    if not out.exists():
        assert run("model", "stim300", log, "-o", out).status == 0
    return out


def navigated(run: Run, vectors: Path, out: Path, *more: object) -> dict[str, Any]:
    words = ("navigate", "stim300", vectors, "-o", out, "--no-plots", "--json", *PLACE)
    outcome = run(*words, *more)
    assert outcome.status == 0, outcome
    said: dict[str, Any] = json.loads(outcome.out)
    return said


def fallen(said: dict[str, Any]) -> float:
    return float(-said["moved_m"]["up"])


@pytest.mark.parametrize("mechanisation", ["wander", "geographic"])
def test_gravity_by_choice(run: Run, tmp_path: Path, resting: Path, mechanisation: str) -> None:
    """1 mm/s² more of gravity is ½·0.001·60² = 1.8 m, 1.2 % more by the unstable channel."""
    table = tmp_path / "g.csv"
    table.write_text(f"gravity,lat_deg,height_m\n{HERE + 1e-3!r},48,500\n")
    words = ("--mechanisation", mechanisation, "--heading", 130)
    plain = navigated(run, resting, tmp_path / "a.csv", *words)
    assert plain["gravity"] == "normal field of WGS-84"
    for choice, told in ((f"constant:{HERE + 1e-3!r}", "constant, 9.80"), (table, "100 mGal")):
        said = navigated(run, resting, tmp_path / "b.csv", *words, "--gravity", choice)
        assert told in said["gravity"]
        assert fallen(said) - fallen(plain) == pytest.approx(1.8, rel=0.01)
    said = navigated(run, resting, tmp_path / "c.csv", *words, "--gravity", "constant")
    assert said["gravity"] == "constant, 9.80665 m/s²"


def test_a_table_in_any_order(tmp_path: Path) -> None:
    table = tmp_path / "g.csv"
    rows = [
        (lat, h, float(gravity(sin(radians(lat)), h)) + 1e-5 * lat)
        for lat in (45, 50)
        for h in (0, 1000, 9000)
    ]
    rows = [rows[k] for k in (3, 0, 5, 1, 4, 2)]
    text = "\n".join(f"{lat},x,{h},{g!r}" for lat, h, g in rows)
    table.write_text(f"lat_deg,note,height_m,gravity\n{text}\n")
    model = read_gravity_table(table)
    for lat, h in ((45.0, 0.0), (47.5, 4000.0), (50.0, 9000.0)):
        expected = gravity(sin(radians(lat)), h) + 1e-5 * lat
        assert gravity_at(model, sin(radians(lat)), h)[1] == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("lat_deg,height_m\n48,500\n", "no column gravity"),
        ("lat_deg,height_m,gravity\n48,500,980665\n", "give m/s² from 5 to 10"),
        ("lat_deg,height_m,gravity\n48,500,x\n", "line 2"),
        ("lat_deg,height_m,gravity\n", "no samples"),
        (
            "lat_deg,height_m,gravity\n48,0,9.8\n49,100,9.8\n",
            "latitude 48°, height 100 m is missing",
        ),
        ("lat_deg,height_m,gravity\n48,0,9.8\n48,0,9.8\n", "there more than once"),
        ("lat_deg,height_m,gravity\n98,0,9.8\n", "the latitudes must rise"),
        ("lat_deg,height_m,gravity\n20,0,9.8\n30,0,9.8\n", "outside the gravity table"),
        ("\0\1\2", "no text"),
    ],
)
def test_tables_that_are_none(
    refused: Refused, tmp_path: Path, resting: Path, text: str, message: str
) -> None:
    table = tmp_path / "g.csv"
    table.write_text(text)
    words = ("navigate", "stim300", resting, "-o", tmp_path / "nav.csv", "--no-plots", *PLACE)
    assert message in refused(*words, "--gravity", table)


@pytest.mark.parametrize(
    ("choice", "message"),
    [
        ("constant:nine", "not a number"),
        ("constant:1", "from 5 to 10"),
        ("constant:nan", "from 5 to 10"),
        ("egm2008", "no such file"),
    ],
)
def test_choices_that_are_none(
    refused: Refused, tmp_path: Path, resting: Path, choice: str, message: str
) -> None:
    words = ("navigate", "stim300", resting, "-o", tmp_path / "nav.csv", "--no-plots", *PLACE)
    assert message in refused(*words, "--gravity", choice)


def test_sigmas_are_told(run: Run, tmp_path: Path, resting: Path) -> None:
    """√(6/5) N/(Ω cos lat √T) coarse, N/(...) fine, by noise found or given; level by biases."""
    out = tmp_path / "nav.csv"
    scale = 0.15 / 60 * np.pi / 180 / (7.292115e-5 * np.cos(radians(48)) * 50**0.5)
    coarse = navigated(run, resting, out, "--align", 50)["alignment"]
    assert coarse["noise"]["gyro_deg_per_sqrt_h"] == pytest.approx(0.15, rel=0.2)
    assert coarse["noise"]["accel_m_per_s_per_sqrt_h"] == pytest.approx(0.06, rel=0.3)
    assert coarse["noise"]["gyro_bias_sigma_deg_per_h"] is None
    heading = np.degrees(np.sqrt(6 / 5) * scale)
    assert coarse["heading_sigma_deg"] == pytest.approx(heading, rel=0.2)
    given = ("--gyro-noise", 0.3, "--accel-noise", 0.06, "--accel-bias-sigma", 0.02)
    fine = navigated(run, resting, out, "--align", 50, "--fine", *given)["alignment"]
    assert fine["heading_sigma_deg"] == pytest.approx(np.degrees(2 * scale), rel=0.1)
    assert fine["sigma_deg"]["pitch"] == pytest.approx(np.degrees(0.02 / 9.8), rel=0.1)
    biased = navigated(run, resting, out, "--align", 50, *given, "--gyro-bias-sigma", 30)
    added = np.degrees(radians(30) / 3600 / (7.292115e-5 * np.cos(radians(48))))
    assert biased["alignment"]["heading_sigma_deg"] == pytest.approx(
        np.hypot(2 * heading, added), rel=0.05
    )


def test_noise_is_for_the_alignment(refused: Refused, tmp_path: Path, resting: Path) -> None:
    words = ("navigate", "stim300", resting, "-o", tmp_path / "nav.csv", "--no-plots", *PLACE)
    assert "--gyro-noise is for --align" in refused(*words, "--gyro-noise", 0.1)
    assert ">= 0" in refused(*words, "--align", 20, "--accel-noise", -1)
    known = sensor_noise(
        {
            "gyro_noise": 60.0,
            "accel_noise": 60.0,
            "gyro_bias_sigma": 3600.0,
            "accel_bias_sigma": 0.5,
        }
    )
    assert known.angle_random_walk == known.gyro_bias == radians(1.0)
    assert (known.velocity_random_walk, known.accel_bias) == (1.0, 0.5)


def test_a_wrong_scale_is_told_at_the_start(run: Run, tmp_path: Path, log: Path) -> None:
    """Half of gravity, for the design's sample rate is half the log's."""
    toml, vectors = tmp_path / "half.toml", tmp_path / "half.csv"
    design = Design.preset("stim300").model_dump(mode="json")
    sensor = design["sensor"]
    toml.write_text(
        'name = "half"\n[sensor]\nkind = "increment"\nsample_rate_hz = 1000.0\n'
        f"gyro = {{ bits = 24, lsb = {sensor['gyro']['lsb']!r} }}\n"
        f"accel = {{ bits = 24, lsb = {sensor['accel']['lsb']!r} }}\n"
        '[algorithm]\nfamily = "frequency-taylor"\nsamples = 4\nminors = 5\n'
    )
    assert run("model", toml, log, "-o", vectors).status == 0
    words = ("navigate", toml, vectors, "-o", tmp_path / "nav.csv", "--no-plots", *PLACE)
    outcome = run(*words, "--heading", 130, "--stop", 10)
    assert outcome.status == 0
    told = " ".join(outcome.out.split())
    assert "specific force in the first seconds is 4.904 m/s², but gravity 9.807" in told
    assert "sample rate of the design is half the log's" in told
