"""Errors against truth: put in by hand and found again, at the poles too, whole and in blocks."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from math import pi, radians

import numpy as np
import pytest
from numpy.typing import NDArray

from sculler_model.errors import InputError
from sculler_model.frames import from_rotation_vector, product, radii
from sculler_model.motion import great_circle, hour_flight, over_the_pole
from sculler_model.navigation import Comparison, NavHistory, interpolated, navigation_errors
from sculler_model.navigation.errors import NAUTICAL_MILE
from sculler_model.navigation.interpolation import slack

FLIGHT = hour_flight(radians(48), radians(11), 500.0)


def turned(q: NDArray, phi: tuple[float, float, float]) -> NDArray:
    """Attitudes after one more rotation, seen from north-east-down."""
    return np.array([product(from_rotation_vector(phi), tuple(row)) for row in q.tolist()])


def test_errors_put_in_are_found() -> None:
    truth = FLIGHT.state(np.linspace(200, 3000, 9))
    phi = (3e-5, -2e-5, 5e-5)
    meridian, prime_vertical = radii(np.sin(truth.lat))
    north, east, down = 3.0, -4.0, 7.0
    estimate = replace(
        truth,
        q=turned(truth.q, phi),
        v=truth.v + np.array([0.1, -0.2, 0.3]),
        lat=truth.lat + north / (meridian + truth.h),
        lon=truth.lon + east / ((prime_vertical + truth.h) * np.cos(truth.lat)) + 2 * pi,
        h=truth.h - down,
    )
    errors = navigation_errors(estimate, truth)
    # further west, north points tan(lat)/R a metre further east: that is not counted as an error
    convergence = -east / (prime_vertical + truth.h) * np.tan(truth.lat)
    expected = np.tile(phi, (9, 1)) + np.outer(convergence, [0, 0, 1])
    assert np.allclose(errors.attitude, expected, rtol=1e-4, atol=1e-10)
    c, v = convergence, truth.v
    twist = np.stack((-c * v[:, 1], c * v[:, 0], 0 * c), 1)
    assert np.allclose(errors.velocity, np.array([0.1, -0.2, 0.3]) + twist, atol=1e-6)
    assert np.allclose(errors.position, [north, east, down], atol=2e-5)
    assert np.allclose(errors.horizontal, 5.0, atol=2e-5)


def test_nothing_is_wrong_with_the_truth_itself() -> None:
    truth = over_the_pole(before=300).state(np.linspace(0, 600, 61))
    errors = navigation_errors(truth, truth)
    for table in (errors.attitude, errors.velocity, errors.position):
        assert np.abs(table).max() < 1e-13


def test_at_a_pole_the_errors_are_as_elsewhere() -> None:
    """Two tracks 10 m apart across the pole: the estimate is behind, nothing else is wrong.

    The truth's and the estimate's norths are turned by up to 180° against each other.
    """
    motion = over_the_pole(h=0.0, speed=100.0, before=1.0)
    t = np.array([0.5, 0.95, 1.02, 1.06, 1.8])
    truth, estimate = motion.state(t), replace(motion.state(t - 0.1), time=t)
    errors = navigation_errors(estimate, truth)
    assert np.allclose(np.linalg.norm(errors.attitude, axis=1), 0, atol=1e-9)
    assert np.allclose(np.linalg.norm(errors.velocity, axis=1), 0, atol=1e-9)
    assert np.allclose(errors.horizontal, 10, atol=1e-6)
    assert np.abs(errors.position[:, 2]).max() < 1e-8


def test_half_a_world_away_north_is_carried_the_shortest_way() -> None:
    """Along the equator, up a meridian, and over the pole, where it points south from then on."""
    zero = np.zeros(1)

    def at(lat: float, lon: float, north: float) -> NavHistory:
        heading = np.array([from_rotation_vector((0, 0, 0 if north > 0 else pi))])
        v = np.array([[north, 0.0, 2.0]])
        return NavHistory(zero, heading, v, zero + radians(lat), zero + radians(lon), zero)

    for truth, estimate in (
        (at(0, 0, 3), at(0, 90, 3)),
        (at(-10, 20, 3), at(50, 20, 3)),
        (at(60, 0, -3), at(60, 180, 3)),
        (at(60, -90, 3), at(40, 90, -3)),
    ):
        errors = navigation_errors(estimate, truth)
        assert errors.attitude == pytest.approx(0, abs=1e-12)
        assert errors.velocity == pytest.approx(0, abs=1e-12)


def test_interpolation_on_a_smooth_track() -> None:
    motion = great_circle(0.7, pi - 1e-4, 9000.0, 1.3, 250.0)  # across 180°, too
    whole = motion.state(np.arange(0, 20.0))
    times = np.array([0.0, 0.25, 3.5, 7.0, 7.9, 19.0])
    found, count = interpolated(whole, times)
    assert count == 3
    errors = navigation_errors(found, motion.state(times))
    assert np.abs(errors.position).max() < 1e-6  # a cubic's error, x'''' h⁴/384, and rounding
    assert np.abs(errors.velocity).max() < 250 * (250 / 6.4e6) ** 2 / 8 + 1e-9
    assert np.abs(errors.attitude).max() < 1e-9
    exact = found.rows(np.array([0, 3, 5]))
    assert np.array_equal(exact.q, whole.q[[0, 7, 19]])
    assert np.array_equal(exact.lon, whole.lon[[0, 7, 19]])


@pytest.mark.parametrize("step", [0.2, -0.2])
def test_between_two_places_beside_180_degrees(step: float) -> None:
    """A quarter and three quarters of the way across, not round the world."""
    lon = np.array([pi - 0.1, -pi + 0.1])[:: 1 if step > 0 else -1]
    q, zero = np.array([(1.0, 0, 0, 0)] * 2), np.zeros(2)
    history = NavHistory(np.array([0.0, 4.0]), q, np.full((2, 3), np.nan), zero, lon, zero)
    found, _ = interpolated(history, np.array([1.0, 3.0]))
    turns = (found.lon - lon[0] - step * np.array([0.25, 0.75])) / (2 * pi)
    assert turns == pytest.approx(np.round(turns), abs=1e-15)


def test_a_steady_climb_is_met_between_its_states() -> None:
    """Down is against height: 10 m up in 2 s at 5 m/s is a straight line in height."""
    q, place = np.array([(1.0, 0, 0, 0)] * 2), np.full(2, 0.5)
    v = np.array([[0.0, 0.0, -5.0]] * 2)
    history = NavHistory(np.array([4.0, 6.0]), q, v, place, place, np.array([100.0, 110.0]))
    found, count = interpolated(history, np.array([4.5, 5.5]))
    assert count == 2
    assert found.h == pytest.approx([102.5, 107.5], rel=1e-15)
    assert found.v.tolist() == v.tolist()


def test_without_velocities_the_position_goes_straight() -> None:
    """And with them it is the cubic: 10 m up in 2 s, from rest to rest, 1.5625 m after ½ s."""
    q, still, place = np.array([(1.0, 0, 0, 0)] * 2), np.zeros((2, 3)), np.array([0.5, 0.6])
    times = np.array([4.0, 6.0])
    history = NavHistory(times, q, still, place, place, np.array([100.0, 110.0]))
    for known, h in ((True, 101.5625), (False, 102.5)):
        each = history if known else replace(history, v=np.full((2, 3), np.nan))
        found, count = interpolated(each, np.array([4.5, 6.0]))
        assert count == 1
        assert found.h == pytest.approx([h, 110.0], rel=1e-15)
        assert found.lat == pytest.approx([0.5 + 0.01 * (h - 100), 0.6], rel=1e-14)
        assert found.lon == pytest.approx(found.lat, rel=1e-14)
        assert np.isnan(found.v).all() != known


@pytest.mark.parametrize("start", [0.0, 1.4e9])
def test_the_same_instant_is_the_same_to_what_a_float_can_tell(start: float) -> None:
    """10 ns, and four places of a float where these are more: 0.95 µs since 1970."""
    near = 1e-8 if start == 0.0 else 4 * 2.0**-22
    assert slack(np.array([start, -start])) == pytest.approx([near, near], rel=1e-9)
    motion = great_circle(0.7, 0.1, 9000.0, 1.3, 250.0)
    history = motion.state(np.arange(3.0))
    object.__setattr__(history, "time", start + np.arange(3.0))
    for times, between in (([0.5, 0.75], 1), ([0.5, 1.25], 2)):
        asked = start + 1 + near * np.array([-times[0], times[1]])
        found, count = interpolated(history, asked)
        assert count == between - 1
        assert found.h[0] == history.h[1]


def test_what_a_truth_does_not_tell_is_no_error() -> None:
    """Position left out: its north is the estimate's.  Velocity or attitude: NaN, nothing else."""
    truth = FLIGHT.state(np.linspace(200, 300, 5))
    estimate = replace(
        truth,
        q=turned(truth.q, (3e-5, -2e-5, 5e-5)),
        v=truth.v + np.array([0.1, -0.2, 0.3]),
        h=truth.h - 4,
    )
    nothing = np.full(5, np.nan)
    placeless = navigation_errors(estimate, replace(truth, lat=nothing, lon=nothing, h=nothing))
    assert np.allclose(placeless.attitude, [3e-5, -2e-5, 5e-5], atol=1e-9)
    assert np.allclose(placeless.velocity, [0.1, -0.2, 0.3], atol=1e-9)
    assert np.isnan(placeless.position).all()
    speedless = navigation_errors(estimate, replace(truth, v=np.full((5, 3), np.nan)))
    assert np.isnan(speedless.velocity).all()
    assert np.allclose(speedless.position, [0, 0, 4], atol=1e-6)
    for each, known in (
        ({"v": np.full((201, 3), np.nan)}, {"attitude", "position"}),
        ({name: np.full(201, np.nan) for name in ("lat", "lon", "h")}, {"attitude", "velocity"}),
        ({"q": np.full((201, 4), np.nan)}, {"velocity", "position"}),
    ):
        told = Comparison(iter([replace(FLIGHT.state(RUN), **each)]), 0.01, "truth.csv")  # type: ignore[arg-type]
        told.add(drifting(RUN))
        told.finish()
        assert set(told.figures()) == set(told.known) == known
        growth = 2.0 if "position" in known else 0.0
        assert told.growth == pytest.approx(growth, rel=1e-5)


