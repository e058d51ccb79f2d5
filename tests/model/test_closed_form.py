"""Analytic coning: against published residuals, brute-force sums and the integral itself."""

from __future__ import annotations

from fractions import Fraction
from math import cos, degrees, pi, radians, sin

import numpy as np
import pytest

from sculler_model.algorithms import TapTable, filtered_rate, frequency_taylor
from sculler_model.analysis.closed_form import (
    LeadingTerm,
    algorithm_correction,
    coning_increments,
    drift_rate,
    leading_term,
    residual,
    true_correction,
    uncorrected_rate,
)

DENSE = TapTable.from_rationals(
    [[], [Fraction(57, 80)], [Fraction(57, 80), Fraction(33, 80)]], [Fraction(1)] * 3
)


@pytest.mark.parametrize("n", [1, 2, 5])
@pytest.mark.parametrize("phase", [0.01, 0.19, 0.21, 1.3])
def test_truth_is_the_coning_integral(n: int, phase: float) -> None:
    """½ ∫ α × ω over the interval, by Gauss-Legendre, from any starting phase."""
    start = 0.7
    node, weight = np.polynomial.legendre.leggauss(30)
    tau = start + 0.5 * n * phase * (node + 1)
    alpha = np.sin(tau) - sin(start), cos(start) - np.cos(tau)
    integral = 0.25 * n * phase * weight @ (alpha[0] * np.sin(tau) - alpha[1] * np.cos(tau))
    assert true_correction(n, phase) == pytest.approx(integral, rel=1e-11, abs=0)


def test_truth_keeps_its_digits_at_small_phase() -> None:
    phase = np.array([1e-6, 1e-3, 0.2499999, 0.25])
    series = (4 * phase) ** 3 / 12 * (1 - (4 * phase) ** 2 / 20 * (1 - (4 * phase) ** 2 / 42))
    assert np.allclose(true_correction(4, phase)[:2], series[:2], rtol=1e-15)
    assert np.diff(true_correction(4, phase)[2:]) == pytest.approx(
        4 * 1e-7 * 0.5 * (1 - cos(1)), rel=1e-5, abs=0
    )


@pytest.mark.parametrize(
    "table", [frequency_taylor(1, 1), frequency_taylor(4, 0), frequency_taylor(3, 2), DENSE]
)
def test_algorithm_is_the_sum_of_its_products(table: TapTable) -> None:
    a, b, omega, interval, n = 0.02, 0.03, 100.0, 3e-3, table.samples
    start, reach = 0.123, table.reach + n
    times = start + interval * np.arange(-reach, n + 1)
    s = coning_increments(a, b, omega, times)  # the interval's samples are the last n
    total = 0.0
    for k in range(1, n + 1):
        at = reach + k - 1
        A = sum(table.tap(k, d) * s[at - d] for d in range(1, table.reach + 1))
        total += np.cross(A, s[at])[2] / table.denominator
    assert algorithm_correction(table, omega * interval) * a * b == pytest.approx(
        total, rel=1e-12, abs=0
    )


PUBLISHED = {2: Fraction(1, 30), 3: Fraction(3, 280), 4: Fraction(1, 315), 5: Fraction(5, 5544)}


@pytest.mark.parametrize("n", PUBLISHED)
def test_residual_law_of_frequency_taylor(n: int) -> None:
    assert leading_term(frequency_taylor(n, 0)) == LeadingTerm(-PUBLISHED[n], 2 * n + 1)


@pytest.mark.parametrize("n", PUBLISHED)
def test_residual_has_the_published_order_and_constant(n: int) -> None:
    """From the exact sines, at two frequencies; extrapolated to λ = 0."""
    table, phase = frequency_taylor(n, 0), np.array([0.4, 0.2])
    constant = -residual(table, phase) / phase ** (2 * n + 1)
    assert constant[1] + (constant[1] - constant[0]) / 3 == pytest.approx(
        float(PUBLISHED[n]), rel=3e-3, abs=0
    )


def test_one_sample_and_one_of_history_leaves_a_thirtieth() -> None:
    """The recursion of Savage-98 Eq. 61 leaves λ⁴/30 of the true rate ½ λ."""
    assert leading_term(frequency_taylor(1, 1)) == LeadingTerm(Fraction(-1, 60), 5)


