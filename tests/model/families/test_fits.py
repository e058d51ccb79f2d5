"""Least squares and rounding: against NumPy, brute force, and the definition of a minimum."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from itertools import pairwise, product
from math import pi
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from sculler_model.algorithms import (
    Balance,
    Band,
    Fit,
    Response,
    RotaryMode,
    Sinc,
    TapTable,
    fit,
    frequency_taylor,
)
from sculler_model.algorithms.decimals import exact
from sculler_model.algorithms.lattice import closest_integers, search
from sculler_model.algorithms.least_squares import (
    _checked_count,
    _denominator,
    _points,
    round_taps,
)
from sculler_model.algorithms.tuned import matched, matched_and_rounded
from sculler_model.analysis.drift import filtered_residual
from sculler_model.errors import InputError

Q = Fraction
RATE = Q(1000)


def basis(n: int, count: int, phase: NDArray[np.float64]) -> NDArray[np.float64]:
    """Yang Eq. 8: products of unit increments at distance 1..count."""
    d = np.arange(1, count + 1)
    lam = phase[:, np.newaxis]
    return 2 * np.sin(d * lam) - np.sin((d + 1) * lam) - np.sin((d - 1) * lam)


def flat(low: float, high: float, points: int = 4001) -> NDArray[np.float64]:
    step = (high - low) / points
    hertz: NDArray[np.float64] = low + step * (np.arange(points) + 0.5)
    return hertz


def compressed(n: int, taps: list[Fraction]) -> TapTable:
    return TapTable.from_rationals([*[[]] * (n - 1), taps], [Q(1)] * n)


def test_four_panels_to_a_ripple_and_sixteen_to_a_band() -> None:
    """Up to half the rate cos 17λ, the fastest with 8 taps over 8 samples, has 8½ ripples."""
    for high, panels in ((RATE / 2, 34), (Q(10), 16)):
        points = _points(Balance(8), 8, Band(Q(0), high), RATE)
        middles = points.hertz[1::3]
        assert middles == [(Q(1, 2) + k) * high / panels for k in range(panels)]
        # Gauss and Legendre's three points integrate every fifth power exactly
        for power in range(6):
            pairs = zip(points.weights, points.hertz, strict=True)
            total = sum(w * exact(f**power) for w, f in pairs)
            expected = float(high) ** (power + 1) / (power + 1)
            assert float(total) == pytest.approx(expected, rel=1e-14)


SIMPSON = np.array([1, 4, 1]) / 3


@pytest.mark.parametrize("phase", [0.3, 1.7])
@pytest.mark.parametrize("response", [Response(), Response((Sinc(Q(3, 2)),))])
@pytest.mark.parametrize("way", ["increment", "zeng", "newton-cotes", "plain"])
def test_terms_of_the_balance(way: str, response: Response, phase: float) -> None:
    """(B1) of two samples, term by term; W is Simpson's rule."""
    kind: Any = "increment" if way == "increment" else "rate"
    how: Any = "plain" if way == "increment" else way
    taps, right = Balance(2, kind, how, response).terms(Decimal(phase), 3)
    power = abs(response.value(phase)) ** 2
    sample = phase**2 if kind == "rate" else 4 * np.sin(phase / 2) ** 2
    distances = np.arange(1, 4)
    assert np.array(taps, float) == pytest.approx(power * sample * np.sin(distances * phase))
    W = np.sum(SIMPSON * np.exp(-1j * phase * np.arange(3)))
    between = {
        "increment": 0.5 * np.sin(2 * phase),
        "zeng": 0.5 * np.sin(2 * phase),
        "newton-cotes": 0.25 * abs(W) ** 2 * phase**2 / np.tan(phase),
        "plain": 0.5 * np.sin(2 * phase) / (np.sin(phase / 2) / (phase / 2)) ** 2,
    }[way]
    assert float(right) == pytest.approx(phase - power * between, rel=1e-13)


def panels(band: Band, widest: Fraction) -> list[tuple[Fraction, Fraction]]:
    return list(band.panels(widest))


