"""How the sensor sits in the body: its axes' directions, small misalignment angles, biases."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from sculler_model.errors import InputError
from sculler_model.frames import AxisMap, Vector, from_rotation_vector, to_dcm

_DIRECTIONS = {
    "F": (0, 1), "R": (1, 1), "D": (2, 1),
    "B": (0, -1), "L": (1, -1), "U": (2, -1),
}  # fmt: skip
_WORDS = {"F": "forward", "R": "right", "D": "down", "B": "back", "L": "left", "U": "up"}


def parse_axes(text: str) -> AxisMap:
    """Read "y,x,-z", or the directions "RFU" in which the sensor's x, y, z point.

    The body axes that directions give are forward, right, down.

    Raises:
        InputError: neither, or the axes are left-handed.
    """
    letters = text.strip().upper()
    if len(letters) != 3 or not set(letters) <= set(_DIRECTIONS):
        return AxisMap.parse(text)
    found = [_DIRECTIONS[letter] for letter in letters]
    if {axis for axis, _ in found} != {0, 1, 2}:
        raise InputError(
            f'axes: "{text}" has two axes on one line, give one of F or B, of R or L and of D or U'
        )
    names = [""] * 3
    for sensor, (body, sign) in zip("xyz", found, strict=True):
        names[body] = ("-" if sign < 0 else "") + sensor
    try:
        return AxisMap.parse(",".join(names))
    except InputError as error:
        raise InputError(
            f'axes: "{text}" is a mirror image (left-handed), not a rotation; turn one axis round'
        ) from error


@dataclass(frozen=True)
class Mounting:
    """From the sensor's axes, as the file has them, to those of the log.

    Attributes:
        axes: which sensor axis becomes which of the log; None for the same.
        misalignment: rotation vector (rad, sensor axes) by which vectors are turned before that:
            C(misalignment)·v is what a sensor mounted without fault would have measured.
        directions: where the sensor's axes point, as "RFU", if the user said so.
    """

    axes: AxisMap | None = None
    misalignment: Vector = (0.0, 0.0, 0.0)
    directions: str | None = None

    @classmethod
    def parse(cls, axes: str | None, misalignment: Vector) -> Mounting:
        """The mounting as options give it, see `parse_axes`."""
        if axes is None:
            return cls(None, misalignment)
        named = set(axes.strip().upper()) <= set(_DIRECTIONS)
        return cls(parse_axes(axes), misalignment, axes.strip().upper() if named else None)

    @property
    def turns(self) -> bool:
        """Whether there is a misalignment."""
        return any(self.misalignment)

    @cached_property
    def matrix(self) -> NDArray[np.float64]:
        """(3, 3): a vector in the sensor's axes to the log's."""
        turn = np.array(to_dcm(from_rotation_vector(self.misalignment)))
        return turn if self.axes is None else self.axes.apply(turn.T).T

    def apply(self, vectors: NDArray[np.float64]) -> NDArray[np.float64]:
        """Vectors (N, 3) in the sensor's axes to the log's; exact if only axes change places."""
        if self.turns:
            return vectors @ self.matrix.T
        return vectors if self.axes is None else self.axes.apply(vectors)

    def rows(self) -> list[dict[str, str]]:
        """For each axis of the log: what it is made of."""
        body = ("forward", "right", "down")
        rows = []
        for at, name in enumerate("xyz"):
            axis = at if self.axes is None else self.axes.axes[at]
            sign = 1.0 if self.axes is None else self.axes.signs[at]
            row = {"log": name, "file": ("-" if sign < 0 else "+") + "xyz"[axis]}
            if self.directions is not None:
                row["log"] = f"{name} ({body[at]})"
                row["file"] += f" ({_WORDS[self.directions[axis]]})"
            row["cosines"] = " ".join(f"{cosine + 0.0:+.6f}" for cosine in self.matrix[at])
            rows.append(row)
        return rows


def parse_vector(option: str, text: str, units: dict[str, float]) -> Vector:
    """Read "x,y,z unit" as SI; without a unit the first of the units holds.

    Raises:
        InputError: not three finite numbers and one of the units.
    """
    numbers, _, unit = text.strip().partition(" ")
    unit = unit.strip() or next(iter(units))
    try:
        values = [float(cell) for cell in numbers.split(",")]
    except ValueError:
        values = []
    if len(values) != 3 or unit not in units or not all(map(isfinite, values)):
        raise InputError(
            f'{option}: "{text}" is not allowed, give three numbers and a unit as in'
            f' "0.1,-0.2,0.3 {unit if unit in units else next(iter(units))}", one of'
            f" {', '.join(units)}"
        )
    x, y, z = (value * units[unit] for value in values)
    return x, y, z
