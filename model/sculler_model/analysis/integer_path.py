"""The integer path as a measuring instrument: SI samples to counts, core, host and attitude."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.fast import FastModel, VectorBlock
from sculler_model.frames import product
from sculler_model.samples import Quantiser

Array = NDArray[np.float64]

FINE_BITS = 32
_HEADROOM_BITS = 2  # the sign, and a factor of two over the largest sample


def changed(design: Design, **parts: dict[str, Any]) -> Design:
    """The design with keys of its parts replaced, as in ``changed(d, algorithm={"minors": 2})``."""
    data = design.as_json()
    for part, values in parts.items():
        data[part] = data.get(part, {}) | values
    return Design.parse(data)


def with_fine_sensor(design: Design, gyro_peak: float, accel_peak: float = 0.0) -> Design:
    """The design on a sensor of 32 bits, as fine as samples of these sizes allow.

    Args:
        design: the design.
        gyro_peak, accel_peak: largest sample, rad and m/s (rad/s and m/s² for a rate sensor);
            0 leaves that sensor as it is.
    """
    sensors = {
        name: {"bits": FINE_BITS, "lsb": peak / 2.0 ** (FINE_BITS - _HEADROOM_BITS)}
        for name, peak in (("gyro", gyro_peak), ("accel", accel_peak))
        if peak > 0
    }
    return changed(design, sensor=sensors)


def through_core(design: Design, samples: Array) -> VectorBlock:
    """Vectors of all complete major intervals.

    Args:
        design: the design.
        samples: (N, 6) as `Quantiser` takes them.

    Raises:
        InputError: a sample does not fit the sensor's word, or the design has compensation, which
            studies of what is behind it know nothing of.
    """
    if design.compensation is not None:
        raise InputError("compensation: studies are of what is behind it, leave the table out")
    return FastModel(design).feed(Quantiser(design)(samples))


def running_attitude(phi: Array) -> Array:
    """Attitude after each of consecutive rotation vectors, exact (Savage-20 Eq. 1).

    Args:
        phi: (R, 3), rad.

    Returns:
        (R, 4) quaternions, from the frame at each interval's end to the frame at the first one's
        start.
    """
    half = 0.5 * np.sqrt(np.sum(phi * phi, axis=1))
    q = np.column_stack((np.cos(half), 0.5 * np.sinc(half / np.pi)[:, None] * phi))
    step = 1
    while step < len(q):  # products of 1, 2, 4, ... consecutive rotations
        q[step:] = np.stack(product(tuple(q[:-step].T), tuple(q[step:].T)), axis=1)
        step *= 2
    return q


def rotation_vectors(q: Array) -> Array:
    """(R, 3) rad, the short way round, of (R, 4) quaternions."""
    q = np.where(q[:, :1] < 0, -q, q)
    sine = np.sqrt(np.sum(q[:, 1:] ** 2, axis=1))
    small = sine < 1e-9  # the angle over a small sine is 2
    scale = np.where(small, 2.0, 2 * np.arctan2(sine, q[:, 0]) / np.where(small, 1.0, sine))
    vectors: Array = scale[:, None] * q[:, 1:]
    return vectors


def unquantised(design: Design, samples: Array) -> tuple[Array, Array]:
    """The design's algorithm on samples as they are: the integer path without counts, in doubles.

    Args:
        design: the design.
        samples: (N, 6) as `Quantiser` takes them; the samples before the first are zero.

    Returns:
        φ and α (rad) of the R complete major intervals, each (R, 3).
    """
    table, n = design.table, design.table.samples
    majors = len(samples) // design.samples_per_major
    scale = 1.0 if design.sensor.kind == "increment" else design.sample_interval
    before = table.history
    s = np.zeros((before + majors * design.samples_per_major, 3))
    s[before:] = scale * samples[: majors * design.samples_per_major, :3]

    def back(k: int, d: int) -> Array:
        """s[t-d] at phase k of every minor interval."""
        return s[before + k - 1 - d : len(s) - d : n][: majors * design.algorithm.minors]

    within = np.zeros((majors * design.algorithm.minors, 3))
    for k in table.active_phases:
        A = sum(
            (tap * back(k, d) for d, tap in enumerate(table.taps[k - 1], start=1) if tap),
            np.zeros_like(within),
        )
        within += np.cross(A, back(k, 0)) / table.denominator
    theta = sum((w * back(n, d) for d, w in enumerate(table.weights) if w), np.zeros_like(within))
    theta = (theta / table.sum_denominator).reshape(majors, -1, 3)
    alpha = np.cumsum(theta, axis=1)
    coning = within.reshape(theta.shape) + 0.5 * np.cross(alpha - theta, theta)
    return alpha[:, -1] + coning.sum(axis=1), alpha[:, -1]
