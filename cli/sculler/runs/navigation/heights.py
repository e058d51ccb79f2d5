"""What a run sees of the height that it is held to."""

from __future__ import annotations

import numpy as np

from sculler.runs.navigation.plan import Plan
from sculler_model.frames import STANDARD_GRAVITY
from sculler_model.host import MajorIncrements
from sculler_model.navigation import HeightDamping, NavHistory, NavState

_LARGE_ERROR = 1e-3 * STANDARD_GRAVITY
"""Of an accelerometer, m/s²; navigation needs a better one."""

_SIGMAS = 6


class HeightWatch:
    """How far a damped height gets from its reference, and where there is none.

    Args:
        plan: the run's.
    """

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        self._strayed, self._where = 0.0, 0.0
        self._resting, self._first_rest = 0, 0.0

    def see(
        self, start: NavState, before: NavState, part: NavHistory, increments: MajorIncrements
    ) -> None:
        """The next intervals.

        Args:
            start: the run's first state.
            before: at the start of the first interval.
            part: at the ends of the intervals.
            increments: theirs.
        """
        if not len(part):
            return
        if increments.heights is None:
            away = np.abs(part.h - start.h)
            times = part.time
        else:
            reference, age = increments.heights.T
            h = np.concatenate(([before.h], part.h[:-1]))
            down = np.concatenate(([before.v[2]], part.v[:-1, 2]))
            times = np.concatenate(([before.time], part.time[:-1]))
            hold = 0.0 if self._plan.height_reference is None else self._plan.height_reference.hold
            resting = (age < 0) | (age > hold)
            away = np.where(resting, 0.0, np.abs(h + down * age - reference))
            if resting.any() and not self._resting:
                self._first_rest = float(times[np.argmax(resting)])
            self._resting += int(resting.sum())
        furthest = int(np.argmax(away))
        if away[furthest] > self._strayed:
            self._strayed, self._where = float(away[furthest]), float(times[furthest])

    def warnings(self, start: NavState) -> list[str]:
        """Where a damped height has left the height that it is held to, and where there is none."""
        seconds, reference = self._plan.carrier.height_damping, self._plan.height_reference
        if seconds is None:
            return []
        explained = HeightDamping(start.h, seconds).transient(_LARGE_ERROR)
        if reference is None:
            return [
                f"--height-damping holds the height to {start.h:.6g} m, where the run began, but it"
                f" came to be {self._strayed:.3g} m away, which no accelerometer error of 1 mg"
                f" explains ({explained:.3g} m): leave it out where the vehicle climbs or descends,"
                " or give --height-reference"
            ] * (self._strayed > explained)
        explained += _SIGMAS * reference.noise
        told = []
        if self._strayed > explained:
            told.append(
                f"the height came to be {self._strayed:.3g} m away from --height-reference at"
                f" {self._where:.6g} s, which neither an accelerometer error of 1 mg nor its noise"
                f" explains ({explained:.3g} m): see that it is above the ellipsoid and on the"
                " log's clock, and its --height-lag"
            )
        if self._resting:
            told.append(
                f"--height-reference has nothing for {self._resting} intervals"
                f" ({self._resting * self._plan.design.major_interval:.6g} s) of the run, the first"
                f" at {self._first_rest:.6g} s: the height is free there"
            )
        return told
