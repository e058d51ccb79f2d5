"""IMU logs as the core sees them: counts, one sample a row (docs/reference/imu-log.md).

The columns are `gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z`, in any order, and optionally `fault`
(0 or 1), `time_s` (the stamp, decimal seconds of the log's own clock) and `sequence` (a whole
number that counts samples).  The log of a design with many channels has `channel` too, and
optionally `restart` (1: the channel begins anew), and no `sequence`.

The ending of the file's name says what it is: `.npz`, `.parquet`, and
CSV for all others.  Reading streams in bounded memory.

The stamp of an increment is the end of its step, that of a rate the instant it holds at.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from types import TracebackType

import numpy as np
from numpy.typing import NDArray

from sculler.formats.log_columns import (
    CHANNEL,
    COUNTS,
    FAULT,
    HEADER,
    OF_CHANNELS,
    OPTIONAL,
    RESTART,
    SEQUENCE,
    TIME,
    Chunk,
)
from sculler.formats.log_table import LogTableWriter, read_log_table
from sculler.formats.log_text import TextLogWriter, read_text_log
from sculler.formats.tables import table_kind
from sculler_model.design import Design
from sculler_model.errors import InputError

__all__ = [
    "CHANNEL",
    "COUNTS",
    "FAULT",
    "HEADER",
    "OF_CHANNELS",
    "OPTIONAL",
    "RESTART",
    "SEQUENCE",
    "TIME",
    "Chunk",
    "LogWriter",
    "read_log",
]


def read_log(
    path: str | Path,
    design: Design | None,
    advance: Callable[[int], None] | None = None,
    *,
    channels: bool = False,
) -> Iterator[Chunk]:
    """Stream a log's samples, checked against the sensor's widths.

    Args:
        path: the log, `.npz`, `.parquet` or CSV; `-` for CSV from stdin.
        design: its `sensor` gives the widths; None for counts of up to 64 bits.
        advance: told the bytes read, block by block.
        channels: whether whoever reads it looks at the channels of its samples.

    Yields:
        The samples, each value checked by itself; whether stamps and counter run on is another
        matter (`sculler.checks.breaks`).

    Raises:
        InputError: the log cannot be read or has a fault; names file, line (of a binary file the
            row, from 1) and column.  Or the design has channels, which nobody would look at.
    """
    if design is not None and design.channels > 1 and not channels:
        raise InputError(
            f"{path}: a log of {design.channels} channels is read by model and simulate alone,"
            " give one channel's log and a design without hardware.channels"
        )
    try:
        read = read_text_log if table_kind(path) is None else read_log_table
        yield from read(path, design, advance)
    except OSError as error:
        name = "stdin" if str(path) == "-" else str(path)
        raise InputError(
            f"{name}: cannot read the log ({error.strerror}), check the path"
        ) from error


class LogWriter:
    """Writes a log, chunk by chunk; what kind of file, the ending of its name says.

    Args:
        path: the file.
        faults: write the `fault` column too.
        times: write the `time_s` column too.
        channels, restarts: write these columns of a log of many channels too.

    Raises:
        InputError: the library for the kind of file is absent.
    """

    def __init__(
        self,
        path: Path,
        faults: bool = False,
        times: bool = False,
        channels: bool = False,
        restarts: bool = False,
    ) -> None:
        self._faults, self._times = faults, times
        marks = [FAULT] * faults + [CHANNEL] * channels + [RESTART] * restarts
        kind = TextLogWriter if table_kind(path) is None else LogTableWriter
        self._file: TextLogWriter | LogTableWriter = kind(path, marks, times)

    def write(
        self,
        counts: NDArray[np.int64],
        faults: NDArray[np.uint8] | None = None,
        times: NDArray[np.float64] | None = None,
        origin: float = 0.0,
        channels: NDArray[np.int64] | None = None,
        restarts: NDArray[np.uint8] | None = None,
    ) -> None:
        """Append samples.

        Args:
            counts: (N, 6).
            faults: (N,), if the log has that column (None: 0).
            times: (N,) stamps, s from the origin; exactly if the log has that column.
            origin: a whole number of s.
            channels, restarts: (N,), exactly if the log has these columns.

        Raises:
            ValueError: stamps are missing or too many.
        """
        if (times is not None) != self._times:
            raise ValueError("times: give them exactly where the log has the column time_s")
        if not self._faults:
            faults = None
        elif faults is None:
            faults = np.zeros(len(counts), np.uint8)
        chunk = Chunk(counts, faults, times, channels=channels, restarts=restarts)
        self._file.write(chunk, origin)

    def __enter__(self) -> LogWriter:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._file.close(kind, error, trace)
