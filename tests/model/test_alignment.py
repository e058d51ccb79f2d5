"""Alignment at rest: exact on exact data, and with errors what the theory of errors says."""

from __future__ import annotations

from math import degrees, radians, sqrt

import numpy as np
import pytest
from numpy.typing import NDArray

from sculler_model.errors import InputError
from sculler_model.frames import EARTH_RATE, conjugate, gravity, product, to_dcm, to_rotation_vector
from sculler_model.host import MajorIncrements, velocity_rotation
from sculler_model.motion import Curve, Motion, Turn, X, Y, Z, at_rest
from sculler_model.navigation import Alignment, SensorNoise, align, navigate
from sculler_model.navigation.alignment import _means, _noise_shown

LAT, LON, H = radians(48.0), 0.2, 500.0
INTERVAL = 0.5


def rest(
    seconds: float = 300.0,
    lat: float = LAT,
    heading: float = 1.0,
    roll: float = 0.0,
    pitch: float = 0.0,
    gyro_bias: NDArray[np.float64] | float = 0.0,
    accel_bias: NDArray[np.float64] | float = 0.0,
) -> tuple[Motion, MajorIncrements]:
    """A unit at rest and its major increments, biases (rad/s, m/s²) in body axes."""
    where = at_rest(lat, LON, H, roll, pitch, heading)
    sums = where.increments(round(seconds / INTERVAL), INTERVAL)
    alpha = sums[:, :3] + np.asarray(gyro_bias) * INTERVAL
    upsilon = sums[:, 3:] + np.asarray(accel_bias) * INTERVAL
    return where, MajorIncrements(alpha, alpha, upsilon + velocity_rotation(alpha, upsilon))


def error(found: Alignment, where: Motion) -> NDArray[np.float64]:
    """Attitude error (rad) in north-east-down at the end of the window."""
    true = where.state(np.array([found.seconds])).state(0).q
    return np.array(to_rotation_vector(product(found.q, conjugate(true))))


def limits(seconds: float, lat: float) -> tuple[float, float]:
    """What level and heading may be off (rad) with exact data.

    Level: the force's mean direction over an interval is its middle one to (ΩT)²/24.  Heading: the
    eigenvector's rounding over the square of gravity's swing.
    """
    swing = EARTH_RATE * np.cos(lat) * seconds / sqrt(12)
    return (EARTH_RATE * INTERVAL) ** 2 / 12, 1e-10 + 2e-15 / swing**2


def true_down(where: Motion) -> NDArray[np.float64]:
    """Down, in the body frame."""
    return np.array(to_dcm(where.state(np.zeros(1)).state(0).q))[2]


@pytest.mark.parametrize("lat", [0.0, 34.0, -33.0, 70.0, 85.0])
@pytest.mark.parametrize(
    ("heading", "roll", "pitch"),
    [(0.0, 0.0, 0.0), (1.6, 0.1, -0.2), (-3.1, -3.0, 0.3), (-0.7, 1.5, 1.4)],
)
def test_exact_data_give_the_exact_attitude(
    lat: float, heading: float, roll: float, pitch: float
) -> None:
    where, inc = rest(lat=radians(lat), heading=heading, roll=roll, pitch=pitch)
    found = align(inc, INTERVAL, radians(lat), H)
    level, turned = limits(300.0, radians(lat))
    assert np.abs(error(found, where)).max() < max(level, turned)
    assert np.abs(np.array(to_dcm(found.q))[2] - true_down(where)).max() < level
    assert found.latitude == pytest.approx(radians(lat), abs=1e-8)
    assert found.rate == pytest.approx(EARTH_RATE, rel=1e-8, abs=0)
    assert found.specific_force == pytest.approx(found.gravity, rel=1e-10, abs=0)
    assert found.warnings == ()
    assert found.heading_sigma < 1e-10


