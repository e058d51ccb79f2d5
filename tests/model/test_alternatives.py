"""Other forms of the navigator's equations: the same, or worse by what the closed form says."""

from __future__ import annotations

from math import radians

import numpy as np
import pytest
from numpy.typing import NDArray

from host_path import fine_design
from sculler_model.errors import InputError
from sculler_model.fast import FastModel
from sculler_model.frames import (
    dcm_of_rotation_vector,
    from_rotation_vector,
    matrix_product,
    orthonormalised,
    to_dcm,
)
from sculler_model.host import major_increments
from sculler_model.motion import MOTIONS, SpinAccel, at_rest, over_the_pole, turn_motion
from sculler_model.navigation import NavHistory, Navigator, exact_increments
from sculler_model.navigation.compiled import compiled_run
from sculler_model.samples import Quantiser

Array = NDArray[np.float64]

TURN = turn_motion(rocking=0.05, sculling_hz=0.5)


def flown(seconds: float, T: float = 0.05, **options: object) -> tuple[NavHistory, NavHistory]:
    count = round(seconds / T)
    true = TURN.state(T * np.arange(count + 1))
    navigator = Navigator(true.state(0), T, **options)  # type: ignore[arg-type]
    return navigator.run(exact_increments(TURN, count, T)), true


@pytest.mark.parametrize("size", [0.0, 1e-9, 0.00999, 0.01001, 0.7, 3.1, 9.0])
def test_direction_cosines_of_a_rotation_vector(size: float) -> None:
    """Against those of its quaternion."""
    phi = (0.48 * size, -0.6 * size, 0.64 * size)
    expected = np.array(to_dcm(from_rotation_vector(phi)))
    assert np.abs(np.array(dcm_of_rotation_vector(phi)) - expected).max() < 5e-16


def test_a_step_towards_orthonormality_squares_the_error() -> None:
    c = dcm_of_rotation_vector((0.3, -0.8, 1.2))
    off = np.array(c) + 1e-5 * np.array([[1, -2, 3], [0.5, 1, -1], [2, 0, -3]])
    rows = tuple(tuple(row) for row in off.tolist())
    better = orthonormalised(rows)  # type: ignore[arg-type]
    transposed = tuple(zip(*better, strict=True))
    found = np.array(matrix_product(transposed, better))  # type: ignore[arg-type]
    assert 1e-10 < np.abs(found - np.eye(3)).max() < 3e-9


def test_cosines_are_the_quaternion_to_rounding() -> None:
    """Savage-20 Eq. 1: turning, rocking flight, 1,000 updates."""
    quaternion, _ = flown(50.0)
    cosines, true = flown(50.0, attitude="cosines")
    same = np.sign((cosines.q * quaternion.q).sum(1))[:, None]
    assert np.abs(cosines.q - same * quaternion.q).max() < 5e-14
    assert np.abs(cosines.v - quaternion.v).max() < 1e-11
    assert np.abs(np.abs((cosines.q * true.q[1:]).sum(1)) - 1).max() < 1e-14


@pytest.mark.parametrize("attitude", ["quaternion", "cosines"])
def test_a_level_frame_that_turns_seldom_costs_half_of_its_turn_squared(attitude: str) -> None:
    """At rest ζ grows to ΩkT: I - ζ× lacks ½ ζ×(ζ×f), upward ½ (ζ cos φ)² g too much.

    The mean of ζ² over k intervals at jΩT, j < k, is (ΩT)² (k-1)(2k-1)/6.
    """
    lat, T, every = radians(40), 1.0, 60
    where = at_rest(lat, 0.1, 200.0)
    increments = exact_increments(where, 600, T)
    start = where.state(np.zeros(1)).state(0)
    slow = Navigator(start, T, attitude=attitude, level_every=every).run(increments)  # type: ignore[arg-type]
    usual = Navigator(start, T).run(increments)
    assert np.abs(slow.q - usual.q).max() < 1e-6
    share = (every - 1) * (2 * every - 1) / 6
    excess = 0.5 * 9.8 * (7.292115e-5 * T * np.cos(lat)) ** 2 * share
    x = 600 * np.sqrt(2 * 9.8 / 6.378e6)  # what a free vertical channel makes of it
    gained = 600 * excess * np.sinh(x) / x
    assert usual.v[-1, 2] - slow.v[-1, 2] == pytest.approx(gained, rel=0.02)


@pytest.mark.deep
def test_free_azimuth_is_the_wander_azimuth_but_for_its_frame() -> None:
    """North-east-down states are the same; the frame turns by the Earth's vertical rate more."""
    wander, _ = flown(30.0)
    free, _ = flown(30.0, azimuth="free")
    assert np.abs(free.q - wander.q).max() < 1e-9
    assert np.abs(free.v - wander.v).max() < 1e-6
    turned = free.wander[-1] - wander.wander[-1]
    assert turned == pytest.approx(7.292115e-5 * np.sin(TURN.lat) * 30, rel=1e-3)
    if compiled_run() is not None:
        count = 600
        inc, start = exact_increments(TURN, count, 0.05), TURN.state(np.zeros(1)).state(0)
        compiled = Navigator(start, 0.05, azimuth="free").run(inc, compiled=True)
        assert np.array_equal(compiled.q, free.q)


