"""Coefficients against the literature, and against the coning motion they are made for.

A coning motion of frequency lambda (per sample interval, half angle a) has increments

    s_i = theta(i) - theta(i-1),    theta(t) = a (cos lambda t, sin lambda t, 0)

so s_i x s_j = 4 a^2 sin^2(lambda/2) sin((j-i) lambda), and its coning over n samples is
a^2 (n lambda - sin n lambda)/2.  Both are written here as power series of exact rationals.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from functools import cache
from math import comb, factorial, gcd, log2
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sculler_model.algorithms import TapTable, filtered_rate, frequency_taylor, newton_cotes
from sculler_model.algorithms.tap_table import CLOSED_FORMS, solve_exactly
from sculler_model.errors import InputError
from tiers import few_of

F = Fraction
Series = list[Fraction]
"""Coefficients of lambda^0, lambda^1, ..."""

taylor = cache(frequency_taylor)
every_n = pytest.mark.parametrize("n", few_of(range(1, 17), range(1, 10)))


def rational_taps(table: TapTable, phase: int) -> list[Fraction]:
    return [F(c, table.denominator) for c in table.taps[phase - 1]]


@cache
def sine(factor: int, terms: int) -> Series:
    """sin(factor * lambda)"""
    return [
        F(0) if i % 2 == 0 else F((-1) ** (i // 2) * factor**i, factorial(i)) for i in range(terms)
    ]


def product(a: Series, b: Series) -> Series:
    powers = range(len(a))
    return [sum((a[i] * b[k - i] for i in range(k + 1) if a[i] and b[k - i]), F(0)) for k in powers]


def total(series: Iterable[tuple[Fraction, Series]], terms: int) -> Series:
    sums = [F(0)] * terms
    for factor, each in series:
        sums = [a + factor * b if b else a for a, b in zip(sums, each, strict=True)]
    return sums


@cache
def four_sin_squared_of_half(terms: int) -> Series:
    half_sine = [c / 2**i for i, c in enumerate(sine(1, terms))]
    return [4 * c for c in product(half_sine, half_sine)]


def response(row: list[Fraction], terms: int) -> Series:
    """What the algorithm makes of a unit coning motion: sum of k_d s[t-d] x s[t]."""
    sines = total(((k, sine(d, terms)) for d, k in enumerate(row, start=1)), terms)
    return product(four_sin_squared_of_half(terms), sines)


def first_power_left(n: int, row: list[Fraction], between: Series) -> tuple[int, Fraction]:
    """First power of lambda where truth and algorithm differ, and truth minus algorithm there.

    Truth is n lambda/2 a minor interval; `between` is what arises between intervals.
    """
    truth = [F(n, 2) if i == 1 else F(0) for i in range(len(between))]
    made = response(row, len(between))
    left = [t - b - m for t, b, m in zip(truth, between, made, strict=True)]
    return next((i, c) for i, c in enumerate(left) if c)


class TestFrequencyTaylor:
    @pytest.mark.parametrize(
        ("n", "p", "denominator", "oldest_first"),
        [
            (2, 0, 3, [2]),
            (3, 0, 20, [9, 27]),
            (4, 0, 105, [54, 92, 214]),
            (5, 0, 504, [250, 525, 650, 1375]),
            (1, 1, 12, [1]),
            (2, 1, 30, [-1, 22]),
            (3, 1, 280, [3, 114, 393]),
        ],
    )
    def test_published_values(
        self, n: int, p: int, denominator: int, oldest_first: list[int]
    ) -> None:
        table = frequency_taylor(n, p)
        assert table.denominator == denominator
        assert list(table.taps[-1]) == oldest_first[::-1]

    @every_n
    def test_matches_coning_in_every_power_it_can_and_no_further(self, n: int) -> None:
        for p in range(0 if n > 1 else 1, n + 1):
            between = [c / 2 for c in sine(n, 2 * (n + p) + 3)]
            power, _ = first_power_left(n, rational_taps(taylor(n, p), n), between)
            assert power == 2 * (n + p) + 1, p

    @pytest.mark.parametrize(
        ("n", "constant"), [(2, F(1, 30)), (3, F(3, 280)), (4, F(1, 315)), (5, F(5, 5544))]
    )
    def test_leading_residual(self, n: int, constant: Fraction) -> None:
        between = [c / 2 for c in sine(n, 2 * n + 3)]
        row = rational_taps(frequency_taylor(n, 0), n)
        power, left = first_power_left(n, row, between)
        assert (power, abs(left)) == (2 * n + 1, constant)

    @every_n
    def test_form(self, n: int) -> None:
        for p in range(0 if n > 1 else 1, n + 1):
            table = taylor(n, p)
            assert table.samples == n
            assert table.active_phases == (n,)
            assert all(table.taps[n - 1])
            assert table.reach == table.history == n + p - 1
            assert (table.sum_denominator, table.weights) == (1, (1,) * n + (0,))
            assert gcd(table.denominator, *table.taps[-1]) == 1

    def test_one_sample_makes_no_product(self) -> None:
        with pytest.raises(InputError, match="give samples \\+ history >= 2"):
            frequency_taylor(1, 0)


def sin_of(x: Fraction) -> Fraction:
    """Far more digits than any test asks for."""
    terms = ((-1) ** i * x ** (2 * i + 1) / factorial(2 * i + 1) for i in range(16))
    return sum(terms, F(0))


def coning_made(table: TapTable, cos: Fraction, sin: Fraction) -> Fraction:
    """What a table makes of one minor interval of unit coning motion, from its samples."""
    n = table.samples
    theta = {0: (F(1), F(0))}
    for t in range(1, n + 1):
        x, y = theta[t - 1]
        theta[t] = (x * cos - y * sin, y * cos + x * sin)
    for t in range(-1, -table.history - 2, -1):
        x, y = theta[t + 1]
        theta[t] = (x * cos + y * sin, y * cos - x * sin)

    def sample(i: int) -> tuple[Fraction, Fraction]:
        return theta[i][0] - theta[i - 1][0], theta[i][1] - theta[i - 1][1]

    coning = F(0)
    for k in range(1, n + 1):
        x_k, y_k = sample(k)
        for d, c in enumerate(rational_taps(table, k), start=1):
            x_d, y_d = sample(k - d) if c else (F(0), F(0))
            coning += c * (x_d * y_k - y_d * x_k)
    return coning


def measured_residual(table: TapTable, x: Fraction) -> Fraction:
    """|truth - algorithm| over one minor interval of unit coning motion, lambda = x."""
    cos = 1 - 2 * sin_of(x / 2) ** 2
    truth = (table.samples * x - sin_of(table.samples * x)) / 2
    return abs(truth - coning_made(table, cos, sin_of(x)))


# Savage-20 method 4 and Song: c12 = c23 = 27/40, c13 = 9/20; and the n = 4 table
UNCOMPRESSED = {
    3: TapTable.from_integers(3, 40, [[], [27], [27, 18]]),
    4: TapTable.from_integers(4, 315, [[], [232], [178, 138], [232, 138, 162]]),
}


class TestMeasuredResidual:
    """The law lambda^(2n+1), measured on sampled coning motions."""

    @pytest.mark.parametrize(
        ("n", "constant"), [(2, F(1, 30)), (3, F(3, 280)), (4, F(1, 315)), (5, F(5, 5544))]
    )
    def test_order_and_constant(self, n: int, constant: Fraction) -> None:
        fine, coarse = F(1, 256), F(1, 128)
        table = frequency_taylor(n, 0)
        small, large = (measured_residual(table, x) for x in (fine, coarse))
        assert log2(large / small) == pytest.approx(2 * n + 1, abs=1e-3)
        assert float(small / fine ** (2 * n + 1) / constant) == pytest.approx(1, abs=1e-3)

    @pytest.mark.parametrize(("n", "p"), [(1, 1), (2, 1), (3, 1), (2, 2), (3, 3)])
    def test_order_with_history(self, n: int, p: int) -> None:
        table = frequency_taylor(n, p)
        small, large = (measured_residual(table, x) for x in (F(1, 256), F(1, 128)))
        assert log2(large / small) == pytest.approx(2 * (n + p) + 1, abs=1e-3)

    @pytest.mark.parametrize("n", [3, 4])
    def test_uncompressed_tables_have_the_response_of_the_compressed(self, n: int) -> None:
        cos, sin = F(4, 5), F(3, 5)  # a frequency whose cosine and sine are rational
        ours = coning_made(frequency_taylor(n, 0), cos, sin)
        assert ours == coning_made(UNCOMPRESSED[n], cos, sin) != 0


class TestFilteredRate:
    """Rate samples that passed sin(lambda/2)/(lambda/2), per sample interval (Zeng)."""

    def test_published_values(self) -> None:
        table = filtered_rate(2)
        assert rational_taps(table, 2) == [F(89, 120), F(1, 240)]
        # Simpson 1, 4, 1 over 6, and the sum carries one more factor n
        assert [F(w, table.sum_denominator) for w in table.weights] == [
            F(2 * w, 6) for w in (1, 4, 1)
        ]

    @every_n
    def test_matches_coning_in_every_power_it_can_and_no_further(self, n: int) -> None:
        # The products of the filtered rates are those of the increments.  Between the intervals
        # the filter works twice: F^2 sin(n lambda)/2 with F^2 = 4 sin^2(lambda/2)/lambda^2.
        for p in range(n + 1):
            terms = 2 * (n + p) + 5
            filter_squared = four_sin_squared_of_half(terms + 2)[2:]
            between = [c / 2 for c in product(filter_squared, sine(n, terms))]
            row = rational_taps(filtered_rate(n, p), n)
            power, _ = first_power_left(n, row, between)
            assert power == 2 * (n + p) + 3, p

    @every_n
    def test_form(self, n: int) -> None:
        table = filtered_rate(n)
        assert table.active_phases == (n,)
        assert table.reach == table.history == n
        assert len(table.weights) == n + 1
        assert gcd(table.denominator, *table.taps[-1]) == 1
        assert gcd(table.sum_denominator, *table.weights) == 1
        assert sum(table.weights) == n * table.sum_denominator


class TestNewtonCotes:
    @pytest.mark.parametrize(
        ("n", "weights"),
        [
            (1, [F(w, 2) for w in (1, 1)]),
            (2, [F(w, 3) for w in (1, 4, 1)]),
            (3, [F(3 * w, 8) for w in (1, 3, 3, 1)]),
            (4, [F(2 * w, 45) for w in (7, 32, 12, 32, 7)]),
            (8, [F(4 * w, 14175) for w in (989, 5888, -928, 10496, -4540)]),
        ],
    )
    def test_published_values(self, n: int, weights: list[Fraction]) -> None:
        full = newton_cotes(n)
        assert full[: len(weights)] == weights
        assert full == full[::-1]

    @every_n
    def test_integrates_every_polynomial_up_to_its_degree(self, n: int) -> None:
        # in Bernstein's basis, where no two tests are nearly alike; even n gain one degree
        degree = n + 1 if n % 2 == 0 else n
        weights = newton_cotes(n)
        for i in range(degree + 1):
            values = [
                comb(degree, i) * F(t, n) ** i * F(n - t, n) ** (degree - i) for t in range(n + 1)
            ]
            integral = sum(w * v for w, v in zip(weights, values, strict=True))
            assert integral == F(n, degree + 1)


@settings(deadline=None, max_examples=60)
@given(
    st.integers(1, 4).flatmap(
        lambda n: st.tuples(
            st.lists(
                st.lists(st.fractions(-9, 9, max_denominator=9), min_size=n, max_size=n),
                min_size=n,
                max_size=n,
            ),
            st.lists(st.fractions(-9, 9, max_denominator=9), min_size=n, max_size=n),
        )
    )
)
def test_solve_exactly(system: tuple[list[list[Fraction]], list[Fraction]]) -> None:
    matrix, right = system
    try:
        solution = solve_exactly(matrix, right)
    except ZeroDivisionError:
        # singular: some combination of the rows vanishes, so the determinant is zero
        assert determinant(matrix) == 0
        return
    assert [sum(a * x for a, x in zip(row, solution, strict=True)) for row in matrix] == right


def determinant(matrix: list[list[Fraction]]) -> Fraction:
    if not matrix:
        return F(1)
    return sum(
        (
            (-1) ** c * a * determinant([row[:c] + row[c + 1 :] for row in matrix[1:]])
            for c, a in enumerate(matrix[0])
        ),
        F(0),
    )


class TestTapTable:
    def test_every_computed_family_is_named(self) -> None:
        assert CLOSED_FORMS["frequency-taylor"](4, 0) == frequency_taylor(4, 0)
        assert CLOSED_FORMS["filtered-rate"](2, 1) == filtered_rate(2, 1)

    def test_lowest_terms(self) -> None:
        table = TapTable.from_integers(4, 630, [1284, 552, 324], 6, [6, 6, 6, 6, 0])
        assert table == frequency_taylor(4, 0)

    def test_flat_row_is_the_last_phase(self) -> None:
        table = TapTable.from_integers(3, 7, [0, -2])
        assert table.taps == ((0, 0), (0, 0), (0, -2))
        assert table == TapTable.from_integers(3, 7, [[], [], [0, -2]])
        assert table.active_phases == (3,)
        assert (table.reach, table.tap(3, 2), table.tap(3, 1)) == (2, -2, 0)

    def test_weights_left_out_count_every_sample_once(self) -> None:
        table = TapTable.from_integers(3, 7, [1], 5)
        assert (table.sum_denominator, table.weights) == (1, (1, 1, 1, 0))

    @pytest.mark.parametrize(
        ("taps", "weights", "history"),
        [
            ([1], [1], 1),
            ([1, 0, 0], [1], 1),
            ([0, 0, 1], [1], 3),
            ([1], [0, 0, 0, 4], 3),
            ([1], [1, 0, 0, 0], 1),
            ([[0, 0, 0, 5], [], []], [1], 4),
        ],
    )
    def test_history_reaches_to_the_last_coefficient_that_counts(
        self, taps: Any, weights: list[int], history: int
    ) -> None:
        assert TapTable.from_integers(3, 9, taps, 1, weights).history == history

    @pytest.mark.parametrize("n", [1, 2, 5])
    def test_json_is_read_back(self, n: int) -> None:
        for table in (frequency_taylor(n, 1), filtered_rate(n, 1)):
            data: Any = table.as_json()
            again = TapTable.from_integers(
                n, data["denominator"], data["taps"], data["sum_denominator"], data["weights"]
            )
            assert again == table

    @pytest.mark.parametrize(
        ("changes", "faults"),
        [
            ({"denominator": 0}, ["denominator: 0 is not allowed, give a whole number >= 1"]),
            ({"denominator": -3}, ["denominator: -3 is not"]),
            ({"sum_denominator": -1, "weights": [1]}, ["sum_denominator: -1 is not allowed"]),
            ({"taps": [1, [2], 3]}, ["taps: numbers and rows are mixed"]),
            ({"taps": [[], [1]]}, ["taps: 2 rows for samples = 3, give one row per phase 1..n"]),
            ({"taps": [[1]] * 4}, ["taps: 4 rows for samples = 3"]),
            ({"taps": [0, 0]}, ["taps: every tap is zero"]),
            ({"taps": [[], [0], []]}, ["taps: every tap is zero"]),
            ({"taps": [1] * 33}, ["taps: a row of 33 reaches too far back, give at most 32"]),
            ({"weights": []}, ["weights: 0 numbers for samples = 3, give 1 to 4"]),
            ({"weights": [1] * 5}, ["weights: 5 numbers for samples = 3, give 1 to 4"]),
            ({"weights": [0, 0]}, ["weights: every weight is zero"]),
            (
                {"denominator": 0, "taps": [[1]], "weights": [1] * 9},
                ["denominator: 0 is", "taps: 1 rows", "weights: 9 numbers"],
            ),
        ],
    )
    def test_faults(self, changes: dict[str, Any], faults: list[str]) -> None:
        good: dict[str, Any] = {"samples": 3, "denominator": 2, "taps": [1]}
        TapTable.from_integers(**good)
        with pytest.raises(InputError) as raised:
            TapTable.from_integers(**{**good, **changes})
        parts = str(raised.value).split("; ")
        assert len(parts) == len(faults)
        assert all(part.startswith(fault) for part, fault in zip(parts, faults, strict=True))
        assert "\n" not in str(raised.value)

    def test_the_longest_row_is_allowed(self) -> None:
        assert TapTable.from_integers(1, 1, [0] * 31 + [1]).history == 32
