"""WGS-84: figure, gravity and rotation, in the local frame north, east, down.

The functions take the sine (and cosine) of geodetic latitude and are arithmetic only, so they
serve the navigator with floats and the truth motions with arrays.
"""

from __future__ import annotations

from sculler_model.navigation.rotation import Real

SEMI_MAJOR_AXIS = 6378137.0
"""a, m."""
FLATTENING = 1 / 298.257223563
"""f."""
ECCENTRICITY_SQUARED = FLATTENING * (2 - FLATTENING)
"""e²."""
EARTH_RATE = 7.292115e-5
"""Rotation rate of the Earth against the stars, rad/s."""
GM = 3.986004418e14
"""Gravitational constant of the Earth with its air, m³/s²."""
GRAVITY_EQUATOR = 9.7803253359
"""Normal gravity on the ellipsoid at the equator, m/s²."""
GRAVITY_POLE = 9.8321849378
"""Normal gravity on the ellipsoid at the pole, m/s²."""

_SEMI_MINOR_AXIS = SEMI_MAJOR_AXIS * (1 - FLATTENING)
_SOMIGLIANA_K = _SEMI_MINOR_AXIS * GRAVITY_POLE / (SEMI_MAJOR_AXIS * GRAVITY_EQUATOR) - 1
_CENTRIFUGAL_M = EARTH_RATE**2 * SEMI_MAJOR_AXIS**2 * _SEMI_MINOR_AXIS / GM


def radii(sin_lat: Real) -> tuple[Real, Real]:
    """Radii of curvature on the ellipsoid (m): of the meridian, and of the prime vertical."""
    squash = 1 - ECCENTRICITY_SQUARED * sin_lat * sin_lat
    prime_vertical = SEMI_MAJOR_AXIS * squash**-0.5
    return prime_vertical * ((1 - ECCENTRICITY_SQUARED) / squash), prime_vertical


def gravity(sin_lat: Real, height: Real) -> Real:
    """Normal (plumb-bob) gravity, down, m/s²; height above the ellipsoid in m.

    Somigliana's formula on the ellipsoid and its second-order expansion in height (NIMA
    TR8350.2, Eq. 4-1 and 4-3).
    """
    square = sin_lat * sin_lat
    squash = 1 - ECCENTRICITY_SQUARED * square
    surface = GRAVITY_EQUATOR * (1 + _SOMIGLIANA_K * square) * squash**-0.5
    ratio = height / SEMI_MAJOR_AXIS
    slope = 2 * (1 + FLATTENING + _CENTRIFUGAL_M - 2 * FLATTENING * square)
    value: Real = surface * (1 - ratio * (slope - 3 * ratio))
    return value


def gravity_lean(sin_lat: Real, height: Real) -> Real:
    """Horizontal part of normal gravity over the horizontal part of the polar axis, m/s².

    Plumb lines are bent: on the ellipsoid gravity is square to it, above it leans to the equator.
    Times cos φ this is its part north, about -8.1e-9 h sin 2φ; times the polar axis in a level
    frame, its parts along that frame's axes, without a singularity at the poles.  The potential is
    W = W0 - ∫ g dh with the g of `gravity` and the same W0 everywhere on the ellipsoid, and this
    is its ∂W/∂φ / (R_M + h) / cos φ, term by term.
    """
    square = sin_lat * sin_lat
    squash = 1 - ECCENTRICITY_SQUARED * square
    surface = GRAVITY_EQUATOR * (1 + _SOMIGLIANA_K * square) * squash**-0.5
    growth = _SOMIGLIANA_K / (1 + _SOMIGLIANA_K * square) + 0.5 * ECCENTRICITY_SQUARED / squash
    ratio = height / SEMI_MAJOR_AXIS
    half_slope = 1 + FLATTENING + _CENTRIFUGAL_M - 2 * FLATTENING * square
    tilt = growth * (1 - ratio * (half_slope - ratio)) + 2 * FLATTENING * ratio
    meridian, _ = radii(sin_lat)
    value: Real = -2 * sin_lat * surface * tilt * height / (meridian + height)
    return value


def earth_rate(sin_lat: Real, cos_lat: Real) -> tuple[Real, Real, Real]:
    """Earth's rotation ω_ie in north, east, down (rad/s)."""
    return EARTH_RATE * cos_lat, 0 * cos_lat, -EARTH_RATE * sin_lat


def transport_rate(
    sin_lat: Real, cos_lat: Real, height: Real, velocity: tuple[Real, Real, Real]
) -> tuple[Real, Real, Real]:
    """Rotation ω_en of the north-east-down frame over the Earth (rad/s) at a velocity (m/s)."""
    meridian, prime_vertical = radii(sin_lat)
    north, east, _ = velocity
    over_east = east / (prime_vertical + height)
    return over_east, -north / (meridian + height), -over_east * sin_lat / cos_lat
