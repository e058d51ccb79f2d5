"""The float low-rate updater: attitude, velocity and position once a major interval.

Frames: body b is x forward, y right, z down; navigation n is north, east, down at the present
geodetic position on WGS-84; q_nb takes body components to navigation components.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from math import isfinite
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from sculler_model.errors import InputError
from sculler_model.frames import Vector, to_dcm
from sculler_model.host import MajorIncrements
from sculler_model.navigation.compiled import CompiledRun, compiled_run, required_run
from sculler_model.navigation.gravity import NORMAL, Gravity, refuse_outside
from sculler_model.navigation.height import HeightDamping, HeightKeeper, Held
from sculler_model.navigation.state import (
    NavHistory,
    NavState,
    VectorLike,
    check_state,
    three_numbers,
    told_times,
)
from sculler_model.navigation.stepping import Alternative, Compiled, Interpreted, Row, Stepping
from sculler_model.navigation.wander import NOT_YET, Settings, level, position, step, with_past

__all__ = [
    "Mechanisation",
    "NavHistory",
    "NavState",
    "Navigator",
    "navigate",
    "trajectory",
]

Array = NDArray[np.float64]

WORTH_COMPILING = 10_000
"""Major intervals that take Python longer than Numba takes to be loaded."""


class Mechanisation(Protocol):
    """Anything that carries a `NavState` over major intervals.

    `Navigator` is the wander azimuth, `GeographicNavigator` points north; `navigate` and
    `trajectory` take any other.
    """

    @property
    def state(self) -> NavState:
        """The state at the end of the last major interval."""

    def run(self, increments: MajorIncrements) -> NavHistory:
        """Carry the state over consecutive major intervals; the states at their ends."""


class Navigator:
    """Wander-azimuth mechanisation after Savage-98 Table 1; works anywhere, the poles included.

    One result at a time with `update`, or whole arrays with `run`.  Both are the arithmetic of
    `wander.step`, in the same order, and may be mixed: compiled they agree to the last bit.

    Args:
        state: at the start of the first interval; its wander angle is kept.
        interval: length of a major interval, s.
        position_every: j: position, gravity, Earth rate and curvature are worked out every j-th
            interval and extrapolated in between (Savage-98 Eq. 9, 19).
        height_damping: a loop that holds the height; none if left out.
        gravity: the model to navigate by.
        compiled: True takes every update through Numba, which is loaded at once (compiled at the
            very first time), so that nothing stops in flight; False none.  If left out, `update`
            is Python's, and `run` is compiled where it is worth it.
        azimuth: "wander", w does not turn about the vertical over the Earth, or "free", it does not
            against the stars.
        attitude: carried as a "quaternion" or as "cosines", the direction cosine matrix (Savage-20
            Eq. 1); the same to rounding.
        level_every: major intervals from one turn of the frame w to the next, in between to first
            order (Savage-98 Eq. 11-14): an alternative of his Table 1, to see what it costs.

    Cosines and level_every > 1 are for Python, never compiled.

    Raises:
        InputError: the state is not one to navigate from (see `check_state`), is outside a gravity
            table, an argument is out of its range, or `compiled` is asked for without Numba.

    Examples:
        >>> import sculler
        >>> north = (1.0, 0.0, 0.0, 0.0)
        >>> start = sculler.NavState(0.0, north, (10.0, 0.0, 0.0), 0.8, 0.2, 500.0)
        >>> navigator = sculler.Navigator(start, interval=0.01)
        >>> after = navigator.update(phi=(0.0, 0.0, 0.0), dv_sf=(0.0, 0.0, -0.0981))
        >>> after.time, bool(after.lat > start.lat)
        (0.01, True)
    """

    def __init__(
        self,
        state: NavState,
        interval: float,
        *,
        position_every: int = 1,
        height_damping: HeightDamping | None = None,
        gravity: Gravity = NORMAL,
        compiled: bool | None = None,
        azimuth: Literal["wander", "free"] = "wander",
        attitude: Literal["quaternion", "cosines"] = "quaternion",
        level_every: int = 1,
    ) -> None:
        check_state(state)
        refuse_outside(gravity, state.time, state.lat, state.h)
        if not (isfinite(interval) and interval > 0):
            raise InputError(f"interval: {interval} s is not allowed, give a number > 0")
        if position_every < 1 or position_every != int(position_every):
            raise InputError(
                f"position every {position_every} intervals is not allowed, give 1 or more"
            )
        if level_every < 1 or level_every != int(level_every):
            raise InputError(f"level every {level_every} intervals is not allowed, give 1 or more")
        if azimuth not in ("wander", "free") or attitude not in ("quaternion", "cosines"):
            raise InputError(
                f"azimuth {azimuth!r}, attitude {attitude!r}: give wander or free, and quaternion"
                " or cosines"
            )
        plain = attitude == "quaternion" and level_every == 1
        if compiled and not plain:
            raise InputError("compiled: not with cosines or level_every, leave it out")
        if height_damping:
            height_damping.fits(interval)
        damping = height_damping.gains if height_damping else (0.0, 0.0, 0.0)
        self._keeper = HeightKeeper(height_damping, interval)
        free = azimuth == "free"
        self._settings = Settings(interval, int(position_every), False, damping, gravity, free)
        now = level(state.q, state.v, state.lat, state.lon, state.h, state.wander, gravity)
        self._stepping: Stepping
        if compiled:
            self._stepping = Compiled(required_run(), now, self._settings)
        elif plain:
            self._stepping = Interpreted(now, self._settings)
        else:
            cosines = attitude == "cosines"
            self._stepping = Alternative(now, self._settings, cosines, level_every)
        self._compiled, self._state, self._updates = compiled, state, 0
        # the time counts from `_start` on, by intervals, or in `_told` it says itself
        self._start, self._since = state.time, 0
        self._told: Array | None = None

    @property
    def state(self) -> NavState:
        """The state at the end of the last major interval."""
        return self._state

    @property
    def position_dcm(self) -> tuple[Vector, Vector, Vector]:
        """Rows of C_ew at the end of the last major interval (Savage-98 Eq. 68, his C_N^E).

        It takes components in the wander-azimuth frame w (x at the wander angle from north, z
        down) to the Earth's (x through latitude and longitude 0, z through the north pole).
        """
        return to_dcm(position(self._stepping.level)[0])

    def update(
        self,
        phi: VectorLike,
        dv_sf: VectorLike,
        dr_sf: VectorLike | None = None,
        *,
        height: float | None = None,
        height_age: float = 0.0,
    ) -> NavState:
        """Carry the state over one major interval; each vector a tuple, list or (3,) array.

        A result of short history (status bit 0) is not for this: begin after it, with the state
        at its end.

        Args:
            phi: rotation vector of the body over the interval, against inertial space, rad.
            dv_sf: ΔV_SF, integral of the specific force (m/s) in the body frame at the START of
                the interval, held fixed in inertial space.
            dr_sf: ΔR_SF, the running integral of that over the interval (m), same frame: the
                position is then of high resolution (see `host.displacement`).
                Without it the velocity is integrated by the trapezoid.
            height: m above the ellipsoid, measured since the last update, for the height damping;
                None where nothing was: it then holds to the last one, up to the age of
                `HeightDamping.hold`.
            height_age: s, from the instant it stands for to the interval's start.

        Returns:
            The state at the interval's end.

        Raises:
            InputError: an argument is not three finite numbers, the height has run away, the
                gravity table ends, or a height comes without height damping.
        """
        turn, dv = three_numbers("phi", phi), three_numbers("dv_sf", dv_sf)
        dr = None if dr_sf is None else three_numbers("dr_sf", dr_sf)
        if height is not None:
            self._keeper.measured(height, height_age)
        self._end_of_told_times()
        state = self._update(turn, dv, dr, self._keeper.held)
        self._keeper.passed()
        return state

    def _update(self, phi: Vector, dv_sf: Vector, dr_sf: Vector | None, held: Held) -> NavState:
        if not isfinite(sum(phi) + sum(dv_sf) + sum(dr_sf or NOT_YET)):
            raise self._not_finite()
        if not self._updates:
            self._see_to_the_past(phi, dv_sf, dr_sf, held)
        row, holds = self._stepping.update(phi, dv_sf, dr_sf, held)
        self._moved(1, row)
        if not holds:
            self._left_gravity()
        return self._state

    def _moved(self, intervals: int, row: Row) -> None:
        """The state is so many intervals further, as the row tells."""
        self._updates += intervals
        self._since += intervals
        w, x, y, z, north, east, down, lat, lon, h, wander = row
        self._state = NavState(self._time, (w, x, y, z), (north, east, down), lat, lon, h, wander)

    def run(self, increments: MajorIncrements, *, compiled: bool | None = None) -> NavHistory:
        """Carry the state over consecutive major intervals.

        Args:
            increments: φ, ΔV_SF and, for a position of high resolution, ΔR_SF of R intervals, as
                for `update`; where they have times, the states do; heights to hold to, where they
                have them.
            compiled: whether to go through Numba; if left out, as the navigator was made, else
                where it is installed and there are `WORTH_COMPILING` intervals up to now.

        Returns:
            The states at the R interval ends.

        Raises:
            InputError: an interval is of short history, an increment is not finite or missing, the
                height has run away, the gravity table ends, or `compiled` is asked for without
                Numba.
        """
        increments.require_whole("navigation")
        vectors = (increments.phi, increments.dv_sf, increments.dr_sf)
        arrays = [np.asarray(array, np.float64) for array in vectors if array is not None]
        if any(array.shape != (len(increments), 3) for array in arrays):
            shapes = ", ".join(str(array.shape) for array in arrays)
            raise InputError(f"increments: shapes {shapes} differ, give (R, 3) each")
        if not all(np.isfinite(array).all() for array in arrays):
            raise self._not_finite()
        self._end_of_told_times()
        if increments.times is not None and len(increments):
            self._start, self._since = self.state.time, 0
            self._told = told_times(increments)
        heights = self._keeper.told(increments.heights, len(increments))
        run = self._run_to_take(len(increments), compiled)
        if run is None or not len(increments):
            return self._interpreted(arrays, heights)

        # Numba would compile anew for arrays of another kind
        phi, dv, *more = (np.require(array, requirements=["C", "W"]) for array in arrays)
        dr = more[0] if more else None
        if not self._updates:
            first = (_first(phi), _first(dv), None if dr is None else _first(dr))
            self._see_to_the_past(*first, (float(heights[0, 0]), float(heights[0, 1])))
        stepping = self._stepping
        if not isinstance(stepping, Compiled):
            stepping = Compiled(run, stepping.level, self._settings)
        table = np.empty((len(phi), 11))
        done = stepping.run(phi, dv, dr, heights, table)
        self._stepping.level = stepping.level
        times = self._told
        if times is None:
            numbers = self._since + np.arange(1.0, len(phi) + 1)
            times = self._start + numbers * self._settings.interval
        carried = min(len(phi), done + 1)
        self._moved(carried, table[carried - 1].tolist())
        if done < len(phi):
            self._left_gravity()
        return NavHistory.from_table(times, table)

    def _interpreted(self, arrays: Sequence[Array], heights: Array) -> NavHistory:
        """`run` in Python."""
        kept = self._stepping
        if isinstance(kept, Compiled):
            self._stepping = Interpreted(kept.level, self._settings)
        try:
            rows = zip(*(map(tuple, array.tolist()) for array in arrays), strict=True)
            held = map(tuple, np.broadcast_to(heights, (len(arrays[0]), 2)).tolist())
            states = [
                self._update(phi, dv, dr[0] if dr else None, height)
                for (phi, dv, *dr), height in zip(rows, held, strict=True)
            ]
            return NavHistory.from_states(states)
        finally:
            if self._stepping is not kept:
                kept.level = self._stepping.level
                self._stepping = kept

    def _run_to_take(self, intervals: int, compiled: bool | None) -> CompiledRun | None:
        """Compiled code for so many intervals more; None for Python's own."""
        if isinstance(self._stepping, Alternative):
            if compiled:
                raise InputError("compiled: not with cosines or level_every, leave it out")
            return None
        if compiled is None:
            compiled = self._compiled
        if compiled is None:
            return compiled_run() if self._updates + intervals >= WORTH_COMPILING else None
        return required_run() if compiled else None

    @property
    def _time(self) -> float:
        """At the end of the last major interval, s."""
        if self._told is not None and self._since:
            return float(self._told[self._since - 1])
        return self._start + self._since * self._settings.interval

    def _end_of_told_times(self) -> None:
        """From here on intervals are counted from the last one whose instant was told."""
        if self._told is not None:
            self._start, self._since, self._told = self._time, 0, None

    def _see_to_the_past(
        self, phi: Vector, dv_sf: Vector, dr_sf: Vector | None, held: Held
    ) -> None:
        """Before the first interval: the past that the extrapolations need."""
        settings = self._settings._replace(high_resolution=dr_sf is not None)
        now = self._stepping.level
        after = step(now, settings, phi, dv_sf, dr_sf or NOT_YET, held)
        self._stepping.level = with_past(now, after, settings)

    def _not_finite(self) -> InputError:
        return InputError(
            f"after {self.state.time:.3f} s: an increment is not finite, mend the vectors"
        )

    def _left_gravity(self) -> None:
        """Say where the track left what the model of gravity holds for."""
        refuse_outside(self._settings.gravity, self.state.time, self.state.lat, self.state.h)


