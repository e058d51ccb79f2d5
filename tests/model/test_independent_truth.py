"""The navigator over a truth that shares no line of code with it (`studies.navigator`)."""

from __future__ import annotations

from math import radians

import numpy as np
import pytest

from sculler_model.host import MajorIncrements
from sculler_model.navigation import GeographicNavigator, Mechanisation, Navigator
from studies.navigator import command, truth


@pytest.mark.parametrize("kind", [Navigator, GeographicNavigator])
def test_a_minute_of_flight(kind: type[Navigator]) -> None:
    """Both mechanisations follow it: attitude, velocity and position.

    Less than 2e-8 m/s² of gravity or Coriolis acceleration would show in the height.
    """
    flight, interval, count = truth.Flight(), 0.02, 3000
    phi, dv = truth.increments(flight, count, interval)
    carrier: Mechanisation = kind(command.start_of(flight), interval)
    carrier.run(MajorIncrements(phi, phi, dv))
    found = command.ends(flight, carrier.state, count * interval)
    assert found.horizontal < 1e-4
    assert found.height < 3e-5
    assert found.velocity < 1e-6
    assert found.attitude < 2e-11


@pytest.mark.deep
def test_an_hour_of_flight_at_1_to_9_km() -> None:
    """Found: 0.3 mm horizontally, 4 mm in height, 7.3e-6″; a series in height: 0.8 m, 15 m."""
    pytest.importorskip("numba", reason="an hour at 100 Hz wants the extra `fast`")
    found = command.flown(3600, 0.01)
    assert found.horizontal < 1e-3
    assert found.height < 0.01
    assert found.attitude < radians(2e-5 / 3600)
    coarse = command.flown(3600, 0.01, command.series_of_second_order())
    assert 0.5 < coarse.horizontal < 3
    assert 10 < coarse.height < 30


def test_the_truth_is_its_own() -> None:
    """Its velocity is the change of its position, by differences; its rotations turn."""
    flight, t = truth.Flight(), np.array([1234.5])
    step = 1e-3
    ahead, behind = (np.stack([j.x for j in flight.ecef(t + d)]) for d in (step, -step))
    speed = np.linalg.norm(flight.velocity(t))
    assert np.linalg.norm(ahead - behind) / (2 * step) == pytest.approx(speed, rel=1e-8)
    turn = truth.turned(1, np.array([0.3]))
    assert truth.rotation_vectors(turn)[0] == pytest.approx([0, 0.3, 0], abs=1e-15)