@pytest.mark.parametrize("seconds", [10.0, 3600.0, 6 * 3600.0])
def test_any_window(seconds: float) -> None:
    where, inc = rest(seconds, heading=2.0, roll=0.05)
    found = align(inc, INTERVAL, LAT, H)
    assert np.abs(error(found, where)).max() < limits(seconds, LAT)[1]
    assert found.warnings == ()


@pytest.mark.parametrize("heading", [0.0, 1.0, 2.5, -2.0])
def test_an_east_gyro_bias_turns_the_heading(heading: float) -> None:
    """Heading error -ε_E / (Ω cos lat): 0.01 °/h at 48° is 1 mrad."""
    bias = radians(0.01) / 3600
    C_nb = np.array(to_dcm(at_rest(LAT, LON, H, heading=heading).state(np.zeros(1)).state(0).q))
    where, inc = rest(heading=heading, gyro_bias=C_nb.T @ [0, bias, 0])
    turned = error(align(inc, INTERVAL, LAT, H), where)
    assert abs(turned[2]) == pytest.approx(bias / (EARTH_RATE * np.cos(LAT)), rel=1e-2, abs=0)
    where, inc = rest(heading=heading, gyro_bias=C_nb.T @ [bias, 0, 0])
    assert abs(error(align(inc, INTERVAL, LAT, H), where)[2]) < 2e-5


def test_an_accelerometer_bias_tilts_the_level() -> None:
    bias = 50e-6 * 9.81
    where, inc = rest(heading=0.0, accel_bias=np.array([bias, 0, 0]))
    found = align(inc, INTERVAL, LAT, H)
    assert np.abs(error(found, where)[1]) == pytest.approx(
        bias / gravity(np.sin(LAT), H), rel=1e-2, abs=0
    )
    # and it stands still by its own lights, for the tilt balances the bias: 0.15 m/s without
    inc = rest(600.0, heading=0.0, accel_bias=np.array([bias, 0, 0]))[1][600:]
    track = navigate(found.state(LAT, LON, H), INTERVAL, inc)
    assert np.abs(track.v[:, :2]).max() < 3e-3
    assert track.time[0] == 300


def test_gyro_noise_gives_the_heading_that_theory_says() -> None:
    """White rate noise N: the slope of a random walk, σ = sqrt(6/5) N / (Ω cos lat √T)."""
    density = radians(0.002) / 60  # 0.002 °/√h
    rng = np.random.default_rng(5)
    seconds, headings, sigmas = 300.0, [], []
    where, inc = rest(seconds, heading=0.3)
    for _ in range(60):
        noise = rng.normal(size=inc.phi.shape) * density * sqrt(INTERVAL)
        found = align(
            MajorIncrements(inc.phi + noise, inc.alpha + noise, inc.dv_sf), INTERVAL, LAT, H
        )
        headings.append(error(found, where)[2])
        sigmas.append(found.heading_sigma)
    theory = sqrt(6 / 5) * density / (EARTH_RATE * np.cos(LAT) * sqrt(seconds))
    assert np.sqrt(np.mean(np.square(headings))) == pytest.approx(theory, rel=0.25, abs=0)
    assert np.mean(sigmas) == pytest.approx(theory, rel=0.05, abs=0)


def test_sway_does_not_disturb() -> None:
    """Rocking of ±0.05° that ends elsewhere than it began: 0.6 °/h if taken for rate."""
    sway = radians(0.05)
    still = at_rest(LAT, LON, H, heading=2.0, roll=0.02)
    where = Motion(
        LAT,
        LON,
        H,
        turns=(
            *still.turns,
            Turn(X, Curve(waves=((sway, 0.1, 0.3),))),
            Turn(Y, Curve((0.0, sway / 300), ((sway, 0.017, 0.0),))),
            Turn(Z, Curve(waves=((sway, 0.3, 1.0),))),
        ),
    )
    interval, count = 0.05, 6000
    sums = where.increments(count, interval)
    alpha, upsilon = sums[:, :3], sums[:, 3:]
    inc = MajorIncrements(alpha, alpha, upsilon + velocity_rotation(alpha, upsilon))
    found = align(inc, interval, LAT, H)
    assert np.abs(error(found, where)).max() < 1e-6


