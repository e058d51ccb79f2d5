"""Allan deviations of a log that is made: what it has beyond the truth."""

from __future__ import annotations

from math import degrees
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.frames import STANDARD_GRAVITY
from sculler_model.samples import (
    CLUSTERS,
    AllanCurve,
    AllanRecord,
    asked_deviation,
    worst_ratio,
)


def allan_facts(curve: AllanCurve, design: Design, picture: Path | None) -> dict[str, Any]:
    """Deviations as plain data, in the units of data sheets."""
    asked = asked_deviation(design, curve.tau)
    data: dict[str, Any] = {
        "picture": str(picture),
        "tau_s": curve.tau.tolist(),
        "clusters": curve.clusters.tolist(),
        "worst_ratio": worst_ratio(curve, asked),
    }
    for name, unit, scale, part in (
        ("gyro", "deg_per_h", degrees(1) * 3600, slice(0, 3)),
        ("accel", "mg", 1e3 / STANDARD_GRAVITY, slice(3, 6)),
    ):
        data[f"{name}_{unit}"] = (scale * curve.deviation[:, part]).tolist()
        data[f"{name}_asked_{unit}"] = (scale * asked[:, part.start]).tolist()
    return data


class Gathered:
    """The samples less the perfect ones, as rates, for `AllanRecord`."""

    def __init__(self, design: Design, samples: int) -> None:
        if samples < CLUSTERS:
            raise InputError(
                f"--allan: {samples} samples are too few, give a --duration of at least"
                f" {CLUSTERS * design.sample_interval:g} s"
            )
        sensor, T = design.sensor, design.sample_interval
        over = T if sensor.kind == "increment" else 1.0
        self._lsb = np.repeat([sensor.gyro.lsb, sensor.accel.lsb], 3) / over
        self._over, self.record = over, AllanRecord(T)

    def add(self, counts: NDArray[np.int64], perfect: NDArray[np.float64]) -> None:
        """The next (N, 6)."""
        self.record.add(counts * self._lsb - perfect / self._over)
