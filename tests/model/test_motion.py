"""Truth motions: their states, rates and increments agree with each other and with geometry."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from math import cos, pi, radians, sin

import numpy as np
import pytest
from numpy.typing import NDArray

from sculler_model import motion
from sculler_model.frames import gravity, gravity_lean, to_dcm
from sculler_model.motion import Coning, Curve, Motion, Sculling, at_rest, turn_motion
from sculler_model.motion.sampling import panel_rule
from sculler_model.navigation import NavHistory

RATE, A, F = 7.292115e-5, 6378137.0, 1 / 298.257223563
E2 = F * (2 - F)
SHAKEN = turn_motion(coning_half_angle=0.004, rocking=0.003, shaking=10.0, bank=0.3)
TURN = turn_motion(speed=40.0, turn_rate=0.3, bank=0.3)
TIMES = np.linspace(0.1, 30, 7)


def sixth_order(f: Callable[[NDArray], NDArray], t: NDArray, step: float) -> NDArray:
    """First derivative by central differences."""
    d = [f(t + k * step) - f(t - k * step) for k in (1, 2, 3)]
    return (45 * d[0] - 9 * d[1] + d[2]) / (60 * step)


def sixth_order_second(f: Callable[[NDArray], NDArray], t: NDArray, step: float) -> NDArray:
    """Second derivative by central differences."""
    s = [f(t + k * step) + f(t - k * step) for k in (1, 2, 3)]
    return (270 * s[0] - 27 * s[1] + 2 * s[2] - 490 * f(t)) / (180 * step**2)


def local_frame(state: NavHistory, t: NDArray) -> NDArray:
    """Axes north, east, down as columns, in inertial space (N, 3, 3)."""
    lat, lon = state.lat, state.lon + RATE * t
    s, c, sl, cl = np.sin(lat), np.cos(lat), np.sin(lon), np.cos(lon)
    north = np.stack((-s * cl, -s * sl, c), 1)
    east = np.stack((-sl, cl, 0 * lat), 1)
    return np.stack((north, east, np.cross(north, east)), 2)


def inertial_position(where: Motion, t: NDArray) -> NDArray:
    state = where.state(t)
    lat, lon, h = state.lat, state.lon + RATE * t, state.h
    normal = A / np.sqrt(1 - E2 * np.sin(lat) ** 2)
    across = (normal + h) * np.cos(lat)
    up = (normal * (1 - E2) + h) * np.sin(lat)
    return np.stack((across * np.cos(lon), across * np.sin(lon), up), 1)


def plumb_bob(state: NavHistory) -> NDArray:
    """Gravity, north, east, down (N, 3)."""
    sin_lat, cos_lat = np.sin(state.lat), np.cos(state.lat)
    north = cos_lat * gravity_lean(sin_lat, state.h)
    return np.stack((north, 0 * north, gravity(sin_lat, state.h)), 1)


def body_frame(where: Motion, t: NDArray) -> NDArray:
    """Axes of the body as columns, in inertial space (N, 3, 3)."""
    state = where.state(t)
    C_nb = np.array([to_dcm(tuple(q)) for q in state.q.tolist()])
    return local_frame(state, t) @ C_nb


@pytest.mark.parametrize("where", [SHAKEN, TURN, at_rest(0.8, 2.0, 50.0, 0.1, 0.2, 3.0)])
def test_sensed_rate_is_the_turning_of_the_body_in_inertial_space(where: Motion) -> None:
    turning = sixth_order(lambda t: body_frame(where, t), TIMES, 2e-4)
    skew = np.swapaxes(body_frame(where, TIMES), 1, 2) @ turning
    rate = np.stack((skew[:, 2, 1], skew[:, 0, 2], skew[:, 1, 0]), 1)
    assert np.allclose(where.sensed(TIMES)[:, :3], rate, atol=2e-9)


def test_sensed_force_is_the_acceleration_in_inertial_space_less_gravitation() -> None:
    times = TIMES.astype(np.longdouble)  # positions of 6.4e6 m are differenced twice
    acceleration = sixth_order_second(lambda t: inertial_position(TURN, t), times, 0.02)
    state, position = TURN.state(times), inertial_position(TURN, times)
    # gravitation = plumb-bob gravity + centrifugal acceleration taken back
    plumb = np.einsum("nij,nj->ni", local_frame(state, times), plumb_bob(state))
    centripetal = -(RATE**2) * position * np.array([1, 1, 0])
    force = acceleration - (plumb + centripetal)
    in_body = np.einsum("nij,ni->nj", body_frame(TURN, times), force)
    assert np.allclose(TURN.sensed(TIMES)[:, 3:], in_body.astype(float), atol=3e-7)


@pytest.mark.parametrize("where", [SHAKEN, TURN])
def test_velocity_is_the_rate_of_position(where: Motion) -> None:
    position = sixth_order(lambda t: inertial_position(where, t), TIMES.astype(np.longdouble), 5e-4)
    position -= np.cross([0, 0, RATE], inertial_position(where, TIMES))
    state = where.state(TIMES)
    velocity = np.einsum("nij,ni->nj", local_frame(state, TIMES), position)
    assert np.allclose(state.v, velocity.astype(float), atol=1e-8)


def test_sensed_force_is_the_rate_of_velocity_with_vibration() -> None:
    """The navigation equation itself, its left side by differences of the true velocity."""
    state = SHAKEN.state(TIMES)
    change = sixth_order(lambda t: SHAKEN.state(t).v, TIMES, 2e-4)
    turning = sixth_order(lambda t: local_frame(SHAKEN.state(t), t), TIMES, 0.05)
    frame = local_frame(state, TIMES)
    skew = np.swapaxes(frame, 1, 2) @ turning
    inertial_rate = np.stack((skew[:, 2, 1], skew[:, 0, 2], skew[:, 1, 0]), 1)
    earth = np.einsum("nij,i->nj", frame, np.array([0, 0, RATE]))
    force = change + np.cross(inertial_rate + earth, state.v) - plumb_bob(state)
    C_nb = np.array([to_dcm(tuple(q)) for q in state.q.tolist()])
    expected = np.einsum("nij,ni->nj", C_nb, force)
    assert np.allclose(SHAKEN.sensed(TIMES)[:, 3:], expected, atol=1e-7)


def test_increments_are_the_integral_of_what_is_sensed() -> None:
    interval = 1 / 2000
    panels = 400  # Simpson's rule
    weights = np.ones(panels + 1)
    weights[1:-1:2], weights[2:-1:2] = 4, 2
    for number in (0, 3, 60001):
        t = interval * (number + np.arange(panels + 1) / panels)
        expected = interval / (3 * panels) * weights @ SHAKEN.sensed(t)
        assert np.allclose(SHAKEN.increments(1, interval, number)[0], expected, rtol=1e-12)


@pytest.mark.parametrize("phase", [0.0, 1e-3, 0.2, 1.0, 3.0, 30.0, 100.0])
def test_nodes_are_enough_for_the_wave(phase: float) -> None:
    nodes, weights = motion.legendre_nodes(phase)
    exact = (cos(0.4) - cos(0.4 + phase)) / phase if phase else sin(0.4)
    assert weights @ np.sin(0.4 + phase * nodes) == pytest.approx(exact, rel=1e-13, abs=1e-15)
    assert len(nodes) < 8 + phase


@pytest.mark.parametrize("phase", [0.0, 1e-6, 3e-3, 0.06])
def test_a_panel_integrates_polynomials_over_each_of_its_parts(phase: float) -> None:
    """In exact rationals: the mean of x^k from a to b is (b^(k+1) - a^(k+1))/(k+1)/(b - a)."""
    nodes, weights = panel_rule(phase)
    many = len(weights)
    assert many == 64
    places = [Fraction(node) for node in nodes.tolist()]
    for part, row in enumerate(weights.tolist()):
        a, b = Fraction(part, many), Fraction(part + 1, many)
        for k in range(len(places)):
            found = sum(Fraction(w) * x**k for w, x in zip(row, places, strict=True))
            exact = (b ** (k + 1) - a ** (k + 1)) / (k + 1) / (b - a)
            assert abs(float(found - exact)) < 2.5e-15


@pytest.mark.parametrize("phase", [0.0, 1e-6, 3e-3, 0.06, 0.25, 1.07, 5.0])
def test_a_panel_integrates_the_fastest_wave_over_each_of_its_parts(phase: float) -> None:
    nodes, weights = panel_rule(phase)
    many = len(weights)
    wave = many * phase
    bound = 3e-16 * (4 + wave)  # rounding of the phase
    means = np.sin(0.4 + wave * (np.arange(many) + 0.5) / many) * np.sinc(0.5 * phase / pi)
    assert weights @ np.sin(0.4 + wave * nodes) == pytest.approx(means, rel=1e-15, abs=bound)


def test_panels_are_short_where_a_curve_has_knots_and_for_the_fastest_waves() -> None:
    assert [len(panel_rule(0.5, rough).weights) for rough in (1e-3, 0.01, 0.1)] == [64, 8, 1]
    assert [len(panel_rule(phase).weights) for phase in (1.6, 6.0, 60.0)] == [32, 16, 1]
    assert motion.hour_flight(*motion.PLACE).rough > 0 == SHAKEN.rough


@pytest.mark.parametrize("name", ["demo", "coning", "spin-rock-size", "sculling"])
def test_fast_motions_are_integrated_sample_by_sample_as_well(name: str) -> None:
    """Against Gauss-Legendre quadrature of each sample, from where phases are small."""
    entry = motion.MOTIONS[name]
    where = entry.make() if name == "demo" else entry.make(*motion.PLACE)
    nodes, weights = np.polynomial.legendre.leggauss(12)
    t = (np.arange(200)[:, None] + 0.5 * (nodes + 1)) / 2000
    sensed = where.sensed(t.ravel()).reshape(200, 12, 6)
    exact = 0.5 / 2000 * np.einsum("g,ngc->nc", weights, sensed)
    size = np.repeat([np.abs(exact[:, :3]).max(), np.abs(exact[:, 3:]).max()], 3)
    assert np.abs((where.increments(200, 1 / 2000) - exact) / size).max() < 4e-13


def test_a_slow_motion_gives_the_same_samples_wherever_one_begins() -> None:
    slow = motion.hour_flight(*motion.PLACE)
    whole = slow.increments(300, 1 / 2000, 199_900)  # over a knot of the splines, at 100 s
    for first, count in ((0, 1), (31, 2), (99, 201)):
        part = slow.increments(count, 1 / 2000, 199_900 + first)
        assert np.array_equal(part, whole[first : first + count])
    # each by Gauss-Legendre quadrature of its own, six times as fine as it need be
    nodes, weights = np.polynomial.legendre.leggauss(12)
    t = (199_900 + np.arange(300)[:, None] + 0.5 * (nodes + 1)) / 2000
    exact = 0.5 / 2000 * np.einsum("g,ngc->nc", weights, slow.sensed(t.ravel()).reshape(300, 12, 6))
    size = np.repeat([np.abs(exact[:, :3]).max(), np.abs(exact[:, 3:]).max()], 3)
    assert np.abs((whole - exact) / size).max() < 2e-14


@pytest.mark.parametrize("interval", [1 / 2000, 1 / 500, 1 / 100])
def test_half_samples_add_up(interval: float) -> None:
    """Vibrations of 35 and 50 Hz: half a cycle of coning in the longest interval."""
    whole = SHAKEN.increments(200, interval)
    halves = SHAKEN.increments(400, interval / 2)
    size = np.abs(whole).max(axis=0)
    # rounding of the vibrations' phase, up to 600 rad, and of coning's two spins, which cancel
    bound = 1e-13 * size + 3e-16 * 2 * pi * 50 * interval
    assert np.all(np.abs(halves[::2] + halves[1::2] - whole) <= bound)


def test_at_rest_the_increments_are_earth_rate_and_gravity() -> None:
    lat, heading, interval = radians(40), radians(30), 0.01
    inc = at_rest(lat, 0.1, 0.0, heading=heading).increments(3, interval)
    north, down = RATE * cos(lat), -RATE * sin(lat)
    expected = np.array([north * cos(heading), -north * sin(heading), down]) * interval
    assert np.allclose(inc[:, :3], expected, rtol=1e-14)
    assert np.allclose(inc[:, 3:5], 0, atol=1e-17)
    assert np.allclose(inc[:, 5], -9.80171 * interval, rtol=1e-5)


def test_filtered_rates_are_the_mean_about_the_instant() -> None:
    interval = 1e-3
    filtered = SHAKEN.rates(20, interval, 5)
    shifted = SHAKEN.increments(40, interval / 2, 2 * 5 - 1) / (interval / 2)
    assert np.allclose(filtered, 0.5 * (shifted[0::2] + shifted[1::2]), rtol=1e-12, atol=1e-13)
    plain = SHAKEN.rates(20, interval, 5, filtered=False)
    assert np.allclose(plain, SHAKEN.sensed(interval * np.arange(5, 25)), rtol=1e-12)


@pytest.mark.parametrize("kind", ["increment", "rate"])
def test_chunks_join_without_a_seam(kind: str) -> None:
    chunks = list(SHAKEN.chunks(kind, 250, 1 / 2000, chunk=100))  # type: ignore[arg-type]
    assert [len(chunk) for chunk in chunks] == [100, 100, 50]
    whole = (SHAKEN.increments if kind == "increment" else SHAKEN.rates)(250, 1 / 2000)
    assert np.array_equal(np.concatenate(chunks), whole)


@pytest.mark.parametrize("order", [0, 1, 2])
def test_curve_derivatives(order: int) -> None:
    curve = Curve((1.0, -2.0, 3.0, 0.5), ((0.7, 2.0, 0.3),)) + Curve((0.0, 1.0))
    t = np.array([0.0, 0.5, 2.0])
    expected = {
        0: 1 - t + 3 * t**2 + 0.5 * t**3 + 0.7 * np.sin(2 * t + 0.3),
        1: -1 + 6 * t + 1.5 * t**2 + 1.4 * np.cos(2 * t + 0.3),
        2: 6 + 3 * t - 2.8 * np.sin(2 * t + 0.3),
    }
    assert np.allclose(curve(t, order), expected[order], atol=1e-14)


CONE = Coning(half_angle=0.2, omega=2 * pi * 7)


def test_coning_rate_turns_its_attitude() -> None:
    """Quaternion kinematics q' = ½ q ω, with ω from tiny increments."""
    t, tiny = 0.37, 1e-6
    (w, x, y, z) = CONE.attitude(np.array([t]))[0]
    change = sixth_order(CONE.attitude, np.array([t]), 1e-4)[0]
    conj = np.array(
        [[w, x, y, z], [-x, w, z, -y], [-y, -z, w, x], [-z, y, -x, w]]
    )  # q* as a matrix from the left
    rate = 2 * (conj @ change)
    assert rate[0] == pytest.approx(0, abs=1e-9)
    inc = CONE.increments(1, tiny, round(t / tiny))[0, :3] / tiny
    assert np.allclose(inc, rate[1:], atol=2e-3)
    assert np.allclose(CONE.rates(1, t, 1, filtered=False)[0, :3], rate[1:], atol=1e-8)