def test_panels_break_where_the_weight_does() -> None:
    band = Band(Q(10), Q(40), ((Q(10), Q(1)), (Q(20), Q(2)), (Q(40), Q(1))))
    edges = [Q(10), Q(15), *(20 + Q(20, 3) * k for k in range(4))]
    assert panels(band, Q(8)) == list(pairwise(edges))
    # a mode is resolved to its width, a fiftieth of its frequency at least, where it is inside
    for damping, count in ((Q(1, 10), 40), (Q(1, 100), 200)):
        mounted = Band(Q(0), Q(100), mount=RotaryMode(Q(25), damping))
        found = panels(mounted, Q(50))
        assert found == [(Q(100, count) * k, Q(100, count) * (k + 1)) for k in range(count)]
    for natural in (Q(100), Q(200)):
        mounted = Band(Q(0), Q(100), mount=RotaryMode(natural, Q(1, 10)))
        assert panels(mounted, Q(50)) == [(Q(0), Q(50)), (Q(50), Q(100))]
    low = Band(Q(25), Q(100), mount=RotaryMode(Q(25), Q(1, 10)))
    assert panels(low, Q(75)) == [(Q(25), Q(100))]


def test_weights_at_and_between_points() -> None:
    points = ((Q(10), Q(4)), (Q(20), Q(2)), (Q(40), Q(8)))
    straight, log = Band(Q(10), Q(40), points), Band(Q(10), Q(40), points, True)
    for hertz, weight in ((10, 4), (15, 3), (20, 2), (30, 5), (40, 8)):
        assert straight.weight(Q(hertz)) == weight
    # 2 (f/20)² above 20 Hz, 4 (10/f) below
    for hertz, weight in ((10, 4.0), (16, 2.5), (20, 2.0), (30, 4.5), (40, 8.0)):
        assert float(log.weight(Q(hertz))) == pytest.approx(weight, rel=1e-14)
    assert Band(Q(10), Q(40)).weight(Q(17)) == 1
    mounted = Band(Q(10), Q(40), points, mount=RotaryMode(Q(30), Q(1, 4)))
    assert float(mounted.weight(Q(15))) == pytest.approx(3 / (0.75**2 + 4 / 16 / 4), rel=1e-14)


def test_a_denominator_that_holds_the_constraint_where_the_factor_is_small() -> None:
    for slow, denominator in ((None, 16), (Q(1, 3), 48), (Q(1, 16), 16), (Q(5, 48), 48)):
        assert _denominator(4, slow) == denominator
    assert [_denominator(0, Q(1, count)) for count in (256, 257)] == [256, 1]


def test_sixteen_taps_are_the_most() -> None:
    assert _checked_count(Balance(12), 5) == 16
    with pytest.raises(InputError, match=r"17 is too large for a least-squares fit, .* up to 16"):
        _checked_count(Balance(12, "rate"), 5)
    assert _checked_count(Balance(1, "rate"), 0) == 1


def test_matched_taps_are_rounded_for_an_eighth_of_the_rate() -> None:
    balance = Balance(3)
    found = matched_and_rounded(balance, 0, RATE, 12)
    assert found == round_taps([Q(27, 20), Q(9, 20)], balance, Band(Q(0), Q(125)), RATE, 12)
    assert 124 < found.worst_hz < 125  # at the band's last point
    with pytest.raises(InputError, match="1 sample gives no cross product"):
        matched(Balance(1), 0)


