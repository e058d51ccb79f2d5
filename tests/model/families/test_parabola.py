"""One sample an interval, three of them known: the parabola after Savage-98 Eq. 61; any history."""

from __future__ import annotations

import random
from fractions import Fraction
from typing import Any

import pytest

from sculler_model.algorithms import TapTable, frequency_taylor, time_taylor
from sculler_model.algorithms.pairs import first_manoeuvre_error, manoeuvre_error
from sculler_model.algorithms.time_taylor import polynomial_fit
from sculler_model.analysis.closed_form import LeadingTerm, leading_term

F = Fraction
Vector = tuple[Any, ...]
PARABOLA = time_taylor(1, 2)
"""As a core forms it: products with the present sample alone."""
PRINTED = TapTable.from_integers(1, 720, [122, -31])
"""The three products of the paper, the past one booked where its later sample was the present."""


def cross(a: Vector, b: Vector) -> Vector:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def plus(*vectors: Vector) -> Vector:
    return tuple(sum(each, F(0)) for each in zip(*vectors, strict=True))


def times(c: Fraction, a: Vector) -> Vector:
    return (c * a[0], c * a[1], c * a[2])


def test_the_three_products_of_a_parabola() -> None:
    """½ ∫ α × ω of ω = a + bt + ct² over 0..1, of its integrals over -2..-1, -1..0 and 0..1."""
    rng = random.Random(1)
    fit = polynomial_fit(1, 2)
    assert fit == {(0, 1): F(121, 720), (-1, 1): F(-31, 720), (-1, 0): F(1, 720)}
    for _ in range(5):
        a, b, c = (tuple(F(rng.randint(-9, 9)) for _ in range(3)) for _ in range(3))
        s = {
            i: plus(
                times(F(1), a),
                times(F(i * i - (i - 1) ** 2, 2), b),
                times(F(i**3 - (i - 1) ** 3, 3), c),
            )
            for i in (-1, 0, 1)
        }
        # α = at + bt²/2 + ct³/3: a×b (1/3 - 1/6)/2, a×c (1/4 - 1/12)/2, b×c (1/10 - 1/15)/2
        true = plus(
            times(F(1, 12), cross(a, b)),
            times(F(1, 12), cross(a, c)),
            times(F(1, 60), cross(b, c)),
        )
        assert plus(*(times(k, cross(s[i], s[j])) for (i, j), k in fit.items())) == true


def test_what_a_core_makes_of_it() -> None:
    """Its own products make two of the three terms exact; b × c and coning are left as said."""
    assert TapTable.from_integers(1, 24, [4, -1]) == PARABOLA
    assert first_manoeuvre_error(PARABOLA) == (3, {(0, 3): F(-19, 120), (1, 2): F(-1, 360)})
    assert first_manoeuvre_error(PARABOLA, highest_order=3)[0] == 3
    with pytest.raises(ValueError, match="no manoeuvre term is left up to order 2"):
        first_manoeuvre_error(PARABOLA, highest_order=2)
    assert leading_term(PARABOLA) == LeadingTerm(F(1, 40), 5)
    # straight lines (Eq. 61) err at the parabola, and leave less of coning
    lines = time_taylor(1, 1)
    assert lines == TapTable.from_integers(1, 12, [1])
    assert manoeuvre_error(lines, (0, 2)) == F(-1, 12)
    assert leading_term(lines) == LeadingTerm(F(-1, 60), 5)


def test_the_printed_products_booked_are_the_same_over_a_record_but_for_its_ends() -> None:
    rng = random.Random(2)
    s = [tuple(F(rng.randint(-99, 99)) for _ in range(3)) for _ in range(40)]
    none: Vector = (F(0), F(0), F(0))
    fit = polynomial_fit(1, 2)
    printed = booked = none
    for t in range(2, len(s)):
        pairs = {(0, 1): (s[t - 1], s[t]), (-1, 1): (s[t - 2], s[t]), (-1, 0): (s[t - 2], s[t - 1])}
        printed = plus(printed, *(times(fit[k], cross(*v)) for k, v in pairs.items()))
        for d, tap in enumerate(PRINTED.taps[0], start=1):
            booked = plus(booked, times(F(tap, PRINTED.denominator), cross(s[t - d], s[t])))
    ends = plus(cross(s[-2], s[-1]), times(F(-1), cross(s[0], s[1])))
    assert booked == plus(printed, times(fit[(-1, 0)], ends))
    assert leading_term(PRINTED) == LeadingTerm(F(19, 720), 5)


@pytest.mark.parametrize("points", range(2, 9))
def test_a_closed_form_knows_n_and_p_by_their_sum_alone(points: int) -> None:
    """Per sample, whatever the split, p > n too (Yang's "any combinations of n and p")."""
    left = {
        (term.power, term.coefficient / n)
        for n in range(1, points + 1)
        for term in [leading_term(frequency_taylor(n, points - n))]
    }
    assert len(left) == 1