def _first(vectors: Array) -> Vector:
    """The first of (R, 3)."""
    x, y, z = vectors[0].tolist()
    return (x, y, z)


def trajectory(
    mechanisation: Mechanisation, increments: Iterable[MajorIncrements]
) -> Iterator[NavHistory]:
    """States at the end of every major interval, one `NavHistory` for each block of increments.

    Memory holds one block at a time, so a day-long log runs in as little as a short one.

    Args:
        mechanisation: what carries the state; it stands at the start of the first interval.
        increments: consecutive blocks, in body axes.

    Yields:
        (R,) states of each block of R intervals.

    Raises:
        InputError: an interval is of short history, an increment is not finite, or the
            mechanisation cannot follow the track.
    """
    for block in increments:
        block.require_whole("navigation")
        arrays = (block.phi, block.dv_sf, block.dr_sf)
        if not all(np.isfinite(array).all() for array in arrays if array is not None):
            raise InputError(
                f"after {mechanisation.state.time:.3f} s: an increment is not finite, mend the"
                " vectors"
            )
        yield mechanisation.run(block)


def navigate(
    initial: NavState,
    interval: float,
    increments: MajorIncrements | Iterable[MajorIncrements],
    mechanisation: Callable[[NavState, float], Mechanisation] = Navigator,
) -> NavHistory:
    """The whole track: the initial state, then the state at the end of every major interval.

    Args:
        initial: state at the start of the first interval, which must not be of short history
            (`MajorIncrements.leading_short`): leave those out, and give the state at their end.
        interval: length of a major interval, s.
        increments: in body axes; one block or several in order.  With ΔR_SF in them a mechanisation
            that can, `Navigator`, takes the position from it.
        mechanisation: what carries the state.

    Returns:
        (R + 1) states for R intervals, north-east-down and geodetic whatever the mechanisation.

    Raises:
        InputError: see `check_state` and `trajectory`.
    """
    blocks = [increments] if isinstance(increments, MajorIncrements) else increments
    parts = trajectory(mechanisation(initial, interval), blocks)
    return NavHistory.concatenate([NavHistory.from_states([initial]), *parts])
