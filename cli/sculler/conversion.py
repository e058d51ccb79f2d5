"""From a recording's numbers to the design's counts."""

from __future__ import annotations

from math import isclose
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sculler.readers import Recording
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.navigation.rotation import AxisMap
from sculler_model.quantise import Quantiser

_TRIPLES = {"gyro": slice(0, 3), "accel": slice(3, 6)}


class Conversion:
    """Brings samples to counts of the design's sensor, streaming.

    Numbers whose unit is the sensor's own LSB (to 1e-6) pass unchanged; others are quantised with
    the remainder carried.  Rates become increments by the sample interval T, as means over it, and
    increments become mean rates.

    Args:
        path: for messages.
        design: gives kind, scales and widths.
        recording: gives the units.
        axes: which sensor axis of the recording becomes which of the log, or None.
    """

    def __init__(
        self, path: Path, design: Design, recording: Recording, axes: AxisMap | None
    ) -> None:
        self._path, self._design, self._axes = path, design, axes
        self._units = {"gyro": recording.gyro, "accel": recording.accel}
        self._quantiser = Quantiser(design)
        self._factor = np.ones(6)
        for sensor, part in _TRIPLES.items():
            self._factor[part] = self._si(sensor)
        self.samples = 0
        self.largest = np.zeros(6, np.int64)

    def _lsb(self, sensor: str) -> float:
        return self._design.sensor.gyro.lsb if sensor == "gyro" else self._design.sensor.accel.lsb

    def _si(self, sensor: str) -> float:
        """SI value, in the design's kind, of one unit."""
        unit, T = self._units[sensor], self._design.sample_interval
        if unit.si is None:
            return self._lsb(sensor)
        if unit.kind == self._design.sensor.kind:
            return unit.si
        return unit.si * T if unit.kind == "rate" else unit.si / T

    def passes(self, sensor: str) -> bool:
        """Whether the numbers of `gyro` or `accel` already are the design's counts."""
        unit = self._units[sensor]
        own_kind = unit.kind in (None, self._design.sensor.kind)
        return own_kind and isclose(self._si(sensor), self._lsb(sensor), rel_tol=1e-6)

    def made(self, sensor: str) -> str:
        """How the numbers of `gyro` or `accel` become counts, in words."""
        unit, axes = self._units[sensor], getattr(self._design.sensor, sensor)
        kind = self._design.sensor.kind
        si = ("rad" if sensor == "gyro" else "m/s") + ("/s" if kind == "rate" else "")
        scale = f"{axes.bits} bits of {axes.lsb:.9g} {si}"
        if self.passes(sensor):
            return f"{unit.name}: the design's own counts, unchanged ({scale})"
        change = ""
        if unit.kind != kind:
            T = f"T = {self._design.sample_interval:.6g} s"
            change = f", times {T}" if kind == "increment" else f", over {T}"
        return f"{unit.name}{change}, quantised to {scale}, remainder carried"

    def __call__(self, values: NDArray[np.float64]) -> NDArray[np.int64]:
        """Counts (N, 6) of the next samples (N, 6).

        Raises:
            InputError: a value does not fit the sensor's width, or is no whole number of counts.
        """
        if self._axes is not None:
            values = np.hstack([self._axes.apply(values[:, part]) for part in _TRIPLES.values()])
        rest = values * self._factor
        for sensor, part in _TRIPLES.items():
            if self.passes(sensor):
                self._require_counts(sensor, values[:, part])
                rest[:, part] = 0
        try:
            counts = self._quantiser(rest)
        except InputError as error:
            raise InputError(f"{self._path}: {error}") from error
        for sensor, part in _TRIPLES.items():
            if self.passes(sensor):
                counts[:, part] = values[:, part]
        self.samples += len(values)
        self.largest = np.maximum(self.largest, np.abs(counts).max(axis=0))
        return counts

    @property
    def remainder(self) -> tuple[float, ...]:
        """What is left for a next sample, SI units, in the order of the columns."""
        return self._quantiser.report().remainder

    def _require_counts(self, sensor: str, values: NDArray[np.float64]) -> None:
        """Whole numbers that fit the word, or an error that names the first that is not."""
        words = self._design.words
        allowed = words.gyro if sensor == "gyro" else words.accel
        good = (values == np.rint(values)) & (values >= allowed.lo) & (values <= allowed.hi)
        if good.all():
            return
        row, axis = (int(at) for at in np.argwhere(~good)[0])
        value = float(values[row, axis])
        where = f"{self._path}: sample {self.samples + row}: {sensor}_{'xyz'[axis]} = {value:.15g}"
        if value.is_integer():
            raise InputError(
                f"{where} does not fit the sensor's {allowed.bits} bits, give {allowed.lo} to"
                f" {allowed.hi}"
            )
        raise InputError(f"{where} is not a whole number of counts, check the unit")
