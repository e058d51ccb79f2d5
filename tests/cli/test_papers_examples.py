"""Yang's and Zeng's example motions end to end: log, emitted Verilog, navigator, truth.

Both are classical coning, Yang Eq. 5 and Zeng section VI (1° half angle, 20 Hz, samples of 1 ms);
Yang's sculling is its dual (his Eq. 4).  Neither paper prints a number for what is left; they print
laws and orders of magnitude, and these are what the runs are held against.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from math import cos, degrees, pi, radians, sin
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

from fine_sensor import fine_design_file
from sculler.formats.log import read_log
from sculler.formats.truth import read_truth
from sculler_model.analysis.closed_form import drift_rate
from sculler_model.design import Design
from sculler_model.frames import (
    conjugate,
    from_rotation_vector,
    normalised,
    product,
    to_rotation_vector,
)
from sculler_model.navigation import NavHistory

Run = Callable[..., Any]

RATE, HALF_ANGLE, OMEGA = 1000.0, radians(1.0), 2 * pi * 20
START, SECONDS = 0.1, 5.0
"""Whole cycles of the motion and whole major intervals of every design: the ripple cancels.

Of rates the last one is at 4.999 s, where the last interval ends; they begin as much earlier."""


class Flown(NamedTuple):
    """Files of a run, and the errors that `navigate` told."""

    design: Design
    log: Path
    truth: Path
    errors: dict[str, Any]
    start: float

    def drift(self, quantity: str) -> float:
        """Error about, or along, down at the end over the time: °/h, or m/s²."""
        return float(self.errors[quantity]["down"]["final"]) / (SECONDS - START)


@pytest.fixture
def flown(run: Run, tmp_path: Path) -> Callable[..., Flown]:
    """Run a motion through the Verilog of a design, and through the golden model as well."""

    def flown(motion: str, kind: str, samples: int, minors: int, core: str) -> Flown:
        toml = fine_design_file(tmp_path, samples, minors, RATE, kind, core)
        log, truth, rtl, model, nav = (
            tmp_path / f"{name}.csv" for name in ("imu", "truth", "rtl", "model", "nav")
        )
        for words in (
            ("motion", motion, "--design", toml, "-o", log, "--truth", truth, "--duration", 5),
            ("simulate", toml, log, "-o", rtl, "--engine", "verilator"),
            ("model", toml, log, "-o", model),
            ("compare", rtl, model),
        ):
            outcome = run(*words)
            assert outcome.status == 0, outcome
        start = START - (1 / RATE if kind == "rate" else 0.0)
        words = ("navigate", toml, rtl, "-o", nav, "--truth", truth, "--start", start)
        outcome = run(*words, "--no-plots", "--json")
        assert outcome.status == 0, outcome
        return Flown(Design.load(toml), log, truth, json.loads(outcome.out)["errors"], start)

    return flown


@pytest.mark.deep
def test_yang_two_samples_leave_a_thirtieth(flown: Callable[..., Flown]) -> None:
    """a² λ⁵/30 every two samples, the residual of Yang's coefficients for n = 2."""
    found = flown("coning", "increment", 2, 1, "compact").drift("attitude_arcsec")
    law = HALF_ANGLE**2 * (OMEGA / RATE) ** 5 / 30 / (2 / RATE)
    assert found == pytest.approx(-degrees(law) * 3600, rel=5e-3)


@pytest.mark.deep
def test_yang_four_samples_five_minors(flown: Callable[..., Flown]) -> None:
    """Nothing is left of the second order (4e-7 °/h); the third order of 20 ms is: 0.107 °/h."""
    found = flown("coning", "increment", 4, 5, "pipelined").drift("attitude_arcsec")
    assert found == pytest.approx(-0.107, rel=5e-3)


@pytest.mark.deep
def test_yang_sculling_is_the_dual_of_coning(flown: Callable[..., Flown]) -> None:
    """The same law for 0.1° and 10 m/s² at 35 Hz, and gravity's own 0.017 m/s² along y."""
    found = flown("sculling", "increment", 2, 1, "compact").drift("velocity_m_s")
    omega = 2 * pi * 35
    law = radians(0.1) * (10 / omega) * (omega / RATE) ** 5 / 30 / (2 / RATE)
    assert abs(found) == pytest.approx(law, rel=0.02)


@pytest.mark.deep
def test_zeng_two_samples_of_filtered_rate(flown: Callable[..., Flown]) -> None:
    """1.07e-2 °/h, "two orders of magnitude" better than Runge-Kutta on the very same samples."""
    run = flown("coning", "rate", 2, 1, "compact")
    found, a = run.drift("attitude_arcsec"), sin(HALF_ANGLE)
    exact = drift_rate(run.design.table, a, a, OMEGA, 1 / RATE, "rate")
    assert found == pytest.approx(degrees(float(exact)) * 3600, rel=3e-3)
    assert found == pytest.approx(1.07e-2, rel=5e-3)
    classical = runge_kutta_drift(run)
    assert classical == pytest.approx(-5.16, abs=0.01)
    assert abs(classical / found) > 100


@pytest.mark.deep
def test_zeng_four_samples_are_better_than_two(flown: Callable[..., Flown]) -> None:
    """His Fig. 4; what is left is of the third order, as the second leaves 6e-5 °/h."""
    assert abs(flown("coning", "rate", 4, 1, "compact").drift("attitude_arcsec")) < 3e-4


def runge_kutta_drift(run: Flown) -> float:
    """Drift about down (°/h) of the classical two-sample, fourth-order Runge-Kutta quaternion.

    Steps of two samples; the rates at their beginning, middle and end.
    """
    counts = np.concatenate([counts for counts, *_ in read_log(run.log, run.design)])
    rates = (counts[:, :3] * run.design.sensor.gyro.lsb).tolist()
    truth = NavHistory.concatenate(list(read_truth(run.truth)))
    h, first = 2 / RATE, round(run.start * RATE)  # sample i is taken at i ms

    def slope(q: tuple[float, ...], rate: list[float]) -> np.ndarray[Any, np.dtype[np.float64]]:
        return 0.5 * np.array(product(q, (0.0, *rate)))

    q = truth.state(int(np.argmin(abs(truth.time - run.start)))).q
    for i in range(first, len(rates) - 2, 2):
        now, begin, middle, end = np.array(q), *rates[i : i + 3]
        k1 = slope(q, begin)
        k2 = slope((*(now + 0.5 * h * k1),), middle)
        k3 = slope((*(now + 0.5 * h * k2),), middle)
        k4 = slope((*(now + h * k3),), end)
        q = normalised((*(now + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)).tolist(),))
    turned = 7.292115e-5 * (SECONDS - START)  # of north-east-down, about the Earth's axis
    lat = float(truth.lat[0])
    back = from_rotation_vector((-turned * cos(lat), 0.0, turned * sin(lat)))
    error = to_rotation_vector(product(product(back, q), conjugate(truth.state(-1).q)))
    return degrees(error[2]) * 3600 / (SECONDS - START)
