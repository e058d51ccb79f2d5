"""A measured height, and the loop that holds to it: closed forms, rate, lag, noise."""

from __future__ import annotations

from dataclasses import replace
from math import radians, sqrt

import numpy as np
import pytest
from numpy.typing import NDArray

from sculler_model.errors import InputError
from sculler_model.host import MajorIncrements
from sculler_model.motion import MOTIONS, Curve, Motion, at_rest
from sculler_model.navigation import (
    GeographicNavigator,
    HeightDamping,
    HeightReference,
    NavHistory,
    Navigator,
    NavState,
    exact_increments,
)
from sculler_model.navigation.compiled import compiled_run
from sculler_model.navigation.height import HeightKeeper

Array = NDArray[np.float64]

REST = at_rest(radians(45), 0.1, 300.0)
T = 0.1


def carrier(
    kind: str, start: NavState, interval: float, tau: float, reference: float | None = None
) -> Navigator | GeographicNavigator:
    damping = HeightDamping(reference, tau)
    if kind == "geographic":
        return GeographicNavigator(start, interval, height_damping=damping)
    return Navigator(start, interval, height_damping=damping, compiled=False)


def flown(
    kind: str, motion: Motion, seconds: float, tau: float, reference: HeightReference, T: float = T
) -> tuple[NavHistory, NavHistory]:
    """The run, and the truth at its instants."""
    count = round(seconds / T)
    times = T * np.arange(count + 1)
    increments = replace(exact_increments(motion, count, T), heights=reference.at(times[:-1]))
    true = motion.state(times)
    return carrier(kind, true.state(0), T, tau).run(increments), true


@pytest.mark.parametrize("kind", ["wander", "geographic"])
def test_the_height_answers_a_step_of_the_reference_as_the_loop_says(kind: str) -> None:
    """(3s²/τ + 3s/τ² + 1/τ³)/(s + 1/τ)³ to a step: 1 - e^-x (1 - 2x + x²/2), x = t/τ."""
    tau = 50.0
    step = HeightReference([0.0], [310.0])
    count = 100
    increments = exact_increments(REST, count, 1.0)
    start = REST.state(np.zeros(1)).state(0)
    navigator = carrier(kind, start, 1.0, tau, 300.0)
    found = []
    for phi, dv in zip(increments.phi.tolist(), increments.dv_sf.tolist(), strict=True):
        found.append(navigator.update(tuple(phi), tuple(dv), height=310.0).h)
    x = np.arange(1, count + 1) / tau
    expected = 300 + 10 * (1 - np.exp(-x) * (1 - 2 * x + 0.5 * x * x))
    assert np.abs(np.array(found) - expected).max() < 0.25  # intervals are 1/50 of τ
    assert step.at([5.0]).tolist() == [[310.0, 5.0]]


@pytest.mark.parametrize("kind", ["wander", "geographic"])
@pytest.mark.parametrize("told", [True, False])
def test_rate_and_lag_cost_nothing_in_a_steady_climb(kind: str, told: bool) -> None:
    """5 m/s, a value every 0.7 s and 0.4 s late: 2 m too low if the lag is not told."""
    climb = Motion(radians(45), 0.1, 300.0, up=Curve((0.0, 5.0)))
    stamps = 0.7 * np.arange(-3, 400)
    barometer = HeightReference(stamps, 300.0 + 5.0 * (stamps - 0.4), lag=0.4 if told else 0.0)
    found, true = flown(kind, climb, 240.0, 20.0, barometer)
    off = found.h[-600:] - true.h[-600:]
    assert off.mean() == pytest.approx(0.0 if told else -2.0, abs=3e-3)
    assert np.abs(off - off.mean()).max() < 5e-3


@pytest.mark.deep
def test_noise_leaves_what_the_bandwidth_says() -> None:
    """33/(16τ) of bandwidth: white noise of 1 m every second, τ = 30 s: 0.26 m."""
    random = np.random.default_rng(3)
    seconds = 12_000
    heights = 300 + random.normal(size=seconds)
    found, _ = flown("wander", REST, seconds, 30.0, HeightReference(np.arange(seconds), heights), 1)
    spread = float(np.std(found.h[500:]))
    assert HeightDamping(0.0, 30.0).noise_left(1.0, 1.0) == pytest.approx(sqrt(33 / 480))
    assert spread == pytest.approx(HeightDamping(0.0, 30.0).noise_left(1.0, 1.0), rel=0.08)


