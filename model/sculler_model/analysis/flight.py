"""A manoeuvre of the user's own: rates and forces from a file, and what a design leaves of it.

Between its points each column follows a natural cubic spline; before and after it stands still.
There is no Earth and no gravity: attitude, velocity and position are in inertial space, from rest
and from body axes at time 0.  So what is left is the algorithms' alone.
"""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from functools import cached_property, lru_cache
from math import radians
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sculler_model.analysis.integer_path import (
    rotation_vectors,
    running_attitude,
    through_core,
    with_fine_sensor,
)
from sculler_model.analysis.sensed import Felt, delay, passed, reach
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.frames import STANDARD_GRAVITY, Quaternions, conjugate, product, rotate
from sculler_model.host import major_increments
from sculler_model.inputs import read_small

Array = NDArray[np.float64]

PROFILE_COLUMNS = ("time_s", "rate_x", "rate_y", "rate_z", "force_x", "force_y", "force_z")
"""Header of a manoeuvre file: s, °/s and g."""

LONGEST = 600.0
"""s, of a manoeuvre: each design runs through the whole of it."""

LARGEST = 1e6
"""rad/s and m/s²."""

FINE_STEPS = 1 << 14
"""Steps of the truth."""


@dataclass(frozen=True, eq=False)
class Profile:
    """Angular rate and specific force over time, in body axes.

    Attributes:
        name: what it is.
        times: (N,) s, rising, from 0 on.
        values: (N, 6) rad/s and m/s².

    Raises:
        InputError: fewer than two points, times that do not rise from 0, or numbers out of range.
    """

    name: str
    times: Array
    values: Array

    def __post_init__(self) -> None:
        if len(self.times) < 2:
            raise InputError(f"{self.name}: a manoeuvre needs two points or more")
        if not (np.isfinite(self.times).all() and np.isfinite(self.values).all()):
            raise InputError(f"{self.name}: a number is not finite")
        if np.abs(self.values).max() > LARGEST:
            raise InputError(
                f"{self.name}: a rate or a force is larger than any vehicle's, give less than"
                f" {LARGEST:g} rad/s and m/s²"
            )
        if self.times[0] != 0 or not (np.diff(self.times) > 0).all():
            raise InputError(f"{self.name}: time_s must rise from 0 on")
        if self.times[-1] > LONGEST:
            raise InputError(
                f"{self.name}: {self.times[-1]:g} s is too long, give at most {LONGEST:g} s"
            )

    @classmethod
    def load(cls, path: str | Path) -> Profile:
        """Read a CSV with the columns `PROFILE_COLUMNS`; those of force may be left out.

        Raises:
            InputError: it cannot be read or is not of this form; says the line.
        """
        wanted = ",".join(PROFILE_COLUMNS)
        text = read_small(path, "manoeuvre", f"a CSV {wanted}")
        try:
            lines = list(csv.reader(io.StringIO(text, newline="")))
        except csv.Error as error:
            raise InputError(f"{path}: not a CSV ({error}), give {wanted}") from error
        header = tuple(word.strip() for word in lines[0]) if lines else ()
        if header not in (PROFILE_COLUMNS, PROFILE_COLUMNS[:4]):
            raise InputError(f"{path}: line 1: the header must be {wanted} (without force, too)")
        points = []
        for number, words in enumerate(lines[1:], start=2):
            if not any(word.strip() for word in words):
                continue
            try:
                row = [float(word) for word in words]
            except ValueError:
                row = []
            if len(row) != len(header):
                raise InputError(
                    f"{path}: line {number}: {','.join(words)!r} is not {len(header)} numbers"
                )
            points.append(row + [0.0] * (len(PROFILE_COLUMNS) - len(header)))
        table = np.array(points, np.float64).reshape(-1, len(PROFILE_COLUMNS))
        scale = [radians(1)] * 3 + [STANDARD_GRAVITY] * 3
        return cls(str(path), table[:, 0], table[:, 1:] * scale)

    @property
    def duration(self) -> float:
        """s."""
        return float(self.times[-1])

    @property
    def peaks(self) -> tuple[float, float]:
        """Largest rate (rad/s) and specific force (m/s²), lengths of vectors."""
        seen = self.seen(np.linspace(0, self.duration, 20 * len(self.times)))
        rate, force = (np.linalg.norm(seen[:, part], axis=1) for part in (slice(3), slice(3, 6)))
        return float(rate.max()), float(force.max())

    def seen(self, t: Array) -> Array:
        """(N, 6) rate (rad/s) and specific force (m/s²) at times t."""
        k, u, inside = self._places(t)
        a, b, c, d = (part[k] for part in self._pieces)
        values = ((d * u + c) * u + b) * u + a
        return np.where(inside, values, 0.0)

    def gone(self, t: Array) -> Array:
        """(N, 6) integrals of them from 0 to t, rad and m/s."""
        k, u, _ = self._places(t)
        a, b, c, d = (part[k] for part in self._pieces)
        within = (((d / 4 * u + c / 3) * u + b / 2) * u + a) * u
        return np.asarray(self._starts[k] + within)

    def samples(self, design: Design, first: int, count: int) -> Array:
        """(count, 6) samples as the sensor gives them, the first one over ``first T`` on.

        Where no filter is stated, rate samples passed sinc(ΩT/2).

        Raises:
            InputError: the sensor's filter remembers for too long.
        """
        T, rate = design.sample_interval, design.sensor.kind == "rate"
        if design.sensor_response is not None:
            return passed(design, self.felt, first + int(rate), count)
        if not rate:
            return self.felt.increments(count, T, first)
        number = np.arange(first, first + count + 1, dtype=np.float64)
        return np.diff(self.gone((number + 0.5) * T), axis=0) / T

    @cached_property
    def felt(self) -> Felt:
        """What perfect sensors feel."""
        return Felt(self.seen, 0.0, self.gone)

    def _places(self, t: Array) -> tuple[NDArray[np.intp], Array, NDArray[np.bool_]]:
        at = np.clip(t, 0.0, self.duration)
        k = np.clip(np.searchsorted(self.times, at, side="right") - 1, 0, len(self.times) - 2)
        inside = (t >= 0) & (t <= self.duration)
        return k, (at - self.times[k])[:, None], inside[:, None]

    @cached_property
    def _pieces(self) -> tuple[Array, Array, Array, Array]:
        """Coefficients a, b, c, d (N-1, 6) of each piece: a natural cubic spline."""
        h = np.diff(self.times)[:, None]
        slope = np.diff(self.values, axis=0) / h
        curvature = _natural(h[:, 0], slope)
        b = slope - h * (2 * curvature[:-1] + curvature[1:]) / 6
        return self.values[:-1], b, curvature[:-1] / 2, np.diff(curvature, axis=0) / (6 * h)

    @cached_property
    def _starts(self) -> Array:
        """(N-1, 6) integrals up to each piece."""
        h = np.diff(self.times)[:, None]
        a, b, c, d = self._pieces
        whole = (((d / 4 * h + c / 3) * h + b / 2) * h + a) * h
        return np.concatenate((np.zeros((1, 6)), np.cumsum(whole, axis=0)[:-1]))


