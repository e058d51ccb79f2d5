"""A manoeuvre from a file: its spline, its truth, and what designs leave of it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sculler.runs.analysis import of_family
from sculler_model.analysis.flight import PROFILE_COLUMNS, Profile, flown, truth
from sculler_model.errors import InputError
from sculler_model.motion import SpinAccel


@pytest.fixture(scope="module")
def rolling() -> Profile:
    """Two seconds of roll, pitch and yaw with a pull, from rest to rest."""
    t = np.linspace(0, 2, 21)
    bump = np.sin(np.pi * t / 2) ** 2
    values = np.zeros((21, 6))
    values[:, 0], values[:, 1], values[:, 2] = 5 * bump * np.sin(np.pi * t), 1.7 * bump, bump**2
    values[:, 4], values[:, 5] = 30 * bump, -9.8 * bump
    return Profile("rolling", t, values)


def test_the_spline_goes_through_its_points_and_its_integral_is_its_own(rolling: Profile) -> None:
    assert rolling.seen(rolling.times) == pytest.approx(rolling.values, abs=1e-12)
    t = np.linspace(0, 2, 20_001)
    middle = rolling.seen((t[:-1] + t[1:]) / 2)
    assert rolling.gone(t)[-1] == pytest.approx(middle.sum(axis=0) * 1e-4, rel=1e-7, abs=1e-8)
    slopes = [np.diff(rolling.seen(np.array([x - 1e-6, x, x + 1e-6])), axis=0) for x in (0.3, 1.1)]
    for before, after in slopes:
        assert before == pytest.approx(after, abs=1e-8)


def test_the_truth_of_constant_rate_and_force() -> None:
    """Against `SpinAccel`'s closed forms."""
    rate, force = (0.9, -0.4, 0.3), (1.0, 20.0, -3.0)
    steady = Profile("steady", np.array([0.0, 3.0]), np.tile([*rate, *force], (2, 1)))
    q, velocity, position = truth(steady, 3.0)
    closed, end = SpinAccel(rate, force), np.array([3.0])
    assert q == pytest.approx(closed.attitude(end)[0], abs=1e-12)
    assert velocity == pytest.approx(closed.velocity(end)[0], rel=1e-11)
    assert position == pytest.approx(closed.position(end)[0], rel=1e-11)


def test_the_truth_against_runge_kutta(rolling: Profile) -> None:
    """The quaternion equation with velocity and position, in steps of 4 ms."""
    h, count = 4e-3, 500
    nodes = rolling.seen(np.arange(2 * count + 1) * h / 2)

    def slope(state: np.ndarray, seen: np.ndarray) -> np.ndarray:
        w, v = state[0], state[1:4]
        rate, force = seen[:3], seen[3:]
        turned = force + 2 * np.cross(v, np.cross(v, force) + w * force)
        dq = 0.5 * np.concatenate(([-v @ rate], w * rate + np.cross(v, rate)))
        return np.concatenate((dq, turned, state[4:7]))

    state = np.array([1.0, *[0.0] * 9])
    for k in range(count):
        first, middle, last = nodes[2 * k : 2 * k + 3]
        k1 = slope(state, first)
        k2 = slope(state + h / 2 * k1, middle)
        k3 = slope(state + h / 2 * k2, middle)
        k4 = slope(state + h * k3, last)
        state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    q, velocity, position = truth(rolling, 2.0)
    assert q == pytest.approx(state[:4], abs=1e-9)
    assert velocity == pytest.approx(state[4:7], abs=1e-7)
    assert position == pytest.approx(state[7:], abs=1e-7)


def test_what_is_left_falls_with_the_interval(rolling: Profile) -> None:
    """Attitude with the fourth power of T (Savage-20), velocity with the third at least."""
    slow, fast = (flown(of_family("time-taylor", 4, 0, M).design, rolling) for M in (10, 5))
    assert slow.angle / fast.angle == pytest.approx(16, rel=0.05)
    assert slow.velocity / fast.velocity > 7
    assert slow.position > fast.position


def test_files(tmp_path: Path) -> None:
    path = tmp_path / "pull.csv"
    path.write_text(f"{','.join(PROFILE_COLUMNS)}\n0,0,0,0,0,0,0\n1,90,0,0,0,2,-1\n")
    found = Profile.load(path)
    assert found.values[1] == pytest.approx([np.pi / 2, 0, 0, 0, 2 * 9.80665, -9.80665])
    path.write_text(f"{','.join(PROFILE_COLUMNS[:4])}\n0,0,0,0\n1,90,0,0\n")
    assert Profile.load(path).peaks == pytest.approx((np.pi / 2, 0))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("t,x\n0,1\n", "line 1: the header must be time_s"),
        ("time_s,rate_x,rate_y,rate_z\n0,0,0,zero\n", "line 2: '0,0,0,zero' is not 4 numbers"),
        ("time_s,rate_x,rate_y,rate_z\n0,0,0,0\n", "two points"),
        ("time_s,rate_x,rate_y,rate_z\n0,0,0,0\n0,1,1,1\n", "must rise from 0"),
        ("time_s,rate_x,rate_y,rate_z\n0,0,0,0\n900,1,1,1\n", "too long"),
        ("time_s,rate_x,rate_y,rate_z\n0,0,0,0\n1,nan,1,1\n", "not finite"),
        ("time_s,rate_x,rate_y,rate_z\n0,0,0,0\n1,1e300,1,1\n", "larger than any vehicle's"),
    ],
)
def test_refusals(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "bad.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=message):
        Profile.load(path)


def test_a_manoeuvre_shorter_than_an_interval(rolling: Profile) -> None:
    short = Profile("short", rolling.times / 1000, rolling.values)
    with pytest.raises(InputError, match="shorter than a major interval"):
        flown(of_family("frequency-taylor", 4, 0, 10).design, short)
