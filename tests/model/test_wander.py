"""The wander azimuth where a north-pointing mechanisation ends, and against it elsewhere."""

from __future__ import annotations

from functools import cache
from math import cos, degrees, pi, radians, sin

import numpy as np
import pytest
from numpy.typing import NDArray

from sculler_model.errors import InputError
from sculler_model.frames import (
    EARTH_RATE,
    ECCENTRICITY_SQUARED,
    conjugate,
    from_euler,
    gravity,
    gravity_lean,
    product,
    radii,
    rotate,
    to_dcm,
    to_rotation_vector,
    transport_rate,
)
from sculler_model.host import MajorIncrements
from sculler_model.motion import Curve, Motion, Turn, X, Y, Z, at_rest, turn_motion
from sculler_model.navigation import (
    NORMAL,
    GeographicNavigator,
    HeightDamping,
    NavHistory,
    Navigator,
    NavState,
    exact_increments,
    navigate,
)
from sculler_model.navigation.exact import increments_in_inertial_space
from sculler_model.navigation.wander import earth_at, geographic, level, travelled

Array = NDArray[np.float64]
Four = tuple[Array, Array, Array, Array]
Triple = tuple[Array, Array, Array]

ARC_SECOND = radians(1 / 3600)


def metres(found: NavHistory, true: NavHistory) -> tuple[float, float]:
    """Largest horizontal and vertical position error."""
    meridian, prime_vertical = radii(np.sin(true.lat))
    north = (found.lat - true.lat) * (meridian + true.h)
    turned = (found.lon - true.lon + pi) % (2 * pi) - pi
    east = turned * (prime_vertical + true.h) * np.cos(true.lat)
    return float(np.hypot(north, east).max()), float(np.abs(found.h - true.h).max())


def tilt(found: NavHistory, true: NavHistory, every: int = 1) -> float:
    """Largest attitude error, rad."""
    pairs = zip(found.q[::every].tolist(), true.q[::every].tolist(), strict=True)
    errors = [to_rotation_vector(product(tuple(a), conjugate(tuple(b)))) for a, b in pairs]
    return float(np.abs(errors).max())


FLIGHT = Motion(
    radians(47),
    radians(11),
    3000.0,
    north=Curve((0.0, 100.0), ((20e3, 0.005, 0.3), (300.0, 0.1, 1.0))),
    east=Curve((0.0, 150.0), ((3e3, 0.02, 0.0),)),
    up=Curve((0.0,), ((1500.0, 0.003, 0.0), (40.0, 0.15, 0.4))),
    turns=(
        Turn(Z, Curve((1.0, 1e-3), ((1.5, 0.02, 0.0),))),
        Turn(Y, Curve((0.05,), ((0.15, 0.15, 0.3),))),
        Turn(X, Curve((0.0,), ((0.6, 0.1, 0.0),))),
    ),
)
"""100 to 250 m/s, 3 m/s² of manoeuvres, heading swinging by 1.5 rad and bank by 0.6 rad."""


@cache
def flight(seconds: int) -> tuple[MajorIncrements, NavHistory]:
    """Its exact increments at 100 Hz and the truth at every interval end."""
    count = 100 * seconds
    true = FLIGHT.state(0.01 * np.arange(count + 1))
    return exact_increments(FLIGHT, count, 0.01), true


@pytest.mark.parametrize(
    ("position_every", "metre"),
    [pytest.param(1, 5e-4, marks=pytest.mark.deep), (5, 1e-3), (20, 5e-3)],
)
def test_an_hour_of_flight(position_every: int, metre: float) -> None:
    """Required: 1 cm and 1e-3″ of the algorithm alone in an hour at 100 Hz.

    Found: 0.4 mm and 1.3e-5″.  What is left is the extrapolation of velocity in the Coriolis
    term, 3/8 T² v̈, and of gravity, in the vertical channel, which amplifies it 400 times an hour.
    """
    pytest.importorskip("numba", reason="an hour at 100 Hz wants the extra `fast`")
    inc, true = flight(3600)
    navigator = Navigator(true.state(0), 0.01, position_every=position_every)
    found = NavHistory.concatenate([NavHistory.from_states([true.state(0)]), navigator.run(inc)])
    horizontal, vertical = metres(found, true)
    assert horizontal < metre
    assert vertical < 20 * metre
    assert tilt(found, true, 100) < 1e-3 * ARC_SECOND
    if position_every == 1:
        assert tilt(found, true, 100) < 2e-5 * ARC_SECOND


