"""Arrays of rotations and vectors, component by component, as `frames` computes with them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sculler_model.frames.rotation import Quaternion, Quaternions, Vectors, from_euler

Array = NDArray[np.float64]


def quaternions(table: Array) -> Quaternions:
    """The columns of (N, 4)."""
    return table[:, 0], table[:, 1], table[:, 2], table[:, 3]


def vectors(table: Array) -> Vectors:
    """The columns of (N, 3)."""
    return table[:, 0], table[:, 1], table[:, 2]


def repeated(q: Quaternion, count: int) -> Quaternions:
    """One quaternion so many times."""
    w, x, y, z = q
    one = np.ones(count)
    return w * one, x * one, y * one, z * one


def rotation_vectors(q: Quaternions) -> Array:
    """Rotation vectors of many rotations, (N, 3) rad, the short way round."""
    sine = np.sqrt(q[1] ** 2 + q[2] ** 2 + q[3] ** 2)
    small = sine < 1e-150
    scale = np.where(small, 2.0, 2 * np.arctan2(sine, np.abs(q[0])) / np.where(small, 1.0, sine))
    scale = np.copysign(scale, q[0])
    return np.stack((scale * q[1], scale * q[2], scale * q[3]), 1)


def from_euler_rows(angles: Array) -> Array:
    """Quaternions (N, 4) of (N, 3) roll, pitch, heading (rad), as `from_euler`."""
    return np.array([from_euler(*row) for row in angles.tolist()])