def test_exact_taps_of_128_bits_are_the_widest() -> None:
    """One tap of two samples behind a mean over w of them: K_1 = 2/3 + w²/12."""

    def made(m: int) -> TapTable:
        return matched(Balance(2, response=Response((Sinc(Q(2 * m)),))), 0)

    assert made(3 * 2**63 + 1).taps[-1] == (((3 * 2**63 + 1) ** 2 + 2) // 3,)
    assert made(3 * 2**63 + 1).taps[-1][0].bit_length() == 128
    with pytest.raises(InputError, match="exact taps would take 129 bits"):
        made(2**65)


@pytest.mark.parametrize(
    ("n", "p", "low", "high"), [(2, 0, 0, 100), (3, 0, 50, 400), (4, 0, 0, 300), (2, 2, 0, 450)]
)
def test_the_fit_is_numpys(n: int, p: int, low: int, high: int) -> None:
    result = fit(Balance(n), p, Band(Q(low), Q(high)), RATE, constrained=False)
    phase = 2 * pi * flat(low, high) / 1000
    truth = 0.5 * (n * phase - np.sin(n * phase))
    P = basis(n, n + p - 1, phase)
    expected, *_ = np.linalg.lstsq(P, truth, rcond=None)
    assert np.array(result.reals, np.float64) == pytest.approx(expected, rel=1e-5)
    rms = float(np.sqrt(np.mean((P @ expected - truth) ** 2)))
    assert result.rms_real == pytest.approx(rms, rel=1e-4)


def weights(hertz: NDArray[np.float64]) -> dict[str, tuple[Band, NDArray[np.float64]]]:
    table = ((Q(20), Q(1, 100)), (Q(80), Q(4, 100)), (Q(350), Q(4, 100)), (Q(450), Q(7, 1000)))
    x, y = (np.array(column, np.float64) for column in zip(*table, strict=True))
    r = (hertz / 50) ** 2
    lines = np.interp(hertz, x, y)
    profile = np.exp(np.interp(np.log(hertz), np.log(x), np.log(y)))
    return {
        "psd": (Band(Q(20), Q(450), table), lines),
        "profile": (Band(Q(20), Q(450), table, True), profile),
        "mounted": (
            Band(Q(20), Q(450), table, True, RotaryMode(Q(50), Q(1, 8))),
            profile / ((1 - r) ** 2 + 4 * 0.125**2 * r),
        ),
    }


@pytest.mark.parametrize("kind", ["psd", "profile", "mounted"])
def test_weights(kind: str) -> None:
    hertz = flat(20, 450)
    band, weight = weights(hertz)[kind]
    result = fit(Balance(4), 0, band, RATE, constrained=False)
    phase = 2 * pi * hertz / 1000
    P, truth = basis(4, 3, phase), 0.5 * (4 * phase - np.sin(4 * phase))
    root = np.sqrt(weight)
    expected, *_ = np.linalg.lstsq(root[:, np.newaxis] * P, root * truth, rcond=None)
    assert np.array(result.reals, np.float64) == pytest.approx(expected, rel=1e-4)
    table = compressed(4, result.sums)
    mean = np.average(filtered_residual(table, phase) ** 2, weights=weight)
    assert result.rms_rounded == pytest.approx(float(np.sqrt(mean)), rel=1e-4)


@pytest.mark.parametrize("bits", [4, 8, 12])
def test_rounding_is_the_best_there_is(bits: int) -> None:
    """Against every integer near the reals."""
    n, high = 4, 100.0
    result = fit(Balance(n), 0, Band(Q(0), Q(100)), RATE, bits, constrained=False)
    phase = 2 * pi * flat(0, high, 400) / 1000
    reals = np.array(result.reals, np.float64)
    around = np.stack(np.meshgrid(*[np.arange(-20, 21)] * 3), -1).reshape(-1, 3)
    near = np.rint(reals * 2**bits) + around
    P, truth = basis(n, 3, phase), 0.5 * (n * phase - np.sin(n * phase))
    R = np.linalg.qr(P, mode="r")
    # the residual's square splits into the fit's own and this
    extra = np.sum(((near / 2**bits - reals) @ R.T) ** 2, axis=1)
    mine = np.sum(((np.array(result.integers) / 2**bits - reals) @ R.T) ** 2)
    assert mine <= np.min(extra) * 1.001
    best = np.mean((P @ (np.array(result.integers) / 2**bits) - truth) ** 2) ** 0.5
    assert result.rms_rounded == pytest.approx(float(best), rel=1e-3)
    assert result.rms_real <= result.rms_rounded <= result.rms_nearest


def test_rounding_beats_the_nearest_integers_by_far() -> None:
    result = fit(Balance(6), 0, Band(Q(0), Q(100)), RATE, 16)
    assert result.rms_rounded < result.rms_nearest / 20
    moved = [abs(k - float(x) * 2**16) for k, x in zip(result.integers, result.reals, strict=True)]
    assert max(moved) <= 2**12  # no tap by more than 2^-4


def test_loss_is_reported_from_the_rounded_table() -> None:
    result = fit(Balance(5), 0, Band(Q(0), Q(150)), RATE, 14)
    hertz = flat(0, 150)
    left = filtered_residual(compressed(5, result.sums), 2 * pi * hertz / 1000)
    assert result.rms_rounded == pytest.approx(float(np.sqrt(np.mean(left**2))), rel=1e-3)
    assert result.worst_rounded == pytest.approx(float(np.max(np.abs(left))), rel=0.03)
    assert result.loss == pytest.approx(result.rms_rounded / result.rms_real - 1)
    assert result.loss > 0


def test_better_than_taylor_in_its_band_and_worse_below_it() -> None:
    n, hertz = 4, np.array([5.0, 190.0])
    table = fit(Balance(n), 0, Band(Q(0), Q(200)), RATE).table(Balance(n))
    least, taylor = (
        np.abs(filtered_residual(t, 2 * pi * hertz / 1000)) for t in (table, frequency_taylor(n, 0))
    )
    assert least[1] < taylor[1] / 5
    assert least[0] > taylor[0]


def test_many_taps_over_a_low_band() -> None:
    """Doubles lose this one altogether: the columns agree to some 40 digits."""
    result = fit(Balance(12), 4, Band(Q(0), Q(20)), RATE, 40)
    taylor = frequency_taylor(12, 4)
    expected = [tap / taylor.denominator for tap in taylor.taps[-1]]
    # over a band going to zero, least squares go to Taylor
    assert list(map(float, result.reals)) == pytest.approx(expected, rel=0.05)
    assert result.rms_real < 1e-25
    assert result.rms_rounded < result.rms_nearest / 100


def test_every_tap_is_at_a_minimum_behind_a_filter() -> None:
    """Tuned, rate sensor, plain sums: moving any tap either way raises the mean square."""
    response = Response((Sinc(Q(3, 2)),))
    balance = Balance(3, "rate", "plain", response)
    result = fit(balance, 0, Band(Q(20), Q(300)), RATE, 30, constrained=False)
    phase = 2 * pi * flat(20, 300, 1000) / 1000

    def mean_square(taps: list[Fraction]) -> float:
        table = TapTable.from_rationals([[], [], taps], balance.weights)
        return float(np.mean(filtered_residual(table, phase, "rate", response) ** 2))

    least = mean_square(result.sums)
    for i, step in product(range(3), (Q(1, 1000), Q(-1, 1000))):
        moved = [k + step * (i == j) for j, k in enumerate(result.sums)]
        assert mean_square(moved) > least


@pytest.mark.parametrize(
    ("n", "p", "low", "high"), [(3, 0, 50, 400), (4, 0, 0, 200), (5, 0, 0, 100), (2, 2, 0, 450)]
)
def test_the_constrained_fit_is_that_of_lagranges_multiplier(
    n: int, p: int, low: int, high: int
) -> None:
    """Least mean square where Σ d K_d = n³/12 (Yang Eq. 17), by the bordered system in doubles."""
    result = fit(Balance(n), p, Band(Q(low), Q(high)), RATE)
    phase = 2 * pi * flat(low, high) / 1000
    P, truth = basis(n, n + p - 1, phase), 0.5 * (n * phase - np.sin(n * phase))
    size = 1 / np.linalg.norm(P, axis=0)
    distance = np.arange(1, n + p)
    bordered = np.zeros((n + p, n + p))
    bordered[:-1, :-1] = (P * size).T @ (P * size)
    bordered[-1, :-1] = bordered[:-1, -1] = distance * size
    right = np.append((P * size).T @ truth, n**3 / 12)
    expected = np.linalg.solve(bordered, right)[:-1] * size
    assert np.array(result.reals, np.float64) == pytest.approx(expected, rel=1e-4)
    assert sum(d * k for d, k in enumerate(result.sums, start=1)) == Q(n**3, 12)
    assert result.missed == 0
    free = fit(Balance(n), p, Band(Q(low), Q(high)), RATE, constrained=False)
    assert free.rms_real < result.rms_real < 4 * free.rms_real
    assert free.denominator == 1 << 24
    assert result.denominator in (1 << 24, 3 << 24)


@pytest.mark.parametrize("bits", [4, 8, 12])
def test_rounding_under_the_constraint_is_the_best_there_is(bits: int) -> None:
    """Against all integers near the reals whose Σ d K_d is right, by the cost that is stated."""
    n = 4
    result = fit(Balance(n), 0, Band(Q(0), Q(100)), RATE, bits)
    unit = 1 / result.denominator
    reals = np.array(result.reals, np.float64)
    around = np.stack(np.meshgrid(*[np.arange(-40, 41)] * 2), -1).reshape(-1, 2)
    others = np.rint(reals[1:] / unit) + around
    total = Q(16, 3) * result.denominator
    assert total.denominator == 1
    near = np.column_stack((int(total) - others @ [2, 3], others))
    phase = 2 * pi * flat(0, 100, 400) / 1000
    R = np.linalg.qr(basis(n, 3, phase), mode="r") / np.sqrt(len(phase))

    def cost(integers: NDArray[np.float64]) -> NDArray[np.float64]:
        """Of the residual, and of each unit that a tap is moved: a hundredth of the fit's own."""
        moved = integers * unit - reals
        share = 0.01 * result.rms_real**2 / (len(reals) * unit**2)
        return np.asarray(np.sum((moved @ R.T) ** 2 + share * moved**2, axis=-1))

    assert cost(np.array(result.integers, np.float64)) <= np.min(cost(near)) * 1.001
    assert np.array(result.integers) @ [1, 2, 3] == total


def test_one_tap_is_fitted_freely() -> None:
    result = fit(Balance(2), 0, Band(Q(0), Q(200)), RATE)
    assert result.slow is None
    assert result.sums != [Q(2, 3)]  # the constraint would leave nothing to fit


def test_behind_a_filter_slow_motion_is_held_to_a_unit_of_rounding() -> None:
    """Σ d K_d of (B1) to the first power: n³/12 and what 1/|F|² = 1 + w²λ²/12 + ... asks for."""
    width = Q(7, 5)
    result = fit(Balance(3, response=Response((Sinc(width),))), 0, Band(Q(0), Q(200)), RATE, 20)
    assert result.slow == Q(27, 12) + 3 * width**2 / 24
    assert abs(result.missed) * result.denominator <= Q(1, 2)


class TestLattice:
    def test_skewed_basis(self) -> None:
        """(k - x) G (k - x) with near-parallel columns, against all integers of a wide window."""
        rng = np.random.default_rng(3)
        for _ in range(6):
            B = rng.integers(-9, 10, (3, 3)) + np.array([[40, 39, 41]] * 3)
            if abs(np.linalg.det(B)) < 1:
                continue
            G = B.T @ B
            x = rng.normal(size=3) * 3
            window = np.stack(np.meshgrid(*[np.arange(-30, 31)] * 3), -1).reshape(-1, 3)
            cost = np.sum(((window - x) @ B.T) ** 2, axis=1)
            found = closest_integers(
                [[Decimal(int(v)) for v in row] for row in G], [Decimal(float(v)) for v in x]
            )
            mine = float(np.sum((B @ (np.array(found) - x)) ** 2))
            assert mine <= float(np.min(cost)) * (1 + 1e-9)

    def test_search_goes_both_ways(self) -> None:
        """On bases that are not reduced, where the best is often not near the centre."""
        rng = np.random.default_rng(11)
        window = np.stack(np.meshgrid(*[np.arange(-12, 13)] * 2), -1).reshape(-1, 2)
        for _ in range(200):
            slope, y = rng.uniform(-0.5, 0.5), rng.uniform(-1, 1, 2)
            lengths = np.array([100.0, 1.0])
            away = window - y
            cost = (
                lengths[0] * (away[:, 0] + slope * away[:, 1]) ** 2 + lengths[1] * away[:, 1] ** 2
            )
            mu = [[Decimal(1), Decimal(0)], [Decimal(slope), Decimal(1)]]
            found = search(mu, list(map(Decimal, lengths)), list(map(Decimal, y)))
            assert found == window[np.argmin(cost)].tolist()

    def test_orthogonal_basis_is_nearest(self) -> None:
        form = [[Decimal(3), Decimal(0)], [Decimal(0), Decimal(1)]]
        assert closest_integers(form, [Decimal("2.4"), Decimal("-1.6")]) == [2, -2]


@pytest.mark.parametrize(
    ("balance", "history", "band", "message"),
    [
        (Balance(1), 0, Band(Q(0), Q(9)), "1 sample gives no cross product"),
        (Balance(12), 6, Band(Q(0), Q(9)), "18 is too large .* up to 17"),
        (
            Balance(2, response=Response((Sinc(Q(4)),))),
            0,
            Band(Q(0), Q(260)),
            "passes less than 1 % at 250 Hz",
        ),
    ],
)
def test_faults(balance: Balance, history: int, band: Band, message: str) -> None:
    with pytest.raises(InputError, match=message):
        fit(balance, history, band, RATE)


def test_rounding_given_taps_keeps_their_response() -> None:
    table = frequency_taylor(4, 0)
    sums = [Q(tap, table.denominator) for tap in table.taps[-1]]
    result: Fit = round_taps(sums, Balance(4), Band(Q(0), Q(125)), RATE, 24)
    assert [float(x) for x in result.reals] == pytest.approx([float(x) for x in sums])
    assert result.rms_rounded == pytest.approx(result.rms_real, rel=1e-2)


def test_rounding_does_not_let_taps_wander() -> None:
    """Over a low band the best integers of all lie whole units off: they are not wanted."""
    result = fit(Balance(6), 6, Band(Q(0), Q(100)), RATE, 24)
    moved = [abs(k / 2**24 - float(x)) for k, x in zip(result.integers, result.reals, strict=True)]
    assert max(moved) <= 1 / 16
    assert result.rms_rounded < result.rms_nearest / 1000
