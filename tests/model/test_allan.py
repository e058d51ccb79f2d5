"""Allan deviations: NIST's table, closed forms, and what `Imperfect` makes of what was asked."""

from __future__ import annotations

from math import degrees, log, pi, sqrt
from typing import Any

import numpy as np
import pytest

from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.samples import (
    AllanRecord,
    Imperfect,
    allan_deviation,
    asked_deviation,
    worst_ratio,
)

HOUR = degrees(1) * 3600


def nist() -> list[float]:
    """The 1000-point set of NIST SP 1065, table 31: n(i+1) = 16807 n(i) mod 2147483647."""
    n, found = 1234567890, []
    for _ in range(1000):
        found.append(n / 2147483647)
        n = 16807 * n % 2147483647
    return found


@pytest.mark.parametrize(
    ("many", "expected"), [(1, 2.922319e-1), (10, 9.159953e-2), (100, 3.241343e-2)]
)
def test_nist_special_publication_1065(many: int, expected: float) -> None:
    """Table 32, overlapping Allan deviation."""
    assert float(allan_deviation(nist(), 1.0, many)) == pytest.approx(expected, rel=2e-7)


def design(**errors: Any) -> Design:
    axes = {"bits": 32, "lsb": 1e-12}
    sensor = {"kind": "increment", "sample_rate_hz": 100.0, "gyro": axes, "accel": axes}
    algorithm = {"family": "frequency-taylor", "samples": 4, "minors": 5}
    data = {"name": "d", "sensor": sensor | {"errors": errors}, "algorithm": algorithm}
    return Design.parse(data)


def test_each_error_alone_has_its_slope() -> None:
    """N/√τ, 0.664 B, K √(τ/3), Gauss and Markov's peak of 0.437 σ √... at 1.89 T_c."""
    tau = np.array([1.0, 100.0])
    white = HOUR * asked_deviation(design(gyro={"random_walk": 0.15}), tau)[:, 0]
    assert white == pytest.approx([9.0, 0.9], rel=1e-6)
    flat = HOUR * asked_deviation(design(gyro={"flicker": 0.5}), tau)[:, 0]
    assert flat == pytest.approx([0.5 * sqrt(2 * log(2) / pi)] * 2, rel=1e-4)
    walk = HOUR * asked_deviation(design(gyro={"rate_random_walk": 6.0}), tau)[:, 1]
    assert walk == pytest.approx([0.1 / sqrt(3), 1 / sqrt(3)], rel=1e-4)
    times = np.geomspace(0.01, 1e5, 2000)
    markov = (
        HOUR * asked_deviation(design(gyro={"markov": 1.0, "markov_time_s": 50.0}), times)[:, 0]
    )
    assert times[np.argmax(markov)] / 50 == pytest.approx(1.89, rel=0.01)  # IEEE Std 952: 1.89 T_c
    assert markov.max() == pytest.approx(0.437 * sqrt(2), rel=2e-3)  # 0.437 q √T_c, q = σ√(2/T_c)
    joint = np.abs(np.diff(np.log(markov))).max()
    assert joint < 1.1 * np.diff(np.log(times)).max()  # no step where the series ends
    accel = asked_deviation(design(accel={"random_walk": 0.06}), tau)[:, 5]
    assert accel == pytest.approx([1e-3, 1e-4], rel=1e-6)


def test_counts_alone_leave_their_remainders() -> None:
    """√3 Q/τ with Q = LSB/√12, of a rate that no LSB divides."""
    plain = Design.preset("stim300")
    T, lsb = plain.sample_interval, plain.sensor.gyro.lsb
    angle = np.floor((np.arange(1, 40_001)[:, None] * [0.3717, 0.4142, 0.7321]) + 0.5)
    counts = np.diff(angle, axis=0, prepend=0.0)
    rates = (counts - np.array([0.3717, 0.4142, 0.7321])) * lsb / T
    record = AllanRecord(T)
    record.add(np.hstack((rates, rates)))
    curve = record.curve()
    asked = asked_deviation(plain, curve.tau)
    ratio = np.sqrt((curve.deviation[:, :3] ** 2).mean(axis=1)) / asked[:, 0]
    assert np.median(ratio) == pytest.approx(1.0, abs=0.2)


def test_what_is_made_is_what_was_asked() -> None:
    """All random errors at once, in blocks; short averages from the first samples, long of all."""
    both = {"random_walk": 0.15, "flicker": 2.0, "rate_random_walk": 30.0}
    made = design(
        gyro={**both, "markov": 4.0, "markov_time_s": 20.0, "bias": 7.0},
        accel={"random_walk": 0.06, "flicker": 0.1},
    )
    imperfect, record = Imperfect(made), AllanRecord(made.sample_interval)
    for _ in range(30):
        record.add(imperfect(np.zeros((10_000, 6))) / made.sample_interval)
    curve = record.curve()
    assert curve.tau[0] == made.sample_interval
    assert curve.tau[-1] > 300
    assert np.all(np.diff(curve.tau) > 0)
    asked = asked_deviation(made, curve.tau)
    assert worst_ratio(curve, asked) < 1.15
    assert worst_ratio(curve, 1.6 * asked) > 1.4


@pytest.mark.deep
def test_blocks_and_thinning_change_nothing() -> None:
    """The thinned sum is the sum; a record of 200,000 is thinned by four."""
    rates = np.random.default_rng(2).normal(size=(200_000, 6))
    whole, parts = AllanRecord(0.01), AllanRecord(0.01)
    whole.add(rates)
    for part in np.split(rates, [1, 2, 5, 70_001, 70_004, 130_000]):
        parts.add(part)
    one, other = whole.curve(), parts.curve()
    np.testing.assert_allclose(one.tau, other.tau, rtol=1e-12)
    np.testing.assert_allclose(one.deviation, other.deviation, rtol=1e-9)
    late = one.tau > 100
    expected = [allan_deviation(rates, 0.01, round(tau / 0.01)) for tau in one.tau[late]]
    np.testing.assert_allclose(one.deviation[late], expected, rtol=0.1)


def test_refuses() -> None:
    with pytest.raises(InputError, match="51 intervals of 100 are not allowed, give 1 to 50"):
        allan_deviation(np.zeros(100), 1.0, 51)
    record = AllanRecord(1.0)
    record.add(np.zeros((8, 6)))
    with pytest.raises(InputError, match="8 samples are too few, give at least 9"):
        record.curve()
