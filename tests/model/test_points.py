"""Motions through points: the points are met, the sensed is the curve's, and it is smooth."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from sculler_model.errors import InputError
from sculler_model.frames import earth_fixed, from_euler, from_local, geodetic
from sculler_model.motion import Knots, Motion, PointCurve, Points, Tumble, hour_flight, through
from sculler_model.motion.points import derivative_weights

Array = np.ndarray

PLACE = (0.8, 0.2, 500.0)


def uneven(many: int = 40, seed: int = 5) -> Array:
    """Instants that are not evenly spaced, from 0 on."""
    return np.concatenate(([0.0], np.random.default_rng(seed).uniform(0.3, 1.7, many - 1).cumsum()))


def test_the_weights_of_the_derivatives_are_the_textbook_s() -> None:
    # central differences of fourth order, Abramowitz and Stegun 25.3.23 ff. by the same method
    found = derivative_weights(np.array([[-2.0, -1.0, 0.0, 1.0, 2.0]]), 3)[:, 0]
    expected = [
        [Fraction(1, 12), Fraction(-2, 3), 0, Fraction(2, 3), Fraction(-1, 12)],
        [Fraction(-1, 12), Fraction(4, 3), Fraction(-5, 2), Fraction(4, 3), Fraction(-1, 12)],
        [Fraction(-1, 2), 1, 0, -1, Fraction(1, 2)],
    ]
    assert found == pytest.approx(np.array(expected, dtype=float), abs=1e-14)


@pytest.mark.parametrize("smoothness", [2, 3, 4])
def test_a_curve_meets_its_points_and_reproduces_polynomials(smoothness: int) -> None:
    time = uneven()
    inner = np.linspace(time[smoothness], time[-1 - smoothness], 501)
    for degree, instants in ((smoothness, np.linspace(0, time[-1], 501)), (2 * smoothness, inner)):
        coefficients = np.random.default_rng(degree).normal(size=degree + 1)
        whole = np.polynomial.Polynomial(coefficients, domain=[0, time[-1]])
        curve = PointCurve(Knots(time, smoothness), whole(time))
        assert curve.jet(time)[0] == pytest.approx(whole(time), abs=1e-14)
        for order, found in enumerate(curve.jet(instants)):
            exact = (whole.deriv(order) if order else whole)(instants)
            assert found == pytest.approx(exact, abs=2e-11), (degree, order)


@pytest.mark.parametrize("smoothness", [2, 3, 4])
def test_a_curve_is_as_smooth_as_it_says(smoothness: int) -> None:
    time = uneven(12)
    values = np.random.default_rng(9).normal(size=12)
    curve = PointCurve(Knots(time, smoothness), values)
    inside = time[1:-1]
    leaps = []
    for step in (1e-3, 5e-4):  # the m-th derivative, by differences of the second, on both sides
        ahead = [curve.jet(inside + k * step)[2] for k in range(smoothness - 1)]
        behind = [curve.jet(inside - k * step)[2] for k in range(smoothness - 1)]
        after = np.diff(ahead, n=smoothness - 2, axis=0)[0] / step ** (smoothness - 2)
        before = np.diff(behind, n=smoothness - 2, axis=0)[0] / (-step) ** (smoothness - 2)
        leaps.append(np.abs(after - before).max())
    # what the differences leave goes down with the step; a leap would stay
    assert leaps[1] < 0.6 * leaps[0] + 1e-9


def test_an_attitude_s_rate_is_that_of_its_quaternion() -> None:
    time = uneven(15, 3)
    generator = np.random.default_rng(4)
    q = np.array([from_euler(*angles) for angles in generator.uniform(-0.6, 0.6, (15, 3))])
    q[7:] *= -1  # the other sign is the same attitude
    tumble = Tumble(Knots(time), q)
    met = np.stack(tumble.jet(time)[0], 1)
    assert np.abs(np.einsum("ij,ij->i", met, q)) == pytest.approx(np.ones(15), abs=1e-14)
    t, step = np.linspace(0.1, time[-1] - 0.1, 301), 1e-4
    (w, x, y, z), rate, change = tumble.jet(t)
    later, sooner = tumble.jet(t + step), tumble.jet(t - step)
    turned = [(a - b) / (2 * step) for a, b in zip(later[0], sooner[0], strict=True)]
    # ω = 2 Im(q* q̇), by differences
    a, b, c, d = turned
    expected = (
        2 * (w * b - x * a - y * d + z * c),
        2 * (w * c - y * a - z * b + x * d),
        2 * (w * d - z * a - x * c + y * b),
    )
    for found, exact in zip(rate, expected, strict=True):
        assert found == pytest.approx(exact, abs=1e-6)
    for found, ahead, behind in zip(change, later[1], sooner[1], strict=True):
        assert found == pytest.approx((ahead - behind) / (2 * step), abs=1e-5)


def flight_points(every: float = 0.5) -> tuple[Motion, Points]:
    motion = hour_flight(*PLACE)
    states = motion.state(np.arange(0.0, 600.0 + every / 2, every))
    return motion, Points(states.time, states.lat, states.lon, states.h, states.q)


def test_through_points_of_a_flight_it_is_that_flight() -> None:
    motion, points = flight_points()
    found = through(points)
    t = np.linspace(0.0, 600.0, 9001)
    true, states = motion.state(t), found.state(t)
    met = found.state(points.time)
    assert met.lat == pytest.approx(points.lat, abs=1e-15)
    assert met.h == pytest.approx(points.h, abs=1e-9)
    assert np.abs(states.v - true.v).max() < 5e-6
    assert np.abs(found.sensed(t) - motion.sensed(t)).max(axis=0) == pytest.approx(
        np.zeros(6), abs=5e-5
    )


def test_the_increments_are_the_integrals_of_what_is_sensed() -> None:
    """By Gauss-Legendre quadrature that is split at the points."""
    time = uneven(12, 8)
    lat, lon, h = from_local(PLACE, 30 * time, 40 * np.sin(0.4 * time), 5 * np.cos(0.7 * time))
    motion = through(Points(time, lat, lon, h))
    interval, samples = 0.01, 900
    ends = np.arange(samples + 1) * interval
    # quarters of samples, and the points
    edges = np.unique(np.concatenate((np.arange(4 * samples + 1) * interval / 4, time)))
    edges = edges[edges <= ends[-1]]
    nodes, weights = np.polynomial.legendre.leggauss(12)
    middle, half = 0.5 * (edges[1:] + edges[:-1]), 0.5 * np.diff(edges)
    instants = middle[:, None] + half[:, None] * nodes
    sensed = motion.sensed(instants.ravel()).reshape(*instants.shape, 6)
    pieces = half[:, None] * np.einsum("g,pgc->pc", weights, sensed)
    sample = np.searchsorted(ends, middle) - 1
    exact = np.stack([np.bincount(sample, pieces[:, c], samples) for c in range(6)], axis=1)
    found = motion.increments(samples, interval)
    assert np.abs(found - exact)[:, :3].max() < 2e-11
    assert np.abs(found - exact)[:, 3:].max() < 2e-9
    assert np.abs((found - exact).sum(axis=0)).max() < 2e-9


def test_the_nose_follows_the_way_and_the_floor_carries_the_force() -> None:
    """A level circle: the bank is that of a coordinated turn, the force square to the floor."""
    time, rate, radius = np.arange(0.0, 60.0, 0.5), 0.1, 400.0
    lat, lon, h = from_local(
        (0.0, 0.0, 0.0), radius * np.sin(rate * time), radius * (1 - np.cos(rate * time)), 0 * time
    )
    motion = through(Points(time, lat, lon, 0 * h))
    inside = np.linspace(5, 55, 200)
    states = motion.state(inside)
    roll, pitch, heading = states.euler.T
    assert roll == pytest.approx(np.full(200, np.arctan(rate**2 * radius / 9.81)), abs=2e-3)
    assert pitch == pytest.approx(np.zeros(200), abs=1e-3)
    course = np.arctan2(states.v[:, 1], states.v[:, 0])
    assert np.angle(np.exp(1j * (heading - course))) == pytest.approx(np.zeros(200), abs=1e-3)
    assert np.abs(motion.sensed(inside)[:, 4]).max() < 0.05


def test_across_the_pole_and_the_date_line() -> None:
    lat = np.radians([89.9, 89.95, 89.99, 89.99, 89.95, 89.9])
    lon = np.radians([170.0, 170.0, 170.0, -10.0, -10.0, -10.0])
    level = np.tile([1.0, 0.0, 0.0, 0.0], (6, 1))  # the body turns with north
    level[3:] = [0.0, 0.0, 0.0, 1.0]
    time = 60.0 * np.array([0.0, 5.0, 9.0, 11.0, 15.0, 20.0])
    motion = through(Points(time, lat, lon, np.full(6, 1e4), level))
    states = motion.state(time)
    assert states.lat == pytest.approx(lat, abs=1e-14)
    assert np.angle(np.exp(1j * (states.lon - lon))) == pytest.approx(np.zeros(6), abs=1e-9)
    assert np.abs(np.einsum("ij,ij->i", states.q, level)) == pytest.approx(np.ones(6), abs=1e-12)
    speed = np.linalg.norm(motion.state(np.linspace(0, 1200, 50)).v, axis=1)
    assert 15 < speed.min() < speed.max() < 25  # 22 km in 20 minutes, no leap at the pole
    line = through(
        Points(np.arange(3.0), np.zeros(3), np.radians([179.9, 180.0, -179.9]), np.zeros(3))
    )
    assert line.state(np.array([1.5])).v[0, 1] == pytest.approx(
        0.1 * np.pi / 180 * 6378137, rel=1e-9
    )


def test_places_there_and_back() -> None:
    generator = np.random.default_rng(2)
    lat = np.concatenate(
        (generator.uniform(-np.pi / 2, np.pi / 2, 200), [np.pi / 2, -np.pi / 2, 0])
    )
    lon, h = generator.uniform(-np.pi, np.pi, 203), generator.uniform(-1e4, 1e6, 203)
    back = geodetic(*earth_fixed(lat, lon, h))
    assert back[0] == pytest.approx(lat, abs=5e-16 * 4)
    assert back[1] == pytest.approx(lon, abs=1e-15)
    assert back[2] == pytest.approx(h, abs=5e-9)
    # a plane leaves the ellipsoid as the square of the distance over twice the radius
    north = from_local((0.0, 0.0, 0.0), np.array([0.0]), np.array([1e4]), np.array([0.0]))
    assert north[2][0] == pytest.approx(1e8 / (2 * 6378137.0), rel=1e-5)
    # the poles' radius, b = a (1 - f)
    pole = geodetic(np.array([0.0]), np.array([0.0]), np.array([6356752.314245179 + 7.0]))
    assert (pole[0][0], pole[2][0]) == (pytest.approx(np.pi / 2), pytest.approx(7.0, abs=2e-9))


@pytest.mark.parametrize(
    ("points", "said"),
    [
        (Points(np.zeros(1), np.zeros(1), np.zeros(1), np.zeros(1)), "give two points at least"),
        (
            Points(np.array([5.0, 5.0001]), np.zeros(2), np.zeros(2), np.zeros(2)),
            "0.0001 s apart, give points 0.0005 s apart or more",
        ),
        (
            Points(np.arange(2.0), *np.zeros((3, 2)), q=np.array([[1.0, 0, 0, 0], [0, 0, 0, 1.0]])),
            "the attitude turns by 180°, give points between them",
        ),
        (
            Points(
                np.array([0, 1, 2, 3.3, 4]), np.array([0, 1e-4, 2e-4, 1e-4, 0]), *np.zeros((2, 5))
            ),
            "where the nose cannot follow, give attitude too",
        ),
        (
            Points(np.arange(4.0), np.array([1.5, 1.0, 0.0, -1.0]), np.zeros(4), np.zeros(4)),
            "give the trajectory in parts",
        ),
    ],
)
def test_what_makes_no_motion_is_refused(points: Points, said: str) -> None:
    with pytest.raises(InputError, match=said):
        through(points)


def test_points_so_far_apart() -> None:
    time = np.arange(11) * 0.1
    thinned = Points(time, time, time, time).apart(0.3)
    assert thinned.time == pytest.approx([0.0, 0.3, 0.6, 1.0])
