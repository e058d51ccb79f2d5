"""What a conversion is asked for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from sculler.formats.calibration import read_calibration
from sculler.readers import registry
from sculler.readers.columns import split_sign
from sculler.readers.format import Request
from sculler.readers.mounting import Mounting, parse_vector
from sculler.readers.recording import (
    ACCEL_BIAS_UNITS,
    ACCEL_UNITS,
    ANGLE_UNITS,
    GYRO_BIAS_UNITS,
    GYRO_UNITS,
    Advance,
    Recording,
)
from sculler.readers.running_sums import Differences
from sculler.readers.timing import Gaps, Steps
from sculler.runs.conversion.counts import Biases
from sculler_model.design import Design
from sculler_model.errors import ContradictionError
from sculler_model.frames import Vector
from sculler_model.samples import Undo

MAX_GAP = 1.0
"""s; the longest gap that is bridged where nothing else is asked for."""


@dataclass(frozen=True)
class Layout:
    """How the numbers lie in the file; None where its format, or the file, says it.

    Attributes:
        gyro_columns, accel_columns: "x,y,z", names or numbers from 1, a minus before those meant
            negative; or the name of one array of three.
        time_column: a name or number; "none" leaves stamps out.
        gyro_unit, accel_unit: names of `GYRO_UNITS` and `ACCEL_UNITS`.
        gyro_scale, accel_scale: how many of its unit the number 1 is.
        time_unit: a name of `TIME_UNITS`.
        delimiter: comma, semicolon, tab, space or one character.
        skip_rows: lines of CSV before its header.
        variable: a matrix of a MAT, HDF5 or npz file.
        topic: of a ROS bag.
    """

    gyro_columns: str | None = None
    accel_columns: str | None = None
    time_column: str | None = None
    gyro_unit: str | None = None
    accel_unit: str | None = None
    gyro_scale: float | None = None
    accel_scale: float | None = None
    time_unit: str | None = None
    delimiter: str | None = None
    skip_rows: int | None = None
    variable: str | None = None
    topic: str | None = None

    def columns(self, sensor: str) -> list[str] | None:
        """The columns of a sensor as they are given.

        Raises:
            ContradictionError: one of them is empty.
        """
        text: str | None = getattr(self, f"{sensor}_columns")
        if text is None:
            return None
        columns = [column.strip() for column in text.split(",")]
        if not all(columns):
            raise ContradictionError(f"--{sensor}-columns: {text!r} is not allowed, give x,y,z")
        return columns

    def signs(self) -> list[float]:
        """The signs of the six columns."""
        signs: list[float] = []
        for sensor in ("gyro", "accel"):
            each = [split_sign(column)[0] for column in self.columns(sensor) or ["x"] * 3]
            signs += each * 3 if len(each) == 1 else each
        return signs

    def given(self) -> Mapping[str, Any]:
        """What is said, by name."""
        said = {name: value for name, value in vars(self).items() if value is not None}
        if said.get("time_column") == "none":
            del said["time_column"]
        return said


@dataclass(frozen=True)
class RunningSums:
    """The numbers are running sums, as counters send them.

    Attributes:
        sensors: which of them sends such.
        bits: width at which the sums wrap; None to find it out.
    """

    sensors: Literal["both", "gyro", "accel"] = "both"
    bits: int | None = None

    def differences(self, log: Path, recording: Recording) -> Differences:
        """What makes increments of them.

        Raises:
            ContradictionError: they are sums of rates.
        """
        columns = {"both": range(6), "gyro": range(3), "accel": range(3, 6)}[self.sensors]
        kinds = [recording.gyro.kind] * 3 + [recording.accel.kind] * 3
        if any(kinds[column] == "rate" for column in columns):
            raise ContradictionError(
                "--cumulative takes running sums of increments, give their units (rad, deg, arcsec,"
                " m/s, ft/s or counts), not those of rates"
            )
        return Differences(log, columns, self.bits)


@dataclass(frozen=True)
class Plan:
    """How to convert a log.

    Attributes:
        design: gives kind, scales and widths.
        log: the file.
        log_format: a name of `registry.MODULES`; "auto" looks at what is in the file.
        layout: how its numbers lie.
        sums: the numbers are running sums; None if they are not.
        rates: what rates are: values at the instant of their stamp, or means over the interval
            that ends there.
        steps: samples one interval apart whatever the stamps say, or resampled by them.
        gaps: what to do where stamps lack.
        max_gap: the longest to bridge, s; None for `MAX_GAP`.
        start, stop: of the file's clock, s; None for its beginning and end.
        axes: how the axes are turned; None for not at all.
        misalignment: rotation vector in the file's axes, as a user writes it.
        gyro_bias, accel_bias: taken off first, as a user writes them.
        calibration: a file of errors of the sensor, taken out last, in the log's axes.

    Raises:
        ContradictionError: `max_gap` without bridging.
    """

    design: Design
    log: Path
    log_format: str = "auto"
    layout: Layout = field(default_factory=Layout)
    sums: RunningSums | None = None
    rates: Literal["instant", "mean"] = "instant"
    steps: Steps = "even"
    gaps: Gaps = "refuse"
    max_gap: float | None = None
    start: float | None = None
    stop: float | None = None
    axes: str | None = None
    misalignment: str | None = None
    gyro_bias: str | None = None
    accel_bias: str | None = None
    calibration: Path | None = None

    def __post_init__(self) -> None:
        if self.max_gap is not None and self.gaps != "bridge":
            raise ContradictionError("--max-gap goes with --gaps bridge, give both or leave it out")

    def open(self, log_format: str, advance: Advance) -> Recording:
        """The recording, by the reader of its format.

        Raises:
            ContradictionError: the layout says what this format's reader does not use.
            InputError: the file has a fault.
        """
        reader, layout = registry.find(log_format), self.layout
        for name in layout.given():
            if name not in reader.options:
                raise ContradictionError(
                    f"--{name.replace('_', '-')} is not used for format {log_format}, leave it out"
                )
        request = Request(
            self.design,
            advance,
            gyro_columns=layout.columns("gyro"),
            accel_columns=layout.columns("accel"),
            time=None if layout.time_column == "none" else layout.time_column,
            time_unit=layout.time_unit,
            gyro=None if layout.gyro_unit is None else GYRO_UNITS[layout.gyro_unit],
            accel=None if layout.accel_unit is None else ACCEL_UNITS[layout.accel_unit],
            gyro_scale=layout.gyro_scale,
            accel_scale=layout.accel_scale,
            delimiter=layout.delimiter,
            skip_rows=layout.skip_rows or 0,
            variable=layout.variable,
            topic=layout.topic,
        )
        return reader.open(self.log, request)

    def found_format(self) -> str:
        """The format asked for, or the one found out."""
        if self.log_format != "auto":
            return self.log_format
        from sculler.readers.detect import detect

        layout = self.layout
        columns_given = layout.gyro_columns is not None or layout.accel_columns is not None
        front = self.design.hardware.front
        if front is not None and front.frame is not None and not columns_given:
            from sculler.readers.raw.front import are_frames

            if are_frames(self.log, front.frame.layout):
                return "front"
        return detect(self.log, layout.delimiter, layout.skip_rows or 0, columns_given)

    def mounting(self, log_format: str) -> Mounting:
        """From the file's axes to the log's."""
        turn = self._vector("--misalignment", self.misalignment, log_format, ANGLE_UNITS)
        return Mounting.parse(self.axes, turn)

    def biases(self, log_format: str) -> Biases:
        """What is taken off first."""
        return Biases(
            self._vector("--gyro-bias", self.gyro_bias, log_format, GYRO_BIAS_UNITS),
            self._vector("--accel-bias", self.accel_bias, log_format, ACCEL_BIAS_UNITS),
        )

    def undo(self) -> Undo | None:
        """What takes the sensor's known errors out; None for nothing.

        Raises:
            InputError: the calibration file has a fault.
        """
        if self.calibration is None:
            return None
        return Undo(self.design, read_calibration(self.calibration))

    def _vector(
        self, option: str, text: str | None, log_format: str, units: dict[str, float]
    ) -> Vector:
        """A vector in SI: three numbers with a unit, or the name of a MAT file's variable."""
        if text is None:
            return (0.0, 0.0, 0.0)
        if text.replace(".", "_").isidentifier() and log_format in ("mat", "hdf5"):
            from sculler.readers.mat import mat_vector

            return mat_vector(self.log, text)
        return parse_vector(option, text, units)