def test_both_mechanisations_agree() -> None:
    """Independent but for the truth: 100 s of flight, one result at a time."""
    inc, true = flight(100)
    wander = navigate(true.state(0), 0.01, inc)
    north = navigate(true.state(0), 0.01, inc, GeographicNavigator)
    assert metres(wander, north)[0] < 2e-5
    assert tilt(wander, north, 10) < 1e-11
    assert np.abs(wander.v - north.v).max() < 1e-6
    assert np.all(north.wander == 0)
    assert np.abs(wander.wander[1:]).min() > 0


def about(axis: int, angle: Array) -> Four:
    """Quaternions of turns about x, y or z."""
    zero = np.zeros_like(angle)
    parts = [np.cos(0.5 * angle), zero, zero, zero]
    parts[1 + axis] = np.sin(0.5 * angle)
    return (parts[0], parts[1], parts[2], parts[3])


class OverThePole:
    """Along a meridian and on over a pole: geodetic latitude psi grows steadily past 90°.

    The frame w with x along the travel: P = (cos psi, 0, -sin psi) is the polar axis in it.
    """

    def __init__(self, start: float, rate: float, h: float, lon: float) -> None:
        self.start, self.rate, self.h, self.lon = start, rate, h, lon
        self.attitude = from_euler(0.05, 0.02, -0.7)  # in w

    def speed(self, psi: Array) -> tuple[Array, Array]:
        """Over the ground (m/s), and its growth (m/s²)."""
        meridian, _ = radii(np.sin(psi))
        squash = 1 - ECCENTRICITY_SQUARED * np.sin(psi) ** 2
        growth = 3 * ECCENTRICITY_SQUARED * np.sin(psi) * np.cos(psi) / squash * meridian
        return self.rate * (meridian + self.h), self.rate**2 * growth

    def sensed(self, t: Array) -> tuple[Four, Triple]:
        psi = self.start + self.rate * t
        w = product(about(2, self.lon + EARTH_RATE * t), about(1, -0.5 * pi - psi))
        q = product(w, tuple(np.full_like(t, c) for c in self.attitude))
        v, v1 = self.speed(psi)
        # (2 ω_ie + ω_en) × v with ω_ie = Ω P, ω_en = (0, -rate, 0), v = (v, 0, 0)
        along_y, along_z = -2 * EARTH_RATE * np.sin(psi) * v, self.rate * v
        # north, towards which w's x axis points before the pole, is where P points as well
        leaning = gravity_lean(np.sin(psi), self.h) * np.cos(psi)
        force = (v1 - leaning, along_y, along_z - gravity(np.sin(psi), self.h))
        back = conjugate(tuple(np.full_like(t, c) for c in self.attitude))
        return q, rotate(back, force)

    def state(self, t: float) -> NavState:
        """Geographic truth, the wander angle that of w: 0 before the pole, 180° after it."""
        psi = self.start + self.rate * t
        v = float(self.speed(np.array([psi]))[0][0])
        q = self.attitude
        if psi <= pi / 2:
            return NavState(t, q, (v, 0.0, 0.0), psi, self.lon, self.h)
        turned = product((0.0, 0.0, 0.0, 1.0), q)
        lon = self.lon - pi if self.lon > 0 else self.lon + pi
        return NavState(t, turned, (-v, 0.0, 0.0), pi - psi, lon, self.h, pi)


@pytest.mark.parametrize("position_every", [1, 4])
def test_over_the_pole(position_every: int) -> None:
    """300 m/s straight over it: position, velocity, attitude; and the azimuth runs on."""
    interval, count = 0.1, 6000
    track = OverThePole(radians(89.2), 300 / 6.4e6, 9000.0, 2.0)
    inc = increments_in_inertial_space(track.sensed, count, interval)
    found = Navigator(track.state(0.0), interval, position_every=position_every).run(inc)
    end, true = found.state(count - 1), track.state(count * interval)
    assert found.lat.max() == pytest.approx(pi / 2, abs=3e-6)  # within 15 m, half an interval
    assert end.lat < radians(89.2)
    meridian, _ = radii(1.0)
    to_pole, true_to_pole = (pi / 2 - s.lat for s in (end, true))
    apart = abs(to_pole * np.exp(1j * end.lon) - true_to_pole * np.exp(1j * true.lon))
    assert apart * meridian < 1e-3
    assert np.abs(np.array(end.v) - true.v).max() < 1e-4
    error = to_rotation_vector(product(end.q, conjugate(true.q)))
    assert np.abs(error[:2]).max() < 1e-9
    assert abs(end.wander - pi) % (2 * pi) == pytest.approx(0, abs=1e-6)
    # the heading jumps by 180° at the pole, the azimuth of the body in w does not
    assert np.abs(np.diff(found.euler[:, 2])).max() > 3
    assert np.abs(found.azimuth - (-0.7)).max() < 1e-8
    assert end.azimuth == pytest.approx(-0.7, abs=1e-8)


