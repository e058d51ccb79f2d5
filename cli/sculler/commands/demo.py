"""`sculler demo`: the main job from end to end, with nothing but this program."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sculler import terminal
from sculler.words import three_digits

if TYPE_CHECKING:
    from rich.table import Table

_FAILED = 1


@click.command(epilog=terminal.examples("sculler demo -o build/demo --seconds 60"))
@click.option(
    "-o",
    "--output",
    "folder",
    type=click.Path(path_type=Path),
    default=Path("build/demo"),
    show_default=True,
    metavar="FOLDER",
    help="Where to write.",
)
@click.option(
    "--seconds",
    type=terminal.number_type(1, 3600),
    default=60.0,
    show_default=True,
    help="Length of the motion.",
)
@click.option("--plots/--no-plots", default=True, show_default=True, help="Draw the pictures.")
@terminal.json_option
def command(folder: Path, seconds: float, plots: bool, as_json: bool) -> int:
    """Show the main job on a motion whose truth is known.

    A vehicle turns while it cones and sculls.  Its integer IMU log goes through the generated
    Verilog (in Verilator) and through the golden model; the two must agree bit for bit.  Then the
    host navigates, and so does an integrator that knows no corrections; both are held against
    the truth.
    """
    from sculler.runs.demo import run_demo

    def done(step: str, took: float) -> None:
        if not as_json:
            terminal.stdout_console().print(f"[green]done[/] {step} [dim]{took:.1f} s[/]")

    outcome = run_demo(folder, seconds, pictures=plots, done=done)
    data = outcome.as_json()
    warnings = [f"warning: {terminal.verbatim(warning)}" for warning in outcome.warnings]
    terminal.report(
        data, as_json, "", _verdict(data), "", _table(data), "", *warnings, _where(data)
    )
    return 0 if outcome.identical and outcome.navigation_identical else _FAILED


def _verdict(data: dict[str, Any]) -> str:
    if data["identical"]:
        return (
            f"[green]identical[/]: {data['majors']:,} results of the RTL and of the golden model,"
            f" {data['samples']:,} samples, every integer"
        )
    return "[red]DIFFERENT[/]: the RTL and the golden model, see sculler compare"


def _table(data: dict[str, Any]) -> Table:
    from rich.table import Table

    from sculler.runs.demo import CORRECTED, LABELS, QUANTITIES, UNCORRECTED, UNITS

    table = Table(title=f"error after {data['seconds']:g} s", title_justify="left")
    table.add_column("")
    for name in (CORRECTED, UNCORRECTED, "times smaller"):
        table.add_column(name, justify="right")
    good, bad = (data["errors_at_end"][name] for name in (CORRECTED, UNCORRECTED))
    for label, unit, key in zip(LABELS, UNITS, QUANTITIES, strict=True):
        table.add_row(
            label,
            f"{three_digits(good[key])} {unit}",
            f"{three_digits(bad[key])} {unit}",
            f"{bad[key] / good[key]:,.0f}" if good[key] else "",
        )
    return table


def _where(data: dict[str, Any]) -> str:
    made = "files and pictures" if data["pictures"] else "files"
    return f"{made}: {terminal.verbatim(data['folder'])} (README.md says what is what)"
