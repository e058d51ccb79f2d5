"""Alignment by the host in C: Python's result to rounding, and refusals in the same words."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sculler.host_c import HostInC, align_finely_in_c, align_in_c
from sculler_model.design import STATUS_SHORT_HISTORY, Design
from sculler_model.errors import InputError
from sculler_model.frames import EARTH_RATE, conjugate, product, to_rotation_vector
from sculler_model.host import MajorIncrements
from sculler_model.motion import at_rest
from sculler_model.navigation import (
    ESTIMATED,
    SensorNoise,
    align,
    align_finely,
    constant_gravity,
    exact_increments,
)

pytestmark = pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc")

DESIGN = Design.preset("stim300")
T = DESIGN.major_interval
KNOWN = SensorNoise(3e-6, 1e-3, 1e-8, 1e-4, 1e-4)


def window(seconds: float, lat: float, seed: int = 5) -> MajorIncrements:
    """A noisy unit at rest, sway of the velocity's counts included."""
    count, random = round(seconds / T), np.random.default_rng(seed)
    exact = exact_increments(at_rest(lat, 0.2, 300.0, 0.02, -0.03, 1.0), count, T)
    counts = 1e-4 * np.diff(random.normal(size=(count + 1, 3)), axis=0)
    return replace(
        exact,
        phi=exact.phi + 3e-7 * random.normal(size=(count, 3)),
        dv_sf=exact.dv_sf + 1e-4 * random.normal(size=(count, 3)) + counts,
    )


def turn(one: Any, other: Any) -> float:
    """Angle between two attitudes, rad."""
    return float(np.linalg.norm(to_rotation_vector(product(one.q, conjugate(other.q)))))


@pytest.mark.parametrize("noise", [ESTIMATED, KNOWN], ids=["estimated", "known"])
@pytest.mark.parametrize(("seconds", "lat"), [(10.57, 0.8), (60.0, -0.4), (150.0, 0.9)])
def test_both_stages(seconds: float, lat: float, noise: SensorNoise) -> None:
    """The coarse one in q is an eigenvector whose gap is (Ω t)²/12: rounding grows by that."""
    whole = window(seconds, lat)
    gravity = constant_gravity(9.81) if noise is KNOWN else None
    options = {} if gravity is None else {"gravity": gravity}
    expected = align_finely(whole, T, lat, 300.0, noise, **options)
    found = align_finely_in_c(HostInC(DESIGN), whole, lat, 300.0, noise, **options)
    coarse = align_in_c(HostInC(DESIGN), whole, lat, 300.0, noise, **options)
    rounding = 2e-15 * 12 / (EARTH_RATE * seconds) ** 2
    assert turn(coarse, expected.coarse) < rounding
    assert found.coarse.q == coarse.q
    assert turn(found, expected) < rounding
    assert found.warnings == expected.warnings
    for one, other in ((coarse, expected.coarse), (found, expected)):
        size = np.abs(other.covariance).max()
        np.testing.assert_allclose(one.covariance, other.covariance, rtol=0, atol=1e-11 * size)
    for name in ("seconds", "horizontal_rate", "down_rate", "specific_force", "gravity"):
        assert getattr(coarse, name) == pytest.approx(getattr(expected.coarse, name), rel=1e-11)
    for name, value in vars(expected.coarse.noise).items():
        assert value is None or getattr(coarse.noise, name) == pytest.approx(value, rel=1e-9), name
    size = float(np.linalg.norm(expected.gyro_bias))
    # of 10 s it comes of differences that rounding moves by 1e-7 of it, more or less by machine
    assert found.gyro_bias == pytest.approx(expected.gyro_bias, abs=3e-7 * size)
    sigma = expected.gyro_bias_sigma
    assert found.gyro_bias_sigma == pytest.approx(sigma, rel=1e-9, nan_ok=True)
    assert found.surprise == pytest.approx(expected.surprise, rel=1e-9)


@pytest.mark.parametrize(
    ("change", "lat"),
    [
        (lambda whole: whole[:900], 0.8),
        (lambda whole: whole, 1.57),
        (lambda whole: replace(whole, phi=whole.phi + 1e-4), 0.8),
        (lambda whole: replace(whole, dv_sf=1.03 * whole.dv_sf), 0.8),
        (lambda whole: replace(whole, status=np.full(len(whole), STATUS_SHORT_HISTORY)), 0.8),
    ],
    ids=["short", "pole", "turning", "moving", "history"],
)
def test_refusals(change: Callable[[MajorIncrements], MajorIncrements], lat: float) -> None:
    whole = change(window(12.0, 0.8))
    with pytest.raises(InputError) as expected:
        align(whole, T, lat, 300.0)
    with pytest.raises(InputError) as found:
        align_in_c(HostInC(DESIGN), whole, lat, 300.0)
    assert str(found.value) == str(expected.value)


def test_what_is_not_finite_is_refused() -> None:
    whole = window(12.0, 0.8)
    whole.phi[500, 1] = np.nan
    with pytest.raises(InputError, match=r"cannot be aligned on \(error 3\)"):
        align_in_c(HostInC(DESIGN), whole, 0.8, 300.0)
