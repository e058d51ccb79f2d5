"""Foreign IMU logs, one module per format; `sculler convert` makes core logs of them.

A reader yields what the file holds as a `Recording`: numbers in the file's own units.  Bringing
them to the design's counts is the same for all formats and is `sculler.conversion`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from math import pi
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

Kind = Literal["increment", "rate"]
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


class Samples(NamedTuple):
    """Consecutive samples of a recording.

    `values` is (N, 6): gyro x, y, z, accelerometer x, y, z, in the recording's units.  `faults` is
    (N,) of 0 and 1, or None.
    """

    values: NDArray[np.float64]
    faults: NDArray[np.uint8] | None = None


@dataclass(frozen=True)
class Recording:
    """A foreign log, read as its samples are drawn.

    Attributes:
        gyro, accel: units of the values.
        chunks: the samples, in order; raises InputError where the file is at fault.
        has_faults: the file has a fault column.
        notes: what the file says that is worth telling, by topic; complete once all samples have
            been drawn.
    """

    gyro: Unit
    accel: Unit
    chunks: Iterator[Samples]
    has_faults: bool = False
    notes: Mapping[str, str] = field(default_factory=dict)