def test_coning_increments_and_filtered_rates_are_integrals() -> None:
    interval = 1e-3
    node, weight = np.polynomial.legendre.leggauss(8)
    times = interval * (5 + 0.5 * (node + 1))
    rates = np.array([CONE.rates(1, t, 1, filtered=False)[0, :3] for t in times])
    inc = CONE.increments(1, interval, 5)[0, :3]
    assert np.allclose(inc, 0.5 * interval * weight @ rates, rtol=1e-14)
    steps = CONE.increments(30, interval / 2)[:, :3]
    assert np.allclose(
        CONE.rates(9, interval, 1)[:, :3] * interval, steps[1:19:2] + steps[2:20:2], atol=1e-16
    )


def test_sculling_mean_force_is_the_average_over_a_cycle() -> None:
    scull = Sculling(angle=0.3, force=20.0, omega=2 * pi * 30)
    phase = 2 * pi * np.arange(64) / 64
    assert scull.mean_force == pytest.approx(
        np.mean(20 * np.sin(phase) * np.sin(0.3 * np.sin(phase))), rel=1e-14, abs=0
    )
    inc = scull.increments(1, 1e-7, round(0.0123 / 1e-7))[0] / 1e-7
    expected = [0.3 * scull.omega * cos(scull.omega * 0.0123), 20 * sin(scull.omega * 0.0123)]
    assert np.allclose(inc[[0, 4]], expected, rtol=1e-4)
    assert np.count_nonzero(inc) == 2


def test_demo_motion_has_coning_and_sculling_to_correct() -> None:
    """Products of neighbouring samples rectify as Yang Eq. 8 says, for both vibrations."""
    inc = motion.demo_motion().increments(4000, 1 / 2000)

    def rectified(a: NDArray, b: NDArray) -> float:
        return float(np.sum(a[:-1] * b[1:] - a[1:] * b[:-1])) / 3999

    def product(a: float, b: float, hertz: float) -> float:
        phase = 2 * pi * hertz / 2000
        return a * b * 4 * sin(phase / 2) ** 2 * sin(phase)

    cone = product(sin(radians(0.1)), sin(radians(0.1)), 50)
    scull = product(radians(0.1), 10 / (2 * pi * 35), 35)
    assert rectified(inc[:, 0], inc[:, 1]) == pytest.approx(cone, rel=0.01, abs=0)
    assert rectified(inc[:, 0], inc[:, 5]) == pytest.approx(-scull, rel=0.02, abs=0)
