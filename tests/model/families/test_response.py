"""Filters: against SciPy, against their own series, and what is refused."""

from __future__ import annotations

from decimal import Decimal, localcontext
from fractions import Fraction
from math import cos, e, pi, sin
from pathlib import Path

import numpy as np
import pytest
from scipy import signal

from sculler_model.algorithms import (
    Analogue,
    Digital,
    Measured,
    Response,
    Sinc,
    Stage,
    decimals,
    series,
)
from sculler_model.design.filters import read_response
from sculler_model.errors import InputError

Q = Fraction
PHASES = [0.01, 0.3, 1.1, 2.9]


def rationals(*values: float) -> tuple[Fraction, ...]:
    return tuple(map(decimals.rational, values))


def stages() -> dict[str, Stage]:
    rate = Q(1000)
    return {
        "sinc": Sinc(),
        "cic": Sinc(Q(1, 4), 3),
        "fir": Digital(rationals(0.1, 0.5, 0.7)),
        "iir": Digital(rationals(0.2, 0.1), rationals(1, -1.1, 0.5), Q(1, 8)),
        "analogue": Analogue(rationals(1e-4, 2), rationals(1e-9, 3e-6, 1e-3, 1), rate),
        "measured": Measured(rationals(0, 200, 500), rationals(1, 0.9, 0.4), (Q(0),) * 3, rate),
    }


@pytest.mark.parametrize("name", stages())
@pytest.mark.parametrize("phase", PHASES)
def test_power_is_the_square_of_the_value(name: str, phase: float) -> None:
    stage = stages()[name]
    assert float(stage.power(Decimal(phase))) == pytest.approx(
        abs(stage.value(phase)) ** 2, rel=1e-12
    )


@pytest.mark.parametrize("name", [name for name in stages() if name != "measured"])
def test_series_converges_to_the_power(name: str) -> None:
    stage, phase = stages()[name], 0.05
    series = stage.power_series(12)
    assert series[0] == 1
    total = sum(float(c) * phase ** (2 * k) for k, c in enumerate(series))
    assert total == pytest.approx(abs(stage.value(phase)) ** 2, rel=1e-13)
    once = Response((stage,))
    inverse = once.inverse_power_series(12)
    total = sum(float(c) * phase ** (2 * k) for k, c in enumerate(inverse))
    assert total == pytest.approx(abs(stage.value(phase)) ** -2, rel=1e-13)


def test_sinc_is_zengs_filter() -> None:
    assert Sinc().value(0.8) == pytest.approx(sin(0.4) / 0.4)
    assert Sinc().power_series(3) == [1, Q(-1, 12), Q(1, 360)]  # 2(1 - cos λ)/λ²


@pytest.mark.parametrize("phase", PHASES)
def test_values_are_scipys(phase: float) -> None:
    b, a = [0.2, 0.1], [1, -1.1, 0.5]
    _, expected = signal.freqz(b, a, [phase / 8])
    found = stages()["iir"].value(phase)
    assert found == pytest.approx(expected[0] * sum(a) / sum(b), rel=1e-12)
    _, expected = signal.freqs([1e-4, 2], [1e-9, 3e-6, 1e-3, 1], [phase * 1000])
    assert stages()["analogue"].value(phase) == pytest.approx(expected[0] / 2, rel=1e-12)


def test_a_mean_of_four_is_a_sinc_over_a_sinc() -> None:
    """The Dirichlet kernel, exactly, term by term of the series."""
    mean = Digital((Q(1, 4),) * 4).power_series(8)
    both = Response((Digital((Q(1, 4),) * 4), Sinc())).power_series(8)
    assert both == Sinc(Q(4)).power_series(8)
    assert mean != both


def test_measured_is_joined_by_straight_lines() -> None:
    stage = Measured(
        rationals(10, 100, 200), rationals(1, 0.8, 0.4), rationals(0, -90, -90), Q(1000)
    )
    assert stage.value(2 * pi * 0.15) == pytest.approx(-0.6j)
    assert stage.value(2 * pi * 0.055) == pytest.approx(0.9 * (1 - 1j) / 2**0.5)
    assert stage.value(0.0) == 1  # below the first point as at it
    assert np.isnan(stage.value(2 * pi * 0.3))
    with pytest.raises(InputError, match="ends at 200 Hz, inside the band"):
        stage.power(Decimal(2))
    with pytest.raises(InputError, match="no power series"):
        stage.power_series(4)