def test_a_row_within_twenty_steps_is_preferred_to_begin_with() -> None:
    """Rows between the run's instants but for one, so many steps of the sparser of the two on."""
    for at, exact in ((20, True), (21, False)):
        times = 0.1 * np.arange(40) + 0.003
        times[at + 1] = 0.1 * (at + 1)
        comparison = Comparison(iter([FLIGHT.state(times)]), 0.1, "truth.csv")
        found = comparison.start(0.1 * np.arange(40))
        assert found is not None
        assert found.interpolated != exact
        assert found.row == (at + 1 if exact else 1)


def test_a_truth_of_one_row_at_first_is_joined_with_what_follows() -> None:
    truth = FLIGHT.state(RUN)
    for sizes in ((1, 200), (2, 199), (1, 1, 199)):
        cuts = np.cumsum((0, *sizes))
        parts = [truth.rows(slice(a, b)) for a, b in pairwise(cuts.tolist())]
        comparison = Comparison(iter(parts), 0.01, "truth.csv")
        comparison.add(truth)
        comparison.finish()
        assert comparison.instants == 201
        assert comparison.first == truth.state(0)


def test_a_truth_has_ended_only_after_its_last_row() -> None:
    comparison = Comparison(blocks(FLIGHT.state(RUN), 50), 0.01, "truth.csv")
    assert not comparison.ended(0.3)
    assert not comparison.ended(2.0 + 5e-9)
    assert comparison.ended(2.0 + 2e-8)


