"""Random vibration on top of any motion: many sinusoids with seeded frequencies and phases."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import isfinite, pi, sqrt

import numpy as np

from sculler_model.errors import InputError
from sculler_model.motion.curves import ZERO_CURVE, Curve
from sculler_model.motion.earthbound import Motion
from sculler_model.motion.turns import Turn, X, Y, Z


@dataclass(frozen=True)
class Vibration:
    """Random vibration in every body axis, angular and linear, flat over a band.

    Each axis gets its own sinusoids, one in each of equal parts of the band at a random place, of
    equal size and random phase; so the axes are incoherent, but for chance.

    Attributes:
        acceleration: root mean square of each axis, m/s².
        rate: root mean square of the angular rate about each axis, rad/s.
        low, high: the band, Hz.
        lines: sinusoids an axis and kind.
        seed: of the random numbers.
    """

    acceleration: float = 0.0
    rate: float = 0.0
    low: float = 20.0
    high: float = 200.0
    lines: int = 20
    seed: int = 1

    def __post_init__(self) -> None:
        if not (0 < self.low < self.high and isfinite(self.high)):
            raise InputError(
                f"vibration: a band from {self.low:g} to {self.high:g} Hz is not allowed, give"
                " 0 < LOW < HIGH"
            )
        if self.lines < 1:
            raise InputError(f"vibration: {self.lines} lines are not allowed, give 1 or more")

    def on(self, motion: Motion) -> Motion:
        """The motion with this vibration of its sensors."""
        generator = np.random.default_rng(self.seed)
        turns, arm = motion.turns, motion.arm or (ZERO_CURVE, ZERO_CURVE, ZERO_CURVE)
        angular = [self._waves(generator, self.rate, 1) for _ in range(3)]
        linear = [self._waves(generator, self.acceleration, 2) for _ in range(3)]
        if self.rate:
            turns += tuple(
                Turn(axis, curve) for axis, curve in zip((X, Y, Z), angular, strict=True)
            )
        if self.acceleration:
            arm = tuple(_sum(part, curve) for part, curve in zip(arm, linear, strict=True))
        return replace(motion, turns=turns, arm=arm)

    def _waves(self, generator: np.random.Generator, rms: float, order: int) -> Curve:
        """Waves whose order-th derivative has this root mean square."""
        place, phase = generator.random((2, self.lines))
        width = (self.high - self.low) / self.lines
        omega = 2 * pi * (self.low + width * (np.arange(self.lines) + place))
        size = rms * sqrt(2 / self.lines) / omega**order
        table = np.column_stack((size, omega, 2 * pi * phase)).tolist()
        return Curve(waves=tuple((a, b, c) for a, b, c in table))


def _sum(part: object, curve: Curve) -> Curve:
    if not isinstance(part, Curve):
        raise TypeError("the arm of a motion that vibrates must be made of Curves")
    return part + curve