@pytest.mark.parametrize("seed", range(8))
def test_measured_is_numpys_interpolation(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = int(rng.integers(2, 6))
    hertz = np.cumsum(rng.integers(1, 90, points)) - (1 if seed % 2 else 0)
    if seed % 4 == 1:
        hertz[0] = 0
    gains, degrees = rng.integers(0, 20, points) / 16, rng.integers(-90, 1, points)
    stage = Measured(*(rationals(*column.tolist()) for column in (hertz, gains, degrees)), Q(1000))
    for at in [0.0, *hertz.tolist(), *rng.uniform(0, hertz[-1], 20)]:
        phase = 2 * pi * at / 1000 * (1 - 1e-15)
        gain, angle = (np.interp(at, hertz, column) for column in (gains, degrees))
        expected = gain * np.exp(1j * np.radians(angle))
        assert stage.value(phase) == pytest.approx(expected, rel=1e-9, abs=1e-9)
        assert float(stage.power(Decimal(phase))) == pytest.approx(gain**2, rel=1e-9, abs=1e-9)
    first = 1 if hertz[0] == 0 else 0
    late = -degrees[first] / 360 / hertz[first]  # s
    assert stage.delay == pytest.approx(1000 * late, rel=1e-12, abs=0)


@pytest.mark.parametrize("name", stages())
def test_the_delay_is_the_slope_of_the_phase(name: str) -> None:
    """Against the filter's own value close to zero frequency."""
    stage = stages()[name]
    assert stage.delay == pytest.approx(-np.angle(stage.value(1e-5)) / 1e-5, rel=1e-6, abs=1e-9)
    both = Response((stage, stages()["iir"]))
    assert both.delay == stage.delay + stages()["iir"].delay


def test_cascade_multiplies() -> None:
    parts = stages()
    both = Response((parts["sinc"], parts["iir"]))
    assert both.value(0.7) == parts["sinc"].value(0.7) * parts["iir"].value(0.7)
    assert Response().value(0.7) == 1
    assert Response().power_series(3) == [1, 0, 0]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Digital(rationals(1), rationals(1, -1)), "at zero frequency"),
        (lambda: Digital(rationals(1, -1)), "at zero frequency"),
        (lambda: Digital(rationals(1), rationals(1, -0.5, -1.5)), "unstable"),
        (lambda: Digital(rationals(1), rationals(1, -2.5, 1)), "unstable"),
        (lambda: Digital(rationals(1), rationals(1, 0, 1)), "unstable"),  # on the circle
        (lambda: Digital(rationals(1), rationals(0, 1)), "begins with 0"),
        (lambda: Digital(()), "one number or more"),
        (lambda: Analogue(rationals(1), rationals(1, 0), Q(1)), "at zero frequency"),
        (lambda: Analogue(rationals(1), rationals(1, -3, 5), Q(1)), "unstable"),
        (lambda: Analogue(rationals(1), rationals(1, 1, 1, 4), Q(9)), "unstable"),
        (lambda: Measured(rationals(1), rationals(1), rationals(0), Q(1)), "two points"),
        (
            lambda: Measured(rationals(5, 5), rationals(1, 1), rationals(0, 0), Q(1)),
            "5 Hz follows 5 Hz",
        ),
        (
            lambda: Measured(rationals(-0.5, 5), rationals(1, 1), rationals(0, 0), Q(1)),
            "must rise from 0 or above, but 5 Hz follows -0.5 Hz",
        ),
        (
            lambda: Measured(rationals(5, 6), rationals(1, -1), rationals(0, 0), Q(1)),
            "gain at 6 Hz is -1",
        ),
    ],
)
def test_no_such_filter(make: type, message: str) -> None:
    with pytest.raises(InputError, match=message):
        make()


def test_stability_is_that_of_the_poles() -> None:
    rng = np.random.default_rng(7)
    seen = set()
    for _ in range(200):
        a = [1.0, *np.round(rng.normal(size=3), 3).tolist()]
        if not sum(a):
            continue
        stable = bool(np.all(np.abs(np.roots(a)) < 1))
        seen.add(stable)
        try:
            Digital((Q(1),), rationals(*a))
            assert stable
        except InputError:
            assert not stable
        left = bool(np.all(np.roots(a).real < 0))
        try:
            Analogue((Q(1),), rationals(*a), Q(3))
            assert left
        except InputError:
            assert not left
    assert seen == {True, False}