@pytest.mark.deep
def test_an_accelerometer_error_in_a_climb_leaves_nothing_behind() -> None:
    """1 mg and a climb that bends: the integral takes the error up; free it would be 880 m."""
    climb = Motion(radians(45), 0.1, 300.0, up=Curve((0.0, 3.0), ((200.0, 0.01, 0.0),)))
    count = 4200
    times = T * np.arange(count + 1)
    true = climb.state(times)
    reference = HeightReference(times - 0.2, climb.state(times - 0.5).h, lag=0.3)
    increments = replace(exact_increments(climb, count, T), heights=reference.at(times[:-1]))
    increments.dv_sf[:, 2] += T * 9.81e-3
    found = carrier("wander", true.state(0), T, 30.0).run(increments)
    assert abs(found.h[-1] - true.h[-1]) < 0.05
    assert np.abs(found.h - true.h[1:]).max() < HeightDamping(0.0, 30.0).transient(9.81e-3) + 0.1


def steps(navigator: Navigator, increments: MajorIncrements) -> NavHistory:
    """By single updates, a height only where there is a new one."""
    assert increments.heights is not None
    states, last = [], None
    rows = zip(
        increments.phi.tolist(),
        increments.dv_sf.tolist(),
        increments.heights.tolist(),
        strict=True,
    )
    for phi, dv, (height, age) in rows:
        new = height != last and age >= 0
        last = height
        states.append(
            navigator.update(tuple(phi), tuple(dv), height=height, height_age=age)
            if new
            else navigator.update(tuple(phi), tuple(dv))
        )
    return NavHistory.from_states(states)


def test_streaming_is_the_whole_run() -> None:
    """Values every 4th interval, 0.125 s late: single updates, blocks and compiled, bit for bit."""
    interval, count = 0.125, 200
    times = interval * np.arange(count)
    reference = HeightReference(times[::4], 300 + np.sin(times[::4]), lag=0.125)
    increments = replace(exact_increments(REST, count, interval), heights=reference.at(times))
    start = REST.state(np.zeros(1)).state(0)

    def fresh() -> Navigator:
        return Navigator(start, interval, height_damping=HeightDamping(None, 20.0))

    whole = fresh().run(increments, compiled=False)
    assert np.array_equal(steps(fresh(), increments).h, whole.h)
    parts = fresh()
    halves = [parts.run(increments[:77], compiled=False), parts.run(increments[77:])]
    assert np.array_equal(NavHistory.concatenate(halves).h, whole.h)
    assert np.abs(whole.h - 300).max() > 0.1  # it does follow
    if compiled_run() is not None:
        assert np.array_equal(fresh().run(increments, compiled=True).h, whole.h)


@pytest.mark.parametrize("kind", ["wander", "geographic"])
def test_where_there_is_no_height_the_loop_rests(kind: str) -> None:
    """Before the first value and when the last one is too old, the channel is free."""
    increments = exact_increments(REST, 600, T)
    increments.dv_sf[:, 2] += T * 0.01
    start = REST.state(np.zeros(1)).state(0)
    times = T * np.arange(600)
    none = HeightReference([1000.0], [300.0])
    free = (GeographicNavigator(start, T) if kind == "geographic" else Navigator(start, T)).run(
        increments
    )
    rested = carrier(kind, start, T, 20.0).run(replace(increments, heights=none.at(times)))
    assert np.array_equal(rested.h, free.h)
    old = HeightReference([0.0], [300.0]).at(times)
    found = carrier(kind, start, T, 20.0).run(replace(increments, heights=old))
    assert np.abs(np.diff(found.v[101:, 2], 2)).max() < 1e-7  # falls evenly from 10 s on
    assert np.abs(np.diff(found.v[20:90, 2], 2)).max() > 1e-6


