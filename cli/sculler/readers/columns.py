"""Columns that known programs write: which hold what, and in which units."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from sculler_model.errors import InputError

_ROS_PREFIX = re.compile(r"^field\.")
_SECONDS, _NANOSECONDS = ("secs", "sec"), ("nsecs", "nanosec", "nanosecs")


@dataclass(frozen=True)
class KnownColumns:
    """A header that was recognised.

    Attributes:
        program: who writes such headers: `euroc` or `ros`.
        columns: the six of gyro x, y, z, accelerometer x, y, z, as the header has them.
        time: none; one column; or two, whole seconds and nanoseconds.
        time_unit: of `TIME_UNITS`; None if the numbers must tell, see `stamp_unit`.
    """

    program: str
    columns: tuple[str, ...]
    time: tuple[str, ...]
    time_unit: str | None


def recognise(names: Sequence[str]) -> KnownColumns | None:
    """The known columns among a header's names, rates in rad/s and m/s²; None if unknown.

    * EuRoC: `#timestamp [ns]`, `w_RS_S_x [rad s^-1]`, ..., `a_RS_S_x [m s^-2]`, ...
    * ROS sensor_msgs/Imu, as rostopic, bag converters and plotting programs export it: any names
      that end in `angular_velocity.x` and so on, with . or / between.  Of its times the stamp of
      the message (`header.stamp`, in one column or two) goes before the time of its recording
      (`%time`, `time`, `timestamp`).
    """
    return _euroc(names) or _ros(names)


def _euroc(names: Sequence[str]) -> KnownColumns | None:
    columns = [
        name
        for part in ("w_RS_S_", "a_RS_S_")
        for axis in "xyz"
        for name in names
        if name.startswith(part + axis)
    ]
    times = [name for name in names if name.lstrip("#").startswith("timestamp")]
    if len(columns) != 6 or len(times) != 1:
        return None
    return KnownColumns("euroc", tuple(columns), (times[0],), "ns")


def _ros(names: Sequence[str]) -> KnownColumns | None:
    plain = {_ROS_PREFIX.sub("", name.replace("/", ".").lower()): name for name in names}

    def ending(*ends: str) -> str | None:
        found = [name for key, name in plain.items() if any(f".{key}".endswith(e) for e in ends)]
        return found[0] if len(found) == 1 else None

    columns = [
        name
        for part in ("angular_velocity", "linear_acceleration")
        for axis in "xyz"
        if (name := ending(f".{part}.{axis}")) is not None
    ]
    if len(columns) != 6:
        return None
    whole = ending(*(f".header.stamp.{part}" for part in _SECONDS))
    rest = ending(*(f".header.stamp.{part}" for part in _NANOSECONDS))
    if whole is not None and rest is not None:
        return KnownColumns("ros", tuple(columns), (whole, rest), "ns")
    stamps = [".header.stamp", ".%time", ".time", ".__time", ".timestamp", ".rosbagtimestamp"]
    time = next((name for end in stamps if (name := ending(end)) is not None), None)
    return KnownColumns("ros", tuple(columns), () if time is None else (time,), None)


def split_sign(column: str) -> tuple[float, str]:
    """The sign and the name or number of a column as an option gives it: `-gy` is minus `gy`."""
    bare = column.removeprefix("-").strip()
    return (-1.0, bare) if column.startswith("-") and bare else (1.0, column)


def headed(column: str, names: Sequence[str]) -> str:
    """The name under which a header has a column that an option gives, its sign apart.

    Some programs head a column `-gy` that holds minus y: `-gy` then is the negative of that.

    Raises:
        InputError: the header has both `gy` and `-gy`.
    """
    sign, bare = split_sign(column)
    if sign > 0 or column not in names:
        return bare
    if bare in names:
        raise InputError(
            f"column {column!r} may be the negative of {bare!r} or the column of that name, give"
            " the columns' numbers"
        )
    return column


def stamp_unit(stamp: str) -> str:
    """Unit of a stamp that no header gives: whole numbers of 16 digits or more count ns, others s.

    Seconds since 1970 have ten digits before the point, nanoseconds nineteen.
    """
    return "ns" if stamp.isdecimal() and len(stamp) >= 16 else "s"
