"""`sculler analyze position`: trapezoid or high resolution, for a manoeuvre and a vibration."""

from __future__ import annotations

from collections.abc import Callable
from math import degrees
from typing import TYPE_CHECKING, Any

import click

from sculler import terminal
from sculler.commands.options import analysis as options
from sculler.commands.options.group import Command

if TYPE_CHECKING:
    from rich.table import Table


ONE_RADIAN = degrees(1)


def _number(
    flag: str, default: float, metavar: str, text: str, *, above: bool = False
) -> Callable[[Command], Command]:
    return click.option(
        flag,
        type=terminal.number_type(0, above=above),
        default=default,
        show_default="1 rad/s" if default == ONE_RADIAN else True,
        metavar=metavar,
        help=text,
    )


@click.command(
    short_help="Position: trapezoid or high resolution, and at which rates.",
    epilog=terminal.examples(
        "sculler analyze position --family frequency-taylor --samples 4 --minors 10",
        "sculler analyze position stim300 --peak-force 2 --peak-rate 90 --vibration 1 80 \\\n"
        "    --limit 0.1 --over 60",
    ),
)
@options.subject_options
@_number("--peak-force", 3.0, "G", "Largest specific force of manoeuvres.")
@_number("--force-ramp", 3.0, "G/S", "Its fastest change.")
@_number("--peak-rate", ONE_RADIAN, "DEG/S", "Fastest turn, square to the force.")
@_number("--rate-ramp", 0.0, "DEG/S2", "Its fastest change.")
@click.option(
    "--vibration",
    nargs=2,
    type=terminal.number_type(0, above=True),
    default=(3.6, 50.0),
    show_default=True,
    metavar="G HZ",
    help="Root mean square and frequency of a vibration.",
)
@click.option("--no-vibration", is_flag=True, help="None.")
@_number("--rocking", 0.0, "DEG", "Amplitude of a rotation in phase with it.")
@_number("--limit", 0.01, "CM", "How wrong the position may be,", above=True)
@_number("--over", 10.0, "S", "over so long.", above=True)
@terminal.json_option
def command(no_vibration: bool, as_json: bool, **asked: Any) -> None:
    """Choose between trapezoid and high-resolution position (Savage-98 section VI).

    The errors of the trapezoid are held against the limit; where one is over it, high resolution is
    chosen, and each of its terms that is over the limit is needed.  Then the same motion runs
    through trapezoid, high resolution with exact integrals, and the core's integers.  Left out, the
    conditions are the paper's.  Attitude and velocity are taken as true.
    """
    from sculler.runs.analysis import PositionPlan, position_study

    keys = ("peak_force", "force_ramp", "peak_rate", "rate_ramp", "rocking", "limit")
    plan = PositionPlan(
        options.subjects(asked),
        vibration=None if no_vibration else asked["vibration"],
        seconds=asked["over"],
        **{key: asked[key] for key in keys},
    )
    with terminal.progress("running", len(plan.subjects)) as advance:
        data = position_study(plan, advance=advance)
    tables: list[Any] = []
    for name, found in data["designs"].items():
        tables += [_selection(name, found, data), _left(found, data)]
    told = [
        f"{name}: the sensor's filter takes {found['filter_takes']:.3g} cm of the vibration's own"
        " displacement, which does not grow"
        for name, found in data["designs"].items()
        if "filter_takes" in found
    ]
    terminal.report(data, as_json, *tables, *told)


def _selection(name: str, found: dict[str, Any], data: dict[str, Any]) -> Table:
    from rich.table import Table

    table = Table(
        title=f"[bold]{name}: l {found['l_hz']:g}, m {found['m_hz']:g}, n {found['n_hz']:g} Hz:"
        f" {found['choice']}[/]",
        title_justify="left",
        caption=f"limit {data['limit']:g} cm over {data['seconds']:g} s",
        caption_justify="left",
    )
    table.add_column("what (cm)")
    for column in ("an interval", "a second", "systematic", "random", ""):
        table.add_column(column, justify="right")
    for kind, yes in (("trapezoid", "too large"), ("terms", "needed")):
        for i, term in enumerate(found[kind]):
            numbers = (f"{term[k]:.3g}" for k in ("each", "a_second", "systematic", "random"))
            last = i == len(found[kind]) - 1
            table.add_row(term["name"], *numbers, yes if term["over"] else "", end_section=last)
    return table


def _left(found: dict[str, Any], data: dict[str, Any]) -> Table:
    from rich.table import Table

    table = Table(
        title=f"[bold]what is left over {data['seconds']:g} s (cm)[/]", title_justify="left"
    )
    table.add_column("position by")
    for column in ("an interval", "largest", "at the end"):
        table.add_column(column, justify="right")
    for key, words in (
        ("trapezoid", "trapezoid (Eq. 75)"),
        ("exact_integrals", "high resolution, exact integrals"),
        ("core", "high resolution, core"),
    ):
        error = found["left"][key]
        if error is None:
            table.add_row(words, "", "", "increments only")
        else:
            table.add_row(words, *(f"{error[k]:.3g}" for k in ("each", "largest", "final")))
    return table
