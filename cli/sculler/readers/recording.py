"""What a reader of foreign logs yields: numbers in the file's own units, times of its own clock.

A reader yields what the file holds as a `Recording`: numbers in the file's own units, and the times
of its own clock.  What becomes of the times is `sculler.readers.timing`; bringing the numbers to
the design's counts is the same for all formats and is `sculler.runs.conversion`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import pi
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sculler_model.errors import InputError
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
_STANDARD_GRAVITY = 9.80665  # m/s², the g of data sheets

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
        Unit("g", _STANDARD_GRAVITY, "rate"),
        Unit("mg", _STANDARD_GRAVITY * 1e-3, "rate"),
        Unit("counts", None, None),
    )
}
GYRO_BIAS_UNITS = {"rad/s": 1.0, "deg/s": _DEGREE, "deg/h": _DEGREE / 3600}
ACCEL_BIAS_UNITS = {
    "m/s2": 1.0,
    "g": _STANDARD_GRAVITY,
    "mg": _STANDARD_GRAVITY * 1e-3,
    "ug": _STANDARD_GRAVITY * 1e-6,
}
ANGLE_UNITS = {
    "rad": 1.0,
    "mrad": 1e-3,
    "deg": _DEGREE,
    "arcmin": _DEGREE / 60,
    "arcsec": _DEGREE / 3600,
}
TIME_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}


class Samples(NamedTuple):
    """Consecutive samples of a recording.

    `values` is (N, 6): gyro x, y, z, accelerometer x, y, z, in the recording's units.  `faults` is
    (N,) of 0 and 1, or None.  `times` is (N,), seconds since the recording's first stamp, or None.
    """

    values: NDArray[np.float64]
    faults: NDArray[np.uint8] | None = None
    times: NDArray[np.float64] | None = None


class Clock:
    """Stamps of a file's own clock to seconds since its first one.

    Whole numbers (nanoseconds since 1970 have 19 digits) are subtracted before they become floats,
    so no digit is lost.

    Args:
        unit: what the stamps count, of `TIME_UNITS`.

    Attributes:
        unit: the same.
        origin: the first stamp, s; 0 before there is one.
    """

    def __init__(self, unit: str) -> None:
        self.unit = unit
        self.origin = 0.0
        self._first: np.int64 | np.float64 | None = None

    def __call__(self, stamps: NDArray[np.int64] | NDArray[np.float64]) -> NDArray[np.float64]:
        """Seconds since the first stamp of all, (N,)."""
        seconds = TIME_UNITS[self.unit]
        if self._first is None:
            self._first = stamps[0]
            self.origin = float(stamps[0]) * seconds
        since: NDArray[np.float64] = (stamps - self._first) * seconds
        return since


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
    """

    gyro: Unit
    accel: Unit
    chunks: Iterator[Samples]
    has_faults: bool = False
    clock: Clock | None = None
    notes: Mapping[str, str] = field(default_factory=dict)
    warnings: Sequence[str] = ()
    datagrams: Census | None = None


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
