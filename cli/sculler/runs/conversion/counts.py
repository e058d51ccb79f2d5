"""From a recording's numbers to the design's counts."""

from __future__ import annotations

from dataclasses import dataclass
from math import isclose
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sculler.checks.log_beginning import LogBeginning
from sculler.readers.mounting import Mounting
from sculler.readers.recording import Unit, si_of_unit
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.frames import STANDARD_GRAVITY, Vector
from sculler_model.samples import Quantiser

_TRIPLES = {"gyro": slice(0, 3), "accel": slice(3, 6)}
_EARTH_RATE = 7.292115e-5  # rad/s
_FAST = 20.0  # rad/s, more than a vehicle turns on the average
_UNIT_SLIPS = (
    (STANDARD_GRAVITY, "g taken for m/s²"),
    (1 / STANDARD_GRAVITY, "m/s² taken for g"),
    (STANDARD_GRAVITY * 1e-3, "mg taken for m/s²"),
    (0.3048, "ft/s taken for m/s"),
)


@dataclass(frozen=True)
class Biases:
    """What a sensor shows too much, in the file's axes: rad/s and m/s²."""

    gyro: Vector = (0.0, 0.0, 0.0)
    accel: Vector = (0.0, 0.0, 0.0)


class Conversion:
    """Brings samples to counts of the design's sensor, streaming.

    Numbers whose unit is the sensor's own LSB (to 1e-6) pass unchanged if nothing else is to be
    done to them; others are quantised with the remainder carried.  Rates become increments by the
    sample interval T, as means over it, and increments become mean rates.  (Rates at instants are
    integrated before they come here.)

    Args:
        path: for messages.
        design: gives kind, scales and widths.
        gyro, accel: units of the numbers.
        mounting: from the recording's axes to the log's.
        biases: taken off first.
        reworked: the samples are interpolated or calibrated, in part at least, and so no whole
            counts.
    """

    def __init__(
        self,
        path: Path | str,
        design: Design,
        gyro: Unit,
        accel: Unit,
        mounting: Mounting | None = None,
        biases: Biases | None = None,
        reworked: bool = False,
    ) -> None:
        self._path, self._design = path, design
        self._mounting = mounting or Mounting()
        biases = biases or Biases()
        self._units = {"gyro": gyro, "accel": accel}
        self._reworked = reworked
        self._quantiser = Quantiser(design)
        # SI in the design's kind, of one unit, and of the bias over one sample
        self._factor, self._bias = np.ones(6), np.zeros(6)
        over = design.sample_interval if design.sensor.kind == "increment" else 1.0
        for sensor, part in _TRIPLES.items():
            self._bias[part] = np.array(getattr(biases, sensor)) * over
            self._factor[part] = self._lsb(sensor) if self._own(sensor) else self._si(sensor)
        self.samples = 0
        self.largest = np.zeros(6, np.int64)
        self._sizes = np.zeros(2)  # sums of |rate| and |specific force|
        self._beginning = LogBeginning(design)

    def begin_anew(self) -> None:
        """The next sample is the first since the sensor was off; no remainder is carried to it."""
        self._quantiser = Quantiser(self._design)

    def _lsb(self, sensor: str) -> float:
        return self._design.sensor.gyro.lsb if sensor == "gyro" else self._design.sensor.accel.lsb

    def _si(self, sensor: str) -> float:
        """SI value, in the design's kind, of one unit."""
        return si_of_unit(self._design, sensor, self._units[sensor])

    def _own(self, sensor: str) -> bool:
        """Whether the numbers of `gyro` or `accel` are in the design's own unit."""
        own_kind = self._units[sensor].kind in (None, self._design.sensor.kind)
        return own_kind and isclose(self._si(sensor), self._lsb(sensor), rel_tol=1e-6)

    def passes(self, sensor: str) -> bool:
        """Whether the numbers of `gyro` or `accel` already are the design's counts."""
        changed = self._reworked or self._mounting.turns or self._bias[_TRIPLES[sensor]].any()
        return self._own(sensor) and not changed

    def made(self, sensor: str) -> str:
        """How the numbers of `gyro` or `accel` become counts, in words."""
        unit, axes = self._units[sensor], getattr(self._design.sensor, sensor)
        kind = self._design.sensor.kind
        si = ("rad" if sensor == "gyro" else "m/s") + ("/s" if kind == "rate" else "")
        scale = f"{axes.bits} bits of {axes.lsb:.9g} {si}"
        if self.passes(sensor):
            return f"{unit.name}: the design's own counts, unchanged ({scale})"
        change = ""
        if unit.kind not in (None, kind):
            T = f"T = {self._design.sample_interval:.6g} s"
            change = f", times {T}" if kind == "increment" else f", over {T}"
        if self._bias[_TRIPLES[sensor]].any():
            change += ", bias taken off"
        return f"{unit.name}{change}, quantised to {scale}, remainder carried"

    def __call__(self, values: NDArray[np.float64]) -> NDArray[np.int64]:
        """Counts (N, 6) of the next samples (N, 6).

        Raises:
            InputError: a value does not fit the sensor's width, or is no whole number of counts.
        """
        return self.counted(self.si(values), values)

    def si(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """(N, 6) samples in SI, in the design's kind and the log's axes, biases taken off."""
        return self._mounted(values * self._factor - self._bias)

    def counted(self, si: NDArray[np.float64], values: NDArray[np.float64]) -> NDArray[np.int64]:
        """Counts (N, 6) of samples in SI; `values` as they were, which may be counts already.

        Raises:
            InputError: as by a call.
        """
        whole = values if self._mounting.turns else self._mounted(values)
        rest = si.copy()
        for sensor, part in _TRIPLES.items():
            if self.passes(sensor):
                self._require_counts(sensor, whole[:, part])
                rest[:, part] = 0
        try:
            counts = self._quantiser(rest)
        except InputError as error:
            raise InputError(f"{self._path}: {error}") from error
        for sensor, part in _TRIPLES.items():
            if self.passes(sensor):
                counts[:, part] = whole[:, part]
        self.samples += len(values)
        self.largest = np.maximum(self.largest, np.abs(counts).max(axis=0))
        self._beginning(si)
        self._sizes += [np.linalg.norm(si[:, part], axis=1).sum() for part in _TRIPLES.values()]
        return counts

    def _mounted(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.hstack([self._mounting.apply(values[:, part]) for part in _TRIPLES.values()])

    def hints(self) -> list[str]:
        """What makes the units look wrong: no vehicle near the Earth moves like this."""
        if not self.samples:
            return []
        over = self._design.sample_interval if self._design.sensor.kind == "increment" else 1.0
        rate, force = (self._sizes / self.samples / over).tolist()
        hints = []
        wrong_size = not 0.5 * STANDARD_GRAVITY < force < 3 * STANDARD_GRAVITY
        if wrong_size:
            slip = next(
                (
                    f" ({name}?)"
                    for factor, name in _UNIT_SLIPS
                    if 0.8 < force * factor / STANDARD_GRAVITY < 1.25
                ),
                "",
            )
            steady = None if slip else self._beginning.size_hint()
            hints.append(
                steady
                or f"the mean specific force is {force:.4g} m/s², far from gravity's 9.8{slip}:"
                " check the accelerometer's unit and scale"
            )
        if not 0.2 * _EARTH_RATE < rate < _FAST:
            than = "more than vehicles turn" if rate > _FAST else "less than the Earth turns"
            hints.append(
                f"the mean angular rate is {rate:.4g} rad/s, {than}: check the gyro's unit and"
                " scale"
            )
        return hints if wrong_size else [*hints, *self._beginning.hints()]

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
