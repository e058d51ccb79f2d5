"""Manoeuvres: the attitude error over polynomial rate profiles, split into Savage-20's two sources.

Error source 1 is what the second-order rotation vector leaves out, with its integrals exact
(Savage-20 Eq. 2 against Eq. 3); source 2 is what the coefficients add to that (Eq. 5 against
Eq. 4).  Truth is the same second-order step, taken so finely that source 1, which falls with the
fourth power of the step, is below rounding.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import ceil, floor, radians, sqrt

import numpy as np
from numpy.polynomial import Polynomial
from numpy.polynomial.polynomial import polyval
from numpy.typing import NDArray

from sculler_model.analysis.integer_path import (
    changed,
    rotation_vectors,
    running_attitude,
    through_core,
    unquantised,
    with_fine_sensor,
)
from sculler_model.analysis.iteration import DEGREE, attitude_on
from sculler_model.analysis.sensed import Felt, delay, passed, reach
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.frames import conjugate, product
from sculler_model.host import MajorIncrements, ThirdOrder, major_increments

Array = NDArray[np.float64]

FINE_STEPS = 1 << 14
"""Steps of the truth over a manoeuvre, at least."""


@dataclass(frozen=True)
class Manoeuvre:
    """A rate profile: polynomials of u = t/duration on 0..1, at rest before and after.

    Attributes:
        name: what it is.
        duration: s.
        rates: ω about x, y, z, rad/s, as polynomials of u.
    """

    name: str
    duration: float
    rates: tuple[Polynomial, Polynomial, Polynomial]

    def rate(self, t: Array) -> Array:
        """ω (N, 3), rad/s, at times t (N,), s."""
        u = t / self.duration
        inside = ((u >= 0) & (u <= 1))[:, None]
        return np.where(inside, np.asarray(polyval(u, self._powers[0]), np.float64).T, 0.0)

    def angle(self, t: Array) -> Array:
        """Integral of ω from 0 to t, (N, 3), rad."""
        u = np.clip(t / self.duration, 0.0, 1.0)
        return self.duration * np.asarray(polyval(u, self._powers[1]), np.float64).T

    @cached_property
    def _powers(self) -> tuple[Array, Array]:
        """Coefficients of ω and of its integral, a column an axis."""

        def columns(polynomials: list[Polynomial]) -> Array:
            longest = max(len(p.coef) for p in polynomials)
            return np.stack([np.pad(p.coef, (0, longest - len(p.coef))) for p in polynomials], 1)

        return columns([*self.rates]), columns([p.integ() for p in self.rates])

    def samples(self, design: Design, count: int) -> Array:
        """(count, 6) samples over intervals from `start` on as the sensor gives them; no force.

        Where no filter is stated, rate samples passed sinc(ΩT/2), as `Motion.rates`.  The first
        one is at T, so that the first interval, which shares the sample before, begins there.

        Raises:
            InputError: the sensor's filter remembers for too long.
        """
        T, rate = design.sample_interval, design.sensor.kind == "rate"
        if design.sensor_response is not None:
            return passed(design, self.felt, int(rate) - reach(design, self.felt)[0], count)
        if not rate:
            return self.felt.increments(count, T)
        number = np.arange(count + 1, dtype=np.float64)
        out = np.zeros((count, 6))
        out[:, :3] = np.diff(self.angle((number + 0.5) * T), axis=0) / T
        return out

    def start(self, design: Design) -> float:
        """Where the samples begin, s: 0, or before that where the sensor's filter looks ahead.

        Raises:
            InputError: the sensor's filter remembers for too long.
        """
        return -reach(design, self.felt)[0] * design.sample_interval

    @cached_property
    def felt(self) -> Felt:
        """What perfect sensors feel: no force."""

        def of(rates: Array) -> Array:
            return np.hstack((rates, np.zeros_like(rates)))

        return Felt(lambda t: of(self.rate(t)), 0.0, lambda t: of(self.angle(t)))

    @property
    def peak(self) -> float:
        """Largest rate about any axis, rad/s."""
        return radians(max(self.peak_degrees()))

    def peak_degrees(self) -> list[float]:
        """Largest rates about x, y, z, °/s."""
        rates = self.rate(np.linspace(0.0, self.duration, 2001))
        largest: list[float] = np.degrees(np.abs(rates).max(axis=0)).tolist()
        return largest

    def profile(self, points: int) -> dict[str, list[float]]:
        """The rates to draw: seconds, and °/s about each axis."""
        t = np.linspace(0.0, self.duration, points)
        columns = [t, *np.degrees(self.rate(t)).T]
        return {
            name: column.tolist()
            for name, column in zip(("seconds", "x", "y", "z"), columns, strict=True)
        }


_U = Polynomial([0.0, 1.0])
BUMP = 16 * _U**2 * (1 - _U) ** 2
"""Rises and falls once: 1 in the middle."""
EARLY = 729 / 16 * _U**2 * (1 - _U) ** 4
"""As `BUMP`, 1 at a third."""
LATE = 729 / 16 * _U**4 * (1 - _U) ** 2
"""As `BUMP`, 1 at two thirds."""
DOUBLET = 25 * sqrt(5.0) * _U**2 * (1 - _U) ** 2 * (1 - 2 * _U)
"""There and back again: largest value 1."""


def _manoeuvre(name: str, duration: float, *parts: tuple[float, Polynomial]) -> Manoeuvre:
    x, y, z = (radians(peak) * shape for peak, shape in parts)
    return Manoeuvre(name, duration, (x, y, z))


MANOEUVRES = {
    m.name: m
    for m in (
        # a fighter's aileron roll and back, with a pull early and a yaw late in it
        _manoeuvre("extreme", 2.0, (300.0, DOUBLET), (100.0, EARLY), (60.0, LATE)),
        # a roll into a turn with the nose coming up
        _manoeuvre("turn-entry", 4.0, (40.0, BUMP), (8.0, LATE), (6.0, LATE)),
        # a missile pitching over while it rolls up and stops
        _manoeuvre("pitch-over", 3.0, (400.0, BUMP), (50.0, EARLY), (50.0, DOUBLET)),
    )
}
"""By name; peak rates in °/s."""


def second_order_steps(manoeuvre: Manoeuvre, times: Array, nodes: int = 12) -> Array:
    """Exact α + ½ ∫ α × ω over consecutive steps (Savage-20 Eq. 2).

    Args:
        manoeuvre: the rates.
        times: (R + 1,) ends of the steps, s.
        nodes: of Gauss and Legendre's rule; so many are exact to degree 2 nodes - 1.

    Returns:
        (R, 3) rad.
    """
    node, weight = np.polynomial.legendre.leggauss(nodes)
    start, step = times[:-1], np.diff(times)
    begin = manoeuvre.angle(start)
    phi = manoeuvre.angle(times[1:]) - begin
    coning = np.zeros_like(phi)
    for x, w in zip(0.5 * (node + 1), 0.5 * weight, strict=True):
        t = start + x * step
        coning += (w * step)[:, None] * np.cross(manoeuvre.angle(t) - begin, manoeuvre.rate(t))
    return phi + 0.5 * coning


def true_attitude(manoeuvre: Manoeuvre, times: Array) -> Array:
    """(R, 4) quaternions at times[1:] (equal steps), body to the frame at times[0]."""
    fine = -(-FINE_STEPS // (len(times) - 1))
    steps = np.linspace(times[0], times[-1], fine * (len(times) - 1) + 1)
    short = second_order_steps(manoeuvre, steps, nodes=4)  # over these the motion is nearly linear
    return running_attitude(short)[fine - 1 :: fine]


@dataclass(frozen=True)
class Split:
    """Attitude errors over a manoeuvre at one update rate, µrad.

    The magnitude at the end of the manoeuvre, and the largest on the way.

    Attributes:
        minors: M.
        update_hz: major intervals a second.
        source_1, source_2: of the exact second-order step, and of the coefficients beyond it, with
            what the sensor's filter leaves.
        complete: both, the algorithm on exact samples.
        third_order: the same with the host's third-order correction.
        integer_path: both, through counts and core.
        iteration: iterated to convergence on the same exact samples (`iteration`).
        largest: of `complete`, the largest on the way; the truth is taken as much earlier as the
            sensor's filter delays.
    """

    minors: int
    update_hz: float
    source_1: float
    source_2: float
    complete: float
    third_order: float
    integer_path: float
    iteration: float
    largest: float


def update_minors(design: Design, low: float, high: float, most: int = 10) -> list[int]:
    """Values of M whose update rate lies in low..high Hz, the slowest first, evenly on a log scale.

    Args:
        design: gives the sample rate and n.
        low, high: Hz.
        most: how many at most.

    Raises:
        InputError: there is none.
    """
    minor_hz = design.sensor.sample_rate_hz / design.table.samples
    largest, smallest = (
        min(floor(minor_hz / low + 1e-9), 4096),
        max(ceil(minor_hz / high - 1e-9), 1),
    )
    if largest < smallest:
        raise InputError(
            f"update rate: {design.name} has {minor_hz:g} minor intervals a second, of which no"
            f" whole number gives {low:g} to {high:g} Hz, give other limits"
        )
    spread = np.geomspace(largest, smallest, most).round().astype(int).tolist()
    return sorted(set(spread), reverse=True)


def split(
    design: Design, manoeuvre: Manoeuvre, minors: int, own_sensor: bool, degree: int = DEGREE
) -> Split:
    """Errors of a design with M minor intervals a major one.

    Args:
        design: the design.
        manoeuvre: the rates.
        minors: M.
        own_sensor: count with the design's own LSB.
        degree: of the polynomial that `iteration` puts through the samples.

    Raises:
        InputError: the rates do not fit the design's own sensor, or its filter remembers for too
            long.
    """
    design = changed(design, algorithm={"minors": minors})
    if not own_sensor:
        scale = design.sample_interval if design.sensor.kind == "increment" else 1.0
        design = with_fine_sensor(design, manoeuvre.peak * scale)
    T = design.major_interval
    start, after = manoeuvre.start(design), reach(design, manoeuvre.felt)[1]
    majors = ceil((manoeuvre.duration - start + after) / T - 1e-9) + 3
    samples = manoeuvre.samples(design, majors * design.samples_per_major)
    times = start + T * np.arange(majors + 1, dtype=np.float64)
    truth = true_attitude(manoeuvre, times - delay(design))
    exact = running_attitude(second_order_steps(manoeuvre, times))
    phi, alpha = unquantised(design, samples)
    counted = major_increments(design, through_core(design, samples))
    algorithm = running_attitude(phi)
    corrected = ThirdOrder()(MajorIncrements(phi, alpha, np.zeros_like(phi))).phi
    complete = errors(algorithm, truth)
    return Split(
        minors,
        1 / T,
        float(errors(exact, truth)[-1]),
        float(errors(algorithm, exact)[-1]),
        float(complete[-1]),
        float(errors(running_attitude(corrected), truth)[-1]),
        float(errors(running_attitude(counted.phi), truth)[-1]),
        float(errors(attitude_on(design, samples, degree=degree), truth)[-1]),
        float(complete.max()),
    )


def errors(found: Array, true: Array) -> Array:
    """(R,) µrad between quaternions (R, 4)."""
    difference = np.stack(product(conjugate(tuple(true.T)), tuple(found.T)), axis=1)
    size: Array = 1e6 * np.sqrt(np.sum(rotation_vectors(difference) ** 2, axis=1))
    return size
