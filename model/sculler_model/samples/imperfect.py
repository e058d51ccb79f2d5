"""What a real sensor delivers in place of a perfect one: bias, noise, scale, misalignment, range.

With x the perfect rate or specific force of a sample (its mean over the sample interval T), an axis
delivers

    y = x + s x + a |x| + q x² + Σ m x_other + G f + b(t),  kept within ±range            (E1)

where b(t) is the constant bias plus

    white noise            N/√T · w                                                          (E2)
    Gauss-Markov           x' = φ x + σ √(1 - φ²) w,   φ = exp(-T/τ)                         (E3)
    flicker (1/f)          (E3) with τ = T/2, 2T, 8T, ... to 3 days, σ² = B² ln 4 / π         (E4)
    random walk of rate    x' = x + K √T w                                                   (E5)

w being independent standard normal numbers.  N, B and K are those of IEEE Std 952: Allan variances
N²/τ, (2 ln 2/π) B² and K² τ/3.  (E4): the two-sided density of one part is 2σ²τ/(1 + (2πfτ)²);
of parts whose times go up by a factor r it is σ²/(2 ln r f) to 1 %, and must be B²/(2πf).  It holds
from averages over ten samples on.
"""

from __future__ import annotations

from math import exp, expm1, log, log2, pi, radians, sqrt

import numpy as np
from numpy.typing import NDArray

from sculler_model.design import AxisErrors, Design, Drawn, SensorErrors
from sculler_model.frames import STANDARD_GRAVITY

Array = NDArray[np.float64]

_RATIO = 4.0
_LONGEST = 3 * 86400.0  # s
_HOUR = 3600.0


class _Axes:
    """Errors of three like axes, in SI units.

    Args:
        errors: in the units of data sheets.
        unit: SI units of one °/h or mg.
        walk: SI units of one °/√h or m/s/√h.
        full: SI units of one °/s or g, of ranges and squares.
        interval: T, s.
        seed: of the random numbers; those of every kind of error are their own.
    """

    def __init__(
        self,
        errors: AxisErrors,
        unit: float,
        walk: float,
        full: float,
        interval: float,
        seed: list[int],
    ) -> None:
        self._seed, self._interval = seed, interval
        self._bias = unit * self._drawn(errors.bias, 0, 3)
        self._linear = np.eye(3) + np.diag(1e-6 * self._drawn(errors.scale_factor, 1, 3))
        off = ~np.eye(3, dtype=bool)
        self._linear[off] += 1e-3 * self._drawn(errors.misalignment, 2, 6)
        self._asymmetry = 1e-6 * self._drawn(errors.asymmetry, 3, 3)
        self._square = 1e-6 / full * self._drawn(errors.square, 4, 3)
        self.g_sensitivity = unit / STANDARD_GRAVITY * self._drawn(errors.g_sensitivity, 5, 3)
        self._range = None if errors.range is None else full * errors.range
        self.beyond = 0
        self._white = walk * (errors.random_walk or 0.0) / sqrt(interval)
        self._noise = self._generator(6)
        self._wandering = []
        if errors.markov and errors.markov_time_s:
            part = _Markov(unit * errors.markov, errors.markov_time_s, interval, self._generator(7))
            self._wandering.append(part)
        if errors.flicker:
            size = unit * errors.flicker * sqrt(log(_RATIO) / pi)
            tau, number = interval / 2, 8
            while tau < _RATIO * _LONGEST:
                part = _Markov(size, tau, interval, self._generator(number), 64.0)
                self._wandering.append(part)
                tau, number = _RATIO * tau, number + 1
        self._step = unit * (errors.rate_random_walk or 0.0) * sqrt(interval / _HOUR)
        self._walker, self._walked = self._generator(100), np.zeros(3)

    def _generator(self, kind: int) -> np.random.Generator:
        return np.random.default_rng([*self._seed, kind])

    def _drawn(self, value: Drawn | list[float] | None, kind: int, many: int) -> Array:
        """Values as given, or drawn."""
        if value is None:
            return np.zeros(many)
        if isinstance(value, Drawn):
            return value.sigma * self._generator(kind).standard_normal(many)
        return np.array(value)

    def __call__(self, perfect: Array, more: Array | float = 0.0) -> Array:
        """(E1) for the next samples (N, 3), SI; `more`: of other sensors, (N, 3)."""
        many = len(perfect)
        found: Array = perfect @ self._linear.T + self._asymmetry * np.abs(perfect)
        found += self._square * perfect * perfect + (self._bias + more)
        if self._white:
            found += self._white * self._noise.standard_normal((many, 3))
        for part in self._wandering:
            found += part(many)
        if self._step:
            steps = self._step * self._walker.standard_normal((many, 3))
            walked = self._walked + np.cumsum(steps, axis=0)
            self._walked = walked[-1]
            found += walked
        if self._range is not None:
            self.beyond += int((np.abs(found) > self._range).any(axis=1).sum())
            np.clip(found, -self._range, self._range, out=found)
        return found


