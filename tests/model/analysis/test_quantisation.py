"""Quantisation: the bilinear form against the algorithm itself, theory against Monte Carlo."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from math import cos, pi, radians, sin

import numpy as np
import pytest

from host_path import fine_design
from sculler_model.analysis import quantisation
from sculler_model.analysis.closed_form import drift_rate
from sculler_model.analysis.integer_path import unquantised
from sculler_model.analysis.quantisation import (
    deviation,
    draws,
    form,
    levels,
    monte_carlo,
    products_with,
)
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.golden import GoldenModel
from sculler_model.motion import Coning
from sculler_model.samples import Quantiser

CASES = [(2, 0, 3, "increment"), (3, 2, 2, "increment"), (2, 0, 2, "rate"), (4, 0, 1, "rate")]


def designed(samples: int, history: int, minors: int, kind: str) -> Design:
    return fine_design(samples, history, minors, kind=kind, rate=1.0 if kind == "rate" else 2000.0)


@pytest.mark.parametrize("case", CASES)
def test_the_form_is_the_correction_of_the_whole_record(case: tuple[int, int, int, str]) -> None:
    """s_xᵀ K s_y against the algorithm, its major intervals put together to second order."""
    design = designed(*case)
    s = np.random.default_rng(1).normal(size=(6 * design.samples_per_major, 3))
    phi, alpha = unquantised(design, np.hstack([s, np.zeros_like(s)]))
    before = np.cumsum(alpha, axis=0) - alpha
    whole = (phi - alpha + 0.5 * np.cross(before, alpha)).sum(axis=0)
    found = s[:, 0] @ products_with(design.table, s[:, 1])
    assert found == pytest.approx(whole[2], rel=1e-12)
    assert s[:, 1] @ products_with(design.table, s[:, 0]) == pytest.approx(-whole[2], rel=1e-12)


@pytest.mark.parametrize("case", CASES[:2])
def test_only_near_remainders_meet_where_all_samples_count_alike(
    case: tuple[int, int, int, str],
) -> None:
    design = designed(*case)
    B = form(design.table, 8)
    reach = design.table.reach + design.table.samples
    far = np.abs(np.subtract.outer(np.arange(len(B)), np.arange(len(B)))) > reach + 1
    assert np.abs(B[far]).max() < 1e-13
    assert np.abs(B).max() > 0.5


def test_far_remainders_meet_where_weights_differ() -> None:
    B = form(designed(*CASES[2]).table, 8)
    assert abs(B[2, -3]) > 0.1


def test_theory_of_a_record_is_its_matrix() -> None:
    """The square term by the whole matrix, at an LSB so large that it rules."""
    design = fine_design(4, rate=2000.0)
    n, minors = 4, 60
    square = float(np.sum(form(design.table, minors) ** 2))
    expected = np.sqrt(1 / 144 * square) / (n * minors / 2000.0)
    found = deviation(design, 1e-9, 50.0, 1.0, n * minors)
    assert found == pytest.approx(expected, rel=0.03)  # the record's ends


@pytest.mark.parametrize(
    "case", [(4, 0, 5, "increment"), (2, 1, 4, "increment"), (2, 0, 2, "rate")]
)
def test_monte_carlo_agrees_with_theory(case: tuple[int, int, int, str]) -> None:
    samples, history, minors, kind = case
    design = fine_design(samples, history, minors, kind=kind)
    trials, ratios = 60, []
    for lsb in (3e-9, 4e-7):
        level = monte_carlo(design, radians(0.1), 37.0, lsb, trials, seed=2)
        assert abs(level.mean) < 4 * level.theory / np.sqrt(trials)
        ratios.append(level.deviation / level.theory)
        assert (level.angle_error is None) == (kind == "rate")
        assert level.angle_error is None or 0 < level.angle_error <= 1.001
    assert np.sqrt(np.mean(np.square(ratios))) == pytest.approx(1, abs=0.25)


def one_trial(
    design: Design, half_angle: float, hertz: float, seconds: float, random: np.random.Generator
) -> tuple[float, float]:
    """Drift (rad/s) and angle error (LSB) of one trial, by the reference in plain integers."""
    T, lsb, table = design.sample_interval, design.sensor.gyro.lsb, design.table
    rate, omega = design.sensor.kind == "rate", 2 * pi * hertz
    half_angle *= random.uniform(0.98, 1.02)
    turn, remainder = random.uniform(0, 2 * pi), random.uniform(-0.5, 0.5, 3)
    before = (table.history + design.samples_per_major) // design.samples_per_major
    count = round(seconds / T) + before * design.samples_per_major
    cone = Coning(half_angle, omega)
    samples = cone.rates(count, T, 1) if rate else cone.increments(count, T)
    x, y = samples[:, 0].copy(), samples[:, 1].copy()
    samples[:, 0], samples[:, 1] = cos(turn) * x - sin(turn) * y, sin(turn) * x + cos(turn) * y
    record = samples[before * design.samples_per_major :, :3]
    true_angle = record.sum(axis=0)
    samples[0, :3] += lsb * remainder
    counts = Quantiser(design)(samples).tolist()
    results = list(GoldenModel(design).run((row[:3], row[3:], 0) for row in counts))[before:]
    Dc, Dw = table.denominator, table.sum_denominator
    coning, alpha = Fraction(0), [Fraction(0)] * 3
    for result in results:
        angle = [Fraction(part, Dw) for part in result.alpha]
        coning += (alpha[0] * angle[1] - alpha[1] * angle[0]) / 2
        coning += Fraction(result.coning_within[2], Dc)
        coning += Fraction(result.coning_between[2], 2 * Dw * Dw)
        alpha = [sum(pair) for pair in zip(alpha, angle, strict=True)]
    a = sin(half_angle)
    known = float(drift_rate(table, a, a, omega, T, design.sensor.kind)) + omega * a * a / 2
    error = max(abs(float(part) - true / lsb) for part, true in zip(alpha, true_angle, strict=True))
    return float(coning) * design.gyro_scale**2 / seconds - known, error


@pytest.mark.parametrize("together", [1, 500, 1 << 17])
@pytest.mark.parametrize(
    ("case", "lsb"),
    [((2, 1, 2, "increment"), 5e-6), ((2, 0, 2, "rate"), 1e-6), ((1, 1, 1, "increment"), 2e-4)],
)
def test_trials_together_are_trials_one_by_one(
    monkeypatch: pytest.MonkeyPatch, case: tuple[int, int, int, str], lsb: float, together: int
) -> None:
    samples, history, minors, kind = case
    monkeypatch.setattr(quantisation, "TRIAL_SAMPLES", 160)
    monkeypatch.setattr(quantisation, "TOGETHER", together)
    design = fine_design(samples, history, minors, kind=kind)
    done: list[int] = []
    found = monte_carlo(design, radians(0.5), 111.0, lsb, 5, seed=3, advance=done.append)
    assert sum(done) == 5

    sensor = {"bits": 32, "lsb": lsb if kind == "increment" else lsb * 2000}
    design = Design.parse(
        {**design.as_json(), "sensor": {**design.as_json()["sensor"], "gyro": sensor}}
    )
    random = np.random.default_rng(3)
    each = [one_trial(design, radians(0.5), 112.5, 0.08, random) for _ in range(5)]
    drifts = [drift for drift, _ in each]
    assert found.mean == pytest.approx(np.mean(drifts), rel=1e-6)
    assert found.deviation == pytest.approx(np.std(drifts, ddof=1), rel=1e-6)
    if kind == "increment":
        assert found.angle_error == pytest.approx(max(error for _, error in each), rel=1e-6)


def test_the_first_trials_of_many_are_those_of_few() -> None:
    assert np.array_equal(draws(0.1, 9, seed=4)[:3], draws(0.1, 3, seed=4))


def test_a_cone_too_large_for_32_bits_is_refused() -> None:
    with pytest.raises(InputError, match="does not fit 32 bits, give a larger LSB"):
        monte_carlo(fine_design(2), radians(1), 50.0, 1e-13, 2, seed=1)


def test_drift_grows_with_the_lsb_and_the_seed_decides() -> None:
    design, angle = fine_design(4, minors=5), radians(0.1)
    one, two = (monte_carlo(design, angle, 50.0, lsb, 20, seed=5) for lsb in (1e-9, 1e-7))
    assert two.deviation / one.deviation == pytest.approx(100, rel=0.6)
    assert two.theory / one.theory == pytest.approx(100, rel=1e-3)
    assert monte_carlo(design, angle, 50.0, 1e-9, 20, seed=5) == one
    assert monte_carlo(design, angle, 50.0, 1e-9, 20, seed=6) != one
    assert replace(one, mean=0.0) != one


def test_levels_span_what_32_bits_hold() -> None:
    for kind in ("increment", "rate"):
        design = fine_design(4, kind=kind)
        lsbs = levels(design, radians(0.1), 50.0, 5)
        assert len(lsbs) == 5
        assert lsbs == sorted(lsbs)
        finest = monte_carlo(design, radians(0.1), 50.0, lsbs[0], 2, seed=1)
        assert 2**28 < finest.counts < 2**30


def test_a_tuned_design_is_studied_behind_its_filter() -> None:
    """Rates tuned to sinc take the same samples as filtered rates, so noise and mean are alike."""
    zeng = fine_design(2, minors=2, kind="rate")
    data = zeng.as_json()
    data["algorithm"] |= {"family": "tuned", "filter": [{"kind": "sinc"}]}
    pair = [
        monte_carlo(design, radians(0.1), 37.0, 3e-9, 5, seed=1)
        for design in (zeng, Design.parse(data))
    ]
    assert pair[0].theory == pytest.approx(pair[1].theory, rel=1e-6)
    assert pair[0].deviation == pytest.approx(pair[1].deviation, rel=1e-3)
