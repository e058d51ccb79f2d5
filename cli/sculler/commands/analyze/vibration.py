"""`sculler analyze vibration`: rectified coning and sculling of a shaken sensor assembly."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sculler import terminal
from sculler.commands.options import analysis as options
from sculler.commands.options.vibration import SPECTRUM_HELP, mount, mount_options

if TYPE_CHECKING:
    from rich.table import Table


@click.command(
    short_help="Rectified coning and sculling under random vibration.",
    epilog=terminal.examples(
        "sculler analyze vibration stim300 --spectrum savage-98 -o build/vibration.png",
        "sculler analyze vibration --family frequency-taylor --samples 2 --samples 4 \\\n"
        "    --spectrum flat:20-2000:0.04 --imbalance 2 --offset 0.5 --check 120",
    ),
)
@options.subject_options
@click.option(
    "--spectrum", default="savage-98", show_default=True, metavar="NAME|FILE", help=SPECTRUM_HELP
)
@mount_options
@click.option(
    "--check",
    "check_seconds",
    type=terminal.number_type(0, 3600, above=True),
    metavar="SECONDS",
    help="Also run so long a random vibration through counts, core and host, in 8 parts.",
)
@click.option("--seed", type=click.IntRange(0), default=1, show_default=True, help="Of --check.")
@options.picture_option
@terminal.json_option
def command(
    spectrum: str,
    check_seconds: float | None,
    seed: int,
    output: Path | None,
    as_json: bool,
    **asked: Any,
) -> None:
    """Show what a vibration rectifies to in a sensor assembly on isolators, and what is left of it.

    A linear mode along the vibration and two rotary modes, coupled by imbalance and offset of the
    centre of mass (Savage-98 section VI), their signs chosen to be worst.  `model` has the phases
    of that model; `worst phase` bounds any phases.
    """
    from sculler.formats.spectra import spectrum_of
    from sculler.runs.analysis import VibrationPlan, vibration_study

    options.require_picture(output)
    designs = {name: found.design for name, found in options.subjects(asked).items()}
    plan = VibrationPlan(designs, spectrum_of(spectrum), mount(asked), check_seconds, seed)
    with terminal.progress("integer path", plan.steps) as advance:
        study = vibration_study(plan, advance=advance)
    data = study.data
    if output is not None:
        from sculler.plots.vibration import vibration_picture

        vibration_picture(output, plan.spectrum, study.response, designs)
        data["picture"] = str(output)
    terminal.report(
        data,
        as_json,
        terminal.facts(study.told(), title=f"{plan.spectrum.name} through the mount"),
        _table(data["designs"]),
        *([_check_table(data["designs"])] if check_seconds is not None else []),
        *options.picture_told(output),
    )


_COLUMNS = (
    ("coning_deg_per_h", "coning (°/h)"),
    ("sculling_y_ug", "sculling y (µg)"),
    ("sculling_z_ug", "sculling z (µg)"),
)


def _table(data: dict[str, Any]) -> Table:
    from rich.table import Table

    table = Table(
        title="[bold]what the algorithm leaves of it, computed minus true; worst phase: at most[/]",
        title_justify="left",
    )
    table.add_column("design")
    table.add_column("phases")
    for _, title in _COLUMNS:
        table.add_column(title, justify="right")
    for name, found in data.items():
        for key, words in (("model", "model"), ("worst_phase", "worst phase")):
            table.add_row(
                name if key == "model" else "",
                words,
                *(f"{found[key][column]:.3g}" for column, _ in _COLUMNS),
                end_section=key == "worst_phase",
            )
    return table


def _check_table(data: dict[str, Any]) -> Table:
    from rich.table import Table

    seconds = next(iter(data.values()))["check"]["seconds"]
    table = Table(
        title=f"[bold]the same through counts, core and host: {seconds:g} s at random[/]",
        title_justify="left",
    )
    table.add_column("design")
    for _, title in _COLUMNS:
        table.add_column(title, justify="right")
    for name, found in data.items():
        error, sigma = found["check"]["error"], found["check"]["sigma"]
        table.add_row(name, *(f"{error[c]:.3g} ± {sigma[c]:.1g}" for c, _ in _COLUMNS))
    return table