def test_interpolated_attitude_turns_evenly() -> None:
    q = np.array([(1.0, 0, 0, 0), from_rotation_vector((0, 0, 1.2))])
    q[1] *= -1  # the same attitude
    zero = np.zeros(2)
    history = NavHistory(np.array([0.0, 2.0]), q, np.zeros((2, 3)), zero, zero, zero)
    found, _ = interpolated(history, np.array([0.5]))
    assert np.allclose(found.q[0], from_rotation_vector((0, 0, 0.3)), atol=1e-15)


def blocks(history: NavHistory, size: int) -> Iterator[NavHistory]:
    for first in range(0, len(history), size):
        yield history.rows(slice(first, first + size))


def drifting(t: NDArray, rate: float = 2.0) -> NavHistory:
    """The flight's states, sliding north at a rate."""
    state = FLIGHT.state(t)
    meridian, _ = radii(np.sin(state.lat))
    return replace(state, lat=state.lat + rate * (t - t[0]) / (meridian + state.h))


@pytest.mark.parametrize("size", [5, 1000])
@pytest.mark.parametrize(
    ("truth_step", "instants", "between"),
    [
        (0.01, 1001, 0),  # the same instants
        (0.1, 101, 0),  # a sparser truth
        (0.0025, 1001, 0),  # a denser one
        (0.025, 401, 200),  # sparser, every other instant between two of the run's
        (0.004, 1001, 500),  # denser, but every other instant between two of the truth's
    ],
)
def test_comparison_in_blocks(truth_step: float, instants: int, between: int, size: int) -> None:
    run = drifting(400 + 0.01 * np.arange(1001))
    truth = FLIGHT.state(400 + truth_step * np.arange(round(10 / truth_step) + 1))
    comparison = Comparison(blocks(truth, max(size, 2)), 0.01, "truth.csv")
    pairs = [comparison.add(part) for part in blocks(run, size)]
    comparison.finish()
    assert (comparison.instants, comparison.interpolated) == (instants, between)
    assert comparison.growth == pytest.approx(2.0, rel=1e-6)
    figures = comparison.figures()
    t = np.concatenate([truth.time for _, truth in pairs]) - 400
    assert len(t) == instants
    north, total = figures["position"]["north"], figures["position"]["total"]
    assert north.rms == pytest.approx(np.sqrt(np.mean((2 * t) ** 2)), rel=1e-5)
    assert (north.largest, north.final) == pytest.approx((20, 20), rel=1e-5)
    assert total.final == pytest.approx(20, rel=1e-5)
    assert figures["position"]["down"].largest < 1e-3  # the chord over 20 m
    assert figures["velocity"]["total"].largest < 1e-3
    assert figures["attitude"]["total"].largest < 1e-6


