"""`sculler convert`: other formats to the integer log the core reads."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from sculler import terminal
from sculler.commands.options import conversion as options

_GAPS_SHOWN = 20


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
@options.layout_options
@options.running_sums_options
@options.stamp_options
@options.mounting_options
@terminal.json_option
def command(log: Path, output: Path, design_name: str, as_json: bool, **asked: Any) -> None:
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
    from sculler.commands.origin import write_origin
    from sculler.runs.conversion import convert_log, told

    plan = options.plan(terminal.load_design(design_name), log, asked)
    with terminal.progress("converting", terminal.file_size(log)) as advance:
        data = convert_log(plan, output, advance=advance).as_json()
    write_origin(output, {"source": log, "design": design_name}, data)
    tables = [*_mounting_table(data), *_gaps_table(data["timing"]), _ranges(data)]
    terminal.report(data, as_json, terminal.facts(told(data)), *tables)


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


def _gaps_table(timing: dict[str, Any] | None) -> list[Any]:
    """The first gaps; no table if there are none."""
    from rich.table import Table

    if timing is None or not timing["gaps"]:
        return []
    table = Table(title="gaps", title_justify="left", title_style="bold")
    for column in ("before sample", "after time (s)", "length (s)", "samples missing"):
        table.add_column(column, justify="right")
    for gap in timing["gaps"][:_GAPS_SHOWN]:
        table.add_row(
            f"{gap['sample']:,}", f"{gap['time']:.6f}", f"{gap['seconds']:.6g}", str(gap["missing"])
        )
    more = timing["gap_count"] - _GAPS_SHOWN
    if more > 0:
        table.add_row("...", f"and {more:,} more", "", "")
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
