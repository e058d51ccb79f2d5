"""`sculler advise`: the ranking as JSON and to read, the file it writes, exit status, refusals."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from sculler.runs.speeds import Speed, speeds
from sculler_hdl import ExpectedRate, placed_designs
from sculler_model.design import Design

Run = Callable[..., Any]
CONING = ("--coning", 0.1, 50, "--drift", 1e-3)


def test_ranking_and_the_cheapest_as_a_design_file(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "best.toml"
    outcome = run("advise", "stim300", *CONING, "-o", path, "--json")
    assert (outcome.status, outcome.err) == (0, "")
    data = json.loads(outcome.out)
    work = [found["cost"]["work"] for found in data["meet"]]
    assert work == sorted(work)
    assert all(found["drift_deg_per_h"] <= 1e-3 and not found["faults"] for found in data["meet"])
    assert all(found["faults"] for found in data["fail"])
    best = Design.load(path)
    assert best.name == data["meet"][0]["name"]
    assert best == Design.parse(data["meet"][0]["design"])
    assert run("coefficients", "--design", path, "--json").status == 0


def test_fitted_designs_are_written_whole(run: Run, tmp_path: Path) -> None:
    """A band with its weights goes into the file and comes back the same."""
    from sculler.runs.advice import write_design

    data = json.loads(
        run("advise", "stim300", "--spectrum", "savage-98", "--drift", 1e-3, "--json").out
    )
    fitted = next(f for f in data["meet"] if f["family"] == "least-squares")
    design = Design.parse(fitted["design"])
    write_design(tmp_path / "fitted.toml", design)
    assert Design.load(tmp_path / "fitted.toml") == design


def test_readable(run: Run) -> None:
    outcome = run("advise", "stim300", *CONING)
    assert outcome.status == 0
    for word in ("designs meet it", "frequency-taylor", "coning leaves", "--all"):
        assert word in outcome.out


def test_the_order_that_a_motion_needs(run: Run) -> None:
    words = ("advise", "stim300", "--coning", 20, 20, "--drift", 1, "--peak-rate", 0)
    outcome = run(*words)
    assert outcome.status == 0
    assert "this design needs order 4" in outcome.out
    assert "order 2 is enough" in run("advise", "stim300", *CONING).out
    data = json.loads(run(*words, "--json").out)
    assert [found["order"] for found in data["orders"]] == [2, 3, 4]
    assert data["meet"][0] == data["orders"][2]


def test_clock_rates_to_count_on(run: Run, tmp_path: Path) -> None:
    """Of the cheapest: in each core and target that was placed, or in the design file's own."""
    data = json.loads(run("advise", "stim300", *CONING, "--json").out)
    best = data["meet"][0]
    assert {(each["core"], each["target"]) for each in data["speeds"]} == {
        (one.kind.core, one.kind.target) for one in placed_designs() if not one.tuned
    }
    for each in data["speeds"]:
        if each["expected_mhz"] is None:
            assert (each["samples_per_second"], each["fits"]) == (None, None)
            assert each["basis"].startswith("not placed: ")
        else:
            taken = 1e6 * each["expected_mhz"] / each["clocks_per_sample"]
            assert each["samples_per_second"] == pytest.approx(taken)
            assert each["fits"] == (taken >= best["sample_rate_hz"])
    path = tmp_path / "mine.toml"
    path.write_text(
        'name = "mine"\npreset = "stim300"\n[hardware]\ncore = "compact"\ntarget = "gowin"\n'
    )
    outcome = run("advise", path, *CONING)
    assert "compact, gowin" in outcome.out
    assert "unknown" in outcome.out
    (alone,) = json.loads(run("advise", path, *CONING, "--json").out)["speeds"]
    assert alone["basis"] == "not placed: no compact core with target gowin was"
    assert alone["clocks_per_sample"] > 1


def test_samples_that_do_not_fit() -> None:
    """At 50 MHz and 100 clocks a sample half a million a second fit, and one more does not."""
    rate = ExpectedRate(50.0, "made up")
    data = {"preset": "stim300", "hardware": {"core": "compact", "target": "ice40"}}
    for asked, fits in ((500_000.0, True), (500_001.0, False)):
        design = Design.parse(data | {"sensor": {"sample_rate_hz": asked}})
        speed = Speed(design, 100.0, rate)
        assert (speed.samples_per_second, speed.fits) == (500_000.0, fits)


@pytest.mark.parametrize(
    ("hardware", "marks"),
    [
        ({"core": "compact", "channels": 16}, "channels"),
        ({"hardening": "detect", "clock_enable": True}, "hardening detect, a clock enable"),
        ({"handover": "stream", "multipliers": 20}, "limited multipliers, a stream"),
    ],
)
def test_a_rate_is_that_of_all_the_hardware_that_is_asked_for(
    hardware: dict[str, Any], marks: str
) -> None:
    """No plain core's rate where no such core was placed."""
    base = Design.parse({"preset": "stim300", "hardware": {"target": "ecp5"} | hardware})
    (speed,) = speeds(Design.preset("stim300"), base)
    assert (speed.rate.mhz, speed.fits) == (None, None)
    assert f", {marks}; ecp5)" in speed.rate.basis