def compared(run: NavHistory, truth: NavHistory) -> Comparison:
    comparison = Comparison(blocks(truth, 50), 0.01, "truth.csv")
    for part in blocks(run, 33):
        comparison.add(part)
    comparison.finish()
    return comparison


RUN = 0.01 * np.arange(201)


@pytest.mark.parametrize(
    ("times", "instants", "left_out"),
    [
        (0.1 * np.arange(1, 21), 20, (0.1, 0, 0, 0)),
        (0.1 * np.arange(-50, 21), 21, (0, 0, 5, 0)),
        (0.1 * np.arange(20), 20, (0, 0.1, 0, 0)),
        (0.1 * np.arange(22), 21, (0, 0, 0, 0.1)),
        (0.1 * np.arange(3, 21), 18, (0.3, 0, 0, 0)),
        (0.01 * np.arange(2, 201), 199, (0.02, 0, 0, 0)),
        (0.005 * np.arange(1, 401), 200, (0.005, 0, 0, 0)),
        (0.1 * np.arange(19), 19, (0, 0.2, 0, 0)),
        (0.01 * np.arange(150), 150, (0, 0.51, 0, 0)),
        (0.005 * np.arange(400), 200, (0, 0.005, 0, 0)),
        (0.1 * np.arange(24), 21, (0, 0, 0, 0.3)),
        (0.01 * np.arange(900), 201, (0, 0, 0, 6.99)),
        (1 + 0.01 * np.arange(201), 101, (1, 0, 0, 1)),
        (-1 + 0.01 * np.arange(201), 101, (0, 1, 1, 0)),
    ],
)
def test_the_overlap_is_compared_and_the_rest_told(
    times: NDArray, instants: int, left_out: tuple[float, ...]
) -> None:
    run, truth = FLIGHT.state(RUN), FLIGHT.state(np.asarray(times, dtype=float))
    comparison = compared(run, truth)
    assert comparison.instants == instants
    assert comparison.left_out == pytest.approx((*left_out, 0), abs=1e-9)
    figures = comparison.figures()
    assert figures["position"]["total"].largest < 1e-6
    assert figures["attitude"]["total"].largest < 1e-6


