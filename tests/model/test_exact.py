"""Exact major increments against closed forms and finer chains."""

from __future__ import annotations

from math import radians

import numpy as np
import pytest

from host_path import chained
from sculler_model.frames import conjugate, product, to_rotation_vector
from sculler_model.host import velocity_rotation
from sculler_model.motion import Motion, at_rest, turn_motion
from sculler_model.navigation import exact, exact_increments


def test_at_rest_they_are_the_constant_rate_and_force() -> None:
    where = at_rest(radians(50), 1.0, 300.0, roll=0.3, pitch=-0.2, heading=2.5)
    found = exact_increments(where, 5, 10.0)
    sensed = 10.0 * where.sensed(np.zeros(1))
    alpha, upsilon = sensed[:, :3], sensed[:, 3:]
    assert np.abs(found.phi - alpha).max() < 1e-15
    assert np.abs(found.dv_sf - upsilon - velocity_rotation(alpha, upsilon)).max() < 1e-13


def test_long_intervals_are_short_ones_one_after_the_other() -> None:
    where: Motion = turn_motion(coning_half_angle=0.01, coning_hz=0.5, rocking=0.05, sculling_hz=1)
    coarse, fine = exact_increments(where, 3, 0.2), exact_increments(where, 60, 0.01)
    for number in range(3):
        part = fine[20 * number : 20 * number + 20]
        whole = chained((1.0, 0.0, 0.0, 0.0), part.phi)
        turned = chained((1.0, 0.0, 0.0, 0.0), coarse.phi[number : number + 1])
        apart = to_rotation_vector(product(whole, conjugate(turned)))
        assert np.abs(apart).max() < 1e-14


def test_many_go_block_by_block(monkeypatch: pytest.MonkeyPatch) -> None:
    where = turn_motion(coning_half_angle=0.01, coning_hz=0.5)
    whole = exact_increments(where, 20, 0.1)
    monkeypatch.setattr(exact, "_BLOCK", 7)
    found = exact_increments(where, 20, 0.1)
    assert np.array_equal(found.phi, whole.phi)
    assert np.array_equal(found.dv_sf, whole.dv_sf)


def test_none() -> None:
    assert len(exact_increments(turn_motion(), 0, 0.1)) == 0
