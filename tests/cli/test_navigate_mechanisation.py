"""`navigate`: mechanisations, how often the position, the height held, the alignment refined."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable
from math import radians
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sculler.formats.log import LogWriter
from sculler_model.design import Design
from sculler_model.motion import Curve, Motion, at_rest, turn_motion
from sculler_model.samples import Quantiser

Run = Callable[..., Any]
Refused = Callable[..., str]

PLACE = ("--lat", 48, "--lon", 11, "--height", 500)


def vectors(run: Run, folder: Path, motion: Motion, seconds: float) -> Path:
    """The motion's vectors by way of `model`, STIM300."""
    design = Design.preset("stim300")
    log, out = folder / "log.csv", folder / "vectors.csv"
    with LogWriter(log) as writer:
        samples = round(seconds * design.sensor.sample_rate_hz)
        quantise = Quantiser(design)
        for chunk in motion.chunks("increment", samples, design.sample_interval):
            writer.write(quantise(chunk))
    assert run("model", "stim300", log, "-o", out).status == 0
    return out


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("mechanisation")


@pytest.fixture
def turning(run: Run, folder: Path) -> Path:
    """20 s of a turn."""
    out = folder / "vectors.csv"
    return out if out.exists() else vectors(run, folder, turn_motion(), 20)


def track(path: Path) -> np.ndarray[Any, np.dtype[np.float64]]:
    with path.open() as file:
        rows = [[float(value) for value in row] for row in list(csv.reader(file))[1:]]
    return np.array(rows)


def test_every_mechanisation_tells_the_same_track(run: Run, tmp_path: Path, turning: Path) -> None:
    tracks = []
    for number, options in enumerate(
        (
            (),
            ("--mechanisation", "geographic"),
            ("--position-every", 5),
            ("--height-damping", 60),
        )
    ):
        out = tmp_path / f"{number}.csv"
        outcome = run(
            "navigate", "stim300", turning, "-o", out, *PLACE, "--ve", 30, "--no-plots", *options
        )
        assert (outcome.status, outcome.err) == (0, "")
        tracks.append(track(out))
    wander, geographic, seldom, damped = tracks
    lat, lon, height = 11, 12, 13
    for other in (geographic, seldom):
        assert np.abs(other[:, lat] - wander[:, lat]).max() < 1e-9
        assert np.abs(other[:, lon] - wander[:, lon]).max() < 1e-9
        assert np.abs(other[:, :8] - wander[:, :8]).max() < 1e-7
        assert not np.array_equal(other, wander)
    assert np.abs(damped[:, height] - 500).max() < np.abs(wander[:, height] - 500).max()


@pytest.mark.parametrize("climbing", [False, True])
def test_a_damped_height_that_leaves_its_reference_is_told(
    run: Run, tmp_path: Path, climbing: bool
) -> None:
    """A climb of 2 m/s over a minute: the loop pulls the height back."""
    up = Curve((0.0, 2.0 if climbing else 0.0))
    path = vectors(run, tmp_path, Motion(radians(48), radians(11), 500.0, up=up), 60)
    options = (*PLACE, "--no-plots", "--height-damping", 30, "-o", tmp_path / "nav.csv")
    outcome = run("navigate", "stim300", path, "--json", "--vd", -2 if climbing else 0, *options)
    assert outcome.status == 0
    told = "--height-damping holds the height to 500 m, where the run began, but it came to be"
    assert [warning.startswith(told) for warning in json.loads(outcome.out)["warnings"]] == [
        True
    ] * climbing


def barometer(folder: Path, offset: float = 0.0, until: float = 60.0) -> Path:
    """2 m/s of climb every 0.5 s, 0.3 s late."""
    path = folder / f"barometer_{offset:g}_{until:g}.csv"
    rows = [f"{500 + offset + 2 * (t - 0.3):.3f},{t:.1f}" for t in np.arange(-0.5, until, 0.5)]
    path.write_text("\n".join(["height_m,time_s", *rows, ""]), encoding="utf-8")
    return path


