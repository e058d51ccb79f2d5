"""Smooth curves through given points: a function of time, and an attitude.

Between two points a curve is the polynomial of degree 2m + 1 that has their values and their first
m derivatives, so it goes through every point with m continuous derivatives.  The derivatives at a
point are those of the polynomial through it and its m neighbours on each side.  Near an end, where
there are fewer on one side, as many are taken on the other, m + 1 points in all at least: one-sided
polynomials of a high degree swing.  So a curve is local: it needs no memory but its points, and
reproduces polynomials up to degree m, away from the ends up to 2m.  Before the first point and
after the last one the outermost
polynomials go on.
"""

from __future__ import annotations

from functools import lru_cache
from math import factorial
from typing import NamedTuple

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

from sculler_model.errors import InputError
from sculler_model.frames import Quaternions, Vectors
from sculler_model.motion.curves import Array, Jet

NEAREST = 5e-4
"""s: points must be so far apart."""

SMOOTHNESS = (2, 3, 4)
"""How many continuous derivatives there can be."""


class _Places(NamedTuple):
    """Where instants are among the points.

    Attributes:
        cell: (N,) which of the cells in use an instant is in.
        left: (cells,) number of the point at the beginning of each cell in use.
        points: numbers of the points in use.
        window: (points, w) numbers of the points that give the derivatives of each of them.
        weights: (m, points, w) of them in the first, second, ... derivative.
        first, last: (cells,) which of the points in use are a cell's ends.
        basis: by derivative (3), by power of the cell's width (m + 1): weights (N,) of the
            derivatives at its beginning and at its end.
    """

    cell: NDArray[np.intp]
    left: NDArray[np.intp]
    points: NDArray[np.intp]
    window: NDArray[np.intp]
    weights: Array
    first: NDArray[np.intp]
    last: NDArray[np.intp]
    basis: list[list[tuple[Array, Array]]]


class Knots:
    """The instants of points, which all curves through them share.

    Args:
        times: (N,) s, running forwards; two at least.
        smoothness: m, continuous derivatives, one of `SMOOTHNESS`.

    Raises:
        InputError: two instants are nearer than `NEAREST`.
    """

    def __init__(self, times: Array, smoothness: int = 3) -> None:
        steps = np.diff(times)
        if len(times) < 2:
            raise InputError(f"{len(times)} point makes no curve, give two points at least")
        if smoothness not in SMOOTHNESS:
            raise InputError(
                f"smoothness {smoothness} is not allowed, give one of {SMOOTHNESS[0]} to"
                f" {SMOOTHNESS[-1]}"
            )
        if steps.min() < NEAREST * (1 - 1e-6):
            worst = int(np.argmin(steps))
            raise InputError(
                f"the points at {times[worst]:.9g} s and {times[worst + 1]:.9g} s are"
                f" {steps[worst]:.3g} s apart, give points {NEAREST:g} s apart or more"
            )
        self.times, self.smoothness = times, smoothness
        self.shortest = float(steps.min())
        self._latest: tuple[Array, _Places] | None = None

    def places(self, t: Array) -> _Places:
        """Where instants are; all curves of a motion ask about the same ones."""
        if self._latest is not None and np.array_equal(self._latest[0], t):
            return self._latest[1]
        m, times = self.smoothness, self.times
        cells = np.clip(np.searchsorted(times, t, "right") - 1, 0, len(times) - 2)
        left, cell = np.unique(cells, return_inverse=True)
        points = np.unique(np.concatenate((left, left + 1)))
        window, weights = self._windows(points)
        duration = times[left + 1] - times[left]
        u = (t - times[left][cell]) / duration[cell]
        basis = _basis(u, duration[cell], m)
        first, last = np.searchsorted(points, left), np.searchsorted(points, left + 1)
        found = _Places(cell, left, points, window, weights, first, last, basis)
        self._latest = (t.copy(), found)
        return found

    def _windows(self, points: NDArray[np.intp]) -> tuple[NDArray[np.intp], Array]:
        """`window` and `weights` of `_Places`; a window that is narrower ends in weights of 0."""
        m, times = self.smoothness, self.times
        many = len(times)
        aside = np.minimum(m, np.minimum(points, many - 1 - points))
        widths = np.minimum(many, np.maximum(2 * aside + 1, m + 1))
        starts = np.clip(points - aside, 0, many - widths)
        widest = int(widths.max())
        window = np.minimum(starts[:, None] + np.arange(widest), many - 1)
        weights = np.zeros((m, len(points), widest))
        for width in np.unique(widths).tolist():
            rows = np.flatnonzero(widths == width)
            offsets = times[window[rows, :width]] - times[points[rows]][:, None]
            weights[:, rows, :width] = derivative_weights(offsets, m)
        return window, weights


class PointCurve:
    """A smooth function of time through points.

    Args:
        knots: the instants.
        values: (N,) at them.
    """

    def __init__(self, knots: Knots, values: Array) -> None:
        self.knots, self.values = knots, values

    def jet(self, t: Array) -> Jet:
        """Value, first and second derivative at times t (s)."""
        places, values = self.knots.places(t), self.values
        # differences first: equal points stand exactly still
        near = values[places.window] - values[places.points][:, None]
        slopes = np.einsum("kpw,pw->kp", places.weights, near)
        rise = (values[places.left + 1] - values[places.left])[places.cell]
        result = []
        for order, by_power in enumerate(places.basis):
            total = by_power[0][1] * rise
            if order == 0:
                total = total + values[places.left][places.cell]
            for k, (at_first, at_last) in enumerate(by_power[1:]):
                total = total + at_first * slopes[k, places.first][places.cell]
                total = total + at_last * slopes[k, places.last][places.cell]
            result.append(total)
        return result[0], result[1], result[2]

    @property
    def highest(self) -> float:
        """A frequency (rad/s) whose derivatives grow as its own do at the most."""
        return 4 / self.knots.shortest

    @property
    def steepest(self) -> float:
        """About the largest first derivative, per s."""
        return 1.5 * float(np.abs(np.diff(self.values) / np.diff(self.knots.times)).max())

    @property
    def rough(self) -> float:
        """`highest`: a derivative leaps at every point."""
        return self.highest


