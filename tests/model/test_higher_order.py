"""Third and fourth order, against series of matrices in rationals and against polynomials.

Nothing here is taken from the code under test but the weights of triples.  A rigid motion is a 4×4
matrix; its growing orders are the powers of a formal ε, and a series of matrices in ε is a list of
Fractions.  Exponentials are multiplied and the logarithm of the product is taken, as series.
"""

from __future__ import annotations

from dataclasses import FrozenInstanceError
from fractions import Fraction
from math import factorial
from typing import Any

import numpy as np
import pytest

from higher_order_designs import HIGHER_ORDER, higher
from sculler_model.algorithms import (
    DUAL_ZERO,
    Dual,
    HigherOrder,
    composition,
    dual_cross,
    dual_sum,
    dual_times,
    triple_taps,
)
from sculler_model.algorithms.pairs import pair_coefficients
from sculler_model.algorithms.triples import CONING, CONING_IN_A_TURN
from sculler_model.design import ZERO_RANGE, Design, Interval, Result, word_lengths
from sculler_model.errors import InputError
from sculler_model.fast import run_fast
from sculler_model.golden import GoldenModel
from sculler_model.host import next_orders
from strategies import random_counts
from tiers import few_of

Matrix = list[list[Fraction]]
Series = list[Matrix]
"""Matrices of ε⁰, ε¹, ... ε⁴."""
Three = tuple[Fraction, ...]

MOST = 4


def zeros() -> Matrix:
    return [[Fraction(0)] * 4 for _ in range(4)]


def plus(a: Matrix, b: Matrix, factor: Fraction = Fraction(1)) -> Matrix:
    return [[x + factor * y for x, y in zip(p, q, strict=True)] for p, q in zip(a, b, strict=True)]


def matrix_product(a: Matrix, b: Matrix) -> Matrix:
    return [
        [sum((a[i][k] * b[k][j] for k in range(4)), Fraction(0)) for j in range(4)]
        for i in range(4)
    ]


def times(a: Series, b: Series) -> Series:
    found = [zeros() for _ in range(MOST + 1)]
    for i in range(MOST + 1):
        for j in range(MOST + 1 - i):
            found[i + j] = plus(found[i + j], matrix_product(a[i], b[j]))
    return found


def unit() -> Series:
    one = [[Fraction(int(i == j)) for j in range(4)] for i in range(4)]
    return [one, *[zeros() for _ in range(MOST)]]


def exponential(x: Series) -> Series:
    total, power = unit(), unit()
    for n in range(1, MOST + 1):
        power = times(power, x)
        total = [plus(t, p, Fraction(1, factorial(n))) for t, p in zip(total, power, strict=True)]
    return total


def logarithm(x: Series) -> Series:
    """Of a series that begins with the unit matrix."""
    rest = [zeros(), *x[1:]]
    total, power = [zeros() for _ in range(MOST + 1)], unit()
    for n in range(1, MOST + 1):
        power = times(power, rest)
        sign = Fraction((-1) ** (n + 1), n)
        total = [plus(t, p, sign) for t, p in zip(total, power, strict=True)]
    return total


def rigid(angle: Three, velocity: Three) -> Matrix:
    """The generator of a rotation and a velocity."""
    x, y, z = angle
    o = Fraction(0)
    return [
        [o, -z, y, velocity[0]],
        [z, o, -x, velocity[1]],
        [-y, x, o, velocity[2]],
        [o, o, o, o],
    ]


def parts(a: Matrix) -> tuple[Three, Three]:
    """Angle and velocity of a generator."""
    return (a[2][1], a[0][2], a[1][0]), (a[0][3], a[1][3], a[2][3])


def bracket(a: Matrix, b: Matrix) -> Matrix:
    return plus(matrix_product(a, b), matrix_product(b, a), Fraction(-1))


def minor_generator(design: Design, rows: list[tuple[int, ...]], end: int) -> Series:
    """Orders 1..4 of the minor interval that ends with row `end`, by brackets of matrices."""
    n, taps = design.table.samples, triple_taps(design.table.samples)

    def sample(number: int) -> Matrix:
        """Of number 1..n in the interval, 0 and below before it."""
        row = end - n + number
        counts = rows[row] if row >= 0 else (0,) * 6
        whole = [Fraction(c) for c in counts]
        return rigid(tuple(whole[:3]), tuple(whole[3:]))

    def weighted(weights: tuple[int, ...], over: int) -> Matrix:
        total = zeros()
        for d, weight in enumerate(weights):
            total = plus(total, sample(n - d), Fraction(weight, over))
        return total

    theta = weighted((1,) * n, 1)
    kappa = zeros()
    for (i, j), c in pair_coefficients(design.table).items():
        kappa = plus(kappa, bracket(sample(i), sample(j)), c)
    m, c = (weighted(w, taps.third_denominator) for w in (taps.partner, taps.curvature))
    slope, f = weighted(taps.slope, 1), weighted(taps.fourth, taps.fourth_denominator)
    tau = plus(bracket(theta, bracket(theta, c)), bracket(slope, bracket(theta, m)))
    sigma = bracket(theta, bracket(theta, bracket(theta, f)))
    return [zeros(), theta, kappa, tau, sigma]


