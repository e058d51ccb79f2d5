"""Fine alignment: as good as theory says the sensors allow, and it knows how good it is."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import cos, radians, sin, sqrt

import numpy as np
import pytest
from numpy.typing import NDArray

from sculler_model.errors import InputError
from sculler_model.frames import (
    EARTH_RATE,
    Quaternion,
    conjugate,
    gravity,
    product,
    to_dcm,
    to_rotation_vector,
)
from sculler_model.host import MajorIncrements, velocity_rotation
from sculler_model.motion import Motion, at_rest
from sculler_model.navigation import (
    NAVIGATION_GRADE,
    FineAlignment,
    SensorNoise,
    align_finely,
    navigate,
)

Array = NDArray[np.float64]

LAT, LON, H = radians(48.0), 0.2, 500.0
INTERVAL, SECONDS = 0.5, 300.0
COUNT = round(SECONDS / INTERVAL)
NORTH_RATE = EARTH_RATE * cos(LAT)
ARW = radians(0.002) / 60
"""0.002 °/√h."""


@cache
def rest(lat: float = LAT, heading: float = 0.3) -> tuple[Motion, MajorIncrements]:
    where = at_rest(lat, LON, H, 0.1, -0.05, heading)
    sums = where.increments(COUNT, INTERVAL)
    alpha, upsilon = sums[:, :3], sums[:, 3:]
    return where, MajorIncrements(alpha, alpha, upsilon + velocity_rotation(alpha, upsilon))


def true_q(where: Motion) -> Quaternion:
    return where.state(np.array([SECONDS])).state(0).q


def error(q: Quaternion, where: Motion) -> Array:
    """Attitude error (rad) about north, east, down at the end of the window."""
    return np.array(to_rotation_vector(product(q, conjugate(true_q(where)))))


def disturbed(
    inc: MajorIncrements, gyro: Array | float = 0.0, accel: Array | float = 0.0
) -> MajorIncrements:
    """With errors added to φ (rad) and ΔV (m/s)."""
    return MajorIncrements(inc.phi + gyro, inc.alpha + gyro, inc.dv_sf + accel)


@pytest.mark.parametrize("lat", [0.0, -33.0, 75.0])
@pytest.mark.parametrize("heading", [-3.0, 1.0])
def test_exact_data_give_the_exact_attitude(lat: float, heading: float) -> None:
    where, inc = rest(radians(lat), heading)
    found = align_finely(inc, INTERVAL, radians(lat), H)
    # the force's mean direction over an interval is its middle one to (ΩT)²/24
    assert np.abs(error(found.q, where)[:2]).max() < 1e-9
    assert abs(error(found.q, where)[2]) < 1e-9
    assert np.abs(found.gyro_bias).max() < 1e-12
    assert found.warnings == ()
    assert found.surprise < 1e-9
    assert found.state(radians(lat), LON, H, 7.0).time == 7.0 + SECONDS
    assert found.state(radians(lat), LON, H).q == found.q


@pytest.mark.deep
def test_random_walk_of_the_gyros_gives_the_heading_that_theory_says() -> None:
    """σ = N/(Ω cos lat √T): the walk's end over the time; `align`, a line fit, has √(6/5) of it."""
    rng = np.random.default_rng(5)
    where, inc = rest()
    noise = SensorNoise(ARW, 0.0, 0.0, 1e-5)
    fine, coarse, tilts = [], [], []
    for _ in range(80):
        walk = rng.normal(size=(COUNT, 3)) * ARW * sqrt(INTERVAL)
        found = align_finely(disturbed(inc, walk), INTERVAL, LAT, H, noise)
        fine.append(error(found.q, where)[2])
        coarse.append(error(found.coarse.q, where)[2])
        tilts.append((np.abs(error(found.q, where)[:2]), np.abs(error(found.coarse.q, where)[:2])))
    theory = ARW / (NORTH_RATE * sqrt(SECONDS))
    assert found.sigma[2] == pytest.approx(theory, rel=0.02, abs=0)
    assert np.std(fine) == pytest.approx(theory, rel=0.2, abs=0)
    assert np.std(fine) < np.std(coarse)
    # the coarse attitude carries half the window's walk in its level, the fine one next to none
    fine_tilt, coarse_tilt = np.mean(tilts, axis=0)
    assert np.all(fine_tilt < 0.2 * coarse_tilt)


