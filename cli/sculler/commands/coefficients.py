"""`sculler coefficients`: the algorithm's numbers, as exact rationals."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

import click

from sculler import terminal

if TYPE_CHECKING:
    from rich.table import Table

    from sculler_model.algorithms import Made, TapTable


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
    help="Samples of the previous interval, 0 to N; 0 if left out.",
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
    from sculler_model.algorithms import SENSOR_KINDS

    notes: list[str] = []
    filtered = False
    if design_name is not None:
        if family is not None or samples is not None or history is not None:
            raise click.UsageError("give --design, or --family, --samples and --history, not both")
        design = terminal.load_design(design_name)
        table, title = design.table, design.name
        kind: str = design.sensor.kind
        if design.algorithm.family != "table":
            notes = design.made.report()
            filtered = bool(design.algorithm.filter)
    elif family is None or samples is None:
        raise click.UsageError("give --family and --samples, or --design")
    else:
        made = _made(family, samples, history or 0)
        table, notes = made.table, made.report()
        kind = SENSOR_KINDS[family][0]
        title = f"{family}, samples n = {samples}, history p = {history or 0}"
    left = [] if filtered else [_residual(table, kind)]  # its closed form knows no other filter
    terminal.report(table.as_json(), as_json, _taps(table, title), _weights(table), *left, *notes)


def _made(family: str, samples: int, history: int) -> Made:
    from sculler_model.algorithms import FAMILIES, MAX_SAMPLES, SENSOR_KINDS, TABLES, Recipe, make
    from sculler_model.errors import InputError

    if family in FAMILIES and family not in TABLES:
        raise InputError(
            f"--family: {family} needs a band or a filter, give them in a design file and --design"
        )
    if family not in TABLES:
        known = ", ".join(TABLES)
        raise InputError(f"--family: {family!r} is not known, give {known} or a --design")
    if not 1 <= samples <= MAX_SAMPLES:
        raise InputError(f"--samples: {samples} is not allowed, give 1 to {MAX_SAMPLES}")
    if not 0 <= history <= samples:
        raise InputError(f"--history: {history} is not allowed, give 0 to --samples = {samples}")
    if family != "filtered-rate" and samples + history < 2:
        raise InputError(
            f"--samples: 1 sample without history gives no cross product for {family}, give"
            " --samples 2 or --history 1"
        )
    return make(Recipe(family, samples, history, kind=SENSOR_KINDS[family][0]))


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


def _residual(table: TapTable, kind: str) -> str:
    """What coning the table leaves, in a sentence."""
    from sculler_model.analysis.closed_form import leading_term

    term = leading_term(table, "increment" if kind == "increment" else "rate")
    return (
        "Left by classical coning of half angle a at frequency Ω, computed minus true, in a minor\n"
        f"interval: {term.coefficient} a² (Ωh)^{term.power} rad and higher powers; h is the sample"
        " interval."
    )
