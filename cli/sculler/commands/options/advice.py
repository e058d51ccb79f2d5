"""Options of `advise`: what the sensor must bear, what may be left, and a navigator's budget."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sculler import terminal
from sculler.commands.options.group import Command, group

if TYPE_CHECKING:
    from rich.table import Table

    from sculler_model.analysis.requirement import Budget


def _number(
    flag: str, metavar: str, text: str, default: float | None = None, *, above: bool = True
) -> Callable[[Command], Command]:
    return click.option(
        flag,
        type=terminal.number_type(0, above=above),
        default=default,
        show_default=default is not None,
        metavar=metavar,
        help=text,
    )


environment_options = group(
    click.option(
        "--coning",
        nargs=2,
        type=terminal.number_type(0, 1e6, above=True),
        metavar="DEG HZ",
        help="Classical coning instead: half angle and frequency.",
    ),
    click.option(
        "--sculling",
        nargs=3,
        type=terminal.number_type(0, 1e6, above=True),
        metavar="DEG G HZ",
        help="Classical sculling: amplitudes and frequency.",
    ),
    click.option(
        "--manoeuvre",
        "manoeuvre_file",
        type=click.Path(path_type=Path),
        metavar="FILE",
        help="A manoeuvre: CSV time_s,rate_x,...,force_z in s, deg/s and g.",
    ),
    _number(
        "--peak-rate",
        "DEG/S",
        "Fastest turn; if left out that of the manoeuvre, or 200.",
        above=False,
    ),
    _number("--peak-force", "G", "Largest specific force of manoeuvres.", 0.0, above=False),
    _number("--force-ramp", "G/S", "Its fastest change.", 0.0, above=False),
)
"""What the sensor must bear."""

requirement_options = group(
    _number("--drift", "DEG/H", "What coning may leave."),
    _number("--force", "UG", "What sculling may leave, micro-g."),
    _number("--angle", "DEG", "What the manoeuvre may leave of attitude."),
    _number("--velocity", "M/S", "What the manoeuvre may leave of velocity."),
    _number("--position", "CM", "What position may leave,"),
    _number("--over", "S", "over so long.", 10.0),
    _number("--host-rate", "HZ", "Results a second that the host wants at least.", 100.0),
)
"""What may be left."""

budget_options = group(
    _number(
        "--nmi-per-hour",
        "NMI/H",
        "A navigator's requirement: takes it apart, and asks for the algorithm's share.",
    ),
    _number("--gyro-bias", "DEG/H", "Of that navigator's gyros.", above=False),
    _number("--scale-factor", "PPM", "Error of its gyros' scale factor.", above=False),
    _number("--accel-bias", "UG", "Of its accelerometers.", above=False),
    _number("--misalignment", "URAD", "From sensor to sensor.", above=False),
    _number("--gravity-error", "UG", "Uncertainty of its gravity.", above=False),
    click.option(
        "--share",
        type=terminal.number_type(0, 100, above=True),
        default=1.0,
        show_default=True,
        metavar="PERCENT",
        help="Of the whole, for the algorithm.",
    ),
)
"""The navigator; see `budget`."""

_GRADE = {
    "gyro_bias": "gyro_bias",
    "scale_factor": "scale_factor",
    "accel_bias": "accel_bias",
    "misalignment": "misalignment",
    "gravity": "gravity_error",
}


def budget(options: Mapping[str, Any]) -> Budget | None:
    """What the options of `budget_options` ask for.

    Raises:
        UsageError: a navigator's errors without its requirement.
    """
    from dataclasses import replace

    from sculler_model.analysis import requirement

    given = {k: options[o] for k, o in _GRADE.items() if options[o] is not None}
    wanted = options["nmi_per_hour"]
    if wanted is None:
        if given:
            raise click.UsageError("the errors of a navigator's sensors need --nmi-per-hour")
        return None
    grade = replace(requirement.Grade.of(wanted), **given)
    return requirement.budget(wanted, grade, options["share"] / 100)


def budget_data(found: Budget) -> dict[str, Any]:
    """As JSON has it."""
    drift, angle = found.taken
    return {
        "nmi_per_hour": found.nmi_per_hour,
        "drift_deg_per_h": found.drift,
        "angle_deg": found.angle,
        "sources": [vars(p) | {"nmi_per_hour": p.nmi_per_hour} for p in found.parts],
        "taken": {"drift_deg_per_h": drift, "angle_deg": angle},
        "too_much": list(found.too_much),
        "algorithm": {
            "share": found.share,
            "drift_deg_per_h": found.algorithm_drift,
            "angle_deg": found.algorithm_angle,
            "force_ug": found.algorithm_force,
        },
    }


def budget_table(found: Budget) -> Table:
    """To read."""
    from rich.table import Table

    table = Table(
        title=f"[bold]{found.nmi_per_hour:g} nmi/h: what the computed attitude may have, and who"
        " takes it[/]",
        title_justify="left",
    )
    table.add_column("source")
    for column in ("size", "drift (°/h)", "nmi/h", "angle (°)"):
        table.add_column(column, justify="right")
    table.add_row(
        "in all", "", f"{found.drift:.3g}", f"{found.nmi_per_hour:g}", f"{found.angle:.2g}"
    )
    table.add_section()
    for part in found.parts:
        numbers = (f"{part.drift:.3g}", f"{part.nmi_per_hour:.2g}") if part.drift else ("", "")
        much = " too much" if part.source in found.too_much else ""
        table.add_row(
            part.source, f"{part.value:g} {part.unit}", *numbers, f"{part.angle:.2g}{much}"
        )
    drift, angle = found.taken
    table.add_row("these together (rss)", "", f"{drift:.3g}", "", f"{angle:.2g}")
    table.add_section()
    table.add_row(
        f"algorithm, {100 * found.share:g} %",
        f"{found.algorithm_force:g} µg",
        f"{found.algorithm_drift:.2g}",
        f"{found.share * found.nmi_per_hour:.2g}",
        f"{found.algorithm_angle:.1g}",
    )
    return table
