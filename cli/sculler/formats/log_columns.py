"""The columns of an IMU log, whatever kind of file it is in, and their samples."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sculler_model.design import Design, Interval
from sculler_model.errors import InputError

COUNTS = ("gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z")
FAULT, TIME, SEQUENCE = "fault", "time_s", "sequence"
OPTIONAL = (FAULT, TIME, SEQUENCE)
HEADER = ",".join(COUNTS)

MOST_SECONDS = 1e12
"""30,000 years: a stamp beyond is in another unit."""

MOST_SEQUENCE = 10**18
"""The greatest counter, either way."""


class Chunk(NamedTuple):
    """Consecutive samples of a log.

    `counts` is (N, 6) in the order of `COUNTS`.  The others are (N,), and None where the log has
    no such column: `faults` of 0 and 1; `times`, the stamps, s; `sequence`, the sample counter.
    """

    counts: NDArray[np.int64]
    faults: NDArray[np.uint8] | None = None
    times: NDArray[np.float64] | None = None
    sequence: NDArray[np.int64] | None = None


def ranges(design: Design | None) -> dict[str, Interval]:
    """What the whole numbers of each column may be; counts of 64 bits where no design tells."""
    widest = Interval.signed(64)
    gyro, accel = (widest, widest) if design is None else (design.words.gyro, design.words.accel)
    allowed = {column: gyro if column.startswith("gyro") else accel for column in COUNTS}
    sequence = Interval(-MOST_SEQUENCE, MOST_SEQUENCE)
    return allowed | {FAULT: Interval(0, 1), SEQUENCE: sequence}


def require_columns(where: str, names: Sequence[str]) -> None:
    """See that a log has its columns, each once, and no others.

    Raises:
        InputError: it has not; the message begins with `where`.
    """
    if not any(column in (*COUNTS, *OPTIONAL) for column in names):
        raise InputError(
            f"{where}: no header, give {HEADER} and optionally {', '.join(OPTIONAL)}"
            " (sculler convert reads other formats)"
        )
    for column in COUNTS:
        if column not in names:
            raise InputError(f"{where}: column {column} is missing, add it")
    for column in names:
        if column not in (*COUNTS, *OPTIONAL):
            raise InputError(
                f"{where}: unknown column {column[:40]!r}, give {HEADER} and"
                f" optionally {', '.join(OPTIONAL)}"
            )
        if names.count(column) > 1:
            raise InputError(f"{where}: column {column} is there twice, drop one")


def does_not_fit(where: str, column: str, shown: object, allowed: Interval) -> InputError:
    """What to say of a whole number outside its range; the place is `where`."""
    if column == FAULT:
        return InputError(f"{where} is {shown}, give 0 or 1")
    if column == SEQUENCE:
        return InputError(f"{where} has more than 18 digits, give a smaller counter")
    return InputError(
        f"{where} = {shown} does not fit the sensor's {allowed.bits} bits, give {allowed.lo} to"
        f" {allowed.hi}"
    )


def too_late(where: str, value: float) -> InputError:
    """What to say of a stamp beyond `MOST_SECONDS`; the place is `where`."""
    return InputError(
        f"{where} = {value:.9g} is more than {MOST_SECONDS:g} s, give seconds (not nanoseconds)"
    )