def test_velocity_noise_gives_the_heading_that_a_parabola_fit_says() -> None:
    """Heading makes the velocity a parabola, g Ω cos lat ψ t²/2; its fit from n values of σ each
    is off by sqrt(180/n) σ/T² in t², or less, for here the beginning is known."""
    rng = np.random.default_rng(2)
    where, inc = rest()
    sigma = 5e-3
    noise = SensorNoise(0.0, 0.0, 0.0, sigma)
    errors = []
    for _ in range(60):
        shaken = np.diff(rng.normal(size=(COUNT + 1, 3)) * sigma, axis=0)
        found = align_finely(disturbed(inc, 0.0, shaken), INTERVAL, LAT, H, noise)
        errors.append(error(found.q, where)[2])
    fit = 2 * sigma * sqrt(180 / SECONDS) / (SECONDS**2 * gravity(sin(LAT), H) * NORTH_RATE)
    assert found.sigma[2] == pytest.approx(fit, rel=0.1, abs=0)
    assert np.std(errors) == pytest.approx(found.sigma[2], rel=0.25, abs=0)


def test_an_east_gyro_bias_turns_the_heading_and_is_reckoned_with() -> None:
    """bias/(Ω cos lat): 0.01 °/h at 48° is 1 mrad, which no alignment at rest can tell."""
    bias = radians(0.01) / 3600
    where, inc = rest()
    to_body = np.array(to_dcm(true_q(where))).T
    noise = SensorNoise(0.0, 0.0, bias, 1e-5)
    found = align_finely(disturbed(inc, to_body @ [0, bias * INTERVAL, 0]), INTERVAL, LAT, H, noise)
    expected = bias / NORTH_RATE
    assert abs(error(found.q, where)[2]) == pytest.approx(expected, rel=1e-2, abs=0)
    assert found.sigma[2] == pytest.approx(expected, rel=1e-2, abs=0)
    assert found.gyro_bias_sigma[1] == pytest.approx(bias, rel=1e-2, abs=0)


def test_the_other_gyro_biases_are_found() -> None:
    """North from the drift of the level, at a known latitude; down from the heading's."""
    north, down = radians(0.02) / 3600, radians(-0.03) / 3600
    where, inc = rest()
    to_body = np.array(to_dcm(true_q(where))).T
    noise = SensorNoise(0.0, 0.0, radians(0.03) / 3600, 1e-5)
    found = align_finely(
        disturbed(inc, to_body @ [north * INTERVAL, 0, down * INTERVAL]), INTERVAL, LAT, H, noise
    )
    n, e, d = np.array(to_dcm(true_q(where))) @ found.gyro_bias
    assert n == pytest.approx(north, rel=1e-2, abs=0)
    assert d == pytest.approx(down, rel=2e-2, abs=0)
    assert abs(e) < 0.01 * north
    assert found.gyro_bias_sigma[0] < 0.01 * north
    assert np.isfinite(found.gyro_bias_sigma).all()


def test_of_east_and_down_nothing_is_said_where_nothing_is_known_of_the_biases() -> None:
    _, inc = rest()
    found = align_finely(inc, INTERVAL, LAT, H, SensorNoise(0.0, 0.0, None, 1e-5))
    assert np.isfinite(found.gyro_bias_sigma).tolist() == [True, False, False]


def test_it_knows_how_good_it_is() -> None:
    """Everything at once: errors against their stated sigmas are unit normals, 3 x 60 of them."""
    rng = np.random.default_rng(11)
    where, inc = rest()
    noise = SensorNoise(ARW, 5e-5, radians(0.01) / 3600, 1e-3)
    shares, surprises = [], []
    for _ in range(60):
        bias = rng.normal(size=3) * noise.gyro_bias * INTERVAL
        walk = bias + rng.normal(size=(COUNT, 3)) * ARW * sqrt(INTERVAL)
        shaken = np.diff(rng.normal(size=(COUNT + 1, 3)) * noise.velocity_noise, axis=0)
        shaken += rng.normal(size=(COUNT, 3)) * noise.velocity_random_walk * sqrt(INTERVAL)
        found = align_finely(disturbed(inc, walk, shaken), INTERVAL, LAT, H, noise)
        shares.append(error(found.q, where) / found.sigma)
        surprises.append(found.surprise)
    assert np.mean(np.square(shares), axis=0) == pytest.approx([1, 1, 1], abs=0.45)
    assert np.mean(surprises) == pytest.approx(1, abs=0.03)


