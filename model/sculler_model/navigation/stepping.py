"""A state on its way from interval to interval: in plain Python, or in compiled code.

Both are the arithmetic of `wander`, and tell what is at an interval's end as a `Row`.
"""

from __future__ import annotations

from collections.abc import Sequence
from struct import Struct
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from sculler_model.frames import Vector
from sculler_model.navigation.compiled import CompiledRun
from sculler_model.navigation.gravity import covers
from sculler_model.navigation.height import RESTING, Held
from sculler_model.navigation.wander import (
    NOT_YET,
    Level,
    Settings,
    geographic,
    level_of,
    numbers_of,
    step,
)

Array = NDArray[np.float64]

Row = Sequence[float]
"""q_nb, v, lat, lon, h, wander at the end of an interval: 11 numbers."""


class Stepping(Protocol):
    """What carries a state."""

    level: Level

    def update(
        self, phi: Vector, dv_sf: Vector, dr_sf: Vector | None, held: Held
    ) -> tuple[Row, bool]:
        """Carry it over one interval, with ΔR_SF in high resolution, held to a height.

        Returns:
            What is at its end, and whether the model of gravity holds there.
        """


class Interpreted:
    """A state that Python carries.

    Args:
        level: the state.
        settings: `high_resolution` is settled anew with every update.
    """

    def __init__(self, level: Level, settings: Settings) -> None:
        self.level = level
        self._coarse = settings._replace(high_resolution=False)
        self._fine = settings._replace(high_resolution=True)

    def update(
        self, phi: Vector, dv_sf: Vector, dr_sf: Vector | None, held: Held
    ) -> tuple[Row, bool]:
        """See `Stepping.update`."""
        settings, dr = (self._coarse, NOT_YET) if dr_sf is None else (self._fine, dr_sf)
        self.level = step(self.level, settings, phi, dv_sf, dr, held)
        q, v, lat, lon, h, wander = geographic(self.level)
        return (*q, *v, lat, lon, h, wander), covers(settings.gravity, lat, h)


_SIX, _NINE = Struct("6d"), Struct("9d")


class Compiled:
    """A state that compiled code carries; it lies in an array, and so does what an update takes.

    Args:
        run: `compiled_run`.
        level: the state.
        settings: `high_resolution` is settled anew with every update.
    """

    def __init__(self, run: CompiledRun, level: Level, settings: Settings) -> None:
        self._run = run
        self._carried = np.array(numbers_of(level))
        self._constants = np.array(
            (settings.interval, settings.position_every, *settings.damping), np.float64
        )
        self._gravity = settings.gravity.value, settings.gravity.table
        vectors, table = np.zeros((3, 1, 3)), np.zeros((1, 11))
        self._held = np.array([RESTING])
        self._coarse = vectors[0], vectors[1], np.zeros((0, 3)), self._held, table
        self._fine = vectors[0], vectors[1], vectors[2], self._held, table
        self._vectors, self._row = vectors.data.cast("B"), table[0]
        nothing = np.zeros((0, 3))
        self.run(
            nothing, nothing, None, self._held, np.zeros((0, 11))
        )  # loads the code, now and not in flight

    @property
    def level(self) -> Level:
        """The state."""
        return level_of(self._carried.tolist())

    @level.setter
    def level(self, level: Level) -> None:
        self._carried[:] = numbers_of(level)

    def update(
        self, phi: Vector, dv_sf: Vector, dr_sf: Vector | None, held: Held
    ) -> tuple[Row, bool]:
        """See `Stepping.update`."""
        self._held[0] = held
        if dr_sf is None:
            _SIX.pack_into(self._vectors, 0, *phi, *dv_sf)
            arrays = self._coarse
        else:
            _NINE.pack_into(self._vectors, 0, *phi, *dv_sf, *dr_sf)
            arrays = self._fine
        done = self._run(self._carried, self._constants, *self._gravity, *arrays)
        return self._row.tolist(), done > 0

    def run(
        self, phi: Array, dv_sf: Array, dr_sf: Array | None, heights: Array, table: Array
    ) -> int:
        """Carry it over R intervals.

        Args:
            phi, dv_sf, dr_sf: (R, 3); ΔR_SF in high resolution.
            heights: (R, 2) of `step`'s `held`, or one row for all.
            table: (R, 11), gets a `Row` for each interval.

        Returns:
            How many intervals the model of gravity held at the end of; at the first other one
            it stops, after that interval.
        """
        dr = np.zeros((0, 3)) if dr_sf is None else dr_sf
        return self._run(
            self._carried, self._constants, *self._gravity, phi, dv_sf, dr, heights, table
        )
