"""The host's terms beyond second order, term by term, against the equations of motion.

Over an interval from -½ to ½ (T = 1) the rate is ω = α1 + α2 τ + α3 τ² + ..., the force likewise.
Powers of s count what a term is small by: the powers of T, one more with each power of τ, or the
rates in it.  The equations are solved in powers of s and τ, in rationals: for the velocity

    ΔV_SF = ∫f + ∫ω×(∫f) + ∫ω×(∫ω×(∫f)) + ...        each inner integral from there to the end

and for the rotation vector φ' = ω + ½ φ×ω + (1/12 + φ²/720) φ×(φ×ω) + O(φ⁶).
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Sequence
from fractions import Fraction
from math import factorial

import numpy as np
import pytest

from sculler_model.host import (
    rotation_terms,
    third_order_terms,
    velocity_higher_orders,
    velocity_terms,
)

Vector = tuple[Fraction, ...]
Polynomial = dict[tuple[int, int], Vector]
"""Vectors, or scalars as vectors of one, by the powers of s and τ."""

HIGHEST = 6  # power of s
END = Fraction(1, 2)


def cross(a: Vector, b: Vector) -> Vector:
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


def dot(a: Vector, b: Vector) -> Vector:
    return (sum((x * y for x, y in zip(a, b, strict=True)), Fraction(0)),)


def times(a: Vector, b: Vector) -> Vector:
    """A scalar times a vector."""
    return tuple(a[0] * x for x in b)


def product(
    of: Callable[[Vector, Vector], Vector], one: Polynomial, other: Polynomial
) -> Polynomial:
    total: Polynomial = {}
    for (s, t), a in one.items():
        for (u, w), b in other.items():
            if s + u <= HIGHEST:
                added(total, (s + u, t + w), of(a, b))
    return total


def added(total: Polynomial, at: tuple[int, int], vector: Vector) -> None:
    before = total.get(at, (Fraction(0),) * len(vector))
    total[at] = tuple(x + y for x, y in zip(before, vector, strict=True))


def weighted(*pairs: tuple[Fraction | int, Polynomial]) -> Polynomial:
    total: Polynomial = {}
    for factor, polynomial in pairs:
        for at, vector in polynomial.items():
            added(total, at, tuple(factor * x for x in vector))
    return total


def integral(of: Polynomial, start: Fraction) -> Polynomial:
    """From `start` to τ."""
    total: Polynomial = {}
    for (s, t), vector in of.items():
        part = tuple(x / (t + 1) for x in vector)
        added(total, (s, t + 1), part)
        added(total, (s, 0), tuple(-x * start ** (t + 1) for x in part))
    return total


def at(polynomial: Polynomial, place: Fraction) -> dict[int, Vector]:
    """By the power of s."""
    found: dict[int, Vector] = defaultdict(lambda: (Fraction(0),) * 3)
    for (s, t), vector in polynomial.items():
        found[s] = tuple(x + y * place**t for x, y in zip(found[s], vector, strict=True))
    return found


def motion(coefficients: Sequence[Vector]) -> Polynomial:
    """With s for every power of T."""
    return {(k + 1, k): vector for k, vector in enumerate(coefficients)}


def counted(coefficients: Sequence[Vector], s: int) -> Polynomial:
    """With the same power of s for all of it."""
    return {(s, k): vector for k, vector in enumerate(coefficients)}


def random_coefficients(seed: int, count: int) -> list[Vector]:
    rng = np.random.default_rng(seed)
    return [tuple(Fraction(int(x), 8) for x in rng.integers(-9, 10, 3)) for _ in range(count)]


def rotation_beyond_coning(omega: Polynomial) -> dict[int, Vector]:
    """φ - α - ½∫α×ω by the power of s."""
    phi = omega
    for _ in range(HIGHEST):
        once = product(cross, phi, omega)
        twice = product(cross, phi, once)
        fourth = product(times, product(dot, phi, phi), twice)
        slope = weighted(
            (1, omega), (Fraction(1, 2), once), (Fraction(1, 12), twice), (Fraction(1, 720), fourth)
        )
        phi = integral(slope, -END)
    alpha = integral(omega, -END)
    coning = integral(product(cross, alpha, omega), -END)
    return at(weighted((1, phi), (-1, alpha), (Fraction(-1, 2), coning)), END)


def velocity_beyond_sculling(omega: Polynomial, force: Polynomial) -> dict[int, Vector]:
    """ΔV_SF - υ - ΔV_rot - ½∫(α×f + υ×ω) by the power of s."""
    inner = weighted((-1, integral(force, END)))
    total = inner
    for _ in range(HIGHEST):
        inner = weighted((-1, integral(product(cross, omega, inner), END)))
        total = weighted((1, total), (1, inner))
    alpha, upsilon = integral(omega, -END), integral(force, -END)
    both = weighted((1, product(cross, alpha, force)), (1, product(cross, upsilon, omega)))
    sculling = integral(both, -END)
    whole_alpha, whole_upsilon = (ends(each) for each in (alpha, upsilon))
    rotation: Polynomial = {}
    turned = whole_upsilon
    for n in range(1, HIGHEST + 1):
        turned = product(cross, whole_alpha, turned)
        rotation = weighted((1, rotation), (Fraction(1, factorial(n + 1)), turned))
    known = weighted((1, whole_upsilon), (1, rotation), (Fraction(1, 2), ends(sculling)))
    return at(weighted((1, ends(total, -END)), (-1, known)), Fraction(0))


def ends(polynomial: Polynomial, place: Fraction = END) -> Polynomial:
    """Its value there."""
    return {(s, 0): vector for s, vector in at(polynomial, place).items()}


def rows(vectors: Sequence[Vector]) -> list[np.ndarray]:
    return [np.array([vector], float) for vector in vectors]


def summed(by_power: dict[int, Vector], powers: Sequence[int]) -> list[float]:
    return [float(sum(parts)) for parts in zip(*(by_power[s] for s in powers), strict=True)]


@pytest.mark.parametrize("seed", range(3))
def test_rotation_of_a_parabola(seed: int) -> None:
    rates = random_coefficients(seed, 3)
    exact = rotation_beyond_coning(motion(rates))
    assert not any(any(exact[s]) for s in range(5))
    assert third_order_terms(*rows(rates))[0] == pytest.approx(summed(exact, [5]), rel=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_velocity_of_parabolas(seed: int) -> None:
    rates, forces = random_coefficients(seed, 3), random_coefficients(seed + 10, 3)
    exact = velocity_beyond_sculling(motion(rates), motion(forces))
    assert not any(any(exact[s]) for s in range(4))
    found = velocity_terms(rows(rates), rows(forces))[0]
    assert found == pytest.approx(summed(exact, [4, 5]), rel=1e-12)


POINTS = np.exp(2j * np.pi * np.arange(32) / 32)
"""Values of s: a polynomial's values there are its coefficients' Fourier transform."""


def on_points(polynomial: Polynomial) -> np.ndarray:
    """A polynomial without τ at `POINTS`, (32, 3)."""
    return sum(np.outer(POINTS**s, np.array(v, float)) for (s, _), v in polynomial.items())


def powers(values: np.ndarray) -> np.ndarray:
    """(32, 3) coefficients, by the power of s."""
    found = np.fft.fft(values, axis=0) / len(values)
    assert np.abs(found.imag).max() < 1e-12 * np.abs(found).max()
    return found.real


@pytest.mark.parametrize("seed", range(3))
def test_rotation_of_a_polynomial_of_fourth_degree(seed: int) -> None:
    """What is left is of T⁷."""
    rates = random_coefficients(seed, 5)
    exact = rotation_beyond_coning(motion(rates))
    scaled = [on_points({(k + 1, 0): vector}) for k, vector in enumerate(rates)]
    found = powers(rotation_terms(scaled))
    for s in range(HIGHEST + 1):
        assert found[s] == pytest.approx(summed(exact, [s]), rel=1e-10, abs=1e-12)
    assert any(exact[5])
    assert not any(exact[6])


def higher_orders(omega: Polynomial, force: Polynomial) -> np.ndarray:
    """`velocity_higher_orders` of the sums that a core hands over, by the power of s."""
    alpha, upsilon = integral(omega, -END), integral(force, -END)
    once = integral(product(cross, alpha, force), -END)
    s_alpha, s_upsilon, twice = (ends(integral(each, -END)) for each in (alpha, upsilon, once))
    alpha, upsilon = ends(alpha), ends(upsilon)
    sculling = weighted((1, ends(once)), (Fraction(-1, 2), product(cross, alpha, upsilon)))
    turned = weighted((1, product(cross, s_alpha, upsilon)), (1, product(cross, alpha, s_upsilon)))
    scrolling = weighted((1, twice), (Fraction(-1, 6), turned))
    given = map(on_points, (alpha, upsilon, s_alpha, s_upsilon, sculling, scrolling))
    return powers(velocity_higher_orders(*given, 1.0))


@pytest.mark.parametrize("seed", range(3))
def test_high_resolution_velocity_of_straight_lines(seed: int) -> None:
    """Exact in T⁴ and T⁵."""
    omega, force = (motion(random_coefficients(k, 2)) for k in (seed, seed + 10))
    found, exact = higher_orders(omega, force), velocity_beyond_sculling(omega, force)
    for s in range(6):
        assert found[s] == pytest.approx(summed(exact, [s]), rel=1e-10, abs=1e-11)


@pytest.mark.parametrize(("degree", "orders"), [(2, 3), (5, 2)])
def test_high_resolution_velocity_of_a_steady_turn(degree: int, orders: int) -> None:
    """Exact with two rates for every force, with three for a parabola."""
    omega = counted(random_coefficients(1, 1), 1)
    force = counted(random_coefficients(2, degree + 1), 0)
    found, exact = higher_orders(omega, force), velocity_beyond_sculling(omega, force)
    for s in range(orders + 1):
        assert found[s] == pytest.approx(summed(exact, [s]), rel=1e-10, abs=1e-11)
    assert any(exact[2])