def test_geographic_streaming_is_the_whole_run() -> None:
    """In a climb, with heights of some age: single updates, parts, bit for bit."""
    interval, count = 0.125, 60
    climb = Motion(radians(45), 0.1, 300.0, up=Curve((0.0, 5.0)))
    times = interval * np.arange(count)
    reference = HeightReference(times[::4], 301 + 5 * times[::4], lag=0.125)
    increments = replace(exact_increments(climb, count, interval), heights=reference.at(times))
    start = climb.state(np.zeros(1)).state(0)

    def fresh() -> GeographicNavigator:
        return GeographicNavigator(start, interval, height_damping=HeightDamping(None, 20.0))

    whole = fresh().run(increments)
    assert np.array_equal(steps(fresh(), increments).v, whole.v)
    parts = fresh()
    halves = [parts.run(increments[:17]), parts.run(increments[17:])]
    assert np.array_equal(NavHistory.concatenate(halves).h, whole.h)
    assert whole.time.tolist() == (interval * np.arange(1, count + 1)).tolist()
    assert parts.state == whole.state(count - 1)
    assert np.abs(whole.h[-1] - climb.state(times[-1:] + interval).h[0]) > 0.1  # it does follow


@pytest.mark.parametrize("kind", ["wander", "geographic"])
def test_a_height_is_of_the_interval_s_start_if_its_age_is_not_told(kind: str) -> None:
    """It is held against the height then: 5 m/s of climb make a metre of 0.2 s."""
    climb = Motion(radians(45), 0.1, 300.0, up=Curve((0.0, 5.0)))
    increments = exact_increments(climb, 1, T)
    start = climb.state(np.zeros(1)).state(0)
    phi, dv = tuple(increments.phi[0].tolist()), tuple(increments.dv_sf[0].tolist())
    told = [
        carrier(kind, start, T, 20.0).update(phi, dv, height=300.0, **age).h  # type: ignore[arg-type]
        for age in ({}, {"height_age": 0.0}, {"height_age": 0.2})
    ]
    assert told[0] == told[1]
    assert told[2] - told[1] == pytest.approx(T * 3 / 20, rel=0.1)  # k1 of 1 m too low


def test_gains_put_all_poles_where_they_are_said_to_be() -> None:
    """s³ + k1 s² + (k2 - 2g/R) s + k3 = (s + 1/τ)³."""
    k1, k2, k3 = HeightDamping(0.0, 20.0).gains
    free = 2 * 9.7803253359 / 6378137.0
    assert (k1, k2 - free, k3) == pytest.approx((3 / 20, 3 / 400, 1 / 8000), rel=1e-12)


def test_figures_of_a_loop_by_hand() -> None:
    plain = HeightDamping()
    assert (plain.reference, plain.seconds, plain.hold) == (None, 100.0, 10.0)
    loop = HeightDamping(0.0, 30.0)
    assert loop.transient(-0.01) == pytest.approx(2 * np.exp(-2) * 0.01 * 900, rel=1e-14)
    assert loop.noise_left(2.0, 1.5) == pytest.approx(2 * sqrt(33 * 1.5 / 480), rel=1e-14)


def test_a_height_is_held_to_at_its_limits() -> None:
    keeper = HeightKeeper(HeightDamping(None, 20.0, hold=0.5), 0.1)
    for height in (-10e3, 1000e3):
        keeper.measured(height, 0.5)
        assert keeper.held == (height, 0.5)
        for beyond in (height * (1 + 1e-12), np.inf, np.nan):
            with pytest.raises(InputError, match="is not allowed"):
                keeper.measured(beyond, 0.5)
    for age in (np.inf, np.nan):
        with pytest.raises(InputError, match="is not allowed"):
            keeper.measured(0.0, age)
    for age, held in ((0.0, (5.0, 0.0)), (0.501, (0.0, -1.0)), (-1e-9, (0.0, -1.0))):
        keeper.measured(5.0, age)
        assert keeper.held == held
    keeper.measured(5.0, 0.0)
    keeper.passed()
    assert keeper.held == (5.0, 0.1)


