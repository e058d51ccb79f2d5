"""The ready-made motions: geometry by differences of position and axes, published lengths."""

from __future__ import annotations

from dataclasses import replace
from math import atan2, cos, degrees, pi, radians, sin

import numpy as np
import pytest
from numpy.typing import NDArray

from sculler_model.errors import InputError
from sculler_model.frames import gravity, gravity_lean, to_dcm, to_euler
from sculler_model.motion import (
    MOTIONS,
    PLACE,
    Curve,
    Motion,
    SpinAccel,
    Spline,
    Vibration,
    coning,
    flight,
    great_circle,
    over_the_pole,
)
from sculler_model.navigation import NavHistory

RATE, A, F = 7.292115e-5, 6378137.0, 1 / 298.257223563
E2 = F * (2 - F)


def made(name: str) -> Motion:
    return MOTIONS[name].make(*(() if name in ("demo", "pole") else PLACE))


SHAKE = Vibration(acceleration=5.0, rate=0.02, low=3.0, high=9.0, lines=5)
CASES = {name: made(name) for name in MOTIONS} | {
    "shaken flight": SHAKE.on(made("flight")),
    "shaken pole": SHAKE.on(over_the_pole(before=8.0)),
    "arm over the pole": replace(
        over_the_pole(before=8.0), arm=(Curve((3.0,)), Curve((-2.0,)), Curve((1.0,)))
    ),
}
# at no simple phase of any vibration; around the pole, in the take-off run, climbs and turns
TIMES = np.array([0.3137, 3.771, 7.93, 8.0273, 61.31, 93.2, 130.117, 222.2, 270.01, 1400.7, 3001.3])


def sixth_order(values: list[NDArray], step: float) -> NDArray:
    """First derivative from values at -3 ... 3 steps."""
    d = [values[3 + k] - values[3 - k] for k in (1, 2, 3)]
    return (45 * d[0] - 9 * d[1] + d[2]) / (60 * step)


def local_axes(state: NavHistory, t: NDArray) -> NDArray:
    """Axes north, east, down as columns, in inertial space (N, 3, 3)."""
    lat, lon = state.lat, state.lon + RATE * t
    s, c, sl, cl = np.sin(lat), np.cos(lat), np.sin(lon), np.cos(lon)
    north = np.stack((-s * cl, -s * sl, c), 1)
    east = np.stack((-sl, cl, 0 * lat), 1)
    return np.stack((north, east, np.cross(north, east)), 2)


def position(state: NavHistory, t: NDArray) -> NDArray:
    """In inertial space (N, 3)."""
    lat, lon, h = state.lat, state.lon + RATE * t, state.h
    normal = A / np.sqrt(1 - E2 * np.sin(lat) ** 2)
    across = (normal + h) * np.cos(lat)
    up = (normal * (1 - E2) + h) * np.sin(lat)
    return np.stack((across * np.cos(lon), across * np.sin(lon), up), 1)


def body_axes(state: NavHistory, t: NDArray) -> NDArray:
    """Axes of the body as columns, in inertial space (N, 3, 3)."""
    C_nb = np.array([to_dcm(tuple(q)) for q in state.q])
    return local_axes(state, t) @ C_nb