def test_samples_of_all_channels_have_to_fit() -> None:
    """16 units at 2 kHz: 32,000 samples a second, at 50 MHz 1562.5 clocks each."""
    data = {"preset": "stim300", "sensor": {"sample_rate_hz": 2000.0}}
    design = Design.parse(data | {"hardware": {"core": "compact", "channels": 16}})
    for clocks, fits in ((1562.5, True), (1562.6, False)):
        assert Speed(design, clocks, ExpectedRate(50.0, "made up")).fits == fits


def test_multipliers_that_are_too_few_are_told() -> None:
    data = {"preset": "stim300", "hardware": {"target": "ecp5", "multipliers": 1}}
    base = Design.parse(data)
    (speed,) = speeds(Design.preset("stim300"), base)
    assert (speed.clocks_per_sample, speed.samples_per_second, speed.fits) == (None, None, None)
    assert "hardware.multipliers" in speed.rate.basis


def test_nothing_meets(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "best.toml"
    words = ("--coning", 10, 100, "--drift", 1e-9, "-o", path)
    outcome = run("advise", "stim300", *words)
    assert outcome.status == 1
    assert outcome.err == ""
    assert "none of" in outcome.out
    assert not path.exists()


def test_a_navigators_budget(run: Run) -> None:
    outcome = run("advise", "--nmi-per-hour", 0.1)
    assert outcome.status == 0
    assert "gravity" in outcome.out
    assert "1.7e-05" in outcome.out
    words = ("--nmi-per-hour", 1, "--gyro-bias", 0.02, "--share", 2, "--json")
    found = json.loads(run("advise", *words).out)["budget"]
    assert found["algorithm"]["drift_deg_per_h"] == pytest.approx(2 * 1.67e-4, rel=0.01)
    assert found["too_much"] == ["gyro bias"]


@pytest.mark.deep
def test_a_budget_is_the_requirement_of_the_ranking(run: Run) -> None:
    words = ("advise", "stim300", "--coning", 0.1, 50, "--nmi-per-hour", 1, "--json")
    data = json.loads(run(*words).out)
    limit = data["budget"]["algorithm"]["drift_deg_per_h"]
    assert data["meet"]
    assert all(found["drift_deg_per_h"] <= limit for found in data["meet"])


@pytest.mark.deep
def test_a_manoeuvre_file_and_a_position(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "roll.csv"
    rows = ["0,0,0,0,0,0,0", "0.2,40,5,0,0,1,-1", "0.4,0,0,0,0,0,-1"]
    path.write_text("\n".join(["time_s,rate_x,rate_y,rate_z,force_x,force_y,force_z", *rows, ""]))
    words = ("advise", "stim300", "--manoeuvre", path, "--angle", 1e-3, "--position", 1)
    data = json.loads(run(*words, "--host-rate", 400, "--json").out)
    best = data["meet"][0]
    assert best["angle_deg"] <= 1e-3
    assert best["position_cm"] <= 1
    assert best["major_rate_hz"] >= 400


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--coning", 0.1, 50, "--gyro-bias", 1, "--drift", 1), "need --nmi-per-hour"),
        ((*CONING, "--angle", 1), "--angle needs --manoeuvre"),
        (("--sculling", 0.1, 1, 35, "--drift", 1), "--drift needs --spectrum or --coning"),
        ((*CONING, "--position", 1), "--position needs --peak-force"),
        (("--manoeuvre", "nowhere.csv", "--angle", 1), "nowhere.csv"),
        (("--drift", 1), "give an environment"),
        (("--spectrum", "savage-98", *CONING), "give an environment"),
        (("--coning", 0.1, 50), "give a requirement"),
        ((*CONING, "--force", 1), "--force needs --spectrum"),
        (("--coning", 60, 50, "--drift", 1), "60° is not allowed"),
        (("--coning", 1, 1000, "--drift", 1), "Nyquist limit of 1000 Hz"),
        (("--spectrum", "nowhere", "--drift", 1), "nowhere: no such spectrum"),
        (("--spectrum", "flat:1", "--drift", 1), "flat:LOW-HIGH:DENSITY"),
        (("--spectrum", "savage-98", "--drift", 1, "--imbalance", 101), "<= 100"),
        (("--spectrum", "savage-98", "--drift", 0), "> 0"),
    ],
)
def test_faults(refused: Callable[..., str], words: tuple[object, ...], message: str) -> None:
    assert message in refused("advise", "stim300", *words)


def test_a_sensors_burden_needs_the_sensor(refused: Callable[..., str]) -> None:
    assert "give a DESIGN" in refused("advise")
    assert "needs its DESIGN" in refused("advise", "--nmi-per-hour", 1, "--coning", 0.1, 50)
