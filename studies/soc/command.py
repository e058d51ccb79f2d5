"""The command line of `python -m studies.soc`."""

from __future__ import annotations

from pathlib import Path

import click

from sculler import terminal
from studies import documents
from studies.soc.fly import measure, usual_chip
from studies.soc.more import further
from studies.soc.page import document, draw, flight_table, parts_table, told_busy_clocks
from studies.soc.place import DEVICES, place

PAGE = "chip.md"


@click.command(
    epilog=terminal.examples(
        f"python -m studies.soc -o {documents.PAGES}",
        "python -m studies.soc --only-flight",
        "python -m studies.soc --only-device LIFCL-40",
    )
)
@documents.folder_option(PAGE)
@click.option("--only-flight", is_flag=True, help="Fly, show the figures, write nothing.")
@click.option(
    "--only-device",
    type=click.Choice(DEVICES),
    help="Place in this device, show the figures, write nothing; the flight's are the page's.",
)
def command(folder: Path, only_flight: bool, only_device: str | None) -> None:
    """Fly the chip in Verilator, place and route it, write chip.md and its picture.

    Needs the extras soc, sim and place, and riscv64-unknown-elf-gcc with picolibc.  It takes some
    quarter of an hour.
    """
    if only_device is not None:
        with terminal.progress("placing", None):
            placed = list(place(usual_chip(), [only_device]))
        lines = parts_table(placed, told_busy_clocks(folder / PAGE))
        terminal.report({}, False, "\n".join(lines))
        return
    with terminal.progress("flying", None):
        flight = measure()
    if only_flight:
        terminal.report({}, False, "\n".join(flight_table(flight)))
        return
    with terminal.progress("flying other chips", None):
        more = further()

    def compute(images: Path) -> tuple[str, list[Path]]:
        with terminal.progress("placing", len(DEVICES)) as advance:
            found = []
            for placed in place(flight.chip):
                found.append(placed)
                advance(1)
        return document(flight, more, found), [draw(images, flight)]

    documents.write_document(folder / PAGE, compute)
