"""What reaches before the first sample is never carried as valid: the run begins after it."""

from __future__ import annotations

import json
from collections.abc import Callable
from math import cosh, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fine_sensor import fine_design_file
from sculler.formats.truth import read_truth
from sculler.formats.vectors import read_vectors
from sculler_model.design import Design
from sculler_model.host import MajorIncrements, major_increments
from sculler_model.navigation import NavHistory, Navigator, navigation_errors
from sculler_model.samples import interval_end

Run = Callable[..., Any]
Refused = Callable[..., str]

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "examples" / "filtered_rate_2x10.toml"


def moved(run: Run, folder: Path, toml: Path, motion: str, *options: object) -> tuple[Path, Path]:
    """Vectors and truth of a motion."""
    log, truth, vectors = (folder / f"{what}.csv" for what in ("imu", "truth", "vectors"))
    words = ("motion", motion, "--design", toml, "-o", log, "--truth", truth, *options)
    assert run(*words).status == 0
    assert run("model", toml, log, "-o", vectors).status == 0
    return vectors, truth


def navigated(run: Run, toml: Path, vectors: Path, *options: object) -> dict[str, Any]:
    out = vectors.with_name("nav.csv")
    outcome = run("navigate", toml, vectors, "-o", out, "--no-plots", "--json", *options)
    assert outcome.status == 0, outcome
    said: dict[str, Any] = json.loads(outcome.out)
    return said


def carried(toml: Path, vectors: Path, truth: Path) -> tuple[NavHistory, NavHistory]:
    """What comes of carrying the short interval from the truth's first state on; and the truth."""
    design = Design.load(toml)
    increments = MajorIncrements.concatenate(
        [major_increments(design, block) for block in read_vectors(vectors, design)]
    )
    assert increments.leading_short == 1
    true = NavHistory.concatenate(list(read_truth(truth)))
    first = true.state(0)
    found = Navigator(first._replace(time=0.0), design.major_interval).run(
        increments.accepted_as_whole()[: len(true)]
    )
    return found, true


def test_the_shipped_rate_design_in_a_turn(run: Run, tmp_path: Path) -> None:
    """30 °/s for 60 s: 36″ and 5.9 mm/s with the first interval carried, 0.2″ and 0.3 mm/s."""
    words = ("turn", "--duration", 60, "--turn-rate", 30)
    vectors, truth = moved(run, tmp_path, EXAMPLE, *words)
    said = navigated(run, EXAMPLE, vectors, "--truth", truth)
    assert said["start_s"] == interval_end(Design.load(EXAMPLE), 0) == 0.019
    assert said["short_history_results_left_out"] == 1
    assert said["warnings"] == []
    errors = said["errors"]
    assert errors["instants"] == 3000
    assert errors["attitude_arcsec"]["total"]["max"] < 0.35
    assert errors["velocity_m_s"]["total"]["max"] < 0.35e-3
    outcome = run("navigate", EXAMPLE, vectors, "-o", tmp_path / "n.csv", "--truth", truth,
                  "--no-plots")  # fmt: skip
    text = " ".join(outcome.out.split())
    assert "1 result reached before the first sample (status bit 0) and cannot be carried" in text
    assert "at 0.019 s, where the initial state holds" in text


def test_at_rest_with_rates_of_200_hz(run: Run, tmp_path: Path) -> None:
    """Simpson's rule without its first sample loses a sixth of g over the first interval."""
    toml = fine_design_file(tmp_path, 2, 1, rate=200.0, kind="rate")
    vectors, truth = moved(run, tmp_path, toml, "rest", "--duration", 60)
    errors = navigated(run, toml, vectors, "--truth", truth)["errors"]
    assert errors["velocity_m_s"]["total"]["max"] < 1e-6
    assert abs(errors["position_m"]["down"]["final"]) < 1e-5
    found, true = carried(toml, vectors, truth)
    wrong = navigation_errors(found, true)
    # the missing sixth of an interval's g, 5 ms / 3 of it: 16 mm/s, and a metre of height
    assert wrong.velocity[0, 2] == pytest.approx(9.81 * 0.005 / 3, rel=1e-2)
    assert abs(wrong.position[-1, 2]) > 0.9


