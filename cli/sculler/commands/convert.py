"""`sculler convert`: other formats to the integer log the core reads."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sculler import terminal

if TYPE_CHECKING:
    from sculler.conversion import Biases, Conversion
    from sculler.mounting import Mounting
    from sculler.readers import Advance, Recording, Samples, Unit
    from sculler.readers.running_sums import Differences
    from sculler.readers.timing import Gaps, Steps
    from sculler_model.design import Design
    from sculler_model.navigation.rotation import Vector
    from sculler_model.sampling import Kind, Resampler

_FORMATS = ("csv", "euroc", "ros", "kfgins", "kfgins-binary", "mat", "npz", "parquet", "psins")
_GYRO_UNITS = ("rad", "deg", "arcsec", "rad/s", "deg/s", "deg/h", "counts")
_ACCEL_UNITS = ("m/s", "ft/s", "m/s2", "g", "mg", "counts")
_TIME_UNITS = ("s", "ms", "us", "ns")
_MAX_GAP = 1.0


@click.command(
    short_help="Make an integer IMU log of CSV, EuRoC, ROS, KF-GINS, MAT, npz, Parquet ...",
    epilog=terminal.examples(
        "sculler convert flight.csv -o log.csv --design stim300 --time-column t \\\n"
        "    --gyro-columns wx,wy,wz --gyro-unit deg/s \\\n"
        "    --accel-columns ax,ay,az --accel-unit g --axes RFU --gaps bridge",
        "sculler convert mav0/imu0/data.csv -o log.csv --design adis.toml --steps resample",
        "sculler convert lasergyro.imu -o log.csv --design examples/lasergyro.toml",
        "sculler convert drive.mat -o log.csv --design mems.toml --variable mimu \\\n"
        "    --gyro-unit rad --accel-unit m/s --time-column 7 \\\n"
        "    --gyro-bias eb0 --accel-bias db0 --misalignment mu0",
    ),
)
@click.argument("log", type=terminal.InputFile(Path))
@terminal.output_option
@click.option("--design", "design_name", metavar="DESIGN", required=True, help="Gives the scales.")
@click.option(
    "--format",
    "log_format",
    type=click.Choice(["auto", *_FORMATS]),
    default="auto",
    help="Format of LOG; auto looks at what is in it.",
)
@click.option(
    "--gyro-columns",
    metavar="A,B,C",
    help="Names or numbers (from 1) of the columns x, y, z, -B for the negative of B; those of the"
    " format, gyro_x,gyro_y,gyro_z or 1,2,3 (MAT) if left out.",
)
@click.option("--accel-columns", metavar="A,B,C", help="The same of the accelerometer.")
@click.option(
    "--time-column", metavar="A", help="A time column, or none; that of the format if left out."
)
@click.option(
    "--gyro-unit",
    type=click.Choice(_GYRO_UNITS),
    help="Required for CSV, MAT, npz and Parquet, unless the file says it.",
)
@click.option("--accel-unit", type=click.Choice(_ACCEL_UNITS), help="The same.")
@click.option("--time-unit", type=click.Choice(_TIME_UNITS), help="s if left out and not known.")
@click.option(
    "--delimiter",
    metavar="C",
    help="comma, semicolon, tab, space or one character; found out if left out.",
)
@click.option("--skip-rows", type=click.IntRange(min=0), help="Lines of CSV before its header.")
@click.option("--variable", metavar="NAME", help="The matrix of a MAT file.")
@click.option(
    "--cumulative",
    is_flag=True,
    help="The numbers are running sums, as counters send them: take their differences.",
)
@click.option(
    "--cumulative-of",
    type=click.Choice(["both", "gyro", "accel"]),
    default="both",
    show_default=True,
    help="Which of the sensors sends running sums.",
)
@click.option(
    "--cumulative-bits",
    type=click.IntRange(min=8, max=48),
    help="Width at which the sums wrap; found out if left out.",
)
@click.option(
    "--rates",
    type=click.Choice(["instant", "mean"]),
    default="instant",
    show_default=True,
    help="What rates are: values at the instant of their stamp, integrated by cubics; or means over"
    " the interval that ends there, multiplied by it.",
)
@click.option(
    "--steps",
    type=click.Choice(["even", "resample"]),
    default="even",
    show_default=True,
    help="Samples are one interval apart whatever the stamps say; or go by the stamps and resample"
    " to even steps, no angle lost.",
)
@click.option(
    "--gaps",
    type=click.Choice(["refuse", "bridge", "ignore"]),
    default="refuse",
    show_default=True,
    help="Where stamps are more than 1.5 intervals apart: refuse; fill in samples on the straight"
    " line, marked as faults; or go on as if there were none.",
)
@click.option(
    "--max-gap",
    type=terminal.number_type(0, 600, above=True),
    metavar="SECONDS",
    help=f"The longest gap to bridge; {_MAX_GAP:g} s if left out.",
)
@click.option(
    "--start",
    type=terminal.number_type(),
    metavar="SECONDS",
    help="Begin at this time of the file's clock (increments whose interval ends after it).",
)
@click.option(
    "--stop", type=terminal.number_type(), metavar="SECONDS", help="End at this time of it."
)
@click.option(
    "--gyro-bias",
    metavar="X,Y,Z",
    help='Take this off, in the file\'s axes: rad/s, or "X,Y,Z deg/h", deg/s; or the name of a'
    " vector in a MAT file.",
)
@click.option(
    "--accel-bias", metavar="X,Y,Z", help='The same: m/s², or "X,Y,Z mg", ug, g; or a name.'
)
@click.option(
    "--misalignment",
    metavar="X,Y,Z",
    help='Turn the vectors by this rotation vector in the file\'s axes: rad, or "X,Y,Z deg",'
    " mrad, arcmin, arcsec; or a name.",
)
@click.option(
    "--axes",
    metavar="MAP",
    help='Turn the axes: "y,x,-z" makes x of the file\'s y, y of its x, z of its -z; or where the'
    ' file\'s axes point, "RFU" for right, forward, up, to make forward, right, down of them.',
)
@terminal.json_option
def command(
    log: Path,
    output: Path,
    design_name: str,
    log_format: str,
    rates: str,
    steps: Steps,
    axes: str | None,
    gyro_bias: str | None,
    accel_bias: str | None,
    misalignment: str | None,
    as_json: bool,
    gaps: Gaps,
    max_gap: float | None,
    start: float | None,
    stop: float | None,
    cumulative: bool,
    cumulative_of: str,
    cumulative_bits: int | None,
    **options: Any,
) -> None:
    """Make an integer IMU log of LOG.

    LOG is CSV with units, EuRoC's or ROS's CSV, increments of KF-GINS (text or binary), MAT, .npz,
    Parquet, or laser-gyro text (.imu).  Numbers are brought to the design's counts with the
    remainder carried to the next sample, as a pulse-counting sensor does, so no angle is lost.
    Rates become increments where the sensor counts increments, and the reverse.  Numbers that
    already are the design's counts pass unchanged.  Time stamps are checked against the sample
    rate; gaps and unequal steps are told.

    An .npz file has the arrays gyro and accel, (N, 3), or dtheta (rad) and dvel (m/s); and may have
    time, (N,), fault, (N,), and the strings gyro_unit, accel_unit and time_unit.
    """
    from sculler.conversion import Conversion
    from sculler.logs import LogWriter
    from sculler.origin import write_origin
    from sculler.readers import timing_told
    from sculler.readers.preparation import Watch, bounded, differenced, signed, unstamped
    from sculler.readers.timing import Timing, resampled
    from sculler_model import inputs
    from sculler_model.errors import InputError
    from sculler_sim.files import replacing

    design = terminal.load_design(design_name)
    if max_gap is not None and gaps != "bridge":
        raise click.UsageError("--max-gap goes with --gaps bridge, give both or leave it out")
    inputs.require_file(log, "log")
    log_format = _format(log, log_format, options)
    mounting = _mounting(log, log_format, axes, misalignment)
    biases = _biases(log, log_format, gyro_bias, accel_bias)
    with (
        terminal.progress("converting", terminal.file_size(log)) as advance,
        replacing(output) as temporary,
    ):
        without_stamps = options["time_column"] == "none"
        if without_stamps:
            options["time_column"] = None
        recording = bounded(log, _open(log, log_format, design, advance, options))
        recording = signed(recording, _signs(options))
        differences = _differences(log, recording, cumulative, cumulative_of, cumulative_bits)
        if differences is not None:
            recording = differenced(recording, differences)
        if without_stamps:
            recording = unstamped(recording)
        given = _kind(design, recording, rates, steps)
        watch = Watch(design, recording, differences is not None)
        chunks: Iterator[Samples] = watch(recording.chunks)
        timing = None
        if recording.clock is not None:
            timing = Timing(
                log, design, recording, given, gaps, max_gap or _MAX_GAP, steps, start, stop
            )
            chunks = timing(chunks)
        elif gaps == "bridge" or steps == "resample" or start is not None or stop is not None:
            raise click.UsageError(
                "--gaps bridge, --steps resample, --start and --stop need time stamps, give"
                " --time-column"
            )
        resampler = _resampler(design, given, rates, steps)
        if resampler is not None:
            chunks = resampled(chunks, resampler, design.sample_interval, steps)
        gyro, accel = (
            _unit(design, unit, given, resampler) for unit in (recording.gyro, recording.accel)
        )
        reworked = gaps == "bridge" or resampler is not None
        conversion = Conversion(log, design, gyro, accel, mounting, biases, reworked)
        faults = recording.has_faults or gaps == "bridge"
        clock, to_instant = recording.clock, _to_instant(design, given, rates, resampler)
        with LogWriter(temporary, faults=faults, times=clock is not None) as writer:
            for chunk in chunks:
                times = None
                if clock is not None and chunk.times is not None:
                    times = chunk.times + (clock.origin + to_instant)
                try:
                    counts = conversion(chunk.values)
                except InputError as error:
                    raise InputError("; ".join([str(error), *watch.sums()])) from error
                writer.write(counts, chunk.faults, times)
        if not conversion.samples:
            raise InputError(
                f"{log}: too few samples to make an increment of (or none from --start to --stop),"
                " give more"
            )
    data = _summary(log, output, log_format, design, recording, conversion)
    data |= {
        "axes": axes or "x,y,z",
        "mounting": mounting.rows(),
        "biases": asdict(biases),
        "misalignment": mounting.misalignment,
        "timing": None,
        "warnings": [*conversion.hints(), *watch.warnings()],
    }
    if timing is not None:
        data["timing"] = timing_told.as_json(timing, design, gaps, steps)
        data["warnings"] += timing_told.warnings(timing, design, gaps, steps)
    if differences is not None:
        data["notes"]["running sums"] = differences.told()
    if resampler is not None and timing is not None:
        data["timing"]["left_out_s"] = resampler.left_out
    write_origin(output, {"source": log, "design": design_name}, data)
    terminal.report(
        data, as_json, terminal.facts(_facts(data)), *_mounting_table(data),
        *timing_told.gaps_table(data["timing"]), _ranges(data)
    )  # fmt: skip


def _format(log: Path, log_format: str, options: dict[str, Any]) -> str:
    """The format asked for, or the one found out."""
    if log_format != "auto":
        return log_format
    from sculler.readers.detect import detect

    columns_given = options["gyro_columns"] is not None or options["accel_columns"] is not None
    delimiter = _delimiter(options)
    return detect(log, delimiter, options["skip_rows"] or 0, columns_given)


_UNITS = {"gyro_unit", "accel_unit"}
_COLUMNS = {"gyro_columns", "accel_columns", "time_column", "time_unit"} | _UNITS
_USED_BY = {
    "csv": _COLUMNS | {"delimiter", "skip_rows"},
    "euroc": _UNITS | {"time_column", "time_unit", "delimiter", "skip_rows"},
    "ros": _UNITS | {"time_column", "time_unit", "delimiter", "skip_rows"},
    "kfgins": _UNITS,
    "kfgins-binary": _UNITS,
    "mat": _COLUMNS | {"variable"},
    "npz": _UNITS | {"time_unit"},
    "parquet": _COLUMNS,
    "psins": set(),
}
_USUAL_UNITS = {
    "euroc": ("rad/s", "m/s2"),
    "ros": ("rad/s", "m/s2"),
    "kfgins": ("rad", "m/s"),
    "kfgins-binary": ("rad", "m/s"),
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
    time, time_unit = options["time_column"], options["time_unit"]
    if log_format in ("npz", "parquet"):
        from sculler.readers.arrays import read_npz, read_parquet

        gyro_or_none, accel_or_none = _optional_units(options)
        if log_format == "npz":
            return read_npz(log, gyro_or_none, accel_or_none, time_unit, advance)
        columns = _columns(options, None)
        return read_parquet(log, columns, time, time_unit, gyro_or_none, accel_or_none, advance)

    gyro, accel = _units(options, log_format)
    if log_format in ("kfgins", "kfgins-binary"):
        from sculler.readers.kfgins import read_kfgins, read_kfgins_binary

        read = read_kfgins if log_format == "kfgins" else read_kfgins_binary
        return read(log, gyro, accel, advance)
    if log_format == "mat":
        from sculler.readers.mat import read_mat

        numbers = [_number(column) for column in _columns(options, "1,2,3 4,5,6") or ()]
        time_number = None if time is None else _number(time)
        return read_mat(
            log, options["variable"], numbers, time_number, gyro, accel, time_unit or "s", advance
        )

    from sculler.readers.delimited import Layout, read_delimited

    layout = Layout(
        _columns(options, None),
        time,
        time_unit,
        _delimiter(options),
        options["skip_rows"] or 0,
        None if log_format == "csv" else log_format,
    )
    return read_delimited(log, layout, gyro, accel, advance)


def _delimiter(options: dict[str, Any]) -> str | None:
    from sculler.readers.delimited import DELIMITERS

    delimiter: str | None = options["delimiter"]
    if delimiter is not None and delimiter not in DELIMITERS and len(delimiter) != 1:
        raise click.UsageError(
            f"--delimiter: {delimiter!r} is not known, give {', '.join(DELIMITERS)} or one"
            " character"
        )
    return delimiter


def _units(options: dict[str, Any], log_format: str) -> tuple[Unit, Unit]:
    """The units asked for, or those that the format always has."""
    gyro, accel = _optional_units(options)
    usual_gyro, usual_accel = _USUAL_UNITS.get(log_format, (None, None))
    from sculler.readers import ACCEL_UNITS, GYRO_UNITS

    if gyro is None and usual_gyro is not None:
        gyro = GYRO_UNITS[usual_gyro]
    if accel is None and usual_accel is not None:
        accel = ACCEL_UNITS[usual_accel]
    for unit, name, known in ((gyro, "gyro", _GYRO_UNITS), (accel, "accel", _ACCEL_UNITS)):
        if unit is None:
            raise click.UsageError(f"--{name}-unit is missing, give one of {', '.join(known)}")
    assert gyro is not None
    assert accel is not None
    return gyro, accel


def _optional_units(options: dict[str, Any]) -> tuple[Unit | None, Unit | None]:
    from sculler.readers import ACCEL_UNITS, GYRO_UNITS

    gyro, accel = options["gyro_unit"], options["accel_unit"]
    return (
        None if gyro is None else GYRO_UNITS[gyro],
        None if accel is None else ACCEL_UNITS[accel],
    )


def _columns(options: dict[str, Any], defaults: str | None) -> list[str] | None:
    """The six columns; None if none are given and there are no defaults."""
    given = [options["gyro_columns"], options["accel_columns"]]
    if given == [None, None] and defaults is None:
        return None
    gyro, accel = (defaults or "gyro_x,gyro_y,gyro_z accel_x,accel_y,accel_z").split()
    return _triple(options, "gyro", gyro) + _triple(options, "accel", accel)


def _triple(options: dict[str, Any], sensor: str, default: str) -> list[str]:
    from sculler.readers.columns import split_sign

    text = options[f"{sensor}_columns"] or default
    columns = [column.strip() for column in text.split(",")]
    bare = {split_sign(column)[1] for column in columns}
    if len(columns) != 3 or not all(columns) or len(bare) != 3:
        raise click.UsageError(
            f"--{sensor}-columns: {text!r} is not allowed, give three different columns x,y,z"
        )
    return columns


def _signs(options: dict[str, Any]) -> list[float]:
    """The signs of the six columns."""
    from sculler.readers.columns import split_sign

    columns = _columns(options, None) or ["x"] * 6
    return [split_sign(column)[0] for column in columns]


def _differences(
    log: Path, recording: Recording, cumulative: bool, sensors: str, bits: int | None
) -> Differences | None:
    """What makes increments of running sums; None where the numbers are none."""
    from sculler.readers.running_sums import Differences

    if not cumulative:
        if bits is not None or sensors != "both":
            raise click.UsageError(
                "--cumulative-of and --cumulative-bits go with --cumulative, give it too"
            )
        return None
    columns = {"both": range(6), "gyro": range(3), "accel": range(3, 6)}[sensors]
    kinds = [recording.gyro.kind] * 3 + [recording.accel.kind] * 3
    if any(kinds[column] == "rate" for column in columns):
        raise click.UsageError(
            "--cumulative takes running sums of increments, give their units (rad, deg, arcsec,"
            " m/s, ft/s or counts), not those of rates"
        )
    return Differences(log, columns, bits)


def _number(column: str) -> int:
    from sculler.readers.columns import split_sign

    _, column = split_sign(column)
    if not column.isdecimal():
        raise click.UsageError(f"column {column!r} is not allowed, MAT columns are numbers from 1")
    return int(column)


def _vector(
    option: str, text: str | None, log: Path, log_format: str, units: dict[str, float]
) -> Vector:
    """A vector option in SI: three numbers with a unit, or the name of a MAT file's variable."""
    from sculler.mounting import parse_vector

    if text is None:
        return (0.0, 0.0, 0.0)
    if text.isidentifier() and log_format == "mat":
        from sculler.readers.mat import mat_vector

        return mat_vector(log, text)
    return parse_vector(option, text, units)