@pytest.mark.parametrize("name", CASES)
def test_rate_velocity_and_force_are_derivatives_of_attitude_and_position(name: str) -> None:
    """All from latitude, longitude, height and attitude alone, in inertial space, by differences.

    Extended precision, for positions of 6.4e6 m are differenced.
    """
    motion = CASES[name]
    fast = motion.highest > 20
    step = np.longdouble(0.2 / motion.highest if fast else 0.02)
    t = TIMES.astype(np.longdouble)
    around = [t + k * step for k in range(-3, 4)]
    states = [motion.state(when) for when in around]
    axes = [body_axes(state, when) for state, when in zip(states, around, strict=True)]
    places = [position(state, when) for state, when in zip(states, around, strict=True)]
    sensed = motion.sensed(TIMES)

    # what the differences leave of vibrations, else rounding
    rate_bound, force_bound = (1e-9, 3e-7) if fast else (1e-10, 3e-12)
    skew = np.swapaxes(axes[3], 1, 2) @ sixth_order(axes, step)
    rate = np.stack((skew[:, 2, 1], skew[:, 0, 2], skew[:, 1, 0]), 1).astype(float)
    assert np.abs(sensed[:, :3] - rate).max() < rate_bound

    local = local_axes(states[3], t)
    over_earth = sixth_order(places, step) - np.cross([0, 0, RATE], places[3])
    velocity = np.einsum("nij,ni->nj", local, over_earth)
    assert np.abs(states[3].v - velocity).max() < 2e-8

    second = [
        np.einsum("nij,nj->ni", local_axes(s, w), s.v) + np.cross([0, 0, RATE], p)
        for s, w, p in zip(states, around, places, strict=True)
    ]
    acceleration = sixth_order(second, step)
    sin_lat, h = np.sin(states[3].lat), states[3].h
    leaning = gravity_lean(sin_lat, h) * np.cos(states[3].lat)
    plumb = leaning[:, None] * local[:, :, 0] + gravity(sin_lat, h)[:, None] * local[:, :, 2]
    gravitation = plumb - RATE**2 * places[3] * np.array([1, 1, 0])
    force = np.einsum("nij,ni->nj", axes[3], acceleration - gravitation).astype(float)
    assert np.abs(sensed[:, 3:] - force).max() < force_bound


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("interval", [1 / 2000, 1 / 100])
def test_half_samples_add_up(name: str, interval: float) -> None:
    """Quadrature of one panel against that of two, where the flight banks, too."""
    motion = CASES[name]
    first = round(225 / interval)
    whole = motion.increments(100, interval, first)
    halves = motion.increments(200, interval / 2, 2 * first)
    size = np.abs(whole).max(axis=0)
    # 1e-15 of the size, and the rounding of the phases Ω t at 225 s, which cancel in some sums
    phase = 2.3e-16 * 225 * motion.highest * interval * max(1.0, motion.highest)
    gap = np.abs(halves[::2] + halves[1::2] - whole)
    assert np.all(gap <= 4e-15 * size + 1e-20 + phase)


def test_constant_speed_along_the_equator() -> None:
    h, speed = 1000.0, 300.0
    state = great_circle(0.0, radians(170), h, pi / 2, speed).state(np.array([0.0, 3600.0]))
    assert np.allclose(state.lat, 0, atol=1e-15)
    # once past 180°
    assert state.lon[1] == pytest.approx(
        radians(170) + speed * 3600 / (A + h) - 2 * pi * (3600 * speed > radians(10) * A), abs=1e-14
    )


def test_the_meridian_quadrant_is_as_long_as_published() -> None:
    """From the equator to the pole it is 10,001,965.729 m on WGS-84."""
    speed = 100.0
    t = np.array([0.0, 10_001_965.729 / speed])
    state = great_circle(0.0, 0.3, 0.0, 0.0, speed).state(t)
    assert (pi / 2 - state.lat[1]) * 6.4e6 < 1e-3


@pytest.mark.parametrize("lat", [-1.2, 0.3, 1.5])
def test_great_circle_keeps_speed_height_and_plane(lat: float) -> None:
    t = np.linspace(0, 40_000, 401)
    state = great_circle(lat, -2.0, 8000.0, 1.0, 250.0).state(t)
    assert np.abs(np.linalg.norm(state.v, axis=1) - 250).max() < 1e-11
    assert np.ptp(state.h) == 0
    c = np.cos(state.lat)
    normal = np.stack((c * np.cos(state.lon), c * np.sin(state.lon), np.sin(state.lat)), 1)
    across = np.cross(normal[0], normal[100])
    assert np.abs(normal @ across).max() < 4e-16
    # body x lies in that plane and is level: the way it goes, but for the ellipsoid's flattening
    course = np.arctan2(state.v[:, 1], state.v[:, 0])
    heading = np.array([to_euler(tuple(q))[2] for q in state.q.tolist()])
    assert np.abs(np.angle(np.exp(1j * (course - heading)))).max() < 0.5 * E2


def test_over_the_pole_and_down_the_other_side() -> None:
    motion = over_the_pole(lon=0.2, h=10_000.0, speed=250.0, before=300.0)
    state = motion.state(np.array([0.0, 299.0, 301.0, 600.0]))
    away = (pi / 2 - state.lat) * (6399593.6 + 10_000)
    # the meridian bends more away from the pole: by 3/2 e'² δ², a third of that on the mean
    excess = 75_000 * 0.5 * E2 / (1 - E2) * (75_000 / 6_409_594) ** 2
    assert away == pytest.approx([75_000 + excess, 250, 250, 75_000 + excess], abs=1e-3)
    assert state.lon == pytest.approx([0.2, 0.2, 0.2 - pi, 0.2 - pi], abs=1e-9)
    headings = [degrees(to_euler(tuple(q))[2]) for q in state.q.tolist()]
    assert headings[0] == pytest.approx(0, abs=1e-9)
    assert abs(headings[3]) == pytest.approx(180, abs=1e-9)
    assert state.v[3] == pytest.approx([-250, 0, 0], abs=1e-9)


