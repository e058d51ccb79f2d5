"""The host's increments: formulas against exact rationals, drift against the closed forms."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from math import degrees, factorial, pi, radians, sin
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from host_path import attitude_error, chained, fine_design, through_core
from sculler_model.analysis.closed_form import drift_rate, uncorrected_rate
from sculler_model.design import COMPONENTS, VECTORS, Design
from sculler_model.errors import InputError
from sculler_model.fast import VectorBlock, run_fast
from sculler_model.frames import AxisMap, Quaternion, rotate
from sculler_model.host import (
    MajorIncrements,
    ThirdOrder,
    major_increments,
    one_minus_cosine,
    one_minus_sine,
    scaling,
    second_order_corrections,
    uncorrected,
    velocity_rotation,
)
from sculler_model.motion import Coning, Sculling
from sculler_model.samples import Quantiser


def turned(phi: NDArray) -> Callable[[NDArray], NDArray]:
    matrix = Rotation.from_rotvec(phi).as_matrix()
    return lambda v: matrix @ v


# --- the coefficients of Savage-98 Eq. 51-52


def series(x: float, first: int) -> Fraction:
    """1/first! - x²/(first+2)! + ..., exact to far beyond a double."""
    square = Fraction(x) ** 2
    return sum(((-square) ** k / factorial(first + 2 * k) for k in range(40)), start=Fraction(0))


@pytest.mark.parametrize(
    "x", [0.0, 1e-300, 1e-8, 1e-3, 0.1, 0.5, 0.999, np.nextafter(1, 0), 1.0, 1.001, 2.0, 3.1, 6.0]
)
def test_rotation_coefficients_are_right_to_rounding(x: float) -> None:
    at = np.array([x])
    for found, exact in (
        (one_minus_cosine(at)[0], series(x, 2)),
        (one_minus_sine(at)[0], series(x, 3)),
    ):
        assert found == pytest.approx(float(exact), rel=1.5e-15, abs=1e-17)


@pytest.mark.parametrize("size", [1e-9, 1e-3, 0.2, 0.999, 1.5, 3.0])
def test_velocity_rotation_is_the_integral_of_turned_force(size: float) -> None:
    rng = np.random.default_rng(7)
    axis, upsilon = rng.normal(size=3), rng.normal(size=3)
    alpha = size * axis / np.linalg.norm(axis)
    node, weight = np.polynomial.legendre.leggauss(20)
    integral = sum(
        0.5 * w * turned(0.5 * (x + 1) * alpha)(upsilon) for x, w in zip(node, weight, strict=True)
    )
    found = upsilon + velocity_rotation(alpha[None], upsilon[None])[0]
    assert np.allclose(found, integral, rtol=2e-15, atol=2e-15)


# --- φ and ΔV_SF from the integers


def block_of(components: NDArray) -> VectorBlock:
    rows = len(components)
    return VectorBlock(np.arange(rows), np.zeros(rows, np.int64), components)


@pytest.mark.parametrize("size", [10**6, 2**62, 10**24])
@pytest.mark.parametrize(("kind", "samples"), [("increment", 5), ("rate", 2)])
def test_increments_are_the_formulas_of_the_page(kind: str, samples: int, size: int) -> None:
    design = fine_design(samples, rate=1000.0, gyro_lsb=3e-7, accel_lsb=1e-4, kind=kind)
    rng = np.random.default_rng(11)
    rows = [
        [int(rng.integers(-(10**6), 10**6)) * max(size // 10**6, 1) for _ in COMPONENTS]
        for _ in range(4)
    ]
    for row in rows:  # α and υ stay small enough for the formulas to mean something
        for at in (*range(3), *range(9, 12)):
            row[at] = row[at] % 100003 - 50000
    dtype = np.int64 if size <= 2**62 else object
    found = major_increments(design, block_of(np.array(rows, dtype=dtype)))

    T = Fraction(1) if kind == "increment" else Fraction(design.sample_interval)
    g, a = Fraction(3e-7) * T, Fraction(1e-4) * T
    Dc, Dw = design.table.denominator, design.table.sum_denominator
    for at, row in enumerate(rows):
        v = {name: row[3 * i : 3 * i + 3] for i, name in enumerate(VECTORS)}
        alpha = [g * c / Dw for c in v["alpha"]]
        upsilon = [a * c / Dw for c in v["nu"]]
        phi = [
            s + g * g * (Fraction(w, Dc) + Fraction(b, 2 * Dw * Dw))
            for s, w, b in zip(alpha, v["coning_within"], v["coning_between"], strict=True)
        ]
        sculling = [
            a * g * (Fraction(w, Dc) + Fraction(b, 2 * Dw * Dw))
            for w, b in zip(v["sculling_within"], v["sculling_between"], strict=True)
        ]
        turn = velocity_rotation(np.array([alpha], float), np.array([upsilon], float))[0]
        assert np.allclose(found.alpha[at], np.array(alpha, float), rtol=1e-15, atol=0)
        assert np.allclose(found.phi[at], np.array(phi, float), rtol=1e-14, atol=1e-18)
        expected = np.array(upsilon, float) + turn + np.array(sculling, float)
        assert np.allclose(found.dv_sf[at], expected, rtol=1e-13, atol=1e-15)


@pytest.mark.parametrize("position", ["trapezoidal", "high-resolution"])
def test_first_order_is_half_a_cross_product(position: str) -> None:
    """Savage-98 Eq. 39 and 86, without the exact rotation and higher orders."""
    design = fine_design(1, 1, 5, 500.0, 2e-6, 1e-4, position=position)
    high = position == "high-resolution"
    rows = np.random.default_rng(6).integers(-(10**4), 10**4, (4, 27 if high else 18))
    block = block_of(rows)
    found = major_increments(design, block, rotation="first-order")
    plain, T = uncorrected(design, block), design.sample_interval
    alpha, upsilon = plain.alpha, 1e-4 * rows[:, 9:12] / design.table.sum_denominator
    Dc, Dw = design.table.denominator, design.table.sum_denominator
    sculling = 1e-4 * 2e-6 * (rows[:, 12:15] / Dc + rows[:, 15:18] / (2 * Dw * Dw))
    expected = upsilon + 0.5 * np.cross(alpha, upsilon) + sculling
    assert np.allclose(found.dv_sf, expected, rtol=1e-12, atol=1e-16)
    assert np.array_equal(found.phi, major_increments(design, block).phi)
    assert (found.dr_sf is not None) == high
    if found.dr_sf is not None:
        s_alpha, s_upsilon = 2e-6 * T * rows[:, 18:21] / 12, 1e-4 * T * rows[:, 21:24] / 12
        turned_sums = np.cross(s_alpha, upsilon) + np.cross(alpha, s_upsilon)
        way = s_upsilon + turned_sums / 6 + 1e-4 * 2e-6 * T * rows[:, 24:27] / 4320
        assert np.allclose(found.dr_sf, way, rtol=1e-12, atol=1e-18)


@pytest.mark.parametrize("order", [3, 4])
def test_orders_that_a_core_hands_over_are_the_formulas_of_the_page(order: int) -> None:
    """φ is the sum of all, ΔV_SF turns the sum of all; what follows is -α×(α×β)/60, and so on."""
    g, a = 1e-3, 1e-1
    data = fine_design(2, minors=2, gyro_lsb=g, accel_lsb=a).as_json()
    data["hardware"] = {"core": "compact"}
    data["algorithm"] |= {"order": order}
    design = Design.parse(data)
    composed = design.composition
    rows = np.random.default_rng(8).integers(-60, 60, (5, len(design.columns) - 2))
    rows[:, :3] *= 3
    parts = np.split(rows.astype(float), len(design.vectors), axis=1)
    vectors = dict(zip(design.vectors, parts, strict=True))
    assert len(vectors) == 2 + 2 * order
    Dc, Dw = design.table.denominator, design.table.sum_denominator
    alpha, upsilon = g * vectors["alpha"], a * vectors["nu"]
    beta, sculling = (
        factor * (vectors[f"{name}_within"] / Dc + vectors[f"{name}_between"] / (2 * Dw * Dw))
        for name, factor in (("coning", g * g), ("sculling", a * g))
    )
    orders = [(alpha, upsilon), (beta, sculling)]
    for name, n, D in (("third", 3, composed.third), ("fourth", 4, composed.fourth))[: order - 2]:
        angle, velocity = vectors[f"coning_{name}"], vectors[f"sculling_{name}"]
        orders.append((g**n / D * angle, g ** (n - 1) * a / D * velocity))

    def cross(one: tuple[NDArray, NDArray], other: tuple[NDArray, NDArray]) -> Any:
        (p, u), (q, v) = one, other
        return np.cross(p, q), np.cross(p, v) + np.cross(u, q)

    first, second, third = orders[:3]
    once = cross(first, second)
    if order == 3:
        tail = [(-1 / 60, cross(first, once))]
    else:
        tail = [(-1 / 42, cross(first, cross(first, third))), (-2 / 105, cross(second, once))]
        tail.append((1 / 2520, cross(first, cross(first, cross(first, once)))))
    phi, w = (
        sum(each[i] for each in orders) + sum(factor * each[i] for factor, each in tail)
        for i in (0, 1)
    )
    found = major_increments(design, block_of(rows))
    assert np.allclose(found.alpha, alpha, rtol=1e-15, atol=0)
    assert np.allclose(found.phi, phi, rtol=1e-13, atol=0)
    assert np.allclose(found.dv_sf, w + velocity_rotation(phi, w), rtol=1e-13, atol=0)
    assert np.abs(found.phi - sum(each[0] for each in orders)).max() > 1e-12
    with pytest.raises(InputError, match=f"third order: .*, with order = {order}, hold these"):
        major_increments(design, block_of(rows), third_order=True)


@pytest.mark.parametrize("minors", [1, 3])
def test_corrections_of_intervals_taken_as_one(minors: int) -> None:
    """Coning and sculling of one long interval are those of the short ones and between them."""
    short, long = (
        fine_design(2, minors=m, gyro_lsb=1e-4, accel_lsb=1e-3) for m in (minors, 6 * minors)
    )
    counts = np.random.default_rng(4).integers(-900, 900, (12 * minors, 6))
    whole = run_fast(long, counts)
    assert len(whole) == 1
    found = second_order_corrections(short, run_fast(short, counts))
    for one, other in zip(found, second_order_corrections(long, whole), strict=True):
        assert one == pytest.approx(other, rel=1e-12)
        assert np.abs(one).max() > 0
    one = major_increments(long, whole)
    assert one.phi[0] - one.alpha[0] == pytest.approx(found[0], rel=1e-12)


def test_without_numba_it_is_numpy(monkeypatch: pytest.MonkeyPatch) -> None:
    design = fine_design(2, minors=3, gyro_lsb=1e-6, accel_lsb=1e-4)
    block = block_of(np.random.default_rng(5).integers(-900, 900, (4, 18)))
    expected = major_increments(design, block)
    monkeypatch.setattr(scaling, "compiled_scale", lambda: None)
    monkeypatch.setattr(scaling, "WORTH_COMPILING", 0)
    monkeypatch.setattr(scaling, "WORTH_WHEN_LOADED", 0)
    found = major_increments(design, block)
    for name in ("phi", "alpha", "dv_sf"):
        assert np.array_equal(getattr(found, name), getattr(expected, name))


@pytest.mark.parametrize("compiled", [False, True])
@pytest.mark.parametrize("count", [7, 8, 9, 10])
def test_many_intervals_are_scaled_part_by_part(
    monkeypatch: pytest.MonkeyPatch, count: int, compiled: bool
) -> None:
    """In parts of four or all at once: each interval by itself."""
    if compiled:
        pytest.importorskip("numba")
    design = fine_design(2, minors=3, gyro_lsb=1e-6, accel_lsb=1e-4)
    block = block_of(np.random.default_rng(5).integers(-900, 900, (count, 18)))
    block = replace(block, times=np.arange(float(count)))
    expected = [major_increments(design, block[row : row + 1]) for row in range(count)]
    monkeypatch.setattr(scaling, "PART", 4)
    monkeypatch.setattr(scaling, "RESULTS", 4)
    for least in ("WORTH_COMPILING", "WORTH_WHEN_LOADED"):
        monkeypatch.setattr(scaling, least, count if compiled else count + 1)
    found, whole = major_increments(design, block), MajorIncrements.concatenate(expected)
    for name in ("phi", "alpha", "dv_sf", "times", "status"):
        assert np.array_equal(getattr(found, name), getattr(whole, name)), name


def test_uncorrected_drops_only_coning_and_sculling() -> None:
    design = fine_design(4, gyro_lsb=1e-7, accel_lsb=1e-4)
    rows = np.random.default_rng(3).integers(-1000, 1000, (5, 18))
    plain = uncorrected(design, block_of(rows))
    rows[:, 3:9] = rows[:, 12:18] = 0  # coning_within .. coning_between, sculling
    full = major_increments(design, block_of(rows))
    assert np.array_equal(plain.phi, full.alpha)
    assert np.array_equal(plain.dv_sf, full.dv_sf)


def test_all_that_increments_carry_is_cut_and_joined() -> None:
    rng = np.random.default_rng(1)
    whole = MajorIncrements(
        *rng.normal(size=(4, 6, 3)), np.arange(6), 10.0 + np.arange(6), rng.normal(size=(6, 2))
    )
    for cuts in ((2, 6), (0, 6)):
        parts = [whole[: cuts[0]], whole[cuts[0] : cuts[1]]]
        assert [len(part) for part in parts] == [cuts[0], 6 - cuts[0]]
        again = MajorIncrements.concatenate(parts)
        for name, column in vars(whole).items():
            assert np.array_equal(getattr(again, name), column), name
    for name in ("times", "heights"):
        with pytest.raises(ValueError, match=f"1 of 2 parts have {name}"):
            MajorIncrements.concatenate([whole, replace(whole, **{name: None})])
    names = ["time_s", "status"]
    names += [f"{v}_{axis}" for v in ("phi", "alpha", "dv_sf", "dr_sf") for axis in "xyz"]
    assert list(whole.named_columns()) == names
    bare = replace(whole, times=None, status=None, dr_sf=None)
    assert list(bare.named_columns()) == names[2:11]
    biased = whole.without_bias([1.0, -2.0, 3.0], 0.5)
    for name in ("phi", "alpha"):
        assert getattr(biased, name) == pytest.approx(getattr(whole, name) - [0.5, -1.0, 1.5])
    assert np.array_equal(biased.dv_sf, whole.dv_sf)


def test_an_interval_of_short_history_is_named() -> None:
    inc = MajorIncrements(*np.zeros((3, 5, 3)), status=np.array([0, 2, 3, 1, 0]))
    assert inc.leading_short == 4
    with pytest.raises(InputError, match=r"^it: interval 2 of these reaches before the first"):
        inc.require_whole("it")
    stamped = replace(inc, times=100.25 + np.arange(5))
    with pytest.raises(InputError, match=r"interval 2 of these, which ends at 102\.25 s, reaches"):
        stamped.require_whole("it")


@pytest.mark.parametrize("wrong", ["", "Exact", "first"])
def test_no_other_rotation(wrong: str) -> None:
    block = block_of(np.zeros((1, 18), int))
    with pytest.raises(InputError, match=f"rotation: '{wrong}' is not allowed"):
        major_increments(fine_design(1, 1), block, rotation=wrong)  # type: ignore[arg-type]


def test_slices_axes_and_joining_of_displacements() -> None:
    inc = MajorIncrements(*np.random.default_rng(0).normal(size=(4, 6, 3)))
    again = MajorIncrements.concatenate([inc[:2], inc[2:]])
    assert inc.dr_sf is not None
    assert np.array_equal(again.dr_sf, inc.dr_sf)
    turned = inc.in_axes(AxisMap.parse("y,x,-z"))
    assert np.array_equal(turned.dr_sf, inc.dr_sf[:, [1, 0, 2]] * [1, 1, -1])
    corrected = ThirdOrder()(inc)
    assert np.array_equal(corrected.dr_sf, inc.dr_sf)
    with pytest.raises(ValueError, match="1 of 2 parts have dr_sf"):
        MajorIncrements.concatenate([inc[:2], replace(inc[2:], dr_sf=None)])


def test_displacement_is_the_formula_of_the_page() -> None:
    """Small angles, where Eq. 99 is 1/6 (S_α×υ + α×S_υ); wide integers, each scaled by its own."""
    design = fine_design(4, 0, 5, 500.0, 3e-13, 1e-4, position="high-resolution")
    rng = np.random.default_rng(12)
    rows = rng.integers(-(10**5), 10**5, (4, 27)).astype(object)
    rows[:, 24:] *= 10**20
    found = major_increments(design, block_of(rows))
    T, g, a = Fraction(1, 500), Fraction(3e-13), Fraction(1e-4)
    for at, row in enumerate(rows.tolist()):
        alpha, upsilon = [g * c for c in row[:3]], [a * c for c in row[9:12]]
        s_alpha = [g * T * c / 12 for c in row[18:21]]
        s_upsilon = [a * T * c / 12 for c in row[21:24]]
        for x in range(3):
            y, z = (x + 1) % 3, (x + 2) % 3
            rotation = s_alpha[y] * upsilon[z] - s_alpha[z] * upsilon[y]
            rotation += alpha[y] * s_upsilon[z] - alpha[z] * s_upsilon[y]
            way = s_upsilon[x] + rotation / 6 + g * a * T * row[24 + x] / 4320
            assert found.dr_sf is not None
            assert found.dr_sf[at, x] == pytest.approx(float(way), rel=1e-12)


def test_slices_axes_and_joining() -> None:
    inc = MajorIncrements(*np.random.default_rng(0).normal(size=(3, 6, 3)))
    again = MajorIncrements.concatenate([inc[:2], inc[2:]])
    assert np.array_equal(again.dv_sf, inc.dv_sf)
    assert len(inc[1:3]) == 2
    turned_axes = inc.in_axes(AxisMap.parse("y,x,-z"))
    assert np.array_equal(turned_axes.phi, inc.phi[:, [1, 0, 2]] * [1, 1, -1])
    assert np.array_equal(turned_axes.alpha, inc.alpha[:, [1, 0, 2]] * [1, 1, -1])
    assert np.array_equal(turned_axes.dv_sf, inc.dv_sf[:, [1, 0, 2]] * [1, 1, -1])


# --- motions with a known answer, through the integers


def test_constant_rate_and_force_are_exact_to_rounding() -> None:
    design = fine_design(4, minors=5, gyro_lsb=1e-7, accel_lsb=1e-6)
    count = np.array([3000, -5000, 1200, 700, -900, 4000])
    inc = major_increments(design, run_fast(design, np.tile(count, (60, 1))))
    phi, upsilon = 20 * 1e-7 * count[:3], 20 * 1e-6 * count[3:]
    node, weight = np.polynomial.legendre.leggauss(10)
    dv = sum(
        0.5 * w * turned(0.5 * (x + 1) * phi)(upsilon) for x, w in zip(node, weight, strict=True)
    )
    assert np.allclose(inc.phi[1:], phi, rtol=2e-16, atol=0)
    assert np.allclose(inc.dv_sf[1:], dv, rtol=1e-15, atol=0)


def test_turn_of_one_radian_a_second_under_30_metres_a_second_squared() -> None:
    """The between-minors term: n = 4, M = 5, 2 kHz, error below 1e-12 m/s²."""
    design = fine_design(4, minors=5, gyro_lsb=1e-9, accel_lsb=1e-8)
    counts = np.tile([0, 0, 500_000, 1_500_000, 0, 0], (40, 1))  # 1 rad/s, 30 m/s²
    found = major_increments(design, run_fast(design, counts)).dv_sf[1] / design.major_interval
    # in the body frame at the start: 30 (sin φ, 1 - cos φ, 0)/φ with φ = 0.01 rad
    assert found[0] == pytest.approx(30 * sin(0.01) / 0.01, abs=1e-12)
    assert found[1] == pytest.approx(30 * 2 * sin(0.005) ** 2 / 0.01, abs=1e-12)
    assert found[2] == 0


def coning_drift(design: Design, cone: Coning, majors: int) -> float:
    """Computed minus true rate (rad/s) about the cone's axis, host attitude against truth.

    The first major interval lacks history and is left out.
    """
    kind = design.sensor.kind
    sampled = cone.increments if kind == "increment" else cone.rates
    samples = (majors + 1) * design.samples_per_major
    inc = through_core(design, [sampled(samples, design.sample_interval)])
    times = design.major_interval * np.array([1.0, majors + 1.0])
    first, last = (tuple(q) for q in cone.attitude(times).tolist())
    found: Quaternion = chained(first, inc.phi[1:])
    return attitude_error(found, last)[2] / (times[1] - times[0])


@pytest.mark.parametrize(
    ("n", "p", "minors", "half_angle", "phase"),
    [
        (2, 0, 1, 1e-4, 2 * pi / 20),
        (2, 0, 6, 1e-4, 2 * pi / 20),
        (3, 0, 1, 1e-4, 2 * pi / 15),
        (3, 0, 4, 1e-4, 2 * pi / 15),
        (4, 0, 1, 1e-4, 2 * pi / 12),
        (4, 0, 5, 1e-4, 2 * pi / 12),
        (5, 0, 1, 1e-4, 2 * pi / 10),
        (5, 0, 2, 1e-4, 2 * pi / 8),
        (1, 1, 10, 1e-4, 2 * pi / 20),
        (3, 1, 2, 1e-4, 2 * pi / 9),
    ],
)
def test_coning_drift_is_the_closed_form_residual(
    n: int, p: int, minors: int, half_angle: float, phase: float
) -> None:
    design = fine_design(n, p, minors, gyro_lsb=1e-13)
    omega = phase / design.sample_interval
    expected = float(
        drift_rate(design.table, sin(half_angle), sin(half_angle), omega, design.sample_interval)
    )
    # whole cycles, so that the ripple of the second order is the same at both ends
    cycle = round(2 * pi / phase)
    majors = cycle * max(1, 3000 // (cycle * design.samples_per_major)) * 2
    measured = coning_drift(design, Coning(half_angle, omega), majors)
    assert measured == pytest.approx(expected, rel=0.01, abs=0)


def test_zengs_rates_drift_by_the_closed_form() -> None:
    """1° half angle at 20 Hz and 1 kHz through the filter: n = 2 leaves 1.07e-2 °/h."""
    design = fine_design(2, rate=1000.0, gyro_lsb=2e-9, kind="rate")
    measured = coning_drift(design, Coning(radians(1), 2 * pi * 20), 5000)
    assert degrees(measured) * 3600 == pytest.approx(1.07e-2, rel=0.01, abs=0)


def test_five_minors_of_four_leave_the_third_order_only() -> None:
    """Yang's lost half, a misprint of theory.md: 1°, 20 Hz, 1 kHz, n = 4, M = 5 drifts 0.11 °/h."""
    design = fine_design(4, minors=5, rate=1000.0, gyro_lsb=1e-11)
    measured = coning_drift(design, Coning(radians(1), 2 * pi * 20), 500)
    assert abs(degrees(measured) * 3600) == pytest.approx(0.11, abs=0.01)


