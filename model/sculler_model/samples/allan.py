"""Allan deviations: of what a sensor's samples have beyond the truth, and of what was asked for."""

from __future__ import annotations

from dataclasses import dataclass
from math import log, pi, radians, sqrt

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sculler_model.design import AxisErrors, Design
from sculler_model.errors import InputError
from sculler_model.frames import STANDARD_GRAVITY

Array = NDArray[np.float64]

FULL = 1 << 18
"""Samples that are kept one by one, for short averages."""

COARSE = 1 << 16
"""Points of the sum that are kept of a record of any length, at most, for long ones."""

STEPS = 8
"""Points of the thinned sum in an average, from which on it serves."""

A_DECADE = 8
"""Averaging times."""

CLUSTERS = 9
"""Averages of a length that the record must have, at least: the last one is known to some 30 %."""


def allan_deviation(rates: ArrayLike, interval: float, many: int) -> Array:
    """Overlapping Allan deviation of rates at `many` intervals (IEEE Std 952-1997, annex C).

    With θ the sum of the rates, σ² = mean of (θ[k+2m] - 2 θ[k+m] + θ[k])² / (2 τ²), τ = m T.

    Args:
        rates: (N,) or (N, C), means over consecutive intervals.
        interval: T, s.
        many: m, at most N/2.

    Returns:
        (C,), or a number's array, in the unit of the rates.

    Raises:
        InputError: there are too few rates.

    Examples:
        >>> import numpy as np
        >>> from sculler_model.samples import allan_deviation
        >>> ramp = allan_deviation(np.arange(100.0), 1.0, 10)  # τ/√2 times its slope
        >>> f"{float(ramp):.4f}"
        '7.0711'
    """
    rates = np.asarray(rates, np.float64)
    if not 1 <= many <= len(rates) // 2:
        raise InputError(
            f"Allan deviation: {many} intervals of {len(rates)} are not allowed, give 1 to"
            f" {len(rates) // 2}"
        )
    first = np.zeros((1, *rates.shape[1:]))
    return _deviation(np.concatenate((first, np.cumsum(rates, axis=0))) * interval, interval, many)


def _deviation(sums: Array, interval: float, many: int) -> Array:
    second = sums[2 * many :] - 2 * sums[many:-many] + sums[: -2 * many]
    found: Array = np.sqrt((second * second).mean(axis=0) / 2) / (many * interval)
    return found


@dataclass(frozen=True)
class AllanCurve:
    """Allan deviations over averaging times.

    Attributes:
        tau: (K,) s.
        deviation: (K, 6) rad/s of the gyros, m/s² of the accelerometers.
        clusters: (K,) averages of that length in the record; a deviation is known to about
            1/√(2 (clusters - 1)) of itself.
    """

    tau: Array
    deviation: Array
    clusters: Array


class AllanRecord:
    """Gathers rates in bounded memory: the first `FULL` as they are, of all a thinned sum.

    Args:
        interval: T between samples, s.
    """

    def __init__(self, interval: float) -> None:
        self._interval = interval
        self._first: list[Array] = []
        self._kept = 0
        self._sums, self._step = np.zeros((1, 6)), 1  # at every step-th sample
        self._seen, self._last = 0, np.zeros(6)

    def add(self, rates: Array) -> None:
        """Take the next (N, 6) rates, means over their intervals."""
        if not len(rates):
            return
        some = rates[: max(FULL - self._kept, 0)]
        self._first.append(some.copy())
        self._kept += len(some)
        sums = self._last + np.cumsum(rates, axis=0)
        self._last = sums[-1].copy()
        skip = (self._step - 1 - self._seen) % self._step
        self._sums = np.concatenate((self._sums, sums[skip :: self._step]))
        self._seen += len(rates)
        while len(self._sums) > COARSE:
            self._sums, self._step = self._sums[::2], 2 * self._step

    def curve(self) -> AllanCurve:
        """The deviations, from one interval to a `CLUSTERS`-th of the record.

        Raises:
            InputError: the record is shorter than that.
        """
        longest = self._seen // CLUSTERS
        if longest < 1:
            raise InputError(
                f"Allan deviation: {self._seen} samples are too few, give at least {CLUSTERS}"
            )
        T = self._interval
        sums = np.cumsum(np.concatenate(self._first), axis=0)
        first = np.concatenate((np.zeros((1, 6)), sums))
        count = max(2, round(A_DECADE * np.log10(longest)) + 1)
        wanted = np.unique(np.rint(np.geomspace(1, longest, count)).astype(int))
        found: dict[int, tuple[Array, float]] = {}
        for many in wanted.tolist():
            if many < STEPS * self._step and many * CLUSTERS <= self._kept:
                found[many] = _deviation(first * T, T, many), self._kept / many
            else:
                steps = max(1, round(many / self._step))
                many = steps * self._step
                deviation = _deviation(self._sums * T, self._step * T, steps)
                found[many] = deviation, self._seen / many
        deviations, clusters = zip(*found.values(), strict=True)
        return AllanCurve(np.array(list(found)) * T, np.array(deviations), np.array(clusters))


