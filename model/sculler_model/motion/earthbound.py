"""A body moving over the turning Earth: its state, and what its sensors feel, without integration.

The path is given in a geographic grid: grid latitude λ, grid longitude σ and height h as functions
of time.  The grid is the Earth's own or one turned against it, so that a path may cross a pole as
smoothly as any other place.  With n the normal of the ellipsoid (grid latitude and longitude are
its direction), k the Earth's axis, s = n·k the sine of geodetic latitude and N the radius of the
prime vertical, the position is

    X = (N + h) n - e² N s k                       N = a/√D,  D = 1 - e² s²            (M1)

and with ρ the rate of the grid's level frame (north, east, down) over the Earth, ṅ = ρ×n,

    v = (N + h) ṅ + ḣ n - e² (N ṡ/D) k_level,      the vertical part being ḣ alone      (M2)

since Ṅ = N g with g = e² s ṡ/D.  One more derivative, component by component, gives what the
accelerometers feel: f = v̇ + (2ω_ie + ρ)×v - gravity.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import cos, degrees, radians, sin

import numpy as np

from sculler_model.errors import InputError
from sculler_model.frames import (
    Quaternion,
    Quaternions,
    Vector,
    Vectors,
    conjugate,
    product,
    radii,
    rotate,
)
from sculler_model.motion import sampling
from sculler_model.motion.compiled import loops
from sculler_model.motion.curves import ZERO_CURVE, Array, Jet, Smooth
from sculler_model.motion.kinematics import felt, followed, seen
from sculler_model.motion.sampling import Sampled
from sculler_model.motion.turns import Rotation, attitude_jet
from sculler_model.navigation import NavHistory

_NEAR_POLE = radians(89.9)


@dataclass(frozen=True)
class Motion(Sampled):
    """A body moving over the turning WGS-84 Earth, all of it analytic.

    Attributes:
        lat, lon, h: position (rad, rad, m) that the path starts from, in the grid.
        north, east, up: displacement, m, along the grid; grid latitude and longitude are the
            displacement over the radii at the starting point, so the path is exact and the metres
            are nominal.
        turns: attitude, body to the grid's north-east-down (first outermost).
        arm: from the point that the path leads to the sensors, body axes x, y, z, m: a lever arm,
            or a vibration; empty for none.
        grid: quaternion from grid to Earth axes (x to longitude 0, z to the north pole); None for
            the Earth's own grid.
        name: what it is.

    Raises:
        InputError: the path begins within 0.1° of a pole of the Earth's own grid.

    Examples:
        >>> import sculler
        >>> still = sculler.Motion(lat=0.8, lon=0.2, h=500.0)
        >>> samples = still.increments(3, 0.01)
        >>> samples.shape, f"{samples[0, 5] / 0.01:.2f} m/s²"
        ((3, 6), '-9.81 m/s²')
    """

    lat: float
    lon: float
    h: float
    north: Smooth = ZERO_CURVE
    east: Smooth = ZERO_CURVE
    up: Smooth = ZERO_CURVE
    turns: tuple[Rotation, ...] = ()
    arm: tuple[Smooth, ...] = ()
    grid: Quaternion | None = None
    name: str = "motion"

    def __post_init__(self) -> None:
        if self.grid is None and abs(self.lat) > _NEAR_POLE and not self._still:
            raise InputError(
                f"{self.name}: latitude {degrees(self.lat):.6g}° is within 0.1° of a pole, where"
                " only a body at rest or on a great circle can be; give another latitude"
            )

    @property
    def _still(self) -> bool:
        """It stays on one vertical, whatever its attitude."""
        return self.north == self.east == ZERO_CURVE and not self.arm

    def state(self, t: Array) -> NavHistory:
        """True states at times t (N,), s; geodetic, whatever the grid."""
        path = _Path(self, t)
        q, v = path.q, path.velocity
        if self.grid is None:
            lat, lon = path.lat[0], path.lon[0]
        else:
            lat, lon, convergence = self._geodetic(path)
            zero = np.zeros_like(t)
            turn: Quaternions = (np.cos(0.5 * convergence), zero, zero, np.sin(0.5 * convergence))
            q, v = product(turn, q), rotate(turn, v)
        lon = lon - 2 * np.pi * np.round(lon / (2 * np.pi))
        return NavHistory(np.array(t), np.stack(q, 1), np.stack(v, 1), lat, lon, path.h[0])

    def states(self, count: int, every: float, start: float = 0.0) -> Iterator[NavHistory]:
        """True states at even times, block by block, in bounded memory.

        Args:
            count: how many in all.
            every: time between them, s.
            start: time of the first, s.

        Yields:
            `state` of the next `sampling.CHUNK` times.
        """
        block = sampling.CHUNK
        for first in range(0, count, block):
            number = np.arange(first, min(first + block, count), dtype=np.float64)
            yield self.state(start + number * every)

    def sensed(self, t: Array) -> Array:
        """What perfect sensors feel at times t (N,).

        Returns:
            (N, 6): ω_ib (rad/s), then specific force (m/s²), in the body frame.
        """
        return _Path(self, t).felt()

    @property
    def highest(self) -> float:
        """A bound on the frequencies (rad/s) that matter: all of them together, and a harmonic."""
        spins = sum(turn.steepest for turn in self.turns)
        waves = sum(turn.highest for turn in self.turns)
        curves = (self.north, self.east, self.up, *self.arm)
        return 2.0 * (spins + waves + max(curve.highest for curve in curves))

    @property
    def rough(self) -> float:
        """The same of the curves that have knots; 0 if none has."""
        curves = (self.north, self.east, self.up, *self.arm)
        turning = sum(turn.rough for turn in self.turns)
        return 2.0 * (turning + max(curve.rough for curve in curves))

    def _geodetic(self, path: _Path) -> tuple[Array, Array, Array]:
        """Latitude, longitude, and by how much grid north lies east of true north (rad)."""
        assert self.grid is not None
        one = np.ones_like(path.h[0])
        w, x, y, z = self.grid
        to_earth: Quaternions = (w * one, x * one, y * one, z * one)
        n_x, n_y, n_z = rotate(to_earth, path.normal)
        across = np.hypot(n_x, n_y)
        lat, lon = np.arctan2(n_z, across), np.arctan2(n_y, n_x)
        # true north by that longitude, so that the two agree even at a pole
        g_x, g_y, g_z = rotate(to_earth, path.grid_north)
        sin_lat, cos_lat, sin_lon, cos_lon = n_z, across, np.sin(lon), np.cos(lon)
        along_north = cos_lat * g_z - sin_lat * (cos_lon * g_x + sin_lon * g_y)
        along_east = cos_lon * g_y - sin_lon * g_x
        return lat, lon, np.arctan2(along_east, along_north)


class _Path:
    """Everything about a motion at times t, in the grid's level frame (north, east, down).

    Attributes:
        q: body to level frame.
        lat, lon, h: grid coordinates, each with two derivatives.
    """

    def __init__(self, motion: Motion, t: Array) -> None:
        self._loops = loops(len(t), t.dtype)
        self._attitude = attitude_jet(motion.turns, t, self._loops)
        self.q = self._attitude[0]
        meridian, prime_vertical = radii(sin(motion.lat))
        per_north = 1 / (meridian + motion.h)
        per_east = 1 / ((prime_vertical + motion.h) * cos(motion.lat))
        north, east, up = motion.north.jet(t), motion.east.jet(t), motion.up.jet(t)
        if motion.arm:
            arm = self._seen(motion.arm, t)
            north, east = _added(north, arm[0]), _added(east, arm[1])
            up = _added(up, (-arm[2][0], -arm[2][1], -arm[2][2]))
        self.lat = (motion.lat + per_north * north[0], per_north * north[1], per_north * north[2])
        self.lon = (motion.lon + per_east * east[0], per_east * east[1], per_east * east[2])
        self.h = (motion.h + up[0], up[1], up[2])
        lat, lon = self.lat[0], self.lon[0]
        self._sines = np.sin(lat), np.cos(lat), np.sin(lon), np.cos(lon)
        self._axis = earth_axis(motion.grid)

    def _seen(self, arm: tuple[Smooth, ...], t: Array) -> tuple[Jet, Jet, Jet]:
        """The arm from the level frame, axis by axis."""
        x, y, z = (part.jet(t) for part in arm)
        if self._loops is None:
            return seen((x, y, z), *self._attitude)
        found = np.empty((9, len(t)))
        self._loops.see((x, y, z), *self._attitude, found)
        return (
            (found[0], found[1], found[2]),
            (found[3], found[4], found[5]),
            (found[6], found[7], found[8]),
        )

    @property
    def velocity(self) -> Vectors:
        """Over the Earth, north, east, down in the grid, m/s."""
        return followed(self.lat, self.lon, self.h, self._sines, self._axis)[2]

    def felt(self) -> Array:
        """ω_ib and specific force in body axes (N, 6)."""
        place = self.lat, self.lon, self.h, self._sines, self._axis
        if self._loops is None:
            turning, force = felt(self.q, self._attitude[1], *place)
            return np.stack((*turning, *force), axis=1)
        found = np.empty((len(self.h[0]), 6))
        self._loops.feel(self.q, self._attitude[1], *place, found)
        return found

    @property
    def normal(self) -> Vectors:
        """n in grid components."""
        sin_lat, cos_lat, sin_lon, cos_lon = self._sines
        return cos_lat * cos_lon, cos_lat * sin_lon, sin_lat

    @property
    def grid_north(self) -> Vectors:
        """The level frame's first axis in grid components."""
        sin_lat, cos_lat, sin_lon, cos_lon = self._sines
        return -sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat


def earth_axis(grid: Quaternion | None) -> Vector:
    """The Earth's axis in grid components."""
    return (0.0, 0.0, 1.0) if grid is None else rotate(conjugate(grid), (0.0, 0.0, 1.0))


def _added(a: Jet, b: Jet) -> Jet:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]
