"""High-resolution position on the host: closed forms, and the example of Savage-98 section VI."""

from __future__ import annotations

from collections.abc import Callable
from math import pi, radians, sqrt

import numpy as np
import pytest
from numpy.typing import NDArray

from host_path import fine_design
from sculler_model.fast import FastModel
from sculler_model.host import MajorIncrements, major_increments, velocity_rotation
from sculler_model.motion import at_rest, turn_motion
from sculler_model.navigation import Navigator
from sculler_model.navigation.earth import radii
from sculler_model.navigation.high_resolution import (
    displacement,
    half_minus_cosine,
    position_rotation,
)
from sculler_model.quantise import Quantiser
from sculler_model.scrolling import S_DENOMINATOR, SCROLLING_DENOMINATOR, high_resolution

Array = NDArray[np.float64]
Plane = NDArray[np.complex128]

G = 9.80665
RATE_HZ, MAJOR_HZ = 2000, 50
PER_MAJOR = RATE_HZ // MAJOR_HZ
GYRO_LSB, ACCEL_LSB = 1e-12, 1e-10


def through_sample_rate(increments: Array) -> tuple[MajorIncrements, list[Array]]:
    """Increments (N, 6) in SI through the integers: the host's, and what `displacement` takes."""
    design = fine_design(1, 1, PER_MAJOR, RATE_HZ, GYRO_LSB, ACCEL_LSB)  # Savage-98 Eq. 61
    counts = Quantiser(design)(increments)
    host = major_increments(design, FastModel(design).feed(counts))
    samples = [((a, b, c), (d, e, f)) for a, b, c, d, e, f in counts.tolist()]
    rows = list(high_resolution(samples, PER_MAJOR))
    T, g, a = 1 / RATE_HZ, GYRO_LSB, ACCEL_LSB
    units = (g, a, g * T / S_DENOMINATOR, a * T / S_DENOMINATOR, g * a * T / SCROLLING_DENOMINATOR)
    vectors = (np.array([row[k] for row in rows], dtype=np.float64) for k in range(5))
    return host, [unit * vector for unit, vector in zip(units, vectors, strict=True)]


def flown(host: MajorIncrements, dr_sf: Array, rate: float) -> tuple[Plane, Plane]:
    """Position in inertial space, the body turning about z: high resolution, and trapezoid."""
    T = 1 / MAJOR_HZ
    start = np.exp(1j * rate * T * np.arange(len(host)))
    dv = start * (host.dv_sf[:, 0] + 1j * host.dv_sf[:, 1])
    dr = start * (dr_sf[:, 0] + 1j * dr_sf[:, 1])
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
    host, sums = through_sample_rate(samples_of(lambda t: 1.5 * G * t**2, 0.0))
    true = 0.5 * G * MAJOR_TIMES**3
    fine, trapezoid = flown(host, displacement(*sums), 0.0)
    assert abs(trapezoid - true)[MAJOR_HZ - 1] == pytest.approx(0.098e-2, rel=2e-3, abs=0)
    assert abs(fine - true).max() < 2e-10  # in 10 s and 490 m


def test_3_g_and_1_rad_per_second() -> None:
    """Trapezoid: 0.098 cm in 1 s if the turning did not carry the error round; exact otherwise.

    Before the very first sample there was none, which to it looks like a rate and force that
    begin: Δυ T_l/12 is missing from S_υ once.
    """
    host, sums = through_sample_rate(samples_of(lambda t: 3 * G * t, 1.0))
    true = 3 * G * position_of_wave(1.0, MAJOR_TIMES)
    fine, trapezoid = flown(host, displacement(*sums), 1.0)
    carried_round = abs(np.exp(1j) - 1)
    error = abs(trapezoid - true)[MAJOR_HZ - 1]
    assert error == pytest.approx(0.098e-2 * carried_round, rel=2e-3, abs=0)
    assert abs(fine - true) == pytest.approx(3 * G / RATE_HZ**2 / 12, abs=2e-10)


@pytest.mark.parametrize(("phase", "steady"), [(0.8, 0.0), (pi / 2, 3 * G)])
def test_3_6_g_rms_of_vibration_and_1_rad_per_second(phase: float, steady: float) -> None:
    """50 Hz vibration seen 50 times a second: below 0.01 cm in 10 s, and not without scrolling.

    As in Savage's example the velocity is taken as known: the position algorithm alone is looked
    at.  (The velocity's own products of third order come to 1.7 cm here, with 0.02 rad of turn in
    one interval; four times shorter intervals make that 0.1 cm.)
    """
    omega, size, T = 2 * pi * 50, 3.6 * sqrt(2) * G, 1 / MAJOR_HZ
    _, sums = through_sample_rate(
        samples_of(lambda t: steady * t - size / omega * np.cos(omega * t + phase), 1.0)
    )
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

    assert error(found(displacement(*sums))) < 0.002e-2
    assert error(0.5 * T * (v[1:] + v[:-1])) > 0.2e-2
    assert error(found(displacement(*sums[:4], 0 * sums[4]))) > 0.05e-2


def test_without_scrolling_the_example_fails() -> None:
    """The third term of Eq. 84 is needed: 0.053 cm/s if systematic (Savage-98 section VI)."""
    omega, size, alpha = 2 * pi * 50, 3.6 * sqrt(2) * G, 1 / MAJOR_HZ
    T = 1 / MAJOR_HZ
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
    host, sums = through_sample_rate(where.increments(seconds * RATE_HZ, 1 / RATE_HZ))
    dr = displacement(*sums)
    true = where.state(np.arange(seconds * MAJOR_HZ + 1) / MAJOR_HZ)
    start = true.state(0)

    def error(dr_sf: Array | None) -> float:
        found = Navigator(start, 1 / MAJOR_HZ).run(host, dr_sf)
        return float(np.abs(found.h - true.h[1:]).max())

    assert error(None) > 1e-4
    assert error(dr) < 2e-6
    one_by_one = Navigator(start, 1 / MAJOR_HZ)
    for phi, dv, way in zip(host.phi.tolist(), host.dv_sf.tolist(), dr.tolist(), strict=True):
        one_by_one.update(tuple(phi), tuple(dv), tuple(way))
    whole = Navigator(start, 1 / MAJOR_HZ).run(host, dr)
    assert one_by_one.state.h == pytest.approx(whole.h[-1], abs=1e-12)


def test_at_rest_the_position_is_exact_in_high_resolution() -> None:
    """A force constant in the turning local level: 10 s intervals, closed form of ∬ R(ωt) dt²."""
    lat, h, count, T = radians(50), 300.0, 60, 10.0
    where = at_rest(lat, 0.3, h, roll=0.2, pitch=0.1, heading=1.0)
    sums = where.increments(count, T)
    alpha, upsilon = sums[:, :3], sums[:, 3:]
    inc = MajorIncrements(alpha, alpha, upsilon + velocity_rotation(alpha, upsilon))
    dr = displacement(alpha, upsilon, 0.5 * T * alpha, 0.5 * T * upsilon, np.zeros_like(alpha))
    found = Navigator(where.state(np.zeros(1)).state(0), T).run(inc, dr)
    meridian, prime_vertical = radii(np.sin(lat))
    assert np.abs(found.lat - lat).max() * meridian < 1e-6
    assert np.abs(found.lon - 0.3).max() * prime_vertical < 1e-6
    assert np.abs(found.h - h).max() < 1e-6
