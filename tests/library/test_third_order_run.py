"""A run with the third order: it begins with the run, and says where it held."""

from __future__ import annotations

from math import radians

import numpy as np
import pytest

import sculler
from sculler_model.motion import spin_cone

DESIGN = sculler.Design.parse(
    {
        "preset": "stim300",
        "sensor": {"sample_rate_hz": 200.0, "gyro": {"bits": 32, "lsb": 1e-9}},
        "algorithm": {"family": "time-taylor", "samples": 2, "minors": 2},
    }
)


@pytest.fixture(scope="module")
def vectors() -> sculler.VectorBlock:
    motion = spin_cone(radians(48), radians(11), 500.0, radians(45), cone_rate=5.0, spin_rate=8.0)
    log = sculler.record(DESIGN, motion, 4)
    return sculler.FastModel(DESIGN).feed(log.counts)


def test_it_begins_with_the_run(vectors: sculler.VectorBlock) -> None:
    """From an instant on as with vectors that begin there: what came before says nothing."""
    place = {"lat": 48.0, "lon": 11.0, "height": 500.0, "roll": 10.0, "pitch": 45.0}
    T = DESIGN.major_interval
    start = round(30 * T, 9)
    runs = [
        sculler.navigate(DESIGN, block, third_order=True, start=at, **place)  # type: ignore[arg-type]
        for block, at in ((vectors, start), (vectors[30:], None))
    ]
    assert len(runs[0].history) == len(runs[1].history) == len(vectors) - 29
    assert np.array_equal(runs[0].history.q, runs[1].history.q)
    plain = sculler.navigate(DESIGN, vectors, start=start, **place)  # type: ignore[arg-type]
    assert np.array_equal(plain.history.q[:5], runs[0].history.q[:5])
    assert not np.array_equal(plain.history.q[5], runs[0].history.q[5])
