"""`sculler analyze orders`: what second, third and fourth order leave at the end of a motion."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from sculler import terminal
from sculler.commands.analyze.manoeuvre import NAMES
from sculler.commands.options import analysis as options

if TYPE_CHECKING:
    from rich.table import Table


@click.command(
    short_help="Attitude and velocity that order = 2, 3 and 4 leave.",
    epilog=terminal.examples(
        "sculler analyze orders stim300 --half-angle 45 --frequency 10 --seconds 2",
        "sculler analyze orders stim300 --half-angle 0.1 --frequency 50 --turn 6 --bank 5",
        "sculler analyze orders stim300 --manoeuvre extreme",
    ),
)
@terminal.design_argument
@click.option(
    "--half-angle",
    type=terminal.number_type(0, 180, above=True),
    metavar="DEG",
    help="Half angle of the cone; 45 if left out.",
)
@click.option(
    "--frequency",
    type=terminal.number_type(0, 1e6, above=True),
    metavar="HZ",
    help="Frequency of the cone; 10 if left out.",
)
@click.option(
    "--turn",
    type=terminal.number_type(-1e4, 1e4),
    metavar="DEG/S",
    help="Rate of a turn about the vertical.",
)
@click.option("--bank", type=terminal.number_type(-90, 90), metavar="DEG", help="Bank in the turn.")
@click.option(
    "--spin",
    type=terminal.number_type(-1e5, 1e5),
    metavar="DEG/S",
    help="Rate about the axis that goes round the cone, besides (spin-cone).",
)
@click.option("--manoeuvre", type=click.Choice(NAMES), help="A rate profile in place of the cone.")
@click.option(
    "--minors",
    type=click.IntRange(1, 4096),
    multiple=True,
    default=(1, 5),
    show_default=True,
    metavar="M",
    help="Minor intervals of a major one; repeatable.",
)
@click.option(
    "--seconds",
    type=terminal.number_type(0, 3600, above=True),
    help="Length of the run; 10, or that of the manoeuvre, if left out.",
)
@terminal.json_option
def command(design_name: str, as_json: bool, **asked: Any) -> None:
    """Show what order = 2, 3 and 4 leave at the end of a motion, for several M.

    The design's sample rate and coefficients run on a sensor too fine to matter, through the
    core's integers.  A coning body is held up by a force that is constant outside, so its true
    velocity is known as exactly as its attitude.  Last what the samples allow: the attitude at the
    end, iterated to convergence on a polynomial through them.  Where
    a higher order leaves more than a lower one, a line says so.  DESIGN must have increments.
    """
    from sculler.runs.analysis import OrdersPlan, orders_study

    plan = OrdersPlan(terminal.load_bare_design(design_name), design_name, **asked)
    with terminal.progress("running", 3 * len(plan.minors)) as advance:
        data = orders_study(plan, advance=advance)
    told = [*options.filtered_told(plan.design), *data["warnings"]]
    terminal.report(data, as_json, _table(data), *told)


def _table(data: dict[str, Any]) -> Table:
    from rich.table import Table

    table = Table(
        title=f"[bold]{data['design']}: {data['motion']}, {data['seconds']:g} s[/]",
        title_justify="left",
    )
    columns = ("M", "hand-over (Hz)", "order", "attitude (″)", "largest (″)")
    for column in (*columns, "velocity (m/s)", "iteration (″)"):
        table.add_column(column, justify="right")
    for row in data["orders"]:
        velocity = row["velocity"]
        table.add_row(
            str(row["minors"]),
            f"{row['hand_over_hz']:g}",
            str(row["order"]),
            f"{row['attitude_arcsec']:.2g}",
            f"{row['largest_arcsec']:.2g}",
            "-" if velocity is None else f"{velocity:.2g}",
            f"{row['iteration_arcsec']:.2g}",
        )
    return table
