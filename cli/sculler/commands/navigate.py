"""`sculler navigate`: attitude, velocity and position from the vectors."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sculler import terminal
from sculler.commands.options import navigation as options

if TYPE_CHECKING:
    from rich.table import Table

    from sculler.runs.navigation import Outcome


@click.command(
    short_help="Carry attitude, velocity and position with the vectors.",
    epilog=terminal.examples(
        "sculler navigate examples/lasergyro.toml vectors.csv -o nav.csv --axes y,x,-z \\\n"
        "    --lat 34.246048 --lon 108.909664 --height 380 --align 300",
        "sculler navigate stim300 vectors.csv -o nav.csv --heading 90 --ve 30 \\\n"
        "    --lat 48 --lon 11 --height 500",
        "sculler navigate stim300 vectors.csv -o nav.csv --truth truth.csv --report run.html",
        "sculler navigate stim300 vectors.csv -o nav.csv --lat 48 --lon 11 --height 500 \\\n"
        "    --height-reference barometer.csv --height-lag 0.3 --height-damping 60",
        "sculler navigate stim300 vectors.csv -o nav.csv --attitude-only --lat 48 --rest 0:60",
    ),
)
@terminal.design_argument
@click.argument("vectors", metavar="VECTORS", type=terminal.InputFile())
@terminal.output_option
@options.initial_state_options
@options.span_options
@options.alignment_options
@options.attitude_options
@options.carrier_options
@click.option(
    "--channel",
    type=click.IntRange(min=0),
    metavar="K",
    help="Take channel K of the vectors of many channels.",
)
@click.option(
    "--truth",
    type=terminal.InputFile(Path),
    metavar="FILE",
    help="Hold the run against this truth (of `motion`, or an npz, MAT or Parquet file with such"
    " columns); what of the initial state is left out comes from it.",
)
@click.option(
    "--telemetry",
    type=terminal.OutputFile(),
    metavar="FILE",
    help="Write the states as binary frames with a CRC, too, as the host in C sends them.",
)
@click.option(
    "--report",
    "page",
    type=terminal.OutputFile(),
    metavar="FILE.html",
    help="Write the run as one HTML page: figures, pictures, settings, design.",
)
@click.option(
    "--plots/--no-plots", default=True, show_default=True, help="Pictures beside the output."
)
@options.sensor_options
@terminal.json_option
def command(
    design_name: str,
    vectors: str,
    output: Path,
    truth: Path | None,
    telemetry: Path | None,
    page: Path | None,
    plots: bool,
    as_json: bool,
    **asked: Any,
) -> None:
    """Navigate with the VECTORS (of `model` or `simulate`) of DESIGN.

    Float, once a major interval: exact attitude, velocity and position over WGS-84.  The body frame
    is forward, right, down.  Columns of the output, a row at the start and after every major
    interval: time_s; the attitude quaternion q_w, q_x, q_y, q_z from body to north-east-down;
    roll_deg, pitch_deg, heading_deg (heading from north to east); v_north, v_east, v_down (m/s);
    lat_deg, lon_deg (geodetic) and height_m (over the ellipsoid): all of true north, in either
    mechanisation; and wander_deg, from north to the x axis of the frame that was carried (0 if
    that points north): heading_deg - wander_deg runs on over a pole.

    Times are on the log's own clock (on one that began with the log where it has no time_s).  The
    first result may reach before the first sample (status bit 0): the run then begins at its end,
    where the initial state holds.

    With --attitude-only the columns end with heading_deg, and nothing is said of where.

    With --truth the errors of attitude, velocity and position are told and drawn.  They are formed
    at the instants of whichever of the two is sparser; where the other has no state at such an
    instant it is interpolated: position by a cubic, velocity linearly, attitude evenly.  What only
    one of the two has is left out, and said.  A truth may tell attitude, velocity or position
    alone; what it does not tell of the initial state comes from the options.
    """
    from sculler.formats.vectors import results_in
    from sculler.runs.navigation import navigate_file, told

    plan = options.plan(
        terminal.load_design(design_name), vectors, truth, {**asked, "telemetry": telemetry}
    )
    with terminal.progress("navigating", results_in(vectors)) as advance:
        outcome = navigate_file(
            plan, output, truth=truth, telemetry=telemetry, pictures=plots, advance=advance
        )
    data = outcome.as_json()
    if telemetry is not None:
        data["telemetry"] = str(telemetry)
    if page is not None:
        data["report"] = str(page)
        files = {"vectors": vectors, "design": design_name}
        files |= {} if truth is None else {"truth": str(truth)}
        files |= {} if plan.gravity.table is None else {"gravity table": asked["gravity"]}
        if plan.height_reference is not None:
            files["height reference"] = str(asked["height_reference"])
        _write_report(page, outcome, told(data), files)
    errors = () if outcome.errors is None else ("", errors_table(outcome.errors))
    terminal.report(data, as_json, terminal.facts(told(data)), *errors)


def _write_report(
    page: Path, outcome: Outcome, facts: dict[str, str], files: dict[str, str]
) -> None:
    """The run as one page."""
    from sculler.commands.origin import settings
    from sculler.formats.origin import chain
    from sculler.report import write_report

    steps = [step for kind, path in files.items() for step in chain(kind, path)]
    write_report(
        page,
        outcome.plan.design,
        facts,
        outcome.errors,
        outcome.pictures or [],
        settings(),
        outcome.warnings,
        steps,
    )


def errors_table(errors: dict[str, Any]) -> Table:
    """The table of errors for a terminal."""
    from rich.table import Table

    from sculler.runs.navigation.against_truth import rows

    shown = Table(title="errors against the truth", title_justify="left")
    for name in ("", "unit", "rms", "largest", "at the end"):
        shown.add_column(name, justify="left" if name in ("", "unit") else "right")
    for number, line in enumerate(rows(errors), start=1):
        shown.add_row(*line, end_section=number % 4 == 0)
    return shown
