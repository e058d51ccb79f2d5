"""The low-rate updater against truth: at rest, Schuler's pendulum, turns, long straight runs."""

from __future__ import annotations

from dataclasses import replace
from math import cosh, pi, radians, sin, sqrt

import numpy as np
import pytest
from numpy.typing import NDArray

from host_path import fine_design, through_core
from sculler_model.errors import InputError
from sculler_model.frames import (
    EARTH_RATE,
    conjugate,
    from_euler,
    gravity,
    product,
    radii,
    to_rotation_vector,
)
from sculler_model.host import MajorIncrements, velocity_rotation
from sculler_model.motion import Curve, Motion, at_rest, steady_attitude, turn_motion
from sculler_model.navigation import (
    GeographicNavigator,
    NavHistory,
    Navigator,
    NavState,
    navigate,
    trajectory,
)
from sculler_model.navigation.state import wrapped

LEVEL = NavState(0.0, (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.8, 0.2, 100.0)


def increments_of(where: Motion, count: int, interval: float) -> MajorIncrements:
    """Major increments straight from the truth; for motions of constant rate and force."""
    sums = where.increments(count, interval)
    alpha, upsilon = sums[:, :3], sums[:, 3:]
    return MajorIncrements(alpha, alpha, upsilon + velocity_rotation(alpha, upsilon))


def metres(found: NavHistory, true: NavHistory) -> NDArray[np.float64]:
    """(N, 3) position error north, east, down."""
    meridian, prime_vertical = radii(np.sin(true.lat))
    return np.stack(
        (
            (found.lat - true.lat) * (meridian + true.h),
            (found.lon - true.lon) * (prime_vertical + true.h) * np.cos(true.lat),
            true.h - found.h,
        ),
        axis=1,
    )


def tilt(found: NavHistory, true: NavHistory) -> NDArray[np.float64]:
    """(N, 3) attitude error, rad, in north-east-down."""
    pairs = zip(found.q.tolist(), true.q.tolist(), strict=True)
    return np.array([to_rotation_vector(product(tuple(a), conjugate(tuple(b)))) for a, b in pairs])


@pytest.mark.parametrize("mechanisation", [Navigator, GeographicNavigator])
@pytest.mark.parametrize("lat", [0.0, 35.0, -62.0, 88.0])
def test_at_rest_on_the_turning_earth_it_stays_put(
    lat: float, mechanisation: type[Navigator]
) -> None:
    """One hour of exact increments at 1 s majors: rounding, which the vertical blows up."""
    where = at_rest(radians(lat), -2.0, 250.0, roll=0.1, pitch=-0.3, heading=2.0)
    count = 3600
    start = where.state(np.zeros(1)).state(0)
    found = navigate(start, 1.0, increments_of(where, count, 1.0), mechanisation)
    true = where.state(np.arange(count + 1.0))
    error = np.abs(metres(found, true)).max(axis=0)
    instability = sqrt(2 * 9.8 / 6.37e6)
    rounding = 2e-14  # of 9.8 m in an interval
    assert error[:2].max() < 1e-5
    assert error[2] < rounding / instability**2 * (cosh(instability * count) - 1)
    assert np.abs(tilt(found, true)).max() < 1e-11


def test_at_rest_for_a_minute_at_100_hz_it_moves_less_than_a_micrometre() -> None:
    where = at_rest(radians(48), 0.2, 500.0, heading=1.0)
    found = navigate(where.state(np.zeros(1)).state(0), 0.01, increments_of(where, 6000, 0.01))
    assert np.abs(metres(found, where.state(0.01 * np.arange(6001)))).max() < 1e-6
    assert np.abs(found.v).max() < 1e-8


def test_a_small_tilt_swings_with_schulers_period() -> None:
    """84.4 minutes: velocity gδ/ω sin ωt, with ω² = g/R."""
    where = at_rest(0.0, 0.0, 0.0)  # at the equator Foucault's rotation is zero
    truth = where.state(np.zeros(1)).state(0)
    delta, count = 1e-5, 5400
    tilted = truth._replace(q=from_euler(0.0, delta, 0.0))
    found = navigate(tilted, 1.0, increments_of(where, count, 1.0))
    meridian, _ = radii(0.0)
    omega = sqrt(gravity(0.0, 0.0) / meridian)
    north = found.v[:, 0]
    crossings = np.flatnonzero(np.sign(north[1:-1]) != np.sign(north[2:])) + 2
    # a rotating Earth couples in the heading: (Earth's rate / Schuler's)² is 0.35 %
    assert crossings / 60 == pytest.approx([pi / omega / 60, 2 * pi / omega / 60], rel=4e-3, abs=0)
    assert 2 * pi / omega / 60 == pytest.approx(84.4, abs=0.5)
    speed = gravity(0.0, 0.0) * delta / omega
    assert np.abs(north).max() == pytest.approx(speed, rel=0.03, abs=0)


@pytest.mark.parametrize(
    ("vibration", "limits"),
    [
        # plain turn: the trapezoid and the extrapolation, second order in 10 ms
        ({}, (6e-5, 3e-8, 2e-11)),
        # third order of the rotation vector, coning² times turn rate: 2.6e-8 rad/s here
        ({"coning_half_angle": radians(0.05)}, (7e-4, 7e-5, 7e-7)),
        # the trapezoid samples a 45 mm/s vibration: a fraction of a millimetre
        ({"rocking": radians(0.05), "shaking": 10.0}, (3e-4, 2e-5, 2e-7)),
    ],
)
def test_a_turning_vehicle_through_the_integers(
    vibration: dict[str, float], limits: tuple[float, float, float]
) -> None:
    design = fine_design(4, minors=5, gyro_lsb=1e-12, accel_lsb=1e-11)
    where = turn_motion(**vibration)
    majors = 2000  # 20 s, a third of the circle
    samples = where.chunks("increment", majors * design.samples_per_major, design.sample_interval)
    true = where.state(design.major_interval * np.arange(majors + 1))
    found = navigate(true.state(0), design.major_interval, through_core(design, samples))
    metre, speed, angle = limits
    assert np.abs(metres(found, true)).max() < metre
    assert np.abs(found.v - true.v).max() < speed
    assert np.abs(tilt(found, true)).max() < angle


def test_errors_fall_with_the_square_of_the_interval() -> None:
    where = turn_motion(speed=100.0, turn_rate=0.2)
    errors = []
    for interval in (0.2, 0.1, 0.05):
        count = round(10 / interval)
        true = where.state(interval * np.arange(count + 1))
        found = navigate(true.state(0), interval, increments_of(where, count, interval))
        errors.append(np.linalg.norm(metres(found, true)[-1]))
    ratios = np.array(errors[:-1]) / np.array(errors[1:])
    assert np.all((ratios > 3.5) & (ratios < 4.5))


@pytest.mark.parametrize(
    ("lat", "lon", "north", "east"),
    [
        (0.0, 10.0, 0.0, 250.0),  # along the equator
        (-0.5, 179.9, 250.0, 50.0),  # over the equator and the date line eastward
        (60.0, -179.95, 100.0, -250.0),  # and westward
        (85.0, 40.0, 0.0, 250.0),  # fast around the pole: large transport rate
    ],
)
def test_a_quarter_of_an_hour_straight_on(
    lat: float, lon: float, north: float, east: float
) -> None:
    where = Motion(
        radians(lat),
        radians(lon),
        10e3,
        north=Curve((0.0, north)),
        east=Curve((0.0, east)),
        turns=steady_attitude(0.05, 0.02, 1.3),
    )
    interval, count = 0.1, 9000
    true = where.state(interval * np.arange(count + 1))
    found = navigate(true.state(0), interval, increments_of(where, count, interval))
    lon_error = (found.lon - true.lon + pi) % (2 * pi) - pi
    found = NavHistory(found.time, found.q, found.v, found.lat, true.lon + lon_error, found.h)
    assert np.abs(metres(found, true)).max() < 3e-4  # of 225 km
    assert np.abs(found.v - true.v).max() < 3e-7
    assert np.abs(tilt(found, true)).max() < 1.5e-10


def test_longitude_stays_within_half_a_turn() -> None:
    where = Motion(0.1, pi - 1e-6, 0.0, east=Curve((0.0, 200.0)))
    found = navigate(where.state(np.zeros(1)).state(0), 0.1, increments_of(where, 100, 0.1))
    assert found.lon[-1] < -3.14
    assert np.abs(found.lon).max() <= pi


def test_free_fall_is_gravity_alone() -> None:
    nothing = MajorIncrements(*np.zeros((3, 100, 3)))
    found = navigate(LEVEL._replace(lat=0.0), 0.01, nothing)
    assert found.v[-1, 2] == pytest.approx(gravity(0.0, 100.0), rel=1e-5, abs=0)
    assert found.h[-1] == pytest.approx(100 - gravity(0.0, 100.0) / 2, rel=1e-5, abs=0)
    # the frame turns under a body at rest in inertial space: Earth's rate, backwards
    assert found.euler[-1, 0] == pytest.approx(-EARTH_RATE, rel=1e-4, abs=0)


def test_streaming_is_the_whole() -> None:
    where = turn_motion()
    inc = increments_of(where, 100, 0.01)
    start = where.state(np.zeros(1)).state(0)
    whole = navigate(start, 0.01, inc)
    parts = list(trajectory(Navigator(start, 0.01), [inc[:30], inc[30:30], inc[30:]]))
    assert [len(part) for part in parts] == [30, 0, 70]
    joined = NavHistory.concatenate(parts)
    for name in ("time", "q", "v", "lat", "lon", "h"):
        assert np.array_equal(getattr(joined, name), getattr(whole, name)[1:])
    assert whole.time[0] == 0
    assert whole.time[-1] == pytest.approx(1.0, abs=1e-15)
    assert whole.state(0) == start


@pytest.mark.parametrize("compiled", [True, False])
def test_compiled_code_is_asked_for_where_it_is_wanted_alone(
    compiled: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The numbers are the same, so they do not tell."""
    asked = []

    def none_there() -> None:
        asked.append(True)

    monkeypatch.setattr("sculler_model.navigation.navigator.required_run", none_there)
    still = increments_of(at_rest(LEVEL.lat, 0.0, 0.0), 3, 0.01)
    Navigator(LEVEL, 0.01).run(still, compiled=compiled)
    assert bool(asked) == compiled


def test_another_mechanisation_takes_its_place() -> None:
    class Frozen:
        def __init__(self, state: NavState, interval: float) -> None:
            self.state = state

        def run(self, increments: MajorIncrements) -> NavHistory:
            return NavHistory.from_states([self.state] * len(increments))

    found = navigate(LEVEL, 0.01, MajorIncrements(*np.ones((3, 4, 3))), Frozen)
    assert len(found) == 5
    assert np.all(found.lat == LEVEL.lat)


@pytest.mark.parametrize("mechanisation", [Navigator, GeographicNavigator])
def test_the_quaternion_keeps_its_length_and_time_its_steps(
    mechanisation: type[Navigator],
) -> None:
    navigator = mechanisation(LEVEL, 1e-6)
    for _ in range(20_000):
        navigator.update((0.01, -0.02, 0.015), (0.0, 0.0, -9.81e-6))
    assert sum(c * c for c in navigator.state.q) == pytest.approx(1, abs=1e-15)
    assert navigator.state.time == pytest.approx(0.02, abs=1e-16)


def test_states_in_other_terms() -> None:
    state = LEVEL._replace(q=from_euler(0.1, 0.2, 3.0), v=(1.0, 2.0, 3.0), wander=-1.0)
    assert state.v_enu == (2.0, 1.0, -3.0)
    assert state.euler == pytest.approx((0.1, 0.2, 3.0))
    assert state.azimuth == pytest.approx(4.0 - 2 * pi)
    history = NavHistory.from_states([LEVEL, state])
    assert history.state(1) == state
    assert history.v_enu[1].tolist() == [2.0, 1.0, -3.0]
    assert history.azimuth == pytest.approx([0.0, 4.0 - 2 * pi])
    without = NavHistory(*(getattr(history, n) for n in ("time", "q", "v", "lat", "lon", "h")))
    assert without.wander.tolist() == [0.0, 0.0]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"lat": 1.0001 * pi / 2}, "latitude 90.009° is not allowed"),
        ({"lat": float("nan")}, "a value is not finite"),
        ({"wander": 3.2}, "wander angle 183.346°"),
        ({"lat": -2.0}, "latitude -114.592°"),
        ({"lon": 3.2}, "longitude 183.346°"),
        ({"h": -10001.0}, "height -10001 m is not allowed"),
        ({"h": 1.1e6}, "height 1.1e\\+06 m is not allowed"),
        ({"q": (1.0, 0.1, 0.0, 0.0)}, "quaternion has length 1.00499"),
        ({"v": (0.0, float("nan"), 0.0)}, "a value is not finite"),
        ({"time": float("inf")}, "a value is not finite"),
    ],
)
def test_bad_initial_states_are_refused(change: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=f"initial state: .*{message}"):
        Navigator(LEVEL._replace(**change), 0.01)  # type: ignore[arg-type]


@pytest.mark.parametrize("mechanisation", [Navigator, GeographicNavigator])
@pytest.mark.parametrize("interval", [0.0, -1.0, float("nan"), float("inf")])
def test_bad_interval_is_refused(interval: float, mechanisation: type[Navigator]) -> None:
    with pytest.raises(InputError, match="interval: "):
        mechanisation(LEVEL, interval)


def test_not_a_number_in_the_increments_is_refused() -> None:
    inc = MajorIncrements(*np.zeros((3, 5, 3)))
    inc.dv_sf[3, 1] = np.nan
    with pytest.raises(InputError, match="an increment is not finite"):
        navigate(LEVEL, 0.01, inc)
    navigator = Navigator(LEVEL, 0.01)
    with pytest.raises(InputError, match=r"after 0\.000 s: an increment is not finite"):
        navigator.run(inc)
    with pytest.raises(InputError, match="an increment is not finite"):
        navigator.update((0.0, float("inf"), 0.0), (0.0, 0.0, 0.0))
    with pytest.raises(InputError, match="an increment is not finite"):
        navigator.update((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (float("nan"), 0.0, 0.0))
    assert navigator.state == LEVEL


def test_leaving_the_earth_is_refused() -> None:
    up = NavState(0.0, LEVEL.q, (0.0, 0.0, -5e5), 0.8, 0.2, 0.0)
    navigator = Navigator(up, 0.5)
    message = r"time 2\.500 s: the height has run away to 1\.\d*e\+06 m"
    for _ in range(4):
        navigator.update((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    with pytest.raises(InputError, match=message):
        navigator.update((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    with pytest.raises(InputError, match=message):
        navigate(up, 0.5, MajorIncrements(*np.zeros((3, 10, 3))))


def test_flying_into_the_pole_is_refused() -> None:
    start = LEVEL._replace(lat=radians(89.9999), v=(300.0, 0.0, 0.0))
    g = gravity(sin(start.lat), start.h)
    inc = MajorIncrements(
        np.zeros((500, 3)), np.zeros((500, 3)), np.tile([0, 0, -g * 0.1], (500, 1))
    )
    with pytest.raises(InputError, match=r"time \d+\.\d+ s: the track has reached a pole"):
        navigate(start, 0.1, inc, GeographicNavigator)
    with pytest.raises(InputError, match="at a pole there is no north"):
        GeographicNavigator(start._replace(lat=-pi / 2), 0.1)


def test_increments_of_unlike_shapes_are_refused() -> None:
    inc = MajorIncrements(np.zeros((5, 3)), np.zeros((5, 3)), np.zeros((4, 3)))
    with pytest.raises(InputError, match=r"shapes \(5, 3\), \(4, 3\) differ, give \(R, 3\) each"):
        Navigator(LEVEL, 0.01).run(inc)


def test_azimuths_are_brought_to_half_a_turn() -> None:
    """Heading less wander angle, of a state and of many."""
    for heading, wander, azimuth in (
        (3.0, -3.0, 6.0 - 2 * pi),
        (-3.0, 3.0, 2 * pi - 6.0),
        (1.0, -2.0, 3.0),
        (-1.0, 2.0, -3.0),
    ):
        state = LEVEL._replace(q=from_euler(0.0, 0.0, heading), wander=wander)
        assert state.azimuth == pytest.approx(azimuth)
        assert NavHistory.from_states([state]).azimuth == pytest.approx([azimuth])
    assert [wrapped(angle) for angle in (pi, -pi)] == [pi, -pi]
    assert wrapped(pi + 0.5) == pytest.approx(0.5 - pi)
    assert wrapped(-pi - 0.5) == pytest.approx(pi - 0.5)


def test_times_count_from_the_start_by_intervals() -> None:
    """Of single updates and of runs, one after another, with nothing in between."""
    still = MajorIncrements(*np.zeros((3, 3, 3)))
    for kind in (Navigator, GeographicNavigator):
        navigator = kind(LEVEL._replace(time=100.0), 0.25)
        told = [navigator.update((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)).time]
        told += navigator.run(still).time.tolist()
        assert len(navigator.run(still[:0])) == 0
        told += navigator.run(replace(still[:0], times=np.zeros(0))).time.tolist()
        told += [navigator.update((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)).time]
        assert told == [100.25, 100.5, 100.75, 101.0, 101.25]


def test_a_displacement_that_is_not_finite_is_refused() -> None:
    inc = MajorIncrements(*np.zeros((4, 5, 3)))
    assert inc.dr_sf is not None
    inc.dr_sf[3, 1] = np.nan
    with pytest.raises(InputError, match=r"after 0\.000 s: an increment is not finite"):
        navigate(LEVEL, 0.01, inc)


def test_the_geographic_mechanisation_has_no_use_for_displacements() -> None:
    g = gravity(sin(LEVEL.lat), LEVEL.h)
    still = np.zeros((5, 3))
    inc = MajorIncrements(still, still, np.tile([0.1, 0, -g * 0.01], (5, 1)), still + 7)
    plain = replace(inc, dr_sf=None)
    found, same = (navigate(LEVEL, 0.01, each, GeographicNavigator) for each in (inc, plain))
    assert np.array_equal(found.lat, same.lat)
    assert not np.array_equal(navigate(LEVEL, 0.01, inc).lat, navigate(LEVEL, 0.01, plain).lat)
