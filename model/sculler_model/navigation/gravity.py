"""Models of gravity to navigate by: the normal field, a constant, or what was measured.

A `Gravity` is a plain tuple and `gravity_at` is arithmetic on floats, so that the navigator
compiles them with the rest.
"""

from __future__ import annotations

from math import asin, degrees, isfinite
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sculler_model.errors import InputError
from sculler_model.frames import STANDARD_GRAVITY, gravity, normal_gravity
from sculler_model.navigation.state import MAX_HEIGHT, MIN_HEIGHT

Array = NDArray[np.float64]

LEAST, MOST = 5.0, 10.0
"""What a model may say, m/s²: on the Earth gravity is 9.76 to 9.84, at 1000 km 7.3."""


class GravityTable(NamedTuple):
    """Points of a table of gravity.

    Attributes:
        lats: (I,) degrees, rising; a single one stands for all latitudes.
        heights: (J,) m, rising; a single one stands for all heights.
        excess: (I, J) m/s², what the points have more than normal gravity.
    """

    lats: Array
    heights: Array
    excess: Array


class Gravity(NamedTuple):
    """A model of plumb-bob gravity over the turning Earth; made by the functions below.

    Attributes:
        value: of a constant, m/s²; None for any other.
        table: what is more than normal gravity; None for nothing.
    """

    value: float | None
    table: GravityTable | None

    def __str__(self) -> str:
        """In words."""
        if self.value is not None:
            return f"constant, {self.value:.10g} m/s²"
        if self.table is not None:
            most = float(np.abs(self.table.excess).max())
            return f"table, up to {1e5 * most:.4g} mGal off the normal field"
        return "normal field of WGS-84"


NORMAL = Gravity(None, None)
"""The normal field of WGS-84, `earth.normal_gravity`."""


def constant_gravity(value: float = STANDARD_GRAVITY) -> Gravity:
    """The same gravity everywhere, square to the ellipsoid.

    Args:
        value: m/s².

    Raises:
        InputError: it is not `LEAST` to `MOST`.
    """
    if not LEAST <= value <= MOST:
        raise InputError(
            f"constant gravity {value:g} is not allowed, give m/s² from {LEAST:g} to {MOST:g}"
        )
    return Gravity(float(value), None)


def table_of_gravity(lats: Array, heights: Array, values: Array) -> Gravity:
    """Gravity at points, and in between normal gravity with what the points have more.

    The excess over normal gravity is interpolated along straight lines in latitude and height, so
    a few points do; the table's values are met exactly.  One point is a measured local gravity:
    its excess holds everywhere.  Gravity leans as the normal field does.

    Args:
        lats: (I,) geodetic latitude, rad, rising.
        heights: (J,) above the ellipsoid, m, rising.
        values: (I, J) gravity's part down, m/s².

    Raises:
        InputError: the axes do not rise, leave the Earth, or do not fit the values; a value is not
            `LEAST` to `MOST`.
    """
    lats, heights, values = (np.array(a, np.float64) for a in (lats, heights, values))
    if values.shape != (len(lats), len(heights)) or not values.size:
        raise InputError(
            f"gravity table: {len(lats)} latitudes and {len(heights)} heights do not fit values of"
            f" shape {values.shape}"
        )
    within_right_angle = 0.5 * np.pi * (1 + 1e-12)
    for name, axis, least, most in (
        ("latitudes", lats, -within_right_angle, within_right_angle),
        ("heights", heights, MIN_HEIGHT, MAX_HEIGHT),
    ):
        if not (np.all(np.diff(axis) > 0) and least <= axis[0] and axis[-1] <= most):
            raise InputError(
                f"gravity table: the {name} must rise"
                " and stay within -90° to 90° and -10 km to 1000 km"
            )
    wrong = ~((values >= LEAST) & (values <= MOST))
    if wrong.any():
        raise InputError(
            f"gravity table: {values[wrong][0]:g} is not allowed, give m/s² from {LEAST:g} to"
            f" {MOST:g}"
        )
    normal = gravity(np.sin(lats)[:, None], heights[None, :])
    return Gravity(None, GravityTable(np.degrees(lats), heights, values - normal))


def gravity_at(model: Gravity, sin_lat: float, height: float) -> tuple[float, float]:
    """Plumb-bob gravity of a model at a place, as `frames.normal_gravity` gives it.

    Args:
        model: of gravity.
        sin_lat: sine of geodetic latitude.
        height: above the ellipsoid, m.

    Returns:
        Its horizontal part over the horizontal part of the polar axis (see `frames.gravity_lean`),
        and its part down, m/s².
    """
    return _gravity_at(model.value, model.table, sin_lat, height)


def _gravity_at(
    value: float | None, table: GravityTable | None, sin_lat: float, height: float
) -> tuple[float, float]:
    # Numba leaves out what an argument of None makes idle: each model is compiled by itself
    if value is not None:
        return 0.0, value
    lean, down = normal_gravity(sin_lat, height)
    if table is not None:
        down += _excess(table, degrees(asin(min(1.0, max(-1.0, sin_lat)))), height)
    return lean, down


def _excess(table: GravityTable, lat: float, height: float) -> float:
    """What a table has more than normal gravity (m/s²) at a latitude (degrees) and height."""
    lats, heights, points = table
    i, k, right = _between(lats, lat)
    j, m, above = _between(heights, height)
    low = points[i, j] + right * (points[k, j] - points[i, j])
    high = points[i, m] + right * (points[k, m] - points[i, m])
    return float(low + above * (high - low))


def _between(axis: Array, value: float) -> tuple[int, int, float]:
    """The points of an axis on either side of a value, and the part of the step to it."""
    if len(axis) < 2:
        return 0, 0, 0.0
    first, last = 0, len(axis) - 1
    while last - first > 1:
        middle = (first + last) // 2
        if axis[middle] <= value:
            first = middle
        else:
            last = middle
    return first, last, float((value - axis[first]) / (axis[last] - axis[first]))


def covers(model: Gravity, lat: float, height: float) -> bool:
    """Whether a model holds at a latitude (rad) and height (m)."""
    return MIN_HEIGHT <= height <= MAX_HEIGHT and _covers(model.table, lat, height)


def _covers(table: GravityTable | None, lat: float, height: float) -> bool:
    if table is None:
        return True
    lats, heights, _ = table
    return _holds(lats, degrees(lat)) and _holds(heights, height)


def _holds(axis: Array, value: float) -> bool:
    slack = 1e-9 * max(1.0, abs(value))  # a start on the very edge is not refused for rounding
    return len(axis) < 2 or axis[0] - slack <= value <= axis[-1] + slack


def refuse_outside(model: Gravity, time: float, lat: float, height: float) -> None:
    """Say why a model does not hold at a place.

    Raises:
        InputError: it does not.
    """
    if not MIN_HEIGHT <= height <= MAX_HEIGHT or not isfinite(height):
        raise InputError(
            f"time {time:.3f} s: the height has run away to {height:.4g} m, as a free"
            " vertical channel does, damp it or navigate for a shorter time"
        )
    if model.table is not None and not covers(model, lat, height):
        lats, heights = _range(model.table.lats), _range(model.table.heights)
        raise InputError(
            f"time {time:.3f} s: latitude {degrees(lat):.6g}° and height {height:.6g} m are outside"
            f" the gravity table (latitudes {lats}°, heights {heights} m), extend it"
        )


def _range(axis: Array) -> str:
    return "all" if len(axis) < 2 else f"{axis[0]:g} to {axis[-1]:g}"
