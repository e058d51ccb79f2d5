"""`sculler convert`: other formats to the integer log the core reads."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sculler import terminal

if TYPE_CHECKING:
    from sculler.conversion import Conversion
    from sculler.readers import Advance, Recording, Unit
    from sculler_model.design import Design

_GYRO_UNITS = ("rad", "deg", "arcsec", "rad/s", "deg/s", "deg/h", "counts")
_ACCEL_UNITS = ("m/s", "ft/s", "m/s2", "g", "mg", "counts")
_TIME_UNITS = ("s", "ms", "us", "ns")


@click.command(
    short_help="Make an integer IMU log of CSV with units, MAT or laser-gyro text.",
    epilog=terminal.examples(
        "sculler convert flight.csv -o log.csv --design stim300 --time-column t \\\n"
        "    --gyro-columns wx,wy,wz --gyro-unit deg/s \\\n"
        "    --accel-columns ax,ay,az --accel-unit g",
        "sculler convert lasergyro.imu -o log.csv --design examples/lasergyro.toml",
        "sculler convert drive.mat -o log.csv --design mems.toml --variable mimu \\\n"
        "    --gyro-unit rad --accel-unit m/s --time-column 7",
    ),
)
@click.argument("log", type=click.Path(path_type=Path))
@terminal.output_option
@click.option("--design", "design_name", metavar="DESIGN", required=True, help="Gives the scales.")
@click.option(
    "--format",
    "log_format",
    type=click.Choice(["auto", "csv", "mat", "psins"]),
    default="auto",
    help="Format of LOG; auto looks at its name and head.",
)
@click.option(
    "--gyro-columns",
    metavar="A,B,C",
    help="Names or numbers (from 1) of the columns x, y, z; gyro_x,gyro_y,gyro_z or 1,2,3 (MAT)"
    " if left out.",
)
@click.option("--accel-columns", metavar="A,B,C", help="The same of the accelerometer.")
@click.option("--time-column", metavar="A", help="A time column, to check the sample rate.")
@click.option("--gyro-unit", type=click.Choice(_GYRO_UNITS), help="Required for CSV and MAT.")
@click.option("--accel-unit", type=click.Choice(_ACCEL_UNITS), help="Required for CSV and MAT.")
@click.option("--time-unit", type=click.Choice(_TIME_UNITS), help="s if left out.")
@click.option(
    "--delimiter",
    metavar="C",
    help="comma, semicolon, tab, space or one character; found out if left out.",
)
@click.option("--skip-rows", type=click.IntRange(min=0), help="Lines of CSV before its header.")
@click.option("--variable", metavar="NAME", help="The matrix of a MAT file.")
@click.option(
    "--axes",
    metavar="MAP",
    help='Turn the axes: "y,x,-z" makes x of the file\'s y, y of its x, z of its -z.',
)
@terminal.json_option
def command(
    log: Path,
    output: Path,
    design_name: str,
    log_format: str,
    axes: str | None,
    as_json: bool,
    **options: Any,
) -> None:
    """Make an integer IMU log of LOG: CSV with units, MAT, or laser-gyro text (.imu).

    Numbers are brought to the design's counts with the remainder carried to the next sample, as a
    pulse-counting sensor does, so no angle is lost.  Rates become increments by the sample interval
    where the sensor counts increments, and the reverse.  Numbers that already are the design's
    counts pass unchanged.
    """
    from sculler.conversion import Conversion
    from sculler.logs import LogWriter
    from sculler_model.navigation.rotation import AxisMap
    from sculler_sim.files import replacing

    design = terminal.load_design(design_name)
    axis_map = None if axes is None else AxisMap.parse(axes)
    if log_format == "auto":
        log_format = _sniff(log)
    with (
        terminal.progress("converting", terminal.file_size(log)) as advance,
        replacing(output) as temporary,
    ):
        recording = _open(log, log_format, design, advance, options)
        conversion = Conversion(log, design, recording, axis_map)
        with LogWriter(temporary, faults=recording.has_faults) as writer:
            for values, faults in recording.chunks:
                writer.write(conversion(values), faults)
    data = _summary(log, output, log_format, design, recording, conversion, axes)
    terminal.report(data, as_json, terminal.facts(_facts(data)), _ranges(data))


def _sniff(log: Path) -> str:
    """Format by the file's name, else by its first line."""
    from sculler.readers.text import open_text

    suffix = log.suffix.lower()
    if suffix in (".mat", ".imu"):
        return {".mat": "mat", ".imu": "psins"}[suffix]
    with open_text(log) as file:
        return "psins" if file.read(200).startswith("% PSINS") else "csv"


_USED_BY = {
    "csv": {
        *("gyro_columns", "accel_columns", "time_column", "gyro_unit", "accel_unit", "time_unit"),
        *("delimiter", "skip_rows"),
    },
    "mat": {
        *("gyro_columns", "accel_columns", "time_column", "gyro_unit", "accel_unit", "time_unit"),
        "variable",
    },
    "psins": set(),
}


