"""time-taylor and uncompressed: published tables, and polynomial motions integrated by hand."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import islice, pairwise

import pytest

from sculler_model.algorithms import (
    TapTable,
    distance_sums,
    first_manoeuvre_error,
    frequency_taylor,
    manoeuvre_error,
    tap_table,
    time_taylor,
    uncompress,
    uncompressed,
)
from sculler_model.algorithms.pairs import (
    Elimination,
    manoeuvre_terms,
    pair_coefficients,
    true_term,
)
from sculler_model.algorithms.time_taylor import polynomial_fit
from sculler_model.analysis.closed_form import leading_term
from sculler_model.errors import InputError

Q = Fraction
Polynomial = list[Fraction]  # coefficients of t^0, t^1, ...


def times(a: Polynomial, b: Polynomial) -> Polynomial:
    product = [Q(0)] * (len(a) + len(b) - 1)
    for i, x in enumerate(a):
        for j, y in enumerate(b):
            product[i + j] += x * y
    return product


def primitive(a: Polynomial) -> Polynomial:
    return [Q(0), *(c / (k + 1) for k, c in enumerate(a))]


def at(a: Polynomial, t: Fraction) -> Fraction:
    return sum((c * t**k for k, c in enumerate(a)), Q(0))


def true_coning(x: Polynomial, y: Polynomial, start: int, stop: int) -> Fraction:
    """z of ½ ∫ α × ω for ω = (x, y, 0) over start..stop."""
    angle_x, angle_y = primitive(x), primitive(y)
    angle_x[0] -= at(angle_x, Q(start))
    angle_y[0] -= at(angle_y, Q(start))
    rate = [p - q for p, q in zip(times(angle_x, y), times(angle_y, x), strict=True)]
    whole = primitive(rate)
    return (at(whole, Q(stop)) - at(whole, Q(start))) / 2


def computed_coning(table: TapTable, x: Polynomial, y: Polynomial, start: int) -> Fraction:
    """What section 3 of the design page makes of it, sample t covering t-1..t."""

    def increments(rate: Polynomial) -> dict[int, Fraction]:
        angle = primitive(rate)
        edges = range(start - table.reach - 1, start + table.samples + 1)
        return {t: at(angle, Q(t)) - at(angle, Q(before)) for before, t in pairwise(edges)}

    sx, sy = increments(x), increments(y)
    total = Q(0)
    for k, row in enumerate(table.taps, start=1):
        t = start + k
        A = [sum((c * s[t - d] for d, c in enumerate(row, start=1)), Q(0)) for s in (sx, sy)]
        total += A[0] * sy[t] - A[1] * sx[t]
    return total / table.denominator


def monomial(power: int, middle: Fraction | int = 0) -> Polynomial:
    """(t - middle)^power."""
    result = [Q(1)]
    for _ in range(power):
        result = times(result, [Q(-middle), Q(1)])
    return result


def error(table: TapTable, a: int, b: int) -> Fraction:
    """Computed minus true for ω = (τ^a, τ^b, 0), τ from the middle of the interval at 7."""
    middle = 7 + Q(table.samples, 2)
    x, y = monomial(a, middle), monomial(b, middle)
    return computed_coning(table, x, y, 7) - true_coning(x, y, 7, 7 + table.samples)


def matrix(table: TapTable) -> dict[str, str]:
    return {f"{i}{j}": str(c) for (i, j), c in sorted(pair_coefficients(table).items())}


def test_published_time_taylor() -> None:
    """Savage-20 method 1, n = 2 and 3; Savage-98 Eq. 61's recursion."""
    assert matrix(time_taylor(2, 0)) == {"12": "2/3"}
    assert matrix(time_taylor(3, 0)) == {"12": "57/80", "13": "33/80", "23": "57/80"}
    assert matrix(time_taylor(1, 1)) == {"01": "1/12"}


def test_published_uncompressed() -> None:
    """Song's tables (Savage-20 method 4)."""
    assert matrix(uncompressed(3, 0)) == {"12": "27/40", "13": "9/20", "23": "27/40"}
    assert matrix(uncompressed(4, 0)) == {
        "12": "232/315",
        "13": "46/105",
        "14": "18/35",
        "23": "178/315",
        "24": "46/105",
        "34": "232/315",
    }


