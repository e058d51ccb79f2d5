"""`sculler motion`: an integer IMU log of a known motion, and its truth."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from sculler import terminal
from sculler.commands.options import motion as options
from sculler.commands.options import points
from sculler.commands.options.analysis import require_picture

_HELP = (
    """Write the IMU log that DESIGN's sensor gives of the motion NAME, and the motion's truth.

\b
"""
    + "\n".join(f"{name:16}{text}" for name, text in options.NAMES.items())
    + """

With --from FILE the motion goes through the points of a file, CSV, .npz, .parquet or MAT: time_s;
lat_deg, lon_deg, height_m, or Earth-fixed x_m, y_m, z_m, or north_m, east_m, up_m from --lat, --lon
and --height; and q_w, q_x, q_y, q_z or roll_deg, pitch_deg, heading_deg.  Without attitude the nose
is along the way, banked as the turn asks.  Time 0 is the first point's.

All of it happens on the turning WGS-84 Earth and is known in closed form; the samples are exact
integrals, counted as a pulse-counting sensor does, remainder carried.  A rate sensor gets rates
averaged over the sample interval about their instant.

Time 0 is the beginning of the first increment, or the instant of the first rate.  The truth has
rows at the ends of the major intervals from the first one at or after time 0 on (or, from there,
every --truth-every seconds), with the columns of `sculler navigate`'s output: time_s; the
quaternion q_w, q_x, q_y, q_z from body (forward, right, down) to north-east-down; roll_deg,
pitch_deg, heading_deg; v_north, v_east, v_down (m/s); lat_deg, lon_deg (geodetic), height_m (over
the ellipsoid).
"""
)


@click.command(
    short_help="Write an IMU log of a known motion, and its truth.",
    help=_HELP,
    epilog=terminal.examples(
        "sculler motion flight --design stim300 -o imu.csv --truth truth.csv",
        "sculler motion rest --design stim300 -o imu.csv --truth truth.csv --duration 10800 \\\n"
        "    --lat 45 --heading 30",
        "sculler motion coning --design examples/stim300_4x5.toml -o imu.csv --truth truth.csv \\\n"
        "    --half-angle 1 --frequency 20 --vibration 0.5 --vibration-band 20-200",
        "sculler motion rest --design stim300.toml -o imu.csv --truth truth.csv --duration 600 \\\n"
        "    --allan allan.png",
        "sculler motion --from way_points.csv --design stim300 -o imu.csv --truth truth.csv",
    ),
)
@click.argument("name", metavar="[NAME]", required=False, type=click.Choice(tuple(options.NAMES)))
@click.option("--design", "design_name", required=True, metavar="DESIGN", help="Gives the sensor.")
@terminal.output_option
@click.option(
    "--truth",
    type=terminal.OutputFile(),
    required=True,
    metavar="FILE",
    help="Where to write the truth: .parquet, .npz, or CSV.",
)
@click.option(
    "--duration",
    type=terminal.number_type(0, 1e7, above=True),
    metavar="SECONDS",
    help="How long; 60 if left out, a flight and a great circle 3600, over the pole 600, through"
    " points to the last one.",
)
@click.option(
    "--truth-every",
    type=terminal.number_type(0, 1e7, above=True),
    metavar="SECONDS",
    help="Time between the truth's rows; a major interval if left out.",
)
@click.option(
    "--allan",
    type=terminal.OutputFile(),
    metavar="FILE",
    help="Draw the Allan deviations of the samples less the perfect ones, beside what"
    " [sensor.errors] asks for (PNG).",
)
@points.points_options
@options.motion_options
@options.vibration_options
@terminal.json_option
def command(
    name: str | None,
    design_name: str,
    output: Path,
    truth: Path,
    allan: Path | None,
    plots: bool,
    as_json: bool,
    **asked: Any,
) -> None:
    """Write the IMU log of a known motion, and its truth."""
    from sculler.commands.origin import write_origin
    from sculler.plots import pictures
    from sculler.runs.motion import write_motion

    require_picture(allan)
    plan = points.plan(terminal.load_design(design_name), name, asked)
    total = plan.samples + plan.truth_rows
    with terminal.progress(f"writing {plan.motion.name}", total) as advance:
        drawn = plots and pictures.left_out() is None
        outcome = write_motion(plan, output, truth, pictures=drawn, allan=allan, advance=advance)
    data = outcome.as_json()
    read = {"design": design_name} | ({"from": plan.given.path} if plan.given else {})
    write_origin(output, read, data)
    terminal.report(data, as_json, terminal.facts(outcome.told()))