def asked_deviation(design: Design, tau: Array) -> Array:
    """What [sensor.errors] and the counts of a design ask for at averaging times (s).

        N²/τ + (2 ln 2/π) B² + K² τ/3 + 3 Q²/τ²
        + 2σ²T_c/τ (1 - T_c/(2τ) (3 - 4 exp(-τ/T_c) + exp(-2τ/T_c)))

    with Q = LSB/√12 of the angle or velocity, whose remainder is carried (IEEE Std 952-1997,
    annex C; the last line is Gauss and Markov's).  What is constant has none.

    Returns:
        (K, 6) rad/s and m/s².
    """
    sensor, errors = design.sensor, design.sensor.errors
    over = 1.0 if sensor.kind == "increment" else design.sample_interval
    found = np.zeros((len(tau), 6))
    units = ((radians(1) / 3600, radians(1) / 60), (1e-3 * STANDARD_GRAVITY, 1 / 60))
    for k, (axes, (unit, walk)) in enumerate(zip((sensor.gyro, sensor.accel), units, strict=True)):
        variance = 3 * (axes.lsb * over) ** 2 / 12 / tau**2
        if errors is not None:
            variance = variance + _variance((errors.gyro, errors.accel)[k], unit, walk, tau)
        found[:, 3 * k : 3 * k + 3] = np.sqrt(variance)[:, None]
    return found


def _variance(errors: AxisErrors, unit: float, walk: float, tau: Array) -> Array:
    """Of the random ones of three like axes; `unit` and `walk` as for `Imperfect`."""
    white, flicker = walk * (errors.random_walk or 0.0), unit * (errors.flicker or 0.0)
    wander = unit * (errors.rate_random_walk or 0.0) / 60
    variance = white**2 / tau + 2 * log(2) / pi * flicker**2 + wander**2 * tau / 3
    if errors.markov and errors.markov_time_s:
        x = tau / errors.markov_time_s
        # where x is small the bracket loses its digits: there it is x²/3 - x³/4 + ...
        bracket = np.where(
            x < 1e-3, x**2 / 3 - x**3 / 4, 1 - (3 - 4 * np.exp(-x) + np.exp(-2 * x)) / (2 * x)
        )
        variance = variance + 2 * (unit * errors.markov) ** 2 / x * bracket
    return variance


def deviation_of(clusters: Array) -> Array:
    """How well a measured deviation is known, as a share of itself."""
    share: Array = 1 / np.sqrt(2 * np.maximum(clusters - 1, 1))
    return share


def worst_ratio(curve: AllanCurve, asked: Array) -> float:
    """The largest measured over asked, or asked over measured, less what chance explains.

    Of the root mean square of three like axes; 2 sigma of chance are allowed for.
    """
    worst = 1.0
    for part in (slice(0, 3), slice(3, 6)):
        made = np.sqrt((curve.deviation[:, part] ** 2).mean(axis=1))
        ratio = made / asked[:, part.start]
        apart = np.maximum(ratio, 1 / ratio) - 2 * deviation_of(curve.clusters) / sqrt(3)
        worst = max(worst, float(apart.max()))
    return worst
