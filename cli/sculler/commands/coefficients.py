"""`sculler coefficients`: the algorithm's numbers, as exact rationals."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

import click

from sculler import terminal

if TYPE_CHECKING:
    from rich.table import Table

    from sculler_model.algorithms import TapTable


@click.command(
    epilog=terminal.examples(
        "sculler coefficients --family frequency-taylor --samples 4 --history 0"
    )
)
@click.option(
    "--family",
    metavar="NAME",
    help="frequency-taylor, filtered-rate, time-taylor or uncompressed; others by --design.",
)
@click.option("--samples", type=int, metavar="N", help="Samples of a minor interval, 1 to 16.")
@click.option(
    "--history",
    type=int,
    metavar="P",
    help="Samples before the interval, 0 to 16; 0 if left out.",
)
@click.option("--design", "design_name", metavar="DESIGN", help="Take them from a design instead.")
@terminal.json_option
def command(
    family: str | None,
    samples: int | None,
    history: int | None,
    design_name: str | None,
    as_json: bool,
) -> None:
    """Print a tap table: exact rationals over one denominator.

    The sample d samples back has the tap of distance d; A = sum of tap * s[t-d] goes into the
    coning correction A x s[t].  Weights sum the samples to the interval's angle.  The JSON form is
    what the design file's [algorithm.table] reads.
    """
    from sculler.runs.coefficients import of_design, of_family

    if design_name is not None:
        if family is not None or samples is not None or history is not None:
            raise click.UsageError("give --design, or --family, --samples and --history, not both")
        outcome = of_design(terminal.load_design(design_name))
    elif family is None or samples is None:
        raise click.UsageError("give --family and --samples, or --design")
    else:
        outcome = of_family(family, samples, history or 0)
    shown = (_taps(outcome.table, outcome.title), _weights(outcome.table))
    terminal.report(outcome.as_json(), as_json, *shown, *outcome.notes)


def _taps(table: TapTable, title: str) -> Table:
    from rich.table import Table

    shown = Table(
        title=f"[bold]{title}[/]\ntaps over Dc = {table.denominator:,}", title_justify="left"
    )
    for column in ("phase k", "distance d", f"integer (/ {table.denominator})", "tap", "decimal"):
        shown.add_column(column, justify="right")
    for phase in table.active_phases:
        for distance, tap in enumerate(table.taps[phase - 1], start=1):
            value = Fraction(tap, table.denominator)
            shown.add_row(
                str(phase) if distance == 1 else "",
                str(distance),
                str(tap),
                str(value),
                f"{float(value):.15g}",
                end_section=distance == table.reach,
            )
    return shown


def _weights(table: TapTable) -> Table:
    from rich.table import Table

    shown = Table(title=f"weights over Dw = {table.sum_denominator:,}", title_justify="left")
    for column in ("distance d", f"integer (/ {table.sum_denominator})", "weight", "decimal"):
        shown.add_column(column, justify="right")
    for distance, weight in enumerate(table.weights):
        value = Fraction(weight, table.sum_denominator)
        shown.add_row(str(distance), str(weight), str(value), f"{float(value):.15g}")
    return shown
