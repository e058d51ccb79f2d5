"""Every family through the integer path: truth, duality, and the tuned special cases."""

from __future__ import annotations

from fractions import Fraction
from itertools import product
from math import pi, radians
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from sculler_model.algorithms import (
    FAMILIES,
    Balance,
    Digital,
    Recipe,
    Response,
    Sinc,
    filtered_rate,
    frequency_taylor,
    make,
    uncompressed,
)
from sculler_model.analysis.closed_form import drift_rate
from sculler_model.analysis.closed_form import residual as plain_residual
from sculler_model.analysis.drift import filtered_residual, in_phase_drift
from sculler_model.design import Design
from sculler_model.fast import FastModel
from sculler_model.frames import from_rotation_vector, rotate
from sculler_model.frames import product as quaternion_product
from sculler_model.golden import GoldenModel
from sculler_model.host import major_increments
from sculler_model.motion import Coning, Sculling
from sculler_model.samples import Quantiser
from strategies import random_counts

Q = Fraction
RATE = 1000.0
MEAN_OF_FOUR = {"kind": "digital", "numerator": [0.25] * 4}
LAG = {"kind": "analogue", "numerator": [1.0], "denominator": [2e-7, 6e-4, 1.0]}

ALGORITHMS: dict[str, dict[str, Any]] = {
    "time-taylor": {"family": "time-taylor", "samples": 4},
    "time-taylor folded": {"family": "time-taylor", "samples": 3, "history": 2},
    "uncompressed": {"family": "uncompressed", "samples": 4},
    "uncompressed history": {"family": "uncompressed", "samples": 3, "history": 1},
    "uncompressed fit": {
        "family": "uncompressed",
        "base": "least-squares",
        "samples": 4,
        "band": {"high_hz": 200.0},
        "denominator_bits": 20,
    },
    "least-squares": {
        "family": "least-squares",
        "samples": 4,
        "band": {
            "profile": [[20, 0.01], [80, 0.04], [350, 0.04], [450, 0.007]],
            "mount": {"natural_hz": 50.0, "damping": 0.125},
            "high_hz": 300.0,
        },
    },
    "tuned": {"family": "tuned", "samples": 4, "filter": MEAN_OF_FOUR},
    "tuned rounded": {"family": "tuned", "samples": 3, "denominator_bits": 20, "filter": LAG},
    "tuned fit": {
        "family": "tuned",
        "samples": 4,
        "match": "least-squares",
        "band": {"high_hz": 150.0},
        "filter": [LAG, {"kind": "measured", "points": [[0, 1], [100, 0.95], [200, 0.8]]}],
    },
    "uncompressed tuned": {
        "family": "uncompressed",
        "base": "tuned",
        "samples": 4,
        "filter": MEAN_OF_FOUR,
    },
    "frequency-taylor": {"family": "frequency-taylor", "samples": 4},
}
RATES: dict[str, dict[str, Any]] = {
    "tuned rates": {"family": "tuned", "samples": 2, "filter": {"kind": "sinc"}},
    "tuned plain": {"family": "tuned", "samples": 3, "sum": "plain", "filter": LAG},
    "filtered-rate": {"family": "filtered-rate", "samples": 3},
}


def design(name: str, bits: int = 32, lsb: float = 1e-12) -> Design:
    algorithm = {**ALGORITHMS, **RATES}[name]
    return Design.parse(
        {
            "name": "family_case",
            "sensor": {
                "kind": "rate" if name in RATES else "increment",
                "sample_rate_hz": RATE,
                "gyro": {"bits": bits, "lsb": lsb},
                "accel": {"bits": bits, "lsb": 10 * lsb},
            },
            "algorithm": {"minors": 5, **algorithm},
        }
    )


def test_every_family_is_here() -> None:
    assert {case["family"] for case in (ALGORITHMS | RATES).values()} == set(FAMILIES)