def _mounting(log: Path, log_format: str, axes: str | None, misalignment: str | None) -> Mounting:
    from sculler.mounting import Mounting
    from sculler.readers import ANGLE_UNITS

    turn = _vector("--misalignment", misalignment, log, log_format, ANGLE_UNITS)
    return Mounting.parse(axes, turn)


def _biases(log: Path, log_format: str, gyro: str | None, accel: str | None) -> Biases:
    from sculler.conversion import Biases
    from sculler.readers import ACCEL_BIAS_UNITS, GYRO_BIAS_UNITS

    return Biases(
        _vector("--gyro-bias", gyro, log, log_format, GYRO_BIAS_UNITS),
        _vector("--accel-bias", accel, log, log_format, ACCEL_BIAS_UNITS),
    )


def _kind(design: Design, recording: Recording, rates: str, steps: str) -> Kind:
    """What the values are to be taken as: rates at instants, or increments over the steps."""
    own = design.sensor.kind
    kinds = {unit.kind or own for unit in (recording.gyro, recording.accel)}
    if kinds == {"rate"} and (rates == "instant" or own == "rate"):
        return "rate"
    if "rate" in kinds and steps == "resample":
        raise click.UsageError(
            "--steps resample takes rates at instants, of the gyro and the accelerometer alike, or"
            " increments of both; leave it out"
        )
    if len(kinds) > 1 and rates == "instant":
        raise click.UsageError(
            "rates of one sensor and increments of the other cannot be integrated alike, give"
            " --rates mean"
        )
    return "increment"


