"""`sculler advise`: the cheapest design that meets a requirement."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sculler import terminal
from sculler.commands.options.vibration import SPECTRUM_HELP, mount, mount_options

if TYPE_CHECKING:
    from rich.table import Table

    from sculler.runs.advice import Plan
    from sculler_model.analysis.advice import Candidate

NONE_MEETS = 1
SHOWN = 10
_ASKED = ("coning", "peak_rate", "peak_force", "drift", "force", "host_rate", "by")


@click.command(
    short_help="Rank the designs that meet a requirement, cheapest first.",
    epilog=terminal.examples(
        "sculler advise stim300 --spectrum savage-98 --drift 1.7e-4 --force 1 -o best.toml",
        "sculler advise stim300 --coning 0.1 50 --drift 1e-4 --peak-rate 400",
    ),
)
@terminal.design_argument
@click.option("--spectrum", metavar="NAME|FILE", help=SPECTRUM_HELP)
@mount_options
@click.option(
    "--coning",
    nargs=2,
    type=terminal.number_type(0, 1e6, above=True),
    metavar="DEG HZ",
    help="Classical coning instead: half angle and frequency.",
)
@click.option(
    "--peak-rate",
    type=terminal.number_type(0),
    default=200.0,
    show_default=True,
    metavar="DEG/S",
    help="Fastest turn.",
)
@click.option(
    "--peak-force",
    type=terminal.number_type(0),
    default=0.0,
    show_default=True,
    metavar="G",
    help="Largest specific force of manoeuvres.",
)
@click.option(
    "--drift",
    type=terminal.number_type(0, above=True),
    metavar="DEG/H",
    help="What coning may leave.",
)
@click.option(
    "--force",
    type=terminal.number_type(0, above=True),
    metavar="UG",
    help="What sculling may leave, micro-g.",
)
@click.option(
    "--host-rate",
    type=terminal.number_type(0, above=True),
    default=100.0,
    show_default=True,
    metavar="HZ",
    help="Results a second that the host wants at least.",
)
@click.option(
    "--by",
    type=click.Choice(["work", "area"]),
    default="work",
    show_default=True,
    help="Cheapest by full-adder operations a second, or by full adders and register bits.",
)
@click.option("--all", "show_all", is_flag=True, help="Show every design, not the first ten.")
@click.option(
    "-o",
    "--output",
    type=terminal.OutputFile(),
    metavar="FILE",
    help="Write the cheapest as a design file.",
)
@terminal.json_option
def command(
    design_name: str,
    spectrum: str | None,
    show_all: bool,
    output: Path | None,
    as_json: bool,
    **asked: Any,
) -> int:
    """Find what to build for the sensor of DESIGN (a design file or a preset).

    Families, n, p, and increments summed to slower samples are tried; M is as large as the host's
    rate and the fastest turn (0.05 rad a result) allow.  Under a vibration what is left is the
    bound over all phases (see analyze vibration); under coning it includes the triple products.
    Exit status 1 if nothing meets the requirement.
    """
    from sculler.runs.advice import find_designs, write_design

    outcome = find_designs(_plan(design_name, spectrum, asked))
    good, bad = outcome.meet, outcome.fail
    data = outcome.as_json()
    tables: list[Any] = [_meets(good, len(good) if show_all else SHOWN)] if good else []
    wrote = []
    if output is not None and good:
        write_design(output, good[0].design)
        data["output"] = str(output)
        wrote = [f"wrote {terminal.verbatim(output)}"]
    tables.append(_fails(bad, len(bad) if show_all else SHOWN))
    count = len(good) + len(bad)
    verdict = (
        f"[green]{len(good)} of {count} designs meet it[/], cheapest by {asked['by']} first"
        if good
        else f"[red]none of {count} designs meets it[/]"
    )
    terminal.report(data, as_json, verdict, *tables, *wrote)
    return 0 if good else NONE_MEETS


def _plan(design_name: str, spectrum: str | None, asked: dict[str, Any]) -> Plan:
    """What the options ask for."""
    from sculler.formats.spectra import spectrum_of
    from sculler.runs.advice import Plan

    return Plan(
        terminal.load_design(design_name),
        mount(asked),
        None if spectrum is None else spectrum_of(spectrum),
        **{name: asked[name] for name in _ASKED},
    )


def _columns(table: Table) -> None:
    table.add_column("family", no_wrap=True)
    for column in ("n", "p", "M", "Hz"):
        table.add_column(column, justify="right", no_wrap=True)


def _cells(candidate: Candidate) -> list[str]:
    algorithm = candidate.design.algorithm
    fitted = " fitted" if algorithm.match == "least-squares" else ""
    return [
        algorithm.family + fitted,
        str(algorithm.samples),
        str(algorithm.history),
        str(algorithm.minors),
        f"{candidate.design.sensor.sample_rate_hz:g}",
    ]


def _meets(candidates: list[Candidate], count: int) -> Table:
    from rich.table import Table

    table = Table(
        title="[bold]designs that meet the requirement[/]",
        title_justify="left",
        caption=f"{len(candidates) - count} more: --all" if len(candidates) > count else None,
        caption_justify="left",
    )
    _columns(table)
    for column in ("°/h", "µg", "rows", "mult/sample", "additions", "bits", "k area", "M work/s"):
        table.add_column(column, justify="right")
    for candidate in candidates[:count]:
        cost = candidate.cost
        table.add_row(
            *_cells(candidate),
            f"{candidate.drift:.2g}",
            "" if candidate.force is None else f"{candidate.force:.2g}",
            str(cost.rows),
            f"{cost.multiplications:.3g}",
            str(cost.additions),
            str(cost.widest),
            f"{cost.area / 1e3:.1f}",
            f"{cost.work / 1e6:.2f}",
        )
    return table


def _fails(candidates: list[Candidate], count: int) -> Table:
    from rich.table import Table

    table = Table(
        title="[bold]designs that do not, the nearest first, and why[/]",
        title_justify="left",
        caption=f"{len(candidates) - count} more: --all" if len(candidates) > count else None,
        caption_justify="left",
    )
    _columns(table)
    table.add_column("why", overflow="fold")
    for candidate in candidates[:count]:
        table.add_row(*_cells(candidate), "; ".join(candidate.faults))
    return table