@pytest.mark.parametrize(("n", "p"), [(2, 1), (3, 1), (3, 2), (1, 3)])
def test_history_raises_the_order_by_two(n: int, p: int) -> None:
    assert leading_term(frequency_taylor(n, p)).power == 2 * (n + p) + 1


@pytest.mark.parametrize("n", [1, 2, 3, 4])
def test_rate_residual_is_the_drift_of_brute_force_sums(n: int) -> None:
    """Second-order sum of everything, within and between, over whole cycles at 16 per cycle."""
    table = filtered_rate(n, 0)
    phase = 2 * pi / 16
    intervals = 4 * 16
    size = 2 * sin(phase / 2)  # λ sinc(λ/2)
    times = np.arange(-n, n * intervals + 1)
    s = size * np.stack((np.cos(phase * times), np.sin(phase * times)), 1)  # rate samples times T

    def cross(a: np.ndarray, b: np.ndarray) -> float:
        return float(a[0] * b[1] - a[1] * b[0])

    total, alpha = 0.0, np.zeros(2)
    for m in range(1, intervals + 1):
        t = n + n * m  # place of the interval's last sample
        A = sum(table.tap(n, d) * s[t - d] for d in range(1, n + 1))
        total += cross(A, s[t]) / table.denominator
        theta = sum(w * s[t - d] for d, w in enumerate(table.weights)) / table.sum_denominator
        total += 0.5 * cross(alpha, theta)
        alpha += theta
    true = 0.5 * phase * n * intervals
    assert residual(table, phase, "rate") * intervals == pytest.approx(
        total - true, rel=1e-9, abs=0
    )


def test_increments_through_the_rate_formula_are_the_same() -> None:
    """Plain sums have no amplitude error, so the formula for rates must reduce to the other."""
    table, phase = frequency_taylor(4, 0), np.linspace(0.1, 1.2, 12)
    assert np.allclose(residual(table, phase, "rate"), residual(table, phase), atol=1e-14)
    assert leading_term(table, "rate") == leading_term(table)


@pytest.mark.parametrize("n", [1, 2, 3, 4])
def test_rate_leading_term_is_the_limit_of_the_sines(n: int) -> None:
    table = filtered_rate(n, 0)
    term = leading_term(table, "rate")
    phase = np.array([0.12, 0.06])
    constant = residual(table, phase, "rate") / phase**term.power
    limit = constant[1] + (constant[1] - constant[0]) / 3
    assert limit == pytest.approx(float(term.coefficient), rel=2e-4, abs=0)


def test_simpson_leaves_a_ninetieth() -> None:
    """n = 2: Simpson's relative error (λ^4)/180 of θ, squared into ½ sin 2λ."""
    assert leading_term(filtered_rate(2, 0), "rate") == LeadingTerm(Fraction(1, 90), 5)


def test_zengs_case() -> None:
    """1° half angle, 20 Hz, 1 kHz, filter sinc(ΩT/2): n = 2 leaves 1.07e-2 °/h (DESIGN)."""
    a = sin(radians(1))
    rate = drift_rate(filtered_rate(2, 0), a, a, 2 * pi * 20, 1e-3, "rate")
    assert degrees(float(rate)) * 3600 == pytest.approx(1.07e-2, rel=5e-3, abs=0)


def test_drift_rate_scales_residual_to_seconds() -> None:
    table, omega = frequency_taylor(3, 0), np.array([100.0, 200.0])
    rate = drift_rate(table, 0.01, 0.02, omega, 1e-3)
    assert np.allclose(rate, residual(table, omega * 1e-3) * 0.01 * 0.02 / 3e-3, rtol=1e-15)


def test_no_correction_at_all_loses_half_ab_omega() -> None:
    """Truth grows by ½(nλ - sin nλ) an interval; over whole cycles the sine is gone."""
    lost = -true_correction(8, 2 * pi / 8) * 0.01 * 0.02 / (8 * 1e-3)
    assert uncorrected_rate(0.01, 0.02, 2 * pi / 8e-3) == pytest.approx(
        float(lost), rel=1e-12, abs=0
    )


def test_zero_frequency_leaves_nothing() -> None:
    assert residual(filtered_rate(2, 0), 0.0, "rate") == 0
    assert residual(frequency_taylor(2, 0), 0.0) == 0


def test_a_table_without_leading_term_is_said_so() -> None:
    with pytest.raises(ValueError, match="up to the power 5"):
        leading_term(frequency_taylor(4, 0), max_power=5)