def test_high_resolution_for_an_hour_at_rest(run: Run, tmp_path: Path) -> None:
    """S_υ lacks g T²/12 of the first sample, which the free vertical channel makes 0.02 m of."""
    toml = tmp_path / "fine.toml"
    toml.write_text(
        fine_design_file(tmp_path, 2, 5, rate=100.0, core="compact")
        .read_text()
        .replace("minors = 5", 'minors = 5\nposition = "high-resolution"')
        .replace("lsb = 1e-11", "lsb = 1e-15")
        .replace("lsb = 1e-09", "lsb = 1e-10")
    )
    vectors, truth = moved(run, tmp_path, toml, "rest", "--duration", 3600)
    said = navigated(run, toml, vectors, "--truth", truth)
    assert said["start_s"] == pytest.approx(0.1)
    assert abs(said["errors"]["position_m"]["down"]["max"]) < 2e-6  # LSBs and rounding
    assert said["errors"]["position_m"]["horizontal"]["max"] < 1e-8
    found, true = carried(toml, vectors, truth)
    growth = cosh(3600 * sqrt(2 * 9.81 / (6.378e6)))
    down = navigation_errors(found, true.rows(slice(1, None))).position[:, 2]
    assert abs(down[-1]) == pytest.approx(9.81 * 0.01**2 / 12 * growth, rel=0.05)


def test_history_of_increments(run: Run, tmp_path: Path) -> None:
    """p > 0: coning of the first minor interval is incomplete."""
    toml = tmp_path / "history.toml"
    toml.write_text(
        fine_design_file(tmp_path, 2, 5).read_text().replace("minors", "history = 2\nminors")
    )
    vectors, truth = moved(run, tmp_path, toml, "coning", "--duration", 2, "--half-angle", 1)
    said = navigated(run, toml, vectors, "--truth", truth)
    assert said["start_s"] == pytest.approx(0.01)
    assert said["errors"]["attitude_arcsec"]["total"]["max"] < 0.03  # the third order of 10 ms
    place = ("--lat", 48, "--lon", 11, "--height", 500)
    assert navigated(run, toml, vectors, *place)["start_s"] == pytest.approx(0.01)


def test_a_start_inside_it_is_refused(run: Run, tmp_path: Path, refused: Refused) -> None:
    vectors, truth = moved(run, tmp_path, EXAMPLE, "rest", "--duration", 1)
    words = ("navigate", EXAMPLE, vectors, "-o", tmp_path / "nav.csv", "--truth", truth, "--start")
    line = refused(*words, 0)
    assert "the run cannot begin at 0 s, but from 0.019 s on" in line
    assert "status bit 0" in line
    assert navigated(run, EXAMPLE, vectors, "--truth", truth, "--start", 0.019)["start_s"] == 0.019


def test_alignment_leaves_it_out(run: Run, tmp_path: Path) -> None:
    """The window begins after it, and its end is on the log's clock."""
    toml = fine_design_file(tmp_path, 2, 5, rate=200.0, kind="rate")
    vectors, truth = moved(run, tmp_path, toml, "rest", "--duration", 40, "--heading", 30)
    said = navigated(run, toml, vectors, "--truth", truth, "--align", 20)
    assert said["start_s"] == pytest.approx(0.045 + 20)
    assert said["alignment"]["seconds"] == pytest.approx(20)
    assert said["short_history_results_left_out"] == 1
    assert said["start_attitude_deg"]["heading"] == pytest.approx(30, abs=1e-3)
    assert said["errors"]["attitude_arcsec"]["total"]["max"] < 5
    assert said["errors"]["velocity_m_s"]["total"]["max"] < 1e-4


def test_nothing_but_short_history(tmp_path: Path, run: Run, refused: Refused) -> None:
    log, truth, vectors = (tmp_path / f"{what}.csv" for what in ("imu", "truth", "vectors"))
    words = ("--design", EXAMPLE, "-o", log, "--truth", truth, "--duration", 0.02)
    assert run("motion", "rest", *words).status == 0
    assert run("model", EXAMPLE, log, "-o", vectors).status == 0
    place = ("--lat", 48, "--lon", 11, "--height", 500)
    nav = ("navigate", EXAMPLE, vectors, "-o", tmp_path / "nav.csv")
    assert "no results to navigate with" in refused(*nav, *place)
    assert np.loadtxt(truth, delimiter=",", skiprows=1, ndmin=2)[:, 0].tolist() == [0.019]
