"""The command line of `python -m studies.hardware`."""

from __future__ import annotations

from pathlib import Path

import click

from sculler import terminal
from sculler_model.errors import InputError
from studies import documents
from studies.hardware.measure import BUDGETS, SEEDS, design_space, measure
from studies.hardware.page import devices, document, goals, paths
from studies.hardware.pictures import draw
from studies.hardware.points import points


@click.command(
    epilog=terminal.examples(
        f"python -m studies.hardware -o {documents.PAGES}",
        "python -m studies.hardware --only fast-24 --only compact-ecp5",
    )
)
@documents.folder_option("hardware.md")
@click.option(
    "--only",
    "keys",
    multiple=True,
    metavar="KEY",
    help="A part of the table, shown and not written; several times for several: "
    + ", ".join(point.key for point in points())
    + ".",
)
def command(folder: Path, keys: tuple[str, ...]) -> None:
    """Place and route the cores in the devices, write hardware.md and draw its pictures."""
    chosen = [point for point in points() if not keys or point.key in keys]
    known = [point.key for point in points()]
    for key in keys:
        if key not in known:
            raise InputError(f"--only {key}: not in the table, give one of {', '.join(known)}")
    if keys:
        with terminal.progress("placing", len(chosen) * (1 + len(SEEDS))) as advance:
            placed = measure(chosen, advance)
        text = "\n".join([*goals(placed), "", *devices(placed), "", *paths(placed)])
        terminal.report({}, False, text)
        return

    def compute(images: Path) -> tuple[str, list[Path]]:
        total = len(chosen) * (1 + len(SEEDS)) + len(BUDGETS) + 2
        with terminal.progress("placing", total) as advance:
            placed = measure(chosen, advance)
            corners = design_space(advance)
        return document(placed, corners), draw(images, placed, corners)

    documents.write_document(folder / "hardware.md", compute)
