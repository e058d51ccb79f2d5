"""Residual drift against frequency: pure coning and pure sculling.

Every quantity is computed minus true.  The closed form is Savage-20's error source 2, what the
coefficients leave of the second-order integral.  The integer path is measured twice over a record
of whole periods: *second order*, the same thing as the closed form, made of the core's integers;
and *complete*, the drift of the attitude (velocity) that the host arrives at, which contains
error source 1 too, the triple products that no algorithm of this kind forms.

A record is K periods in N samples, K and N without a common factor: the motion then ends where it
began, so the drift is exact and not blurred by a ripple, and no phase of quantisation comes twice.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from fractions import Fraction
from math import cos, gcd, isfinite, log2, pi, sin

import numpy as np
from numpy.typing import NDArray

from sculler_model.analysis import closed_form
from sculler_model.analysis.drift import filtered_residual
from sculler_model.analysis.integer_path import (
    rotation_vectors,
    running_attitude,
    through_core,
    with_fine_sensor,
)
from sculler_model.analysis.iteration import DEGREE, attitude_on
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.fast import VectorBlock
from sculler_model.frames import product, rotate
from sculler_model.host import major_increments, second_order_corrections
from sculler_model.motion import Coning, Sculling

Array = NDArray[np.float64]

RECORD_SAMPLES = 20_000
"""Samples of a record, at least."""

MOST_SAMPLES = 1_000_000
"""Of a record: it is held in memory whole, some 400 bytes a sample."""

RECORD_PERIODS = 7
"""Periods of a record, at least."""


@dataclass(frozen=True)
class Oscillation(ABC):
    """A pure vibration of one frequency, by its two amplitudes.

    `Cone` and `Scull` say what they are; drifts are rad/s and m/s² about and along z.
    """

    @abstractmethod
    def amplitudes(self, omega: Array) -> Array:
        """a·b of `closed_form` at Ω (rad/s)."""

    @abstractmethod
    def samples(self, design: Design, omega: float, count: int) -> Array:
        """(count, 6) samples from time 0, as the design's sensor gives them."""

    @abstractmethod
    def peaks(self, design: Design, omega: float) -> tuple[float, float]:
        """Bounds of gyro and accelerometer samples at Ω and below, for a fine sensor."""

    @abstractmethod
    def second_order(self, design: Design, block: VectorBlock) -> float:
        """Drift times the record's time that the vectors of whole periods give, to 2nd order."""

    @abstractmethod
    def complete(self, design: Design, block: VectorBlock, omega: float, start: float) -> float:
        """Drift times time of the host's attitude or velocity, minus truth, to all orders.

        Args:
            design: the design.
            block: vectors over whole periods.
            omega: Ω, rad/s.
            start: time at which the block begins, s.
        """


@dataclass(frozen=True)
class Cone(Oscillation):
    """Classical coning about z (`motion.Coning`); half_angle in rad."""

    half_angle: float

    def amplitudes(self, omega: Array) -> Array:
        """See `Oscillation`."""
        return np.full_like(omega, sin(self.half_angle) ** 2)

    def samples(self, design: Design, omega: float, count: int) -> Array:
        """See `Oscillation`."""
        motion, T = Coning(self.half_angle, omega), design.sample_interval
        response = design.sensor_response
        if design.sensor.kind == "increment":
            samples = motion.increments(count, T)
        else:
            samples = motion.rates(count, T, 1, filtered=response is None)
        if response is not None:  # both axes pass it alike, so its phase is only a later start
            samples[:, :2] *= abs(response.value(omega * T))
        return samples

    def peaks(self, design: Design, omega: float) -> tuple[float, float]:
        """See `Oscillation`."""
        T = design.sample_interval
        swing = 2 * sin(self.half_angle) * min(0.5 * omega * T, 1.0)
        spin = 2 * omega * T * sin(self.half_angle / 2) ** 2
        return (swing + spin) / (T if design.sensor.kind == "rate" else 1.0), 0.0

    def second_order(self, design: Design, block: VectorBlock) -> float:
        """See `Oscillation`."""
        return float(second_order_corrections(design, block)[0][2])

    def complete(self, design: Design, block: VectorBlock, omega: float, start: float) -> float:
        """See `Oscillation`."""
        increments = major_increments(design, block)
        w, i, j, k = Coning(self.half_angle, omega).attitude(np.array([start])).T
        x, y, z = rotation_vectors(running_attitude(increments.phi)[-1:]).T
        turned = rotate((w, i, j, k), (x, y, z))[2].item()  # about the cone's axis
        # the last LSB of the cone's constant rate waits in the quantiser: no drift, so taken off
        seconds = len(block) * design.major_interval
        constant = -2 * omega * sin(self.half_angle / 2) ** 2 * seconds
        return float(turned - (increments.alpha[:, 2].sum() - constant))