class TestDecimals:
    def test_pi(self) -> None:
        with localcontext() as context:
            context.prec = 60
            assert str(decimals.pi()) == (
                "3.14159265358979323846264338327950288419716939937510582097494"
            )

    @pytest.mark.parametrize("x", [-2.0, 0.0, 1e-9, 0.5, 3.1, 9.0])
    def test_sine_and_cosine(self, x: float) -> None:
        s, c = decimals.sine_cosine(Decimal(x))
        assert (float(s), float(c)) == pytest.approx((sin(x), cos(x)), rel=1e-14, abs=1e-16)

    @pytest.mark.parametrize("turns", [0, -1, 1, 2, 1234, -(10**9)])
    def test_digits_are_right_to_the_last(self, turns: int) -> None:
        """Of a sixth of half a turn, and turns on from there."""
        with localcontext() as context:
            context.prec = 80
            x = decimals.pi() * (2 * turns + Decimal(1) / 6)
            context.prec = 50
            s, c = decimals.sine_cosine(x)
            assert abs(s - Decimal("0.5")) < Decimal("1e-49")
            assert abs(2 * c - Decimal(3).sqrt()) < Decimal("1e-48")
            assert len(s.as_tuple().digits) <= 50
            assert len(c.as_tuple().digits) == 50

    @pytest.mark.parametrize("digits", [1, 5, 40])
    def test_a_rational_pi_has_the_digits_asked_for(self, digits: int) -> None:
        pi_of_60 = Q("3.14159265358979323846264338327950288419716939937510582097494")
        assert 0 < abs(decimals.pi_to(digits) - pi_of_60) < Q(10) ** (1 - digits)

    def test_the_smallest_arguments(self) -> None:
        assert decimals.sinc(Decimal(0)) == 1
        assert float(decimals.sinc(Decimal("0.5"))) == pytest.approx(sin(0.5) / 0.5, rel=1e-15)
        assert list(map(float, decimals.sines(Decimal("0.6"), Decimal("0.8"), 1))) == [0.96]
        assert decimals.exact(Q(1, 8)) == Decimal("0.125")

    def test_multiples(self) -> None:
        found = list(map(float, decimals.sines(*decimals.sine_cosine(Decimal("0.35")), 5)))
        assert found == pytest.approx([sin(0.7 * d) for d in range(1, 6)])

    def test_a_float_is_the_decimal_it_is_written_as(self) -> None:
        assert decimals.rational(0.1) == Q(1, 10)
        assert decimals.rational(1e-7) == Q(1, 10**7)
        assert decimals.rational(e) != Q(e)


class TestSeries:
    """In powers of λ², written out."""

    def test_sine_and_cosine(self) -> None:
        assert series.sine(Q(2, 3), 3) == [Q(2, 3), Q(-8, 27 * 6), Q(32, 243 * 120)]
        assert series.cosine(3, 4) == [1, Q(-9, 2), Q(81, 24), Q(-729, 720)]

    def test_the_power_of_an_autocorrelation(self) -> None:
        """Of 1 + 2x + 3x² in x = e^(-iλ/2): 14 + 2·8 cos λ/2 + 2·3 cos λ."""
        assert series.autocorrelation([Q(1), Q(2), Q(3)]) == [14, 8, 3]
        found = series.cosine_sum([Q(14), Q(8), Q(3)], Q(1, 2), 3)
        assert found == [36, -16 * Q(1, 8) - 6 * Q(1, 2), 16 * Q(1, 384) + 6 * Q(1, 24)]

    def test_products_and_quotients(self) -> None:
        a, b = [Q(1), Q(2), Q(3)], [Q(2), Q(-1), Q(5)]
        assert series.multiply(a, b) == [2, 3, 9]
        assert series.divide([Q(2), Q(3), Q(9)], b) == a
        with pytest.raises(ZeroDivisionError):
            series.divide(a, [Q(0), Q(1), Q(1)])


class TestFile:
    def test_reads_two_or_three_columns(self, tmp_path: Path) -> None:
        file = tmp_path / "r.csv"
        file.write_text("freq_hz,gain\n0,1\n\n10.5, 0.5\n")
        assert read_response(file) == [[0, 1], [10.5, 0.5]]
        file.write_text("freq_hz, gain, phase_deg\n0,1,0\n1,1,-3\n")
        assert read_response(file) == [[0, 1, 0], [1, 1, -3]]

    @pytest.mark.parametrize(
        ("text", "message"),
        [
            ("", "the first line must be freq_hz,gain"),
            ("f,g\n1,2\n", "the first line must be freq_hz,gain"),
            ("freq_hz,gain\n0,1\n1,x\n", "line 3: '1,x' is not numbers"),
            ("freq_hz,gain\n0,1,2\n", "line 2 has 3 numbers, the header names 2"),
        ],
    )
    def test_refuses(self, tmp_path: Path, text: str, message: str) -> None:
        file = tmp_path / "r.csv"
        file.write_text(text)
        with pytest.raises(InputError, match=r"sensor\.filter\.file: .*r\.csv") as caught:
            read_response(file)
        assert message in str(caught.value)

    def test_absent_or_binary(self, tmp_path: Path) -> None:
        with pytest.raises(InputError, match="No such file"):
            read_response(tmp_path / "none.csv")
        (tmp_path / "b.csv").write_bytes(b"\xff\xfe\x00")
        with pytest.raises(InputError, match="not a text file"):
            read_response(tmp_path / "b.csv")