def test_heights_that_increments_tell_are_held_to_row_by_row() -> None:
    """Too old and none: the loop rests; what follows holds to the last one."""
    keeper = HeightKeeper(HeightDamping(300.0, 20.0, hold=0.5), 0.1)
    nothing = np.zeros((0, 2))
    assert keeper.told(nothing, 0) is nothing
    assert keeper.told(None, 2).tolist() == [[300.0, 0.0]]
    rows = np.array([[7.0, 0.5], [8.0, 0.6], [9.0, -0.1], [10.0, 0.0]])
    found = keeper.told(rows, 4)
    assert found.tolist() == [[7.0, 0.5], [0.0, -1.0], [0.0, -1.0], [10.0, 0.0]]
    assert keeper.held == (10.0, 0.1)


def test_a_height_ages_until_it_is_held_to_no_longer() -> None:
    """Measured 0.25 s before an interval, of 0.1 s each, and held to for 0.5 s."""
    for ahead in (True, False):
        keeper = HeightKeeper(HeightDamping(300.0, 20.0, hold=0.5), 0.1)
        assert keeper.ahead(3).tolist() == [[300.0, 0.0]]  # one row for all
        keeper.measured(310.0, 0.25)
        found = keeper.ahead(4).tolist() if ahead else [list(keeper.held)]
        while len(found) < 4:
            keeper.passed()
            found.append(list(keeper.held))
        assert [height for height, _ in found] == [310.0, 310.0, 310.0, 0.0]
        assert [age for _, age in found] == pytest.approx([0.25, 0.35, 0.45, -1.0])
        keeper.passed()
        assert keeper.held == (0.0, -1.0)