def _natural(h: Array, slope: Array) -> Array:
    """(N, 6) second derivatives at the points; none at the ends.  By Thomas's elimination."""
    count = len(h) + 1
    curvature = np.zeros((count, slope.shape[1]))
    if count == 2:
        return curvature
    right = 6 * np.diff(slope, axis=0)
    above, sums = np.zeros(count - 2), np.zeros_like(right)
    for i in range(count - 2):
        left = h[i] if i else 0.0
        pivot = 2 * (h[i] + h[i + 1]) - left * (above[i - 1] if i else 0.0)
        above[i] = h[i + 1] / pivot
        sums[i] = (right[i] - left * (sums[i - 1] if i else 0.0)) / pivot
    for i in reversed(range(count - 2)):
        curvature[i + 1] = sums[i] - (above[i] * curvature[i + 2] if i < count - 3 else 0.0)
    return curvature


@lru_cache(maxsize=64)
def truth(profile: Profile, end: float) -> tuple[Array, Array, Array]:
    """Attitude (4,), velocity (3,) m/s and position (3,) m at a time, s.

    Steps so fine that what the second order leaves out, which falls with their fourth power, is
    below rounding; forces are integrated by Gauss and Legendre's rule in each.
    """
    node, weight = np.polynomial.legendre.leggauss(4)
    node, weight = 0.5 * (node + 1), 0.5 * weight
    h = end / FINE_STEPS
    start = h * np.arange(FINE_STEPS, dtype=np.float64)
    begin = profile.gone(start)[:, :3]
    phi = profile.gone(start + h)[:, :3] - begin
    turned, moved = np.zeros_like(phi), np.zeros_like(phi)
    coning = np.zeros_like(phi)
    for x, w in zip(node, weight, strict=True):
        seen, alpha = profile.seen(start + x * h), profile.gone(start + x * h)[:, :3] - begin
        coning += 0.5 * w * h * np.cross(alpha, seen[:, :3])
        force = _rotated(_quaternions(alpha), seen[:, 3:])
        turned += w * h * force
        moved += w * h * (1 - x) * h * force
    q = running_attitude(phi + coning)
    before = np.vstack(([1.0, 0, 0, 0], q[:-1]))
    velocity, position = _put_together(before, turned, moved, h)
    return q[-1], velocity, position


