"""Resampler: exact where a cubic is exact, its total kept, its error on coning as derived."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from math import sin

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

from sculler_model.errors import InputError
from sculler_model.samples import Gridded, Kind, Resampler
from sculler_model.samples.resampler import lagrange_weights

T = 0.01
CUBIC = Polynomial([0.3, -2.0, 7.0, -11.0])


def resample(
    given: Kind,
    wanted: Kind,
    times: NDArray[np.float64],
    values: NDArray[np.float64],
    cuts: tuple[int, ...] = (),
    faults: NDArray[np.uint8] | None = None,
) -> Gridded:
    resampler = Resampler(T, given, wanted)
    edges = [0, *cuts, len(times)]
    parts = [
        resampler(times[a:b], values[a:b], None if faults is None else faults[a:b])
        for a, b in pairwise(edges)
    ]
    parts.append(resampler.finish())
    kept = [part for part in parts if len(part.values)]
    return Gridded(
        np.concatenate([part.values for part in kept]),
        np.concatenate([part.faults for part in kept]),
        np.concatenate([part.times for part in kept]),
    )


def jittered(count: int, seed: int = 1) -> NDArray[np.float64]:
    """Stamps that never stray far from the grid, the first and last on it."""
    times = np.arange(count) * T
    times[1:-1] += np.random.default_rng(seed).uniform(-0.4, 0.4, count - 2) * T
    return times


def integral(polynomial: Polynomial, at: NDArray[np.float64]) -> NDArray[np.float64]:
    whole = polynomial.integ()
    return np.asarray(whole(at[1:]) - whole(at[:-1]))[:, None]


@pytest.mark.parametrize("stamps", ["even", "jittered"])
@pytest.mark.parametrize("cuts", [(), (1,), (1, 2, 3, 4, 5), (7, 7, 30)])
def test_cubic_rates_integrate_exactly(stamps: str, cuts: tuple[int, ...]) -> None:
    times = np.arange(50) * T if stamps == "even" else jittered(50)
    got = resample("rate", "increment", times, CUBIC(times)[:, None], cuts)
    assert got.values.shape == (49, 1)
    assert np.abs(got.values - integral(CUBIC, np.arange(50) * T)).max() < 1e-16
    rates = resample("rate", "rate", times, CUBIC(times)[:, None], cuts)
    assert np.abs(rates.values[:, 0] - CUBIC(np.arange(50) * T)).max() < 1e-14


@pytest.mark.parametrize(("count", "degree"), [(2, 1), (3, 2), (4, 3)])
def test_few_samples_take_the_curve_through_them(count: int, degree: int) -> None:
    curve = Polynomial(CUBIC.coef[: degree + 1])
    times = np.arange(count) * T
    got = resample("rate", "increment", times, curve(times)[:, None])
    assert np.abs(got.values - integral(curve, times)).max() < 1e-16


def test_one_rate_makes_no_increment_and_no_sample_nothing() -> None:
    resampler = Resampler(T, "rate", "increment")
    assert len(resampler(np.array([5.0]), np.ones((1, 6))).values) == 0
    assert len(resampler.finish().values) == 0
    assert len(Resampler(T, "increment", "increment").finish().values) == 0


def test_rule_on_equal_steps() -> None:
    """h/24·(-1, 13, 13, -1) between, h/24·(9, 19, -5, 1) at the ends."""
    for at in range(8):
        impulse = np.zeros((8, 1))
        impulse[at] = 1.0
        got = resample("rate", "increment", np.arange(8) * T, impulse).values[:, 0] * 24 / T
        expected = np.zeros(7)
        for step in range(7):
            first = min(max(step - 1, 0), 4)
            rule = {0: (9, 19, -5, 1), 6: (1, -5, 19, 9)}.get(step, (-1, 13, 13, -1))
            if first <= at < first + 4:
                expected[step] = rule[at - first]
        assert got == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("omega_h", [0.2, 0.1, 0.05])
def test_error_on_a_coning_motion(omega_h: float) -> None:
    """Drift is bilinear in the two rates, each seen by the rule's gain: 1 - 11/360·(Ωh)⁴ of it."""
    omega, count = omega_h / T, 400
    times = np.arange(count) * T
    rates = np.column_stack([np.cos(omega * times), np.sin(omega * times)])
    got = resample("rate", "increment", times, rates).values[2:-2]
    gain = np.linalg.norm(got, axis=1) / (2 / omega * sin(omega_h / 2))
    assert gain == pytest.approx(gain[0], rel=1e-12)
    assert 1 - gain[0] ** 2 == pytest.approx(11 / 360 * omega_h**4, rel=0.02)