@pytest.mark.parametrize("lat", [40.0, -70.0])
def test_free_azimuth_at_rest_turns_by_the_earths_vertical_rate(lat: float) -> None:
    """It stands still among the stars: Ω sin φ t, but for mm by the extrapolation."""
    where = at_rest(radians(lat), 0.1, 200.0, heading=1.0)
    increments, start = exact_increments(where, 300, 2.0), where.state(np.zeros(1)).state(0)
    found = Navigator(start, 2.0, azimuth="free").run(increments)
    turned = 7.292115e-5 * np.sin(radians(lat)) * 2.0 * np.arange(1, 301)
    assert np.abs(found.wander - turned).max() < 1e-10
    assert np.abs(found.euler[:, 2] - 1.0).max() < 1e-10
    assert np.abs(found.lat - start.lat).max() * 6.4e6 < 2e-3
    assert np.abs(found.v).max() < 1e-5


def test_free_azimuth_over_the_pole() -> None:
    motion = over_the_pole(before=60.0)
    count, T = 240, 0.5
    true = motion.state(T * np.arange(count + 1))
    found = Navigator(true.state(0), T, azimuth="free").run(exact_increments(motion, count, T))
    assert np.abs(found.h - true.h[1:]).max() < 1e-3
    assert abs(found.lat[-1] - true.lat[-1]) * 6.4e6 < 1e-3


def test_the_cheap_rotation_compensation_leaves_what_its_next_term_is() -> None:
    """Eq. 39 against Eq. 51, Eq. 86 against Eq. 99, at constant rate and force: α×(α×υ)/6, and
    α×(S_α×υ + α×S_υ)/24 = T α×(α×υ)/24."""
    spin, T, per = SpinAccel(rate=(0.3, -0.5, 0.9), force=(2.0, 30.0, -4.0)), 0.02, 20
    design = fine_design(1, 1, per, per / T, 1e-12, 1e-9, position="high-resolution")
    block = FastModel(design).feed(Quantiser(design)(spin.increments(4 * per, T / per)))
    exact = major_increments(design, block)[1:]
    cheap = major_increments(design, block, rotation="first-order")[1:]
    assert exact.dr_sf is not None
    assert cheap.dr_sf is not None
    rate, force = np.array(spin.rate), np.array(spin.force)
    twice = np.cross(rate, np.cross(rate, force))
    assert np.allclose(exact.dv_sf - cheap.dv_sf, T**3 / 6 * twice, rtol=0.02, atol=2e-8)
    assert np.allclose(exact.dr_sf - cheap.dr_sf, T**4 / 24 * twice, rtol=0.02, atol=2e-10)
    with pytest.raises(InputError, match="rotation: 'none' is not allowed"):
        major_increments(design, block, rotation="none")  # type: ignore[arg-type]


def test_spin_accel_over_the_earth_is_its_closed_form() -> None:
    rate, force = (0.2, -0.1, 0.4), (2.0, 1.0, -3.0)
    motion = MOTIONS["spin-accel"].make(
        0.8, 0.2, 500.0, roll_rate=0.2, pitch_rate=-0.1, yaw_rate=0.4, forward=2, right=1, down=-3
    )
    closed, t = SpinAccel(rate, force), np.array([0.0, 0.7, 3.0, 20.0])
    path = np.stack((motion.north(t), motion.east(t), -motion.up(t)), 1)
    assert np.allclose(path, closed.position(t), rtol=1e-12, atol=1e-12)
    speed = np.stack((motion.north(t, 1), motion.east(t, 1), -motion.up(t, 1)), 1)
    assert np.allclose(speed, closed.velocity(t), rtol=1e-12, atol=1e-12)
    assert np.allclose(np.abs((motion.state(t).q * closed.attitude(t)).sum(1)), 1, atol=1e-12)
    assert np.allclose(motion.sensed(t)[:, :3], rate, atol=2e-4)  # but for the Earth's
    straight = MOTIONS["spin-accel"].make(0.8, 0.2, 500.0, yaw_rate=0.0, forward=2.0)
    assert straight.north(t) == pytest.approx(t * t)


def test_a_whole_float_counts_intervals_too() -> None:
    inc, start = exact_increments(TURN, 8, 0.05), TURN.state(np.zeros(1)).state(0)
    for name in ("position_every", "level_every"):
        one, other = (
            Navigator(start, 0.05, **{name: every}).run(inc)  # type: ignore[arg-type]
            for every in (4, 4.0)
        )
        assert np.array_equal(one.v, other.v)
        assert not np.array_equal(one.v, Navigator(start, 0.05).run(inc).v)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"level_every": 0}, "level every 0 intervals is not allowed"),
        ({"level_every": 1.5}, "level every 1.5 intervals is not allowed"),
        ({"position_every": 2.5}, "position every 2.5 intervals is not allowed"),
        ({"azimuth": "north"}, "give wander or free"),
        ({"attitude": "euler"}, "quaternion or cosines"),
        ({"attitude": "cosines", "compiled": True}, "compiled: not with cosines"),
    ],
)
def test_what_is_refused(options: dict[str, object], message: str) -> None:
    start = TURN.state(np.zeros(1)).state(0)
    with pytest.raises(InputError, match=message):
        Navigator(start, 0.05, **options)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="compiled: not with cosines"):
        Navigator(start, 0.05, level_every=2).run(exact_increments(TURN, 2, 0.05), compiled=True)