def test_navigation_goes_on_without_a_jump() -> None:
    """With navigation-grade noise: the first minutes' velocity is what tilt and noise allow."""
    rng = np.random.default_rng(3)
    _, inc = rest()
    walk = rng.normal(size=(COUNT, 3)) * ARW * sqrt(INTERVAL)
    found = align_finely(disturbed(inc, walk), INTERVAL, LAT, H, NAVIGATION_GRADE)
    track = navigate(found.state(LAT, LON, H), INTERVAL, inc[:240])
    level = 3 * max(found.sigma[:2])
    assert np.abs(track.v[:, :2]).max() < 9.8 * level * 120


def test_the_bias_found_is_taken_out() -> None:
    """0.02 °/h about north: 20 minutes later an order of magnitude less of it is left."""
    where, inc = rest()
    to_body = np.array(to_dcm(true_q(where))).T
    turned = to_body @ [radians(0.02) / 3600 * INTERVAL, 0, 0]
    biased = disturbed(inc, turned)
    found = align_finely(biased, INTERVAL, LAT, H, SensorNoise(0.0, 0.0, 1e-7, 1e-5))
    start = found.state(LAT, LON, H)
    with_it, without = (
        navigate(start, INTERVAL, [part] * 4)
        for part in (biased, found.corrected(biased, INTERVAL))
    )
    assert np.abs(without.v[:, :2]).max() < 0.1 * np.abs(with_it.v[:, :2]).max()
    assert np.array_equal(found.corrected(biased, INTERVAL).dv_sf, biased.dv_sf)


def test_an_odd_number_of_intervals() -> None:
    where, inc = rest()
    found = align_finely(inc[: COUNT - 1], INTERVAL, LAT, H)
    true = where.state(np.array([SECONDS - INTERVAL])).state(0).q
    assert np.abs(to_rotation_vector(product(found.q, conjugate(true)))).max() < 1e-9


def test_a_unit_that_moves_is_told() -> None:
    _, inc = rest()
    wild = np.random.default_rng(1).normal(size=(COUNT, 3)) * 0.02
    moved = disturbed(inc, 0.0, wild)
    found: FineAlignment = align_finely(moved, INTERVAL, LAT, H, NAVIGATION_GRADE)
    assert any(warning.startswith("velocity strays") for warning in found.warnings)


def test_the_warning_of_a_surprise_begins_at_twice_the_noise() -> None:
    _, inc = rest()
    found = align_finely(inc, INTERVAL, LAT, H)
    assert replace(found, surprise=4.0).warnings == ()
    (said,) = replace(found, surprise=4.41).warnings
    assert said.startswith("velocity strays 2.1 times as far as the stated noise")


def test_navigation_grade_is_what_its_words_say() -> None:
    """0.002 °/√h, 5 µg/√Hz (to 2 %), 0.01 °/h, 1 mm/s."""
    assert NAVIGATION_GRADE.angle_random_walk == pytest.approx(radians(0.002) / 60)
    assert NAVIGATION_GRADE.velocity_random_walk == pytest.approx(5e-6 * 9.80665, rel=0.02)
    assert NAVIGATION_GRADE.gyro_bias == pytest.approx(radians(0.01) / 3600)
    assert (NAVIGATION_GRADE.velocity_noise, NAVIGATION_GRADE.accel_bias) == (1e-3, None)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"accel_bias": float("inf")}, "accel_bias inf"),
        ({"angle_random_walk": -1e-9}, "angle_random_walk -1e-09"),
        ({"gyro_bias": float("nan")}, "gyro_bias nan"),
        ({"velocity_noise": 0.0}, "velocity_noise 0.0"),
    ],
)
def test_bad_noise_is_refused(change: dict[str, float], message: str) -> None:
    with pytest.raises(InputError, match=f"sensor noise: {message} is not allowed"):
        SensorNoise(**change)
