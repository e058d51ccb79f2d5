"""What an alignment says it may be off is what it is off: Monte Carlo, coarse and fine."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import radians, sqrt

import numpy as np
import pytest
from numpy.typing import NDArray

from sculler_model.frames import (
    conjugate,
    from_euler,
    from_rotation_vector,
    product,
    to_dcm,
    to_euler,
    to_rotation_vector,
)
from sculler_model.host import MajorIncrements, velocity_rotation
from sculler_model.motion import Curve, Motion, Turn, X, Y, Z, at_rest
from sculler_model.navigation import SensorNoise, align, align_finely
from sculler_model.navigation.attitude_estimate import euler_sigmas
from tiers import few_of

Array = NDArray[np.float64]

H, RUNS = 500.0, 120
WITHIN = 0.2
"""Of the told sigmas; an rms of 120 runs itself scatters by 6 %."""
ROOT_HOUR = 60.0


@dataclass(frozen=True)
class Unit:
    """A unit at rest: noise densities in SI, counts (rad, m/s; 0: none), sway (rad)."""

    walk: float
    force: float
    counts: tuple[float, float] = (0.0, 0.0)
    sway: float = 0.0
    lat: float = radians(47.3)
    seconds: float = 300.0

    @property
    def interval(self) -> float:
        """600 of them, s."""
        return self.seconds / 600


STIM300 = Unit(radians(0.15) / ROOT_HOUR, 0.06 / ROOT_HOUR)
LASER = Unit(radians(0.002) / ROOT_HOUR, 2e-5, counts=(radians(0.1 / 3600), 125e-6 * 9.80665))
UNITS = {
    "stim300": STIM300,
    "laser gyro in counts": LASER,
    "the same on a table that sways": Unit(LASER.walk, 5e-5, LASER.counts, radians(0.05)),
    "navigation grade": Unit(radians(0.002) / ROOT_HOUR, 5e-5, lat=radians(-60)),
    "an hour": Unit(radians(0.01) / ROOT_HOUR, 5e-4, seconds=3600),
    "a minute, poor accelerometers": Unit(radians(0.01) / ROOT_HOUR, 5e-4, seconds=60),
}


@cache
def still(unit: Unit) -> tuple[Motion, MajorIncrements]:
    tilted = at_rest(unit.lat, 0.2, H, 0.1, -0.3, 0.7)
    turns = tilted.turns
    if unit.sway:
        turns += (
            Turn(X, Curve(waves=((unit.sway, 0.4, 0.3),))),
            Turn(Y, Curve((0.0, unit.sway / 300), ((unit.sway, 0.21, 0.0),))),
            Turn(Z, Curve(waves=((unit.sway, 0.33, 1.0),))),
        )
    where = Motion(unit.lat, 0.2, H, turns=turns)
    sums = where.increments(round(unit.seconds / unit.interval), unit.interval)
    alpha, upsilon = sums[:, :3], sums[:, 3:]
    return where, MajorIncrements(alpha, alpha, upsilon + velocity_rotation(alpha, upsilon))


def in_counts(increments: Array, size: float) -> Array:
    """As a counter sends them, the remainder carried."""
    if not size:
        return increments
    return np.diff(np.round(np.cumsum(increments, axis=0) / size) * size, axis=0, prepend=0.0)


def noisy(
    unit: Unit, rng: np.random.Generator, bias: float = 0, tilt: float = 0
) -> MajorIncrements:
    """The unit's increments with its noise, and biases drawn from their sigmas."""
    _, inc = still(unit)
    shape, angle, speed = inc.phi.shape, *unit.counts
    T = unit.interval
    gyro = rng.normal(size=shape) * unit.walk * sqrt(T) + rng.normal(size=3) * bias * T
    force = rng.normal(size=shape) * unit.force * sqrt(T) + rng.normal(size=3) * tilt * T
    phi = in_counts(inc.phi + gyro, angle)
    return MajorIncrements(phi, phi, in_counts(inc.dv_sf + force, speed))


def rms(rows: list[Array]) -> Array:
    found: Array = np.sqrt(np.mean(np.square(rows), axis=0))
    return found