def test_a_measured_height(run: Run, refused: Refused, tmp_path: Path) -> None:
    """A climb is followed in both mechanisations; a reference that is wrong or ends is told."""
    path = vectors(run, tmp_path, Motion(radians(48), radians(11), 500.0, up=Curve((0.0, 2.0))), 60)
    out = tmp_path / "nav.csv"

    def flown(reference: Path, *options: object) -> list[str]:
        given = (*PLACE, "--vd", -2, "--no-plots", "--height-damping", 10, "-o", out, *options)
        measured = ("--height-reference", reference, "--height-lag", 0.3)
        outcome = run("navigate", "stim300", path, "--json", *given, *measured)
        assert outcome.status == 0, outcome.err
        told: list[str] = json.loads(outcome.out)["warnings"]
        return told

    height = 13
    for mechanisation in ("wander", "geographic"):
        assert flown(barometer(tmp_path), "--mechanisation", mechanisation) == []
        found = track(out)
        assert np.abs(found[:, height] - 500 - 2 * found[:, 0]).max() < 0.01
    (told,) = flown(barometer(tmp_path, 20.0))
    assert "the height came to be 20 m away from --height-reference at 0 s" in told
    assert flown(barometer(tmp_path, 20.0), "--height-noise", 5) == []
    (told,) = flown(barometer(tmp_path, until=30.0))
    assert "--height-reference has nothing for" in told
    assert "the height is free there" in told
    for text, message in (("a,b\n1,2\n", "no column time_s"), ("time_s,height_m\n", "no samples")):
        bad = tmp_path / "bad.csv"
        bad.write_text(text, encoding="utf-8")
        options = ("-o", tmp_path / "none.csv", *PLACE, "--height-reference", bad)
        assert message in refused("navigate", "stim300", path, *options)
    said = refused("navigate", "stim300", path, "-o", out, *PLACE, "--height-lag", 1)
    assert "--height-lag is of --height-reference, give that too" in said


@pytest.mark.parametrize("lat", [90, -90])
def test_at_a_pole(run: Run, refused: Refused, tmp_path: Path, turning: Path, lat: int) -> None:
    place = ("--lat", lat, "--lon", 0, "--height", 0, "--no-plots", "-o", tmp_path / "nav.csv")
    assert run("navigate", "stim300", turning, *place).status == 0
    said = refused("navigate", "stim300", turning, *place, "--mechanisation", "geographic")
    assert "at a pole there is no north to point to" in said


def test_what_the_geographic_one_has_not(refused: Refused, tmp_path: Path, turning: Path) -> None:
    out = tmp_path / "nav.csv"
    options = (*PLACE, "-o", out, "--mechanisation", "geographic", "--position-every", 2)
    assert "--position-every is for the wander azimuth" in refused(
        "navigate", "stim300", turning, *options
    )
    assert not out.exists()


@pytest.mark.parametrize("lat", ["90.1", "-91", "nan"])
def test_outside_the_earth(refused: Refused, tmp_path: Path, turning: Path, lat: str) -> None:
    place = (f"--lat={lat}", "--lon", 0, "--height", 0, "-o", tmp_path / "nav.csv")
    assert lat.lstrip("-") in refused("navigate", "stim300", turning, *place)


def test_fine_alignment(run: Run, tmp_path: Path) -> None:
    out = tmp_path / "nav.csv"
    where = at_rest(radians(48), radians(11), 500, radians(2), radians(-3), radians(130))
    rest = vectors(run, tmp_path, where, 90)
    outcome = run(
        "navigate", "stim300", rest, "-o", out, *PLACE, "--align", 60, "--fine", "--json",
        "--no-plots",
    )  # fmt: skip
    assert (outcome.status, outcome.err) == (0, "")
    found = json.loads(outcome.out)["alignment"]
    assert found["level_sigma_deg"] < 1e-3
    assert len(found["gyro_bias_deg_per_h"]) == 3
    attitude = track(out)[0, 5:8]
    assert attitude[:2] == pytest.approx([2, -3], abs=1e-3)
    # 24-bit STIM300 counts of 1.7 milliseconds of arc, 60 s: a degree of heading
    assert attitude[2] == pytest.approx(130, abs=5 * found["heading_sigma_deg"])


