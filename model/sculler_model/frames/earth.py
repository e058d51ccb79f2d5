"""WGS-84: figure, gravity and rotation, in the local frame north, east, down.

The functions take the sine (and cosine) of geodetic latitude and are arithmetic only, so they
serve the navigator with floats and the truth motions with arrays.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from sculler_model.frames.rotation import Real

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
STANDARD_GRAVITY = 9.80665
"""g, m/s²: what constant gravity is where nobody says otherwise."""

_SEMI_MINOR_AXIS = SEMI_MAJOR_AXIS * (1 - FLATTENING)
_FOCUS_SQUARED = ECCENTRICITY_SQUARED * SEMI_MAJOR_AXIS**2
"""E², m²: square of the meridian ellipse's linear eccentricity."""


def root(x: Real) -> Real:
    """Square root, rounded exactly, which `x**0.5` need not be; a host in C has the same."""
    return sqrt(x) if isinstance(x, float) else np.sqrt(x)


def radii(sin_lat: Real) -> tuple[Real, Real]:
    """Radii of curvature on the ellipsoid (m): of the meridian, and of the prime vertical.

    Args:
        sin_lat: sine of geodetic latitude.
    """
    squash = 1 - ECCENTRICITY_SQUARED * sin_lat * sin_lat
    prime_vertical = SEMI_MAJOR_AXIS / root(squash)
    return prime_vertical * ((1 - ECCENTRICITY_SQUARED) / squash), prime_vertical


def normal_gravity(sin_lat: Real, height: Real) -> tuple[Real, Real]:
    """Normal gravity of WGS-84 at any height, by its closed form.

    The gradient of the potential of the level ellipsoid that turns (Heiskanen and Moritz, Physical
    Geodesy, Eq. 2-126 to 2-130).  In their ellipsoidal coordinates u, β, with x = E²/u², the
    gravitation at X, z above the equator, is P X + (Q - P) z k with the polar axis k and

        P     = -(B + C sin²β) / (L u (1 + x))     B = GM + K S_p (½ sin²β - 1/6) / u²
        Q - P = -(B x - C) / (L u (1 + x))         C = K S_q (1 + x) / u²,  L = u² + E² sin²β

    in which nothing is singular and nothing cancels.  S_p and S_q are their q' and q less the
    leading power of E/u: alternating series in x < 0.0068, so what is left out is less than the
    next term, 1e-15 m/s² from 10 km under the ellipsoid up.  Rounding leaves 1e-14 m/s².

    Args:
        sin_lat: sine of geodetic latitude.
        height: above the ellipsoid, m; more than -10 km.

    Returns:
        Gravity's horizontal part over the horizontal part of the polar axis, m/s² (see
        `gravity_lean`), and its part down, m/s².
    """
    prime_vertical = SEMI_MAJOR_AXIS / root(1 - ECCENTRICITY_SQUARED * sin_lat * sin_lat)
    bulge = ECCENTRICITY_SQUARED * prime_vertical * sin_lat
    out = prime_vertical + height  # X = out n - bulge k, n the ellipsoid's normal
    z = out * sin_lat - bulge
    z_squared = z * z
    inner = out * (out - 2 * bulge * sin_lat) + bulge * bulge - _FOCUS_SQUARED  # |X|² - E²
    L = root(inner * inner + 4 * _FOCUS_SQUARED * z_squared)
    per_u2 = 2 / (inner + L)
    x = _FOCUS_SQUARED * per_u2
    sin2_beta = z_squared * per_u2
    s_p, s_q = _shape(x)
    B = GM + _ROTATION_K * per_u2 * s_p * (0.5 * sin2_beta - 1 / 6)
    C = _ROTATION_K * per_u2 * s_q * (1 + x)
    scale = root(per_u2) / (L * (1 + x))
    P = EARTH_RATE**2 - (B + C * sin2_beta) * scale  # with the centrifugal ω² (X - z k)
    along_axis = -(EARTH_RATE**2) * z - (B * x - C) * scale * z
    lean: Real = along_axis - P * bulge
    down: Real = -(P * out + lean * sin_lat)
    return lean, down


def _shape(x: Real) -> tuple[Real, Real]:
    """S_p and S_q of `normal_gravity`: (-x)^n by 6, by 2 (n + 1), over (2n + 3)(2n + 5), added."""
    s_p: Real = 2 / 5 - x * (6 / 35 - x * (2 / 21 - x * (2 / 33 - x * (6 / 143 - x * (2 / 65)))))
    s_q: Real = 2 / 15 - x * (4 / 35 - x * (2 / 21 - x * (8 / 99 - x * (10 / 143 - x * (4 / 65)))))
    return s_p, s_q


_ROTATION_K = (
    EARTH_RATE**2
    * SEMI_MAJOR_AXIS**2
    * _SEMI_MINOR_AXIS**3
    / _shape(_FOCUS_SQUARED / _SEMI_MINOR_AXIS**2)[1]
)
"""K = ω² a² E³ / q_0, m⁵/s²."""


def gravity(sin_lat: Real, height: Real) -> Real:
    """Normal (plumb-bob) gravity, down, m/s²; height above the ellipsoid in m."""
    return normal_gravity(sin_lat, height)[1]


def gravity_lean(sin_lat: Real, height: Real) -> Real:
    """Horizontal part of normal gravity over the horizontal part of the polar axis, m/s².

    Plumb lines are bent: on the ellipsoid gravity is square to it, above it leans to the equator.
    Times cos φ this is its part north, about -8.1e-9 h sin 2φ; times the polar axis in a level
    frame, its parts along that frame's axes, without a singularity at the poles.
    """
    return normal_gravity(sin_lat, height)[0]


GRAVITY_EQUATOR = gravity(0.0, 0.0)
"""Normal gravity on the ellipsoid at the equator, m/s²: 9.7803253359."""


def earth_rate(sin_lat: Real, cos_lat: Real) -> tuple[Real, Real, Real]:
    """Earth's rotation ω_ie in north, east, down (rad/s), of sine and cosine of latitude."""
    return EARTH_RATE * cos_lat, 0 * cos_lat, -EARTH_RATE * sin_lat


def transport_rate(
    sin_lat: Real, cos_lat: Real, height: Real, velocity: tuple[Real, Real, Real]
) -> tuple[Real, Real, Real]:
    """Rotation ω_en of the north-east-down frame over the Earth, in its own axes (Savage-98 Eq. 3).

    Args:
        sin_lat, cos_lat: of geodetic latitude.
        height: above the ellipsoid, m.
        velocity: over the Earth, north, east, down, m/s.

    Returns:
        North, east, down, rad/s; not defined at a pole, where `cos_lat` is 0.
    """
    meridian, prime_vertical = radii(sin_lat)
    north, east, _ = velocity
    over_east = east / (prime_vertical + height)
    return over_east, -north / (meridian + height), -over_east * sin_lat / cos_lat
