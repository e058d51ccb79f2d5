"""The way back: known errors of a sensor taken out of its samples.

`Imperfect` and a sensor's place make of the perfect x, y = x + s x + a |x| + q x² + Σ m x_other +
G f + b.  Here it is solved for x, and the accelerometers are brought to the gyros' time and to the
point that is navigated.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, floor, radians

import numpy as np
from numpy.typing import NDArray

from sculler_model.design import AxisErrors, Design, Drawn, SensorErrors, why_not_undone
from sculler_model.errors import InputError
from sculler_model.frames import STANDARD_GRAVITY

Array = NDArray[np.float64]

_TAPS = 6  # samples that an interpolated one is made of
_EDGE = 3  # samples on either side that a rate at a boundary is made of


@dataclass(frozen=True)
class AxesCalibration:
    """Known errors of three like axes, SI.

    Attributes:
        linear: (3, 3), from the perfect vector: scale factors and misalignments.
        bias: (3,) rad/s or m/s².
        asymmetry: (3,), of |x|.
        square: (3,) of x², 1/(rad/s) or 1/(m/s²).
        g_sensitivity: (3,) rad/s for each m/s²; zeros for accelerometers.
    """

    linear: Array
    bias: Array
    asymmetry: Array
    square: Array
    g_sensitivity: Array

    def undone(self, felt: Array, more: Array | float = 0.0) -> Array:
        """The perfect rates or forces of (N, 3) felt ones; `more`: of other sensors."""
        back = np.linalg.inv(self.linear).T
        target = felt - self.bias - more
        found: Array = target @ back
        if self.asymmetry.any() or self.square.any():
            for _ in range(8):  # each step gains a factor of some 1e-3
                bent = self.asymmetry * np.abs(found) + self.square * found * found
                found = (target - bent) @ back
        return found


@dataclass(frozen=True)
class Calibration:
    """Known errors of a sensor, in its own axes.

    Attributes:
        gyro, accel: of the three axes each.
        delay: sample intervals by which the accelerometers see later than the gyros.
        arms: (3, 3) m, a row for each accelerometer: from the point that is navigated to it.
    """

    gyro: AxesCalibration
    accel: AxesCalibration
    delay: float
    arms: Array

    @classmethod
    def of(cls, errors: SensorErrors) -> Calibration:
        """From a table like [sensor.errors], every value a number.

        Raises:
            InputError: a value is drawn or random, so nobody knows it.
        """
        for name, axes in (("gyro", errors.gyro), ("accel", errors.accel)):
            for key in type(axes).model_fields:
                value = getattr(axes, key)
                if why := why_not_undone(key, value):
                    raise InputError(f"{name}.{key}: {why}")
        degree, gravity = radians(1), STANDARD_GRAVITY
        arms = errors.arms_m or [[0.0] * 3] * 3
        return cls(
            _axes(errors.gyro, degree / 3600, degree),
            _axes(errors.accel, 1e-3 * gravity, gravity),
            errors.delay_samples or 0.0,
            np.array(arms, np.float64),
        )

    @property
    def of_samples(self) -> list[str]:
        """What of it only the samples can be freed of, not sums over intervals; in words."""
        told = []
        for name, axes in (("gyro", self.gyro), ("accel", self.accel)):
            told += [f"{name}.asymmetry"] if axes.asymmetry.any() else []
            told += [f"{name}.square"] if axes.square.any() else []
        told += ["delay_samples"] if self.delay else []
        return told + (["arms_m"] if self.arms.any() else [])


def _axes(errors: AxisErrors, unit: float, full: float) -> AxesCalibration:
    linear = np.eye(3) + np.diag(1e-6 * _numbers(errors.scale_factor, 3))
    linear[~np.eye(3, dtype=bool)] += 1e-3 * _numbers(errors.misalignment, 6)
    return AxesCalibration(
        linear,
        unit * _numbers(errors.bias, 3),
        1e-6 * _numbers(errors.asymmetry, 3),
        1e-6 / full * _numbers(errors.square, 3),
        unit / STANDARD_GRAVITY * _numbers(errors.g_sensitivity, 3),
    )


def _numbers(value: Drawn | list[float] | None, many: int) -> Array:
    return np.array(value, np.float64) if isinstance(value, list) else np.zeros(many)


class Undo:
    """Takes a calibration out of consecutive samples, in blocks of any length.

    A delay, and lever arms, need samples on either side: `reach` of them are held back until they
    are there.  Beyond the ends of the record the samples are taken to go on along straight lines.

    With ω at the boundaries of a sample by six samples about each, and in its middle by Simpson's
    rule backwards, an accelerometer at r feels more, over a sample interval T,

        (ω_end - ω_begin)/T × r + mean of ω×(ω×r)

    along its own axis (the size effect).

    Args:
        design: kind and rate of the sensor.
        calibration: what is known.
    """

    def __init__(self, design: Design, calibration: Calibration) -> None:
        self._known = calibration
        self._interval = design.sample_interval
        self._per_sample = self._interval if design.sensor.kind == "increment" else 1.0
        delay, arms = calibration.delay, bool(calibration.arms.any())
        self._arms = arms
        self.reach = (ceil(abs(delay)) + _TAPS // 2 if delay else 0) + (_EDGE if arms else 0)
        self._held = np.zeros((0, 6))  # what is felt; `reach` samples are past ones
        self._begun = False

    def __call__(self, felt: Array) -> Array:
        """Samples without the errors, as many as are due; those held back come later.

        Args:
            felt: (N, 6), rad and m/s a sample, or rad/s and m/s² for a rate sensor.
        """
        if not len(felt):
            return np.zeros((0, 6))
        if not self._begun:
            self._held, self._begun = _onwards(felt[1::-1], self.reach)[::-1], True
        held = np.concatenate((self._held, felt))
        due = max(len(held) - 2 * self.reach, 0)
        self._held = held[due:]
        return self._without(held) if due else np.zeros((0, 6))

    def finish(self) -> Array:
        """The samples still held back."""
        if not self.reach or not self._begun:
            return np.zeros((0, 6))
        return self(_onwards(self._held[-2:], self.reach))

    def _without(self, felt: Array) -> Array:
        """(N - 2 reach, 6) samples of (N, 6)."""
        known, mean = self._known, felt / self._per_sample
        force = known.accel.undone(mean[:, 3:])
        rate = known.gyro.undone(mean[:, :3], known.gyro.g_sensitivity * force)
        edge = _EDGE if self._arms else 0
        if known.delay:
            force = _earlier(force, known.delay, self.reach - edge)
            rate = rate[self.reach - edge : len(rate) - (self.reach - edge)]
        if self._arms:
            force, rate = force[edge:-edge] - self._size_effect(rate), rate[edge:-edge]
        return np.hstack((rate, force)) * self._per_sample

    def _size_effect(self, rate: Array) -> Array:
        """(N - 2 edge, 3) m/s² that each accelerometer feels more for its arm."""
        weights = np.array([1.0, -8.0, 37.0, 37.0, -8.0, 1.0]) / 60
        many = len(rate) - 2 * _EDGE + 1  # boundaries
        at = sum(w * rate[i : i + many] for i, w in enumerate(weights))
        begin, end = np.asarray(at)[:-1], np.asarray(at)[1:]
        middle = (6 * rate[_EDGE:-_EDGE] - begin - end) / 4
        change = (end - begin) / self._interval
        felt = np.empty_like(begin)
        for axis, arm in enumerate(self._known.arms):
            inward = (
                np.cross(w, np.cross(w, np.broadcast_to(arm, w.shape)))[:, axis]
                for w in (begin, middle, end)
            )
            first, half, last = inward
            felt[:, axis] = np.cross(change, arm)[:, axis] + (first + 4 * half + last) / 6
        return felt


def _onwards(last: Array, many: int) -> Array:
    """(many, 6) samples on the straight line after one or two."""
    steps = np.arange(1.0, many + 1)[:, None]
    beyond: Array = last[-1] + steps * (last[-1] - last[0])
    return beyond


def _earlier(force: Array, delay: float, reach: int) -> Array:
    """(N - 2 reach, 3): samples as they are `delay` samples further on, by Lagrange's polynomial.

    Of increments the running sum is interpolated, which is the same sum of neighbours.
    """
    whole = floor(delay)
    share = delay - whole
    offsets = np.arange(_TAPS) - (_TAPS // 2 - 1)
    many = len(force) - 2 * reach
    found = np.zeros((many, 3))
    for offset in offsets.tolist():
        others = offsets[offsets != offset]
        weight = float(np.prod((share - others) / (offset - others)))
        first = reach + whole + offset
        found += weight * force[first : first + many]
    return found
