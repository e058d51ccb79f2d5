"""What the first seconds of a log say of its units and axes: gravity's size and direction."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sculler_model.design import Design
from sculler_model.frames import STANDARD_GRAVITY

_SECONDS = 2.0  # looked at
_STEADY = 0.1  # of gravity: standard deviation of a log that begins without manoeuvres
_OFF = 0.04  # of gravity: more than sensors and places differ
_TURNING = 0.02  # rad/s: mean rate in which a vehicle's turn adds to gravity
_OFF_TURNING = 0.2
_UP = 0.5  # of the force along +z
_CAUSES = (
    (0.5, "half of it: is the sample rate twice the true one, or the scale half of it?"),
    (2.0, "twice it: is the sample rate half the true one, or the scale twice it?"),
    (1 / STANDARD_GRAVITY, "m/s² taken for g?"),
    (0.3048, "feet taken for metres?"),
    (1 / 0.3048, "metres taken for feet?"),
)


class LogBeginning:
    """Mean specific force and rate over the first seconds.

    Args:
        design: gives kind and rate.
    """

    def __init__(self, design: Design) -> None:
        self._over = design.sample_interval if design.sensor.kind == "increment" else 1.0
        self._wanted = max(round(_SECONDS * design.sensor.sample_rate_hz), 4)
        self._samples: list[NDArray[np.float64]] = []
        self._count = 0

    def __call__(self, si: NDArray[np.float64]) -> None:
        """Take the next samples (N, 6), SI units of the design's kind, in the log's axes."""
        if self._count < self._wanted and len(si):
            self._samples.append(si[: self._wanted - self._count] / self._over)
            self._count += len(self._samples[-1])

    def _means(self) -> tuple[float, NDArray[np.float64]]:
        """Size of the mean rate, and mean force; zeros if the log does not begin steadily."""
        if self._count < 4:
            return 0.0, np.zeros(3)
        samples = np.concatenate(self._samples)
        if samples[:, 3:].std(axis=0).max() > _STEADY * STANDARD_GRAVITY:
            return 0.0, np.zeros(3)
        return float(np.linalg.norm(samples[:, :3].mean(axis=0))), samples[:, 3:].mean(axis=0)

    def size_hint(self) -> str | None:
        """What looks wrong of the force's size."""
        rate, force = self._means()
        size = float(np.linalg.norm(force))
        allowed = _OFF if rate < _TURNING else _OFF_TURNING
        if not size or abs(size / STANDARD_GRAVITY - 1) <= allowed:
            return None
        cause = next(
            (told for ratio, told in _CAUSES if abs(size / STANDARD_GRAVITY / ratio - 1) < 0.03),
            "check the accelerometer's unit and scale, and the sample rate",
        )
        return (
            f"the specific force at the beginning is {size:.4g} m/s², gravity is 9.8 m/s²: {cause}"
        )

    def hints(self) -> list[str]:
        """What looks wrong; nothing if the log does not begin steadily."""
        size_hint = self.size_hint()
        hints = [] if size_hint is None else [size_hint]
        _, force = self._means()
        size = float(np.linalg.norm(force))
        if size and force[2] > _UP * size:
            hints.append(
                f"the specific force at the beginning is {force[2]:+.4g} m/s² along z, which is to"
                f" point down (at rest: -9.8): do the file's axes point forward, left, up (--axes"
                " FLU), right, forward, up (--axes RFU), or does the unit give acceleration with"
                " gravity's sign (--accel-columns -ax,-ay,-az)? (navigate --axes turns them later)"
            )
        return hints
