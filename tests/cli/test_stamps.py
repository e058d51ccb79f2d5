"""Jitter and lasting shifts of time stamps: made by hand, so that it is known which is which."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sculler.checks.stamps import HELD, WINDOW, Shift, ShiftFinder, wrong_rate

T = 1e-3
N = np.arange(1000)


def find(times: Any, chunk: int = 1000, interval: float = T) -> list[Shift]:
    finder, found, told = ShiftFinder(interval), [], 0
    times = np.asarray(times, float)
    for at in range(0, len(times), chunk):
        found += finder(times[at : at + chunk])
        assert told <= finder.decided <= at + chunk
        told = finder.decided
        assert all(shift.sample < told for shift in found)
    found += finder(np.empty(0), last=True)
    assert finder.decided == len(times)
    return found


def without(*samples: int) -> Any:
    """Sample numbers of a log that lost some."""
    return np.delete(N, samples)


def late(first: int, count: int, delay: float) -> Any:
    """A host that slept: `count` samples read at once after a delay, the next one in time."""
    times = N * T
    times[first : first + count] = (first + delay) * T + 1e-6 * np.arange(count)
    return times


JITTER = np.random.default_rng(7).normal(0, 0.2, 1000)
QUIET = {
    "even": N * T,
    "since 1970": 1403636579.763555527 + N * T,
    "jitter of a fifth": np.sort((N + JITTER) * T),
    "one sample late": late(300, 1, 0.9),
    "a host that slept": late(300, 4, 3.5),
    "one wrong stamp": np.where(N == 400, 0.35, N * T),
    "batches of ten under one stamp": N // 10 * 10 * T,
    "batches of forty, 5 us apart": N // 40 * 40 * T + N % 40 * 5e-6,
    "whole seconds": np.floor((N + 371) * T),
    "all equal": np.ones(1000),
    "float32 at 4000 s": (4000 + N * 5e-4).astype(np.float32),
    "clock 300 ppm off": N * T * 1.0003,
}


@pytest.mark.parametrize("case", QUIET)
def test_what_evens_out_is_jitter(case: str) -> None:
    interval = 5e-4 if "float32" in case else T
    for chunk in (1000, 37):
        assert find(QUIET[case], chunk, interval) == []
    assert wrong_rate(np.asarray(QUIET[case], float), [], interval) is None


def test_whole_milliseconds_at_800_and_2000_hz() -> None:
    for rate in (800, 2000, 1024):
        times = np.round(np.floor(N * 1000 / rate) / 1000, 3)
        assert find(times, interval=1 / rate) == []
        assert wrong_rate(times, [], 1 / rate) is None


@pytest.mark.parametrize("chunk", [1000, 37])
@pytest.mark.parametrize(
    ("times", "shifts"),
    [
        (without(500) * T, [(500, 1)]),
        (without(500, 501, 502) * T, [(500, 3)]),
        (without(500, 501, 510) * T, [(500, 2), (508, 1)]),
        (without(1) * T, [(1, 1)]),
        (without(*range(4, 1000, 5)) * T, [(4 * k, 1) for k in range(1, 200)]),
        (without(*range(4, 90, 5)) * T, [(4 * k, 1) for k in range(1, 19)]),
        (without(998) * T, [(998, 1)]),
        (np.sort((without(500) + JITTER[1:]) * T), [(500, 1)]),
        (np.sort((without(200, 201) + JITTER[2:]) * T), [(200, 2)]),
        (np.insert(N, 700, 699) * T, [(700, -1)]),  # a row written twice
        (np.where(N >= 600, N * T - 5, N * T), [(600, -5000)]),  # a clock set back
        (without(505) // 10 * 10 * T, [(509, 1)]),  # the batch after the short one comes too early
        (np.floor((without(*range(400, 700))) * 1.0), [(400, 300)]),
    ],
)
def test_what_lasts_is_a_shift(times: Any, shifts: list[tuple[int, int]], chunk: int) -> None:
    interval = 1.0 if times[1] >= 1 else T
    found = find(times, chunk, interval)
    assert [shift.missing for shift in found] == [missing for _, missing in shifts]
    for shift, (sample, _) in zip(found, shifts, strict=True):
        assert abs(shift.sample - sample) <= (1 if len(times) == 1000 - 1 else 0) + 1
        assert shift.time == times[shift.sample - 1]
        assert shift.time + shift.seconds == pytest.approx(times[shift.sample])


def test_exact_places_without_jitter() -> None:
    rng = np.random.default_rng(2)
    gone = np.sort(rng.choice(np.arange(3, 100_000, 3), 60, replace=False))
    times = np.delete(np.arange(100_000), gone) * T
    found = find(times, 777)
    assert [shift.sample for shift in found] == (gone - np.arange(60)).tolist()
    assert {shift.missing for shift in found} == {1}


def test_few_samples_of_jitter_are_no_shift() -> None:
    """At the end nobody can know whether a late sample is followed by others in time."""
    times = np.sort((N + np.random.default_rng(3).exponential(0.8, 1000)) * T)
    times[-1] = times[-2] + 2.2 * T
    assert find(times) == []
    assert find(np.append(N, 1003) * T) == [Shift(1000, 0.999, pytest.approx(0.004), 3)]


def test_another_rate() -> None:
    for factor, rate in ((2, 500), (1.3, 1000 / 1.3), (1.05, 1000 / 1.05), (0.5, 2000), (10, 100)):
        times = N * T * factor
        assert wrong_rate(times, find(times), T) == pytest.approx(rate, rel=1e-6)
        few = times[:12]
        if abs(factor - 1) > 0.2:
            assert wrong_rate(few, find(few), T) == pytest.approx(rate, rel=1e-6)
    assert wrong_rate(without(3, 4, 9) * T, find(without(3, 4, 9) * T), T) is None
    assert wrong_rate(np.array([5.0]), [], T) is None


def test_what_is_held_back_is_bounded() -> None:
    finder = ShiftFinder(T)
    finder(np.zeros(10))
    for _ in range(4):
        finder(np.zeros(HELD // 2))
    assert finder.decided >= HELD
    finder = ShiftFinder(T)
    finder(N * T)
    assert finder.decided == 1000 - 2 * WINDOW
