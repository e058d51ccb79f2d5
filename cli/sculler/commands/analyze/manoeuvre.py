"""`sculler analyze manoeuvre`: attitude error over a manoeuvre against the update rate."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sculler import terminal
from sculler.commands.options import analysis as options

if TYPE_CHECKING:
    from rich.table import Table

NAMES = ("extreme", "turn-entry", "pitch-over")
"""`sculler_model.analysis.MANOEUVRES`, named here so that --help imports no numpy."""

COLUMNS = ("source_1", "source_2", "complete", "third_order", "integer_path", "iteration")


@click.command(
    short_help="Attitude error over a manoeuvre against update rate.",
    epilog=terminal.examples(
        "sculler analyze manoeuvre --family frequency-taylor --samples 2 --samples 4 \\\n"
        "    -o build/manoeuvre.png",
        "sculler analyze manoeuvre stim300 --manoeuvre turn-entry --json",
    ),
)
@options.subject_options
@click.option(
    "--manoeuvre",
    "name",
    type=click.Choice(NAMES),
    default=NAMES[0],
    show_default=True,
    help="Which rate profile.",
)
@click.option(
    "--from",
    "low",
    type=terminal.number_type(0, above=True),
    default=50.0,
    show_default=True,
    metavar="HZ",
    help="Slowest update rate.",
)
@click.option(
    "--to",
    "high",
    type=terminal.number_type(0, above=True),
    default=400.0,
    show_default=True,
    metavar="HZ",
    help="Fastest update rate.",
)
@options.fine_option
@options.degree_option
@options.picture_option
@terminal.json_option
def command(
    name: str,
    low: float,
    high: float,
    fine: bool,
    degree: int,
    output: Path | None,
    as_json: bool,
    **asked: Any,
) -> None:
    """Show the attitude error that a manoeuvre leaves, in µrad, against the update rate.

    Every number of minor intervals M that gives an update rate in the band is tried at the design's
    sample rate.  Source 1 is the triple products of the rotation vector that no algorithm of this
    kind forms; source 2 is what the coefficients leave beyond it (Savage-20).  Then both together,
    without and with the host's third-order correction, and both through the core's integers.  Last
    what the samples allow: the attitude iterated to convergence on a polynomial through them.
    """
    from sculler.runs.analysis import ManoeuvrePlan, manoeuvre_study

    options.require_picture(output)
    plan = ManoeuvrePlan(options.subjects(asked), name, low, high, fine, degree)
    with terminal.progress("manoeuvres", plan.steps) as advance:
        data = manoeuvre_study(plan, advance=advance)
    if output is not None:
        from sculler.plots.analysis import manoeuvre_picture

        manoeuvre_picture(output, data)
        data["picture"] = str(output)
    told = options.filtered_told(*(subject.design for subject in plan.subjects.values()))
    terminal.report(data, as_json, _table(data), *told, *options.picture_told(output))


def _table(data: dict[str, Any]) -> Table:
    from rich.table import Table

    table = Table(
        title=f"[bold]attitude error at the end of the {data['seconds']:g} s manoeuvre"
        f" {data['manoeuvre']} (µrad)[/]",
        title_justify="left",
    )
    table.add_column("design")
    for column in (
        "M",
        "update (Hz)",
        "source 1",
        "source 2",
        "both",
        "third order",
        "integer path",
        "iteration",
    ):
        table.add_column(column, justify="right")
    for name, found in data["designs"].items():
        for i, row in enumerate(found["updates"]):
            table.add_row(
                name if i == 0 else "",
                str(row["minors"]),
                f"{row['update_hz']:.4g}",
                *(f"{row[key]:.3g}" for key in COLUMNS),
                end_section=i == len(found["updates"]) - 1,
            )
    return table
