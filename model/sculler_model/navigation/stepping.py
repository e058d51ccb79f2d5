"""A state on its way from interval to interval: in plain Python, or in compiled code.

Both are the arithmetic of `wander`, and tell what is at an interval's end as a `Row`.
"""

from __future__ import annotations

from collections.abc import Sequence
from struct import Struct
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from sculler_model.frames import (
    Vector,
    conjugate,
    cross,
    dcm_of_rotation_vector,
    from_dcm,
    from_rotation_vector,
    matrix_product,
    normalised,
    orthonormalised,
    plus,
    product,
    rotate,
    to_dcm,
)
from sculler_model.navigation.compiled import CompiledRun
from sculler_model.navigation.gravity import covers
from sculler_model.navigation.height import RESTING, Held
from sculler_model.navigation.wander import (
    NOT_YET,
    Level,
    Settings,
    displaced,
    geographic,
    level_of,
    numbers_of,
    settled,
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


class Alternative(Interpreted):
    """A state carried by other forms of the same equations, to see what each is worth.

    Args:
        level, settings: as of `Interpreted`.
        cosines: the attitude is carried as direction cosines (Savage-20 Eq. 1), with the exact
            coefficients for φ and for ζ, and one step towards orthonormality an update.
        level_every: major intervals from one turn of the frame L to the next (Savage-98 Eq. 11-14):
            in between the specific force is turned by what L has turned since, to first order,
            I - ζ×.
    """

    def __init__(self, level: Level, settings: Settings, cosines: bool, level_every: int) -> None:
        super().__init__(level, settings)
        self._cosines, self._level_every = cosines, level_every
        self._q, self._dcm = level.q, to_dcm(level.q)
        self._lag, self._since = NOT_YET, 0

    def update(
        self, phi: Vector, dv_sf: Vector, dr_sf: Vector | None, held: Held
    ) -> tuple[Row, bool]:
        """See `Stepping.update`."""
        settings, dr = (self._coarse, NOT_YET) if dr_sf is None else (self._fine, dr_sf)
        begun = from_dcm(self._dcm) if self._cosines else self._q
        now, lag = self.level._replace(q=begun), rotate(conjugate(begun), self._lag)
        dv, dr = plus(dv_sf, cross(lag, dv_sf), -1.0), plus(dr, cross(lag, dr), -1.0)
        turn, after = displaced(now, settings, dv, dr, held)
        self._lag = plus(self._lag, turn, 1.0)
        self._since += 1
        x, y, z = self._lag
        back = (-x, -y, -z)
        if self._cosines:
            self._dcm = matrix_product(self._dcm, dcm_of_rotation_vector(phi))
            turned = orthonormalised(matrix_product(dcm_of_rotation_vector(back), self._dcm))
            q = from_dcm(turned)
        else:
            self._q = normalised(product(self._q, from_rotation_vector(phi)))
            q = normalised(product(from_rotation_vector(back), self._q))
        if self._since == self._level_every:
            if self._cosines:
                self._dcm = turned
            self._q, self._lag, self._since = q, NOT_YET, 0
        self.level = settled(after, settings, q)
        found, v, lat, lon, h, wander = geographic(self.level)
        return (*found, *v, lat, lon, h, wander), covers(settings.gravity, lat, h)


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
            (settings.interval, settings.position_every, *settings.damping, settings.free),
            np.float64,
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