@pytest.mark.parametrize("sign", [1, -1])
def test_at_rest_on_a_pole(sign: int) -> None:
    """Latitude exactly ±90°: it stays there, heading and longitude as they were given."""
    lat, lon, h, heading = sign * pi / 2, 0.5, 100.0, 1.2
    g, T, count = gravity(sign, h), 0.1, 3000
    q = from_euler(0.0, 0.0, heading)
    start = NavState(0.0, q, (0.0, 0.0, 0.0), lat, lon, h)
    phi, dv = np.zeros((2, count, 3))
    phi[:, 2] = -sign * EARTH_RATE * T
    dv[:, 2] = -g * T
    found = navigate(start, T, MajorIncrements(phi, phi, dv))
    meridian, _ = radii(1.0)
    assert (pi / 2 - np.abs(found.lat)).max() * meridian < 1e-8
    assert np.abs(found.v).max() < 1e-10
    assert np.abs(found.h - h).max() < 1e-8
    assert np.abs(found.lon - lon).max() < 1e-12
    assert np.abs(found.euler[:, 2] - heading).max() < 1e-12
    assert np.all(found.wander == 0)


def test_leaving_a_pole() -> None:
    """From a standstill at the north pole along longitude 0.5 - which is south, turned round."""
    start = NavState(0.0, (1.0, 0.0, 0.0, 0.0), (-100.0, 0.0, 0.0), pi / 2, 0.5, 0.0)
    g, T = gravity(1.0, 0.0), 0.01
    still = np.zeros((100, 3))
    found = navigate(start, T, MajorIncrements(still, still, np.tile([0, 0, -g * T], (100, 1))))
    meridian, _ = radii(1.0)
    assert (pi / 2 - found.lat[-1]) * meridian == pytest.approx(100.0, rel=1e-4)
    assert found.lon[-1] == pytest.approx(0.5, abs=1e-3)
    assert found.v[-1, 0] == pytest.approx(-100.0, rel=1e-4)


@pytest.mark.parametrize("lat", [-90.0, -89.99999, -40.0, 0.0, 63.0, 90.0])
@pytest.mark.parametrize("lon", [-179.0, 0.0, 75.0])
@pytest.mark.parametrize("wander", [0.0, 2.0, -3.0])
def test_geographic_terms_there_and_back(lat: float, lon: float, wander: float) -> None:
    q, v = from_euler(0.3, -0.4, 2.2), (120.0, -50.0, 3.0)
    start = NavState(0.0, q, v, radians(lat), radians(lon), 1e3, wander)
    carried = level(start.q, start.v, start.lat, start.lon, start.h, start.wander, NORMAL)
    q2, v2, lat2, lon2, h2, wander2 = geographic(carried)
    assert (degrees(lat2), h2) == (pytest.approx(lat, abs=1e-12), 1000.0)
    # the same C_be whatever becomes of north at the pole
    back = product(to_earth(lat2, lon2), q2)
    error = to_rotation_vector(product(back, conjugate(product(to_earth(start.lat, start.lon), q))))
    assert np.abs(error).max() < 4e-15
    moving = rotate(to_earth(lat2, lon2), v2)
    assert moving == pytest.approx(rotate(to_earth(start.lat, start.lon), v), abs=1e-12)
    if abs(lat) < 90:
        assert degrees(lon2) == pytest.approx(lon, abs=1e-6)
        assert wander2 == pytest.approx(wander, abs=1e-8)


