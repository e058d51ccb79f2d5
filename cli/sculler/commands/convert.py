"""`sculler convert`: other formats to the integer log the core reads."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sculler import terminal
from sculler.readers import registry as formats

if TYPE_CHECKING:
    from sculler.readers.mounting import Mounting
    from sculler.readers.recording import Advance, Recording, Samples, Unit
    from sculler.readers.running_sums import Differences
    from sculler.readers.timing import Gaps, Steps
    from sculler.runs.conversion import Biases, Conversion
    from sculler_model.design import Design
    from sculler_model.frames import Vector
    from sculler_model.samples import Kind, Resampler

_GYRO_UNITS = ("rad", "deg", "arcsec", "rad/s", "deg/s", "deg/h", "counts")
_ACCEL_UNITS = ("m/s", "ft/s", "m/s2", "g", "mg", "counts")
_TIME_UNITS = ("s", "ms", "us", "ns")
_MAX_GAP = 1.0


@click.command(
    short_help="Make an integer IMU log of CSV, ROS, MAT, raw datagrams ...",
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
    type=click.Choice(["auto", *formats.MODULES]),
    default="auto",
    help="Format of LOG; auto looks at what is in it.",
)
@click.option(
    "--gyro-columns",
    metavar="A,B,C",
    help="Names or numbers (from 1) of the columns x, y, z, -B for the negative of B, or the name"
    " of one array of three (MAT, npz; imu.gyro in a structure); those of the format if left out,"
    " or gyro_x,gyro_y,gyro_z.",
)
@click.option("--accel-columns", metavar="A,B,C", help="The same of the accelerometer.")
@click.option(
    "--time-column", metavar="A", help="A time column, or none; that of the format if left out."
)
@click.option(
    "--gyro-unit",
    type=click.Choice(_GYRO_UNITS),
    help="Required for CSV, MAT, npz and Parquet, unless the file says it; of raw datagrams those"
    " of the sensor, or counts for the design's own.",
)
@click.option("--accel-unit", type=click.Choice(_ACCEL_UNITS), help="The same.")
@click.option(
    "--gyro-scale",
    type=terminal.number_type(0, above=True),
    metavar="X",
    help="How many of its unit the number 1 is, of columns or datagrams that count.",
)
@click.option(
    "--accel-scale", type=terminal.number_type(0, above=True), metavar="X", help="The same."
)
@click.option("--time-unit", type=click.Choice(_TIME_UNITS), help="s if left out and not known.")
@click.option(
    "--delimiter",
    metavar="C",
    help="comma, semicolon, tab, space or one character; found out if left out.",
)
@click.option("--skip-rows", type=click.IntRange(min=0), help="Lines of CSV before its header.")
@click.option("--variable", metavar="NAME", help="A matrix of a MAT, HDF5 or npz file.")
@click.option("--topic", metavar="NAME", help="The topic of a ROS bag, where it has several.")
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

    LOG is CSV with units, EuRoC's or ROS's CSV, increments of KF-GINS (text or binary), MAT, HDF5,
    .npz, Parquet, a ROS bag or MCAP, laser-gyro text (.imu), or raw datagrams of a STIM300,
    NovAtel, VectorNav, Xsens, ADIS or HG4930 (docs/reference/input-formats.md).  Numbers are
    brought to the design's counts with the remainder carried to the next sample, as a
    pulse-counting sensor does, so no angle is lost.
    Rates become increments where the sensor counts increments, and the reverse.  Numbers that
    already are the design's counts pass unchanged.  Time stamps are checked against the sample
    rate; gaps and unequal steps are told.

    An .npz file has the arrays gyro and accel, (N, 3), or dtheta (rad) and dvel (m/s); and may have
    time, (N,), fault, (N,), and the strings gyro_unit, accel_unit and time_unit.
    """
    from sculler.formats.log import LogWriter
    from sculler.formats.origin import write_origin
    from sculler.readers import timing_told
    from sculler.readers.preparation import Watch, bounded, differenced, signed, unstamped
    from sculler.readers.timing import Timing, resampled
    from sculler.runs.conversion import Conversion
    from sculler_model import inputs
    from sculler_model.errors import InputError
    from sculler_model.outputs import replacing

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
                times = None if chunk.times is None else chunk.times + to_instant
                origin = 0.0 if clock is None else clock.origin
                try:
                    counts = conversion(chunk.values)
                except InputError as error:
                    raise InputError("; ".join([str(error), *watch.sums()])) from error
                writer.write(counts, chunk.faults, times, origin)
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
        "datagrams": None if recording.datagrams is None else asdict(recording.datagrams),
        "warnings": [*recording.warnings, *conversion.hints(), *watch.warnings()],
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
    return detect(log, options["delimiter"], options["skip_rows"] or 0, columns_given)


