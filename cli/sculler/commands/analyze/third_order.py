"""`sculler analyze third-order`: coning in a turn, and what mends its triple products."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from sculler import terminal
from sculler.commands.options import analysis as options

if TYPE_CHECKING:
    from rich.table import Table


@click.command(
    short_help="Coning in a turn: triple products left by core, host and exact accumulators.",
    epilog=terminal.examples(
        "sculler analyze third-order stim300 --half-angle 0.1 --frequency 50 --turn 6 --bank 5",
        "sculler analyze third-order stim300 --half-angle 1 --frequency 20 --minors 1 --minors 5",
        "sculler analyze third-order stim300 --half-angle 45 --frequency 3 --spin 573",
    ),
)
@terminal.design_argument
@click.option(
    "--half-angle",
    type=terminal.number_type(0, 90, above=True),
    default=0.1,
    show_default=True,
    metavar="DEG",
    help="Half angle of the cone.",
)
@click.option(
    "--frequency",
    type=terminal.number_type(0, 1e6, above=True),
    default=50.0,
    show_default=True,
    metavar="HZ",
    help="Frequency of the cone.",
)
@click.option(
    "--turn",
    type=terminal.number_type(-1e4, 1e4),
    default=0.0,
    show_default=True,
    metavar="DEG/S",
    help="Rate of the turn about the vertical.",
)
@click.option(
    "--bank",
    type=terminal.number_type(-90, 90),
    default=0.0,
    show_default=True,
    metavar="DEG",
    help="Bank in the turn.",
)
@click.option(
    "--spin",
    type=terminal.number_type(-1e5, 1e5),
    default=0.0,
    show_default=True,
    metavar="DEG/S",
    help="Rate about the axis that goes round the cone, besides (spin-cone).",
)
@click.option(
    "--minors",
    type=click.IntRange(1, 4096),
    multiple=True,
    default=(1, 2, 5, 10),
    show_default=True,
    metavar="M",
    help="Minor intervals of a major one; repeatable.",
)
@click.option(
    "--seconds",
    type=terminal.number_type(0, 3600, above=True),
    default=20.0,
    show_default=True,
    help="Length of the run.",
)
@options.degree_option
@terminal.json_option
def command(design_name: str, as_json: bool, **asked: Any) -> None:
    """Show what the triple products leave of coning in a turn, for several M.

    The design's samples and coefficients run on a sensor too fine to matter: second order, as the
    core hands it over; with the host's third-order correction (navigate --third-order); and with
    exact third-order accumulators, which are a study and in no hardware.  Last what the samples
    allow: the attitude iterated to convergence on a polynomial through them.  DESIGN must have
    increments.
    """
    from sculler.runs.analysis import ThirdOrderPlan, third_order_study

    plan = ThirdOrderPlan(terminal.load_bare_design(design_name), design_name, **asked)
    with terminal.progress("running", len(plan.minors)) as advance:
        data = third_order_study(plan, advance=advance)
    told = options.filtered_told(plan.design)
    terminal.report(data, as_json, _table(data, 1e3 * plan.minor_interval), *told)


def _table(data: dict[str, Any], minor_ms: float) -> Table:
    from rich.table import Table

    spin = f", spin {data['spin_deg_per_s']:g} °/s" if data["spin_deg_per_s"] else ""
    table = Table(
        title=f"[bold]attitude drift of {data['design']}: {data['half_angle_deg']:g}° coning at"
        f" {data['frequency_hz']:g} Hz in a {data['turn_deg_per_s']:g} °/s turn{spin} (°/h)[/]",
        title_justify="left",
    )
    for column in ("M", "interval (ms)", "second order", "host", "integers", "iteration"):
        table.add_column(column, justify="right")
    for row in data["minors"]:
        numbers = (row["second_order"], row["host"], row["integers"], row["iteration"])
        M = row["minors"]
        table.add_row(str(M), f"{M * minor_ms:g}", *(f"{number:.2g}" for number in numbers))
    return table
