"""What a reader of foreign logs yields: numbers in the file's own units, times of its own clock.

A reader yields what the file holds as a `Recording`: numbers in the file's own units, and the times
of its own clock.  What becomes of the times is `sculler.readers.timing`; bringing the numbers to
the design's counts is the same for all formats and is `sculler.runs.conversion`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from math import pi
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.frames import STANDARD_GRAVITY
from sculler_model.samples import Kind

if TYPE_CHECKING:
    from sculler.readers.raw.datagrams import Census

Advance = Callable[[int], None]


@dataclass(frozen=True)
class Unit:
    """A unit of angle or velocity increments, or of rates.

    Attributes:
        name: as the user gives it.
        si: one of it in rad or m/s (increments), rad/s or m/s² (rates); None for a count of the
            design's own sensor.
        kind: what it measures; None for counts.
    """

    name: str
    si: float | None
    kind: Kind | None


_DEGREE = pi / 180

GYRO_UNITS = {
    unit.name: unit
    for unit in (
        Unit("rad", 1.0, "increment"),
        Unit("deg", _DEGREE, "increment"),
        Unit("arcsec", _DEGREE / 3600, "increment"),
        Unit("rad/s", 1.0, "rate"),
        Unit("deg/s", _DEGREE, "rate"),
        Unit("deg/h", _DEGREE / 3600, "rate"),
        Unit("counts", None, None),
    )
}
ACCEL_UNITS = {
    unit.name: unit
    for unit in (
        Unit("m/s", 1.0, "increment"),
        Unit("ft/s", 0.3048, "increment"),
        Unit("m/s2", 1.0, "rate"),
        Unit("g", STANDARD_GRAVITY, "rate"),
        Unit("mg", STANDARD_GRAVITY * 1e-3, "rate"),
        Unit("counts", None, None),
    )
}
GYRO_BIAS_UNITS = {"rad/s": 1.0, "deg/s": _DEGREE, "deg/h": _DEGREE / 3600}
ACCEL_BIAS_UNITS = {
    "m/s2": 1.0,
    "g": STANDARD_GRAVITY,
    "mg": STANDARD_GRAVITY * 1e-3,
    "ug": STANDARD_GRAVITY * 1e-6,
}
ANGLE_UNITS = {
    "rad": 1.0,
    "mrad": 1e-3,
    "deg": _DEGREE,
    "arcmin": _DEGREE / 60,
    "arcsec": _DEGREE / 3600,
}
TIME_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
_MICROSECOND_DECIMALS = {"s": 6, "ms": 3, "us": 0, "ns": -3}

Stamps = NDArray[np.int64] | NDArray[np.float64] | NDArray[np.str_]


class Samples(NamedTuple):
    """Consecutive samples of a recording.

    `values` is (N, 6): gyro x, y, z, accelerometer x, y, z, in the recording's units.  `faults` is
    (N,) of 0 and 1, or None.  `times` is (N,), seconds since the origin of the recording's clock,
    or None.  `channels` is (N,), whose sample it is, and `restarts` (N,) of 0 and 1; both None but
    where a design has channels and the file says it.
    """

    values: NDArray[np.float64]
    faults: NDArray[np.uint8] | None = None
    times: NDArray[np.float64] | None = None
    channels: NDArray[np.int64] | None = None
    restarts: NDArray[np.uint8] | None = None


class Clock:
    """Stamps of a file's own clock to seconds since the whole second of its first one.

    A float tells seconds since 1970 to 0.24 µs only, in which a body that turns by 190 °/s turns
    by 0.16″.  So the origin is taken off before anything is rounded: from whole numbers as they
    are, from texts as decimals.  Floats that all stand for whole microseconds are taken as these.

    Args:
        unit: what the stamps count, of `TIME_UNITS`.

    Attributes:
        unit: the same.
        origin: a whole number of s, at most a second from the first stamp; 0 before there is one.
    """

    def __init__(self, unit: str) -> None:
        self.unit = unit
        self.origin = 0.0
        self._ticks = round(1 / TIME_UNITS[unit])  # a second has
        self._begin: int | None = None  # the origin in ticks

    def __call__(self, stamps: Stamps) -> NDArray[np.float64]:
        """Seconds since the origin, (N,).

        Args:
            stamps: (N,) whole numbers (int64), floats (float64), or decimals as texts.
        """
        if self._begin is None:
            first = int(Decimal(str(stamps[0])))
            seconds = abs(first) // self._ticks * (-1 if first < 0 else 1)
            self._begin, self.origin = seconds * self._ticks, float(seconds)
        return self._since(stamps, self._begin) / self._ticks

    def _since(self, stamps: Stamps, begin: int) -> NDArray[np.float64]:
        """Ticks since the origin, (N,)."""
        if stamps.dtype.kind == "U":
            return np.array([float(Decimal(text) - begin) for text in stamps.tolist()])
        if stamps.dtype.kind == "i":
            return (np.asarray(stamps, np.int64) - begin).astype(np.float64)
        since: NDArray[np.float64] = stamps.astype(np.float64) - float(begin)  # exact
        with np.errstate(over="ignore", invalid="ignore"):
            rounded = np.round(since, _MICROSECOND_DECIMALS[self.unit])
            near = np.abs(rounded - since) <= 0.5 * np.spacing(np.abs(stamps))
        return rounded if near.all() else since


@dataclass(frozen=True)
class Recording:
    """A foreign log, read as its samples are drawn.

    Attributes:
        gyro, accel: units of the values.
        chunks: the samples, in order; raises InputError where the file is at fault.
        has_faults: the file has a fault column.
        clock: of the stamps; None where there are none.
        notes: what the file says that is worth telling, by topic; complete once all samples have
            been drawn.
        warnings: what is doubtful in it, in sentences; likewise.
        datagrams: what a raw log is made of; likewise.
        has_channels, has_restarts: the samples say whose they are, and where a channel begins anew.
    """

    gyro: Unit
    accel: Unit
    chunks: Iterator[Samples]
    has_faults: bool = False
    clock: Clock | None = None
    notes: Mapping[str, str] = field(default_factory=dict)
    warnings: Sequence[str] = ()
    datagrams: Census | None = None
    has_channels: bool = False
    has_restarts: bool = False


def require_finite(path: Path, first: int, values: NDArray[Any], names: Sequence[str]) -> None:
    """Refuse a value that is not finite.

    Args:
        path: for the message.
        first: number of the first sample.
        values: (N, columns).
        names: of the columns.

    Raises:
        InputError: names the first such value.
    """
    bad = ~np.isfinite(values)
    if bad.any():
        row, at = (int(i) for i in np.argwhere(bad)[0])
        raise InputError(
            f"{path}: sample {first + row}: {names[at]} is {values[row, at]}, give a finite number"
        )


def si_of_unit(design: Design, sensor: str, unit: Unit) -> float:
    """SI value, in the design's kind, of one unit of a number; the interval turns rates and means.

    Args:
        design: gives kind, scales and sample interval.
        sensor: `gyro` or `accel`.
        unit: of the number.
    """
    if unit.si is None:
        lsb: float = getattr(design.sensor, sensor).lsb
        return lsb
    if unit.kind in (None, design.sensor.kind):
        return unit.si
    T = design.sample_interval
    return unit.si * T if unit.kind == "rate" else unit.si / T
