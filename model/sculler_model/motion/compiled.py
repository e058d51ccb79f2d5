"""The arithmetic of motions over many instants, and the means over panels, compiled by Numba.

The very functions of `kinematics`, `frames.rotation` and `frames.earth` are compiled, so that there
is one algorithm.  No operation is joined with another, so every number is that of numpy, to the
last bit; what is saved is numpy's way through the memory at each operation.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sculler_model.frames import earth, rotation
from sculler_model.machine_code import callable_when_compiled, compiled
from sculler_model.motion import kinematics
from sculler_model.motion.kinematics import felt, seen, turned

Array = NDArray[np.float64]

WORTH_LOADING = 600_000
"""Instants that numpy takes as long for as Numba takes to be loaded."""


class Loops(NamedTuple):
    """Loops over instants; arrays of an instant's numbers have a row each.

    Attributes:
        turn: change an attitude (10, N), quaternion, rate and its derivative, as `turned` does by
            the three parts of a turn's jet.
        see: fill in (9, N) with what `seen` gives.
        feel: fill in (N, 6) with what `felt` gives.
        mean: fill in (panels, parts, 6) with the sum of weights (n, parts) times values
            (n, panels, 6).
    """

    turn: Callable[..., None]
    see: Callable[..., None]
    feel: Callable[..., None]
    mean: Callable[[Array, Array, Array], None]


_asked = 0


def loops(instants: int, dtype: np.dtype[Any]) -> Loops | None:
    """The loops, compiled, once that is worth it; None before, and where Numba is missing.

    Loading Numba takes half a second.  So it is loaded when numpy has worked as long.

    Args:
        instants: that are to be worked out now.
        dtype: of their numbers; those longer than doubles are left to numpy.
    """
    global _asked
    if dtype != np.float64:
        return None
    _asked += instants
    return _compiled() if _asked > WORTH_LOADING else None


@cache
def _compiled() -> Loops | None:
    modules = (earth, rotation, kinematics)
    try:
        callable_when_compiled(*modules)
        turn, see, feel = (compiled(each, *modules, nogil=True) for each in (_turn, _see, _feel))
        return Loops(turn, see, feel, compiled(_mean, nogil=True))
    except ImportError:
        return None


def _turn(attitude: Array, step: Any, own: Any, gain: Any) -> None:
    for i in range(attitude.shape[1]):
        a = attitude[:, i]
        before = (a[0], a[1], a[2], a[3]), (a[4], a[5], a[6]), (a[7], a[8], a[9])
        turn = (
            (step[0][i], step[1][i], step[2][i], step[3][i]),
            (own[0][i], own[1][i], own[2][i]),
            (gain[0][i], gain[1][i], gain[2][i]),
        )
        q, rate, change = turned(before, turn)
        a[0], a[1], a[2], a[3] = q
        a[4], a[5], a[6] = rate
        a[7], a[8], a[9] = change


def _see(arm: Any, q: Any, rate: Any, change: Any, found: Array) -> None:
    x, y, z = arm
    for i in range(len(q[0])):
        row = found[:, i]
        north, east, down = seen(
            (
                (x[0][i], x[1][i], x[2][i]),
                (y[0][i], y[1][i], y[2][i]),
                (z[0][i], z[1][i], z[2][i]),
            ),
            (q[0][i], q[1][i], q[2][i], q[3][i]),
            (rate[0][i], rate[1][i], rate[2][i]),
            (change[0][i], change[1][i], change[2][i]),
        )
        row[0], row[1], row[2] = north
        row[3], row[4], row[5] = east
        row[6], row[7], row[8] = down


def _feel(
    q: Any, rate: Any, lat: Any, lon: Any, h: Any, sines: Any, axis: Any, found: Array
) -> None:
    for i in range(len(q[0])):
        row = found[i]
        turning, force = felt(
            (q[0][i], q[1][i], q[2][i], q[3][i]),
            (rate[0][i], rate[1][i], rate[2][i]),
            (lat[0][i], lat[1][i], lat[2][i]),
            (lon[0][i], lon[1][i], lon[2][i]),
            (h[0][i], h[1][i], h[2][i]),
            (sines[0][i], sines[1][i], sines[2][i], sines[3][i]),
            axis,
        )
        row[0], row[1], row[2] = turning
        row[3], row[4], row[5] = force


def _mean(weights: Array, values: Array, found: Array) -> None:
    nodes, parts = weights.shape
    total = np.empty((6, parts))
    for panel in range(values.shape[1]):
        total[:] = 0.0
        for node in range(nodes):
            for column in range(6):
                value = values[node, panel, column]
                for part in range(parts):
                    total[column, part] += weights[node, part] * value
        for part in range(parts):
            for column in range(6):
                found[panel, part, column] = total[column, part]
