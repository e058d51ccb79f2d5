"""`sculler analyze third-order`: coning in a turn, and what mends its triple products."""

from __future__ import annotations

from dataclasses import asdict
from math import degrees, radians
from typing import TYPE_CHECKING, Any

import click

from sculler import terminal
from sculler.commands.analyze import subjects

if TYPE_CHECKING:
    from rich.table import Table


@click.command(
    short_help="Coning in a turn: triple products left by core, host and exact accumulators.",
    epilog=terminal.examples(
        "sculler analyze third-order stim300 --half-angle 0.1 --frequency 50 --turn 6 --bank 5",
        "sculler analyze third-order stim300 --half-angle 1 --frequency 20 --minors 1 --minors 5",
    ),
)
@terminal.design_argument
@subjects.half_angle_option
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
@terminal.json_option
def command(
    design_name: str,
    half_angle: float,
    frequency: float,
    turn: float,
    bank: float,
    minors: tuple[int, ...],
    seconds: float,
    as_json: bool,
) -> None:
    """Show what the triple products leave of coning in a turn, for several M.

    The design's samples and coefficients run on a sensor too fine to matter: second order, as the
    core hands it over; with the host's third-order correction (navigate --third-order); and with
    exact third-order accumulators, which are a study and in no hardware.  DESIGN must have
    increments.
    """
    from sculler_model.analysis.triple import ConingTurn, left
    from sculler_model.errors import InputError

    design = terminal.load_design(design_name)
    if design.sensor.kind != "increment":
        raise InputError(f'{design_name}: sensor.kind is "rate", give a design with increments')
    if frequency >= design.sensor.sample_rate_hz / 2:
        raise InputError(
            f"--frequency: {frequency:g} Hz is not below the Nyquist limit,"
            f" {design.sensor.sample_rate_hz / 2:g} Hz"
        )
    longest = max(minors) * design.algorithm.samples * design.sample_interval
    if seconds < longest:
        raise InputError(f"--seconds: {seconds:g} is too short, give at least {longest:g}")
    motion = ConingTurn(radians(half_angle), frequency, radians(turn), radians(bank))
    rows = []
    with terminal.progress("running", len(minors)) as advance:
        for M in minors:
            row = asdict(left(design, motion, M, seconds))
            rows.append({k: v if k == "minors" else degrees(v) * 3600 for k, v in row.items()})
            advance(1)
    data = {
        "study": "third-order",
        "design": design.name,
        "half_angle_deg": half_angle,
        "frequency_hz": frequency,
        "turn_deg_per_s": turn,
        "bank_deg": bank,
        "seconds": seconds,
        "unit": "deg/h",
        "minors": rows,
    }
    interval = 1e3 * design.algorithm.samples * design.sample_interval
    terminal.report(data, as_json, _table(data, interval))


def _table(data: dict[str, Any], minor_ms: float) -> Table:
    from rich.table import Table

    table = Table(
        title=f"[bold]attitude drift of {data['design']}: {data['half_angle_deg']:g}° coning at"
        f" {data['frequency_hz']:g} Hz in a {data['turn_deg_per_s']:g} °/s turn (°/h)[/]",
        title_justify="left",
    )
    for column in ("M", "interval (ms)", "second order", "host", "integers"):
        table.add_column(column, justify="right")
    for row in data["minors"]:
        numbers = (row["second_order"], row["host"], row["integers"])
        M = row["minors"]
        table.add_row(str(M), f"{M * minor_ms:g}", *(f"{number:.2g}" for number in numbers))
    return table