def composed(design: Design, rows: list[tuple[int, ...]], major: int) -> Series:
    """Orders of a whole major interval: the logarithm of the product of the minors' motions."""
    n, motion = design.table.samples, unit()
    for minor in range(design.algorithm.minors):
        end = major * design.samples_per_major + (minor + 1) * n - 1
        motion = times(motion, exponential(minor_generator(design, rows, end)))
    return logarithm(motion)


def golden(design: Design, rows: list[tuple[int, ...]]) -> list[Result]:
    return list(GoldenModel(design).run((row[:3], row[3:], 0) for row in rows))  # type: ignore[misc]


@pytest.mark.parametrize("name", few_of(list(HIGHER_ORDER), ["one_sample", "fourth_order"]))
def test_every_order_is_the_logarithm_of_the_product(name: str) -> None:
    design = HIGHER_ORDER[name]
    counts = random_counts(design, 2 * design.samples_per_major, np.random.default_rng(5))
    rows = [tuple(row) for row in counts.tolist()]
    c, table = design.composition, design.table
    for result in golden(design, rows):
        expected = [parts(each) for each in composed(design, rows, result.major)[1:]]
        found = [(result.alpha, result.nu)]
        second = [
            tuple(
                Fraction(w, table.denominator) + Fraction(b, 2)
                for w, b in zip(within, between, strict=True)
            )
            for within, between in (
                (result.coning_within, result.coning_between),
                (result.sculling_within, result.sculling_between),
            )
        ]
        assert found[0] == expected[0]
        assert tuple(second) == expected[1]
        for order, denominator in ((3, c.third), (4, c.fourth))[: design.order - 2]:
            name_of = {3: "third", 4: "fourth"}[order]
            for kind, true in zip(("coning", "sculling"), expected[order - 1], strict=True):
                numerators = getattr(result, f"{kind}_{name_of}")
                assert tuple(Fraction(x, denominator) for x in numerators) == true


# --- the weights inside a minor interval


def polynomial_orders(rates: list[list[Fraction]], size: Fraction, most: int = MOST) -> list[Three]:
    """Orders 1, 2, ... of the rotation vector of a polynomial rate over -size/2..size/2 (Bortz).

    Args:
        rates: of each axis, coefficients of t⁰, t¹, ...
        size: of the interval.
        most: the highest order, up to 6.
    """

    def product(a: list[Fraction], b: list[Fraction]) -> list[Fraction]:
        found = [Fraction(0)] * (len(a) + len(b) - 1)
        for i, x in enumerate(a):
            for j, y in enumerate(b):
                found[i + j] += x * y
        return found

    def added(*terms: tuple[Fraction, list[Fraction]]) -> list[Fraction]:
        found = [Fraction(0)] * max(len(term) for _, term in terms)
        for factor, term in terms:
            for i, x in enumerate(term):
                found[i] += factor * x
        return found

    def crossed(a: list[list[Fraction]], b: list[list[Fraction]]) -> list[list[Fraction]]:
        one = Fraction(1)
        return [
            added((one, product(a[i - 2], b[i - 1])), (-one, product(a[i - 1], b[i - 2])))
            for i in range(3)
        ]

    def scaled(*terms: tuple[Fraction, list[list[Fraction]]]) -> list[list[Fraction]]:
        return [added(*((f, t[axis]) for f, t in terms)) for axis in range(3)]

    def integral(rate: list[list[Fraction]]) -> list[list[Fraction]]:
        found = []
        for axis in rate:
            power = [Fraction(0), *(x / (i + 1) for i, x in enumerate(axis))]
            power[0] = -sum((x * (-size / 2) ** i for i, x in enumerate(power)), Fraction(0))
            found.append(power)
        return found

    # nested[j][k]: the part of degree k of φ×(φ×... ω), j products
    factors = {0: Fraction(1), 1: Fraction(1, 2), 2: Fraction(1, 12), 4: Fraction(-1, 720)}
    nested = [{1: rates}, *({} for _ in range(most))]
    orders = {1: integral(rates)}
    for degree in range(2, most + 1):
        for j in range(1, degree):
            products = [
                (Fraction(1), crossed(orders[i], nested[j - 1][degree - i]))
                for i in range(1, degree)
                if degree - i in nested[j - 1]
            ]
            if products:
                nested[j][degree] = scaled(*products)
        rate = [(f, nested[j][degree]) for j, f in factors.items() if degree in nested[j]]
        orders[degree] = integral(scaled(*rate))
    return [
        tuple(
            sum((x * (size / 2) ** i for i, x in enumerate(axis)), Fraction(0))
            for axis in orders[degree]
        )
        for degree in range(1, most + 1)
    ]


