"""`sculler advise`: the cheapest design that meets a requirement."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sculler import terminal
from sculler.commands.options import advice
from sculler.commands.options.vibration import SPECTRUM_HELP, mount, mount_options

if TYPE_CHECKING:
    from rich.table import Table

    from sculler.runs.advice import Plan
    from sculler.runs.speeds import Speed
    from sculler_model.analysis.advice import Candidate
    from sculler_model.analysis.requirement import Budget

NONE_MEETS = 1
SHOWN = 10
_ASKED = (
    *("coning", "sculling", "peak_rate", "peak_force", "force_ramp", "host_rate", "by"),
    *("drift", "force", "angle", "velocity", "position", "over"),
)


@click.command(
    short_help="Rank the designs that meet a requirement, cheapest first.",
    epilog=terminal.examples(
        "sculler advise stim300 --spectrum savage-98 --drift 1.7e-4 --force 1 -o best.toml",
        "sculler advise stim300 --coning 0.1 50 --drift 1e-4 --peak-rate 400",
        "sculler advise stim300 --sculling 0.1 1 35 --force 1 --peak-force 3 --position 1",
        "sculler advise --nmi-per-hour 0.1",
    ),
)
@click.argument("design_name", metavar="[DESIGN]", required=False)
@click.option("--spectrum", metavar="NAME|FILE", help=SPECTRUM_HELP)
@mount_options
@advice.environment_options
@advice.requirement_options
@advice.budget_options
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
    design_name: str | None,
    spectrum: str | None,
    show_all: bool,
    output: Path | None,
    as_json: bool,
    **asked: Any,
) -> int:
    """Find what to build for the sensor of DESIGN (a design file or a preset).

    Families, n, p, and increments summed to slower samples are tried; M is as large as the host's
    rate and the fastest turn (0.05 rad a result) allow.  Where coning or a manoeuvre asks for more,
    third and fourth order are tried too; where a manoeuvre or position does, smaller M and
    high-resolution position.  Under a vibration what is left is the bound over all phases (see
    analyze vibration); under coning it includes the triple products.  --nmi-per-hour prints a
    navigator's budget, and asks for what it leaves the algorithm; without DESIGN that is all.  Of
    the cheapest it tells the clock rate to count on, from designs that were placed and routed, and
    whether the sensor's samples fit: with DESIGN's hardware, or in each core and target that was
    placed if its target is generic.  Exit status 1 if nothing meets the requirement.
    """
    navigator = advice.budget(asked)
    if design_name is None:
        if navigator is None:
            raise click.UsageError("give a DESIGN, or --nmi-per-hour for a navigator's budget")
        given = [output, spectrum, *(asked[k] for k in ("coning", "sculling", "manoeuvre_file"))]
        if any(item is not None for item in given):
            raise click.UsageError("what a sensor must bear needs its DESIGN, give it")
        data: dict[str, Any] = {"budget": advice.budget_data(navigator)}
        terminal.report(data, as_json, advice.budget_table(navigator))
        return 0
    from sculler.runs.advice import find_designs, write_design
    from sculler.runs.speeds import speeds

    plan = _plan(design_name, spectrum, asked, navigator)
    outcome = find_designs(plan)
    good, bad = outcome.meet, outcome.fail
    data = outcome.as_json()
    tables: list[Any] = [_meets(good, len(good) if show_all else SHOWN)] if good else []
    if navigator is not None:
        data["budget"] = advice.budget_data(navigator)
        tables.insert(0, advice.budget_table(navigator))
    wrote: list[str] = []
    if output is not None and good:
        write_design(output, good[0].design)
        data["output"] = str(output)
        wrote = [f"wrote {terminal.verbatim(output)}"]
    if len(outcome.orders) > 1:
        tables.append(_orders(outcome.orders))
    if good:
        found = speeds(good[0].design, plan.base)
        data["speeds"] = [speed.as_json() for speed in found]
        tables.append(_speeds(found))
    tables.append(_fails(bad, len(bad) if show_all else SHOWN))
    count = len(good) + len(bad)
    verdict = (
        f"[green]{len(good)} of {count} designs meet it[/], cheapest by {asked['by']} first"
        if good
        else f"[red]none of {count} designs meets it[/]"
    )
    terminal.report(data, as_json, verdict, *tables, *wrote)
    return 0 if good else NONE_MEETS


def _plan(
    design_name: str, spectrum: str | None, asked: dict[str, Any], navigator: Budget | None
) -> Plan:
    """What the options ask for; what a navigator leaves the algorithm where they are silent."""
    from sculler.formats.spectra import spectrum_of
    from sculler.runs.advice import Plan
    from sculler_model.analysis.flight import Profile

    file, wanted = asked["manoeuvre_file"], {name: asked[name] for name in _ASKED}
    if wanted["peak_rate"] is None:
        wanted["peak_rate"] = 200.0 if file is None else 0.0
    shaken = spectrum is not None
    if navigator is not None:
        for name, limit, there in (
            ("drift", navigator.algorithm_drift, shaken or wanted["coning"]),
            ("force", navigator.algorithm_force, shaken or wanted["sculling"]),
            ("angle", navigator.algorithm_angle, file),
        ):
            if there and wanted[name] is None:
                wanted[name] = limit
    return Plan(
        terminal.load_bare_design(design_name),
        mount(asked),
        None if spectrum is None else spectrum_of(spectrum),
        manoeuvre=None if file is None else Profile.load(file),
        **wanted,
    )


def _columns(table: Table) -> None:
    table.add_column("family", no_wrap=True)
    for column in ("n", "p", "l Hz", "m Hz", "n Hz"):
        table.add_column(column, justify="right", no_wrap=True)


def _cells(candidate: Candidate) -> list[str]:
    algorithm = candidate.design.algorithm
    rate = candidate.design.sensor.sample_rate_hz
    fitted = " fitted" if algorithm.match == "least-squares" else ""
    fine = " fine" if algorithm.position == "high-resolution" else ""
    order = f" order {algorithm.order}" if algorithm.order else ""
    return [
        algorithm.family + fitted + fine + order,
        str(algorithm.samples),
        str(algorithm.history),
        f"{rate:g}",
        f"{rate / algorithm.samples:.4g}",
        f"{1 / candidate.design.major_interval:.4g}",
    ]


def _meets(candidates: list[Candidate], count: int) -> Table:
    from rich.table import Table

    table = Table(
        title="[bold]designs that meet the requirement[/]",
        title_justify="left",
        caption=_caption(len(candidates) - count),
        caption_justify="left",
    )
    _columns(table)
    _results(table, candidates)
    for candidate in candidates[:count]:
        table.add_row(*_cells(candidate), *_result_cells(candidate, candidates))
    return table


def _orders(candidates: list[Candidate]) -> Table:
    """What each order of a design leaves and takes."""
    from rich.table import Table

    name = candidates[0].design.name
    table = Table(
        title=f"[bold]{terminal.verbatim(name)} with each order: what is left, what it takes[/]",
        title_justify="left",
        caption=_needed(candidates),
        caption_justify="left",
    )
    table.add_column("order", justify="right")
    _results(table, candidates)
    for candidate in candidates:
        table.add_row(str(candidate.design.order), *_result_cells(candidate, candidates))
    return table


def _needed(candidates: list[Candidate]) -> str:
    """Which order this design needs."""
    least = next((one.design.order for one in candidates if one.meets), None)
    if least is None:
        return "no order of this design meets the requirement"
    return f"this design needs order {least}" if least > 2 else "order 2 is enough"


def _speeds(found: list[Speed]) -> Table:
    """The clock rates that a design may count on, and whether the samples fit."""
    from rich.table import Table

    from sculler.words import three_digits

    design = found[0].design
    name, rate = terminal.verbatim(design.name), design.sensor.sample_rate_hz
    table = Table(
        title=f"[bold]{name} in real devices, {rate:g} samples/s asked[/]",
        title_justify="left",
    )
    table.add_column("core, target", no_wrap=True)
    for column in ("clocks/sample", "MHz", "samples/s"):
        table.add_column(column, justify="right")
    table.add_column("fits")
    table.add_column("basis of the clock rate", overflow="fold")
    for speed in found:
        hardware, clocks = speed.design.hardware, speed.clocks_per_sample
        mhz, taken = speed.rate.mhz, speed.samples_per_second
        table.add_row(
            f"{hardware.core}, {hardware.target}",
            "" if clocks is None else f"{clocks:.4g}",
            "" if mhz is None else f"{mhz:.1f}",
            "" if taken is None else three_digits(taken),
            {True: "yes", False: "[red]no[/]", None: "unknown"}[speed.fits],
            terminal.verbatim(speed.rate.basis),
        )
    return table


def _results(table: Table, candidates: list[Candidate]) -> None:
    """The columns of what designs leave and take."""
    paths = _paths(candidates)
    for column in ("°/h", "µg", *(_PATHS[name][0] for name in paths)):
        table.add_column(column, justify="right")
    for column in ("mult/sample", "bits", "k area", "M work/s"):
        table.add_column(column, justify="right")


def _paths(candidates: list[Candidate]) -> list[str]:
    """What of manoeuvres and position any of them tells."""
    return [name for name in _PATHS if any(getattr(c, name) is not None for c in candidates)]


def _result_cells(candidate: Candidate, candidates: list[Candidate]) -> list[str]:
    """What a design leaves and takes, in the columns of `_results` of several."""
    cost = candidate.cost
    left = {name: getattr(candidate, name) for name in _paths(candidates)}
    return [
        f"{candidate.drift:.2g}",
        "" if candidate.force is None else f"{candidate.force:.2g}",
        *("" if x is None else f"{x * _PATHS[name][1]:.2g}" for name, x in left.items()),
        f"{cost.multiplications:.3g}",
        str(cost.widest),
        f"{cost.area / 1e3:.1f}",
        f"{cost.work / 1e6:.2f}",
    ]


_PATHS = {"angle": ("°", 1.0), "velocity": ("m/s", 1.0), "position": ("cm", 100.0)}
"""Heading and scale of what is left of manoeuvres and position."""


def _caption(more: int) -> str:
    told = f"{more} more: --all; " if more > 0 else ""
    return told + "l samples, m minor intervals, n results a second; fine: high-resolution position"


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
