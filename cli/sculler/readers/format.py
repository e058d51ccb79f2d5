"""What a module of readers says of its formats, and what `convert` says to a reader."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from sculler.readers.columns import split_sign
from sculler.readers.recording import ACCEL_UNITS, GYRO_UNITS, Advance, Recording, Unit
from sculler_model.design import Design
from sculler_model.errors import InputError

UNITS = frozenset({"gyro_unit", "accel_unit", "gyro_scale", "accel_scale"})
TIME = frozenset({"time_column", "time_unit"})
COLUMNS = UNITS | TIME | {"gyro_columns", "accel_columns"}
"""Options of `convert`, by the names of their parameters."""


@dataclass(frozen=True)
class Request:
    """What the options of `convert` ask of a reader; None where they do not say.

    Attributes:
        design: gives rate and counts.
        advance: to be told the bytes read.
        gyro_columns, accel_columns: names or numbers (from 1): three, or one of an array (N, 3);
            each with a minus before it where the negative is meant.
        time: name or number of the time column.
        time_unit: of `TIME_UNITS`.
        gyro, accel: units, of `GYRO_UNITS` and `ACCEL_UNITS`.
        gyro_scale, accel_scale: how many of its unit the number 1 in the file is.
        delimiter: between values of a text: a name of `delimited.DELIMITERS` or one character.
        skip_rows: lines of a text before its header.
        variable: a variable of a MAT or HDF5 file.
        topic: of a ROS bag.
    """

    design: Design
    advance: Advance
    gyro_columns: Sequence[str] | None = None
    accel_columns: Sequence[str] | None = None
    time: str | None = None
    time_unit: str | None = None
    gyro: Unit | None = None
    accel: Unit | None = None
    gyro_scale: float | None = None
    accel_scale: float | None = None
    delimiter: str | None = None
    skip_rows: int = 0
    variable: str | None = None
    topic: str | None = None

    @property
    def gyro_names(self) -> list[str] | None:
        """`gyro_columns` without signs."""
        return _without_signs(self.gyro_columns)

    @property
    def accel_names(self) -> list[str] | None:
        """`accel_columns` without signs."""
        return _without_signs(self.accel_columns)

    def units(self, gyro: str | None = None, accel: str | None = None) -> tuple[Unit, Unit]:
        """The units asked for, with their scales; else the usual ones of the format.

        Raises:
            InputError: neither says a unit.
        """
        return (
            self._unit("gyro", self.gyro, self.gyro_scale, GYRO_UNITS.get(gyro or "")),
            self._unit("accel", self.accel, self.accel_scale, ACCEL_UNITS.get(accel or "")),
        )

    @staticmethod
    def _unit(sensor: str, given: Unit | None, scale: float | None, usual: Unit | None) -> Unit:
        unit = given or usual
        if unit is None:
            known = GYRO_UNITS if sensor == "gyro" else ACCEL_UNITS
            raise InputError(f"--{sensor}-unit is missing, give one of {', '.join(known)}")
        return scaled(sensor, unit, scale)

    def columns(self, defaults: Sequence[str]) -> list[str] | None:
        """The six columns with their signs; None if both sensors' are left out.

        Where one sensor's are, they have the default names.

        Raises:
            InputError: not three different columns are given for a sensor.
        """
        if self.gyro_columns is None and self.accel_columns is None:
            return None
        return triple("gyro", self.gyro_columns or defaults[:3]) + triple(
            "accel", self.accel_columns or defaults[3:]
        )


def _without_signs(columns: Sequence[str] | None) -> list[str] | None:
    return None if columns is None else [split_sign(column)[1] for column in columns]


def triple(sensor: str, columns: Sequence[str]) -> list[str]:
    """Three different columns.

    Raises:
        InputError: they are not.
    """
    if len(columns) != 3 or len(set(_without_signs(columns) or ())) != 3:
        raise InputError(
            f"--{sensor}-columns: {','.join(columns)!r} is not allowed, give three different"
            " columns x,y,z"
        )
    return list(columns)


def scaled(sensor: str, unit: Unit, scale: float | None) -> Unit:
    """The unit times a scale.

    Raises:
        InputError: counts have the scale of the design.
    """
    if scale is None:
        return unit
    if unit.si is None:
        raise InputError(
            f"--{sensor}-scale goes with a unit, not with counts, whose scale the design gives"
        )
    return Unit(f"{scale:.9g} {unit.name}", unit.si * scale, unit.kind)


class Head(NamedTuple):
    """What is known of a file before its format is: its path, first bytes and size."""

    path: Path
    content: bytes
    size: int


Open = Callable[[Path, Request], Recording]


@dataclass(frozen=True)
class Format:
    """A format of logs.

    Attributes:
        name: as `convert --format` has it.
        about: what files these are, for a list.
        open: a recording of a file; raises InputError where the file is at fault.
        options: those of `convert` that the reader uses, by their parameters' names.
        looks: how sure the first bytes make it, 0 to 1; 1 where they say it themselves.
        suffixes: of the names of such files.
    """

    name: str
    about: str
    open: Open = field(repr=False)
    options: frozenset[str] = frozenset()
    looks: Callable[[Head], float] = field(default=lambda head: 0.0, repr=False)
    suffixes: tuple[str, ...] = ()


def begins(*magics: bytes) -> Callable[[Head], float]:
    """`looks` of a format whose files begin with one of some bytes."""
    return lambda head: float(head.content.startswith(magics))