@dataclass(frozen=True)
class Scull(Oscillation):
    """Classical sculling (`motion.Sculling`): angle about x in rad, specific force along y."""

    angle: float
    force: float

    def amplitudes(self, omega: Array) -> Array:
        """See `Oscillation`."""
        return self.angle * self.force / omega

    def samples(self, design: Design, omega: float, count: int) -> Array:
        """See `Oscillation`."""
        motion, T = Sculling(self.angle, self.force, omega), design.sample_interval
        response = design.sensor_response
        gain = 1.0 if response is None else abs(response.value(omega * T))
        if design.sensor.kind == "increment":
            return gain * motion.increments(count, T)
        if response is None:
            gain = float(np.sinc(omega * T / (2 * pi)))
        phase = omega * T * (1 + np.arange(count))
        out = np.zeros((count, 6))
        out[:, 0] = gain * self.angle * omega * np.cos(phase)
        out[:, 4] = gain * self.force * np.sin(phase)
        return out

    def peaks(self, design: Design, omega: float) -> tuple[float, float]:
        """See `Oscillation`."""
        T = design.sample_interval
        peaks = 2 * self.angle * min(0.5 * omega * T, 1.0), self.force * T
        return (peaks[0] / T, peaks[1] / T) if design.sensor.kind == "rate" else peaks

    def second_order(self, design: Design, block: VectorBlock) -> float:
        """See `Oscillation`."""
        return float(second_order_corrections(design, block)[1][2])

    def complete(self, design: Design, block: VectorBlock, omega: float, start: float) -> float:
        """See `Oscillation`."""
        motion = Sculling(self.angle, self.force, omega)
        increments = major_increments(design, block)
        begin = 0.5 * self.angle * sin(omega * start)
        first = np.array([[cos(begin), sin(begin), 0.0, 0.0]])
        after = running_attitude(increments.phi)
        q = np.concatenate((first, np.stack(product(tuple(first.T), tuple(after[:-1].T)), 1)))
        w, i, j, k = q.T
        x, y, z = increments.dv_sf.T
        velocity = rotate((w, i, j, k), (x, y, z))[2].sum()
        seconds = len(block) * design.major_interval
        return float(velocity) - motion.mean_force * seconds


@dataclass(frozen=True)
class Point:
    """The integer path at one frequency, beside the closed form; drifts as `Study` has them.

    Attributes:
        hertz: frequency, adjusted to whole periods.
        periods, samples: K and N of the record.
        closed_form, second_order, complete: drifts, computed minus true.
    """

    hertz: float
    periods: int
    samples: int
    closed_form: float
    second_order: float
    complete: float


@dataclass(frozen=True)
class Law:
    """Residual per minor interval, ``constant·λ^order`` per a·b, as λ goes to 0.

    Attributes:
        constant, order: exact, computed minus true; None where the samples passed a stated filter.
        measured_constant, measured_order: the same, out of two runs of the integer path.
        phases: λ of those two runs.
    """

    constant: Fraction | None
    order: int | None
    measured_constant: float
    measured_order: float
    phases: tuple[float, float]


def drift(design: Design, vibration: Oscillation, hertz: Array) -> Array:
    """Closed-form residual drift (rad/s or m/s²) at frequencies in Hz, computed minus true."""
    omega = 2 * pi * np.asarray(hertz, np.float64)
    T, kind, response = design.sample_interval, design.sensor.kind, design.sensor_response
    if response is None:
        left = closed_form.residual(design.table, omega * T, kind)
    else:
        left = filtered_residual(design.table, omega * T, kind, response)
    result: Array = left * vibration.amplitudes(omega) / (design.table.samples * T)
    return result


def uncorrected(vibration: Oscillation, hertz: Array) -> Array:
    """Drift of an integrator that makes no correction, less its ripple: -½ a b Ω."""
    omega = 2 * pi * np.asarray(hertz, np.float64)
    return -0.5 * omega * vibration.amplitudes(omega)