def test_a_stream_forgets_what_lies_far_behind(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of nine values with room for twice three, the last three are kept."""
    monkeypatch.setattr(HeightReference, "KEPT", 3)
    reference = HeightReference()
    for second in range(9):
        reference.add(second, 100.0 + second)
    found = reference.at([5.5, 6.0, 7.5, 9.0]).tolist()
    assert found == [[0.0, -1.0], [106.0, 0.0], [107.0, 0.5], [108.0, 1.0]]


def test_twice_as_many_values_are_kept_as_stay() -> None:
    reference = HeightReference()
    for second in range(8193):
        if second in (0, 8192):
            assert len(reference.times) == second
        reference.add(second, 1.0)
    assert reference.times.tolist() == [*range(4097, 8193)]
    assert HeightReference.KEPT == 4096


def test_a_value_counts_from_its_stamp_on_but_for_rounding() -> None:
    reference = HeightReference([1.0, 2.0], [10.0, 20.0])
    found = reference.at([1 - 2e-9, 1 - 5e-10, 2 - 2e-9, 2 - 5e-10, 2.0]).tolist()
    assert [height for height, _ in found] == [0.0, 10.0, 10.0, 20.0, 20.0]
    assert [age for _, age in found] == pytest.approx([-1.0, 0.0, 1.0, 0.0, 0.0], abs=3e-9)
    assert found[1][1] == found[3][1] == 0.0
    assert (reference.lag, reference.noise, reference.every) == (0.0, 0.0, 1.0)
    assert HeightReference([1.0], [10.0]).every == 0.0
    assert HeightReference([0.0, 4.0], [0.0, 0.0]).hold == 12.0


def test_a_stream_runs_forwards_value_by_value() -> None:
    reference = HeightReference()
    reference.add(-5.0, 0.0)
    reference.add(1.0, 0.0)
    for time in (1.0, 0.0):
        with pytest.raises(InputError, match=f"time {time:g} s does not come after 1 s"):
            reference.add(time, 0.0)
    assert len(reference.times) == 2  # they are put to the others
    with pytest.raises(InputError, match="time 1 s does not come after 1 s"):
        reference.add(1.0, 0.0)
    for height in (-10e3 - 1e-6, 1000e3 + 1e-6):
        with pytest.raises(InputError, match="m is not allowed"):
            reference.add(2.0, height)
    for height in (-10e3, 1000e3):
        reference.add(height + 20e3, height)
    with pytest.raises(InputError, match="a time is not finite"):
        reference.add(np.inf, 0.0)


def test_a_stream_of_values() -> None:
    reference = HeightReference(lag=0.5, noise=2.0)
    assert reference.at([1.0]).tolist() == [[0.0, -1.0]]
    for k in range(9_000):
        reference.add(0.1 * k, 100.0 + k)
        if k % 1000 == 0:
            assert reference.at([0.1 * k])[0] == pytest.approx([100.0 + k, 0.5])
    assert len(reference.times) < 9_000  # the oldest are forgotten
    assert reference.every == pytest.approx(0.1)
    assert reference.hold == 10.5
    assert HeightReference([0, 60.0], [0, 0.0]).hold == 180.0


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: HeightReference([0, 1], [1.0]), "do not fit"),
        (lambda: HeightReference([0, 0.0], [1.0, 2]), "time 0 s does not come after 0 s"),
        (lambda: HeightReference([0], [2e6]), "2e\\+06 m is not allowed"),
        (lambda: HeightReference([float("nan")], [2]), "a time is not finite"),
        (lambda: HeightReference([3, 2, 1], [1, 2, 3.0]), "time 2 s does not come after 3 s"),
        (lambda: HeightReference([[0, 1]], [[1.0, 2]]), "do not fit"),
        (lambda: HeightReference(lag=-1), "lag -1 is not allowed"),
        (lambda: HeightReference(lag=float("inf")), "lag inf is not allowed"),
        (lambda: HeightReference(noise=-1e-9), "noise -1e-09 is not allowed"),
        (lambda: HeightDamping(0.0, -0.5), "time constant -0.5 s is not allowed"),
        (lambda: HeightDamping(0.0, float("inf")), "time constant inf s is not allowed"),
        (lambda: HeightDamping(0.0, 10.0, -0.5), "hold -0.5 s is not allowed"),
        (lambda: HeightDamping(0.0, 10.0, float("inf")), "hold inf s is not allowed"),
        (lambda: HeightReference([1], [2]).add(0.5, 3.0), "does not come after"),
        (lambda: HeightDamping(0.0, 10.0, 0.0), "hold 0.0 s is not allowed"),
    ],
)
def test_what_is_refused(make: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        make()  # type: ignore[operator]


def test_heights_that_nothing_holds_to_are_refused() -> None:
    start = REST.state(np.zeros(1)).state(0)
    still = ((0.0, 0.0, 0.0), (0.0, 0.0, -0.981))
    with pytest.raises(InputError, match="nothing holds to it"):
        Navigator(start, T).update(*still, height=3.0)
    held = Navigator(start, T, height_damping=HeightDamping(None, 20.0))
    with pytest.raises(InputError, match=r"nan m .* is not allowed"):
        held.update(*still, height=float("nan"))
    increments = exact_increments(REST, 3, T)
    rows = np.array([[300.0, 0.0], [float("nan"), 0.0], [300.0, 0.0]])
    with pytest.raises(InputError, match="nan m"):
        held.run(replace(increments, heights=rows))
    with pytest.raises(InputError, match="heights: shape"):
        held.run(replace(increments, heights=rows[:2]))


@pytest.mark.deep
def test_an_hour_of_flight_with_a_barometer() -> None:
    """10 Hz, 0.3 s late, 0.5 m of noise: 7 cm of height; held to take-off's height 9.4 km."""
    motion, step = MOTIONS["flight"].make(radians(48), radians(11), 500.0), 0.05
    times = step * np.arange(72_001)
    true, increments = motion.state(times), exact_increments(motion, 72_000, step)
    stamps = 0.1 * np.arange(36_000)
    noise = np.random.default_rng(1).normal(size=len(stamps))
    heights = motion.state(np.maximum(stamps - 0.3, 0.0)).h + 0.5 * noise
    barometer = HeightReference(stamps, heights, lag=0.3, noise=0.5)
    start = true.state(0)

    def off(reference: float | None, heights: Array | None) -> tuple[float, float]:
        damping = HeightDamping(reference, 100.0)
        found = Navigator(start, step, height_damping=damping).run(
            replace(increments, heights=heights)
        )
        north = (found.lat[-1] - true.lat[-1]) * 6.37e6
        return float(np.abs(found.h - true.h[1:]).max()), abs(north)

    height, north = off(None, barometer.at(times[:-1]))
    assert height < 0.12
    assert north < 0.005
    height, north = off(start.h, None)
    assert 9000 < height < 10_000
    assert north > 100
