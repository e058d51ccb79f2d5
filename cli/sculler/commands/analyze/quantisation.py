"""`sculler analyze quantisation`: what the LSB does to the coning correction."""

from __future__ import annotations

from dataclasses import asdict
from math import degrees, radians
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sculler import terminal
from sculler.commands.analyze import subjects
from sculler.commands.analyze.coning import REQUIREMENTS

if TYPE_CHECKING:
    from rich.table import Table

PER_HOUR = degrees(1) * 3600
"""°/h per rad/s."""


@click.command(
    short_help="What the LSB does to drift and noise.",
    epilog=terminal.examples(
        "sculler analyze quantisation stim300 --family frequency-taylor --samples 2 \\\n"
        "    --trials 50 -o build/quantisation.png",
    ),
)
@subjects.subject_options
@subjects.half_angle_option
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
@subjects.picture_option
@terminal.json_option
def command(
    half_angle: float,
    frequency: float,
    count: int,
    trials: int,
    seed: int,
    output: Path | None,
    as_json: bool,
    **chosen: Any,
) -> None:
    """Show the drift that quantisation adds to coning, against the LSB.

    Each trial runs coning of its own phase, amplitude (within 2 %) and starting remainder through
    counts and core; what the same motion gives without quantisation is taken off.  Theory is the
    standard deviation for a white remainder.  Rate sensors' LSBs are given times the sample
    interval.
    """
    from sculler_model.analysis import quantisation as analysis

    subjects.require_picture(output)
    found = subjects.subjects(**chosen)
    data: dict[str, Any] = {
        "study": "quantisation",
        "half_angle_deg": half_angle,
        "frequency_hz": frequency,
        "trials": trials,
        "seed": seed,
        "unit": "°/h",
        "requirements": list(REQUIREMENTS),
        "designs": {},
    }
    with terminal.progress("trials", len(found) * (count + 1)) as advance:
        for name, subject in found.items():
            design, angle = subject.design, radians(half_angle)
            own = None if subject.of_family else design.gyro_scale
            lsbs = analysis.levels(design, angle, frequency, count)
            rows = []
            for lsb in sorted({*lsbs, *([own] if own and own > lsbs[0] else [])}):
                level = analysis.monte_carlo(design, angle, frequency, lsb, trials, seed)
                row = asdict(level)
                for key in ("mean", "deviation", "theory"):
                    row[key] *= PER_HOUR
                rows.append(row)
                advance(1)
            data["designs"][name] = {"lsb": own, "levels": rows}
            data["seconds"] = analysis.trial_seconds(design, frequency)
    if output is not None:
        from sculler.plots.analysis import quantisation_picture

        quantisation_picture(output, data)
        data["picture"] = str(output)
    terminal.report(
        data, as_json, _table(data), *([f"picture: {terminal.verbatim(output)}"] if output else [])
    )


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
                terminal.three_digits(row["counts"]),
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