def test_fine_needs_align(refused: Refused, tmp_path: Path, turning: Path) -> None:
    said = refused("navigate", "stim300", turning, "-o", tmp_path / "n.csv", *PLACE, "--fine")
    assert "--fine refines --align, give that too" in said


def test_all_columns_but_the_wander_angle_are_of_true_north(run: Run, tmp_path: Path) -> None:
    """Past the pole at 86° N and 250 m/s: north turns by 19°, and heading with it.

    The truth's heading is of true north; the wander angle is the integral of sin lat over the
    longitude gone, here by Simpson's rule over the truth.
    """
    design, log, truth = tmp_path / "fine.toml", tmp_path / "log.csv", tmp_path / "truth.csv"
    design.write_text(
        'preset = "lasergyro"\nname = "fine"\n[sensor]\n'
        "gyro = { bits = 32, lsb = 1e-11 }\naccel = { bits = 32, lsb = 1e-8 }\n"
    )
    words = ("great-circle", "--lat", 86, "--heading", 75, "--duration", 600)
    assert run("motion", *words, "--design", design, "-o", log, "--truth", truth).status == 0
    assert run("model", design, log, "-o", tmp_path / "vectors.csv").status == 0
    tracks = {}
    for name in ("wander", "geographic"):
        out = tmp_path / f"{name}.csv"
        words = ("--truth", truth, "--mechanisation", name, "--no-plots")
        outcome = run("navigate", design, tmp_path / "vectors.csv", "-o", out, *words)
        assert outcome.status == 0, outcome
        tracks[name] = track(out)
    true, heading, lat, lon, wander = track(truth), 7, 11, 12, 14
    for found in tracks.values():
        assert np.abs(found[:, 1:14] - true[:, 1:14])[:, [*range(7), lat - 1, lon - 1]].max() < 1e-6
    assert abs(true[-1, heading] - true[0, heading]) > 19
    sines, steps = np.sin(np.radians(true[:, lat])), np.diff(true[:, lon])
    middle = np.sin(np.radians(0.5 * (true[1:, lat] + true[:-1, lat])))
    expected = np.cumsum((sines[1:] + 4 * middle + sines[:-1]) / 6 * steps)
    assert np.abs(tracks["wander"][1:, wander] - expected).max() < 1e-6
    assert abs(expected[-1]) > 19
    assert not tracks["geographic"][:, wander].any()


def test_other_forms(run: Run, refused: Refused, tmp_path: Path, turning: Path) -> None:
    """Each gives nearly the same track; where they are not at hand it is said."""
    tracks = []
    forms: tuple[tuple[object, ...], ...] = (
        (),
        ("--attitude", "cosines"),
        ("--azimuth", "free"),
        ("--level-every", 5),
        ("--rotation", "first-order"),
    )
    for number, options in enumerate(forms):
        out = tmp_path / f"{number}.csv"
        given = (*PLACE, "--ve", 30, "--no-plots", "-o", out, *options)
        outcome = run("navigate", "stim300", turning, *given)
        assert (outcome.status, outcome.err) == (0, "")
        tracks.append(track(out))
    for other, most in zip(tracks[1:], (1e-9, 1e-6, 1e-3, 0.5), strict=True):
        assert np.abs(other[:, 8:11] - tracks[0][:, 8:11]).max() < most
        assert not np.array_equal(other, tracks[0])
    out = tmp_path / "none.csv"
    for word in (("--mechanisation", "geographic"), ("--engine", "c")):
        for options in forms[1:4]:
            said = refused("navigate", "stim300", turning, *PLACE, "-o", out, *word, *options)
            assert "--azimuth, --attitude and --level-every" in said
