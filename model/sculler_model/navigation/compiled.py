"""The wander azimuth over whole arrays, compiled by Numba (the extra `fast`).

The very functions of `wander`, `rotation`, `earth` and `gravity` are compiled, so there is one
algorithm and the results equal those of the interpreter to rounding.  Without Numba the navigator
goes on in Python: the same numbers, some hundred times more slowly.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sculler_model.errors import InputError
from sculler_model.frames import earth, rotation
from sculler_model.machine_code import callable_when_compiled, compiled
from sculler_model.navigation import gravity, wander
from sculler_model.navigation.gravity import Gravity, GravityTable, covers
from sculler_model.navigation.wander import (
    Settings,
    geographic,
    level_of,
    numbers_of,
    step,
)

Array = NDArray[np.float64]

CompiledRun: TypeAlias = Callable[
    [Array, Array, float | None, GravityTable | None, Array, Array, Array, Array, Array], int
]


_LOOSE = {"nsz"}
"""A sum with 0 may be left out: all that it changes is the sign of a zero."""


@cache
def compiled_run() -> CompiledRun | None:
    """What carries a state over many intervals at machine speed; None where Numba is missing.

    It takes the state (`numbers_of`), which it changes, and the settings (interval, position every,
    three of damping, 1 for free azimuth), the two parts of a `Gravity`, φ, ΔV_SF and ΔR_SF, (R, 3)
    each (the last one (0, 3) where it is not used), the heights to hold to, (R, 2) or one row for
    all, and an (R, 11) table that it fills with q_nb, v, lat, lon, h, wander at the interval ends.
    It returns how many intervals it got through: fewer than R if the track left the places that
    `gravity.covers`.  A call takes half a microsecond and no more than arrays, so that it serves
    single updates too.

    Compiling takes some seconds at the very first call and is kept on disk from then on.
    """
    modules = (earth, gravity, rotation, wander)
    try:
        callable_when_compiled(*modules, forceinline=True, fastmath=_LOOSE)
    except ImportError:
        return None

    def loop(
        carried: Array,
        constants: Array,
        value: float | None,
        points: GravityTable | None,
        phi: Array,
        dv_sf: Array,
        dr_sf: Array,
        heights: Array,
        table: Array,
    ) -> int:
        model, fine = Gravity(value, points), len(dr_sf) > 0
        damping = (constants[2], constants[3], constants[4])
        free = constants[5] > 0
        settings = Settings(constants[0], int(constants[1]), fine, damping, model, free)
        now = level_of(carried)
        dr, done, one_for_all = (0.0, 0.0, 0.0), len(phi), len(heights) == 1
        for i in range(len(phi)):
            if fine:
                dr = (dr_sf[i, 0], dr_sf[i, 1], dr_sf[i, 2])
            at = 0 if one_for_all else i
            now = step(
                now,
                settings,
                (phi[i, 0], phi[i, 1], phi[i, 2]),
                (dv_sf[i, 0], dv_sf[i, 1], dv_sf[i, 2]),
                dr,
                (heights[at, 0], heights[at, 1]),
            )
            q, v, lat, lon, h, angle = geographic(now)
            row = table[i]
            row[0], row[1], row[2], row[3] = q
            row[4], row[5], row[6] = v
            row[7], row[8], row[9], row[10] = lat, lon, h, angle
            if not covers(model, lat, h):
                done = i
                break
        numbers = numbers_of(now)
        for k in range(len(numbers)):
            carried[k] = numbers[k]
        return done

    run: CompiledRun = compiled(loop, *modules, error_model="numpy", fastmath=_LOOSE)
    return run


def required_run() -> CompiledRun:
    """`compiled_run`, which must be there.

    Raises:
        InputError: Numba is missing.
    """
    run = compiled_run()
    if run is None:
        raise InputError("compiled navigation needs Numba: install sculler[fast]")
    return run
