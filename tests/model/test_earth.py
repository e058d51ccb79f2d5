"""WGS-84 against geometry; its gravity is in test_gravity."""

from math import cos, pi, radians, sin, tan

import numpy as np
import pytest

from sculler_model.frames import earth

A, F = 6378137.0, 1 / np.longdouble("298.257223563")
E2 = F * (2 - F)
RATE = 7.292115e-5


def ecef(lat: float, lon: float, h: float) -> np.ndarray:
    normal = A / np.sqrt(1 - E2 * np.sin(lat) ** 2)
    return np.array(
        [
            (normal + h) * np.cos(lat) * np.cos(lon),
            (normal + h) * np.cos(lat) * np.sin(lon),
            (normal * (1 - E2) + h) * np.sin(lat),
        ]
    )


@pytest.mark.parametrize("lat_deg", [-80, -30, 0, 20, 45, 89])
def test_radii_are_those_of_the_ellipsoid(lat_deg: float) -> None:
    lat, step = radians(lat_deg), 1e-4
    meridian, prime_vertical = earth.radii(sin(lat))
    north = (ecef(lat + step, 0, 0) - ecef(lat - step, 0, 0)) / (2 * step)
    east = (ecef(lat, step, 0) - ecef(lat, -step, 0)) / (2 * step)
    assert meridian == pytest.approx(np.linalg.norm(north), rel=3e-9, abs=0)
    assert prime_vertical * cos(lat) == pytest.approx(np.linalg.norm(east), rel=3e-9, abs=0)


def test_earth_turns_about_its_axis() -> None:
    assert earth.earth_rate(0.0, 1.0) == (RATE, 0, 0)  # equator: north
    assert earth.earth_rate(1.0, 0.0) == (0, 0, -RATE)  # pole: up
    assert 2 * pi / RATE == pytest.approx(86164.1, abs=0.1)  # the sidereal day


def test_transport_rate_follows_the_surface() -> None:
    lat, h = radians(50), 1000.0
    north, east = 200.0, -150.0
    meridian, prime_vertical = earth.radii(sin(lat))
    rate = earth.transport_rate(sin(lat), cos(lat), h, (north, east, 3.0))
    assert rate[0] == pytest.approx(east / (prime_vertical + h))
    assert rate[1] == pytest.approx(-north / (meridian + h))
    assert rate[2] == pytest.approx(-east / (prime_vertical + h) * tan(lat))
