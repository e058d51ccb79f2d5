"""`motion`: logs whose counts add up to the motion, and truths that are the motion's."""

from __future__ import annotations

import csv
import inspect
import json
from collections.abc import Callable
from math import cos, radians, sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sculler.commands.options import motion as options
from sculler.formats.log import read_log
from sculler.formats.truth import read_truth
from sculler_model.design import Design
from sculler_model.motion import MOTIONS, Vibration, coning
from sculler_model.navigation import NavHistory

Run = Callable[..., Any]
Refused = Callable[..., str]

EARTH = 7.292115e-5
COLUMNS = (
    "time_s,q_w,q_x,q_y,q_z,roll_deg,pitch_deg,heading_deg,"
    "v_north,v_east,v_down,lat_deg,lon_deg,height_m"
)


def written(run: Run, folder: Path, *words: object) -> tuple[np.ndarray, NavHistory, dict]:
    """Counts, truth and what was said."""
    log, truth = folder / "imu.csv", folder / "truth.csv"
    outcome = run("motion", *words, "-o", log, "--truth", truth, "--json")
    assert (outcome.status, outcome.err) == (0, ""), outcome
    said = json.loads(outcome.out)
    assert (said["output"], said["truth"]) == (str(log), str(truth))
    counts = np.concatenate([c for c, *_ in read_log(log, Design.preset("stim300"))])
    return counts, NavHistory.concatenate(list(read_truth(truth))), said


def test_at_rest_the_counts_are_earth_rate_and_gravity(run: Run, tmp_path: Path) -> None:
    counts, truth, said = written(
        run,
        tmp_path,
        *("rest", "--design", "stim300", "--duration", 20, "--lat", 40, "--heading", 30),
    )
    design = Design.preset("stim300")
    assert (said["samples"], len(counts)) == (40_000, 40_000)
    rate = counts[:, :3].sum(axis=0) * design.sensor.gyro.lsb / 20
    force = counts[:, 3:].sum(axis=0) * design.sensor.accel.lsb / 20
    north, down = EARTH * cos(radians(40)), -EARTH * sin(radians(40))
    expected = [north * cos(radians(30)), -north * sin(radians(30)), down]
    # the remainder is carried: half a count at the end is all that is missing
    assert rate == pytest.approx(expected, abs=0.51 * design.sensor.gyro.lsb / 20)
    leaning = 4.0106e-6  # of the normal field's gravity to the equator, at 40° and 500 m
    assert force[:2] == pytest.approx(
        [leaning * cos(radians(30)), -leaning * sin(radians(30))],
        abs=0.52 * design.sensor.accel.lsb / 20,
    )
    assert force[2] == pytest.approx(-9.8002, abs=3e-4)  # 9.80170 at 40°, 500 m up: -0.00154
    assert len(truth) == said["truth_rows"] == 2001
    assert truth.time == pytest.approx(0.01 * np.arange(2001), abs=1e-12)
    assert np.ptp(truth.lat) == np.ptp(truth.h) == 0
    assert np.degrees(truth.euler[0]) == pytest.approx([0, 0, 30], abs=1e-12)
    assert (tmp_path / "truth.csv").read_text().splitlines()[0] == COLUMNS


def test_options_reach_the_motion_and_the_truth_keeps_every_digit(run: Run, tmp_path: Path) -> None:
    words = ("coning", "--design", "stim300", "--duration", 1, "--half-angle", 2)
    words += ("--frequency", 30, "--lat", -20, "--lon", 170, "--height", 8000)
    _, truth, said = written(run, tmp_path, *words, "--truth-every", 0.003)
    expected = coning(radians(-20), radians(170), 8000, radians(2), 30.0)
    assert truth.time == pytest.approx(0.003 * np.arange(334))
    state = expected.state(truth.time)
    assert np.abs(truth.q - state.q).max() < 4e-16
    assert np.abs(truth.lon - state.lon).max() < 1e-15
    assert said["options"] == {
        "lat": -20,
        "lon": 170,
        "h": 8000,
        "half_angle": 2,
        "hertz": 30,
    }


def test_vibration_on_top(run: Run, tmp_path: Path) -> None:
    words = ("rest", "--design", "stim300", "--duration", 8, "--vibration", 0.5)
    words += ("--vibration-rate", 3, "--vibration-band", "30-90", "--seed", 4)
    counts, truth, said = written(run, tmp_path, *words)
    design = Design.preset("stim300")
    force = counts[:, 3] * design.sensor.accel.lsb * 2000
    rate = counts[:, 0] * design.sensor.gyro.lsb * 2000
    assert force.std() == pytest.approx(0.5 * 9.80665, rel=0.1)
    assert rate.std() == pytest.approx(radians(3), rel=0.1)
    assert said["vibration"]["band_hz"] == [30, 90]
    shake = Vibration(0.5 * 9.80665, radians(3), 30, 90, 20, 4)
    state = shake.on(MOTIONS["rest"].make(radians(48), radians(11), 500)).state(truth.time)
    assert np.abs(truth.v - state.v).max() < 1e-15


@pytest.mark.parametrize("name", options.NAMES)
def test_every_motion_by_its_name(run: Run, tmp_path: Path, name: str) -> None:
    counts, truth, said = written(run, tmp_path, name, "--design", "stim300", "--duration", 0.5)
    assert (len(counts), len(truth), said["motion"]) == (1000, 51, name)
    assert np.allclose(np.linalg.norm(truth.q, axis=1), 1, atol=1e-15)