@pytest.mark.parametrize(
    ("times", "message"),
    [
        (10 + 0.01 * np.arange(201), "from 10 s to 12 s and has nothing in common"),
        (-10 + 0.01 * np.arange(201), "from -10 s to -8 s and has nothing in common"),
        (np.zeros(1), "fewer than two rows"),
    ],
)
def test_nothing_in_common(times: NDArray, message: str) -> None:
    run, truth = FLIGHT.state(RUN), FLIGHT.state(np.asarray(times, dtype=float))
    with pytest.raises(InputError, match=r"^truth\.csv: ") as caught:
        compared(run, truth)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("step", [0.01, 0.004, 0.1])
def test_a_gap_of_the_truth_is_not_interpolated_over(step: float) -> None:
    times = step * np.arange(round(2 / step) + 1)
    times = times[(times < 0.5 + 1e-9) | (times > 1.5 - 1e-9)]
    comparison = compared(FLIGHT.state(RUN), FLIGHT.state(times))
    figures = comparison.figures()
    assert figures["position"]["total"].largest < 1e-6
    dense = step < 0.02
    assert comparison.instants == (102 if dense else len(times))
    assert comparison.left_out.run_in_gaps == pytest.approx(1, abs=0.011)


@pytest.mark.parametrize("step", [0.004, 0.1])
@pytest.mark.parametrize("missing", [2, 3])
def test_three_steps_are_no_gap_and_four_are(step: float, missing: int) -> None:
    """Rows missing in the middle: states between are compared, or told to be in a gap."""
    times = step * np.arange(round(2 / step) + 1)
    first = len(times) // 2
    kept = np.delete(times, np.arange(first, first + missing))
    run = FLIGHT.state(RUN)
    comparison = compared(run, FLIGHT.state(kept))
    between = (kept[first - 1] + 1e-9 < RUN) & (kept[first] - 1e-9 > RUN)
    if missing == 2:
        assert comparison.left_out.run_in_gaps == 0
    else:
        wide = 4 * step if step > 0.01 else 0.01 * np.count_nonzero(between)
        assert comparison.left_out.run_in_gaps == pytest.approx(wide, rel=1e-9)
    if step > 0.01:
        assert comparison.instants == len(kept)
    else:
        assert comparison.instants == len(RUN) - (0 if missing == 2 else np.count_nonzero(between))