@pytest.mark.parametrize("name", ALGORITHMS | RATES)
def test_sculling_is_coning_polarised(name: str) -> None:
    """Duality (Yang Eq. 4, Roscoe), exactly and for every family.

    The true integrals obey sculling(α, υ) = coning(α + υ) - coning(α) - coning(υ), being one
    bilinear form; so must the sums, in every integer.
    """
    case = design(name, bits=16)
    rng = np.random.default_rng(1)
    s, r = (random_counts(case, 60, rng)[:, :3] // 4 for _ in range(2))

    def run(gyro: NDArray[np.int64], accel: NDArray[np.int64]) -> list[Any]:
        model = GoldenModel(case)
        rows = zip(gyro.tolist(), accel.tolist(), strict=True)
        return list(model.run((tuple(a), tuple(b), 0) for a, b in rows))

    for mixed, plain_s, plain_r, both in zip(
        run(s, r), run(s, s), run(r, r), run(s + r, s + r), strict=True
    ):
        for part in ("within", "between"):
            coning, sculling = f"coning_{part}", f"sculling_{part}"
            expected = [
                sum_ - a - b
                for sum_, a, b in zip(
                    getattr(both, coning),
                    getattr(plain_s, coning),
                    getattr(plain_r, coning),
                    strict=True,
                )
            ]
            assert list(getattr(mixed, sculling)) == expected
            assert any(expected)


def filtered(samples: NDArray[np.float64], taps: list[float]) -> NDArray[np.float64]:
    """The samples through a real FIR filter, its start-up left out."""
    columns = [np.convolve(column, taps, "valid") for column in samples.T]
    return np.stack(columns, axis=1)


def coning_drift(case: Design, samples: NDArray[np.float64]) -> float:
    """Drift about z in rad/s through counts, core, host and quaternions.

    Five major intervals at a time hold whole cycles of 40 Hz; the first five, with no history at
    their start, are left out.
    """
    phi = major_increments(case, FastModel(case).feed(Quantiser(case)(samples))).phi
    phi = phi[5 : len(phi) // 5 * 5]
    q = (1.0, 0.0, 0.0, 0.0)
    for step in phi.tolist():
        q = quaternion_product(q, from_rotation_vector(tuple(step)))
    return float(2 * q[3] / (len(phi) * case.major_interval))


# so small an angle that third order, a² of the whole, does not show
ANGLE, HERTZ = radians(0.05), 40.0


@pytest.mark.parametrize(
    "name", ["time-taylor", "time-taylor folded", "uncompressed", "least-squares"]
)
def test_coning_through_the_integer_path(name: str) -> None:
    case = design(name)
    motion = Coning(ANGLE, 2 * pi * HERTZ)
    found = coning_drift(case, motion.increments(5000, 1 / RATE))
    a = np.sin(ANGLE)
    expected = drift_rate(case.table, a, a, 2 * pi * HERTZ, 1 / RATE)
    uncorrected = 0.5 * a * a * 2 * pi * HERTZ
    assert found == pytest.approx(float(expected), abs=2e-6 * uncorrected)
    assert abs(found) < 1e-3 * uncorrected


@pytest.mark.parametrize("name", ["tuned", "uncompressed tuned"])
def test_tuned_behind_a_real_filter(name: str) -> None:
    """Increments averaged over four samples: a plain table drifts, the tuned one does not."""
    motion = Coning(ANGLE, 2 * pi * HERTZ)
    samples = filtered(motion.increments(5003, 1 / RATE), [0.25] * 4)
    a, phase = np.sin(ANGLE), 2 * pi * HERTZ / RATE
    response = Response((Digital((Q(1, 4),) * 4),))

    def expected(case: Design) -> float:
        left = filtered_residual(case.table, phase, gyro=response)
        return float(left) * a * a * RATE / case.algorithm.samples

    tuned, plain = design(name), design("frequency-taylor")
    uncorrected = 0.5 * a * a * 2 * pi * HERTZ
    for case in (tuned, plain):
        assert coning_drift(case, samples) == pytest.approx(expected(case), abs=5e-6 * uncorrected)
    assert abs(expected(plain)) > 0.05 * uncorrected
    assert abs(expected(tuned)) < 2e-4 * uncorrected


@pytest.mark.parametrize("name", ["tuned rates", "tuned plain"])
def test_tuned_rates_through_the_integer_path(name: str) -> None:
    """Rate samples that passed the analytic filter, phase and all."""
    case = design(name, lsb=2e-9)
    response = case.made.balance.response
    omega, count = 2 * pi * HERTZ, 6000
    F = response.value(omega / RATE)
    motion = Coning(ANGLE, omega)
    turn = np.exp(1j * omega * np.arange(1, count + 1) / RATE) * F * omega * np.sin(ANGLE)
    samples = motion.rates(count, 1 / RATE, 1, filtered=False)
    samples[:, 0], samples[:, 1] = -turn.imag, turn.real
    found = coning_drift(case, samples)
    a = np.sin(ANGLE)
    left = filtered_residual(case.table, omega / RATE, "rate", response)
    uncorrected = 0.5 * a * a * omega
    assert found == pytest.approx(
        float(left) * a * a * RATE / case.algorithm.samples, abs=5e-6 * uncorrected
    )
    assert abs(found) < 1e-3 * uncorrected


@pytest.mark.parametrize(
    "name", ["time-taylor", "uncompressed", "least-squares", "uncompressed fit"]
)
def test_sculling_through_the_integer_path(name: str) -> None:
    case = design(name)
    omega = 2 * pi * HERTZ
    motion = Sculling(radians(0.1), 5.0, omega)
    samples = motion.increments(5000, 1 / RATE)
    block = FastModel(case).feed(Quantiser(case)(samples))
    steps = major_increments(case, block)
    q, velocity = (1.0, 0.0, 0.0, 0.0), np.zeros(3)
    for phi, dv in zip(steps.phi.tolist(), steps.dv_sf.tolist(), strict=True):
        velocity += np.array(rotate(q, tuple(dv)))
        q = quaternion_product(q, from_rotation_vector(tuple(phi)))
    force = velocity[2] / (len(block) * case.major_interval)
    a, b = motion.angle, motion.force / omega
    left = float(drift_rate(case.table, a, b, omega, 1 / RATE))
    assert force == pytest.approx(motion.mean_force + left, abs=2e-6 * motion.mean_force)
    assert abs(left) < 1e-3 * motion.mean_force


class TestSpecialCases:
    @pytest.mark.parametrize(("n", "p"), [(n, p) for n in range(1, 6) for p in range(n + 1)])
    def test_zeng_is_tuned_to_a_sinc(self, n: int, p: int) -> None:
        """filtered-rate, exactly, from the filter F = sinc(ΩT/2) and rate samples."""
        sinc = Response((Sinc(),))
        made = make(Recipe("tuned", n, p, kind="rate", sum="zeng", response=sinc))
        assert made.table == filtered_rate(n, p)

    def test_zengs_numbers(self) -> None:
        table = design("tuned rates").table
        assert [Q(tap, table.denominator) for tap in table.taps[1]] == [Q(89, 120), Q(1, 240)]
        weights = [Q(w, table.sum_denominator) for w in table.weights]
        assert weights == [Q(1, 3), Q(4, 3), Q(1, 3)]

    @pytest.mark.parametrize(("n", "p"), [(2, 0), (1, 1), (4, 0), (3, 2), (6, 3)])
    def test_no_filter_is_frequency_taylor(self, n: int, p: int) -> None:
        assert make(Recipe("tuned", n, p)).table == frequency_taylor(n, p)
        sinc = Response((Sinc(),))
        shifted = make(Recipe("tuned", n, p, kind="rate", response=sinc)).table
        # a rate averaged over T is an increment: plain sums, one tap more
        assert shifted.taps == frequency_taylor(n, p + 1).taps
        assert shifted.denominator == frequency_taylor(n, p + 1).denominator

    def test_uncompressing_without_a_filter_is_uncompressed(self) -> None:
        assert make(Recipe("uncompressed", 4)).table == uncompressed(4, 0)
        assert make(Recipe("uncompressed", 4, base="tuned")).table == uncompressed(4, 0)


@pytest.mark.parametrize("sum", ["newton-cotes", "plain"])
@pytest.mark.parametrize("n", [2, 3, 4])
def test_rates_are_matched_to_their_order(n: int, sum: Any) -> None:
    """Taylor matching by the drift itself: n powers gone, the residual falls as λ^(2n+3)."""
    response = Response((Digital((Q(1, 2), Q(1, 2))), Sinc()))
    table = make(Recipe("tuned", n, kind="rate", sum=sum, response=response)).table
    coarse, fine = filtered_residual(table, np.array([0.16, 0.08]), "rate", response)
    assert np.log2(coarse / fine) == pytest.approx(2 * n + 3, abs=0.2)


@pytest.mark.parametrize("n", [2, 4])
def test_true_sums_leave_far_less_than_zengs(n: int) -> None:
    """1 kHz, 20 Hz, as Zeng's example: his premise about the sum costs more than all the rest."""
    phase, sinc = 2 * pi * 20 / 1000, Response((Sinc(),))
    left = {
        name: abs(
            float(
                filtered_residual(
                    make(Recipe("tuned", n, kind="rate", sum=name, response=sinc)).table,
                    phase,
                    "rate",
                    sinc,
                )
            )
        )
        for name in ("zeng", "newton-cotes", "plain")
    }
    a = np.sin(radians(1))
    if n == 2:  # the figure of the design page, 1.07e-2 deg/h
        hourly = np.degrees(left["zeng"] * a * a * 1000 / n) * 3600
        assert hourly == pytest.approx(1.07e-2, rel=5e-3)
    assert left["newton-cotes"] < left["zeng"] / 50
    assert left["plain"] < left["newton-cotes"]


def test_without_filter_drift_is_the_closed_form() -> None:
    phase = np.array([1e-6, 0.01, 0.4, 2.0])
    for name in ("time-taylor", "uncompressed history"):
        table = design(name).table
        assert filtered_residual(table, phase) == pytest.approx(
            plain_residual(table, phase), rel=1e-12
        )
    table = filtered_rate(3)
    found = filtered_residual(table, phase[1:], "rate", Response((Sinc(),)))
    assert found == pytest.approx(plain_residual(table, phase[1:], "rate"), rel=1e-9)


def test_unlike_filters_of_gyro_and_accelerometer() -> None:
    """A delay between the two turns vibration in phase into drift; only the table's size counts.

    Against the sums themselves, over one whole period.
    """
    gyro, accel = Response((Digital((Q(1),)),)), Response((Digital((Q(0), Q(1))),))  # one sample
    table, cycle = uncompressed(3, 0), 40
    phase = 2 * pi / cycle
    t = np.arange(-10, 3 * cycle)
    c = {(k, d): tap for k, row in enumerate(table.taps, 1) for d, tap in enumerate(row, 1) if tap}

    def within(s: NDArray[np.float64], r: NDArray[np.float64]) -> float:
        total = 0.0
        for start in range(10, len(t), 3):
            for (k, d), tap in c.items():
                i = start + k - 1
                total += tap * (s[i - d] * r[i] - r[i - d] * s[i])
        return total / table.denominator / cycle

    def increments(shift: float) -> tuple[NDArray[np.float64], ...]:
        z = 2 * np.sin(phase / 2) * np.exp(1j * phase * (t - shift))
        return z.real, z.imag

    sine_sum = float(filtered_residual(table, phase)) + 0.5 * 3 * phase - 0.5 * np.sin(3 * phase)
    s, (_, r) = increments(0)[0], increments(1)
    power = np.cos(phase)  # Re F_g F_a*
    assert within(s, r) == pytest.approx(power * sine_sum, rel=1e-12)
    in_phase = within(s, increments(1)[0])
    whole = float(in_phase_drift(table, np.array(phase), "increment", gyro, accel))
    between = 0.5 * np.sin(phase) * np.sin(3 * phase)
    assert in_phase == pytest.approx(whole - between, rel=1e-12)
    assert whole == pytest.approx(0.5 * 3 * phase * np.sin(phase), rel=1e-4)
    quarter = float(filtered_residual(table, phase, gyro=gyro, accel=accel))
    assert quarter == pytest.approx((power - 1) * 0.5 * 3 * phase, rel=1e-3)


def test_weights_of_the_balance_are_the_tables() -> None:
    for kind, sum, n in product(("increment", "rate"), ("zeng", "plain"), (2, 3)):
        if kind == "rate":
            table = make(Recipe("tuned", n, kind=kind, sum=sum)).table  # type: ignore[arg-type]
            weights = Balance(n, kind, sum).weights  # type: ignore[arg-type]
            found = [Q(w, table.sum_denominator) for w in table.weights[: len(weights)]]
            assert found == weights


@pytest.mark.parametrize("name", ["tuned", "uncompressed tuned"])
def test_manoeuvre_behind_a_filter(name: str) -> None:
    """A short turn about two axes, seen through (1, 2, 1)/4: the whole net coning is recovered.

    The rates are Gaussian pulses, at rest before and after, so that nothing is left over at the
    ends; the truth is ½ ∫ α × ω of the unfiltered rates by quadrature.
    """
    algorithm = {**ALGORITHMS[name], "filter": {"kind": "digital", "numerator": [1, 2, 1]}}
    table = Design.parse(design(name).as_json() | {"algorithm": algorithm | {"minors": 5}}).table
    fine, count, width = 64, 640, 9.0
    t = (np.arange(count * fine) + 0.5) / fine
    x = np.exp(-(((t - 300) / width) ** 2) / 2)
    y = np.exp(-(((t - 306) / width) ** 2) / 2)

    def coning(x: NDArray[np.float64], y: NDArray[np.float64], step: float) -> float:
        """½ Σ α × Δα, with α at the middle of each step."""
        at_x, at_y = (step * (np.cumsum(rate) - rate / 2) for rate in (x, y))
        return float(0.5 * step * np.sum(at_x * y - at_y * x))

    truth = coning(x, y, 1 / fine)
    s = np.stack([rate.reshape(count, fine).mean(axis=1) for rate in (x, y)], axis=1)
    s = filtered(s, [0.25, 0.5, 0.25])
    s = s[: len(s) // 4 * 4]
    theta = s.reshape(-1, 4, 2).sum(axis=1)
    computed = coning(theta[:, 0], theta[:, 1], 1.0)
    for k, row in enumerate(table.taps):
        for d, tap in enumerate(row, start=1):
            later = np.arange(4 + k, len(s), 4)
            a, b = s[later - d], s[later]
            computed += (
                tap / table.denominator * float(np.sum(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]))
            )
    assert computed == pytest.approx(truth, rel=2e-5)
    plain = coning(s[:, 0], s[:, 1], 1.0)
    assert abs(plain - truth) > 1e-3 * abs(truth)


def test_uncompressing_a_tuned_table_reaches_as_far() -> None:
    """The distance sums and the filtered truth agree, so that no order is lost to the filter."""
    made = design("uncompressed tuned").made
    assert made.uncompressed is not None
    assert made.uncompressed.order == 5
    assert set(made.uncompressed.vanishing) >= {(0, 1), (0, 2), (0, 3), (1, 2), (0, 4), (1, 3)}
