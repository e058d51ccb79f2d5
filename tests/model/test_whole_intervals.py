"""Increments carry their status and instants; nothing navigates or aligns with short history."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import pi, radians

import numpy as np
import pytest

from host_path import fine_design
from sculler_model.design import STATUS_FAULT, STATUS_SHORT_HISTORY
from sculler_model.errors import InputError
from sculler_model.fast import VectorBlock, run_fast
from sculler_model.frames import radii
from sculler_model.host import MajorIncrements, ThirdOrder, major_increments, uncorrected
from sculler_model.navigation import (
    GeographicNavigator,
    NavHistory,
    Navigator,
    NavState,
    align,
    align_finely,
    coasted,
    navigate,
    trajectory,
)

START = NavState(0.0, (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), radians(48), radians(11), 500.0)


def increments(count: int, *short: int, seed: int = 1) -> MajorIncrements:
    """Small random ones, some of short history."""
    phi, dv = 1e-4 * np.random.default_rng(seed).normal(size=(2, count, 3))
    status = np.zeros(count, np.int64)
    status[list(short)] = STATUS_SHORT_HISTORY
    return MajorIncrements(phi, phi, dv, status=status)


USES: dict[str, Callable[[MajorIncrements], object]] = {
    "Navigator.run": Navigator(START, 0.01).run,
    "Navigator.run, compiled": lambda inc: Navigator(START, 0.01).run(inc, compiled=True),
    "GeographicNavigator.run": GeographicNavigator(START, 0.01).run,
    "trajectory": lambda inc: list(trajectory(Navigator(START, 0.01), [inc])),
    "navigate": lambda inc: navigate(START, 0.01, inc),
    "navigate in blocks": lambda inc: navigate(START, 0.01, [inc[:3], inc[3:]]),
    "align": lambda inc: align(inc, 1.0, START.lat, START.h),
    "align_finely": lambda inc: align_finely(inc, 1.0, START.lat, START.h),
}


@pytest.mark.parametrize("use", USES)
@pytest.mark.parametrize("row", [0, 4])
def test_short_history_is_refused(use: str, row: int) -> None:
    with pytest.raises(InputError) as caught:
        USES[use](increments(20, row))
    assert "reaches before the first sample (status bit 0)" in str(caught.value)
    assert "increments.leading_short" in str(caught.value)


def test_a_mechanisation_of_ones_own_is_spared_it_too() -> None:
    class Frozen:
        state = START

        def run(self, increments: MajorIncrements) -> NavHistory:
            raise AssertionError("it must not come to this")

    with pytest.raises(InputError, match="status bit 0"):
        list(trajectory(Frozen(), [increments(3, 0)]))


def test_what_the_message_says_helps() -> None:
    inc = increments(20, 0, 1)
    assert inc.leading_short == 2
    assert inc.short.tolist() == [True, True, *[False] * 18]
    whole = Navigator(START, 0.01).run(inc[inc.leading_short :])
    told = Navigator(START, 0.01).run(inc.accepted_as_whole())
    assert (len(whole), len(told)) == (18, 20)
    assert replace(inc, status=None).leading_short == 0


def test_other_status_bits_stay_and_are_no_hindrance() -> None:
    inc = replace(increments(3), status=np.array([STATUS_FAULT | 1, STATUS_FAULT, 0], np.uint8))
    assert inc.leading_short == 1
    accepted = inc.accepted_as_whole()
    assert accepted.status is not None
    assert accepted.status.tolist() == [STATUS_FAULT, STATUS_FAULT, 0]
    assert len(Navigator(START, 0.01).run(accepted)) == 3


@pytest.mark.parametrize(
    ("design", "short"),
    [
        (fine_design(2, 0, 2), 0),
        (fine_design(2, 1, 2), 1),
        (fine_design(2, 0, 2, kind="rate"), 1),
        (fine_design(2, 2, 1, kind="rate"), 2),
        (fine_design(2, 0, 2, position="high-resolution"), 1),
    ],
)
def test_the_host_hands_status_and_times_on(design: object, short: int) -> None:
    counts = np.random.default_rng(2).integers(-1000, 1000, (40, 6))
    block = run_fast(design, counts)  # type: ignore[arg-type]
    times = 7.0 + 0.1 * np.arange(len(block))
    stamped = VectorBlock(block.major, block.status, block.components, times)
    for host in (major_increments, uncorrected):
        inc = host(design, stamped)  # type: ignore[arg-type]
        assert inc.leading_short == short
        assert inc.status is block.status
        assert inc.times is times
        assert host(design, block).times is None  # type: ignore[arg-type]
    cut = inc[2:5]
    assert cut.times is not None
    assert cut.times.tolist() == times[2:5].tolist()
    joined = MajorIncrements.concatenate([inc[:2], inc[2:]])
    assert joined.times is not None
    assert joined.status is not None
    assert np.array_equal(joined.times, times)
    assert np.array_equal(joined.status, block.status)


def test_joining_what_does_not_belong_together() -> None:
    inc = increments(4, 0)
    with pytest.raises(ValueError, match="1 of 2 parts have times"):
        MajorIncrements.concatenate([inc, replace(inc, times=np.arange(4.0))])
    mixed = MajorIncrements.concatenate([replace(inc, status=None), inc])
    assert mixed.short.tolist() == [False] * 4 + [True] + [False] * 3


def test_the_third_order_begins_after_it() -> None:
    """A short interval tells no rate: what follows is as if it had never been."""
    inc = increments(8, 0)
    turn = np.linspace(0.01, 0.02, 8)
    smooth = np.column_stack((turn, turn**2, 1 - np.cos(10 * turn)))
    inc = replace(inc, phi=smooth, alpha=smooth)
    alone, after = ThirdOrder()(inc[1:]).phi, ThirdOrder()(inc).phi[1:]
    assert np.array_equal(alone, after)
    parts = ThirdOrder()
    assert np.array_equal(np.concatenate([parts(inc[:2]).phi, parts(inc[2:]).phi])[1:], alone)
    assert not np.array_equal(alone, inc.phi[1:])


@pytest.mark.parametrize("kind", [Navigator, GeographicNavigator])
def test_states_are_told_at_the_intervals_own_instants(kind: type) -> None:
    times = 1.4e9 + np.array([0.01, 0.02, 0.0301, 0.04, 0.05])
    inc = replace(increments(5), times=times)
    plain = kind(START, 0.01).run(replace(inc, times=None))
    navigator = kind(START, 0.01)
    found = NavHistory.concatenate([navigator.run(inc[:2]), navigator.run(inc[2:])])
    assert found.time.tolist() == times.tolist()
    assert np.array_equal(found.lat, plain.lat)
    assert np.array_equal(found.q, plain.q)
    assert navigator.state.time == times[-1]
    # from there on by the interval
    later = navigator.update(inc.phi[0], inc.dv_sf[0])
    assert later.time == times[-1] + 0.01
    assert navigator.run(replace(inc[:2], times=None)).time[-1] == pytest.approx(
        times[-1] + 0.03, abs=1e-6
    )


def test_compiled_states_have_the_instants_too() -> None:
    pytest.importorskip("numba")
    times = 100.0 + np.cumsum(np.full(6, 0.011))
    inc = replace(increments(6), times=times)
    navigator = Navigator(START, 0.01)
    assert navigator.run(inc, compiled=True).time.tolist() == times.tolist()
    assert navigator.state.time == times[-1]
    again = navigator.run(replace(inc, times=None), compiled=True)
    assert again.time == pytest.approx(times[-1] + 0.01 * np.arange(1, 7), abs=1e-12)


@pytest.mark.parametrize(
    ("times", "message"),
    [
        (np.zeros(4), "run forwards"),
        (np.arange(3.0), "shape"),
        (np.array([0, 1, np.nan, 3]), "finite"),
    ],
)
def test_impossible_instants(times: np.ndarray, message: str) -> None:
    for navigator in (Navigator(START, 0.01), GeographicNavigator(START, 0.01)):
        with pytest.raises(InputError, match=message):
            navigator.run(replace(increments(4), times=times))


VECTORS = {
    "tuple": (1e-4, 2e-4, -3e-4),
    "list": [1e-4, 2e-4, -3e-4],
    "array": np.array([1e-4, 2e-4, -3e-4]),
    "numpy numbers": tuple(np.array([1e-4, 2e-4, -3e-4])),
    "objects": np.array([1e-4, 2e-4, -3e-4], object),
}


@pytest.mark.parametrize("kind", [Navigator, GeographicNavigator])
def test_update_takes_any_three_numbers(kind: type) -> None:
    states = {name: kind(START, 0.01).update(v, v) for name, v in VECTORS.items()}
    assert len(set(states.values())) == 1
    assert all(type(number) is float for number in states["numpy numbers"].v)
    if kind is Navigator:
        ways = {Navigator(START, 0.01).update(v, v, v) for v in VECTORS.values()}
        assert len(ways) == 1
    # any integer type, at its extremes: as the same numbers of Python
    for dtype in (np.int8, np.uint8, np.int16, np.uint16, np.int32, np.uint32, np.int64, np.uint64):
        least, most = np.iinfo(dtype).min, np.iinfo(dtype).max
        small = np.array([least, most, 1], dtype)
        turned = kind(START, 1e-9).update(small, np.zeros(3, dtype))
        expected = kind(START, 1e-9).update((float(least), float(most), 1.0), (0.0, 0.0, 0.0))
        assert turned == expected


@pytest.mark.parametrize("kind", [Navigator, GeographicNavigator])
@pytest.mark.parametrize(
    "vector",
    [
        np.zeros((1, 3)), np.zeros((3, 1)), np.zeros(2), np.zeros(4), 3.0, None, "123", "abc",
        (1, 2), (1, 2, "3"), (1, 2, 3j), [[1], [2], [3]], np.zeros(3, complex),
    ],
)  # fmt: skip
def test_update_refuses_all_else_in_one_line(kind: type, vector: object) -> None:
    good = (0.0, 0.0, 0.0)
    for name, call in (("phi", (vector, good)), ("dv_sf", (good, vector))):
        with pytest.raises(InputError, match=f"^{name}: .*give three numbers"):
            kind(START, 0.01).update(*call)
    with pytest.raises(InputError, match="not finite"):
        kind(START, 0.01).update((0.0, np.nan, 0.0), good)


def test_coasting_goes_straight_on() -> None:
    """North and east by the radii of curvature there; over a pole to the other side of it."""
    state = START._replace(v=(30.0, 40.0, -2.0), time=5.0)
    found = coasted(state, 10.0)
    meridian, prime_vertical = radii(np.sin(state.lat))
    assert (found.time, found.h) == pytest.approx((15.0, 520.0))
    assert (found.lat - state.lat) * (meridian + 500) == pytest.approx(300, rel=1e-4)
    east = (found.lon - state.lon) * (prime_vertical + 500) * np.cos(found.lat)
    assert east == pytest.approx(400, rel=1e-4)
    over = coasted(START._replace(lat=radians(89.999), v=(100.0, 0.0, 0.0)), 10.0)
    # 111.7 m to the pole, and 888.3 m beyond it
    assert over.lat == pytest.approx(pi / 2 - 888.3 / 6.4e6, abs=1e-6)
    assert abs(over.lon - radians(11)) == pytest.approx(pi, abs=1e-6)
    assert over.v == pytest.approx((-100, 0, 0), abs=1e-6)
    still = coasted(state, 0.0)
    assert (still.lat, still.lon, still.h) == pytest.approx((state.lat, state.lon, state.h))
    assert still.q == pytest.approx(state.q)
    assert still.v == pytest.approx(state.v)
