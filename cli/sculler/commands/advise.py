"""`sculler advise`: the cheapest design that meets a requirement."""

from __future__ import annotations

import json
from dataclasses import asdict
from math import radians
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sculler import terminal
from sculler.commands.options.vibration import SPECTRUM_HELP, mount, mount_options

if TYPE_CHECKING:
    from rich.table import Table

    from sculler_model.analysis.advice import Candidate
    from sculler_model.design import Design

NONE_MEETS = 1
SHOWN = 10


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
    coning: tuple[float, float] | None,
    peak_rate: float,
    peak_force: float,
    drift: float | None,
    force: float | None,
    host_rate: float,
    by: str,
    show_all: bool,
    output: Path | None,
    as_json: bool,
    **mount_values: float,
) -> int:
    """Find what to build for the sensor of DESIGN (a design file or a preset).

    Families, n, p, and increments summed to slower samples are tried; M is as large as the host's
    rate and the fastest turn (0.05 rad a result) allow.  Under a vibration what is left is the
    bound over all phases (see analyze vibration); under coning it includes the triple products.
    Exit status 1 if nothing meets the requirement.
    """
    from sculler.formats.spectra import spectrum_of
    from sculler_model.analysis.advice import Environment, Requirement, advise
    from sculler_model.analysis.vibration import G
    from sculler_model.errors import InputError

    if (spectrum is None) == (coning is None):
        raise click.UsageError("give an environment: --spectrum or --coning")
    if drift is None and force is None:
        raise click.UsageError("give a requirement: --drift, --force or both")
    base = terminal.load_design(design_name)
    if coning is not None:
        if force is not None:
            raise click.UsageError("--force needs --spectrum: pure coning has no specific force")
        if coning[0] > 45:
            raise InputError(f"--coning: {coning[0]:g}° is not allowed, give at most 45")
        if coning[1] >= base.sensor.sample_rate_hz / 2:
            raise InputError(
                f"--coning: {coning[1]:g} Hz is not below the Nyquist limit of"
                f" {base.sensor.sample_rate_hz / 2:g} Hz, give less"
            )
    half_angle, hertz = coning or (0.0, 0.0)
    environment = Environment(
        spectrum=spectrum_of(spectrum) if spectrum is not None else None,
        mount=mount(**mount_values),
        half_angle=radians(half_angle),
        hertz=hertz,
        peak_rate=radians(peak_rate),
        peak_force=G * peak_force,
    )
    found = advise(base, environment, Requirement(drift, force, host_rate), by=by)
    good = [candidate for candidate in found if candidate.meets]
    bad = [candidate for candidate in found if not candidate.meets]
    data: dict[str, Any] = {
        "sensor": base.name,
        "meet": [_as_json(candidate) for candidate in good],
        "fail": [_as_json(candidate) for candidate in bad],
    }
    tables: list[Any] = [_meets(good, len(good) if show_all else SHOWN)] if good else []
    if output is not None and good:
        _write(output, good[0].design)
        data["output"] = str(output)
    tables.append(_fails(bad, len(bad) if show_all else SHOWN))
    verdict = (
        f"[green]{len(good)} of {len(found)} designs meet it[/], cheapest by {by} first"
        if good
        else f"[red]none of {len(found)} designs meets it[/]"
    )
    wrote = [f"wrote {terminal.verbatim(output)}"] if output is not None and good else []
    terminal.report(data, as_json, verdict, *tables, *wrote)
    return 0 if good else NONE_MEETS


def _as_json(candidate: Candidate) -> dict[str, Any]:
    design = candidate.design
    return {
        "name": design.name,
        "family": design.algorithm.family,
        "samples": design.algorithm.samples,
        "history": design.algorithm.history,
        "minors": design.algorithm.minors,
        "sample_rate_hz": design.sensor.sample_rate_hz,
        "drift_deg_per_h": candidate.drift,
        "force_ug": candidate.force,
        "cost": asdict(candidate.cost),
        "faults": list(candidate.faults),
        "design": design.as_json(),
    }


def _columns(table: Table) -> None:
    table.add_column("family", no_wrap=True)
    for column in ("n", "p", "M", "Hz"):
        table.add_column(column, justify="right", no_wrap=True)


def _cells(candidate: Candidate) -> list[str]:
    algorithm = candidate.design.algorithm
    return [
        algorithm.family,
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


def _write(path: Path, design: Design) -> None:
    """The design as a file that `sculler` reads."""
    from sculler_model.outputs import replacing

    data = design.as_json()
    lines = ["# found by sculler advise", f"name = {_toml(data.pop('name'))}"]
    for part, values in data.items():
        lines += ["", f"[{part}]", *(f"{key} = {_toml(value)}" for key, value in values.items())]
    with replacing(path) as temporary:
        temporary.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _toml(value: Any) -> str:
    """A value on one line of TOML."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {_toml(item)}" for key, item in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(_toml, value)) + "]"
    return json.dumps(value)  # strings, numbers and booleans are written alike
