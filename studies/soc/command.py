"""The command line of `python -m studies.soc`."""

from __future__ import annotations

from pathlib import Path

import click

from sculler import terminal
from studies import documents
from studies.soc.fly import measure
from studies.soc.more import further
from studies.soc.page import document, draw, flight_table
from studies.soc.place import DEVICES, place

PAGE = "chip.md"


@click.command(
    epilog=terminal.examples(
        f"python -m studies.soc -o {documents.PAGES}", "python -m studies.soc --only-flight"
    )
)
@documents.folder_option(PAGE)
@click.option("--only-flight", is_flag=True, help="Fly, show the figures, write nothing.")
def command(folder: Path, only_flight: bool) -> None:
    """Fly the chip in Verilator, place and route it in two ECP5, write chip.md and its picture.

    Needs the extras soc, sim and place, and riscv64-unknown-elf-gcc with picolibc.  It takes some
    half an hour.
    """
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