@pytest.mark.parametrize(
    ("n", "p"), [(2, 0), (3, 0), (4, 0), (5, 0), (8, 0), (16, 0), (1, 1), (2, 1), (5, 1)]
)
def test_time_taylor_is_exact_for_polynomials_through_its_samples(n: int, p: int) -> None:
    degree = n + p - 1
    x = [Q(3 + k, 1 + k * k) for k in range(degree + 1)]
    y = [Q((-1) ** k * (2 * k + 5), k + 2) for k in range(degree + 1)]
    start = 3
    table = time_taylor(n, p)
    assert computed_coning(table, x, y, start) == true_coning(x, y, start, start + n)
    higher = monomial(degree + 1)
    assert computed_coning(table, x, higher, start) != true_coning(x, higher, start, start + n)


@pytest.mark.parametrize(("n", "p"), [(2, 2), (3, 2), (3, 3), (4, 2), (5, 5)])
def test_folding_keeps_the_orders_of_the_fit(n: int, p: int) -> None:
    """What is lost with the previous interval's own pairs lies at or above the fit's own error."""
    table, order = time_taylor(n, p), n + p
    terms = [(a, b) for b in range(1, order + 1) for a in range(b) if a + b <= order]
    wrong = [term for term in terms if error(table, *term)]
    assert all(sum(term) == order for term in wrong)
    assert (0, order) in wrong
    fitted = polynomial_fit(n, p)
    of_fit = [sum((c for (i, j), c in fitted.items() if j - i == d), Q(0)) for d in range(1, order)]
    compressed = TapTable.from_rationals([*[[]] * (n - 1), of_fit], [Q(1)] * n)
    mine, fits = leading_term(table), leading_term(compressed)
    assert mine.power == fits.power
    assert mine.coefficient == pytest.approx(fits.coefficient, rel=0.03)


def test_booking_pairs_an_interval_earlier_would_err_at_the_lowest_order() -> None:
    """Why the previous interval's pairs are not simply put where they can be formed."""
    n, p = 2, 2
    booked: dict[tuple[int, int], Fraction] = {}
    for (i, j), c in polynomial_fit(n, p).items():
        place = (i, j) if j >= 1 else (i + n, j + n)
        booked[place] = booked.get(place, Q(0)) + c
    table = tap_table(n, booked)
    assert error(table, 0, 1) == 0  # a constant ω × dω/dt is the same wherever it is booked
    assert error(table, 0, 2) != 0
    assert error(time_taylor(n, p), 0, 2) == error(time_taylor(n, p), 1, 2) == 0


@pytest.mark.parametrize(
    ("n", "p"), [(2, 0), (3, 0), (4, 0), (5, 0), (6, 0), (2, 1), (3, 1), (2, 2), (4, 3), (1, 1)]
)
def test_uncompressed_keeps_coning_and_improves_manoeuvres(n: int, p: int) -> None:
    compressed = frequency_taylor(n, p)
    made = uncompress(distance_sums(compressed), n, p)
    assert made.table == uncompressed(n, p)
    assert distance_sums(made.table) == distance_sums(compressed)
    before, _ = first_manoeuvre_error(compressed)
    assert made.order > before or len(pair_coefficients(made.table)) == 1
    # what it says of itself, by integrals that know nothing of the family
    for a, b in made.vanishing:
        assert error(made.table, a, b) == 0
    assert {term: error(made.table, *term) for term in made.left} == made.left
    assert all(a + b == made.order for a, b in made.left)
    if p == 0:  # time reversed, the true integral changes its sign, and so does this
        c = pair_coefficients(made.table)
        assert all(c[i, j] == c[n + 1 - j, n + 1 - i] for i, j in c)


def test_uncompressed_leaves_what_the_report_of_four_samples_says() -> None:
    made = uncompress(distance_sums(frequency_taylor(4, 0)), 4, 0)
    assert made.order == 5
    assert set(made.left) == {(0, 5), (1, 4), (2, 3)}
    assert set(made.vanishing) == {(0, 1), (0, 2), (0, 3), (1, 2), (0, 4), (1, 3)}


