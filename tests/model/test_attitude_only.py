"""Attitude alone: the Earth's turning by closed form; gyro biases in a window at rest by hand."""

from __future__ import annotations

from math import cos, degrees, nan, pi, radians, sin, sqrt

import numpy as np
import pytest
from numpy.typing import NDArray

from sculler_model.design import STATUS_SHORT_HISTORY
from sculler_model.errors import InputError
from sculler_model.frames import EARTH_RATE, from_euler, from_rotation_vector, product, to_dcm
from sculler_model.host import MajorIncrements
from sculler_model.motion import at_rest
from sculler_model.navigation import (
    AttitudeNavigator,
    NavHistory,
    attitude_state,
    exact_increments,
)
from sculler_model.navigation.attitude_only import RestWindow, earth_rate_at, seen_from_body

Array = NDArray[np.float64]

LEVEL = (1.0, 0.0, 0.0, 0.0)
BEFORE = np.array([1e-3, 2e-3, 3e-3])
"""A bias that was taken out before, rad/s."""


def turning(phi: Array, **more: Array) -> MajorIncrements:
    return MajorIncrements(phi, phi, np.full_like(phi, 7.0), **more)  # type: ignore[arg-type]


@pytest.mark.parametrize("lat", [-90.0, -33.0, 0.0, 48.0, 90.0])
def test_at_rest_on_the_turning_earth_the_attitude_stays(lat: float) -> None:
    where = at_rest(radians(lat) * (1 - 1e-12), 0.3, 100.0, 0.1, -0.2, 1.0)
    q = from_euler(0.1, -0.2, 1.0)
    found = AttitudeNavigator(attitude_state(5.0, q, radians(lat)), 10.0).run(
        exact_increments(where, 50, 10.0)
    )
    assert np.abs(found.q - q).max() < 1e-13
    assert found.time.tolist() == (5.0 + 10.0 * np.arange(1, 51)).tolist()
    assert np.isnan(found.v).all()
    assert np.isnan(found.h).all()
    assert (found.lat == radians(lat)).all()


def test_without_a_latitude_the_frame_stands_still_among_the_stars() -> None:
    phi = 0.1 * np.random.default_rng(1).normal(size=(30, 3))
    navigator = AttitudeNavigator(attitude_state(0.0, LEVEL), 0.5)
    found = navigator.run(turning(phi))
    q = LEVEL
    for row, turn in enumerate(phi.tolist()):
        q = product(q, from_rotation_vector(tuple(turn)))
        assert found.q[row] == pytest.approx(q, abs=1e-14)
    assert np.isnan(found.lat).all()
    assert navigator.state.q == tuple(found.q[-1].tolist())


def test_updates_runs_and_told_instants() -> None:
    """The instants go on by intervals from the last one that was told."""
    phi = 0.1 * np.random.default_rng(2).normal(size=(6, 3))
    whole = AttitudeNavigator(attitude_state(1.0, LEVEL, 0.7), 0.5).run(turning(phi))
    parts = AttitudeNavigator(attitude_state(1.0, LEVEL, 0.7), 0.5)
    told = [parts.update(tuple(phi[0].tolist()))]
    some = parts.run(turning(phi[1:3]))
    told += [some.state(0), some.state(1)]
    assert [state.time for state in told] == [1.5, 2.0, 2.5]
    stamps = np.array([3.25, 3.5])
    history = parts.run(turning(phi[3:5], times=stamps))
    assert history.time.tolist() == stamps.tolist()
    assert len(parts.run(turning(phi[:0], times=stamps[:0]))) == 0
    last = parts.update(tuple(phi[5].tolist()))
    assert last.time == 4.0
    assert [state.q for state in told] == [tuple(q) for q in whole.q[:3].tolist()]
    assert last.q == tuple(whole.q[5].tolist())


@pytest.mark.parametrize(
    ("state", "interval", "message"),
    [
        (attitude_state(0.0, (1 + 1.01e-6, 0.0, 0.0, 0.0)), 0.1, "the quaternion has length 1"),
        (attitude_state(0.0, (1 - 1.01e-6, 0.0, 0.0, 0.0)), 0.1, "the quaternion has length"),
        (attitude_state(0.0, (nan, 0.0, 0.0, 0.0)), 0.1, "the quaternion has length nan"),
        (attitude_state(0.0, LEVEL), 0.0, "interval: 0.0 s is not allowed"),
        (attitude_state(0.0, LEVEL), -1.0, "interval: -1.0 s is not allowed"),
        (attitude_state(0.0, LEVEL), float("inf"), "interval: inf s is not allowed"),
        (attitude_state(0.0, LEVEL, pi / 2 + 1e-15), 0.1, "latitude: give one from -90° to 90°"),
    ],
)
def test_what_is_refused(state: object, interval: float, message: str) -> None:
    with pytest.raises(InputError, match=message):
        AttitudeNavigator(state, interval)  # type: ignore[arg-type]
    for length in (1 + 0.99e-6, 1 - 0.99e-6):
        AttitudeNavigator(attitude_state(0.0, (length, 0.0, 0.0, 0.0), -pi / 2), 0.1)


