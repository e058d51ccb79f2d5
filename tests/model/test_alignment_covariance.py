"""The stated covariance of an alignment against what small errors of each interval do to it.

`align` is run once for each component of each interval's ΔV_SF and φ with a small error put in.
That gives its derivatives, and with independent errors of known size its covariance.
"""

from __future__ import annotations

from math import radians

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import minimize

from sculler_model.frames import conjugate, product, to_rotation_vector
from sculler_model.host import MajorIncrements, velocity_rotation
from sculler_model.motion import at_rest
from sculler_model.navigation import SensorNoise, align
from sculler_model.navigation.sensor_noise import _mean_walk, _modes, _most_likely

Array = NDArray[np.float64]

LAT, H, COUNT, T = radians(40.0), 300.0, 24, 20.0
SMALL = 1e-6


@pytest.fixture(scope="module")
def window() -> MajorIncrements:
    """A level unit that looks north."""
    sums = at_rest(LAT, 0.1, H, 0.0, 0.0, 0.0).increments(COUNT, T)
    alpha, upsilon = sums[:, :3], sums[:, 3:]
    return MajorIncrements(alpha, alpha, upsilon + velocity_rotation(alpha, upsilon))


@pytest.fixture(scope="module")
def derivatives(window: MajorIncrements) -> tuple[Array, Array]:
    """Of the attitude at the end, rad, by φ (rad) and by ΔV_SF (m/s): (R, 3 of it, 3 of these)."""
    exact = align(window, T, LAT, H).q

    def moved(phi: Array, dv_sf: Array) -> Array:
        found = align(MajorIncrements(phi, phi, dv_sf), T, LAT, H).q
        return np.array(to_rotation_vector(product(found, conjugate(exact)))) / SMALL

    by_phi, by_dv = np.empty((2, COUNT, 3, 3))
    for row in range(COUNT):
        for axis in range(3):
            error = np.zeros((COUNT, 3))
            error[row, axis] = SMALL
            by_dv[row, :, axis] = moved(window.phi, window.dv_sf + error)
            # a gyro whose error grows evenly over the interval turns its force by half of it
            turned = window.dv_sf + 0.5 * np.cross(error, window.dv_sf)
            by_phi[row, :, axis] = moved(window.phi + error, turned)
    return by_phi, by_dv


KINDS = {
    "walk": SensorNoise(3e-5, 0.0, 0.0, 1e-12, 0.0),
    "white": SensorNoise(0.0, 2e-4, 0.0, 1e-12, 0.0),
    "gyro bias": SensorNoise(0.0, 0.0, 4e-8, 1e-12, 0.0),
    "velocity": SensorNoise(0.0, 0.0, 0.0, 5e-3, 0.0),
    "accelerometer bias": SensorNoise(0.0, 0.0, 0.0, 1e-12, 6e-4),
    "all": SensorNoise(3e-6, 2e-4, 4e-8, 5e-3, 6e-4),
}


@pytest.mark.parametrize("kind", KINDS)
def test_the_covariance_is_that_of_the_derivatives(
    window: MajorIncrements, derivatives: tuple[Array, Array], kind: str
) -> None:
    noise = KINDS[kind]
    walk, white, bias, blue, tilt = (float(x or 0.0) for x in vars(noise).values())
    by_phi, by_dv = derivatives
    none = np.zeros((1, 3, 3))
    at_instants = np.diff(np.concatenate((none, by_dv, none)), axis=0)
    parts = [
        *(walk * T**0.5 * by_phi),
        *(white * T**0.5 * by_dv),
        *(blue * at_instants),
        bias * T * by_phi.sum(axis=0),
        tilt * T * by_dv.sum(axis=0),
    ]
    expected = sum(part @ part.T for part in parts)
    found = align(window, T, LAT, H, noise).covariance
    size = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    assert np.abs(found - expected).max() < 1e-3 * size.max()
    assert (np.abs(found - expected) < 1e-2 * size + 1e-18).all()


