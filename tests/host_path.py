"""The whole integer path for tests of the host: float samples to counts, core, host, attitude."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from sculler_model.design import Design
from sculler_model.fast import FastModel
from sculler_model.frames import (
    Quaternion,
    Vector,
    conjugate,
    from_rotation_vector,
    product,
    to_rotation_vector,
)
from sculler_model.host import MajorIncrements, major_increments
from sculler_model.samples import Quantiser


def fine_design(
    samples: int,
    history: int = 0,
    minors: int = 1,
    rate: float = 2000.0,
    gyro_lsb: float = 1e-12,
    accel_lsb: float = 1e-11,
    kind: str = "increment",
    position: str = "trapezoidal",
) -> Design:
    """32-bit sensor with LSBs so fine that quantisation does not show."""
    return Design.parse(
        {
            "name": "fine",
            "sensor": {
                "kind": kind,
                "sample_rate_hz": rate,
                "gyro": {"bits": 32, "lsb": gyro_lsb},
                "accel": {"bits": 32, "lsb": accel_lsb},
            },
            "algorithm": {
                "family": "frequency-taylor" if kind == "increment" else "filtered-rate",
                "samples": samples,
                "history": history,
                "minors": minors,
                "position": position,
            },
            "hardware": {"core": "compact" if position == "high-resolution" else "pipelined"},
        }
    )


def through_core(design: Design, samples: Iterable[NDArray[np.float64]]) -> MajorIncrements:
    """SI samples to counts, through the integer core, to the host's increments."""
    quantiser, core = Quantiser(design), FastModel(design)
    blocks = [major_increments(design, core.feed(quantiser(chunk))) for chunk in samples]
    return MajorIncrements.concatenate(blocks)


def chained(start: Quaternion, phi: NDArray[np.float64]) -> Quaternion:
    """Attitude after all rotation vectors (R, 3)."""
    q = start
    for row in phi.tolist():
        q = product(q, from_rotation_vector(tuple(row)))
    return q


def attitude_error(found: Quaternion, true: Quaternion) -> Vector:
    """Small rotation from true to found, rad, in the reference frame."""
    return to_rotation_vector(product(found, conjugate(true)))