def test_increments_that_are_refused() -> None:
    navigator = AttitudeNavigator(attitude_state(2.0, LEVEL), 0.5)
    with pytest.raises(InputError, match=r"after 2\.500 s: an increment is not finite"):
        navigator.run(turning(np.array([[0.0, 0.0, 0.0], [0.0, nan, 0.0]])))
    short = np.array([0, STATUS_SHORT_HISTORY])
    with pytest.raises(InputError, match="navigation: interval 1 of these"):
        navigator.run(turning(np.zeros((2, 3)), status=short))


def test_the_earths_rate_and_a_vector_seen_from_the_body() -> None:
    c, s = cos(0.7), sin(0.7)
    assert earth_rate_at(0.7) == pytest.approx((EARTH_RATE * c, 0.0, -EARTH_RATE * s), rel=1e-15)
    assert earth_rate_at(nan) == (0.0, 0.0, 0.0)
    angles = ((0.3, -0.8, 2.0), (0.0, 0.0, 0.0))
    q = np.array([from_euler(*each) for each in angles])
    found = seen_from_body(q, np.array([1.0, 2.0, 3.0]))
    for row, each in enumerate(angles):
        C = np.array(to_dcm(from_euler(*each)))
        assert found[row] == pytest.approx(C.T @ [1.0, 2.0, 3.0], abs=1e-14)


def at(times: Array, lat: float = nan) -> NavHistory:
    states = [attitude_state(time, LEVEL, None if lat != lat else lat) for time in times.tolist()]
    return NavHistory.from_states(states)


def resting(window: tuple[float, float], rates: Array, lat: float = nan) -> RestWindow:
    """Half a second each, from 0 on."""
    x, y, z = BEFORE.tolist()
    found = RestWindow(*window, 0.5, (x, y, z))
    times = 0.5 * np.arange(1, len(rates) + 1)
    for part in (slice(5), slice(5, None)):
        found.see(turning(0.5 * rates[part]), at(times[part], lat))
    return found


def test_a_bias_at_rest_is_the_mean_of_what_lies_inside() -> None:
    """Intervals from 1 s to 9 s: the third to the eighteenth; the noise tells how well."""
    rates = 1e-3 * np.random.default_rng(4).normal(size=(40, 3))
    inside = rates[2:18]
    for begin, end in ((1.0, 9.0), (1.0004, 8.9996), (0.51, 9.49)):
        found = resting((begin, end), rates).found()
        assert (found.begin, found.end, found.earth) == (begin, end, False)
        assert found.bias == pytest.approx(inside.mean(axis=0) + BEFORE, rel=1e-12)
        assert found.sigma == pytest.approx(inside.std(axis=0, ddof=1) / 4, rel=1e-12)
        assert found.warnings == ()
    assert resting((1.0006, 9.0), rates).found().sigma != found.sigma
    with_earth = resting((1.0, 9.0), rates, 0.7).found()
    assert with_earth.earth
    rate = np.array([EARTH_RATE * cos(0.7), 0.0, -EARTH_RATE * sin(0.7)])
    assert np.array(found.bias) - with_earth.bias == pytest.approx(rate, abs=1e-17)
    phi = np.ones((2, 3))
    corrected = with_earth.corrected(turning(phi), 0.5)
    assert corrected.phi == pytest.approx(phi - 0.5 * np.array(with_earth.bias))
    assert np.array_equal(corrected.dv_sf, turning(phi).dv_sf)


def test_a_window_of_eight_intervals_is_the_least() -> None:
    rates = 1e-3 * np.random.default_rng(4).normal(size=(40, 3))
    assert resting((1.0, 5.0), rates).found().warnings == ()
    for window, count in (((1.0, 4.5), 7), ((30.0, 50.0), 0)):
        with pytest.raises(InputError, match=f"rest: {count} intervals of the run lie in"):
            resting(window, rates).found()
    # 20 s of the run: a hundredth and two intervals may lack
    for end, lacks in ((21.2, False), (21.3, True)):
        (*_, said) = resting((0.0, end), rates).found().warnings or [""]
        assert said == (f"rest: 20 s of the {end:g} s asked for lie in the run" if lacks else "")


def test_what_is_no_gyro_at_rest() -> None:
    """A mean of more than 1 °/s; neighbours that differ by less than noise's would."""
    noise = 1e-4 * np.random.default_rng(5).normal(size=(40, 3))
    noise -= noise.mean(axis=0) + BEFORE
    for rate, warned in ((0.999, 0), (1.001, 1), (-1.001, 1)):
        said = resting((0.0, 20.0), noise + np.array([0.0, radians(rate), 0.0])).found().warnings
        assert len(said) == warned
        assert not warned or said[0].startswith("rest: the mean rate is 1 °/s: check")
    # von Neumann's ratio of a wave is 2 sin²(ω/2)
    k = np.arange(40)
    for ratio, warned in ((0.29, 1), (0.31, 0)):
        omega = 2 * np.arcsin(sqrt(ratio / 2))
        wave = np.sin(omega * k + 0.3) * 1e-3
        rates = noise + np.outer(wave - wave.mean(), [0.0, 0.0, 1.0])
        seen = np.mean(np.diff(rates[:, 2]) ** 2) / 2 / rates[:, 2].var()
        assert (seen < 0.3) == bool(warned)
        said = resting((0.0, 20.0), rates).found().warnings
        assert len(said) == warned
        size = degrees(rates[:, 2].std())
        assert not warned or f"the rates wander by {size:.3g} °/s" in said[0]
