"""The columns of an IMU log, whatever kind of file it is in, and their samples."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sculler_model.design import Design, Interval
from sculler_model.errors import InputError

COUNTS = ("gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z")
FAULT, TIME, SEQUENCE = "fault", "time_s", "sequence"
OPTIONAL = (FAULT, TIME, SEQUENCE)
CHANNEL, RESTART = "channel", "restart"
OF_CHANNELS = (CHANNEL, RESTART)
"""Of the log of a core with many sensors; the first is then required."""
HEADER = ",".join(COUNTS)

MOST_SECONDS = 1e12
"""30,000 years: a stamp beyond is in another unit."""

MOST_SEQUENCE = 10**18
"""The greatest counter, either way."""


class Chunk(NamedTuple):
    """Consecutive samples of a log.

    `counts` is (N, 6) in the order of `COUNTS`.  The others are (N,), and None where the log has
    no such column: `faults` of 0 and 1; `times`, the stamps, s; `sequence`, the sample counter;
    `channels`, whose sample it is; `restarts`, 1 where its channel begins anew.
    """

    counts: NDArray[np.int64]
    faults: NDArray[np.uint8] | None = None
    times: NDArray[np.float64] | None = None
    sequence: NDArray[np.int64] | None = None
    channels: NDArray[np.int64] | None = None
    restarts: NDArray[np.uint8] | None = None

    @property
    def marks(self) -> list[NDArray[Any]]:
        """Its faults, channels and restarts, as far as it has them."""
        found = (self.faults, self.channels, self.restarts)
        return [column for column in found if column is not None]

    def part(self, which: slice) -> Chunk:
        """Some of the samples."""
        return Chunk._make(None if column is None else column[which] for column in self)


def ranges(design: Design | None) -> dict[str, Interval]:
    """What the whole numbers of each column may be; counts of 64 bits where no design tells."""
    widest = Interval.signed(64)
    gyro, accel = (widest, widest) if design is None else (design.words.gyro, design.words.accel)
    allowed = {column: gyro if column.startswith("gyro") else accel for column in COUNTS}
    sequence = Interval(-MOST_SEQUENCE, MOST_SEQUENCE)
    channel = Interval(0, 0 if design is None else design.channels - 1)
    return allowed | {
        FAULT: Interval(0, 1),
        SEQUENCE: sequence,
        CHANNEL: channel,
        RESTART: Interval(0, 1),
    }


def require_columns(where: str, names: Sequence[str], channels: int) -> None:
    """See that a log has its columns, each once, and no others.

    Args:
        where: the log, for messages.
        names: its columns.
        channels: of the design whose log it is.

    Raises:
        InputError: it has not; the message begins with `where`.
    """
    optional = OPTIONAL if channels == 1 else (FAULT, TIME, *OF_CHANNELS)
    if not any(column in (*COUNTS, *optional) for column in names):
        raise InputError(
            f"{where}: no header, give {HEADER} and optionally {', '.join(optional)}"
            " (sculler convert reads other formats)"
        )
    for column in COUNTS:
        if column not in names:
            raise InputError(f"{where}: column {column} is missing, add it")
    if channels > 1 and CHANNEL not in names:
        raise InputError(
            f"{where}: column {CHANNEL} is missing, add it: hardware.channels = {channels}"
        )
    for column in names:
        if channels == 1 and column in OF_CHANNELS:
            raise InputError(
                f"{where}: column {column} is for a design with hardware.channels, take it out or"
                " give such a design"
            )
        if channels > 1 and column == SEQUENCE:
            raise InputError(
                f"{where}: column {SEQUENCE} is not read where there are channels, take it out"
            )
        if column not in (*COUNTS, *optional):
            raise InputError(
                f"{where}: unknown column {column[:40]!r}, give {HEADER} and"
                f" optionally {', '.join(optional)}"
            )
        if names.count(column) > 1:
            raise InputError(f"{where}: column {column} is there twice, drop one")


def does_not_fit(where: str, column: str, shown: object, allowed: Interval) -> InputError:
    """What to say of a whole number outside its range; the place is `where`."""
    if column in (FAULT, RESTART):
        return InputError(f"{where} is {shown}, give 0 or 1")
    if column == SEQUENCE:
        return InputError(f"{where} has more than 18 digits, give a smaller counter")
    if column == CHANNEL:
        return InputError(f"{where} is {shown}, give {allowed.lo} to {allowed.hi}")
    return InputError(
        f"{where} = {shown} does not fit the sensor's {allowed.bits} bits, give {allowed.lo} to"
        f" {allowed.hi}"
    )


def too_late(where: str, value: float) -> InputError:
    """What to say of a stamp beyond `MOST_SECONDS`; the place is `where`."""
    return InputError(
        f"{where} = {value:.9g} is more than {MOST_SECONDS:g} s, give seconds (not nanoseconds)"
    )