def inside(samples: int, rates: list[list[Fraction]], size: Fraction) -> tuple[Three, Three]:
    """τ and ς of the samples of a polynomial rate."""
    taps, n = triple_taps(samples), samples
    increments = []
    for i in range(n):
        start, stop = (size * (Fraction(edge, n) - Fraction(1, 2)) for edge in (i, i + 1))
        increments.append(
            rigid(
                tuple(
                    sum(
                        (
                            x * (stop ** (p + 1) - start ** (p + 1)) / (p + 1)
                            for p, x in enumerate(axis)
                        ),
                        Fraction(0),
                    )
                    for axis in rates
                ),
                (Fraction(0),) * 3,
            )
        )

    def weighted(weights: tuple[int, ...], over: int) -> Matrix:
        total = zeros()
        for increment, weight in zip(reversed(increments), weights, strict=True):
            total = plus(total, increment, Fraction(weight, over))
        return total

    theta, slope = weighted((1,) * n, 1), weighted(taps.slope, 1)
    m, c = (weighted(w, taps.third_denominator) for w in (taps.partner, taps.curvature))
    f = weighted(taps.fourth, taps.fourth_denominator)
    tau = plus(bracket(theta, bracket(theta, c)), bracket(slope, bracket(theta, m)))
    sigma = bracket(theta, bracket(theta, bracket(theta, f)))
    return parts(tau)[0], parts(sigma)[0]


@pytest.mark.parametrize("samples", [3, 4, 7])
def test_triples_leave_nothing_of_the_fifth_power(samples: int) -> None:
    """A rate of any three powers: what is left falls with the seventh power of the interval."""
    rates = [[Fraction(x) for x in axis] for axis in ((3, -1, 4), (1, 5, -9), (-2, 6, 5))]
    left = []
    for size in (Fraction(1, 1000), Fraction(1, 2000)):
        true = polynomial_orders(rates, size)
        found = inside(samples, rates, size)
        left.append(
            [
                max(abs(a - b) for a, b in zip(one, other, strict=True))
                for one, other in zip(found, true[2:], strict=True)
            ]
        )
        # the terms themselves are of the fifth power
        assert all(max(map(abs, order)) > size**5 / 100 for order in true[2:])
    for coarse, fine in zip(*left, strict=True):
        assert 120 < coarse / fine < 136 or coarse == 0


def test_two_samples_leave_the_curvature_alone() -> None:
    rates = [[Fraction(x) for x in axis] for axis in ((3, -1), (1, 5), (-2, 6))]
    size = Fraction(1, 1000)
    true = polynomial_orders(rates, size)
    for found, expected in zip(inside(2, rates, size), true[2:], strict=True):
        assert max(abs(a - b) for a, b in zip(found, expected, strict=True)) < 50 * size**7