@pytest.mark.parametrize("size", [7, 33, 1000])
@pytest.mark.parametrize("step", [0.002, 0.02])
def test_gaps_beside_the_first_and_the_last_row_of_a_truth(step: float, size: int) -> None:
    """Each told once, however the run and the truth come: half a second, and a whole one."""
    times = np.concatenate([[0.0], 0.5 + step * np.arange(round(0.5 / step) + 1), [2.0]])
    for together in (9, 1000):
        comparison = Comparison(blocks(FLIGHT.state(times), together), 0.01, "truth.csv")
        for part in blocks(FLIGHT.state(RUN), size):
            comparison.add(part)
        comparison.finish()
        if step > 0.01:
            assert comparison.instants == len(times)
            assert comparison.left_out.run_in_gaps == pytest.approx(1.5, abs=1e-9)
        else:
            assert comparison.instants == 53
            assert comparison.left_out.run_in_gaps == pytest.approx(0.49 + 0.99, abs=1e-9)
        assert comparison.left_out[:4] == pytest.approx((0, 0, 0, 0), abs=1e-9)
        assert comparison.interpolated == 0


@pytest.mark.parametrize("size", [10, 33, 1000])
def test_a_dense_truth_may_begin_long_after_the_run(size: int) -> None:
    truth = FLIGHT.state(1 + 0.005 * np.arange(201))
    comparison = Comparison(iter([truth]), 0.01, "truth.csv")
    found = [comparison.add(part)[1] for part in blocks(FLIGHT.state(RUN), size)]
    comparison.finish()
    told = np.concatenate([part.time for part in found])
    assert told == pytest.approx(1 + 0.01 * np.arange(101))
    assert comparison.left_out == pytest.approx((1, 0, 0, 0, 0), abs=1e-9)


def test_of_steps_that_are_alike_the_truths_instants_are_taken_where_it_is_sparser() -> None:
    for step, instants in ((0.015, 134), (0.008, 201)):
        times = step * np.arange(round(2 / step) + 1)
        assert compared(FLIGHT.state(RUN), FLIGHT.state(times)).instants == instants


@pytest.mark.parametrize("size", [1, 2, 5, 7])
def test_a_blocks_last_state_is_joined_with_the_next_ones_first(size: int) -> None:
    """A run that goes up and down by 10 m, at rest in each state: it is 5 m up in the middles."""
    times = 0.01 * np.arange(31)
    q, zero = np.array([(1.0, 0, 0, 0)] * 31), np.zeros(31)
    run = NavHistory(times, q, np.zeros((31, 3)), zero, zero, 10.0 * (np.arange(31) % 2))
    middles = 0.005 + 0.03 * np.arange(10)
    truth = NavHistory(middles, q[:10], np.zeros((10, 3)), *np.zeros((3, 10)))
    comparison = Comparison(iter([truth]), 0.01, "truth.csv")
    found = [comparison.add(part)[0].h for part in blocks(run, size)]
    assert np.concatenate(found) == pytest.approx(np.full(10, 5.0), rel=1e-12)
    assert comparison.interpolated == 10


@pytest.mark.parametrize("step", [0.005, 0.1])
@pytest.mark.parametrize("offset", [0.0, 0.003])
def test_nothing_lies_between_two_stretches_of_a_run(step: float, offset: float) -> None:
    """A run of 1 s that stops for 1 s and goes on: what the truth has meanwhile is not compared."""
    times = offset + step * np.arange(round(4 / step))
    run = RUN[:101]
    comparison = Comparison(blocks(FLIGHT.state(times), 60), 0.01, "truth.csv")
    for begin in (0.0, 2.0):
        comparison.begin()
        for part in blocks(FLIGHT.state(begin + run), 33):
            comparison.add(part)
    comparison.finish()
    asked = np.concatenate([run, 2 + run])
    if step > 0.01:
        ours = [t for t in times.tolist() if -1e-9 < t < 1 + 1e-9 or 2 - 1e-9 < t < 3 + 1e-9]
    else:
        ours = [t for t in asked.tolist() if t > offset - 1e-9]
    between = 0 if offset == 0 else len(ours)
    assert comparison.instants == len(ours)
    assert comparison.interpolated == between
    assert comparison.left_out.run_in_gaps == 0
    assert comparison.figures()["position"]["total"].largest < 1e-6