def _open(
    log: Path, log_format: str, design: Design, advance: Advance, options: dict[str, Any]
) -> Recording:
    """The recording, by the reader of its format."""
    from sculler.readers.format import Request
    from sculler.readers.recording import ACCEL_UNITS, GYRO_UNITS

    reader = formats.find(log_format)
    for name, value in options.items():
        if value is not None and name not in reader.options:
            raise click.UsageError(
                f"--{name.replace('_', '-')} is not used for format {log_format}, leave it out"
            )
    request = Request(
        design,
        advance,
        gyro_columns=_columns(options, "gyro"),
        accel_columns=_columns(options, "accel"),
        time=options["time_column"],
        time_unit=options["time_unit"],
        gyro=None if options["gyro_unit"] is None else GYRO_UNITS[options["gyro_unit"]],
        accel=None if options["accel_unit"] is None else ACCEL_UNITS[options["accel_unit"]],
        gyro_scale=options["gyro_scale"],
        accel_scale=options["accel_scale"],
        delimiter=options["delimiter"],
        skip_rows=options["skip_rows"] or 0,
        variable=options["variable"],
        topic=options["topic"],
    )
    return reader.open(log, request)


def _columns(options: dict[str, Any], sensor: str) -> list[str] | None:
    """The columns of a sensor as they are given."""
    text = options[f"{sensor}_columns"]
    if text is None:
        return None
    columns = [column.strip() for column in text.split(",")]
    if not all(columns):
        raise click.UsageError(f"--{sensor}-columns: {text!r} is not allowed, give x,y,z")
    return columns


def _signs(options: dict[str, Any]) -> list[float]:
    """The signs of the six columns."""
    from sculler.readers.columns import split_sign

    signs: list[float] = []
    for sensor in ("gyro", "accel"):
        each = [split_sign(column)[0] for column in _columns(options, sensor) or ["x"] * 3]
        signs += each * 3 if len(each) == 1 else each
    return signs


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


def _vector(
    option: str, text: str | None, log: Path, log_format: str, units: dict[str, float]
) -> Vector:
    """A vector option in SI: three numbers with a unit, or the name of a MAT file's variable."""
    from sculler.readers.mounting import parse_vector

    if text is None:
        return (0.0, 0.0, 0.0)
    if text.replace(".", "_").isidentifier() and log_format in ("mat", "hdf5"):
        from sculler.readers.mat import mat_vector

        return mat_vector(log, text)
    return parse_vector(option, text, units)


def _mounting(log: Path, log_format: str, axes: str | None, misalignment: str | None) -> Mounting:
    from sculler.readers.mounting import Mounting
    from sculler.readers.recording import ANGLE_UNITS

    turn = _vector("--misalignment", misalignment, log, log_format, ANGLE_UNITS)
    return Mounting.parse(axes, turn)


def _biases(log: Path, log_format: str, gyro: str | None, accel: str | None) -> Biases:
    from sculler.readers.recording import ACCEL_BIAS_UNITS, GYRO_BIAS_UNITS
    from sculler.runs.conversion import Biases

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
    from sculler_model.samples import Resampler

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
    from sculler.readers.recording import Unit

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
    from sculler.formats.log import COUNTS

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
