"""Which of a file's named arrays are the samples: as the user says, or by the names they have.

An array of a sensor is (N, 3), or (3, N); or there is one of (N,) for each axis.  Names may be
those of fields in structures: `imu.gyro`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from numpy.typing import NDArray

from sculler.formats.log import COUNTS, FAULT
from sculler.readers.apart import Shape, told
from sculler.readers.format import Request, scaled
from sculler.readers.recording import TIME_UNITS, Unit
from sculler_model.errors import InputError

GYRO_NAMES = (
    *("gyro", "gyr", "gyros", "gyroscope", "angular_velocity", "angularvelocity", "angular_rate"),
    *("omega", "dtheta", "delta_theta", "delta_angle"),
)
ACCEL_NAMES = (
    *("accel", "acc", "accelerometer", "acceleration", "linear_acceleration"),
    *("linearacceleration", "specific_force", "dvel", "delta_v", "delta_velocity"),
)
TIME_NAMES = ("time", "t", "timestamp", "timestamps", "time_s")


class Source(Protocol):
    """Named arrays, of which the shapes are known before they are read."""

    @property
    def path(self) -> Path:
        """The file."""

    @property
    def listing(self) -> Mapping[str, Shape]:
        """The shapes by name."""

    def __getitem__(self, name: str) -> NDArray[Any]: ...


@dataclass(frozen=True)
class Column:
    """A column of samples.

    Attributes:
        name: of the array.
        place: its column, from 0; None for an array (N,).
        lies: the array is (3, N), and the column one of its rows.
    """

    name: str
    place: int | None = None
    lies: bool = False

    def __str__(self) -> str:
        return self.name if self.place is None else f"{self.name}:{self.place + 1}"


def _lies(shape: Sequence[int]) -> bool:
    """Whether an array of a sensor is (3, N), with more samples than axes."""
    return len(shape) == 2 and shape[0] == 3 and shape[1] > 3


def _is_vector(shape: Shape) -> bool:
    long = [length for length in shape.shape if length != 1]
    return shape.is_real and len(long) <= 1 and len(shape.shape) in (1, 2)


def _is_triple(shape: Shape) -> bool:
    wide = len(shape.shape) == 2 and (shape.shape[1] == 3 or _lies(shape.shape))
    return shape.is_real and wide and 1 not in shape.shape


class Choice:
    """The columns of the samples, of the stamps and of the faults.

    Attributes:
        samples: six.
        time, fault: or None.
        matrix: the one variable that numbers of columns count in; None where names are given.
    """

    def __init__(self, source: Source, request: Request) -> None:
        self._source, self._request = source, request
        self._listing, self.path = source.listing, source.path
        self.matrix = self._matrix()
        given = request.gyro_names is not None or request.accel_names is not None
        if self.matrix is not None:
            self.samples = [
                *self._given("gyro", request.gyro_names or ("1", "2", "3")),
                *self._given("accel", request.accel_names or ("4", "5", "6")),
            ]
        elif given:
            if request.gyro_names is None or request.accel_names is None:
                raise InputError("--gyro-columns and --accel-columns go together, give both")
            self.samples = [
                *self._given("gyro", request.gyro_names),
                *self._given("accel", request.accel_names),
            ]
        else:
            self.samples = self._guessed()
        self.time = self._time()
        self.fault = Column(FAULT) if FAULT in self._listing else None

    @property
    def columns(self) -> list[Column]:
        """All of them."""
        return [*self.samples, *(each for each in (self.time, self.fault) if each is not None)]

    def _has(self) -> str:
        return f"the file has {told(self._listing)}"

    def _matrix(self) -> str | None:
        name = self._request.variable
        if name is None:
            columns = [*(self._request.gyro_names or ()), *(self._request.accel_names or ())]
            if columns and all(column.isdecimal() for column in columns):
                raise InputError(f"{self.path}: columns by number need --variable; {self._has()}")
            return None
        if name not in self._listing:
            raise InputError(f"{self.path}: no variable {name!r}; {self._has()}: give --variable")
        shape = self._listing[name]
        if not shape.is_real or len(shape.shape) != 2:
            raise InputError(
                f"{self.path}: {name} is not a matrix of real numbers, give another; {self._has()}"
            )
        if not shape.shape[0]:
            raise InputError(f"{self.path}: {name} has no rows, give samples")
        return name

    def _given(self, sensor: str, columns: Sequence[str]) -> list[Column]:
        """The three columns that the user names."""
        if len(columns) == 1:
            name = self._name(columns[0], f"--{sensor}-columns")
            if not _is_triple(self._listing[name]):
                raise InputError(
                    f"{self.path}: {name} is no array of three columns of real numbers;"
                    f" {self._has()}"
                )
            return self._axes(name)
        if len(columns) != 3 or len(set(columns)) != 3:
            raise InputError(
                f"--{sensor}-columns: {','.join(columns)!r} is not allowed, give three different"
                " columns x,y,z, or one array of three"
            )
        return [self._column(column, f"--{sensor}-columns") for column in columns]

    def _axes(self, name: str) -> list[Column]:
        """The columns of an array of a sensor."""
        lies = _lies(self._listing[name].shape)
        return [Column(name, axis, lies) for axis in range(3)]

    def _column(self, text: str, option: str) -> Column:
        """A column as the user names it: a number, a name, or name:number."""
        if text.isdecimal():
            if self.matrix is None:
                raise InputError(f"{option}: columns by number need --variable")
            return self._numbered(self.matrix, text)
        name, _, number = text.rpartition(":")
        if name and number.isdecimal():
            return self._numbered(self._name(name, option), number)
        name = self._name(text, option)
        if not _is_vector(self._listing[name]):
            shape = "×".join(map(str, self._listing[name].shape))
            raise InputError(
                f"{self.path}: {name} ({shape}) is no vector of real numbers, name one of its"
                f" columns as {name}:1"
            )
        return Column(name)

    def _numbered(self, name: str, number: str) -> Column:
        shape = self._listing[name]
        if not shape.is_real or len(shape.shape) != 2:
            raise InputError(f"{self.path}: {name} is not a matrix of real numbers, give another")
        count = shape.shape[1]
        if not 1 <= int(number) <= count:
            raise InputError(
                f"{self.path}: {name} has columns 1 to {count}, not {number}; give --gyro-columns"
                " and --accel-columns"
            )
        return Column(name, int(number) - 1)

    def _name(self, text: str, option: str) -> str:
        """The array that the user means: by its whole name, or the end of it if one only has it."""
        if text in self._listing:
            return text
        ending = [name for name in self._listing if name.endswith(f".{text}")]
        if len(ending) == 1:
            return ending[0]
        why = (
            f"{text!r} is the end of {' and '.join(ending[:4])}" if ending else f"no array {text!r}"
        )
        raise InputError(f"{self.path}: {why}; {self._has()}: give {option}")

    def _guessed(self) -> list[Column]:
        """The samples, by the names that arrays have."""
        pairs = []
        for parent in dict.fromkeys(_parent(name) for name in self._listing):
            axes = [f"{parent}{name}" for name in COUNTS]
            if all(name in self._listing and _is_vector(self._listing[name]) for name in axes):
                pairs.append([Column(name) for name in axes])
                continue
            gyro, accel = (self._known(parent, names) for names in (GYRO_NAMES, ACCEL_NAMES))
            if len(gyro) > 1 or len(accel) > 1:
                both = gyro if len(gyro) > 1 else accel
                raise InputError(
                    f"{self.path}: arrays {' and '.join(both)} are both there; {self._has()}: give"
                    " --gyro-columns and --accel-columns"
                )
            if gyro and accel:
                pairs.append([*self._axes(gyro[0]), *self._axes(accel[0])])
        if len(pairs) == 1:
            return pairs[0]
        why = "no arrays gyro and accel of shape (N, 3)"
        if pairs:
            names = " and ".join(str(pair[0].name) for pair in pairs[:4])
            why = f"more than one pair of gyro and accelerometer ({names})"
        raise InputError(
            f"{self.path}: {why}; {self._has()}: give --variable with a matrix, or --gyro-columns"
            " and --accel-columns"
        )

    def _known(self, parent: str, names: Sequence[str]) -> list[str]:
        """The arrays of three columns of a structure that have one of some names."""
        return [
            name
            for name, shape in self._listing.items()
            if _parent(name) == parent
            and name[len(parent) :].lower() in names
            and _is_triple(shape)
        ]

    def _time(self) -> Column | None:
        if self._request.time is not None:
            return self._column(self._request.time, "--time-column")
        if self.matrix is not None:
            return None
        parent = _parent(self.samples[0].name)
        for near in dict.fromkeys((parent, "")):
            names = [
                name
                for name, shape in self._listing.items()
                if _parent(name) == near
                and name[len(near) :].lower() in TIME_NAMES
                and _is_vector(shape)
            ]
            if len(names) > 1:
                raise InputError(
                    f"{self.path}: arrays {' and '.join(names)} are both there, give --time-column"
                )
            if names:
                return Column(names[0])
        return None

    def time_unit(self, stamps: NDArray[Any], whole_is_ns: bool) -> str:
        """What the stamps count."""
        usual = "ns" if stamps.dtype.kind in "iu" and whole_is_ns else "s"
        unit = self._request.time_unit or self._text("time_unit") or usual
        if unit not in TIME_UNITS:
            raise InputError(
                f"{self.path}: time_unit {unit!r} is not one of {', '.join(TIME_UNITS)}"
            )
        return unit

    def _text(self, name: str) -> str | None:
        """What a text beside the samples says."""
        parent = _parent(self.samples[0].name)
        for each in (f"{parent}{name}", name):
            if each in self._listing and self._listing[each].text is not None:
                return self._listing[each].text
        return None

    def unit(
        self,
        sensor: str,
        given: Unit | None,
        known: Mapping[str, Unit],
        usual: str,
        saying: Sequence[str],
        scale: float | None,
    ) -> Unit:
        """The unit of a sensor: as the user says, a text in the file, or the array's name."""
        key = f"{sensor}_unit"
        name = self._text(key)
        if given is None and name is not None:
            if name not in known:
                raise InputError(
                    f"{self.path}: {key} {name!r} is not known, give {', '.join(known)}"
                )
            given = known[name]
        array = self.samples[0 if sensor == "gyro" else 3].name
        if given is None and array.rpartition(".")[2] in saying:
            given = known[usual]
        if given is None:
            raise InputError(
                f"{self.path}: the unit of {sensor} is not given, give --{sensor}-unit, one of"
                f" {', '.join(known)}"
            )
        return scaled(sensor, given, scale)

    def told(self) -> str:
        """The columns, in words."""
        if self.matrix is not None and all(each.name == self.matrix for each in self.samples):
            places = [0 if each.place is None else each.place + 1 for each in self.samples]
            return f"{self.matrix}: " + ", ".join(map(str, places))
        names = [str(each) for each in self.samples]
        for first in (0, 3):
            three = self.samples[first : first + 3]
            if [each.place for each in three] == [0, 1, 2] and len({e.name for e in three}) == 1:
                names[first : first + 3] = [three[0].name, "", ""]
        return ", ".join(name for name in names if name)


def _parent(name: str) -> str:
    """The structure of a name, with the point after it; empty for none."""
    return name[: name.rfind(".") + 1]