def test_modes_have_the_powers_of_the_three_kinds_of_noise() -> None:
    """By their covariances: of means of a Wiener process, of white noise, and of differences."""
    count = 12
    modes, spectra = _modes(count)
    place = np.arange(count)
    # cov of the means over steps i < j of W: i + 1/2; of one with itself: i + 1/3
    walk = np.minimum(place[:, None], place) + 0.5 - np.eye(count) / 6
    ends = np.diff(np.eye(count + 1), axis=0)
    for column, covariance in enumerate((walk, np.eye(count), ends @ ends.T)):
        power = np.diag(modes @ covariance @ modes.T)
        assert spectra[:, column] == pytest.approx(power, rel=1e-12)
    assert len(modes) == count - 2
    lines = np.stack((np.ones(count), place), axis=1)
    assert np.abs(modes @ lines).max() < 1e-12  # straight lines are of no account
    # and of the rest nothing is lost but the little that a line has of each mode
    assert np.linalg.matrix_rank(modes) == count - 2
    assert np.square(modes).sum(axis=1)[1:].min() > 0.5


@pytest.mark.parametrize("known", [None, 0.7])
def test_variances_are_those_of_most_likelihood(known: float | None) -> None:
    """Against a general minimiser; the first variance free, or known."""
    rng = np.random.default_rng(3)
    _, spectra = _modes(60)
    power = spectra @ np.array([0.5, 2.0, 0.3]) * rng.chisquare(2, len(spectra)) / 2

    def unlikely(logarithms: Array) -> float:
        variances = np.exp(logarithms)
        if known is not None:
            variances = np.concatenate(([known], variances))
        expected = spectra @ variances
        return float(np.sum(np.log(expected) + power / expected))

    start = np.zeros(3 if known is None else 2)
    best = minimize(unlikely, start, method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-12})
    if known is None:
        found = _most_likely(power, spectra)
    else:
        several = _most_likely(power, spectra, np.array([known, 2 * known]))
        assert several[:, 0].tolist() == [known, 2 * known]
        found = several[0, 1:]
    assert unlikely(np.log(found)) == pytest.approx(best.fun, abs=1e-3)


@pytest.mark.parametrize(("shown", "walk"), [(0.3, 0.3), (1.0, 1.0), (3.0, 0.3), (3.0, 0.01)])
def test_the_mean_walk_is_that_over_what_it_may_be(shown: float, walk: float) -> None:
    """Against a sum over many walks, the others of most likelihood by a general minimiser.

    The odds are 4 for what the gyros show, 1 for all up to it, 0.1 for all up to three times what
    explains the lowest modes.  A standard deviation within a quarter: 16 walks, few rounds each.
    """
    rng = np.random.default_rng(0)
    _, spectra = _modes(24)
    power = spectra @ np.array([walk**2, 1.0, 0.2]) * rng.chisquare(4, len(spectra)) / 4
    axes, others = 2, np.zeros(2)

    def unlikely(logarithms: Array, walk: float) -> float:
        expected = spectra @ np.array([walk * walk, *np.exp(logarithms)])
        return 0.5 * axes * float(np.sum(np.log(expected) + power / expected))

    def least(walk: float) -> float:
        nonlocal others
        options = {"xatol": 1e-3, "fatol": 1e-4}
        best = minimize(unlikely, others, (walk,), method="Nelder-Mead", options=options)
        others = best.x
        return float(best.fun)

    largest = 3 * float(np.sqrt((power[:4] / spectra[:4, 0]).max()))
    at_shown = least(shown)
    total, squares = 4.0, 4.0 * shown**2
    for limit, odds in ((shown, 1.0), (largest, 0.1)):
        walks = limit * (np.arange(40) + 0.5) / 40
        chances = np.exp(at_shown - np.array([least(each) for each in walks.tolist()]))
        total += odds * float(chances.mean())
        squares += odds * float((chances * walks**2).mean())
    found = 1e10 * _mean_walk(1e-10 * power, spectra, axes, 1e-5 * shown)  # of tilts in rad
    assert np.sqrt(found) == pytest.approx(np.sqrt(squares / total), rel=0.25)
