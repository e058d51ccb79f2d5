"""The command line of `python -m studies.hardware`."""

from __future__ import annotations

from pathlib import Path

import click

from sculler import terminal
from sculler_model.errors import InputError
from studies import documents
from studies.hardware.classes import classes, spread
from studies.hardware.measure import BUDGETS, SEEDS, design_space, measure
from studies.hardware.page import devices, document, goals, paths
from studies.hardware.pictures import draw
from studies.hardware.points import points


@click.command(
    epilog=terminal.examples(
        f"python -m studies.hardware -o {documents.PAGES}",
        "python -m studies.hardware --only fast-24 --only compact-ecp5",
        "python -m studies.hardware --classes --only k24",
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
@click.option(
    "--classes",
    "of_classes",
    is_flag=True,
    help="The designs chosen to differ instead, shown and not written; all without --only: "
    + ", ".join(point.key for group in classes() for point in group.points)
    + ".",
)
def command(folder: Path, keys: tuple[str, ...], of_classes: bool) -> None:
    """Place and route the cores in the devices, write hardware.md and draw its pictures."""
    differing = [point for group in classes() for point in group.points]
    offered = differing if of_classes else points()
    chosen = [point for point in offered if not keys or point.key in keys]
    known = [point.key for point in offered]
    for key in keys:
        if key not in known:
            raise InputError(f"--only {key}: not in the table, give one of {', '.join(known)}")
    if of_classes:
        with terminal.progress("placing", len(chosen) * (1 + len(SEEDS))) as advance:
            text = "\n".join(spread(measure(chosen, advance)))
        terminal.report({}, False, text)
        return
    if keys:
        with terminal.progress("placing", len(chosen) * (1 + len(SEEDS))) as advance:
            placed = measure(chosen, advance)
        text = "\n".join([*goals(placed), "", *devices(placed), "", *paths(placed)])
        terminal.report({}, False, text)
        return

    def compute(images: Path) -> tuple[str, list[Path]]:
        total = (len(chosen) + len(differing)) * (1 + len(SEEDS)) + len(BUDGETS) + 2
        with terminal.progress("placing", total) as advance:
            placed = measure(chosen, advance)
            corners = design_space(advance)
            differed = measure(differing, advance)
        return document(placed, corners, differed), draw(images, placed, corners)

    documents.write_document(folder / "hardware.md", compute)
