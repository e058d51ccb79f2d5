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

from dataclasses import dataclass
from fractions import Fraction
from math import gcd, isfinite, log2, pi

import numpy as np
from numpy.typing import NDArray

from sculler_model.analysis import closed_form
from sculler_model.analysis.drift import filtered_residual
from sculler_model.analysis.integer_path import through_core, with_fine_sensor
from sculler_model.analysis.iteration import DEGREE
from sculler_model.analysis.oscillation import Oscillation
from sculler_model.analysis.sensed import known_hz, require_known
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.fast import VectorBlock

Array = NDArray[np.float64]

RECORD_SAMPLES = 20_000
"""Samples of a record, at least."""

MOST_SAMPLES = 1_000_000
"""Of a record: it is held in memory whole, some 400 bytes a sample."""

RECORD_PERIODS = 7
"""Periods of a record, at least."""


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
        InputError: the frequency is not between 0 and the Nyquist limit, or above the end of a
            measured response of the sensor's, or so low that a record is longer than
            `MOST_SAMPLES`.
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
    require_known(design, periods * rate / samples, design.name)
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
    design: Design, vibration: Oscillation, hertz: float, degree: int = DEGREE
) -> tuple[float, float]:
    """What the samples allow (`iteration`) at (nearly) a frequency, over the same record.

    Args:
        design: gives the samples and the record.
        vibration: the motion.
        hertz: its frequency.
        degree: of the polynomial through the samples.

    Returns:
        The frequency of whole periods, Hz, and the drift, rad/s or m/s², computed minus true.

    Raises:
        InputError: the frequency is out of range.
    """
    periods, samples = record(design, hertz)
    rate = design.sensor.sample_rate_hz
    omega, edge = 2 * pi * periods * rate / samples, degree + 1
    taken = vibration.samples(design, omega, samples + 2 * edge)
    drifted = vibration.iterated(design, taken, omega, degree, edge)
    return omega / (2 * pi), drifted / (samples / rate)


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
    # both λ and 2λ must be known
    phases = PHASES[: max(np.searchsorted(PHASES, 0.99 * pi * T * known_hz(design)), 1)]
    hertz = phases / (2 * pi * T)
    share = np.abs(drift(design, vibration, hertz) / uncorrected(vibration, hertz))
    low = float(phases[np.argmax(share > SHARE)]) if np.any(share > SHARE) else float(phases[-1])
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