def test_coning_is_the_rotation_vector_that_it_is_called() -> None:
    a, hertz = radians(1), 20.0
    t = np.array([0.0, 0.0123, 1.3])
    q = coning(*PLACE, half_angle=a, hertz=hertz).state(t).q
    angle = 2 * pi * hertz * t
    expected = [np.cos(a / 2) + 0 * t, sin(a / 2) * np.cos(angle), sin(a / 2) * np.sin(angle)]
    assert np.allclose(q[:, :3], np.stack(expected, 1), atol=1e-14)
    assert np.allclose(q[:, 3], 0, atol=1e-14)


def test_a_coordinated_turn_feels_no_side_force() -> None:
    motion = MOTIONS["turn"].make(*PLACE, speed=100.0, turn_rate=0.05)
    force = motion.sensed(np.linspace(0, 60, 7))[:, 3:]
    assert np.abs(force[:, 1]).max() < 0.06  # Coriolis and the Earth's gravity are not in the bank
    assert force[:, 2] == pytest.approx(-np.hypot(9.81, 5.0), abs=0.02)


def test_the_lever_arm_of_spin_rock_size_is_a_distance() -> None:
    """The sensors stay the arm's length from the centre, at rest over the Earth."""
    motion = MOTIONS["spin-rock-size"].make(*PLACE, arm=0.5)
    t = np.linspace(0, 3, 50)
    centre = replace(motion, arm=())
    gap = position(motion.state(t), 0 * t) - position(centre.state(t), 0 * t)
    # metres are nominal: the radii are those of the centre, 0.5 m of 6.4e6 away
    assert np.linalg.norm(gap, axis=1) == pytest.approx(0.5 * 3**0.5, abs=5e-8)
    assert np.abs(centre.state(t).v).max() == 0
    # straight down the arm it is C_nb (0.5, 0.5, 0.5)
    C_nb = np.array([to_dcm(tuple(q)) for q in motion.state(t).q.tolist()])
    down = -(motion.state(t).h - PLACE[2])
    assert down == pytest.approx(C_nb[:, 2].sum(axis=1) * 0.5, abs=1e-9)


def test_the_flight_takes_off_turns_and_lands() -> None:
    motion = made("flight")
    t = np.linspace(0, 3600, 3601)
    state = motion.state(t)
    speed = np.linalg.norm(state.v, axis=1)
    assert speed[:40].max() == 0
    assert speed[3560:].max() < 1e-11  # the differences of metres far away are as small as that
    assert state.h[0] == state.h[-1] == pytest.approx(500, abs=1e-9)
    assert state.h.max() == pytest.approx(9700, abs=1)
    assert speed.max() == pytest.approx(230, abs=2)
    # the nose points where it goes, to a degree or so, whenever it flies
    euler = state.euler
    flying = speed > 40
    course = np.arctan2(state.v[:, 1], state.v[:, 0])
    gap = np.degrees(np.angle(np.exp(1j * (course - euler[:, 2]))))[flying]
    assert np.abs(gap).max() < 3
    assert np.degrees(euler[:, 0]).max() > 25
    assert np.degrees(euler[:, 0]).min() < -20
    assert motion is made("flight")  # planned once


def test_the_spline_is_the_cardinal_one() -> None:
    """Values at the knots: 1, 120, 1191, 2416 over 5040 (Schoenberg)."""
    impulse = Spline([0.0] * 6 + [1.0] + [0.0] * 6, 2.0)
    value, first, _ = impulse.jet(2.0 * np.arange(13))
    around = [1, 120, 1191, 2416, 1191, 120, 1]
    assert value == pytest.approx([0] * 3 + [n / 5040 for n in around] + [0] * 3, abs=2e-16)
    # B7' = B6(x + 1/2) - B6(x - 1/2), B6 at half knots: 1, 57, 302 over 720
    slopes = [1, 56, 245, 0, -245, -56, -1]
    assert first == pytest.approx([0] * 3 + [n / 720 / 2 for n in slopes] + [0] * 3, abs=2e-16)


def test_the_spline_stands_still_goes_straight_and_goes_on() -> None:
    t = np.array([-30.0, -0.5, 0.0, 7.3, 20.0, 33.0, 99.0])
    value, first, second = Spline([3.0, 5.0, 7.0, 9.0, 11.0], 5.0).jet(t)
    assert value == pytest.approx(3 + 0.4 * t, abs=1e-13)
    assert first == pytest.approx(0.4, abs=1e-15)
    assert second == pytest.approx(0, abs=1e-15)
    value, first, second = Spline([7.0] * 9 + [8.0], 1.0).jet(np.array([-5.0, 0.0, 3.9]))
    assert (value.tolist(), first.tolist(), second.tolist()) == ([7.0] * 3, [0.0] * 3, [0.0] * 3)


