"""Savage's and Yang's of docs/explanation/misprints.md: the right form holds, the printed not."""

from __future__ import annotations

from math import cos, degrees, pi, radians

import numpy as np
import pytest
from numpy.typing import NDArray

from sculler_model.analysis.integer_path import rotation_vectors, running_attitude
from sculler_model.frames import from_rotation_vector, rotate, to_dcm
from sculler_model.motion import Coning, SpinAccel

Array = NDArray[np.float64]

G = 9.80665
EARTH = 7.292115e-5


def test_savage_20_eq_1_cosine_series() -> None:
    x = 0.3
    exact = (1 - cos(x)) / x**2
    assert 1 / 2 - x**2 / 24 + x**4 / 720 == pytest.approx(exact, rel=1e-7)
    printed = 1 - x**2 / 2 + x**4 / 24
    assert printed == pytest.approx(cos(x), rel=1e-5)
    # 0.05 rad an update
    x, cross = 0.05, np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 0]]) * 0.05
    B = np.array(to_dcm(from_rotation_vector((0.0, 0.0, x))))
    with_printed = np.eye(3) + np.sin(x) / x * cross + (1 - x**2 / 2) * cross @ cross
    assert np.abs(with_printed - B).max() == pytest.approx(1.2e-3, rel=0.05)


def test_savage_98_eq_35() -> None:
    """α × υ' = ½ d/dt(α × υ) + ½(α × υ' + υ × α'): with α = (t², 0, 0), υ = (0, t³, 0)."""
    t = 0.7
    left, rate = t**2 * 3 * t**2, 5 * t**4
    bracket = 0.5 * (3 * t**4 - 2 * t**4)
    assert 0.5 * rate + bracket == pytest.approx(left)
    assert rate + bracket != pytest.approx(left)


def _turning_frame(interval: float, turn: float) -> tuple[complex, complex]:
    """Velocity and displacement in a frame that turns by -ζ while unit force stands still in it."""
    T = interval
    t = (np.arange(20000) + 0.5) * T / 20000
    seen = np.exp(-1j * turn * t) * T / 20000
    return complex(seen.sum()), complex(seen @ (T - t))


def test_savage_98_eq_13_14_and_79() -> None:
    """½ζ and 1/6 of ζ × ΔV T to first order; the printed forms leave as much again."""
    T, rate = 0.01, EARTH
    zeta = rate * T
    velocity, moved = _turning_frame(T, rate)
    assert velocity.imag == pytest.approx(-zeta / 2 * T, rel=1e-6)
    assert moved.imag == pytest.approx(-zeta / 6 * T * T, rel=1e-6)
    micro_g = (zeta - zeta / 2) * 1e6
    assert micro_g == pytest.approx(0.36, abs=0.01)
    metres_a_second = (1 / 3 - 1 / 6) * zeta * G * T * T / T
    assert metres_a_second == pytest.approx(1.2e-8, rel=0.05)


def test_savage_98_eq_95() -> None:
    """For constant rate and force S_α × υ + α × S_υ is α × υ T; the sum is not even linear."""
    T, rate, force = 0.02, np.array([1.0, 0.2, 0]), np.array([0, 3.0, 1.0])
    alpha, upsilon, s_alpha, s_upsilon = rate * T, force * T, rate * T**2 / 2, force * T**2 / 2
    right = np.cross(s_alpha, upsilon) + np.cross(alpha, s_upsilon)
    assert right == pytest.approx(np.cross(alpha, upsilon) * T)
    printed = np.cross(s_alpha, upsilon) + alpha + s_upsilon
    assert printed != pytest.approx(right, rel=0.1)