def test_uncorrected_integration_drifts_by_half_ab_omega() -> None:
    design = fine_design(4, minors=5, gyro_lsb=1e-11)
    cone = Coning(1e-3, 2 * pi * 50)  # 50 Hz: half a cycle a major interval
    counts = Quantiser(design)(cone.increments(20 * 400, 1 / 2000))
    inc = uncorrected(design, run_fast(design, counts))
    first, last = (tuple(q) for q in cone.attitude(np.array([0.0, 4.0])).tolist())
    drift = attitude_error(chained(first, inc.phi), last)[2] / 4
    # α of half a cycle is ±2a along one axis: nothing of the cone's rate is left in the sums
    assert drift == pytest.approx(float(uncorrected_rate(1e-3, 1e-3, cone.omega)), rel=1e-3, abs=0)


@pytest.mark.parametrize(
    ("n", "minors", "phase"),
    [(2, 1, 2 * pi / 20), (3, 4, 2 * pi / 15), (4, 5, 2 * pi / 12), (5, 1, 2 * pi / 10)],
)
def test_sculling_drift_is_the_closed_form_residual(n: int, minors: int, phase: float) -> None:
    """Velocity along z in inertial space against B J1(A), through the integers."""
    design = fine_design(n, minors=minors, gyro_lsb=1e-13, accel_lsb=1e-10)
    T = design.sample_interval
    scull = Sculling(angle=1e-4, force=10.0, omega=phase / T)
    cycle = round(2 * pi / phase)
    majors = cycle * max(1, 3000 // (cycle * design.samples_per_major))
    inc = through_core(design, [scull.increments(majors * design.samples_per_major, T)])
    velocity, q = np.zeros(3), (1.0, 0.0, 0.0, 0.0)
    for phi, dv in zip(inc.phi, inc.dv_sf.tolist(), strict=True):
        velocity += rotate(q, tuple(dv))
        q = chained(q, phi[None])
    seconds = majors * design.major_interval
    expected = float(
        drift_rate(design.table, scull.angle, scull.force / scull.omega, scull.omega, T)
    )
    assert velocity[2] / seconds - scull.mean_force == pytest.approx(expected, rel=0.01, abs=0)


def test_coning_through_axes_any_way_round_is_the_same() -> None:
    """A turned sensor gives turned results: exact integers commute with signed permutations."""
    design = fine_design(4, minors=5)
    values = Coning(1e-3, 300.0).increments(200, 1 / 2000)
    values[:, 3:] = values[:, [1, 2, 0]] * 10
    axes = AxisMap.parse("-z,y,x")
    both = np.hstack([axes.apply(values[:, :3]), axes.apply(values[:, 3:])])
    one, other = through_core(design, [values]).in_axes(axes), through_core(design, [both])
    assert np.allclose(one.phi, other.phi, rtol=1e-9, atol=1e-11)
    assert np.allclose(one.dv_sf, other.dv_sf, rtol=1e-9, atol=1e-10)
