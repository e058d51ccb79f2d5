"""A motion through points of a trajectory that somebody measured, planned or simulated."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import cos, radians, sin

import numpy as np
from numpy.typing import NDArray

from sculler_model.errors import InputError
from sculler_model.frames import (
    Quaternion,
    conjugate,
    from_dcm,
    from_euler_rows,
    product,
    quaternions,
    radii,
    repeated,
    rotate,
    vectors,
)
from sculler_model.motion.curves import Array
from sculler_model.motion.earthbound import Motion
from sculler_model.motion.flight_plan import BANK_GRAVITY
from sculler_model.motion.points import NEAREST, Knots, PointCurve, Tumble

_NEAR_POLE = radians(80.0)
_FAR_FROM_GRID = radians(60.0)
_SLOW = 1.0  # m/s; below, the way has no direction to speak of
_BETWEEN = 4  # attitudes a point where the nose follows the way


@dataclass(frozen=True)
class Points:
    """Where a body was, at some instants.

    Attributes:
        time: (N,) s, running forwards.
        lat, lon, h: (N,) geodetic, rad, rad, m over the WGS-84 ellipsoid.
        q: (N, 4) quaternions, body (forward, right, down) to north-east-down; None where they are
            not known: the nose is along the way then, banked as the turn asks.
    """

    time: Array
    lat: Array
    lon: Array
    h: Array
    q: Array | None = None

    def __len__(self) -> int:
        return len(self.time)

    def apart(self, seconds: float) -> Points:
        """Only points that are so far apart: the first, then each that is at least so much later.

        The last is kept in place of the one before it, if that is nearer.
        """
        kept, last = [0], self.time[0]
        for place in range(1, len(self)):
            if self.time[place] - last >= seconds * (1 - 1e-9):
                kept.append(place)
                last = self.time[place]
        if kept[-1] != len(self) - 1 and len(kept) > 1:
            kept[-1] = len(self) - 1
        return self._at(np.array(kept))

    def _at(self, places: NDArray[np.intp]) -> Points:
        q = None if self.q is None else self.q[places]
        return Points(self.time[places], self.lat[places], self.lon[places], self.h[places], q)


def through(points: Points, smoothness: int = 3, name: str = "through points") -> Motion:
    """A smooth motion through points: at each it has the point's place and attitude.

    Latitude, longitude, height and the components of the quaternion are `PointCurve`s, so that rate
    and specific force follow from the curve without integration, as with any `Motion`.  Where the
    points come within 10° of a pole, latitude and longitude are those of a turned grid.

    Args:
        points: two at least; time 0 of the motion is the first one's.
        smoothness: continuous derivatives of place and attitude, 2 to 4: with 2 the specific force
            is continuous, with 3 its first derivative too.
        name: what it is.

    Raises:
        InputError: points are too near each other, the attitude between two of them or the way's
            direction is ambiguous, or they are near a pole and half round the Earth too.

    Examples:
        >>> import numpy as np
        >>> from sculler_model.motion import Points, through
        >>> time = np.arange(4.0)
        >>> way = through(Points(time, 0.8 + 1e-6 * time, 0.2 + 0 * time, 500 + 0 * time))
        >>> f"{way.state(np.array([1.5])).lat[0]:.7f}"
        '0.8000015'
    """
    time = points.time - points.time[0]
    knots = Knots(time, smoothness)
    bare = _path(points, knots, name)
    if points.q is None:
        return replace(bare, turns=(_along_the_way(bare, time, smoothness),))
    level = quaternions(bare.state(time).q)  # of a level body: how the grid is turned
    q = np.stack(product(conjugate(level), quaternions(points.q)), axis=1)
    return replace(bare, turns=(Tumble(knots, q),))


def _path(points: Points, knots: Knots, name: str) -> Motion:
    """The way, and no attitude."""
    grid, lat, lon = None, points.lat, points.lon
    if np.abs(lat).max() > _NEAR_POLE:
        normal = np.stack(
            (np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)), axis=1
        )
        grid = _grid(normal.mean(axis=0))
        to_grid = repeated(conjugate(grid), len(lat))
        x, y, z = rotate(to_grid, vectors(normal))
        lat, lon = np.arctan2(z, np.hypot(x, y)), np.arctan2(y, x)
        if max(np.abs(lat).max(), np.abs(lon).max()) > _FAR_FROM_GRID:
            raise InputError(
                "the points pass near a pole and go more than 60° from their middle too, give the"
                " trajectory in parts"
            )
    lon = np.unwrap(lon)
    start, h = float(lat[0]), float(points.h[0])
    meridian, prime_vertical = radii(sin(start))
    return Motion(
        start,
        float(lon[0]),
        h,
        north=PointCurve(knots, (lat - start) * (meridian + h)),
        east=PointCurve(knots, (lon - lon[0]) * ((prime_vertical + h) * cos(start))),
        up=PointCurve(knots, points.h - h),
        grid=grid,
        name=name,
    )


def _grid(middle: Array) -> Quaternion:
    """Grid whose latitude 0 and longitude 0 are in the middle of the points."""
    x = middle / np.linalg.norm(middle)
    y = np.cross((1.0, 0.0, 0.0) if abs(x[0]) < 0.7 else (0.0, 1.0, 0.0), x)
    y /= np.linalg.norm(y)
    rows = np.stack((x, y, np.cross(x, y)), axis=1).tolist()
    return from_dcm((tuple(rows[0]), tuple(rows[1]), tuple(rows[2])))


def _along_the_way(bare: Motion, time: Array, smoothness: int) -> Tumble:
    """Nose along the velocity, banked as a coordinated turn asks; heading held where it stands."""
    shares = np.arange(_BETWEEN) / _BETWEEN
    dense = np.append((time[:-1, None] + np.diff(time)[:, None] * shares).ravel(), time[-1])
    if np.diff(dense).min() < NEAREST:
        dense = time
    states = bare.state(dense)
    v = rotate(conjugate(quaternions(states.q)), vectors(states.v))
    speed = np.hypot(v[0], v[1])
    known = np.flatnonzero(speed > _SLOW)
    if len(known):
        course = np.interp(dense, dense[known], np.unwrap(np.arctan2(v[1], v[0])[known]))
    else:
        course = np.zeros_like(dense)
    leaps = np.abs(np.diff(course)) > radians(110)
    if leaps.any():
        raise InputError(
            f"the way turns back at about {dense[int(np.argmax(leaps))]:.6g} s after its start,"
            " where the nose cannot follow, give attitude too"
        )
    turn_rate = np.gradient(course, dense)
    moving = np.minimum(1, (speed / _SLOW) ** 4)
    bank = moving * np.arctan(speed * turn_rate / BANK_GRAVITY)
    pitch = moving * np.arctan2(-v[2], np.maximum(speed, 1e-9))
    q = from_euler_rows(np.stack((bank, pitch, course), axis=1))
    return Tumble(Knots(dense, smoothness), q)