def test_a_run_can_begin_as_late_as_the_last_instant_asked_about() -> None:
    """In a later block of the truth, which has a gap; and nowhere once the truth is used up."""
    times = np.concatenate([0.1 * np.arange(5), 4 + 0.1 * np.arange(5)])
    comparison = Comparison(blocks(FLIGHT.state(times), 5), 0.1, "truth.csv")
    found = comparison.start(np.array([-2.0, -1.0, 4.2]))
    assert found is not None
    assert (found.row, found.state.time, found.interpolated) == (2, 4.2, False)
    comparison.add(FLIGHT.state(0.1 * np.arange(60)))
    assert comparison.start(np.array([6.0, 6.1])) is None


@pytest.mark.parametrize(
    ("rows", "seconds", "error", "left_out"),
    [([-4.0, 1.0], 1.0, 2.0, (0, 0, 4, 0, 0)), ([0.0, 5.0], 0.0, 0.0, (0, 0, 0, 5, 0))],
)
def test_a_single_instant_has_its_error_for_all_figures(
    rows: list[float], seconds: float, error: float, left_out: tuple[float, ...]
) -> None:
    """2 m/s for 1 s; and at the very start, where nothing has grown yet."""
    comparison = Comparison(iter([FLIGHT.state(np.array(rows))]), 0.01, "truth.csv")
    comparison.add(drifting(RUN[: round(100 * seconds) + 1]))
    comparison.finish()
    assert comparison.instants == 1
    figures = comparison.figures()["position"]["north"]
    assert (figures.rms, figures.largest, figures.final) == pytest.approx([error] * 3, abs=1e-4)
    assert comparison.growth == pytest.approx(error, abs=1e-4)
    assert comparison.left_out == pytest.approx(left_out, abs=1e-9)


def test_a_run_can_begin_where_the_truth_is_whole() -> None:
    times = np.concatenate([0.003 + 0.1 * np.arange(6), 4.5 + 0.1 * np.arange(6)])
    truth = FLIGHT.state(times)

    def start(begin: float) -> tuple[float, bool] | None:
        comparison = Comparison(blocks(truth, 4), 0.01, "truth.csv")
        found = comparison.start(begin + 0.01 * np.arange(700))
        return None if found is None else (round(found.state.time, 9), found.interpolated)

    assert start(-1.0) == (0.01, True)
    assert start(0.6) == (4.5, False)  # not in the gap
    assert start(4.52) == (4.6, False)
    assert start(5.01) is None
    assert start(4.505) == (4.505, True)


def test_no_instant_is_compared_twice() -> None:
    """Blocks that overlap nothing, where the run's block ends on an instant of the truth."""
    comparison = Comparison(blocks(FLIGHT.state(0.1 * np.arange(21)), 4), 0.01, "truth.csv")
    times = [comparison.add(part)[1].time for part in blocks(FLIGHT.state(RUN), 11)]
    assert np.concatenate(times) == pytest.approx(0.1 * np.arange(21))


def test_a_run_without_a_state_has_nothing_in_common() -> None:
    comparison = Comparison(blocks(FLIGHT.state(RUN), 50), 0.01, "truth.csv")
    with pytest.raises(InputError, match=r"goes from 0 s to 2 s and .* the run from 0 s to 0 s"):
        comparison.finish()


def test_a_nautical_mile() -> None:
    """By its definition, m."""
    assert NAUTICAL_MILE == 1852


def test_no_truth_at_all() -> None:
    with pytest.raises(InputError, match="fewer than two rows"):
        Comparison(iter(()), 0.01, "truth.csv")


def random_blocks(history: NavHistory, rng: np.random.Generator, least: int) -> list[NavHistory]:
    cuts, at = [0], 0
    while at < len(history):
        at = min(len(history), at + int(rng.integers(least, 40)))
        cuts.append(at)
    return [history.rows(slice(a, b)) for a, b in pairwise(cuts)]


