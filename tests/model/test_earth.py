"""WGS-84 against geometry and the closed form of the normal gravity field."""

from math import cos, pi, radians, sin, tan

import numpy as np
import pytest

from sculler_model.navigation import earth

A, F = 6378137.0, 1 / np.longdouble("298.257223563")
B = A * (1 - F)
E2 = F * (2 - F)
GM, RATE = 3.986004418e14, 7.292115e-5
LATITUDES = [-90, -60, -23.4, 0, 10, 45, 71, 89, 90]


def ecef(lat: float, lon: float, h: float) -> np.ndarray:
    normal = A / np.sqrt(1 - E2 * np.sin(lat) ** 2)
    return np.array(
        [
            (normal + h) * np.cos(lat) * np.cos(lon),
            (normal + h) * np.cos(lat) * np.sin(lon),
            (normal * (1 - E2) + h) * np.sin(lat),
        ]
    )


def potential(p: float, z: float) -> float:
    """Normal gravity potential at distance p from the axis and z from the equator.

    In ellipsoidal coordinates (Heiskanen and Moritz, Physical Geodesy, Eq. 2-62).
    """
    E = np.sqrt(A * A - B * B)
    inner = p * p + z * z - E * E
    u = np.sqrt(0.5 * (inner + np.sqrt(inner * inner + 4 * E * E * z * z)))
    sin_beta = z / u
    cos_beta_squared = p * p / (u * u + E * E)

    def q(u: float) -> float:
        return 0.5 * ((1 + 3 * u * u / (E * E)) * np.arctan(E / u) - 3 * u / E)

    return (
        GM / E * np.arctan(E / u)
        + 0.5 * RATE**2 * A * A * q(u) / q(B) * (sin_beta**2 - 1 / 3)
        + 0.5 * RATE**2 * (u * u + E * E) * cos_beta_squared
    )


@pytest.mark.parametrize("lat_deg", LATITUDES)
@pytest.mark.parametrize(("h", "within"), [(0.0, 3e-6), (5e3, 3e-6), (20e3, 1.5e-5)])
def test_gravity_is_the_gradient_of_the_normal_potential(
    lat_deg: float, h: float, within: float
) -> None:
    lat = radians(lat_deg)
    x, _, z = ecef(lat, 0.0, h)
    step = 500.0  # the differences' own error stays below 1e-7 m/s²
    along_p = (potential(x + step, z) - potential(x - step, z)) / (2 * step)
    along_z = (potential(x, z + step) - potential(x, z - step)) / (2 * step)
    down = -(along_p * cos(lat) + along_z * sin(lat))
    assert earth.gravity(sin(lat), h) == pytest.approx(down, abs=within)


@pytest.mark.parametrize("lat_deg", LATITUDES)
@pytest.mark.parametrize(("h", "within"), [(0.0, 1e-12), (5e3, 2e-10), (20e3, 1e-9)])
def test_gravity_leans_as_the_normal_potential_says(
    lat_deg: float, h: float, within: float
) -> None:
    """Along the ellipsoid, by differences of fourth order in extended precision."""
    lat = np.longdouble(radians(lat_deg))
    north = np.array([-np.sin(lat), np.cos(lat)])
    across, _, along = ecef(lat, 0.0, h)

    def between(step: float) -> float:
        ahead, behind = (np.array([across, along]) + sign * step * north for sign in (1, -1))
        return potential(*ahead) - potential(*behind)

    leaning = float((8 * between(2e3) - between(4e3)) / (12 * 2e3))
    cos_lat = cos(radians(lat_deg))
    found = cos_lat * earth.gravity_lean(sin(radians(lat_deg)), h)
    assert found == pytest.approx(leaning, abs=within)
    # the figure that Groves gives (Eq. 2.140)
    assert found == pytest.approx(-8.08e-9 * h * sin(2 * radians(lat_deg)), rel=0.01, abs=1e-18)


def test_gravity_at_equator_and_pole() -> None:
    assert earth.gravity(0.0, 0.0) == 9.7803253359
    assert earth.gravity(1.0, 0.0) == pytest.approx(9.8321849378, abs=1e-12)
    assert earth.gravity(0.0, 0.0) - earth.gravity(0.0, 1.0) == pytest.approx(3.0877e-6, abs=1e-9)


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


def test_arrays_and_floats_agree() -> None:
    sines, heights = np.linspace(-0.99, 0.99, 7), np.linspace(0, 9e3, 7)
    gravity = [earth.gravity(s, h) for s, h in zip(sines.tolist(), heights.tolist(), strict=True)]
    assert np.allclose(earth.gravity(sines, heights), gravity, rtol=1e-15)