def test_spline_derivatives_by_differences() -> None:
    spline = Spline(np.random.default_rng(3).normal(size=20).tolist(), 1.5)
    t = np.linspace(-4, 33, 200).astype(np.longdouble)
    step = np.longdouble(1e-3)
    jets = [spline.jet(t + k * step) for k in range(-3, 4)]
    for order in (0, 1):
        found = sixth_order([jet[order] for jet in jets], step)
        assert np.abs(found - jets[3][order + 1]).max() < 1e-13


def test_vibration_has_the_size_and_the_band_that_it_is_given() -> None:
    shake = Vibration(acceleration=3.0, rate=0.05, low=20, high=60, lines=40, seed=7)
    motion = shake.on(made("rest"))
    t = np.arange(0, 40, 1 / 500)
    felt = motion.sensed(t) - made("rest").sensed(t)
    rms = np.sqrt((felt**2).mean(axis=0))
    assert rms[:3] == pytest.approx(0.05, rel=0.03)
    assert rms[3:] == pytest.approx(3.0, rel=0.03)
    power = np.abs(np.fft.rfft(felt[:, 5])) ** 2
    hertz = np.fft.rfftfreq(len(t), 1 / 500)
    inside = (hertz > 19.9) & (hertz < 60.1)
    assert power[inside].sum() > 0.999 * power.sum()
    # axes do not correlate, and the seed decides
    assert np.abs(np.corrcoef(felt.T) - np.eye(6)).max() < 0.2
    assert np.array_equal(shake.on(made("rest")).sensed(t[:9]), motion.sensed(t[:9]))
    other = replace(shake, seed=8).on(made("rest"))
    assert not np.allclose(other.sensed(t[:9]), motion.sensed(t[:9]))


def test_at_a_pole_only_rest_and_great_circles() -> None:
    state = MOTIONS["rest"].make(pi / 2, 1.0, 0.0).state(np.zeros(1))
    assert (state.lat[0], state.lon[0]) == (pi / 2, 1.0)
    for name in ("turn", "flight", "sculling", "spin-rock-size"):
        with pytest.raises(InputError, match="great circle"):
            MOTIONS[name].make(radians(-89.95), 1.0, 0.0)
    with pytest.raises(InputError, match="great circle"):
        SHAKE.on(MOTIONS["rest"].make(pi / 2, 1.0, 0.0))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"low": 0.0}, "0 < LOW < HIGH"),
        ({"low": 30.0, "high": 20.0}, "30 to 20 Hz"),
        ({"high": float("nan")}, "nan Hz"),
        ({"high": float("inf")}, "inf Hz"),
        ({"lines": 0}, "0 lines"),
    ],
)
def test_vibration_faults(options: dict[str, float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        Vibration(**options)  # type: ignore[arg-type]


def test_constant_rate_and_force_in_inertial_space() -> None:
    """Velocity and position against quadrature of the force turned by the attitude."""
    spin = SpinAccel(rate=(0.3, -0.5, 0.9), force=(2.0, 30.0, -4.0))
    node, weight = np.polynomial.legendre.leggauss(30)
    for end in (0.4, 2.0, 9.0):
        times = 0.5 * end * (node + 1)
        C = np.array([to_dcm(tuple(q)) for q in spin.attitude(times).tolist()])
        force = C @ np.array(spin.force)
        assert spin.velocity(np.array([end]))[0] == pytest.approx(
            0.5 * end * weight @ force, rel=1e-13, abs=1e-13
        )
        assert spin.position(np.array([end]))[0] == pytest.approx(
            0.5 * end * (weight * (end - times)) @ force, rel=1e-13, abs=1e-13
        )
    angle = np.linalg.norm(spin.rate)
    assert 2 * np.arccos(spin.attitude(np.array([1.0]))[0, 0]) == pytest.approx(angle, rel=1e-14)
    inc = spin.increments(3, 0.25)
    assert np.allclose(inc, 0.25 * np.array([0.3, -0.5, 0.9, 2.0, 30.0, -4.0]), rtol=1e-15)


def test_the_runway_heading_is_the_take_off_run() -> None:
    heading = radians(-75)
    motion = flight(0.2, 1.0, 0.0, heading)
    state = motion.state(np.array([95.0]))
    assert atan2(state.v[0, 1], state.v[0, 0]) == pytest.approx(heading, abs=1e-6)
    assert cos(state.euler[0, 2] - heading) == pytest.approx(1, abs=1e-15)
