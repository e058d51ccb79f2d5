"""Places on and over the WGS-84 ellipsoid: geodetic, Earth-fixed (ECEF), and local metres.

Earth axes: x to latitude 0 and longitude 0, z to the north pole.  Arrays of any shape.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sculler_model.frames.earth import ECCENTRICITY_SQUARED, SEMI_MAJOR_AXIS, radii

Array = NDArray[np.float64]
Three = tuple[Array, Array, Array]

_ROUNDS = 4  # each squares an error that begins below 1e-3 at any height from -10 to 1000 km


def earth_fixed(lat: Array, lon: Array, h: Array) -> Three:
    """Earth-fixed metres x, y, z of geodetic latitude, longitude (rad) and height (m)."""
    sin_lat = np.sin(lat)
    _, prime_vertical = radii(sin_lat)
    out = (prime_vertical + h) * np.cos(lat)
    up = ((1 - ECCENTRICITY_SQUARED) * prime_vertical + h) * sin_lat
    return out * np.cos(lon), out * np.sin(lon), up


def geodetic(x: Array, y: Array, z: Array) -> Three:
    """Geodetic latitude, longitude (rad) and height (m) of Earth-fixed metres, `earth_fixed` back.

    Bowring's formula for the latitude, repeated until rounding is all that is left; good from
    -1000 km up, at the poles too.
    """
    squash = np.sqrt(1 - ECCENTRICITY_SQUARED)
    minor = SEMI_MAJOR_AXIS * squash
    across = np.hypot(x, y)
    reduced = np.arctan2(z, squash * across)
    lat = reduced
    for _ in range(_ROUNDS):
        lat = np.arctan2(
            z + ECCENTRICITY_SQUARED / squash * SEMI_MAJOR_AXIS * np.sin(reduced) ** 3,
            across - ECCENTRICITY_SQUARED * SEMI_MAJOR_AXIS * np.cos(reduced) ** 3,
        )
        reduced = np.arctan2(squash * np.sin(lat), np.cos(lat))
    # the distance along the normal from the foot point, which is exact at every latitude
    h = (across - SEMI_MAJOR_AXIS * np.cos(reduced)) * np.cos(lat)
    h = h + (z - minor * np.sin(reduced)) * np.sin(lat)
    return lat, np.arctan2(y, x), h


def from_local(place: tuple[float, float, float], north: Array, east: Array, up: Array) -> Three:
    """Geodetic latitude, longitude (rad) and height (m) of metres in the tangent plane of a place.

    Args:
        place: latitude, longitude (rad), height (m) of the plane's origin.
        north, east, up: straight along the plane's axes, m; `up` is square to the plane, so a
            point 10 km away with `up` 0 is 8 m higher than the origin.
    """
    lat, lon, h = (np.float64(value) for value in place)
    sin_lat, cos_lat, sin_lon, cos_lon = np.sin(lat), np.cos(lat), np.sin(lon), np.cos(lon)
    x, y, z = earth_fixed(np.asarray(lat), np.asarray(lon), np.asarray(h))
    out = cos_lat * up - sin_lat * north
    return geodetic(
        x + cos_lon * out - sin_lon * east,
        y + sin_lon * out + cos_lon * east,
        z + sin_lat * up + cos_lat * north,
    )