def circle(turn: int, powers: int) -> list[list[Fraction]]:
    """The rate (cos t, sin t, turn) as a polynomial."""
    cosine = [
        Fraction((-1) ** (k // 2), factorial(k)) if k % 2 == 0 else Fraction(0)
        for k in range(powers)
    ]
    sine = [
        Fraction((-1) ** (k // 2), factorial(k)) if k % 2 else Fraction(0) for k in range(powers)
    ]
    return [cosine, sine, [Fraction(turn)]]


def test_series_of_coning_are_the_true_ones() -> None:
    """τ_z/T³ and ς_z/T⁴ of coning, from integrals of two sizes, against the constants."""
    sizes = [Fraction(1, 100), Fraction(1, 200)]
    thirds = [polynomial_orders(circle(1, 12), size)[2][2] / size**3 for size in sizes]
    fourths = [polynomial_orders(circle(0, 12), size)[3][2] / size**4 for size in sizes]
    for values, first, power, second in (
        (thirds, Fraction(-1, 180), 2, CONING_IN_A_TURN),
        (fourths, Fraction(1, 720), 1, CONING),
    ):
        for value, size in zip(values, sizes, strict=True):
            rest = (value - first * size**power) / size ** (power + 2)
            assert abs(rest / second - 1) < size**2


@pytest.mark.parametrize("samples", few_of([4, 6], [4]))
def test_triples_match_the_frequency_of_coning(samples: int) -> None:
    """From four samples on the mean drift of coning is right two powers further."""
    for turn, order, power in ((1, 0, 9), (0, 1, 9)):
        left = []
        for size in (Fraction(1, 50), Fraction(1, 100)):
            rates = circle(turn, 14)
            true = polynomial_orders(rates, size)[2 + order][2]
            left.append(abs(inside(samples, rates, size)[order][2] - true))
        assert 0.98 * 2**power < left[0] / left[1] < 1.02 * 2**power


def test_next_orders_are_what_follows() -> None:
    """δ after γ, ε + ζ after δ: all terms of T⁵, and of T⁷, of a rate of any three powers."""
    rates = [[Fraction(x, 4) for x in axis] for axis in ((3, -1, 4), (1, 5, -9), (-2, 6, 5))]
    left: dict[int, list[float]] = {3: [], 4: []}
    for size in (Fraction(1, 256), Fraction(1, 512)):
        orders = polynomial_orders(rates, size, 6)
        known = [(np.array([order], float), np.zeros((1, 3))) for order in orders]
        after = {3: orders[3], 4: [a + b for a, b in zip(orders[4], orders[5], strict=True)]}
        for given, true in after.items():
            found, _ = next_orders(known[:given])
            left[given].append(float(np.abs(found - np.array([true], float)).max()))
    assert left[3][0] / left[3][1] == pytest.approx(2**7, rel=0.02)
    assert left[4][0] / left[4][1] == pytest.approx(2**9, rel=0.02)


def test_next_orders_of_velocity_are_those_of_the_angle_turned_once() -> None:
    """The velocity of a dual vector is its angle's derivative along the velocities."""
    rng = np.random.default_rng(3)
    angles, velocities = rng.normal(size=(4, 1, 3)), rng.normal(size=(4, 1, 3))
    step = 1e-6
    for given in (3, 4):
        ends = []
        for way in (step, -step):
            moved = zip(angles + way * velocities, velocities, strict=True)
            ends.append(next_orders([*moved][:given])[0])
        _, found = next_orders([*zip(angles, velocities, strict=True)][:given])
        np.testing.assert_allclose(found, (ends[0] - ends[1]) / (2 * step), rtol=1e-7)


# --- models and word lengths


@pytest.mark.parametrize("name", few_of(list(HIGHER_ORDER), ["two_samples", "fourth_order"]))
def test_fast_model_has_the_same_integers(name: str) -> None:
    design = HIGHER_ORDER[name]
    counts = random_counts(design, 3 * design.samples_per_major, np.random.default_rng(6))
    expected = [result.row() for result in golden(design, [tuple(r) for r in counts.tolist()])]
    assert [*run_fast(design, counts).rows()] == expected


@pytest.mark.parametrize("name", few_of(list(HIGHER_ORDER), ["third_order"]))
def test_no_counts_pass_the_words(name: str) -> None:
    design = HIGHER_ORDER[name]
    words, rng = design.words, np.random.default_rng(7)
    ends = np.array([[each.lo, each.hi] for each in [words.gyro] * 3 + [words.accel] * 3], object)
    choice = rng.integers(0, 2, (40 * design.samples_per_major, 6))
    choice[: design.samples_per_major] = 0
    counts = np.take_along_axis(ends.T, choice, axis=0).astype(np.int64)
    block = run_fast(design, counts)
    for vector in design.vectors:
        allowed = getattr(words, vector)
        for row in block.vector(vector).tolist():
            assert all(component in allowed for component in row)


def test_smallest_words_hold_every_input() -> None:
    """Two bits, one sample, two minor intervals: one in nine of all gyro inputs."""
    design = higher("tiny", 1, 1, 2, (8, 8), 4)
    words = word_lengths(2, 2, 2, design.table, order=4)
    third, fourth = words.coning_third, words.coning_fourth
    assert third is not None
    assert fourth is not None
    seen = []
    for code in range(0, 4**6, 9):
        digits = [(code >> 2 * i & 3) - 2 for i in range(6)]
        rows = [(*digits[:3], 0, 0, 0), (*digits[3:], 0, 0, 0)]
        (result,) = golden(design, rows)
        seen += [*(result.coning_third or ()), *(result.coning_fourth or ())]
        assert all(x in third for x in result.coning_third or ())
        assert all(x in fourth for x in result.coning_fourth or ())
    assert any(seen)


class Range:
    """Every number from lo to hi, in sums and products."""

    def __init__(self, lo: int, hi: int) -> None:
        self.lo, self.hi = lo, hi

    def __add__(self, other: Any) -> Any:
        other = as_range(other)
        return Range(self.lo + other.lo, self.hi + other.hi)

    def __sub__(self, other: Any) -> Any:
        return self + -1 * as_range(other)

    def __mul__(self, other: Any) -> Any:
        ends = [a * b for a in (self.lo, self.hi) for b in vars(as_range(other)).values()]
        return Range(min(ends), max(ends))

    __radd__, __rmul__ = __add__, __mul__


def as_range(value: Any) -> Range:
    return value if isinstance(value, Range) else Range(value, value)


@pytest.mark.parametrize("name", list(HIGHER_ORDER))
def test_words_are_the_models_own_lines_on_ranges(name: str) -> None:
    """`HigherOrder` steps through a major interval with ranges where its numbers are.

    It shares no line with the word lengths.  Letters of fourth order are nothing with third order.
    """
    design, words = HIGHER_ORDER[name], HIGHER_ORDER[name].words
    table, higher = design.table, HigherOrder(design.table, design.order)
    gyro, accel = ((Range(each.lo, each.hi),) * 3 for each in (words.gyro, words.accel))
    sample: Any = Dual(gyro, accel)
    kappa = dual_sum(
        *(dual_cross(dual_sum(*(dual_times(c, sample) for c in row)), sample) for row in table.taps)
    )
    within = between = DUAL_ZERO
    theta = dual_times(table.samples, sample)
    for minor in range(design.algorithm.minors):
        alpha = dual_times(minor, theta)
        higher.step([sample] * table.samples, alpha, within, between, kappa)
        within = dual_sum(within, kappa)
        between = dual_sum(between, dual_cross(alpha, theta))

    def ends(component: Any) -> Interval:
        return Interval(*vars(as_range(component)).values())

    third, fourth = higher.third, higher.fourth
    assert words.coning_third == ends(third.angle[0])
    assert words.sculling_third == ends(third.velocity[0])
    inside = words.higher
    assert inside is not None
    if design.order > 3:
        assert words.coning_fourth == inside.fourth.angle == ends(fourth.angle[0])
        assert words.sculling_fourth == inside.fourth.velocity == ends(fourth.velocity[0])
        return
    assert words.coning_fourth is words.sculling_fourth is None
    letters = "f theta_f theta_theta_f sigma p q g h outer pairs fourth"
    assert {getattr(inside, letter) for letter in letters.split()} == {(ZERO_RANGE, ZERO_RANGE)}


def test_composition_of_the_default_table() -> None:
    """Denominators by hand: 12·105, 23625, and 72·105² and 1260 beside them."""
    c = composition(Design.preset("stim300").table)
    assert (c.within, c.third, c.third_triple, c.third_composed) == (105, 94500, 4, 75)
    assert (c.fourth, c.fourth_outer, c.fourth_pairs) == (7938000, 7, 10)
    with pytest.raises(FrozenInstanceError):  # it is kept, and all of the table's designs share it
        c.within = 1  # type: ignore[misc]


@pytest.mark.parametrize(
    ("sensor", "algorithm", "said"),
    [
        ({}, {"order": 5}, "algorithm.order: 5 is not allowed, give 2, 3 or 4"),
        ({}, {"order": 3, "position": "high-resolution"}, "leave one of them out"),
        ({"kind": "rate"}, {"order": 3, "family": "filtered-rate"}, 'give sensor.kind = "increm'),
        (
            {},
            {
                "order": 4,
                "family": "table",
                "table": {"denominator": 3, "taps": [2, 1, 1], "weights": [1, 1, 2, 1]},
            },
            "needs every sample of a minor interval to count once",
        ),
    ],
)
def test_what_cannot_be_is_said(
    sensor: dict[str, object], algorithm: dict[str, object], said: str
) -> None:
    with pytest.raises(InputError) as fault:
        Design.parse({"preset": "stim300", "sensor": sensor, "algorithm": algorithm})
    assert said in str(fault.value)
    assert "\n" not in str(fault.value)


def test_second_order_is_the_design_without_the_key() -> None:
    plain = Design.preset("stim300")
    assert Design.preset("stim300", order=2).digest == plain.digest
    assert plain.columns == Design.preset("stim300", order=4).columns[:20]
