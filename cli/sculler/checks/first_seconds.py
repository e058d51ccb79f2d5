"""The specific force of a run's first seconds against the gravity that its initial state implies.

A start that is said to be still, and is steady, must feel gravity, upward by the given attitude.
A start under way may feel anything, so only what no manoeuvre does is told of it: a force that
stands steadily on the vertical and is half, twice or the negative of gravity.
"""

from __future__ import annotations

from math import acos, asin, atan2, degrees

import numpy as np
from numpy.typing import NDArray

from sculler_model.frames import STANDARD_GRAVITY, AxisMap, from_rotation_vector, product, rotate
from sculler_model.host import MajorIncrements
from sculler_model.navigation import NORMAL, Gravity, NavState, gravity_at

Array = NDArray[np.float64]

LONG, SHORT = 2.0, 1.0
"""Seconds that are looked at; fewer than the latter tell nothing."""

STILL = 0.5
"""m/s, a velocity up to which a start is meant to be still."""

STEADY = 0.03
"""Of gravity: how far eighths of the window may stray from its mean; a manoeuvre strays more."""

SIZE = 0.04
"""Of gravity: what no accelerometer is off, for the worst are known to 2 %."""

LEAN = 5.0
"""Degrees that a still unit's attitude may be off: it would run off with 0.9 m/s²."""

PLAIN = AxisMap.parse("x,y,z")
"""Sensor axes that are the body's."""

_PARTS = 8
_CAUSES = (
    (0.5, "the sample rate of the design is half the log's, or the accelerometer's LSB is half"),
    (2.0, "the sample rate of the design is twice the log's, or the accelerometer's LSB is twice"),
    (1 / STANDARD_GRAVITY, "the accelerometer's unit is g and was taken for m/s²"),
    (STANDARD_GRAVITY, "the accelerometer's unit is m/s² and was taken for g"),
    (0.3048, "feet were taken for metres the wrong way"),
    (1 / 0.3048, "the accelerometer's unit is feet and was taken for m"),
)


class FirstSeconds:
    """Looks at a run's first intervals; `warning` says what is odd about them.

    Args:
        state: the initial one.
        interval: length of a major interval, s.
        gravity: the model to navigate by.
        axes: how the sensor's axes became the body's.
    """

    def __init__(
        self, state: NavState, interval: float, gravity: Gravity = NORMAL, axes: AxisMap = PLAIN
    ) -> None:
        self._state, self._interval, self._axes = state, interval, axes
        self._gravity = gravity_at(gravity, _sine(state.lat), state.h)[1]
        self._wanted = max(1, round(LONG / interval))
        self._parts: list[MajorIncrements] = []

    def see(self, increments: MajorIncrements) -> None:
        """Take the next intervals, in body axes."""
        missing = self._wanted - sum(map(len, self._parts))
        if missing > 0:
            self._parts.append(increments[:missing])

    @property
    def warning(self) -> str | None:
        """What to look at before trusting the run; None if nothing is odd."""
        count = sum(map(len, self._parts))
        if count < _PARTS or count * self._interval < SHORT:
            return None
        forces = self._forces()
        mean = forces.mean(axis=0)
        strays = [np.linalg.norm(p.mean(axis=0) - mean) for p in np.array_split(forces, _PARTS)]
        g, size = self._gravity, float(np.linalg.norm(mean))
        if max(strays) > STEADY * g or size == 0:
            return None
        from_up = degrees(acos(min(1.0, max(-1.0, -float(mean[2]) / size))))
        still = max(map(abs, self._state.v)) <= STILL
        vertical = min(from_up, 180 - from_up) < LEAN
        if abs(size / g - 1) > SIZE:
            cause = _cause(size / g)
            if still or (vertical and cause in [words for _, words in _CAUSES[:2]]):
                return self._wrong_size(size, cause)
            return None
        if from_up > 180 - LEAN or (still and from_up > LEAN):
            return self._wrong_way(mean, from_up)
        return None

    def _forces(self) -> Array:
        """(R, 3) specific force, m/s², in the initial north-east-down, the gyros at their word."""
        window = MajorIncrements.concatenate(self._parts)
        q, forces = self._state.q, []
        for phi, dv in zip(window.phi.tolist(), window.dv_sf.tolist(), strict=True):
            forces.append(rotate(q, (dv[0], dv[1], dv[2])))
            q = product(q, from_rotation_vector((phi[0], phi[1], phi[2])))
        return np.array(forces) / self._interval

    def _wrong_size(self, size: float, cause: str) -> str:
        return (
            f"specific force in the first seconds is {size:.4g} m/s², but gravity"
            f" {self._gravity:.4g} ({size / self._gravity:.3g} of it): {cause}"
        )

    def _wrong_way(self, mean: Array, from_up: float) -> str:
        told = f"specific force in the first seconds points {from_up:.0f}° from up"
        if from_up > 180 - LEAN:
            advice = "check --axes, --roll and --pitch"
            if self._axes == PLAIN:
                advice = "try --axes x,-y,-z (forward, left, up) or y,x,-z (right, forward, up)"
            return f"{told} by the initial attitude: the unit's z points up; {advice}"
        body = self._parts[0].dv_sf.sum(axis=0)
        x, y, z = (body / np.linalg.norm(body)).tolist()
        roll, pitch = degrees(atan2(-y, -z)), degrees(asin(min(1.0, max(-1.0, x))))
        return (
            f"{told} by the initial attitude; a unit that stands still has roll {roll:.1f}°, pitch"
            f" {pitch:.1f}° by it: check --axes, --roll and --pitch (or --align)"
        )


def _cause(ratio: float) -> str:
    """Why the force might be this many times gravity."""
    for known, words in _CAUSES:
        if abs(ratio / known - 1) < SIZE:
            return words
    return "check the accelerometer's LSB and unit, and the sample rate"


def _sine(angle: float) -> float:
    return float(np.sin(angle))