def to_earth(lat: float, lon: float) -> tuple[float, float, float, float]:
    """q_en."""
    a, b = 0.5 * lon, 0.5 * (-0.5 * pi - lat)
    return product((cos(a), 0.0, 0.0, sin(a)), (cos(b), 0.0, sin(b), 0.0))


@pytest.mark.parametrize("lat", [-80.0, 0.0, 34.0, 89.9])
@pytest.mark.parametrize("wander", [0.0, 1.0, -2.5])
def test_curvature_turned_into_w_is_that_of_the_ellipsoid(lat: float, wander: float) -> None:
    """Against the transport rate in north-east-down, less its vertical part."""
    phi, h, v_w = radians(lat), 5e3, (70.0, -230.0, 5.0)
    carried = level((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), phi, 0.7, h, wander, NORMAL)
    here = earth_at(carried.place, h, NORMAL)
    to_north = (cos(0.5 * wander), 0.0, 0.0, sin(0.5 * wander))
    known = transport_rate(sin(phi), cos(phi), h, rotate(to_north, v_w))
    found = rotate(to_north, travelled(here.curvature, v_w))
    assert found == pytest.approx((*known[:2], 0.0), rel=1e-12, abs=1e-18)
    assert rotate(to_north, here.rate) == pytest.approx(
        (EARTH_RATE * cos(phi), 0.0, -EARTH_RATE * sin(phi)), abs=1e-19
    )
    leaning = gravity_lean(sin(phi), h) * cos(phi)
    assert rotate(to_north, here.gravity) == pytest.approx(
        (leaning, 0.0, gravity(sin(phi), h)), rel=1e-14, abs=1e-16
    )
    assert np.linalg.det(to_dcm(carried.place)) == pytest.approx(1.0)


def test_the_wander_angle_is_what_the_longitude_turns_north_by() -> None:
    """Around the pole on a parallel: dα/dt = sin lat dlon/dt, here 85° N for 15 minutes."""
    where = Motion(radians(85), 0.7, 10e3, east=Curve((0.0, 250.0)))
    T, count = 0.1, 9000
    true = where.state(T * np.arange(count + 1))
    found = navigate(true.state(0), T, exact_increments(where, count, T))
    expected = np.sin(true.lat) * (true.lon - true.lon[0])
    assert np.abs(found.wander - expected).max() < 1e-9
    assert metres(found, true)[0] < 1e-4


def test_a_given_wander_angle_changes_nothing_else() -> None:
    where = turn_motion()
    inc = exact_increments(where, 500, 0.02)
    start = where.state(np.zeros(1)).state(0)
    plain, turned = (navigate(start._replace(wander=a), 0.02, inc) for a in (0.0, 2.0))
    assert metres(turned, plain)[0] < 5e-7  # rounding
    assert tilt(turned, plain) < 1e-13
    assert np.abs(turned.wander - plain.wander - 2.0).max() < 1e-12


@pytest.mark.parametrize("lat", [0.0, 48.0, -75.0])
@pytest.mark.parametrize("position_every", [1, 7])
def test_at_rest_it_is_exact_to_rounding(lat: float, position_every: int) -> None:
    """Ten minutes at 1 s: nothing but rounding, though ζ²/12 of gravity would be 14 mm here."""
    where = at_rest(radians(lat), 0.3, 200.0, roll=0.1, pitch=-0.2, heading=2.0)
    true = where.state(np.arange(601.0))
    found = Navigator(true.state(0), 1.0, position_every=position_every).run(
        exact_increments(where, 600, 1.0)
    )
    rest = NavHistory(*(getattr(true, n)[1:] for n in ("time", "q", "v", "lat", "lon", "h")))
    horizontal, vertical = metres(found, rest)
    assert horizontal < 1e-6
    assert vertical < 1e-6
    assert np.abs(found.v).max() < 1e-8
    assert tilt(found, rest) < 1e-13


def test_the_first_interval_needs_no_past() -> None:
    """Starting while braking with 40 m/s², 0.5 s intervals: as if there had been one before."""
    where = Motion(0.8, 0.2, 5e3, east=Curve((0.0, 300.0, -20.0)))
    inc = exact_increments(where, 4, 0.5)
    true = where.state(0.5 * np.arange(5))
    found = navigate(true.state(0), 0.5, inc)
    # without it the Coriolis term would miss T²/2 · 40 m/s² · 2Ω: 7e-4 m/s
    assert np.abs(found.v - true.v).max() < 2e-5


