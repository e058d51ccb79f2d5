"""`analyze`: each study tells the same in JSON and in a table, draws, and refuses what it must."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sculler_model.analysis.manoeuvre import MANOEUVRES
from sculler_model.design import Design
from sculler_model.samples import Quantiser
from tiers import few_of

Run = Callable[..., Any]
Refused = Callable[..., str]

FAMILY = ("--family", "frequency-taylor", "--samples", "2")
QUICK = {
    "coning": ("--points", "30", "--integer-points", "3", "--from", "30"),
    "sculling": ("--points", "30", "--integer-points", "3", "--from", "30"),
    "manoeuvre": ("--from", "150"),
    "quantisation": ("--levels", "3", "--trials", "3"),
}


@pytest.mark.parametrize("verb", few_of(list(QUICK), ["quantisation"]))
def test_json_table_and_picture(run: Run, tmp_path: Path, design: Path, verb: str) -> None:
    picture = tmp_path / "picture.png"
    words = ("analyze", verb, design, *FAMILY, *QUICK[verb])
    if verb in ("manoeuvre", "quantisation"):
        words = ("analyze", verb, "stim300", *FAMILY, *QUICK[verb])
    outcome = run(*words, "--json", "-o", picture)
    assert (outcome.status, outcome.err) == (0, "")
    data = json.loads(outcome.out)
    assert data["study"] == verb
    assert data["picture"] == str(picture)
    assert len(data["designs"]) == 2
    assert "frequency-taylor n=2" in data["designs"]
    assert picture.read_bytes().startswith(b"\x89PNG")
    first = picture.read_bytes()
    assert run(*words, "-o", picture).status == 0
    assert picture.read_bytes() == first  # the same data give the same bytes
    shown = run(*words)
    assert shown.status == 0
    assert all(name in shown.out for name in data["designs"])


def test_coning_of_the_family_is_the_published_law(run: Run) -> None:
    """n = 2: a²(Ωh)⁵/30 a minor interval, so ratio 2⁵ in frequency, and its requirement lines."""
    data = json.loads(run("analyze", "coning", *FAMILY, *QUICK["coning"], "--json").out)
    found = data["designs"]["frequency-taylor n=2"]
    assert found["law"]["constant"] == "-1/30"
    assert found["law"]["order"] == 5
    assert found["law"]["measured_constant"] == pytest.approx(-1 / 30, rel=1e-3)
    assert data["requirements"] == [1.7e-4, 1.7e-5]
    point = found["integer_path"][0]
    # 0.1°, 2 kHz: a² (2πf/2000)⁵/30 / (2/2000) rad/s
    a, phase = 0.1 * 3.141592653589793 / 180, 2 * 3.141592653589793 * point["hertz"] / 2000
    law = a * a * phase**5 / 30 * 1000 * 3600 * 180 / 3.141592653589793
    assert -point["closed_form"] == pytest.approx(law, rel=0.01)
    assert point["second_order"] == pytest.approx(point["closed_form"], rel=1e-4)
    wide = ("--from", "5", "--to", "100", "--points", "500", "--integer-points", "1")
    data = json.loads(run("analyze", "coning", *FAMILY, *wide, "--json").out)
    fast, slow = data["designs"]["frequency-taylor n=2"]["meets_up_to_hz"]
    assert fast / slow == pytest.approx(10**0.2, rel=0.01)
    assert point["hertz"] * (1.7e-5 / law) ** 0.2 == pytest.approx(slow, rel=0.02)


@pytest.mark.deep
def test_all_combinations_of_families_are_studied(run: Run) -> None:
    words = ("--family", "time-taylor", "--samples", "3", "--history", "0", "--history", "1")
    data = json.loads(run("analyze", "coning", *FAMILY, *words, *QUICK["coning"], "--json").out)
    assert list(data["designs"]) == [
        f"{family} n={n}" + (f" p={p}" if p else "")
        for family in ("frequency-taylor", "time-taylor")
        for n in (2, 3)
        for p in (0, 1)
    ]


def test_a_vibration_too_large_for_the_sensor_is_said(run: Run, design: Path) -> None:
    words = ("analyze", "coning", design, "--half-angle", "5", *QUICK["coning"])
    data = json.loads(run(*words, "--json").out)
    found = data["designs"]["little"]
    assert found["sensor"] == "own"
    assert found["does_not_fit_sensor_hz"]
    assert "does not fit the sensor's word" in run(*words).out
    fine = json.loads(run(*words, "--fine", "--json").out)["designs"]["little"]
    assert (fine["sensor"], fine["does_not_fit_sensor_hz"]) == ("fine", [])


def test_position_json_and_table(run: Run) -> None:
    words = ("analyze", "position", *FAMILY, "--minors", 10, "--over", 1)
    data = json.loads(run(*words, "--json").out)
    assert data["study"] == "position"
    (found,) = data["designs"].values()
    assert found["choice"] == "high-resolution"
    assert found["left"]["core"]["largest"] < 0.01 < found["left"]["trapezoid"]["largest"]
    calm = ("--no-vibration", "--peak-rate", 0.1, "--force-ramp", 0.001, "--peak-force", 0.1)
    assert "Hz: trapezoid" in run(*words, *calm).out


REFUSALS = {
    ("position", "stim300", "--no-vibration", "--rocking", "1"): "give --vibration too",
    ("position", "stim300", "--vibration", "1", "1000"): "Nyquist limit of stim300_4x5, 1000 Hz",
    ("position", "stim300", "--over", "1000"): "more than 1,000,000 samples",
    ("coning",): "nothing to analyze",
    ("coning", "nowhere.toml"): "no such design file",
    ("coning", "--family", "frequency-taylor"): "--family needs --samples",
    ("coning", "stim300", "--samples", "3"): "--samples belongs to --family",
    ("coning", "--family", "frequency-tailor", "--samples", "3"): "frequency-tailor",
    ("coning", "--family", "frequency-taylor", "--samples", "17"): "samples",
    ("coning", "--family", "least-squares", "--samples", "3"): "--band belong together",
    ("coning", *FAMILY, "--band", "0", "100"): "give both or none; see 'sculler analyze coning -",
    ("coning", "--family", "tuned", "--samples", "3"): "sensor.filter",
    ("coning", "stim300", "--to", "1200"): "above the Nyquist limit of 1000 Hz",
    ("coning", "stim300", "--from", "1200"): "leaves no band below 1000 Hz",
    ("coning", "stim300", "--half-angle", "0"): "a finite number > 0",
    ("sculling", "stim300", "-o", "picture.svg"): "pictures are PNG",
    ("manoeuvre", "hg4930"): "25 minor intervals a second, of which no whole number",
    ("manoeuvre", "stim300", "--manoeuvre", "loop"): "loop",
    ("quantisation", "stim300", "--trials", "1"): "1 is not in the range",
    ("quantisation", "stim300", "--frequency", "1000"): "Nyquist limit of 1000 Hz",
}


@pytest.mark.parametrize("words", REFUSALS, ids=" ".join)
def test_refuses(refused: Callable[..., str], words: tuple[str, ...]) -> None:
    assert REFUSALS[words] in refused("analyze", *words)


def test_navigate_takes_the_third_order(run: Run, tmp_path: Path) -> None:
    """The extreme manoeuvre at 50 Hz: 0.16 µrad more or less, seen in the attitude's digits."""
    path, log, vectors = tmp_path / "d.toml", tmp_path / "log.csv", tmp_path / "vectors.csv"
    path.write_text(
        'name = "d"\nsensor = {kind = "increment", sample_rate_hz = 200.0,'
        " gyro = {bits = 32, lsb = 2e-11}, accel = {bits = 24, lsb = 1e-6}}\n"
        'algorithm = {family = "frequency-taylor", samples = 2, minors = 2}\n'
    )
    design = Design.load(path)
    samples = Quantiser(design)(MANOEUVRES["extreme"].samples(design, 404))
    rows = [",".join(map(str, row)) for row in samples.tolist()]
    log.write_text("\n".join(["gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z", *rows]) + "\n")
    assert run("model", path, log, "-o", vectors).status == 0
    ends = []
    for name, words in (("plain.csv", ()), ("third.csv", ("--third-order",))):
        where = ("--lat", "48", "--lon", "11", "--height", "0", "--no-plots")
        outcome = run("navigate", path, vectors, "-o", tmp_path / name, *where, *words)
        assert outcome.status == 0
        assert ("101 intervals corrected" in " ".join(outcome.out.split())) == bool(words)
        last = (tmp_path / name).read_text().splitlines()[-1].split(",")
        ends.append(np.array(last[1:5], float))
    assert 1e-8 < np.abs(ends[0] - ends[1]).max() < 1e-6


