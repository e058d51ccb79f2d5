"""A motion as sensors feel it that are not all in one place, or not all at one time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sculler_model.design import Design
from sculler_model.motion.curves import ZERO_CURVE, Array, Curve
from sculler_model.motion.earthbound import Motion
from sculler_model.motion.sampling import Sampled


@dataclass(frozen=True)
class Placed(Sampled):
    """What gyros and three accelerometers feel of a motion.

    Attributes:
        motion: of the point that is navigated.
        arms: from it to the x, the y and the z accelerometer, body axes, m; empty for none.
        delay: s by which the accelerometers see later than the gyros.
    """

    motion: Motion
    arms: Sequence[Sequence[float]] = ()
    delay: float = 0.0

    def sensed(self, t: Array) -> Array:
        """What the sensors feel at times t (N,), as `Motion.sensed`."""
        late = t - self.delay
        if not self.arms:
            if not self.delay:
                return self.motion.sensed(t)
            return np.hstack((self.motion.sensed(t)[:, :3], self.motion.sensed(late)[:, 3:]))
        felt = np.empty((len(t), 6))
        felt[:, :3] = self.motion.sensed(t)[:, :3]
        for axis, arm in enumerate(self.arms):
            there = replace(self.motion, arm=_moved(self.motion, arm))
            felt[:, 3 + axis] = there.sensed(late)[:, 3 + axis]
        return felt

    @property
    def highest(self) -> float:
        """A bound on the frequencies (rad/s) that matter."""
        return self.motion.highest

    @property
    def rough(self) -> float:
        """The same of the curves that have knots."""
        return self.motion.rough


def as_felt(motion: Motion, design: Design) -> Motion | Placed:
    """The motion as the design's sensors feel it, each in its place and at its time."""
    errors = design.sensor.errors
    if errors is None or not (errors.arms_m or errors.delay_samples):
        return motion
    delay = (errors.delay_samples or 0.0) * design.sample_interval
    return Placed(motion, errors.arms_m or (), delay)


def _moved(motion: Motion, by: Sequence[float]) -> tuple[Curve, Curve, Curve]:
    """The motion's arm, and more of it."""
    arm = motion.arm or (ZERO_CURVE, ZERO_CURVE, ZERO_CURVE)
    parts = []
    for part, more in zip(arm, by, strict=True):
        if not isinstance(part, Curve):
            raise TypeError("the arm of a motion must be made of Curves")
        parts.append(part + Curve((more,)))
    return parts[0], parts[1], parts[2]