def told_and_found(
    unit: Unit, noise: SensorNoise, bias: float = 0.0, tilt: float = 0.0
) -> dict[str, tuple[Array, Array]]:
    """Told sigmas and found errors, rms over the runs, of everything that is told with a sigma."""
    rng = np.random.default_rng(17)
    where, _ = still(unit)
    true = where.state(np.array([unit.seconds])).state(0).q
    told: dict[str, list[Array]] = {}
    found: dict[str, list[Array]] = {}

    def note(name: str, sigma: object, error: object) -> None:
        told.setdefault(name, []).append(np.array(sigma))
        found.setdefault(name, []).append(np.array(error))

    to_body = np.array(to_dcm(true)).T
    for _ in range(RUNS):
        state = rng.bit_generator.state
        block = noisy(unit, rng, bias, tilt)
        fine = align_finely(block, unit.interval, unit.lat, H, noise)
        for name, result in (("coarse", fine.coarse), ("fine", fine)):
            off = to_rotation_vector(product(result.q, conjugate(true)))
            note(f"{name}, north, east, down", result.sigma, off)
            note(
                f"{name}, roll, pitch, heading",
                result.euler_sigma,
                np.subtract(to_euler(result.q), to_euler(true)),
            )
        # what the biases were: the same draws
        again = np.random.default_rng()
        again.bit_generator.state = state
        again.normal(size=block.phi.shape)
        biases = to_body.T @ (again.normal(size=3) * bias)
        seen = np.array(fine.gyro_bias_sigma)
        known = np.isfinite(seen)
        off = np.array(to_dcm(fine.q)) @ fine.gyro_bias - biases
        note("gyro bias", seen[known], off[known])
    return {name: (rms(told[name]), rms(found[name])) for name in told}


@pytest.mark.parametrize("unit", few_of(UNITS, []))
def test_told_is_found_with_noise_that_the_window_shows(unit: Unit) -> None:
    for name, (told, found) in told_and_found(unit, SensorNoise()).items():
        assert told == pytest.approx(found, rel=WITHIN, abs=0), name


@pytest.mark.deep
def test_told_is_found_with_all_given() -> None:
    """Biases too: heading is off by the east one's, level by the accelerometers'."""
    bias, tilt = radians(0.05) / 3600, 3e-4
    unit = Unit(radians(0.01) / ROOT_HOUR, 1e-4)
    noise = SensorNoise(unit.walk, unit.force, bias, 1e-6, tilt)
    results = told_and_found(unit, noise, bias, tilt)
    assert len(results["gyro bias"][0]) == 3
    for name, (told, found) in results.items():
        assert told == pytest.approx(found, rel=WITHIN, abs=0), name


def test_the_case_of_a_stim300() -> None:
    """0.15 °/√h for 300 s at 47.3°: √(6/5) N/(Ω cos lat √T) = 3.1° coarse; N/(...) = 2.9° fine."""
    rng = np.random.default_rng(1)
    found = align_finely(noisy(STIM300, rng), 0.5, STIM300.lat, H, SensorNoise(STIM300.walk))
    scale = STIM300.walk / (7.292115e-5 * np.cos(STIM300.lat) * sqrt(300))
    assert found.coarse.heading_sigma == pytest.approx(sqrt(6 / 5) * scale, rel=0.03, abs=0)
    assert found.sigma[2] == pytest.approx(scale, rel=0.03, abs=0)
    assert any("heading is known to 3." in warning for warning in found.warnings)


def test_what_is_given_goes_before_what_is_seen() -> None:
    rng = np.random.default_rng(1)
    block = noisy(STIM300, rng)
    seen = align(block, 0.5, STIM300.lat, H).noise
    assert seen.angle_random_walk == pytest.approx(STIM300.walk, rel=0.2, abs=0)
    assert seen.velocity_random_walk == pytest.approx(STIM300.force, rel=0.3, abs=0)
    given = align(block, 0.5, STIM300.lat, H, noise=SensorNoise(1e-5)).noise
    assert given.angle_random_walk == 1e-5
    assert given.velocity_random_walk == seen.velocity_random_walk


@pytest.mark.parametrize("angles", [(0.3, -0.8, 2.0), (-2.0, 1.2, -3.0)])
def test_sigmas_of_euler_angles(angles: tuple[float, float, float]) -> None:
    """Against small rotations drawn from the covariance."""
    rng = np.random.default_rng(2)
    mix = rng.normal(size=(3, 3)) * 1e-5
    q = from_euler(*angles)
    drawn = [
        np.subtract(to_euler(product(from_rotation_vector(tuple(mix @ unit)), q)), to_euler(q))
        for unit in np.eye(3)
    ]
    expected = np.sqrt(np.sum(np.square(drawn), axis=0))
    assert euler_sigmas(q, mix @ mix.T) == pytest.approx(tuple(expected), rel=1e-3, abs=0)