class _Markov:
    """(E3) for three axes, stationary from the first sample on.

    A slow one is worked out every so many samples, a power of two and at most τ/256 or, in flicker,
    τ/64, and held between them.
    """

    def __init__(
        self,
        sigma: float,
        tau: float,
        interval: float,
        generator: np.random.Generator,
        a_time: float = 256.0,
    ) -> None:
        self._hold = 1 << int(max(0.0, log2(tau / (a_time * interval))))
        steps = self._hold * interval / tau
        self._keep = exp(-steps)
        self._gain = sigma * sqrt(-expm1(-2 * steps))
        self._generator = generator
        self._state = sigma * generator.standard_normal(3)
        self._taken = 0

    def __call__(self, many: int) -> Array:
        """The next values (N, 3)."""
        first, last = self._taken // self._hold, (self._taken + many - 1) // self._hold
        known = self._taken % self._hold != 0  # the first value is the latest one's
        fresh = self._next(last - first + 1 - known)
        values = np.vstack((self._state, fresh)) if known else fresh
        begin, end = self._taken, self._taken + many
        self._state, self._taken = values[-1].copy(), end
        if self._hold == 1:
            return values
        changes = np.clip(self._hold * np.arange(first, last + 2), begin, end)
        return np.repeat(values, changes[1:] - changes[:-1], axis=0)

    def _next(self, many: int) -> Array:
        """The next values, each of them worked out."""
        values = self._gain * self._generator.standard_normal((many, 3))
        if not many:
            return values
        values[0] += self._keep * self._state
        # x_k = Σ φ^(k-j) w_j by doubling: after each round sums of twice as many are there
        reach = 1
        while reach < many and self._keep**reach > 1e-18:
            values[reach:] += self._keep**reach * values[:-reach]
            reach *= 2
        return values


class Imperfect:
    """The errors of a design's [sensor.errors], sample after sample.

    A sensor without them passes everything unchanged.

    Args:
        design: gives the errors, kind and rate of the sensor.
        seed: of all random numbers: the same seed and the same cuts into calls give the same
            samples.
    """

    def __init__(self, design: Design, seed: int = 1) -> None:
        errors = design.sensor.errors
        self.errors: SensorErrors | None = errors
        self._per_sample = design.sample_interval if design.sensor.kind == "increment" else 1.0
        if errors is not None:
            interval = design.sample_interval
            degree_an_hour, milli_g = radians(1) / _HOUR, 1e-3 * STANDARD_GRAVITY
            self._gyro = _Axes(
                *(errors.gyro, degree_an_hour, radians(1) / sqrt(_HOUR), radians(1)),
                interval,
                [seed, 0],
            )
            self._accel = _Axes(
                *(errors.accel, milli_g, 1 / sqrt(_HOUR), STANDARD_GRAVITY), interval, [seed, 1]
            )

    def __call__(self, perfect: Array) -> Array:
        """What the sensor delivers.

        Args:
            perfect: (N, 6), rad and m/s a sample, or rad/s and m/s² for a rate sensor.

        Returns:
            The same with the errors.
        """
        if self.errors is None or not len(perfect):
            return perfect
        mean = perfect / self._per_sample
        rate, force = mean[:, :3], mean[:, 3:]
        gyro = self._gyro(rate, self._gyro.g_sensitivity * force)
        return np.hstack((gyro, self._accel(force))) * self._per_sample

    @property
    def beyond_range(self) -> int:
        """Samples so far that stayed at an end of the range, of gyros and of accelerometers."""
        return 0 if self.errors is None else self._gyro.beyond + self._accel.beyond