class Tumble:
    """An attitude through given ones, a rotation as `Turn` is one.

    The four components of the quaternion are curves through those of the points; divided by their
    length they are the attitude.

    Args:
        knots: the instants.
        q: (N, 4) quaternions of length 1.

    Raises:
        InputError: from one point to the next it turns by more than 120°, so that the way between
            them is not known.
    """

    def __init__(self, knots: Knots, q: Array) -> None:
        cosines = np.einsum("ij,ij->i", q[1:], q[:-1])
        signs = np.concatenate(([1.0], np.cumprod(np.where(cosines < 0, -1.0, 1.0))))
        angles = 2 * np.arccos(np.clip(np.abs(cosines), 0, 1))
        if (angles > _FARTHEST).any():
            worst = int(np.argmax(angles))
            raise InputError(
                f"from {knots.times[worst]:.9g} s to {knots.times[worst + 1]:.9g} s the attitude"
                f" turns by {np.degrees(angles[worst]):.0f}°, give points between them, so that it"
                f" turns by {np.degrees(_FARTHEST):.0f}° at most"
            )
        self.knots = knots
        self._fastest = float((angles / np.diff(knots.times)).max())
        self._parts = [PointCurve(knots, signs * part) for part in q.T]

    def jet(self, t: Array) -> tuple[Quaternions, Vectors, Vectors]:
        """Quaternion, rate (rad/s) in the turned axes, and the rate's derivative (rad/s²).

        With p the quaternion before division, ω = 2 Im(p* ṗ)/|p|², and Im(ṗ* ṗ) = 0.
        """
        value, first, second = zip(*(part.jet(t) for part in self._parts), strict=True)
        square = sum(part * part for part in value)
        length = np.sqrt(square)
        w, x, y, z = (part / length for part in value)
        rate = tuple(2 * part / square for part in _imaginary(value, first))
        grows = sum(a * b for a, b in zip(value, first, strict=True)) / square
        change = tuple(
            2 * part / square - 2 * grows * speed
            for part, speed in zip(_imaginary(value, second), rate, strict=True)
        )
        return (w, x, y, z), (rate[0], rate[1], rate[2]), (change[0], change[1], change[2])

    @property
    def highest(self) -> float:
        """The highest frequency in it that matters, rad/s."""
        return 4 / self.knots.shortest

    @property
    def steepest(self) -> float:
        """About the largest rate of turning, rad/s."""
        return 1.5 * self._fastest

    @property
    def rough(self) -> float:
        """`highest`: a derivative leaps at every point."""
        return self.highest


_FARTHEST = np.radians(120.0)


def _imaginary(p: tuple[Array, ...], r: tuple[Array, ...]) -> Vectors:
    """Im(p* r)."""
    (a, b, c, d), (w, x, y, z) = p, r
    return (
        a * x - b * w - c * z + d * y,
        a * y - c * w - d * x + b * z,
        a * z - d * w - b * y + c * x,
    )


def derivative_weights(offsets: Array, highest: int) -> Array:
    """Weights of values at some offsets in the derivatives at 0 of the polynomial through them.

    Fornberg's recursion (Mathematics of Computation 51, 1988), for many places at a time.

    Args:
        offsets: (P, w), from the place; unlike in each row.
        highest: derivative.

    Returns:
        (highest, P, w): of the first, second, ... derivative.
    """
    places, width = offsets.shape
    weights = np.zeros((highest + 1, places, width))
    weights[0, :, 0] = 1
    before = np.ones(places)
    for n in range(1, width):
        apart = offsets[:, n, None] - offsets[:, :n]
        product = apart.prod(axis=1)
        lower = weights[:, :, n - 1].copy()
        for k in range(min(n, highest), -1, -1):
            down = k * weights[k - 1, :, :n] if k else 0.0
            old = k * lower[k - 1] if k else 0.0
            weights[k, :, n] = before / product * (old - offsets[:, n - 1] * lower[k])
            weights[k, :, :n] = (offsets[:, n, None] * weights[k, :, :n] - down) / apart
        before = product
    return weights[1:]


@lru_cache(maxsize=8)
def _hermite(m: int) -> tuple[Polynomial, ...]:
    """The polynomials on 0..1 whose k-th derivative at 0 is 1, all others up to m at both ends 0.

    u^k/k! (1-u)^(m+1) Σ_j C(m+j, j) u^j, j = 0 .. m - k.
    """
    u, rest = Polynomial([0, 1]), Polynomial([1, -1]) ** (m + 1)
    found = []
    for k in range(m + 1):
        series = Polynomial([factorial(m + j) / factorial(m) / factorial(j) for j in range(m + 1)])
        found.append(u**k / factorial(k) * rest * series.cutdeg(m - k))
    return tuple(found)


def _basis(u: Array, duration: Array, m: int) -> list[list[tuple[Array, Array]]]:
    """Weights of a cell's derivatives at both ends in value, first and second derivative."""
    result = []
    for order in range(3):
        by_power = []
        for k, polynomial in enumerate(_hermite(m)):
            shape = polynomial.deriv(order) if order else polynomial
            scale = duration ** (k - order)
            turned = (-1.0) ** (k + order)  # the end's are the beginning's, seen backwards
            by_power.append((scale * shape(u), turned * scale * shape(1 - u)))
        result.append(by_power)
    return result
