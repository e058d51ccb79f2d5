"""High-resolution position on the host: closed forms, and the example of Savage-98 section VI."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import factorial, pi, radians, sqrt

import numpy as np
import pytest
from numpy.typing import NDArray

from host_path import fine_design
from sculler_model.algorithms import SCROLLING_DENOMINATOR
from sculler_model.design import Design
from sculler_model.fast import VectorBlock, run_fast
from sculler_model.frames import radii
from sculler_model.golden import GoldenModel
from sculler_model.host import (
    MajorIncrements,
    displacement,
    half_minus_cosine,
    major_increments,
    position_rotation,
    velocity_higher_orders,
    velocity_rotation,
)
from sculler_model.motion import Curve, Motion, Turn, Z, at_rest, turn_motion
from sculler_model.navigation import NavHistory, Navigator
from sculler_model.samples import Quantiser

Array = NDArray[np.float64]
Plane = NDArray[np.complex128]

G = 9.80665
RATE_HZ, MAJOR_HZ = 2000, 50
PER_MAJOR = RATE_HZ // MAJOR_HZ
GYRO_LSB, ACCEL_LSB = 1e-12, 1e-10


DESIGN = fine_design(
    1, 1, PER_MAJOR, RATE_HZ, GYRO_LSB, ACCEL_LSB, position="high-resolution"
)  # the recursion of Savage-98 Eq. 61
T = 1 / MAJOR_HZ


def through_core(increments: Array, exactly: bool = False) -> VectorBlock:
    """Increments (N, 6) in SI through the integers, by the reference model where asked for."""
    counts = Quantiser(DESIGN)(increments)
    if not exactly:
        return run_fast(DESIGN, counts)
    samples = [((a, b, c), (d, e, f), 0) for a, b, c, d, e, f in counts.tolist()]
    return VectorBlock.from_results(list(GoldenModel(DESIGN).run(samples)))


def through_sample_rate(increments: Array) -> MajorIncrements:
    """The same, with what the host makes of it."""
    return major_increments(DESIGN, through_core(increments))


def flown(host: MajorIncrements, rate: float) -> tuple[Plane, Plane]:
    """Position in inertial space, the body turning about z: high resolution, and trapezoid."""
    assert host.dr_sf is not None
    start = np.exp(1j * rate * T * np.arange(len(host)))
    dv = start * (host.dv_sf[:, 0] + 1j * host.dv_sf[:, 1])
    dr = start * (host.dr_sf[:, 0] + 1j * host.dr_sf[:, 1])
    v = np.concatenate(([0], np.cumsum(dv)))
    return np.cumsum(T * v[:-1] + dr), np.cumsum(T * 0.5 * (v[1:] + v[:-1]))


def position_of_wave(omega: complex, t: Array) -> Plane:
    """The double integral of exp(iωt) from rest."""
    w = 1j * omega
    result: Plane = (np.exp(w * t) - 1) / w**2 - t / w
    return result


TIMES = np.arange(10 * RATE_HZ + 1) / RATE_HZ
MAJOR_TIMES = np.arange(1, 10 * MAJOR_HZ + 1) / MAJOR_HZ


def samples_of(velocity: Callable[[Array], Array], rate: float) -> Array:
    """Increments for a force along body x whose integral is `velocity`, turning about z."""
    out = np.zeros((len(TIMES) - 1, 6))
    out[:, 2] = rate / RATE_HZ
    out[:, 3] = np.diff(velocity(TIMES))
    return out


def test_ramp_of_3_g_per_second() -> None:
    """Trapezoid: 0.098 cm in 1 s (Savage-98 section VI); high resolution: rounding."""
    host = through_sample_rate(samples_of(lambda t: 1.5 * G * t**2, 0.0))
    true = 0.5 * G * MAJOR_TIMES**3
    fine, trapezoid = flown(host, 0.0)
    assert abs(trapezoid - true)[MAJOR_HZ - 1] == pytest.approx(0.098e-2, rel=2e-3, abs=0)
    assert abs(fine - true).max() < 2e-10  # in 10 s and 490 m


def test_3_g_and_1_rad_per_second() -> None:
    """Trapezoid: 0.098 cm in 1 s if the turning did not carry the error round; exact otherwise.

    Before the very first sample there was none, which to it looks like a rate and force that
    begin: Δυ T_l/12 is missing from S_υ once, and the velocity is 3 nm/s off from then on.
    """
    host = through_sample_rate(samples_of(lambda t: 3 * G * t, 1.0))
    true = 3 * G * position_of_wave(1.0, MAJOR_TIMES)
    fine, trapezoid = flown(host, 1.0)
    carried_round = abs(np.exp(1j) - 1)
    error = abs(trapezoid - true)[MAJOR_HZ - 1]
    assert error == pytest.approx(0.098e-2 * carried_round, rel=2e-3, abs=0)
    assert abs(fine - true) == pytest.approx(3 * G / RATE_HZ**2 / 12, abs=4e-8)


@pytest.mark.parametrize(("phase", "steady"), [(0.0, 0.0), (0.8, 0.0), (pi / 2, 3 * G)])
def test_3_6_g_rms_of_vibration_and_1_rad_per_second(phase: float, steady: float) -> None:
    """50 Hz vibration seen 50 times a second: below 0.01 cm in 10 s, and not without scrolling.

    In Savage's example the velocity is taken as known, the position algorithm alone is looked at.
    Here that is done, and the velocity is carried along too: its products of third and fourth
    order (`velocity_higher_orders`) come to up to 1.7 cm.
    """
    omega, size = 2 * pi * 50, 3.6 * sqrt(2) * G
    increments = samples_of(lambda t: steady * t - size / omega * np.cos(omega * t + phase), 1.0)
    block = through_core(increments)
    host = major_increments(DESIGN, block)
    # along x of a body that turns: e^(it) (steady + size/2i (e^(i(ωt+φ)) - e^(-i(ωt+φ))))
    waves = ((steady, 1.0), (size / 2j * np.exp(1j * phase), 1 + omega))
    waves += ((-size / 2j * np.exp(-1j * phase), 1 - omega),)
    times = np.concatenate(([0.0], MAJOR_TIMES))
    v = sum(c * (np.exp(1j * w * times) - 1) / (1j * w) for c, w in waves)
    true = sum(c * position_of_wave(w, MAJOR_TIMES) for c, w in waves)

    def error(way: Plane) -> float:
        return float(abs(np.cumsum(way) - true).max())

    def found(dr_sf: Array) -> Plane:
        into_inertial = np.exp(1j * times[:-1])
        result: Plane = T * v[:-1] + into_inertial * (dr_sf[:, 0] + 1j * dr_sf[:, 1])
        return result

    assert host.dr_sf is not None
    unit = GYRO_LSB * ACCEL_LSB / RATE_HZ / SCROLLING_DENOMINATOR
    scrolling = unit * block.vector("scrolling").astype(np.float64)
    assert error(found(host.dr_sf)) < 0.002e-2
    assert error(0.5 * T * (v[1:] + v[:-1])) > 0.2e-2
    assert error(found(host.dr_sf - scrolling)) > 0.05e-2

    fine, trapezoid = flown(host, 1.0)
    assert abs(fine - true).max() < 0.005e-2
    assert abs(trapezoid - true).max() > 0.2e-2
    s = major_increments(replace_position(DESIGN), block)  # ΔV_SF to second order only
    second_order, _ = flown(replace(s, dr_sf=host.dr_sf), 1.0)
    assert abs(second_order - true).max() > 0.5e-2


def replace_position(design: Design) -> Design:
    """The design without high-resolution position."""
    data = design.as_json()
    return Design.parse({**data, "algorithm": {**data["algorithm"], "position": "trapezoidal"}})


def test_without_scrolling_the_example_fails() -> None:
    """The third term of Eq. 84 is needed: 0.053 cm/s if systematic (Savage-98 section VI)."""
    omega, size, alpha = 2 * pi * 50, 3.6 * sqrt(2) * G, 1 / MAJOR_HZ
    s_upsilon = size / omega * T  # of a vibration that begins at a zero of the force
    rotation = position_rotation(
        np.array([[0.0, 0.0, alpha]]),
        np.zeros((1, 3)),
        np.array([[0.0, 0.0, 0.5 * alpha * T]]),
        np.array([[s_upsilon, 0.0, 0.0]]),
    )
    assert np.linalg.norm(rotation) * MAJOR_HZ == pytest.approx(0.053e-2, rel=0.02, abs=0)


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-3, 0.3, 0.999, 1.001, 2.5, 6.0])
def test_position_rotation_is_exact_for_constant_rate_and_force(angle: float) -> None:
    """Eq. 92: force along x, turning about z by `angle` in 1 s, from the closed form."""
    force = np.array([[7.0, 0.0, 0.0]])
    alpha = np.array([[0.0, 0.0, angle]])
    zero = np.zeros((1, 3))
    found = displacement(alpha, force, 0.5 * alpha, 0.5 * force, zero)[0]
    if angle > 0.1:
        true = 7.0 * complex(position_of_wave(angle, np.array([1.0]))[0])
    else:  # by series
        true = 7.0 * complex(0.5 - angle**2 / 24, angle / 6 - angle**3 / 120)
    assert found == pytest.approx([true.real, true.imag, 0.0], abs=3e-15 * 7)


def test_the_coefficient_at_both_ends() -> None:
    x = np.array([0.0, 1e-8, 1 - 1e-12, 1 + 1e-12, 2 * pi])
    found = half_minus_cosine(x)
    assert found[:2] == pytest.approx([1 / 24, 1 / 24], rel=1e-15)
    assert found[2] == pytest.approx(0.5 - (1 - np.cos(1.0)), rel=1e-11)
    assert found[3] == pytest.approx(found[2], rel=1e-11)
    assert found[4] == pytest.approx(0.5 / (4 * pi**2), rel=1e-14)


def test_the_navigator_takes_it() -> None:
    """A turning vehicle shaken at 35 Hz: the trapezoid at 50 Hz misses what this finds."""
    where = turn_motion(shaking=10.0)
    seconds = 4
    host = through_sample_rate(where.increments(seconds * RATE_HZ, 1 / RATE_HZ))
    true = where.state(np.arange(seconds * MAJOR_HZ + 1) / MAJOR_HZ)
    assert host.leading_short == 1  # it lacks the sample before it
    host, start = host[1:], true.state(1)

    def error(increments: MajorIncrements) -> float:
        found = Navigator(start, T).run(increments)
        return float(np.abs(found.h - true.h[2:]).max())

    assert host.dr_sf is not None
    assert error(replace(host, dr_sf=None)) > 1e-4
    assert error(host) < 2e-6
    assert host.dr_sf is not None
    one_by_one = Navigator(start, T)
    rows = zip(host.phi.tolist(), host.dv_sf.tolist(), host.dr_sf.tolist(), strict=True)
    for phi, dv, way in rows:
        one_by_one.update(tuple(phi), tuple(dv), tuple(way))
    whole = Navigator(start, T).run(host)
    assert one_by_one.state.h == pytest.approx(whole.h[-1], abs=1e-12)


CIRCLE = {
    "north": Curve(waves=((3 * G, 1.0, 0.0),)),
    "east": Curve((3 * G,), ((-3 * G, 1.0, pi / 2),)),
    "turns": (Turn(Z, Curve((0.0, 1.0))),),
}
"""1 rad/s at 3 g m/s: 3 g square to the way, constant in the body but for gravity."""


def shaken(axis: int, phase: float) -> tuple[Curve, ...]:
    """3.6 g rms at 50 Hz along an axis of the body."""
    omega = 2 * pi * 50
    curves = [Curve(), Curve(), Curve()]
    curves[axis] = Curve(waves=((-3.6 * sqrt(2) * G / omega**2, omega, phase),))
    return tuple(curves)


def position_errors(found: NavHistory, true: NavHistory) -> Array:
    """Distance (m) at each instant."""
    meridian, prime_vertical = radii(float(np.sin(true.lat[0])))
    north = (found.lat - true.lat) * meridian
    east = (found.lon - true.lon) * prime_vertical * np.cos(true.lat)
    result: Array = np.sqrt(north**2 + east**2 + (found.h - true.h) ** 2)
    return result


@pytest.mark.deep
@pytest.mark.parametrize(
    ("motion", "trapezoidal", "most"),
    [
        (Motion(radians(48), 0.2, 500.0, north=Curve((0, 0, 0, G / 2))), 0.098e-2, 0.002e-2),
        (Motion(radians(48), 0.2, 500.0, **CIRCLE), 0.098e-2 * abs(np.exp(1j) - 1), 0.001e-2),
        (Motion(radians(48), 0.2, 500.0, arm=shaken(0, 0.0), **CIRCLE), None, 0.003e-2),
        (Motion(radians(48), 0.2, 500.0, arm=shaken(1, 0.8), **CIRCLE), None, 0.003e-2),
        (Motion(radians(48), 0.2, 500.0, arm=shaken(2, 0.0), **CIRCLE), None, 0.001e-2),
    ],
    ids=["ramp", "circle", "shaken forward", "shaken right", "shaken down"],
)
def test_savages_example_over_the_earth(
    motion: Motion, trapezoidal: float | None, most: float
) -> None:
    """Savage-98 section VI from counts through model, host and navigator: 10 s at 50 Hz.

    Ramp of 3 g/s, 3 g with 1 rad/s, and that with 3.6 g rms at 50 Hz; the trapezoid leaves
    0.098 cm in 1 s (on the circle less, for it is carried round), high resolution less than
    0.01 cm in 10 s.  The velocity over the Earth at the updates stands up to 0.16 m/s off its mean.
    """
    block = through_core(motion.increments(len(TIMES) - 1, 1 / RATE_HZ), exactly=most == 0.003e-2)
    host = major_increments(DESIGN, block)[1:]  # the first interval lacks a sample before it
    true = motion.state(MAJOR_TIMES)
    start = true.state(0)
    fine = position_errors(Navigator(start, T).run(host, compiled=False), rows_of(true, 1))
    coarse = Navigator(start, T).run(replace(host, dr_sf=None), compiled=False)
    trapezoid = position_errors(coarse, rows_of(true, 1))
    assert fine.max() < most <= 0.01e-2
    if trapezoidal is not None:
        assert trapezoid[MAJOR_HZ - 1] == pytest.approx(trapezoidal, rel=0.05)
    assert trapezoid.max() > 20 * most


def rows_of(history: NavHistory, first: int) -> NavHistory:
    """The states from a row on."""
    fields = (history.time, history.q, history.v, history.lat, history.lon, history.h)
    return NavHistory(*(field[first:] for field in fields))


@pytest.mark.parametrize(
    ("force", "order", "alpha"), [((2, -7, 5), 4, 0.1), ((0, 0, 0, 1), 3, 2e-3)]
)
def test_higher_orders_of_the_velocity(force: tuple[int, ...], order: int, alpha: float) -> None:
    """A force that is a parabola or a cubic, in a body that turns steadily.

    ∫ e^(iωt) f dt over one interval against Eq. 37 with the higher orders: what is left goes with
    α⁴ for the parabola; for the cubic, whose third moment is guessed, with α³, p/2800 of α³/6.
    """

    def moment(n: int) -> float:
        return sum(p / (k + n + 1) for k, p in enumerate(force))  # Σ p_k t^k along x, T = 1

    def error(alpha: float) -> float:
        m0, m1, m2 = (moment(n) for n in range(3))
        sculling = 1j * alpha * (m1 - 0.5 * m0)
        # Eq. 86 with S_α = ½ α t²: its integrands in turn, of the same moments
        running = 1j * alpha * (m1 - 0.75 * m2 - 0.25 * m0)
        s_f, s_w, across = 0.5 * m2, 0.5 * (m0 - 2 * m1 + m2), 0.5 * (m0 - m2)
        scrolling = running + 1j * alpha * (-s_f - s_w + across) / 6
        vectors = [np.array([[z.real, z.imag, 0.0]]) for z in (complex(m0), sculling, scrolling)]
        turn = np.array([[0.0, 0.0, alpha]])
        found = vectors[0] + velocity_rotation(turn, vectors[0]) + vectors[1]
        ways = 0.5 * turn, np.array([[m0 - m1, 0.0, 0.0]])
        found += velocity_higher_orders(turn, vectors[0], *ways, vectors[1], vectors[2], 1.0)
        true = sum((1j * alpha) ** n / factorial(n) * moment(n) for n in range(25))
        return abs(complex(found[0, 0], found[0, 1]) - true)

    assert error(alpha) / error(alpha / 2) == pytest.approx(2**order, rel=0.1)
    if order == 3:
        assert error(alpha) == pytest.approx(alpha**3 / 6 / 2800, rel=0.1, abs=0)


def test_at_rest_the_position_is_exact_in_high_resolution() -> None:
    """A force constant in the turning local level: 10 s intervals, closed form of ∬ R(ωt) dt²."""
    lat, h, count, interval = radians(50), 300.0, 60, 10.0
    where = at_rest(lat, 0.3, h, roll=0.2, pitch=0.1, heading=1.0)
    sums = where.increments(count, interval)
    alpha, upsilon = sums[:, :3], sums[:, 3:]
    dv = upsilon + velocity_rotation(alpha, upsilon)
    dr = displacement(alpha, upsilon, 0.5 * interval * alpha, 0.5 * interval * upsilon, 0 * alpha)
    start = where.state(np.zeros(1)).state(0)
    found = Navigator(start, interval).run(MajorIncrements(alpha, alpha, dv, dr))
    meridian, prime_vertical = radii(np.sin(lat))
    assert np.abs(found.lat - lat).max() * meridian < 1e-6
    assert np.abs(found.lon - 0.3).max() * prime_vertical < 1e-6
    assert np.abs(found.h - h).max() < 1e-6
