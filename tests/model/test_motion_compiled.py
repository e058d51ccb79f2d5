"""Motions through Numba are those of numpy, bit for bit."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from sculler_model.motion import (
    PLACE,
    Motion,
    Vibration,
    compiled,
    demo_motion,
    earthbound,
    hour_flight,
    over_the_pole,
    sampling,
)

pytest.importorskip("numba")

MOTIONS = {
    "panels, turns": demo_motion,
    "an arm that shakes": lambda: Vibration(9.8, 0.02).on(demo_motion()),
    "splines": lambda: hour_flight(*PLACE),
    "a turned grid": over_the_pole,
}


@pytest.mark.parametrize("name", MOTIONS)
def test_every_sample_is_the_same(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Increments of whole and cut panels, rates, and states."""
    found = []
    for loops in (lambda *_: None, lambda *_: compiled._compiled()):
        for module in (earthbound, sampling):
            monkeypatch.setattr(module, "loops", loops)
        found.append(_of(MOTIONS[name]))
    assert not any(np.isnan(values).any() for values in found[0])
    for by_numpy, by_numba in zip(*found, strict=True):
        assert np.array_equal(by_numpy, by_numba)


def _of(make: Callable[[], Motion]) -> list[np.ndarray]:
    motion = make()
    states = motion.state(np.arange(50) / 7)
    return [
        motion.increments(700, 1 / 2000, 12_345),
        motion.rates(100, 1 / 500),
        motion.sensed(np.arange(50) / 7),
        *(states.q, states.v, states.lat, states.lon, states.h),
    ]


def test_numba_is_loaded_when_numpy_has_worked_long(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compiled, "_asked", 0)
    doubles = np.dtype(np.float64)
    assert compiled.loops(compiled.WORTH_LOADING, doubles) is None
    assert compiled.loops(1, doubles) is not None


def test_instants_longer_than_doubles_are_left_to_numpy(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever was worked out before."""
    motion, t = demo_motion(), np.arange(5, dtype=np.longdouble) / 7
    monkeypatch.setattr(compiled, "_asked", 0)
    before = motion.sensed(t)
    monkeypatch.setattr(compiled, "_asked", compiled.WORTH_LOADING + 1)
    after = motion.sensed(t)
    assert after.dtype == np.longdouble
    assert np.array_equal(before, after)