def record(design: Design, hertz: float, least_samples: int = RECORD_SAMPLES) -> tuple[int, int]:
    """K and N: the whole periods in whole major intervals that come nearest to a frequency.

    Args:
        design: gives the rate and the intervals.
        hertz: the wanted frequency.
        least_samples: samples of the record, at least; and at least `RECORD_PERIODS` periods.

    Raises:
        InputError: the frequency is not between 0 and the Nyquist limit, or so low that a record
            is longer than `MOST_SAMPLES`.
    """
    rate, span = design.sensor.sample_rate_hz, design.samples_per_major
    if not 0 < hertz < rate / 2:
        raise InputError(
            f"frequency: {hertz:g} Hz is not between 0 and the Nyquist limit of {rate / 2:g} Hz of"
            f" {design.name}, give one that is"
        )
    least = max(least_samples, RECORD_PERIODS * rate / hertz)
    if least > MOST_SAMPLES:
        raise InputError(
            f"frequency: {hertz:g} Hz is too low for {rate:g} samples/s of {design.name}:"
            f" {RECORD_PERIODS} periods are more than {MOST_SAMPLES:,} samples, give at least"
            f" {1.001 * RECORD_PERIODS * rate / MOST_SAMPLES:.4g} Hz"
        )
    samples = -(-int(least) // span) * span
    periods = round(hertz * samples / rate)
    while gcd(periods, samples) > 1:
        periods += 1
    return periods, samples


def integer_point(design: Design, vibration: Oscillation, hertz: float) -> Point:
    """Run the integer path at (nearly) a frequency, on the design's own sensor.

    Raises:
        InputError: the frequency is out of range, or the motion does not fit the sensor.
    """
    periods, samples = record(design, hertz)
    rate, span = design.sensor.sample_rate_hz, design.samples_per_major
    exact_hertz = periods * rate / samples
    omega, seconds = 2 * pi * exact_hertz, samples / rate
    # enough major intervals before the record that no tap reaches before the first sample
    before = -(-design.table.history // span)
    counts = vibration.samples(design, omega, samples + before * span)
    block = through_core(design, counts)
    block = VectorBlock(block.major[before:], block.status[before:], block.components[before:])
    truth = 0.5 * omega * float(vibration.amplitudes(np.array([omega]))[0])
    start = before * design.major_interval
    return Point(
        exact_hertz,
        periods,
        samples,
        float(drift(design, vibration, np.array([exact_hertz]))[0]),
        vibration.second_order(design, block) / seconds - truth,
        vibration.complete(design, block, omega, start) / seconds,
    )


def iteration_drift(
    design: Design, cone: Cone, hertz: float, degree: int = DEGREE
) -> tuple[float, float]:
    """What the samples allow (`iteration`) at (nearly) a frequency, over the same record.

    Args:
        design: gives the samples and the record.
        cone: the motion.
        hertz: frequency of the cone.
        degree: of the polynomial through the samples.

    Returns:
        The frequency of whole periods, Hz, and the drift about the cone's axis, rad/s, computed
        minus true.

    Raises:
        InputError: the frequency is out of range.
    """
    periods, samples = record(design, hertz)
    rate = design.sensor.sample_rate_hz
    omega, edge = 2 * pi * periods * rate / samples, degree + 1
    taken = cone.samples(design, omega, samples + 2 * edge)
    last = attitude_on(design, taken, degree=degree, edge=edge)[-1:]
    w, i, j, k = Coning(cone.half_angle, omega).attitude(np.array([edge / rate])).T
    x, y, z = rotation_vectors(last).T
    turned = rotate((w, i, j, k), (x, y, z))[2].item()  # about the cone's axis
    return omega / (2 * pi), turned / (samples / rate)


def fine(design: Design, vibration: Oscillation, highest_hertz: float) -> Design:
    """The design on a sensor so fine that its LSB does not show."""
    return with_fine_sensor(design, *vibration.peaks(design, 2 * pi * highest_hertz))


SHARE = 1e-7
"""The residual's share of the uncorrected drift at which its law is measured."""

PHASES = np.geomspace(1e-3, 0.5, 200)
"""Where λ of the lower run is looked for: both runs stay well below Nyquist."""


def law(design: Design, vibration: Oscillation) -> Law:
    """The first term of the residual, exact and measured through the integer path.

    The two runs are at λ and 2λ with the first λ where the residual passes `SHARE` of the
    uncorrected drift: low enough for its first term to rule, high enough to stand out of 32 bits.
    """
    n, T = design.table.samples, design.sample_interval
    hertz = PHASES / (2 * pi * T)
    share = np.abs(drift(design, vibration, hertz) / uncorrected(vibration, hertz))
    low = float(PHASES[np.argmax(share > SHARE)]) if np.any(share > SHARE) else float(PHASES[-1])
    found = []
    for phase in (low, 2 * low):
        at = phase / (2 * pi * T)
        point = integer_point(fine(design, vibration, at), vibration, at)
        omega = 2 * pi * point.hertz
        scale = float(vibration.amplitudes(np.array([omega]))[0]) / (n * T)
        found.append((omega * T, point.second_order / scale))
    (phase, small), (phase2, large) = found
    order = log2(large / small) / log2(phase2 / phase) if large / small > 0 else float("nan")
    exact = None
    if design.sensor_response is None:
        exact = closed_form.leading_term(design.table, design.sensor.kind)
    # one step of Richardson: the second term is λ² of the first
    power = exact.power if exact else (round(order) if isfinite(order) else 0)
    c1, c2 = small / phase**power, large / phase2**power
    constant = c1 + (c1 - c2) / ((phase2 / phase) ** 2 - 1)
    return Law(
        exact.coefficient if exact else None,
        exact.power if exact else None,
        constant,
        order,
        (phase, phase2),
    )


def fits(design: Design, vibration: Oscillation, hertz: float) -> bool:
    """Whether the motion's samples are sure to fit the words of the design's sensor."""
    gyro, accel = vibration.peaks(design, 2 * pi * hertz)
    words, sensor = design.words, design.sensor
    return gyro / sensor.gyro.lsb + 1 <= words.gyro.hi and accel / sensor.accel.lsb + 1 <= (
        words.accel.hi
    )