@pytest.mark.parametrize(("printed", "exact"), [(False, True), (True, False)])
def test_savage_98_eq_105(printed: bool, exact: bool) -> None:
    """δR_scrlA of straight lines, T_l = 1, from the interval's start: ∫ δv_scul dt."""
    a, b, c, d = 0.3, 0.7, -0.2, 0.5  # rate a + b t about x, force c + d t along y
    d_alpha, d_alpha_past = a + b / 2, a - b / 2
    d_upsilon, d_upsilon_past = c + d / 2, c - d / 2
    s_alpha, s_upsilon = (5 * d_alpha + d_alpha_past) / 12, (5 * d_upsilon + d_upsilon_past) / 12
    first = -(d_alpha - d_alpha_past) / 12 * s_upsilon
    slope = d_upsilon - d_upsilon_past
    second = -(d_upsilon / 12 + d_upsilon_past if printed else slope / 12) * s_alpha
    computed = 0.5 * (first - second)  # y × x is -z
    # δv_scul(t) = ½ ∫ (α a - υ ω) = ½ (ad - bc) t³/6, whose integral over 0..1 is ½ (ad - bc)/24
    assert (computed == pytest.approx((a * d - b * c) / 48, rel=1e-12)) is exact


def test_savage_98_section_vi_flexure() -> None:
    """k x = m a and ω² = k/m: x = a/ω²."""
    omega = 2 * pi * 50
    assert G / omega**2 == pytest.approx(1e-4, rel=0.01)
    assert G * omega**2 == pytest.approx(970e3, rel=0.01)


def minor_intervals(samples: Array, taps: list[float]) -> tuple[Array, Array]:
    """θ of minor intervals of four samples (R, 3), and what their last one adds of products."""
    whole = samples.reshape(-1, 4, 3)
    back = sum(tap * whole[:, 3 - d] for d, tap in enumerate(taps, start=1))
    return whole.sum(axis=1), np.cross(back, whole[:, 3])


TAPS = [214 / 105, 92 / 105, 54 / 105]
"""Yang Eq. 12 for n = 4, p = 0."""


@pytest.mark.parametrize(("half", "left"), [(0.5, -0.11), (1.0, 2860.0)])
def test_yang_19f_and_20a(half: float, left: float) -> None:
    """Coning of 1° at 20 Hz, 1 kHz, M = 5: ½ of the products between minor intervals, or all."""
    a, omega, majors = radians(1.0), 2 * pi * 20.0, 50  # a second: 20 whole periods
    motion = Coning(a, omega)
    theta, within = minor_intervals(motion.increments(majors * 20, 1e-3)[:, :3], TAPS)
    alpha = np.cumsum(theta.reshape(majors, 5, 3), axis=1)
    between = np.cross(alpha[:, :-1], theta.reshape(majors, 5, 3)[:, 1:]).sum(axis=1)
    phi = alpha[:, -1] + within.reshape(majors, 5, 3).sum(axis=1) + half * between
    w, i, j, k = motion.attitude(np.zeros(1)).T
    x, y, z = rotation_vectors(running_attitude(phi)[-1:]).T
    turned = float(rotate((w, i, j, k), (x, y, z))[2].item())  # about the cone's axis
    assert degrees(turned) * 3600 == pytest.approx(left, rel=0.05)


@pytest.mark.parametrize("complete", [True, False])
def test_yang_18_and_20b(complete: bool) -> None:
    """1 rad/s with 30 m/s², 2 kHz, n = 4, M = 5: each minor ΔV is in its own body axes."""
    T, majors = 5e-4, 100
    spin = SpinAccel((0.0, 0.0, 1.0), (30.0, 0.0, 0.0))
    samples = spin.increments(majors * 20, T)
    theta, dv = (part.reshape(majors, 5, 4, 3).sum(axis=2) for part in np.split(samples, 2, 1))
    each = dv + 0.5 * np.cross(theta, dv)
    alpha = np.cumsum(theta, axis=1)
    summed = each.sum(axis=1)
    if complete:  # between minor intervals: the turn since the major interval's start
        summed = summed + np.cross(alpha[:, :-1], dv[:, 1:]).sum(axis=1)
    starts = np.concatenate(([[1.0, 0, 0, 0]], running_attitude(alpha[:, -1])[:-1]))
    w, i, j, k = starts.T
    x, y, z = summed.T
    reached = [float(axis.sum()) for axis in rotate((w, i, j, k), (x, y, z))]
    end = majors * 20 * T
    error = np.array(reached) - spin.velocity(np.array([end]))[0]
    a_second = float(np.linalg.norm(error)) / end
    assert a_second < 1e-3 if complete else a_second == pytest.approx(0.12, rel=0.05)