@pytest.mark.parametrize("seconds", [20.0, 100.0])
def test_the_transient_of_the_height_is_that_of_the_loop(seconds: float) -> None:
    """The loop stepped by Euler, without the gradient of gravity that k2 makes up for."""
    loop, error, step = HeightDamping(0.0, seconds), 0.01, seconds / 2000
    k1, k2, k3 = loop.gains
    k2 -= 2 * 9.7803253359 / 6378137.0
    height = speed = total = largest = 0.0
    for _ in range(10_000):
        total += step * k3 * height
        speed += step * (error - k2 * height - total)
        height += step * (speed - k1 * height)
        largest = max(largest, height)
    assert loop.transient(-error) == pytest.approx(largest, rel=2e-3)


def test_height_damping_holds_the_height() -> None:
    """An accelerometer 1 mg off, for an hour: the loop's integral takes it up."""
    where = at_rest(radians(45), 0.0, 300.0)
    inc = exact_increments(where, 36_000, 0.1)
    inc.dv_sf[:, 2] += 0.1 * 9.81e-3
    start = where.state(np.zeros(1)).state(0)
    loop = HeightDamping(300.0, 50.0)
    found = Navigator(start, 0.1, height_damping=loop).run(inc)
    assert abs(found.h[-1] - 300) < 1e-3
    assert np.abs(found.h - 300).max() < 9.81e-3 * 50**2  # b τ² and less, while it settles
    assert np.abs(found.v[-1, 2]) < 1e-4
    with pytest.raises(InputError, match="the height has run away to"):
        Navigator(start, 0.1).run(inc)


def test_height_damping_has_its_three_poles_where_it_says() -> None:
    """A wrong height decays as e^(-t/τ) (1 + c1 t/τ + c2 (t/τ)²)."""
    tau, T, count = 100.0, 0.1, 4000
    where = at_rest(radians(45), 0.0, 300.0)
    start = where.state(np.zeros(1)).state(0)._replace(h=310.0)
    loop = HeightDamping(300.0, tau)
    found = Navigator(start, T, height_damping=loop).run(exact_increments(where, count, T))
    x = T * np.arange(1, count + 1) / tau
    # h(0) = 10, h' = -k1 h, h'' = k1² h - (k2 - 2g/R) h = (9 - 3) h/τ², v starting at 0
    a, b, c = 1.0, 1.0 - 3.0, 0.5 * (6.0 - 1.0 + 2 * (1.0 - 3.0))
    expected = 10 * np.exp(-x) * (a + b * x + c * x**2)
    assert np.abs(found.h - 300 - expected).max() < 0.03


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"seconds": 0.0}, "time constant 0.0 s is not allowed"),
        ({"seconds": float("nan")}, "time constant nan s is not allowed"),
        ({"reference": -2e4}, "reference -20000 m is not allowed"),
        ({"reference": float("nan")}, "reference nan m is not allowed"),
    ],
)
def test_bad_height_damping_is_refused(arguments: dict[str, float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        HeightDamping(**({"reference": 0.0} | arguments))


def test_height_damping_faster_than_the_intervals_is_refused() -> None:
    start = NavState(0.0, (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.8, 0.2, 100.0)
    with pytest.raises(InputError, match="time constant 5 s is too short for intervals of 1 s"):
        Navigator(start, 1.0, height_damping=HeightDamping(100.0, 5.0))


def test_the_position_direction_cosines() -> None:
    """At 30° N, 90° E, x turned to south-east: down points at the Earth, x as it should."""
    start = NavState(0.0, (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), pi / 6, pi / 2, 0.0, radians(135))
    C_ew = np.array(Navigator(start, 1.0).position_dcm)
    assert C_ew[:, 2] == pytest.approx([0, -cos(pi / 6), -0.5], abs=1e-15)
    south, east = np.array([0, 0.5, -cos(pi / 6)]), np.array([-1.0, 0, 0])
    assert C_ew[:, 0] == pytest.approx((south + east) * 0.5**0.5, abs=1e-15)
    assert C_ew @ C_ew.T == pytest.approx(np.eye(3), abs=1e-15)


def test_position_every_none_is_refused() -> None:
    start = NavState(0.0, (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.8, 0.2, 100.0)
    with pytest.raises(InputError, match="position every 0 intervals is not allowed"):
        Navigator(start, 0.01, position_every=0)