def test_the_help_names_the_catalogue(run: Run) -> None:
    assert tuple(options.NAMES) == tuple(MOTIONS)
    used = {name for entry in MOTIONS.values() for name in inspect.signature(entry.make).parameters}
    assert used - {"gone"} == set(options.OPTIONS)
    out = run("motion", "--help").out
    assert all(name in out for name in MOTIONS)
    for option in options.OPTIONS.values():
        assert option.flag in out


def test_a_rate_sensor_gets_filtered_rates(run: Run, tmp_path: Path) -> None:
    design = Path(__file__).parents[2] / "examples/filtered_rate_2x10.toml"
    log, truth = tmp_path / "imu.csv", tmp_path / "truth.csv"
    words = ("turn", "--design", design, "--duration", 2, "-o", log, "--truth", truth)
    assert run("motion", *words, "--turn-rate", 90, "--speed", 10).status == 0
    with log.open() as file:
        rows = np.array([[int(v) for v in row.values()] for row in csv.DictReader(file)])
    # a coordinated turn: the rate about down, turned into the banked body
    bank = np.arctan2(10 * np.pi / 2, 9.81)
    rate = rows[:, :3].mean(axis=0) * 2e-5
    assert rate == pytest.approx([0, np.pi / 2 * sin(bank), np.pi / 2 * cos(bank)], abs=1e-4)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("fly",), "'fly' is not one of 'rest', 'coning'"),
        (("rest", "--speed", 3), "--speed does not belong to the motion rest"),
        (("demo", "--lat", 3), "--lat does not belong to the motion demo, whose options are none"),
        (("rest", "--duration", 0), "give a finite number > 0"),
        (("rest", "--duration", 1e-9), "shorter than a sample"),
        (("rest", "--lat", 91), "<= 90"),
        (("rest", "--lat", "nan"), "give a finite number"),
        (("turn", "--lat", 90), "within 0.1° of a pole"),
        (("turn", "--turn-rate", 0), "> 0"),
        (("rest", "--truth-every", -1), "> 0"),
        (("rest", "--vibration", 1, "--vibration-band", "20"), "give LOW-HIGH in Hz"),
        (("rest", "--vibration", 1, "--vibration-band", "90-20"), "90 to 20 Hz"),
        (("rest", "--vibration", 1, "--vibration-band", "a-b"), "give LOW-HIGH in Hz"),
        (("rest", "--vibration-lines", 0), "0 is not in the range"),
        (("spin-cone", "--spin-rate", 90_000, "--duration", 1), "does not fit 24 bits"),
    ],
)
def test_faults(tmp_path: Path, refused: Refused, words: tuple[object, ...], message: str) -> None:
    files = ("-o", tmp_path / "imu.csv", "--truth", tmp_path / "truth.csv")
    assert message in refused("motion", *words, "--design", "stim300", *files)


def test_files(tmp_path: Path, refused: Refused) -> None:
    words = ("motion", "rest", "--design", "stim300", "--duration", 1)
    one = tmp_path / "one.csv"
    assert "two outputs of this command" in refused(*words, "-o", one, "--truth", one)
    absent = tmp_path / "absent" / "truth.csv"
    assert "cannot write to folder" in refused(*words, "-o", one, "--truth", absent)
    assert "Missing option '--truth'" in refused(*words, "-o", one)
    missing = tmp_path / "no.toml"
    words = ("motion", "rest", "--design", missing, "-o", one, "--truth", tmp_path / "t.csv")
    assert "no such design file" in refused(*words)


def test_the_log_streams(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same bytes whatever the size of the chunks."""
    from sculler_model.motion import sampling

    outs = []
    for chunk in (1 << 15, 33):
        monkeypatch.setattr(sampling, "CHUNK", chunk)
        written(run, tmp_path, "turn", "--design", "stim300", "--duration", 1)
        outs.append(((tmp_path / "imu.csv").read_bytes(), (tmp_path / "truth.csv").read_bytes()))
    assert outs[0] == outs[1]


def test_allan_deviation_of_what_was_made(run: Run, refused: Refused, tmp_path: Path) -> None:
    """Beside what was asked for; white noise of 0.15 °/√h is 9 °/h at 1 s."""
    design, picture = tmp_path / "d.toml", tmp_path / "allan.png"
    design.write_text(
        'preset = "stim300"\nname = "d"\n[sensor.errors]\n'
        "gyro = { random_walk = 0.15, bias = 5.0 }\naccel = { random_walk = 0.06 }\n"
    )
    words = ("rest", "--design", design, "--duration", 20)
    _, _, said = written(run, tmp_path, *words, "--allan", picture)
    found = said["allan"]
    assert picture.exists()
    at = int(np.argmin(np.abs(np.array(found["tau_s"]) - 1)))
    assert found["gyro_asked_deg_per_h"][at] == pytest.approx(
        9 / found["tau_s"][at] ** 0.5, rel=0.01
    )
    assert np.mean(found["gyro_deg_per_h"][at]) == pytest.approx(
        found["gyro_asked_deg_per_h"][at], rel=0.25
    )
    assert found["worst_ratio"] < 1.3
    assert "allan" not in written(run, tmp_path, *words)[2]
    outputs = ("-o", tmp_path / "x.csv", "--truth", tmp_path / "y.csv")
    short = ("motion", "rest", "--design", design, "--duration", 0.0025)
    assert "5 samples are too few" in refused(*short, *outputs, "--allan", picture)
    assert "pictures are PNG" in refused(*short, *outputs, "--allan", tmp_path / "a.svg")