def _quaternions(alpha: Array) -> Array:
    half = 0.5 * np.linalg.norm(alpha, axis=1)
    return np.column_stack((np.cos(half), 0.5 * np.sinc(half / np.pi)[:, None] * alpha))


def _rotated(q: Array, vectors: Array) -> Array:
    w, x, y, z = q.T
    quaternions: Quaternions = (w, x, y, z)
    a, b, c = vectors.T
    return np.stack(rotate(quaternions, (a, b, c)), axis=1)


def _put_together(q: Array, dv: Array, dr: Array | None, T: float) -> tuple[Array, Array]:
    """Velocity and position at the end of intervals; q at their starts; dr None: by trapezoid."""
    steps = _rotated(q, dv)
    velocity = np.cumsum(steps, axis=0)
    moved = T / 2 * steps if dr is None else _rotated(q, dr)
    return velocity[-1], np.sum(T * (velocity - steps) + moved, axis=0)


@dataclass(frozen=True)
class Flown:
    """What a design leaves of a manoeuvre at its end, sizes.

    Attributes:
        angle: of attitude, rad.
        velocity: m/s.
        position: m, by the trapezoid or at high resolution as the design has it.
    """

    angle: float
    velocity: float
    position: float


def flown(design: Design, profile: Profile) -> Flown:
    """A design's errors over a manoeuvre, through its integers on a sensor too fine to matter.

    Args:
        design: the design.
        profile: the manoeuvre; its first whole major intervals are flown, and held against the
            truth at their end, or as much earlier as the sensor's filter delays.

    Raises:
        InputError: it is shorter than a major interval, or the filter remembers for too long.
    """
    T, span = design.major_interval, design.samples_per_major
    majors = int(profile.duration / T + 1e-9)
    if majors < 1:
        raise InputError(f"{profile.name}: it is shorter than a major interval, {T:g} s")
    # a major interval at rest before it, or as many as the filter looks ahead
    early = max(-(-reach(design, profile.felt)[0] // span), 1)
    samples = profile.samples(design, -early * span, (majors + early) * span)
    peaks = np.abs(samples).max(axis=0)
    fine = with_fine_sensor(design, float(peaks[:3].max()), float(peaks[3:].max()))
    found = major_increments(fine, through_core(fine, samples))
    if design.sensor.kind == "rate" and design.sensor_response is None:
        # the leap to the first rates belongs to the interval before
        found = found[1:]
    q = running_attitude(found.phi)
    before = np.vstack(([1.0, 0, 0, 0], q[:-1]))
    velocity, position = _put_together(before, found.dv_sf, found.dr_sf, T)
    true_q, true_velocity, true_position = truth(profile, max(majors * T - delay(design), 0.0))
    difference = np.stack(product(conjugate(tuple(true_q)), tuple(q[-1])))[None]
    return Flown(
        float(np.linalg.norm(rotation_vectors(difference))),
        float(np.linalg.norm(velocity - true_velocity)),
        float(np.linalg.norm(position - true_position)),
    )