def wrong(truth: NavHistory) -> NavHistory:
    """Off by known amounts: position (2t, -3, 4) m, velocity and attitude by constants."""
    meridian, prime_vertical = radii(np.sin(truth.lat))
    return replace(
        truth,
        q=turned(truth.q, (3e-5, -2e-5, 5e-5)),
        v=truth.v + np.array([0.1, -0.2, 0.3]),
        lat=truth.lat + 2.0 * (truth.time - truth.time[0]) / (meridian + truth.h),
        lon=truth.lon - 3.0 / ((prime_vertical + truth.h) * np.cos(truth.lat)),
        h=truth.h - 4.0,
    )


@pytest.mark.parametrize("seed", range(16))
def test_any_run_against_any_truth(seed: int) -> None:
    """Whatever the steps, the gap, the ends and the blocks: what a list of instants says."""
    rng = np.random.default_rng(seed)
    interval, step = 0.01, float(rng.choice([0.0025, 0.004, 0.01, 0.03, 0.05]))
    run = 100 + interval * np.arange(int(rng.integers(150, 250)))
    begin = float(rng.choice([99.5, 100.0, 100.003, 100.2]))
    times = begin + step * np.arange(round(float(rng.uniform(1.2, 3)) / step))
    if seed % 2:  # a gap in the truth
        times = times[(times < 100.7) | (times > 100.7 + 6 * max(step, interval))]
    if step >= interval:
        compared_at = [t for t in times if run[0] - 1e-8 <= t <= run[-1] + 1e-8]
        steps = np.diff(compared_at)
        in_gaps = float(steps[steps > 3.5 * step].sum())
        between = [t for t in compared_at if np.abs(run - t).min() > 1e-8]
    else:
        compared_at, between, in_gaps = [], [], 0.0
        for t in run:
            on_row = np.abs(times - t).min() <= 1e-8
            before, after = times[times < t], times[times > t]
            covered = len(before) and len(after) and after[0] - before[-1] <= 3.5 * step
            if on_row or covered:
                compared_at.append(t)
                between += [] if on_row else [t]
            elif len(before) and len(after):
                in_gaps += interval
    comparison = Comparison(iter(random_blocks(FLIGHT.state(times), rng, 1)), interval, "t.csv")
    pairs = [comparison.add(part) for part in random_blocks(wrong(FLIGHT.state(run)), rng, 1)]
    comparison.finish()
    for side in (0, 1):
        told = np.concatenate([pair[side].time for pair in pairs])
        assert told == pytest.approx(compared_at, abs=2e-8)
    assert (comparison.instants, comparison.interpolated) == (len(compared_at), len(between))
    ends = (times[0] - run[0], run[-1] - times[-1], run[0] - times[0], times[-1] - run[-1])
    assert comparison.left_out == pytest.approx([*(max(0, e) for e in ends), in_gaps], abs=1e-7)
    t = np.array(compared_at) - 100
    figures = comparison.figures()
    for quantity, values in (
        ("attitude", (3e-5, -2e-5, 5e-5)),
        ("velocity", (0.1, -0.2, 0.3)),
        ("position", (2 * t, -3.0, 4.0)),
    ):
        columns = [np.broadcast_to(value, t.shape) for value in values]
        level = columns[:2] if quantity == "position" else columns
        columns.append(np.sqrt(sum(column**2 for column in level)))
        for name, column in zip(("north", "east", "down", "total"), columns, strict=True):
            found = figures[quantity][name]
            expected = (np.sqrt(np.mean(column**2)), np.abs(column).max(), column[-1])
            near = {"attitude": 1e-6, "velocity": 2e-3, "position": 2e-3}[quantity]
            assert (found.rms, found.largest, found.final) == pytest.approx(expected, abs=near)
    horizontal = np.hypot(2 * t, 3.0)
    assert comparison.growth == pytest.approx(float(t @ horizontal / (t @ t)), rel=1e-3)