@pytest.mark.parametrize("table", [frequency_taylor(4, 0), time_taylor(3, 2), uncompressed(3, 1)])
def test_manoeuvre_error_is_the_difference_of_the_integrals(table: TapTable) -> None:
    for a, b in [(0, 1), (0, 2), (1, 2), (0, 4), (2, 5)]:
        assert manoeuvre_error(table, (a, b)) == error(table, a, b)


@pytest.mark.parametrize("n", [1, 2, 5])
def test_true_terms_behind_a_filter_by_hand(n: int) -> None:
    """½ Σ (-1)^k e_k ∫ (D^(2k-1) x) × x, with 1/|F|² = 1 + e₁λ² + e₂λ⁴, x = g_a τ^a + g_b τ^b.

    D x × x of 1 and τ³ is -3τ², D³ x × x of them -6, of τ and τ⁴ -24 τ²; ∫ τ² is n³/12.
    """
    e1, e2 = Q(3, 7), Q(5, 11)
    for (a, b), more in {
        (0, 1): Q(n, 2) * e1,
        (1, 2): Q(n**3, 24) * e1,
        (0, 3): Q(n**3, 8) * e1 - 3 * n * e2,
        (1, 4): Q(3 * n**5, 160) * e1 - n**3 * e2,
        (0, 2): Q(0),
    }.items():
        x, y = monomial(a, Q(n, 2)), monomial(b, Q(n, 2))
        plain = true_coning(x, y, 0, n)
        assert true_term(n, (a, b)) == plain
        assert true_term(n, (a, b), [Q(1)]) == plain
        assert true_term(n, (a, b), [Q(1), e1, e2]) == plain + more


def test_terms_in_their_order() -> None:
    assert list(manoeuvre_terms(3)) == [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)]
    assert list(islice(manoeuvre_terms(), 5)) == [(0, 1), (0, 2), (0, 3), (1, 2), (0, 4)]


def test_compressed_table_errs_at_second_order_in_manoeuvres() -> None:
    assert first_manoeuvre_error(frequency_taylor(4, 0))[0] == 2


class TestElimination:
    def test_takes_equations_in_order(self) -> None:
        system = Elimination(2)
        assert system.add([Q(1), Q(1)], Q(3))
        assert not system.add([Q(2), Q(2)], Q(6))  # implied
        assert not system.add([Q(1), Q(1)], Q(5))  # contradicted: the first one stands
        assert system.free == 1
        assert system.add([Q(0), Q(1, 3)], Q(1, 2))
        assert system.solution() == [Q(3, 2), Q(3, 2)]

    def test_free_unknowns_are_no_solution(self) -> None:
        with pytest.raises(ValueError, match="1 unknowns are free"):
            Elimination(1).solution()


@pytest.mark.parametrize(
    ("make", "arguments", "message"),
    [
        (time_taylor, (1, 0), "give samples + history >= 2"),
        (uncompressed, (1, 0), "give samples + history >= 2"),
        (time_taylor, (12, 5), "17 is too large for time-taylor with history >= 2"),
        (uncompressed, (16, 1), "17 is too large for uncompressed, give a sum up to 16"),
        (uncompress, ([Q(1)], 3, 0), "1 distance sums for samples + history = 3, give 2"),
        (uncompress, ([Q(1)], 16, 0), "1 distance sums for samples + history = 16, give 15"),
    ],
)
def test_faults(make: object, arguments: Sequence[object], message: str) -> None:
    assert callable(make)
    with pytest.raises(InputError) as caught:
        make(*arguments)
    assert message in str(caught.value)


def test_sixteen_points_are_the_most() -> None:
    for table in (time_taylor(14, 2), uncompressed(16, 0)):
        assert table.history == 15


def test_a_pair_of_the_previous_interval_has_no_row() -> None:
    with pytest.raises(ValueError, match="pair -1, 0 has no row"):
        tap_table(2, {(-1, 0): Q(1)})
