"""Options of `convert`, in groups, and what they ask for as a `Plan`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sculler import terminal
from sculler.commands.options.group import group
from sculler.readers import registry

if TYPE_CHECKING:
    from sculler.runs.conversion import Plan
    from sculler_model.design import Design

_GYRO_UNITS = ("rad", "deg", "arcsec", "rad/s", "deg/s", "deg/h", "counts")
_ACCEL_UNITS = ("m/s", "ft/s", "m/s2", "g", "mg", "counts")
_TIME_UNITS = ("s", "ms", "us", "ns")
_LAYOUT = (
    *("gyro_columns", "accel_columns", "time_column", "gyro_unit", "accel_unit", "gyro_scale"),
    *("accel_scale", "time_unit", "delimiter", "skip_rows", "variable", "topic"),
)
_REST = (
    *("rates", "steps", "gaps", "max_gap", "start", "stop"),
    *("axes", "misalignment", "gyro_bias", "accel_bias", "calibration"),
)

layout_options = group(
    click.option(
        "--format",
        "log_format",
        type=click.Choice(["auto", *registry.MODULES]),
        default="auto",
        help="Format of LOG; auto looks at what is in it.",
    ),
    click.option(
        "--gyro-columns",
        metavar="A,B,C",
        help="Names or numbers (from 1) of the columns x, y, z, -B for the negative of B, or the"
        " name of one array of three (MAT, npz; imu.gyro in a structure); those of the format if"
        " left out, or gyro_x,gyro_y,gyro_z.",
    ),
    click.option("--accel-columns", metavar="A,B,C", help="The same of the accelerometer."),
    click.option(
        "--time-column", metavar="A", help="A time column, or none; that of the format if left out."
    ),
    click.option(
        "--gyro-unit",
        type=click.Choice(_GYRO_UNITS),
        help="Required for CSV, MAT, npz and Parquet, unless the file says it; of raw datagrams"
        " those of the sensor, or counts for the design's own.",
    ),
    click.option("--accel-unit", type=click.Choice(_ACCEL_UNITS), help="The same."),
    click.option(
        "--gyro-scale",
        type=terminal.number_type(0, above=True),
        metavar="X",
        help="How many of its unit the number 1 is, of columns or datagrams that count.",
    ),
    click.option(
        "--accel-scale", type=terminal.number_type(0, above=True), metavar="X", help="The same."
    ),
    click.option(
        "--time-unit", type=click.Choice(_TIME_UNITS), help="s if left out and not known."
    ),
    click.option(
        "--delimiter",
        metavar="C",
        help="comma, semicolon, tab, space or one character; found out if left out.",
    ),
    click.option("--skip-rows", type=click.IntRange(min=0), help="Lines of CSV before its header."),
    click.option("--variable", metavar="NAME", help="A matrix of a MAT, HDF5 or npz file."),
    click.option("--topic", metavar="NAME", help="The topic of a ROS bag, where it has several."),
)
"""How the numbers lie in the file."""

running_sums_options = group(
    click.option(
        "--cumulative",
        is_flag=True,
        help="The numbers are running sums, as counters send them: take their differences.",
    ),
    click.option(
        "--cumulative-of",
        type=click.Choice(["both", "gyro", "accel"]),
        default="both",
        show_default=True,
        help="Which of the sensors sends running sums.",
    ),
    click.option(
        "--cumulative-bits",
        type=click.IntRange(min=8, max=48),
        help="Width at which the sums wrap; found out if left out.",
    ),
)
"""Numbers that count on."""

stamp_options = group(
    click.option(
        "--rates",
        type=click.Choice(["instant", "mean"]),
        default="instant",
        show_default=True,
        help="What rates are: values at the instant of their stamp, integrated by cubics; or means"
        " over the interval that ends there, multiplied by it.",
    ),
    click.option(
        "--steps",
        type=click.Choice(["even", "resample"]),
        default="even",
        show_default=True,
        help="Samples are one interval apart whatever the stamps say; or go by the stamps and"
        " resample to even steps, no angle lost.",
    ),
    click.option(
        "--gaps",
        type=click.Choice(["refuse", "bridge", "ignore"]),
        default="refuse",
        show_default=True,
        help="Where stamps are more than 1.5 intervals apart: refuse; fill in samples on the"
        " straight line, marked as faults; or go on as if there were none.",
    ),
    click.option(
        "--max-gap",
        type=terminal.number_type(0, 600, above=True),
        metavar="SECONDS",
        help="The longest gap to bridge; 1 s if left out.",
    ),
    click.option(
        "--start",
        type=terminal.number_type(),
        metavar="SECONDS",
        help="Begin at this time of the file's clock (increments whose interval ends after it).",
    ),
    click.option(
        "--stop", type=terminal.number_type(), metavar="SECONDS", help="End at this time of it."
    ),
)
"""What becomes of rates, steps and gaps."""

mounting_options = group(
    click.option(
        "--gyro-bias",
        metavar="X,Y,Z",
        help='Take this off, in the file\'s axes: rad/s, or "X,Y,Z deg/h", deg/s; or the name of a'
        " vector in a MAT file.",
    ),
    click.option(
        "--accel-bias", metavar="X,Y,Z", help='The same: m/s², or "X,Y,Z mg", ug, g; or a name.'
    ),
    click.option(
        "--misalignment",
        metavar="X,Y,Z",
        help='Turn the vectors by this rotation vector in the file\'s axes: rad, or "X,Y,Z deg",'
        " mrad, arcmin, arcsec; or a name.",
    ),
    click.option(
        "--axes",
        metavar="MAP",
        help='Turn the axes: "y,x,-z" makes x of the file\'s y, y of its x, z of its -z; or where'
        ' the file\'s axes point, "RFU" for right, forward, up, to make forward, right, down of'
        " them.",
    ),
    click.option(
        "--calibration",
        type=terminal.InputFile(Path),
        metavar="FILE",
        help="Take these errors of the sensor out, in the log's axes: TOML with the tables of"
        " [sensor.errors], of numbers: bias, scale factor, misalignment, asymmetry, square,"
        " g-sensitivity, delay of the accelerometers, their lever arms (size effect).",
    ),
)
"""What becomes of the axes, and of the sensor's errors."""


def plan(design: Design, log: Path, options: Mapping[str, Any]) -> Plan:
    """What the options ask for.

    Args:
        design: gives kind, scales and widths.
        log: the file.
        options: the verb's, of all groups above, by their names in Python.

    Raises:
        ContradictionError: options do not go together.
    """
    from sculler.runs.conversion import Layout, Plan, RunningSums
    from sculler_model.errors import ContradictionError

    sensors, bits = options["cumulative_of"], options["cumulative_bits"]
    if not options["cumulative"] and (bits is not None or sensors != "both"):
        raise ContradictionError(
            "--cumulative-of and --cumulative-bits go with --cumulative, give it too"
        )
    return Plan(
        design,
        log,
        options["log_format"],
        Layout(**{name: options[name] for name in _LAYOUT}),
        RunningSums(sensors, bits) if options["cumulative"] else None,
        **{name: options[name] for name in _REST},
    )