def _resampler(design: Design, given: Kind, rates: str, steps: str) -> Resampler | None:
    """What brings the samples to the increments or rates of the design; None if they are."""
    from sculler_model.sampling import Resampler

    wanted = design.sensor.kind
    if steps == "resample" or (given == "rate" and wanted == "increment"):
        return Resampler(design.sample_interval, given, wanted)
    return None


def _to_instant(design: Design, given: Kind, rates: str, resampler: Resampler | None) -> float:
    """From the stamps to the instants of the design's samples, s.

    A mean over the interval that ends at a stamp is the rate in the interval's middle.
    """
    mean = rates == "mean" if given == "rate" else resampler is None
    return -0.5 * design.sample_interval if mean and design.sensor.kind == "rate" else 0.0


def _unit(design: Design, unit: Unit, given: Kind, resampler: Resampler | None) -> Unit:
    """The unit of the values as they come to the conversion."""
    from sculler.readers import Unit

    if resampler is None:
        return unit
    done = "integrated by cubics" if given == "rate" else "resampled to even steps"
    if given == design.sensor.kind == "rate":
        done = "interpolated to even steps"
    return Unit(f"{unit.name}, {done}", unit.si, None if unit.kind is None else design.sensor.kind)


def _summary(
    log: Path,
    output: Path,
    log_format: str,
    design: Design,
    recording: Recording,
    conversion: Conversion,
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
    rows |= data["notes"]
    if data["timing"] is not None:
        from sculler.readers import timing_told

        rows["time"] = timing_told.words(data["timing"])
    return rows | terminal.warning_rows(data["warnings"]) | {"wrote": data["output"]}


def _mounting_table(data: dict[str, Any]) -> list[Any]:
    """Log axis by log axis, what it is made of; none if nothing is turned."""
    from rich.table import Table

    if data["axes"] == "x,y,z" and not any(data["misalignment"]):
        return []
    table = Table(title="mounting", title_justify="left", title_style="bold")
    for column in ("log axis", "file axis", "direction cosines of file x, y, z"):
        table.add_column(column)
    for row in data["mounting"]:
        table.add_row(row["log"], row["file"], row["cosines"])
    return [table]


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
