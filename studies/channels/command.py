"""The command line of `python -m studies.channels`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from sculler import terminal
from sculler_hdl import timing
from sculler_model.errors import InputError
from studies import documents
from studies.channels.measure import CORES, UNITS, Measured, design_of, measure

PAGE = "channels.md"

_ABOUT = (
    "The compact core of the preset `stim300` (four samples, five minor intervals) with `channels`,"
    " in an ECP5 of speed grade 6, by Yosys and nextpnr, one seed. *Samples* are what it takes in"
    " the long run at the rate found, of all channels together; *each* is what that leaves for a"
    " channel, all alike. What is a channel's own stands in block memory (DP16KD, 18 kbit each);"
    " each shows its words from its own output register. A larger memory has blocks of fewer bits"
    " side by side, up to 16384 words; beyond there are banks of such, and which one it is comes"
    " from a register. What limits the rate with 256 channels of 24 bits is the way from a block's"
    " register through that choice to the multiplier, four fifths of it wire (`sculler place`). The"
    " pipelined core is not in these tables, for a placement of it takes long:"
    " `python -m studies.channels --core pipelined --only 64` places it and shows the rows."
)

_HEADINGS = (
    "C",
    "device",
    "LUT4",
    "registers",
    "DP16KD",
    "MHz",
    "samples/s",
    "each, Hz",
    "start-up, clocks",
)


@click.command(
    epilog=terminal.examples(
        f"python -m studies.channels -o {documents.PAGES}", "python -m studies.channels --only 16"
    )
)
@documents.folder_option(PAGE)
@click.option(
    "--only",
    "counts",
    multiple=True,
    type=int,
    metavar="C",
    help="Channels of the rows that are shown, and not written; several times for several.",
)
@click.option(
    "--core",
    type=click.Choice(CORES),
    default=CORES[0],
    show_default=True,
    help="Which core; the rows of the pipelined one are shown, and not written.",
)
def command(folder: Path, counts: tuple[int, ...], core: str) -> None:
    """Place and route cores with 1 to 1024 channels, write channels.md."""
    known = {channels for _, _, these in UNITS.values() for channels in these}
    for channels in counts:
        if channels not in known:
            listed = ", ".join(map(str, sorted(known)))
            raise InputError(f"--only {channels}: not in the table, give one of {listed}")
    rows = [
        (unit, channels)
        for unit, (_, _, these) in UNITS.items()
        for channels in these
        if not counts or channels in counts
    ]
    with terminal.progress("placing", len(rows)) as advance:
        found = [measure(unit, channels, core, advance) for unit, channels in rows]
    if counts or core != CORES[0]:
        terminal.report({}, False, "\n".join(table(found)))
        return
    documents.write_page(folder / PAGE, document(found))


def table(found: Sequence[Measured]) -> list[str]:
    """The rows, in Markdown."""
    rows = []
    for one in found:
        placed = one.placement
        start = timing(design_of(one.unit, one.channels, one.core)).startup
        rows.append(
            (
                f"{one.channels}",
                placed.device.split()[0],
                f"{placed.area.luts}",
                f"{placed.area.flip_flops}",
                f"{placed.area.memories}",
                f"{placed.fmax_mhz or 0:.0f}",
                f"{placed.samples_per_second or 0:,.0f}",
                f"{one.each_hz:,.0f}",
                f"{start}",
            )
        )
    return list(documents.table("rlrrrrrrr", _HEADINGS, rows))


def served(found: Sequence[Measured]) -> str:
    """Which of the units' rates are reached."""
    told = []
    for unit, (_, rate, _) in UNITS.items():
        most = [one for one in found if one.unit == unit and one.each_hz >= rate]
        if most:
            largest = max(most, key=lambda one: one.channels)
            told.append(
                f"{largest.channels} of the kind *{unit}* at {rate:,.0f} Hz in an"
                f" {largest.placement.device.split()[0]}"
            )
    return f"The largest rows that reach their unit's rate: {'; '.join(told)}." if told else ""


def document(found: Sequence[Measured]) -> str:
    """The page."""
    lines = ["# One core for many sensors", "", "<!-- written by `python -m studies.channels` -->"]
    lines += ["", documents.paragraph(_ABOUT), "", documents.paragraph(served(found)), ""]
    for unit in UNITS:
        lines += [f"## {unit}", *table([one for one in found if one.unit == unit]), ""]
    lines += [
        "[How to use it](../how-to/many-sensors.md);"
        " [the port contract](../reference/verilog.md#channels).",
        "",
    ]
    return "\n".join(lines)
