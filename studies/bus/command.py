"""The command line of `python -m studies.bus`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from textwrap import fill

import click

from sculler import terminal
from sculler_model.errors import InputError
from studies import documents
from studies.bus.measure import BUSES, FRONTS, GOAL_MHZ, SEEDS, Measured, measure

PAGE = "bus-area.md"

_ABOUT = (
    "`NAME_bus` of the preset `stim300` with four results in the queue, alone in an LFE5U-25F-6, by"
    f" Yosys and nextpnr, asked for {GOAL_MHZ} MHz. The rate is that of `clk`, the median of"
    f" {len(SEEDS)} seeds; what limits it is the block memory's output, which Yosys does not give"
    " the register that DP16KD has. [Buses and registers](../reference/bus.md) says what each is."
)

_ABOUT_FRONTS = (
    "`NAME_front` at a clock of 50 MHz, placed alike. [Front ends](../reference/front-ends.md)"
    " says what each reads."
)


@click.command(
    epilog=terminal.examples(
        f"python -m studies.bus -o {documents.PAGES}", "python -m studies.bus --only apb"
    )
)
@documents.folder_option(PAGE)
@click.option(
    "--only",
    "keys",
    multiple=True,
    metavar="ROW",
    help="A row of the table, shown and not written; several times for several.",
)
def command(folder: Path, keys: tuple[str, ...]) -> None:
    """Place and route each bus and front end in an ECP5, write bus-area.md."""
    known = (*BUSES, *FRONTS)
    for key in keys:
        if key not in known:
            raise InputError(f"--only {key}: not in the table, give one of {'; '.join(known)}")
    chosen = keys or known
    with terminal.progress("placing", len(chosen) * (1 + len(SEEDS))) as advance:
        found = [measure(name, advance) for name in chosen]
    if keys:
        terminal.report({}, False, "\n".join(table(found)))
        return
    documents.write_page(folder / PAGE, document(found))


def table(found: Sequence[Measured], what: str = "bus") -> list[str]:
    """The rows, in Markdown."""
    rows = (f"| {m.name} | {m.luts} | {m.registers} | {m.blocks} | {m.mhz:.0f} |" for m in found)
    return [f"| {what} | LUT4 | registers | DP16KD | MHz |", "|---|---:|---:|---:|---:|", *rows]


def document(found: Sequence[Measured]) -> str:
    """The page."""
    return "\n".join(
        [
            "# What a bus takes",
            "",
            "<!-- written by `python -m studies.bus` -->",
            "",
            fill(_ABOUT, documents.WIDTH),
            "",
            *table([one for one in found if one.name in BUSES]),
            "",
            "## What a front end takes",
            fill(_ABOUT_FRONTS, documents.WIDTH),
            "",
            *table([one for one in found if one.name in FRONTS], "front end"),
            "",
        ]
    )
