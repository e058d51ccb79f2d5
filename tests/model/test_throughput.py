"""Clocks in the long run, against a count of the clocks the contract allows one by one."""

import itertools

import pytest

from sculler_model.design import Design
from sculler_model.golden import Dropping, Timing, clocks_per_major, clocks_per_minor


def counted(n, timing, samples=400):
    """Clock in which each sample is taken when one is always offered."""
    taken, free, clock = [], 0, -timing.spacing
    for t in range(samples):
        work = timing.work[t % n] if timing.work else 0
        clock += timing.spacing
        if work:
            clock = max(clock, free)
            free = clock + work
        taken.append(clock)
    return taken


@pytest.mark.parametrize("n", [1, 2, 3, 5])
@pytest.mark.parametrize("spacing", [1, 2, 13])
def test_clocks_per_minor(n, spacing):
    design = Design.preset("stim300", samples=n, history=1 if n == 1 else 0)
    for work in [(), *itertools.product([0, 3, 17, 40], repeat=n)][:150]:
        timing = Timing(latency=9, spacing=spacing, work=work)
        taken = counted(n, timing)
        period = clocks_per_minor(design, timing)
        assert taken[20 * n - 1] - taken[10 * n - 1] == 10 * period, (work, taken[: 4 * n])


def test_the_hand_over_can_be_what_takes_longest():
    hardware = {"handover": "stream"}
    design = Design.parse({"preset": "stim300", "algorithm": {"minors": 1}, "hardware": hardware})
    words = 20 * 4  # coning of 24-bit counts needs 57 bits
    assert clocks_per_major(design, Timing(latency=12)) == 12 + words
    slow = Timing(latency=12, handover_spacing=3)
    assert clocks_per_major(design, slow) == 12 + 3 * (words - 1) + 1
    parallel = Design.parse({"preset": "stim300", "algorithm": {"minors": 1}})
    assert clocks_per_major(parallel, Timing(latency=12)) == 13
    stim300 = Design.preset("stim300")
    assert clocks_per_major(stim300, Timing(latency=12)) == 20
    # a result is late: the next one's last sample waits for it, or for the one before it
    assert clocks_per_major(stim300, Timing(latency=24)) == 25
    assert clocks_per_major(stim300, Timing(latency=24, results=2)) == 20
    assert clocks_per_major(stim300, Timing(latency=60, results=2)) == 31  # half of 61
    # where results are dropped samples never wait for them
    assert clocks_per_major(stim300, Timing(latency=60, dropping=Dropping(0, 9))) == 20
    assert clocks_per_major(parallel, Timing(latency=9, handover_spacing=8, results=2)) == 8
