"""The first seconds' specific force: what is told, and what is not."""

from __future__ import annotations

from math import cos, radians, sin

import numpy as np
import pytest
from numpy.typing import NDArray

from sculler.checks.first_seconds import PLAIN, FirstSeconds
from sculler_model.frames import AxisMap, from_euler, gravity
from sculler_model.host import MajorIncrements
from sculler_model.motion import at_rest, turn_motion
from sculler_model.navigation import NavState, constant_gravity, exact_increments

Array = NDArray[np.float64]

G = float(gravity(sin(0.8), 400.0))
T = 0.01


def start(
    roll: float = 0.0, pitch: float = 0.0, v: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> NavState:
    return NavState(0.0, from_euler(radians(roll), radians(pitch), 1.0), v, 0.8, 0.1, 400.0)


def said(state: NavState, force: Array, seconds: float = 3.0, axes: AxisMap = PLAIN) -> str | None:
    """Of so many seconds of a steady force (m/s²) in the body."""
    count = round(seconds / T)
    block = MajorIncrements(*np.zeros((2, count, 3)), np.tile(force * T, (count, 1)))
    seen = FirstSeconds(state, T, axes=axes)
    for first in range(0, count, 70):
        seen.see(block[first : first + 70])
    return seen.warning


def up(size: float = G, roll: float = 0.0, pitch: float = 0.0) -> Array:
    """A still unit's force in the body at this roll and pitch, degrees."""
    a, b = radians(roll), radians(pitch)
    return size * np.array([sin(b), -cos(b) * sin(a), -cos(b) * cos(a)])


@pytest.mark.parametrize(
    ("size", "words"),
    [
        (
            0.5 * G,
            ("4.903 m/s²", "gravity 9.806", "0.5 of it", "of the design is half"),
        ),
        (2 * G, ("19.61 m/s²", "2 of it", "sample rate of the design is twice")),
        (1.0, ("0.102 of it", "unit is g")),
        (G * 9.80665, ("9.81 of it", "unit is m/s²")),
        (G / 0.3048, ("3.28 of it", "feet")),
        (1.07 * G, ("10.49 m/s²", "1.07 of it", "check the accelerometer's LSB")),
        (0.94 * G, ("0.94 of it", "check the accelerometer's LSB")),
    ],
)
def test_a_wrong_size_names_both_figures_and_a_cause(size: float, words: tuple[str, ...]) -> None:
    warning = said(start(2.0, -3.0), up(size, 2.0, -3.0))
    assert warning is not None
    assert all(word in warning for word in words)


def test_upside_down_is_told_with_the_maps_to_try() -> None:
    warning = said(start(), -up())
    assert warning is not None
    assert "180° from up" in warning
    assert "try --axes x,-y,-z (forward, left, up) or y,x,-z (right, forward, up)" in warning
    turned = said(start(), -up(), axes=AxisMap.parse("y,x,-z"))
    assert turned is not None
    assert "check --axes, --roll and --pitch" in turned


def test_an_attitude_that_the_force_contradicts() -> None:
    warning = said(start(), up(G, 12.0, -7.0))
    assert warning is not None
    assert "14° from up" in warning
    assert "roll 12.0°, pitch -7.0°" in warning


@pytest.mark.parametrize("roll", [0.0, 30.0, 180.0])
def test_a_still_unit_as_it_should_be(roll: float) -> None:
    assert said(start(roll), up(1.02 * G, roll)) is None  # a poor accelerometer
    assert said(start(roll), up(G, roll + 3)) is None  # a rough attitude


@pytest.mark.parametrize(
    "force",
    [
        up() + np.array([3.0, 0.0, 0.0]),  # it speeds up
        up(G / cos(radians(60)), 0.0),  # a turn with 60° of bank
        up(1.5 * G),  # it pulls up
        up(0.9 * G),
        0 * up(),  # a throw
    ],
)
def test_a_start_under_way_may_do_as_it_likes(force: Array) -> None:
    bank = 60.0 if force[2] < -1.9 * G else 0.0
    assert said(start(bank, v=(80.0, 0.0, 0.0)), force) is None


def test_what_no_manoeuvre_does_is_told_under_way_too() -> None:
    moving = start(v=(80.0, -20.0, 0.0))
    for force, word in ((up(0.5 * G), "half"), (up(2 * G), "twice"), (-up(), "z points up")):
        warning = said(moving, force)
        assert warning is not None
        assert word in warning


def test_motions_that_begin_at_once_are_left_alone() -> None:
    where = turn_motion(rocking=radians(1), shaking=3.0)
    seen = FirstSeconds(where.state(np.zeros(1)).state(0), T)
    seen.see(exact_increments(where, 300, T))
    assert seen.warning is None


def test_rocking_in_place_is_no_matter() -> None:
    """The gyros carry the attitude along: the force stands up in the level frame."""
    still = at_rest(0.8, 0.1, 400.0, heading=1.0)
    increments = exact_increments(still, 300, T)
    assert FirstSeconds(start(), T).warning is None  # nothing seen
    rocking = 0.3 * np.sin(2 * np.pi * np.arange(301) * T)
    turned = MajorIncrements(*np.zeros((3, 300, 3)))
    turned.phi[:, 1] = np.diff(rocking)
    turned.dv_sf[:] = [up(G, 0.0, np.degrees(angle)) * T for angle in rocking[:-1]]
    for block in (increments, turned):
        seen = FirstSeconds(start(), T)
        seen.see(block)
        assert seen.warning is None


def test_too_little_tells_nothing() -> None:
    assert said(start(), up(0.5 * G), seconds=0.9) is None
    assert said(start(), up(0.5 * G), seconds=1.1) is not None


def test_the_gravity_navigated_by_counts() -> None:
    seen = FirstSeconds(start(), T, constant_gravity(9.0))
    seen.see(MajorIncrements(*np.zeros((2, 300, 3)), np.tile(up() * T, (300, 1))))
    assert seen.warning is not None
    assert "gravity 9 (1.09 of it)" in seen.warning
