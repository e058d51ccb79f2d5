"""What any alignment tells of its attitude: Euler angles and standard deviations."""

from __future__ import annotations

from math import cos, sin, tan

import numpy as np
from numpy.typing import NDArray

from sculler_model.frames import Quaternion, Vector, to_euler

Array = NDArray[np.float64]


class AttitudeEstimate:
    """An attitude and how well it is known; what coarse and fine alignment have in common.

    Attributes:
        q: q_nb, body to north-east-down.
        covariance: (3, 3) of the attitude, rad², about north, east and down.
    """

    q: Quaternion
    covariance: Array

    @property
    def euler(self) -> Vector:
        """Roll, pitch, heading, rad."""
        return to_euler(self.q)

    @property
    def sigma(self) -> Vector:
        """Standard deviation about north, east and down (level, level, heading), rad."""
        return _sigmas(self.covariance)

    @property
    def euler_sigma(self) -> Vector:
        """Standard deviation of roll, pitch and heading, rad."""
        return euler_sigmas(self.q, self.covariance)

    @property
    def heading_sigma(self) -> float:
        """Standard deviation about the vertical, rad."""
        return self.sigma[2]


def euler_sigmas(q: Quaternion, covariance: Array) -> Vector:
    """Standard deviations of roll, pitch and heading (rad) at q_nb.

    Args:
        q: body to north-east-down.
        covariance: (3, 3) of the attitude about north, east and down, rad².
    """
    _, pitch, heading = to_euler(q)
    along = np.array([cos(heading), sin(heading), 0.0])
    across = np.array([-sin(heading), cos(heading), 0.0])
    down = np.array([0.0, 0.0, 1.0])
    rates = np.stack((along / cos(pitch), across, down + tan(pitch) * along))
    return _sigmas(rates @ covariance @ rates.T)


def _sigmas(covariance: Array) -> Vector:
    """Standard deviations of a (3, 3) covariance."""
    x, y, z = np.sqrt(np.diag(covariance)).tolist()
    return (x, y, z)
