"""Analytic functions of time that motions are made of, each with its first two derivatives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import factorial, pi
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from sculler_model.frames import ECCENTRICITY_SQUARED, SEMI_MAJOR_AXIS, Vector

Array = NDArray[np.float64]
Jet = tuple[Array, Array, Array]
"""A function's value and its first and second time derivative."""


class Smooth(Protocol):
    """A smooth function of time."""

    def jet(self, t: Array) -> Jet:
        """Value, first and second derivative at times t (s)."""

    @property
    def highest(self) -> float:
        """The highest frequency in it that matters, rad/s."""

    @property
    def steepest(self) -> float:
        """A bound on its first derivative: as an angle, the rate of turning, rad/s."""

    @property
    def rough(self) -> float:
        """Its highest frequency (rad/s) if it has knots; 0 if it is analytic."""


@dataclass(frozen=True)
class Curve:
    """An analytic function of time: Σ c_k t^k + Σ A sin(Ω t + φ).

    Attributes:
        powers: c_0, c_1, ...
        waves: (amplitude, Ω in rad/s, phase in rad) of each wave.
    """

    powers: tuple[float, ...] = ()
    waves: tuple[tuple[float, float, float], ...] = ()

    def __call__(self, t: Array, order: int = 0) -> Array:
        """The order-th time derivative at times t (s)."""
        value = self._polynomial(t, order)
        for amplitude, omega, phase in self.waves:
            value += amplitude * omega**order * np.sin(omega * t + (phase + order * pi / 2))
        return value

    def jet(self, t: Array) -> Jet:
        """Value, first and second derivative at times t (s)."""
        value, first, second = (self._polynomial(t, order) for order in range(3))
        for amplitude, omega, phase in self.waves:
            angle = omega * t + phase
            wave = amplitude * np.sin(angle)
            value += wave
            first += (amplitude * omega) * np.cos(angle)
            second -= omega * omega * wave
        return value, first, second

    def __add__(self, other: Curve) -> Curve:
        width = max(len(self.powers), len(other.powers))
        powers = [0.0] * width
        for curve in (self, other):
            for k, c in enumerate(curve.powers):
                powers[k] += c
        return Curve(tuple(powers), self.waves + other.waves)

    def _polynomial(self, t: Array, order: int) -> Array:
        value = np.zeros_like(t)
        for k in range(len(self.powers) - 1, order - 1, -1):
            value = value * t + self.powers[k] * (factorial(k) // factorial(k - order))
        return value

    @property
    def highest(self) -> float:
        """The highest frequency in it, rad/s."""
        return max((abs(omega) for _, omega, _ in self.waves), default=0.0)

    @property
    def steepest(self) -> float:
        """A bound on the first derivative in the first second, per s."""
        powers = sum(k * abs(c) for k, c in enumerate(self.powers))
        return powers + sum(abs(amplitude * omega) for amplitude, omega, _ in self.waves)

    @property
    def rough(self) -> float:
        """0: it has no knots."""
        return 0.0


ZERO_CURVE = Curve()

SPLINE_DEGREE = 7
"""Of a `Spline`: six continuous derivatives."""


class Spline:
    """A uniform B-spline of degree 7: it follows its control points smoothly.

    f(t) = Σ P_i B(t/step - i), B the centred cardinal B-spline.  It reproduces straight lines, and
    where eight neighbouring points agree it stands exactly still.  Before the first point and after
    the last one the outermost two points go on in a straight line.

    Args:
        points: P_0, P_1, ...; at least two.
        step: s, between them.
    """

    def __init__(self, points: Sequence[float], step: float) -> None:
        self.points, self.step = tuple(points), step
        # straight on beyond both ends, far enough for every derivative there
        around = np.arange(1, SPLINE_DEGREE + 1)
        known = np.array(self.points)
        before = known[0] - around[::-1] * (known[1] - known[0])
        after = known[-1] + around * (known[-1] - known[-2])
        padded = np.concatenate((before, known, after))
        # differences first: a derivative is then as exact as its own size allows
        self._differences = [np.diff(padded, order) / step**order for order in range(3)]
        self._points = [self._around(order) for order in range(3)]

    def _around(self, order: int) -> tuple[Array, Array]:
        """By cell, the middle one of its points, and what each point (k, cell) has more."""
        values, width = self._differences[order], SPLINE_DEGREE - order + 1
        cells = len(values) - width + 1
        points = np.stack([values[k : k + cells] for k in range(width)])
        middle = points[(width - 1) // 2]
        return middle, points - middle

    def jet(self, t: Array) -> Jet:
        """Value, first and second derivative at times t (s)."""
        cell, beyond, weights = _places(t, self.step, len(self.points))
        sums = []
        for order, (middle, more) in enumerate(self._points):
            # equal points give just themselves
            near = (w * row[cell] for w, row in zip(weights[order], more, strict=True))
            sums.append(middle[cell] + sum(near))
        value, first, second = sums
        return np.asarray(value + beyond * first), np.asarray(first), np.asarray(second)

    @property
    def highest(self) -> float:
        """A frequency (rad/s) whose derivatives grow as its own do at the most."""
        return 4 / self.step

    @property
    def steepest(self) -> float:
        """A bound on the first derivative, per s."""
        return float(np.abs(self._differences[1]).max())

    @property
    def rough(self) -> float:
        """`highest`: its seventh derivative leaps at every knot."""
        return self.highest


class _Places(NamedTuple):
    """Where instants are among the control points of a `Spline`.

    Attributes:
        cell: by instant, the leftmost point of eight, padded.
        beyond: s past the ends' cells.
        weights: of the points in the value, the first and the second derivative.
    """

    cell: NDArray[np.intp]
    beyond: Array
    weights: list[list[Array]]


_latest: list[tuple[Array, float, int, _Places]] = []
"""The places of the last instants: a motion asks all of its splines about the same ones."""


def _places(t: Array, step: float, points: int) -> _Places:
    for instants, same_step, same_points, places in _latest:
        if (same_step, same_points) == (step, points) and np.array_equal(instants, t):
            return places
    x = t / step
    inside = np.clip(np.floor(x), -4, points + 2)  # straight lines beyond
    cell = inside.astype(np.intp) + (SPLINE_DEGREE - 3)
    u = np.clip(x - inside, 0, 1)
    weights, kept = [np.ones_like(u)], []
    for degree in range(1, SPLINE_DEGREE + 1):
        weights = _next_weights(weights, degree, u)
        if degree > SPLINE_DEGREE - 3:
            kept.append(weights)
    places = _Places(cell, t - step * (inside + u), kept[::-1])
    _latest[:] = [(t.copy(), step, points, places)]
    return places


def _next_weights(weights: list[Array], degree: int, u: Array) -> list[Array]:
    """B-spline weights of a degree at the place u (0..1) of a cell, from those one degree lower.

    Weight k belongs to the k-th control point from the left; all are positive and sum to 1.
    """
    rising = [(u + (degree - 1 - k)) * weight / degree for k, weight in enumerate(weights)]
    falling = [weight - part for weight, part in zip(weights, rising, strict=True)]
    between = [a + b for a, b in zip(rising, falling[1:], strict=False)]
    return [falling[0], *between, rising[-1]]


@dataclass(frozen=True)
class EvenPace:
    """Longitude on a great circle of normals, at constant speed over the WGS-84 Earth.

    The circle is the equator of a grid (see `Motion.grid`): the Earth's normal turns by σ about the
    grid's axis, and the point under way makes ds = w(σ) dσ.  w has period π and is so smooth that
    its Fourier series ends, to rounding, after a dozen terms: s(σ) is closed-form, and Newton's
    method turns it round.

    Attributes:
        axis: the Earth's axis in grid components.
        h: height, m.
        speed: m/s.
        gone: metres at time 0, from the grid's origin.
    """

    axis: Vector
    h: float
    speed: float
    gone: float = 0.0

    def jet(self, t: Array) -> Jet:
        """Longitude in metres of the grid's equator (σ times a + h), with two derivatives."""
        mean, terms = self._series
        s = self.gone + self.speed * t
        sigma = s / mean
        for _ in range(4):  # each squares an error that begins below e² = 0.007
            total, w, _ = self._length(sigma, mean, terms)
            sigma = sigma - (total - s) / w
        _, w, slope = self._length(sigma, mean, terms)
        rate = self.speed / w
        radius = SEMI_MAJOR_AXIS + self.h
        return radius * sigma, radius * rate, -radius * rate * rate * slope / w

    @property
    def highest(self) -> float:
        """The highest frequency in it, rad/s: once round the Earth."""
        return 4 * abs(self.speed) / SEMI_MAJOR_AXIS

    @property
    def steepest(self) -> float:
        """A bound on the first derivative, m/s."""
        return 1.01 * abs(self.speed)

    @property
    def rough(self) -> float:
        """0: it has no knots."""
        return 0.0

    @staticmethod
    def _length(sigma: Array, mean: float, terms: list[tuple[int, complex]]) -> Jet:
        """s(σ), ds/dσ = w and dw/dσ."""
        total, w, slope = mean * sigma, mean + 0 * sigma, 0 * sigma
        step = np.exp(2j * sigma)
        turn = np.ones_like(step)
        for k, c in terms:  # 2, 4, 6, ...
            turn = turn * step
            total = total + 2 * np.real(c / (1j * k) * (turn - 1))
            w = w + 2 * np.real(c * turn)
            slope = slope + 2 * np.real(1j * k * c * turn)
        return total, w, slope

    @cached_property
    def _series(self) -> tuple[float, list[tuple[int, complex]]]:
        """Mean of w, and its harmonics (number, coefficient)."""
        count = 64
        sigma = np.pi * np.arange(count) / count
        x, y, z = self.axis
        sin_lat = x * np.cos(sigma) + y * np.sin(sigma)
        along = y * np.cos(sigma) - x * np.sin(sigma)  # the axis along the path; z is across it
        squash = 1 - ECCENTRICITY_SQUARED * sin_lat**2
        prime_vertical = SEMI_MAJOR_AXIS / np.sqrt(squash)
        change = ECCENTRICITY_SQUARED * prime_vertical * along / squash
        w = np.hypot(prime_vertical + self.h - change * along, change * z)
        c = np.fft.rfft(w) / count
        return float(c[0].real), [(2 * k, complex(c[k])) for k in range(1, 13)]
