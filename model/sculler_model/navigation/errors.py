"""Errors of a navigated track against the truth: attitude, velocity, position, and their growth.

An error is estimate less truth, in the true north-east-down axes.  So that it means the same at a
pole as elsewhere, the estimate's north is first carried to the true place the shortest way: what is
left out is the turning of north with longitude, tan(lat)/R for every metre of error east.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sculler_model.frames import (
    Quaternions,
    Vectors,
    conjugate,
    earth_fixed,
    product,
    quaternions,
    rotate,
    rotation_vectors,
    vectors,
)
from sculler_model.navigation.state import NavHistory

Array = NDArray[np.float64]

NAUTICAL_MILE = 1852.0
"""m."""


@dataclass(frozen=True)
class NavErrors:
    """Errors at N instants, each (N, 3): north, east, down; NaN for what the truth does not tell.

    Attributes:
        time: (N,) s.
        attitude: rotation vector from the true to the estimated body, rad: tilt about north, tilt
            about east, heading.
        velocity: m/s.
        position: m.
    """

    time: Array
    attitude: Array
    velocity: Array
    position: Array

    @property
    def horizontal(self) -> Array:
        """(N,) distance between true and estimated place, over ground, m."""
        return np.hypot(self.position[:, 0], self.position[:, 1])


QUANTITIES = ("attitude", "velocity", "position")
NORTH_EAST_DOWN = ("north", "east", "down")


def known_quantities(truth: NavHistory) -> tuple[str, ...]:
    """Which `QUANTITIES` a truth tells: what it does not is NaN in all of its states."""
    columns = dict(zip(QUANTITIES, (truth.q[:, 0], truth.v[:, 0], truth.lat), strict=True))
    return tuple(name for name, column in columns.items() if not np.isnan(column).any())


def navigation_errors(estimate: NavHistory, truth: NavHistory) -> NavErrors:
    """Errors of states at the same instants, estimate less truth.

    A truth without position is taken to be at the estimate's place, so that its north is the same;
    so is an estimate without one.

    Args:
        estimate, truth: (N,) states each, at the same times; NaN all through in what the truth
            does not tell.

    Returns:
        In the true north-east-down axes, at the truth's times.
    """
    if "position" not in known_quantities(truth):
        place = {name: np.nan_to_num(getattr(estimate, name)) for name in ("lat", "lon", "h")}
        found = navigation_errors(replace(estimate, **place), replace(truth, **place))
        return replace(found, position=np.full((len(truth), 3), np.nan))
    level_e, level_t = _level_frame(estimate), _level_frame(truth)
    # the estimate's level frame against the true one, of which only the part about down is kept
    w, _, _, z = product(conjugate(level_t), level_e)
    length = np.hypot(w, z)
    twist: Quaternions = (w / length, 0 * w, 0 * w, z / length)

    q = product(product(twist, quaternions(estimate.q)), conjugate(quaternions(truth.q)))
    attitude = rotation_vectors(q)
    turned = rotate(twist, vectors(estimate.v))
    velocity = np.stack(turned, 1) - truth.v
    gap = np.stack(_cartesian(estimate), 1) - np.stack(_cartesian(truth), 1)
    north, east, _ = rotate(conjugate(level_t), vectors(gap))
    position = np.stack((north, east, truth.h - estimate.h), 1)
    return NavErrors(truth.time, attitude, velocity, position)


def _level_frame(history: NavHistory) -> Quaternions:
    """Quaternions from north-east-down to Earth axes."""
    # down is turned by -(lat + 90°) about east, east by longitude about the axis
    half_lon, half_lat = 0.5 * history.lon, -0.5 * (history.lat + 0.5 * np.pi)
    zero = np.zeros_like(half_lon)
    about_axis: Quaternions = (np.cos(half_lon), zero, zero, np.sin(half_lon))
    about_east: Quaternions = (np.cos(half_lat), zero, np.sin(half_lat), zero)
    return product(about_axis, about_east)


def _cartesian(history: NavHistory) -> Vectors:
    """Position in Earth axes, m."""
    return earth_fixed(history.lat, history.lon, history.h)
