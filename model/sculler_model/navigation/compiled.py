"""The wander azimuth over whole arrays, compiled by Numba (the extra `fast`).

The very functions of `wander`, `rotation`, `earth` and `gravity` are compiled, so there is one
algorithm and the results equal those of the interpreter to rounding.  Without Numba the navigator
goes on in Python: the same numbers, some hundred times more slowly.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from hashlib import sha256
from inspect import getsource
from types import FunctionType
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sculler_model.frames import earth, rotation
from sculler_model.navigation import gravity, wander
from sculler_model.navigation.gravity import covers
from sculler_model.navigation.wander import Level, Settings, geographic, step

Array = NDArray[np.float64]

CompiledRun: TypeAlias = Callable[[Level, Settings, Array, Array, Array, Array], tuple[Level, int]]


@cache
def compiled_run() -> CompiledRun | None:
    """What carries a state over many intervals at machine speed; None where Numba is missing.

    It takes the state, the settings, φ, ΔV_SF and ΔR_SF, (R, 3) each (the last one (0, 3) where it
    is not used), and an (R, 11) table that it fills with q_nb, v, lat, lon, h, wander at the
    interval ends.  It returns the state at the end and how many intervals it got through: fewer
    than R if the track left the places that `gravity.covers`.

    Compiling takes some seconds at the very first call and is kept on disk from then on.
    """
    try:
        from numba import njit
        from numba.extending import register_jitable
    except ImportError:
        return None
    modules = (earth, gravity, rotation, wander)
    for module in modules:
        for function in vars(module).values():
            if isinstance(function, FunctionType) and function.__module__ == module.__name__:
                register_jitable(function)
    # Numba sees only a change of this file, and cannot read what it kept of types that are gone:
    # with the others' text in its name the compiled code has a file of its own
    key = sha256("".join(map(getsource, modules)).encode()).hexdigest()

    def loop(
        now: Level, settings: Settings, phi: Array, dv_sf: Array, dr_sf: Array, table: Array
    ) -> tuple[Level, int]:
        dr = (0.0, 0.0, 0.0)
        for i in range(len(phi)):
            if settings.high_resolution:
                dr = (dr_sf[i, 0], dr_sf[i, 1], dr_sf[i, 2])
            now = step(
                now,
                settings,
                (phi[i, 0], phi[i, 1], phi[i, 2]),
                (dv_sf[i, 0], dv_sf[i, 1], dv_sf[i, 2]),
                dr,
            )
            q, v, lat, lon, h, angle = geographic(now)
            if not covers(settings.gravity, lat, h):
                return now, i
            row = table[i]
            row[0], row[1], row[2], row[3] = q
            row[4], row[5], row[6] = v
            row[7], row[8], row[9], row[10] = lat, lon, h, angle
        return now, len(phi)

    loop.__qualname__ = f"loop_{key[:16]}"
    try:
        run: CompiledRun = njit(cache=True)(loop)
    except RuntimeError:  # there is nowhere to keep it: compiled anew in every process
        run = njit()(loop)
    return run
