"""Where the body is: one instant, or many, in geographic terms.

Frames: body b is x forward, y right, z down; n is north, east, down at the body's geodetic
position on WGS-84; q_nb takes body components to n components.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import degrees, isfinite, pi, sqrt
from typing import Any, NamedTuple, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

from sculler_model.errors import InputError
from sculler_model.frames import Quaternion, Vector, euler_angles, to_euler
from sculler_model.host import MajorIncrements
from sculler_model.tables import Table, vector_columns

Array = NDArray[np.float64]

Selection = TypeVar("Selection", slice, NDArray[np.intp], NDArray[np.bool_])

MIN_HEIGHT, MAX_HEIGHT = -10e3, 1000e3
"""Heights (m) to navigate in; normal gravity is right at all of them."""


class NavState(NamedTuple):
    """Where the body is at one instant.

    Attributes:
        time: s.
        q: q_nb (w, x, y, z), body to north-east-down.
        v: velocity over the Earth (m/s) north, east, down.
        lat, lon: geodetic, rad; lon in -pi..pi.
        h: height above the ellipsoid, m.
        wander: the wander angle α, from north to the x axis of the frame that the mechanisation
            works in, positive towards east, rad in -pi..pi; 0 for a north-pointing one.

    Examples:
        >>> import sculler
        >>> still = (0.0, 0.0, 0.0)
        >>> state = sculler.NavState(0.0, (1.0, 0.0, 0.0, 0.0), still, 0.8, 0.2, 500.0)
        >>> state.euler
        (0.0, 0.0, 0.0)
    """

    time: float
    q: Quaternion
    v: Vector
    lat: float
    lon: float
    h: float
    wander: float = 0.0

    @property
    def v_enu(self) -> Vector:
        """Velocity over the Earth (m/s) east, north, up."""
        return (self.v[1], self.v[0], -self.v[2])

    @property
    def euler(self) -> Vector:
        """Roll, pitch, heading (rad), heading from north to east."""
        return to_euler(self.q)

    @property
    def azimuth(self) -> float:
        """Heading (rad) from the mechanisation's x axis instead of north, in -pi..pi.

        Over a pole heading jumps, for north does; a wander azimuth does not.
        """
        return wrapped(to_euler(self.q)[2] - self.wander)


@dataclass(frozen=True)
class NavHistory(Table):
    """States at many instants, as arrays (see `NavState` for frames and units).

    Attributes:
        time: (N,) s.
        q: (N, 4) body to north-east-down, scalar first.
        v: (N, 3) m/s north, east, down.
        lat, lon: (N,) rad.
        h: (N,) m.
        wander: (N,) rad; zeros if left out.

    Examples:
        >>> import sculler
        >>> state = sculler.NavState(0.0, (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.8, 0.2, 500.0)
        >>> history = sculler.NavHistory.from_states([state, state])
        >>> history.to_numpy().shape, list(history.named_columns())[:5]
        ((2, 15), ['time_s', 'q_w', 'q_x', 'q_y', 'q_z'])
    """

    time: Array
    q: Array
    v: Array
    lat: Array
    lon: Array
    h: Array
    wander: Array = field(default_factory=lambda: np.zeros(0))

    def __post_init__(self) -> None:
        if not len(self.wander):
            object.__setattr__(self, "wander", np.zeros(len(self.time)))

    @classmethod
    def from_table(cls, time: Array, table: Array) -> NavHistory:
        """From (N,) times and an (N, 11) table: q_nb, v, lat, lon, h, wander."""
        return cls(time, table[:, :4], table[:, 4:7], *table[:, 7:].T)

    @classmethod
    def from_states(cls, states: Sequence[NavState]) -> NavHistory:
        """Collect states."""
        rows = [(s.time, *s.q, *s.v, s.lat, s.lon, s.h, s.wander) for s in states]
        flat = np.array(rows, dtype=np.float64).reshape(-1, 12)
        return cls.from_table(flat[:, 0], flat[:, 1:])

    @classmethod
    def concatenate(cls, parts: Sequence[NavHistory]) -> NavHistory:
        """Join in order.

        Raises:
            ValueError: there is no part.
        """
        fields = ("time", "q", "v", "lat", "lon", "h", "wander")
        return cls(*(np.concatenate([getattr(part, name) for part in parts]) for name in fields))

    def __len__(self) -> int:
        return len(self.time)

    def rows(self, which: Selection) -> NavHistory:
        """Some of the states: a slice, indices or a mask."""
        return NavHistory(
            self.time[which],
            self.q[which],
            self.v[which],
            self.lat[which],
            self.lon[which],
            self.h[which],
            self.wander[which],
        )

    def state(self, row: int) -> NavState:
        """The state of one row."""
        w, x, y, z = self.q[row].tolist()
        north, east, down = self.v[row].tolist()
        return NavState(
            float(self.time[row]),
            (w, x, y, z),
            (north, east, down),
            float(self.lat[row]),
            float(self.lon[row]),
            float(self.h[row]),
            float(self.wander[row]),
        )

    def named_columns(self) -> dict[str, NDArray[Any]]:
        """The columns of `sculler navigate`: angles in degrees, the rest in SI units."""
        return {
            "time_s": self.time,
            **vector_columns(("q_w", "q_x", "q_y", "q_z"), self.q),
            **vector_columns(("roll_deg", "pitch_deg", "heading_deg"), np.degrees(self.euler)),
            **vector_columns(("v_north", "v_east", "v_down"), self.v),
            "lat_deg": np.degrees(self.lat),
            "lon_deg": np.degrees(self.lon),
            "height_m": self.h,
            "wander_deg": np.degrees(self.wander),
        }

    @property
    def v_enu(self) -> Array:
        """(N, 3) velocity over the Earth (m/s) east, north, up."""
        turned: Array = self.v[:, [1, 0, 2]] * np.array([1.0, 1.0, -1.0])
        return turned

    @property
    def euler(self) -> Array:
        """(N, 3) roll, pitch, heading, rad; heading from north to east."""
        return euler_angles(self.q)

    @property
    def azimuth(self) -> Array:
        """(N,) heading from the mechanisation's x axis (see `NavState.azimuth`), rad, -pi..pi."""
        turned = self.euler[:, 2] - self.wander
        result: Array = turned - 2 * pi * np.round(turned / (2 * pi))
        return result


def wrapped(angle: float) -> float:
    """An angle (rad) of at most a turn and a half, brought to -pi..pi."""
    if angle > pi:
        return angle - 2 * pi
    return angle + 2 * pi if angle < -pi else angle


VectorLike: TypeAlias = Sequence[float] | Array
"""Three components as a tuple, a list or an array of shape (3,)."""


def three_numbers(name: str, vector: VectorLike) -> Vector:
    """A vector as three floats of Python.

    Raises:
        InputError: it is not three numbers.
    """
    numbers: tuple[object, ...] = ()
    try:
        x, y, z = vector.tolist() if isinstance(vector, np.ndarray) else vector
        if type(x) is type(y) is type(z) is float:
            return (x, y, z)
        numbers = x + 0.0, y + 0.0, z + 0.0  # text has no such sum
    except (TypeError, ValueError):
        pass
    floats = [float(number) for number in numbers if isinstance(number, float | np.floating)]
    if len(floats) != 3:
        shape = f" of shape {vector.shape}" if isinstance(vector, np.ndarray) else ""
        raise InputError(
            f"{name}: {type(vector).__name__}{shape} is not allowed, give three numbers as a"
            " tuple, a list or an array of shape (3,)"
        )
    return (floats[0], floats[1], floats[2])


def told_times(increments: MajorIncrements) -> Array | None:
    """The instants that increments tell, checked.

    Raises:
        InputError: they are not one for each interval, finite and running forwards.
    """
    if increments.times is None:
        return None
    times = np.asarray(increments.times, np.float64)
    if times.shape != (len(increments),):
        raise InputError(f"times: shape {times.shape}, give ({len(increments)},)")
    if not (np.isfinite(times).all() and (np.diff(times) > 0).all()):
        raise InputError("times: give finite instants that run forwards")
    return times


def check_state(state: NavState) -> None:
    """Refuse a state that cannot be navigated from.

    Raises:
        InputError: a number is not finite, the latitude is outside ±90°, the longitude or the
            wander angle outside ±180°, the height outside `MIN_HEIGHT`..`MAX_HEIGHT`, or the
            quaternion is not of length 1 (to 1e-6).
    """
    numbers = (state.time, *state.q, *state.v, state.lat, state.lon, state.h, state.wander)
    if not all(isfinite(number) for number in numbers):
        raise InputError(f"initial state: a value is not finite in {state}, give numbers")
    for name, angle, most in (
        ("latitude", state.lat, pi / 2),
        ("longitude", state.lon, pi),
        ("wander angle", state.wander, pi),
    ):
        if abs(angle) > most:
            raise InputError(
                f"initial state: {name} {degrees(angle):.6g}° is not allowed, give one from"
                f" -{degrees(most):.0f}° to {degrees(most):.0f}°"
            )
    if not MIN_HEIGHT <= state.h <= MAX_HEIGHT:
        raise InputError(
            f"initial state: height {state.h:.6g} m is not allowed, give one from"
            f" {MIN_HEIGHT:.0f} m to {MAX_HEIGHT:.0f} m above the ellipsoid"
        )
    length = sqrt(sum(c * c for c in state.q))
    if abs(length - 1) > 1e-6:
        raise InputError(f"initial state: the quaternion has length {length:.6g}, give length 1")
