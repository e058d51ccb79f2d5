"""`sculler model`: a log through the bit-exact golden model."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from sculler import terminal
from sculler.words import warning_rows

if TYPE_CHECKING:
    from sculler.checks.breaks import Policy
    from sculler.runs.counts import ModelEngine


@click.command(
    short_help="Run an IMU log through the bit-exact golden model.",
    epilog=terminal.examples("sculler model examples/stim300_4x5.toml imu.csv -o model.csv"),
)
@terminal.design_argument
@terminal.log_argument
@terminal.output_option
@click.option(
    "--engine",
    type=click.Choice(["fast", "reference"]),
    default="fast",
    show_default=True,
    help="The vectorised twin, or the plain reference it is tested against.",
)
@terminal.breaks_option(terminal.BREAKS_IN_LOG)
@terminal.json_option
def command(
    design_name: str, log: str, output: Path, engine: ModelEngine, breaks: Policy, as_json: bool
) -> None:
    """Run the IMU log LOG through the golden model.

    LOG has counts, as CSV, .npz or .parquet; - is CSV from stdin.
    Writes the vectors: one row of exact integers for each complete major interval.  A log with a
    column time_s (stamps, s) or sequence (a sample counter) is checked for missing samples.
    """
    from sculler.commands.origin import write_origin
    from sculler.runs.counts import model_log

    design = terminal.load_design(design_name)
    with terminal.progress("modelling", terminal.file_size(log)) as advance:
        summary = model_log(design, log, output, engine, advance, breaks)
    data = {"engine": engine, "log": log, "output": str(output), **summary.as_json()}
    write_origin(output, {"log": log, "design": design_name}, data)
    rows = summary.facts() | warning_rows(summary.warnings)
    terminal.report(data, as_json, terminal.facts(rows | {"wrote": str(output)}))
