"""Limits of what can be navigated with: the limit itself is allowed, a little beyond it is not."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import acos, inf, nextafter, pi, radians, sqrt

import numpy as np
import pytest

from sculler_model.errors import InputError
from sculler_model.frames import EARTH_RATE
from sculler_model.host import MajorIncrements
from sculler_model.navigation import (
    HeightDamping,
    Navigator,
    NavState,
    align,
    constant_gravity,
    table_of_gravity,
)
from sculler_model.navigation.alignment import alignment_warnings, refuse_unfit_window
from sculler_model.navigation.gravity import covers

STILL = NavState(0.0, (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.5, 0.0, 0.0)
G = 9.8


def from_state(**changes: object) -> object:
    return Navigator(STILL._replace(**changes), 0.01)  # type: ignore[arg-type]


def table(lat: float = 0.5, height: float = 0.0, value: float = G) -> object:
    return table_of_gravity(np.array([lat]), np.array([height]), np.array([[value]]))


def window(
    count: int = 20,
    interval: float = 1.0,
    lat: float = 0.7,
    rate: float = 0.0,
    force: float = G,
) -> object:
    """A window of alignment at a constant rate and force."""
    phi = np.tile([0.0, 0.0, rate * interval], (count, 1))
    dv_sf = np.tile([0.0, 0.0, -force * interval], (count, 1))
    refuse_unfit_window(MajorIncrements(phi, phi, dv_sf), interval, lat, G)
    return True


LIMITS: dict[str, tuple[Callable[[float], object], float, float]] = {
    "latitude north": (lambda x: from_state(lat=x), pi / 2, 1e-15),
    "latitude south": (lambda x: from_state(lat=-x), pi / 2, 1e-15),
    "longitude east": (lambda x: from_state(lon=x), pi, 1e-15),
    "longitude west": (lambda x: from_state(lon=-x), pi, 1e-15),
    "wander angle": (lambda x: from_state(wander=x), pi, 1e-15),
    "height": (lambda x: from_state(h=x), 1000e3, 1e-9),
    "depth": (lambda x: from_state(h=-x), 10e3, 1e-9),
    "long quaternion": (lambda x: from_state(q=(x, 0.0, 0.0, 0.0)), 1 + 0.99e-6, 2e-8),
    "short quaternion": (lambda x: from_state(q=(1 / x, 0.0, 0.0, 0.0)), 1 + 0.99e-6, 2e-8),
    "constant gravity": (constant_gravity, 10.0, 1e-15),
    "least constant gravity": (lambda x: constant_gravity(1 / x), 0.2, 1e-15),
    "gravity of a table": (lambda x: table(value=x), 10.0, 1e-15),
    "least gravity of a table": (lambda x: table(value=1 / x), 0.2, 1e-15),
    "latitude of a table": (lambda x: table(lat=x), pi / 2, 1e-11),
    "latitude of a table, south": (lambda x: table(lat=-x), pi / 2, 1e-11),
    "height of a table": (lambda x: table(height=x), 1000e3, 1e-9),
    "depth of a table": (lambda x: table(height=-x), 10e3, 1e-9),
    "height to hold to": (HeightDamping, 1000e3, 1e-9),
    "depth to hold to": (lambda x: HeightDamping(-x), 10e3, 1e-9),
    "short time constant": (lambda x: HeightDamping(0.0, 1 / x).fits(0.01) or True, 10.0, 1e-12),
    "short window": (lambda x: window(10, 1 / x), 1.0, 1e-12),
    "few intervals": (lambda x: window(int(20 - x), 2.0), 10.0, 0.1),
    "near the pole": (lambda x: window(lat=x), acos(0.01), 1e-9),
    "near the south pole": (lambda x: window(lat=-x), acos(0.01), 1e-9),
    "rate": (lambda x: window(rate=x * EARTH_RATE), 100.0, 1e-9),
    "strong force": (lambda x: window(force=x * G), 1.02, 1e-9),
    "weak force": (lambda x: window(force=(2 - x) * G), 1.02, 1e-9),
}
"""What takes a number, the greatest that it allows, and how much more (relative) it refuses."""


@pytest.mark.parametrize("name", LIMITS)
def test_a_limit_is_allowed_and_what_is_beyond_is_not(name: str) -> None:
    make, most, beyond = LIMITS[name]
    inside = most if beyond <= 1e-15 or beyond >= 0.1 else most * (1 - beyond)
    assert make(inside) is not None
    with pytest.raises(InputError):
        make(max(most * (1 + beyond), nextafter(most, inf)))


def test_a_table_holds_on_its_very_edge() -> None:
    """A start there is not refused for the rounding of degrees to radians and back."""
    model = table_of_gravity(np.radians([47.0, 48.0]), np.array([100.0, 900.0]), np.full((2, 2), G))
    for lat, height in ((47.0, 100.0), (47.0, 900.0), (48.0, 100.0), (48.0, 900.0), (47.5, 500.0)):
        assert covers(model, radians(lat), height)
    for lat, height in ((46.999999, 500.0), (48.000001, 500.0), (47.5, 99.999), (47.5, 900.001)):
        assert not covers(model, radians(lat), height)
    one = table_of_gravity(np.array([0.8]), np.array([0.0]), np.array([[G]]))
    assert covers(one, -1.2, 1000e3)
    assert not covers(one, -1.2, 1000e3 + 1)


def test_warnings_of_an_alignment_begin_where_they_say() -> None:
    """2 % of Earth's rate, 1 mg, 0.01 rad of heading."""
    phi, lat = np.zeros((40, 3)), 0.7
    turn = np.array([EARTH_RATE * np.cos(lat), 0.0, -EARTH_RATE * np.sin(lat)])
    increments = MajorIncrements(phi + turn, phi + turn, np.tile([0.0, 0.0, -G], (40, 1)))
    found = align(increments, 1.0, lat, 0.0, gravity=constant_gravity(G))
    north, down = turn[[0, 2]].tolist()
    fair = replace(
        found,
        horizontal_rate=north,
        down_rate=down,
        specific_force=G,
        covariance=np.zeros((3, 3)),
    )
    assert alignment_warnings(fair, lat) == ()
    for part in (-1, 1):
        for name, value, step in (
            ("horizontal_rate", north, part * 0.02 * EARTH_RATE),
            ("down_rate", down, part * 0.02 * EARTH_RATE),
            ("specific_force", G, part * 1e-3 * G),
        ):
            for times, warned in ((0.999, 0), (1.001, 1)):
                changed = replace(fair, **{name: value + times * step})  # type: ignore[arg-type]
                assert len(alignment_warnings(changed, lat)) == warned, name
    for sigma, warned in ((0.00999, 0), (0.01001, 1)):
        changed = replace(fair, covariance=np.diag([0.0, 0.0, sigma**2]))
        assert len(alignment_warnings(changed, lat)) == warned
    assert fair.rate == pytest.approx(EARTH_RATE, rel=1e-14)
    assert fair.latitude == pytest.approx(lat, rel=1e-14)
    assert sqrt(found.covariance[2, 2]) == found.heading_sigma
