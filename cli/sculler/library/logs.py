"""`Log`: a log's samples in memory, from files, arrays and frames, and to them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sculler.formats import log as files
from sculler.formats.log import COUNTS, FAULT, SEQUENCE, TIME, Chunk, LogWriter
from sculler.library.counts import (
    CountsLike,
    as_counts,
    as_marks,
    as_times,
    column,
    is_frame,
    whole,
)
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.outputs import replacing
from sculler_model.tables import Table, vector_columns


@dataclass(frozen=True)
class Log(Table):
    """Consecutive samples of a six-axis sensor, as exact counts in the sensor's axes.

    `Log.of` makes one of arrays or of a frame, `read_log` of a file, `record` of a motion.

    Attributes:
        counts: (N, 6) int64: gyro x, y, z, accelerometer x, y, z, in the sensor's LSB.
        faults: (N,) uint8, 1 where the sensor said that the sample is faulty; None for none.
        times: (N,) s, the stamps: the end of an increment's step, the instant of a rate; None
            where there are none.
        sequence: (N,) int64, a counter of samples; None where there is none.

    Examples:
        >>> import numpy as np, sculler
        >>> log = sculler.Log.of(np.zeros((40, 6), np.uint16))
        >>> len(log), log.counts.dtype.name, list(log.named_columns())[:2]
        (40, 'int64', ['gyro_x', 'gyro_y'])
    """

    counts: NDArray[np.int64]
    faults: NDArray[np.uint8] | None = None
    times: NDArray[np.float64] | None = None
    sequence: NDArray[np.int64] | None = None

    @classmethod
    def of(
        cls,
        counts: CountsLike,
        faults: ArrayLike | None = None,
        times: ArrayLike | None = None,
        sequence: ArrayLike | None = None,
        design: Design | None = None,
    ) -> Log:
        """A log of arrays, or of a pandas or polars frame.

        Args:
            counts: (N, 6) whole numbers of any dtype, or a frame with the columns `gyro_x` to
                `accel_z` and optionally `fault`, `time_s` and `sequence`.
            faults, times, sequence: (N,) as the attributes; None for what the frame says.
            design: whose sensor's widths the counts must fit; None for 64 bits.

        Raises:
            InputError: a value is no whole number or does not fit (nothing is ever wrapped or
                rounded), or a shape is wrong.
        """
        whole_counts = as_counts(counts, design)
        if is_frame(counts):
            frame: Any = counts
            given = {FAULT: faults, TIME: times, SEQUENCE: sequence}
            faults, times, sequence = (
                column(frame, name) if value is None and name in frame.columns else value
                for name, value in given.items()
            )
        n = len(whole_counts)
        if sequence is not None:
            sequence = np.atleast_1d(whole("sequence", sequence))
            if sequence.shape != (n,):
                raise InputError(f"sequence: shape {sequence.shape}, give {n}, one a sample")
        return cls(
            whole_counts,
            None if faults is None else as_marks("faults", faults, n),
            None if times is None else as_times(times, n),
            sequence,
        )

    def __len__(self) -> int:
        return len(self.counts)

    def named_columns(self) -> dict[str, NDArray[Any]]:
        """The columns of a log file, of what is there."""
        columns: dict[str, NDArray[Any]] = vector_columns(COUNTS, self.counts)
        others = {FAULT: self.faults, TIME: self.times, SEQUENCE: self.sequence}
        return columns | {name: told for name, told in others.items() if told is not None}

    def to_numpy(self) -> NDArray[np.int64]:
        """The counts (N, 6), int64."""
        return self.counts

    @property
    def chunk(self) -> Chunk:
        """As the checks and the models take it."""
        return Chunk(self.counts, self.faults, self.times, self.sequence)


LogLike: TypeAlias = "Log | str | Path | CountsLike"
"""A log, the path of one, an array (N, 6), or a frame with the log's columns."""


def as_log(log: LogLike, design: Design | None = None) -> Log:
    """Whatever stands for a log as one, its counts checked against the design's widths.

    Raises:
        InputError: it cannot be read, or as `Log.of`.
    """
    if isinstance(log, str | Path):
        return read_log(log, design)
    if isinstance(log, Log):
        return Log.of(log.counts, log.faults, log.times, log.sequence, design)
    return Log.of(log, design=design)


def read_log(path: str | Path, design: Design | None = None) -> Log:
    """Read an IMU log (integer counts, docs/reference/imu-log.md) whole.

    Args:
        path: of the file, `.npz`, `.parquet` or CSV; `-` for CSV from standard input.
        design: whose sensor's widths the counts must fit; None for 64 bits.

    Returns:
        The samples: counts (N, 6) in the sensor's axes and LSB, stamps in s.

    Raises:
        InputError: the file cannot be read or has a fault; file, line and column are named.

    Examples:
        >>> import numpy as np, sculler
        >>> sculler.write_log("imu.csv", np.arange(12).reshape(2, 6))
        >>> sculler.read_log("imu.csv").counts.tolist()
        [[0, 1, 2, 3, 4, 5], [6, 7, 8, 9, 10, 11]]
    """
    chunks = list(files.read_log(path, design))
    counts, *others = zip(*chunks, strict=True)
    joined = [None if part[0] is None else np.concatenate(part) for part in others]
    return Log(np.concatenate(counts), *joined[:3])  # a log of channels is refused by now


def write_log(path: str | Path, log: LogLike) -> None:
    """Write an IMU log (integer counts); it appears whole or not at all.

    Args:
        path: of the file; its ending says which kind, `.npz`, `.parquet` or CSV.
        log: a `Log`, an array (N, 6), a frame with the log's columns, or the path of another log;
            the column `sequence` is not written.

    Raises:
        InputError: a value does not fit, or the file cannot be written.

    Examples:
        >>> import numpy as np, sculler
        >>> sculler.write_log("imu.csv", sculler.Log.of(np.ones((3, 6), int), faults=[0, 1, 0]))
        >>> from pathlib import Path
        >>> Path("imu.csv").read_text().splitlines()[2]
        '1,1,1,1,1,1,1'
    """
    samples = as_log(log)
    with (
        replacing(path) as temporary,
        LogWriter(temporary, samples.faults is not None, samples.times is not None) as writer,
    ):
        writer.write(samples.counts, samples.faults, samples.times)
