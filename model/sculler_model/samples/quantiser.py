"""Float increments to integer counts, the remainder carried on as a pulse-counting sensor does.

The counts emitted so far are always the rounded total of the input so far, so no angle and no
velocity is ever lost, however long the log.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sculler_model.design import AXES, Design
from sculler_model.errors import InputError

INPUT_COLUMNS = tuple(f"{sensor}_{axis}" for sensor in ("gyro", "accel") for axis in AXES)
"""Order of the six columns, as in the IMU log."""

_FRACTION_BITS = 42
_HALF = 1 << (_FRACTION_BITS - 1)
_SPLIT = float((1 << 27) + 1)
_EXACT = float(1 << 24)
BLOCK = 1 << 11
"""Samples quantised at a time: few enough for the cache."""

MOST = 1 << 19
"""The most: so many fractions, each below 2**42, sum to less than 2**62."""


@dataclass(frozen=True)
class QuantiserReport:
    """What a quantiser has done so far.

    Attributes:
        samples: samples taken.
        largest_count: largest magnitude of a count, per column of `INPUT_COLUMNS`.
        full_scale: the same as a share of the largest count that fits the word (0..1).
        remainder: what is left for the next sample, SI units, at most half an LSB.
    """

    samples: int
    largest_count: tuple[int, ...]
    full_scale: tuple[float, ...]
    remainder: tuple[float, ...]


class Quantiser:
    """Turn SI samples into the design's integer counts, streaming.

    The remainder is kept in units of 2**-42 LSB as an integer, so the result does not depend on
    how the input is cut into chunks, and the total of the counts stays within half an LSB of the
    total of the input, plus at most 2**-43 LSB a sample for bringing each sample's fraction to
    those units (2e-5 LSB after a day at 2 kHz).  Carrying the remainder is right for rate samples
    too: their sum, which becomes the angle, is what is kept.

    Args:
        design: gives widths, LSBs and kind of the sensor.
        block: samples quantised at a time, at most `MOST`; makes no difference to the counts.
    """

    def __init__(self, design: Design, block: int = BLOCK) -> None:
        self.design = design
        gyro, accel = design.sensor.gyro, design.sensor.accel
        self._lsb = np.array([gyro.lsb] * 3 + [accel.lsb] * 3)
        self._high = (self._lsb * _SPLIT) - (self._lsb * _SPLIT - self._lsb)  # Veltkamp
        self._low = self._lsb - self._high
        self._parted = bool(((self._lsb > 1e-200) & (self._lsb < 1e200)).all())
        ranges = [design.words.gyro] * 3 + [design.words.accel] * 3
        self._lo = np.array([r.lo for r in ranges])
        self._hi = np.array([r.hi for r in ranges])
        self._bits = [r.bits for r in ranges]
        increments = design.sensor.kind == "increment"
        self._units = ["rad" if increments else "rad/s"] * 3 + ["m/s" if increments else "m/s²"] * 3
        self._size = min(block, MOST)
        self._samples = 0
        self._carry = np.zeros(6, np.int64)
        self._largest = np.zeros(6, np.int64)

    def __call__(self, values: NDArray[np.float64]) -> NDArray[np.int64]:
        """Quantise the next samples.

        Args:
            values: (N, 6) in the order of `INPUT_COLUMNS`; rad and m/s a sample, or rad/s and
                m/s² for a rate sensor.

        Returns:
            (N, 6) counts.

        Raises:
            InputError: a value is not finite, or its count does not fit the sensor's word.  The
                quantiser is then as it was before the call.
        """
        values = np.asarray(values, np.float64)
        if values.ndim != 2 or values.shape[1] != 6:
            raise InputError(f"samples: shape {values.shape} is not allowed, give (N, 6)")
        before = self._samples, self._carry, self._largest
        counts = np.empty(values.shape, np.int64)
        try:
            for first in range(0, len(values), self._size):
                part = slice(first, first + self._size)
                counts[part] = self._block(values[part])
        except InputError:
            self._samples, self._carry, self._largest = before
            raise
        return counts

    def _block(self, values: NDArray[np.float64]) -> NDArray[np.int64]:
        self._require(np.abs(values) < 2.0**40 * self._lsb, values)  # false for NaN too

        # value = whole * lsb + rest without rounding
        rest = self._rest(values)
        whole = np.rint((values - rest) / self._lsb).astype(np.int64)
        fraction = np.rint(rest / self._lsb * (1 << _FRACTION_BITS)).astype(np.int64)

        total = np.cumsum(fraction, axis=0) + self._carry
        rounded = (total + _HALF) >> _FRACTION_BITS
        counts: NDArray[np.int64] = whole + np.diff(rounded, axis=0, prepend=0)
        self._require((counts >= self._lo) & (counts <= self._hi), values)

        self._carry = total[-1] - (rounded[-1] << _FRACTION_BITS)
        self._largest = np.maximum(self._largest, np.abs(counts).max(axis=0))
        self._samples += len(values)
        return counts

    def _rest(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """What division by the LSB leaves, exactly, of the value's sign: `fmod`, which is slow.

        With n the whole number nearest to value/LSB and the LSB parted into high + low, of 26 bits
        and at most 26, n high and n low are exact up to n = 2**24.  value - n high is at most 0.8
        LSB then, and both are whole multiples of the last place of value or LSB, so no difference
        is rounded either.  A zero is told as a whole LSB of the value's sign, or as a zero.
        """
        nearest = np.rint(values / self._lsb)
        if not (self._parted and np.abs(nearest).max(initial=0) <= _EXACT):
            rest: NDArray[np.float64] = np.fmod(values, self._lsb)
        else:
            rest = (values - nearest * self._high) - nearest * self._low
            rest += (np.signbit(rest) != np.signbit(values)) * np.copysign(self._lsb, values)
        return rest

    def _require(self, good: NDArray[np.bool_], values: NDArray[np.float64]) -> None:
        if good.all():
            return
        row, column = (int(at) for at in np.argwhere(~good)[0])
        value, where = float(values[row, column]), f"sample {self._samples + row}"
        name, unit = INPUT_COLUMNS[column], self._units[column]
        if not np.isfinite(value):
            raise InputError(f"{where}: {name} = {value} is not a number to quantise, mend the log")
        raise InputError(
            f"{where}: {name} = {value:.9g} {unit} does not fit {self._bits[column]} bits of"
            f" {self._lsb[column]:.9g} {unit} ({self._lo[column]} to {self._hi[column]} counts),"
            " check the units or give the sensor more bits or a larger LSB"
        )

    def report(self) -> QuantiserReport:
        """Facts about all samples so far."""
        return QuantiserReport(
            self._samples,
            tuple(self._largest.tolist()),
            tuple((self._largest / self._hi).tolist()),
            tuple((self._carry / 2.0**_FRACTION_BITS * self._lsb).tolist()),
        )