def test_means_over_at_most_128_parts() -> None:
    """As long as they must be, the odd first values left out."""
    for count, each, first in ((10, 1, 0.0), (128, 1, 0.0), (129, 2, 1.5), (300, 3, 1.0)):
        found, step = _means(np.arange(float(count))[:, None], 0.5)
        parts = count // each
        assert step == 0.5 * each
        assert found[:, 0].tolist() == [first + each * k for k in range(parts)]


def test_noise_is_of_the_same_steps_for_gyros_and_level() -> None:
    """601 intervals are 120 steps of five: the first interval is of no account."""
    rng = np.random.default_rng(3)
    phi, level = 1e-5 * rng.normal(size=(601, 3)), 1e-3 * rng.normal(size=(601, 3))
    inc = MajorIncrements(phi, phi, phi)
    found, count, step = _noise_shown(inc, 0.5, level, 9.8, SensorNoise())
    assert (count, step) == (120, 2.5)
    other, *_ = _noise_shown(inc[1:], 0.5, level[1:], 9.8, SensorNoise())
    for one, same in zip(vars(found).values(), vars(other).values(), strict=True):
        assert (one is None) == (same is None)
        assert one is None or one == pytest.approx(same, rel=1e-6)


def test_too_short_is_refused() -> None:
    _, inc = rest(9.5)
    with pytest.raises(InputError, match=r"9.5 s of data in 19 major intervals is too short"):
        align(inc, INTERVAL, LAT, H)
    with pytest.raises(InputError, match="in 9 major intervals is too short"):
        align(inc[:9], 100.0, LAT, H)


def test_wrong_force_is_refused() -> None:
    _, inc = rest()
    wrong = MajorIncrements(inc.phi, inc.alpha, 1.03 * inc.dv_sf)
    with pytest.raises(InputError, match=r"more than 2 % off gravity .* accelerometer's LSB"):
        align(wrong, INTERVAL, LAT, H)


def test_turning_is_refused() -> None:
    _, inc = rest(gyro_bias=np.array([0, 0, radians(0.5)]))
    with pytest.raises(InputError, match="over 100 times Earth's"):
        align(inc, INTERVAL, LAT, H)


def test_at_the_pole_is_refused() -> None:
    _, inc = rest(lat=radians(89.9))
    with pytest.raises(InputError, match=r"latitude 89.9° .* too small to find north"):
        align(inc, INTERVAL, radians(89.9), H)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"gyro_bias": np.array([0.0, 0.0, radians(0.5) / 3600])}, ["vertical rate"]),
        ({"gyro_bias": np.array([radians(1) / 3600, 0, 0]), "heading": 0.0}, ["horizontal rate"]),
        ({"accel_bias": np.array([0, 0, 0.02])}, ["specific force"]),
    ],
)
def test_warnings_name_what_is_off(change: dict[str, object], words: list[str]) -> None:
    _, inc = rest(**change)  # type: ignore[arg-type]
    warnings = align(inc, INTERVAL, LAT, H).warnings
    assert [w for word in words for w in warnings if w.startswith(word)] == list(warnings)


def test_bad_gyros_are_said_to_scatter() -> None:
    _, inc = rest()
    noise = np.random.default_rng(1).normal(size=inc.phi.shape) * radians(0.15) / 60 * INTERVAL**0.5
    noisy = MajorIncrements(inc.phi + noise, inc.alpha, inc.dv_sf)
    found = align(noisy, INTERVAL, LAT, H)
    assert degrees(found.heading_sigma) > 0.57
    assert any("heading is known to" in warning for warning in found.warnings)
