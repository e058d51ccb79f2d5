"""The exact third-order accumulators, against the page in rationals and against truth."""

from __future__ import annotations

from fractions import Fraction
from math import radians

import numpy as np
import pytest

from host_path import fine_design
from sculler_model.algorithms import cross
from sculler_model.analysis.third_order import third_order_vectors, third_order_words
from sculler_model.analysis.triple import ConingTurn, left
from sculler_model.design import Design
from sculler_model.frames import from_rotation_vector, product
from sculler_model.golden import GoldenModel

FVec = tuple[Fraction, ...]


def rational_cross(a: FVec, b: FVec) -> FVec:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def plus(*terms: tuple[Fraction, FVec]) -> FVec:
    return tuple(sum((c * v[i] for c, v in terms), Fraction(0)) for i in range(3))


def page(design: Design, counts: np.ndarray) -> list[FVec]:
    """Composition to third order, in rationals of counts, from the plain golden model's minors."""
    data = design.as_json()
    data["algorithm"]["minors"] = 1
    model, table = GoldenModel(Design.parse(data)), design.table
    samples = ((tuple(row[:3]), tuple(row[3:]), 0) for row in counts.tolist())
    gammas, one, half, twelfth = [], Fraction(1), Fraction(1, 2), Fraction(1, 12)
    zero: FVec = (Fraction(0),) * 3
    for number, minor in enumerate(model.run(samples)):  # type: ignore[arg-type]
        if number % design.algorithm.minors == 0:
            alpha = beta = gamma = zero
        theta = tuple(Fraction(x, table.sum_denominator) for x in minor.alpha)
        delta = tuple(Fraction(x, table.denominator) for x in minor.coning_within)
        turned = rational_cross(alpha, theta)
        gamma = plus(
            (one, gamma),
            (half, rational_cross(beta, theta)),
            (half, rational_cross(alpha, delta)),
            (twelfth, rational_cross(alpha, turned)),
            (-twelfth, rational_cross(theta, turned)),
        )
        beta = plus((one, beta), (half, turned), (one, delta))
        alpha = plus((one, alpha), (one, theta))
        if number % design.algorithm.minors == design.algorithm.minors - 1:
            gammas.append(gamma)
    return gammas


@pytest.mark.parametrize(
    ("samples", "history", "minors", "kind"),
    [(2, 0, 3, "increment"), (3, 1, 2, "increment"), (2, 0, 4, "rate"), (4, 0, 1, "increment")],
)
def test_accumulators_are_the_page_exactly(
    samples: int, history: int, minors: int, kind: str
) -> None:
    design = fine_design(samples, history, minors, kind=kind)
    counts = np.random.default_rng(4).integers(-(2**31), 2**31, (3 * samples * minors, 6))
    found, table = third_order_vectors(design, counts), design.table
    for row, expected in enumerate(page(design, counts)):
        for axis in range(3):
            gamma = Fraction(found.within[row, axis], 2 * table.denominator * table.sum_denominator)
            gamma += Fraction(found.between[row, axis], 12 * table.sum_denominator**3)
            assert gamma == expected[axis]


def test_words_hold_the_worst() -> None:
    design = fine_design(4, 0, 3)
    words = third_order_words(design)
    extremes = np.random.default_rng(5).choice([-(2**31), 2**31 - 1], (12 * 200, 6))
    found = third_order_vectors(design, extremes)
    for name, values in (("third_within", found.within), ("third_between", found.between)):
        assert all(int(v) in words[name] for v in values.ravel())
        largest = max(abs(int(v)) for v in values.ravel())
        assert largest.bit_length() > words[name].bits - 8  # and not absurdly wide


def test_they_see_vibration_in_a_turn_that_the_host_cannot() -> None:
    """6 °/s with 0.1° coning at 50 Hz, 10 ms intervals: a hundredth of the drift is left."""
    motion = ConingTurn(radians(0.1), 50.0, radians(6.0), radians(30.0))
    (found,) = left(fine_design(4, 0, 5, rate=2000.0), motion, [5], 4.0)
    assert found.integers < found.second_order / 100
    assert found.integers < found.host / 10


def test_each_of_several_minors_is_as_it_is_alone() -> None:
    """A run of 0.0998 s: 49 whole major intervals of 4 samples, 24 of 8, 7 of 28."""
    motion, design = ConingTurn(radians(1), 50.0, radians(6.0)), fine_design(4, 1, rate=2000.0)
    together = list(left(design, motion, [1, 7, 2], 0.0998))
    assert [found.minors for found in together] == [1, 7, 2]
    for found in together:
        (alone,) = left(design, motion, [found.minors], 0.0998)
        for name in ("second_order", "host", "integers"):
            assert getattr(found, name) == pytest.approx(getattr(alone, name), rel=1e-4)


def test_composition_of_two_rotations() -> None:
    """Two minor intervals of plain turning: φ of the product, to the fourth power of the angle."""
    left = []
    for size in (0.2, 0.1):
        theta = size * np.array([[0.6, -0.3, 0.7], [-0.2, 0.9, 0.4]])
        a, b = map(tuple, theta.tolist())
        w, x, y, z = product(from_rotation_vector(a), from_rotation_vector(b))
        true = np.array([x, y, z]) * 2 * np.arccos(w) / np.sqrt(1 - w * w)
        turned = np.array(cross(a, b))
        third = (np.cross(theta[0], turned) - np.cross(theta[1], turned)) / 12
        left.append(np.linalg.norm(true - theta.sum(axis=0) - 0.5 * turned - third))
    assert left[0] / left[1] == pytest.approx(16, rel=0.1)
