"""Doubly integrated increments and scrolling in integers: against exact integrals and the page."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest

from sculler_model.algorithms import (
    DoublyIntegrated,
    high_resolution,
    scrolling_weight,
    scrolling_weights_total,
)
from sculler_model.errors import InputError

Vector = tuple[Fraction, ...]
Poly = list[Vector]  # coefficient vectors of 1, t, t², ...
Samples = list[tuple[tuple[int, int, int], tuple[int, int, int]]]


def fractions(vector: tuple[int, ...]) -> Vector:
    return tuple(Fraction(c) for c in vector)


def add(*vectors: Vector) -> Vector:
    return tuple(sum(c, Fraction(0)) for c in zip(*vectors, strict=True))


def scale(factor: Fraction | int, a: Vector) -> Vector:
    return tuple(Fraction(factor) * c for c in a)


def cross(a: Vector, b: Vector) -> Vector:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def integral(p: Poly) -> Poly:
    zero = fractions((0, 0, 0))
    return [zero, *(scale(Fraction(1, k + 1), c) for k, c in enumerate(p))]


def crossed(p: Poly, q: Poly) -> Poly:
    out = [fractions((0, 0, 0))] * (len(p) + len(q) - 1)
    for i, a in enumerate(p):
        for j, b in enumerate(q):
            out[i + j] = add(out[i + j], cross(a, b))
    return out


def total(*parts: tuple[Fraction | int, Poly]) -> Poly:
    length = max(len(p) for _, p in parts)
    zero = fractions((0, 0, 0))
    padded = [[scale(f, c) for c in p] + [zero] * (length - len(p)) for f, p in parts]
    return [add(*column) for column in zip(*padded, strict=True)]


def at(p: Poly, t: int) -> Vector:
    return add(*(scale(Fraction(t) ** k, c) for k, c in enumerate(p)))


def integrals_85_86(omega: Poly, force: Poly, T: int) -> tuple[Vector, Vector, Vector]:
    """S_α, S_υ and ΔR_scrl of Savage-98 Eq. 85, 86 by exact integration from 0 to T."""
    alpha, upsilon = integral(omega), integral(force)
    s_alpha, s_upsilon = integral(alpha), integral(upsilon)
    half = Fraction(1, 2)
    sculling = integral(total((half, crossed(alpha, force)), (half, crossed(upsilon, omega))))
    scrolling = integral(
        total(
            (6, sculling),
            (-1, crossed(s_alpha, force)),
            (1, crossed(s_upsilon, omega)),
            (1, crossed(alpha, upsilon)),
        )
    )
    return at(s_alpha, T), at(s_upsilon, T), scale(Fraction(1, 6), at(scrolling, T))


def values(result: DoublyIntegrated) -> tuple[Vector, Vector, Vector]:
    """In units of counts and samples."""
    return (
        scale(Fraction(1, 12), fractions(result.s_alpha)),
        scale(Fraction(1, 12), fractions(result.s_nu)),
        scale(Fraction(1, 4320), fractions(result.scrolling)),
    )


def random_samples(rng: np.random.Generator, count: int, size: int = 2**23) -> Samples:
    table = rng.integers(-size, size, (count, 6)).tolist()
    return [((a, b, c), (d, e, f)) for a, b, c, d, e, f in table]


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("M", [1, 2, 5, 20])
def test_straight_lines_of_rate_and_force_are_exact(seed: int, M: int) -> None:
    """ω = A + B t, f = C + D t: equal as fractions, from the second interval on (the first has
    no sample before it)."""
    rng = np.random.default_rng(seed)
    A, B, C, D = (tuple(row) for row in rng.integers(-1000, 1000, (4, 3)).tolist())
    B, D = tuple(2 * b for b in B), tuple(2 * d for d in D)  # whole counts per sample

    def sample(base: tuple[int, ...], slope: tuple[int, ...], number: int) -> tuple[int, int, int]:
        x, y, z = (a + b // 2 * (2 * number + 1) for a, b in zip(base, slope, strict=True))
        return (x, y, z)

    # time 0 is where the second interval begins
    samples = [(sample(A, B, l), sample(C, D, l)) for l in range(-M, M)]  # noqa: E741
    _, second = high_resolution(samples, M)
    omega, force = [fractions(A), fractions(B)], [fractions(C), fractions(D)]
    assert values(second) == integrals_85_86(omega, force, M)


def test_constant_rate_and_force_scroll_nothing() -> None:
    samples = [((3, -5, 7), (11, 13, -17))] * 40
    _, second = high_resolution(samples, 20)
    assert second.scrolling == (0, 0, 0)
    assert second.s_alpha == (12 * 3 * 200, -12 * 5 * 200, 12 * 7 * 200)  # ½ ω T²


def as_on_the_page(samples: Samples, M: int) -> list[tuple[Vector, Vector, Vector]]:
    """Savage-98 Eq. 61, 103-105 with fractions, T_l = 1, the misprint in δR_scrlA mended."""
    zero = fractions((0, 0, 0))
    out = []
    every = [(zero, zero), *((fractions(g), fractions(a)) for g, a in samples)]
    for number, ((da1, dv1), (da, dv)) in enumerate(pairwise(every)):
        if number % M == 0:
            alpha = nu = s_alpha = s_nu = scul = scrl = zero
        Da, Dv = add(da, scale(-1, da1)), add(dv, scale(-1, dv1))
        twelfth, sixth = Fraction(1, 12), Fraction(1, 6)
        ds_alpha = add(alpha, scale(twelfth, add(scale(5, da), da1)))
        ds_nu = add(nu, scale(twelfth, add(scale(5, dv), dv1)))
        a_part = add(
            scul,
            scale(
                Fraction(1, 2),
                cross(add(alpha, scale(-twelfth, Da)), add(ds_nu, scale(-1, nu))),
            ),
            scale(
                Fraction(1, 2),
                cross(add(nu, scale(-twelfth, Dv)), add(ds_alpha, scale(-1, alpha))),
            ),
        )
        b_part = add(
            scale(sixth, cross(add(s_nu, scale(Fraction(1, 24), Dv)), da)),
            scale(-sixth, cross(add(s_alpha, scale(Fraction(1, 24), Da)), dv)),
            scale(sixth, cross(add(alpha, scale(-sixth, Da)), add(nu, scale(-sixth, Dv)))),
            scale(-Fraction(1, 2160), cross(Da, Dv)),
        )
        scrl = add(scrl, a_part, b_part)
        scul = add(
            scul,
            scale(Fraction(1, 2), cross(add(alpha, scale(sixth, da1)), dv)),
            scale(Fraction(1, 2), cross(add(nu, scale(sixth, dv1)), da)),
        )
        s_alpha, s_nu = add(s_alpha, ds_alpha), add(s_nu, ds_nu)
        alpha, nu = add(alpha, da), add(nu, dv)
        if number % M == M - 1:
            out.append((s_alpha, s_nu, scrl))
    return out


@pytest.mark.parametrize("M", [1, 3, 8])
def test_any_samples_as_on_the_page(M: int) -> None:
    samples = random_samples(np.random.default_rng(M), 25)
    found = [values(result) for result in high_resolution(samples, M)]
    assert found == as_on_the_page(samples, M)
    assert len(found) == 25 // M


def test_sums_are_plain_and_history_runs_across_intervals() -> None:
    samples = random_samples(np.random.default_rng(7), 12)
    whole = list(high_resolution(samples, 4))
    for number, result in enumerate(whole):
        part = np.array(samples[4 * number : 4 * number + 4])
        assert result.alpha == tuple(part[:, 0].sum(axis=0))
        assert result.nu == tuple(part[:, 1].sum(axis=0))
    alone = next(high_resolution(samples[4:], 4))
    assert alone.alpha == whole[1].alpha
    assert alone.s_alpha != whole[1].s_alpha


def test_no_samples_in_an_interval_is_refused() -> None:
    with pytest.raises(InputError, match="samples in a major interval: 0 is not allowed"):
        list(high_resolution([], 0))
    (found,) = high_resolution([((1, 0, 0), (0, 2, 0))], 1)
    assert (found.alpha, found.nu) == ((1, 0, 0), (0, 2, 0))


def weights_by_impulses(M: int) -> list[list[int]]:
    """c_ij as the algorithm of the page gives them: Δα_i along y and Δυ_j along z, all else 0."""
    rows = []
    for i in range(M + 1):
        row = []
        for j in range(M + 1):
            samples = [[(0, 0, 0), (0, 0, 0)] for _ in range(2 * M)]
            samples[M - 1 + i][0], samples[M - 1 + j][1] = (0, 1, 0), (0, 0, 1)
            _, (_, _, scrolling) = as_on_the_page([(a, b) for a, b in samples], M)
            row.append(int(4320 * scrolling[0]))
        rows.append(row)
    return rows


@pytest.mark.parametrize("M", [1, 2, 3, 4, 6])
def test_the_weights_of_the_double_sum(M: int) -> None:
    expected = weights_by_impulses(M)
    assert [[scrolling_weight(i, j, M) for j in range(M + 1)] for i in range(M + 1)] == expected


@pytest.mark.parametrize("M", [*range(1, 12), 37, 64])
def test_the_double_sum_is_scrolling(M: int) -> None:
    samples = random_samples(np.random.default_rng(M), 2 * M)
    *_, second = high_resolution(samples, M)
    last = samples[M - 1 :]
    total = [0, 0, 0]
    for i, (a, _) in enumerate(last):
        for j, (_, v) in enumerate(last):
            c = scrolling_weight(i, j, M)
            for x in range(3):
                y, z = (x + 1) % 3, (x + 2) % 3
                total[x] += c * (a[y] * v[z] - a[z] * v[y])
    assert second.scrolling == tuple(total)


@pytest.mark.parametrize("M", [*range(1, 30), 83, 150])
def test_the_total_of_the_weights(M: int) -> None:
    pairs = ((i, j) for i in range(M + 1) for j in range(M + 1))
    assert scrolling_weights_total(M) == sum(abs(scrolling_weight(i, j, M)) for i, j in pairs)