@pytest.mark.parametrize("wanted", ["increment", "rate"])
@pytest.mark.parametrize("cuts", [(), (1,), (1, 2, 3, 4, 5), (20, 21)])
def test_increments_keep_their_total(wanted: Kind, cuts: tuple[int, ...]) -> None:
    """Whole counts over unequal steps: the grid's increments add up to exactly their sum."""
    rng = np.random.default_rng(4)
    counts = rng.integers(-30000, 30000, (60, 6)).astype(float)
    got = resample("increment", wanted, jittered(60), counts, cuts)
    assert got.values.shape == (60, 6)
    total = got.values.sum(axis=0) * (T if wanted == "rate" else 1)
    assert total == pytest.approx(counts.sum(axis=0), rel=1e-13, abs=1e-8)


def test_increments_of_a_cubic_angle_over_unequal_steps() -> None:
    times = jittered(40)
    ends = np.concatenate([[-T], times])
    values = (CUBIC(ends[1:]) - CUBIC(ends[:-1]))[:, None]
    got = resample("increment", "increment", times, values, (11, 12))
    grid = np.arange(-1, 40) * T
    assert np.abs(got.values[:, 0] - np.diff(CUBIC(grid))).max() < 1e-15


def test_increments_on_the_grid_pass() -> None:
    values = np.random.default_rng(2).normal(size=(100, 6))
    got = resample("increment", "increment", 7e4 + np.arange(100) * T, values, (33,))
    # a stamp of 7e4 s is good to 7e-12 s, 7e-10 of the interval, and values differ by up to 5
    assert np.abs(got.values - values).max() < 1e-8
    assert not got.faults.any()


def test_a_slow_clock_over_many_samples() -> None:
    """A sensor 0.1 % slow: 10000 rows make 10010 intervals of the same rate."""
    times = np.arange(10_000) * (T * 1.001)
    got = resample("increment", "increment", times, np.full((10_000, 1), 1.001), (4096, 8192))
    # the grid begins T before the first stamp, so the first step is 0.1 % faster
    assert len(got.values) == 1 + int(9_999 * 1.001)
    assert got.values[5:] == pytest.approx(np.ones((len(got.values) - 5, 1)), abs=1e-9)


def test_what_is_left_after_the_last_grid_point() -> None:
    resampler = Resampler(T, "rate", "increment")
    given = resampler(np.array([0, 1, 2, 3, 3.25]) * T, np.ones((5, 1)))
    assert len(given.values) + len(resampler.finish().values) == 3
    assert resampler.left_out == pytest.approx(0.25 * T)


@pytest.mark.parametrize("cuts", [(), (5,), (6,), (7,), (8,), tuple(range(1, 20))])
def test_faults_mark_every_step_they_touch(cuts: tuple[int, ...]) -> None:
    faults = np.zeros(20, np.uint8)
    faults[6] = 1
    even, ones = np.arange(20) * T, np.ones((20, 1))
    got = resample("increment", "increment", even, ones, cuts, faults)
    assert np.flatnonzero(got.faults).tolist() == [6]
    got = resample("rate", "increment", even, ones, cuts, faults)
    assert np.flatnonzero(got.faults).tolist() == [5, 6]  # rate 6 ends step 5 and begins step 6
    late = even + np.where(np.arange(20) > 0, 0.3 * T, 0)
    got = resample("increment", "increment", late, ones, cuts, faults)
    # grid step k ends at k·T, given step 6 lasts from 5.3 T to 6.3 T
    assert np.flatnonzero(got.faults).tolist() == [6, 7]


def test_weights_are_lagranges() -> None:
    nodes = [Fraction(0), Fraction(1), Fraction(5, 2), Fraction(4)]
    x = Fraction(3, 2)
    expected = []
    for k, node in enumerate(nodes):
        weight = Fraction(1)
        for other in nodes[:k] + nodes[k + 1 :]:
            weight *= (x - other) / (node - other)
        expected.append(float(weight))
    got = lagrange_weights(np.array([[float(n) for n in nodes]]), np.array([float(x)]))
    assert got[0] == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize("interval", [0.0, -1.0, np.nan, np.inf])
def test_interval_is_checked(interval: float) -> None:
    with pytest.raises(InputError, match="interval"):
        Resampler(interval, "rate", "increment")


def test_trapezoid_figure_of_the_docstring() -> None:
    """(Ωh)²/6 of the drift is what the trapezoid loses: gain (x/2)/tan(x/2), squared."""
    x = 1e-2
    gain = (x / 2) / np.tan(x / 2)
    assert 1 - gain**2 == pytest.approx(x**2 / 6, rel=1e-3)