def _open(
    log: Path, log_format: str, design: Design, advance: Advance, options: dict[str, Any]
) -> Recording:
    """The recording, by the reader of its format."""
    for name, value in options.items():
        if value is not None and name not in _USED_BY[log_format]:
            raise click.UsageError(
                f"--{name.replace('_', '-')} is not used for format {log_format}, leave it out"
            )
    if log_format == "psins":
        from sculler.readers.psins import read_psins

        return read_psins(log, design, advance)

    from sculler.readers.timing import TIME_UNITS, TimeCheck

    gyro, accel = _units(options)
    time_check = TimeCheck(log, design, TIME_UNITS[options["time_unit"] or "s"])
    time = options["time_column"]
    if log_format == "mat":
        from sculler.readers.mat import read_mat

        columns = _triple(options, "gyro", "1,2,3") + _triple(options, "accel", "4,5,6")
        numbers = [_number(column) for column in columns]
        time_number = None if time is None else _number(time)
        return read_mat(
            log, options["variable"], numbers, time_number, gyro, accel, time_check, advance
        )

    from sculler.readers.delimited import DELIMITERS, Layout, read_delimited

    delimiter = options["delimiter"]
    if delimiter is not None and delimiter not in DELIMITERS and len(delimiter) != 1:
        raise click.UsageError(
            f"--delimiter: {delimiter!r} is not known, give {', '.join(DELIMITERS)} or one"
            " character"
        )
    columns = _triple(options, "gyro", "gyro_x,gyro_y,gyro_z")
    columns += _triple(options, "accel", "accel_x,accel_y,accel_z")
    layout = Layout(columns, time, delimiter, options["skip_rows"] or 0)
    return read_delimited(log, layout, gyro, accel, time_check, advance)


def _units(options: dict[str, Any]) -> tuple[Unit, Unit]:
    from sculler.readers import ACCEL_UNITS, GYRO_UNITS

    for name, known in (("gyro_unit", _GYRO_UNITS), ("accel_unit", _ACCEL_UNITS)):
        if options[name] is None:
            raise click.UsageError(
                f"--{name.replace('_', '-')} is missing, give one of {', '.join(known)}"
            )
    return GYRO_UNITS[options["gyro_unit"]], ACCEL_UNITS[options["accel_unit"]]


def _triple(options: dict[str, Any], sensor: str, default: str) -> list[str]:
    text = options[f"{sensor}_columns"] or default
    columns = [column.strip() for column in text.split(",")]
    if len(columns) != 3 or not all(columns) or len(set(columns)) != 3:
        raise click.UsageError(
            f"--{sensor}-columns: {text!r} is not allowed, give three different columns x,y,z"
        )
    return columns


def _number(column: str) -> int:
    if not column.isdecimal():
        raise click.UsageError(f"column {column!r} is not allowed, MAT columns are numbers from 1")
    return int(column)


def _summary(
    log: Path,
    output: Path,
    log_format: str,
    design: Design,
    recording: Recording,
    conversion: Conversion,
    axes: str | None,
) -> dict[str, Any]:
    from sculler.logs import COUNTS

    bits = {"gyro": design.sensor.gyro.bits, "accel": design.sensor.accel.bits}
    lsb = {"gyro": design.sensor.gyro.lsb, "accel": design.sensor.accel.lsb}
    units = {"gyro": recording.gyro.name, "accel": recording.accel.name}
    return {
        "log": str(log),
        "format": log_format,
        "output": str(output),
        "design": design.name,
        "kind": design.sensor.kind,
        "samples": conversion.samples,
        "seconds": conversion.samples * design.sample_interval,
        "axes": axes or "x,y,z",
        "notes": dict(recording.notes),
        "sensors": {
            sensor: {
                "unit": units[sensor],
                "unchanged": conversion.passes(sensor),
                "made": conversion.made(sensor),
                "lsb": lsb[sensor],
                "bits": bits[sensor],
            }
            for sensor in ("gyro", "accel")
        },
        "columns": {
            column: {
                "largest_count": int(largest),
                "share_of_full_scale": int(largest) / 2 ** (bits[column.split("_")[0]] - 1),
                "remainder": left,
            }
            for column, largest, left in zip(
                COUNTS, conversion.largest, conversion.remainder, strict=True
            )
        },
    }


def _facts(data: dict[str, Any]) -> dict[str, str]:
    rows = {
        "read": f"{data['log']} (format {data['format']})",
        "samples": f"{data['samples']:,}, {data['seconds']:,.6g} s",
    }
    rows |= {sensor: facts["made"] for sensor, facts in data["sensors"].items()}
    if data["axes"] != "x,y,z":
        rows["axes"] = data["axes"]
    return {**rows, **data["notes"], "wrote": data["output"]}


def _ranges(data: dict[str, Any]) -> Any:
    from rich.table import Table

    table = Table()
    for column in ("column", "largest count", "of full scale", "remainder left"):
        table.add_column(column, justify="left" if column == "column" else "right")
    for name, facts in data["columns"].items():
        sensor = name.split("_")[0]
        unit = {"gyro": "rad", "accel": "m/s"}[sensor] + ("/s" if data["kind"] == "rate" else "")
        unchanged = data["sensors"][sensor]["unchanged"]
        table.add_row(
            name,
            f"{facts['largest_count']:,}",
            f"{100 * facts['share_of_full_scale']:.3g} %",
            "none" if unchanged else f"{facts['remainder']:.3g} {unit}",
        )
    return table