def test_orders_of_coning_in_a_turn_and_of_a_manoeuvre(run: Run) -> None:
    """By the orders' powers: what is left of coning in a turn is third order, then nothing."""
    words = ("analyze", "orders", "stim300", "--minors", 5)
    cone = ("--half-angle", 0.1, "--frequency", 50, "--turn", 6, "--bank", 5, "--seconds", 1)
    found = json.loads(run(*words, *cone, "--json").out)["orders"]
    assert [row["order"] for row in found] == [2, 3, 4]
    assert [row["hand_over_hz"] for row in found] == pytest.approx([100] * 3)
    second, third, fourth = (row["attitude_arcsec"] for row in found)
    assert third < second / 200
    assert fourth < second / 500
    second, third, fourth = (row["velocity"] for row in found)
    assert third < second / 1000
    assert fourth < second / 1000
    said = run(*words, "--manoeuvre", "pitch-over").out
    assert "manoeuvre pitch-over, 3 s" in said


def test_orders_say_where_a_higher_one_is_worse(run: Run) -> None:
    """A turn takes from what order 2 leaves of a fast cone, and nothing from what order 3 does."""
    words = ("analyze", "orders", "stim300", "--minors", 1, "--seconds", 0.2, "--half-angle", 10)
    words = (*words, "--frequency", 200)
    told = json.loads(run(*words, "--spin", 360, "--json").out)["warnings"]
    assert [line[:33] for line in told] == ["M = 1: order 3 leaves 1.4e+03″ wh"]
    assert told[0].endswith("take order 4 or a shorter major interval")
    assert told[0] in run(*words, "--spin", 360).out
    assert json.loads(run(*words, "--json").out)["warnings"] == []


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--frequency", 1000), "--frequency: 1000 Hz is not below the Nyquist limit, 1000 Hz"),
        (("--seconds", 0.001), "--seconds: 0.001 is too short, give at least 0.01"),
        (("--manoeuvre", "extreme", "--turn", 3), "--turn is of a cone, leave it out with"),
    ],
)
def test_orders_refuses(refused: Refused, words: tuple[object, ...], message: str) -> None:
    assert message in refused("analyze", "orders", "stim300", *words)


def test_third_order_table_and_json(run: Run) -> None:
    words = ("analyze", "third-order", "stim300", "--minors", 5, "--turn", 6, "--seconds", 4)
    found = json.loads(run(*words, "--json").out)
    (row,) = found["minors"]
    # of third order: the integers mend it, and without a turn there is hardly any
    assert row["integers"] < row["second_order"] / 100
    (still,) = json.loads(run(*words, "--turn", 0, "--json").out)["minors"]
    assert still["second_order"] < row["second_order"] / 100
    assert "second order" in run(*words).out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--frequency", 1000), "--frequency: 1000 Hz is not below the Nyquist limit, 1000 Hz"),
        (("--seconds", 0.001), "--seconds: 0.001 is too short, give at least 0.02"),
    ],
)
def test_third_order_refuses(refused: Refused, words: tuple[object, ...], message: str) -> None:
    assert message in refused("analyze", "third-order", "stim300", *words)
