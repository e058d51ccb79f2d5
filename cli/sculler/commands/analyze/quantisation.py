"""`sculler analyze quantisation`: what the LSB does to the coning correction."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sculler import terminal
from sculler.commands.options import analysis as options
from sculler.words import three_digits

if TYPE_CHECKING:
    from rich.table import Table


@click.command(
    short_help="What the LSB does to drift and noise.",
    epilog=terminal.examples(
        "sculler analyze quantisation stim300 --family frequency-taylor --samples 2 \\\n"
        "    --trials 50 -o build/quantisation.png",
    ),
)
@options.subject_options
@options.half_angle_option
@click.option(
    "--frequency",
    type=terminal.number_type(0, above=True),
    default=50.0,
    show_default=True,
    metavar="HZ",
    help="Frequency of the coning.",
)
@click.option(
    "--levels",
    "count",
    type=click.IntRange(2, 100),
    default=8,
    show_default=True,
    help="How many LSBs, beside a design's own.",
)
@click.option(
    "--trials",
    type=click.IntRange(2, 100_000),
    default=20,
    show_default=True,
    help="Trials at each LSB.",
)
@click.option("--seed", type=int, default=1, show_default=True, help="Of the random numbers.")
@options.picture_option
@terminal.json_option
def command(
    half_angle: float,
    frequency: float,
    count: int,
    trials: int,
    seed: int,
    output: Path | None,
    as_json: bool,
    **asked: Any,
) -> None:
    """Show the drift that quantisation adds to coning, against the LSB.

    Each trial runs coning of its own phase, amplitude (within 2 %) and starting remainder through
    counts and core; what the same motion gives without quantisation is taken off.  Theory is the
    standard deviation for a white remainder.  Rate sensors' LSBs are given times the sample
    interval.
    """
    from sculler.runs.analysis import QuantisationPlan, quantisation_study

    options.require_picture(output)
    plan = QuantisationPlan(
        options.subjects(asked), half_angle, frequency, count, trials, seed, options.REQUIREMENTS
    )
    with terminal.progress("trials", plan.steps) as advance:
        data = quantisation_study(plan, advance=advance)
    if output is not None:
        from sculler.plots.analysis import quantisation_picture

        quantisation_picture(output, data)
        data["picture"] = str(output)
    terminal.report(data, as_json, _table(data), *options.picture_told(output))


def _table(data: dict[str, Any]) -> Table:
    from rich.table import Table

    table = Table(
        title=f"[bold]drift (°/h) that quantisation adds to {data['half_angle_deg']:g}° coning at"
        f" {data['frequency_hz']:g} Hz over {data['seconds']:.3g} s; {data['trials']} trials[/]",
        title_justify="left",
    )
    table.add_column("design")
    for column in (
        "LSB (rad)",
        "counts, peak",
        "mean",
        "deviation",
        "theory",
        "ratio",
        "angle (LSB)",
    ):
        table.add_column(column, justify="right")
    for name, found in data["designs"].items():
        for i, row in enumerate(found["levels"]):
            own = " *" if row["lsb"] == found["lsb"] else ""
            table.add_row(
                name if i == 0 else "",
                f"{row['lsb']:.3g}{own}",
                three_digits(row["counts"]),
                f"{row['mean']:.2e}",
                f"{row['deviation']:.2e}",
                f"{row['theory']:.2e}",
                f"{row['deviation'] / row['theory']:.2f}",
                "" if row["angle_error"] is None else f"{row['angle_error']:.2f}",
                end_section=i == len(found["levels"]) - 1,
            )
    if any(found["lsb"] is not None for found in data["designs"].values()):
        table.caption = "* the design's own LSB; the angle is the largest error over a trial"
    return table
