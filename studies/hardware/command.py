"""The command line of `python -m studies.hardware`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from sculler import terminal
from sculler_hdl import placed_designs
from sculler_model.errors import InputError
from studies import documents
from studies.hardware import counted_on
from studies.hardware import kept as kept_before
from studies.hardware.classes import classes, spread
from studies.hardware.measure import BUDGETS, SEEDS, design_space, measure
from studies.hardware.page import devices, document, goals, paths
from studies.hardware.pictures import draw
from studies.hardware.points import Point, points


@click.command(
    epilog=terminal.examples(
        f"python -m studies.hardware -o {documents.PAGES}",
        "python -m studies.hardware --only fast-24 --only compact-ecp5",
        "python -m studies.hardware --classes --only k24",
        "python -m studies.hardware --differing k24 --differing c16-n6",
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
@click.option(
    "--differing",
    "others",
    multiple=True,
    metavar="KEY",
    help="One of these designs, to be on the page too; several times for several, some ten minutes"
    " each; if left out those that are on it.",
)
@click.option(
    "--rates",
    type=click.Path(dir_okay=False, path_type=Path),
    default=counted_on.FILE,
    show_default=True,
    metavar="FILE",
    help="Where the rates go that the library tells.",
)
@click.option(
    "--kept",
    "kept_in",
    type=click.Path(dir_okay=False, path_type=Path),
    default=kept_before.FILE,
    metavar="FILE",
    show_default=True,
    help="What was placed before; what has the same Verilog, device and tools is not again.",
)
@click.option("--again", is_flag=True, help="Place again what is kept, too.")
def command(
    folder: Path,
    keys: tuple[str, ...],
    of_classes: bool,
    others: tuple[str, ...],
    rates: Path,
    kept_in: Path,
    again: bool,
) -> None:
    """Place and route the cores in the devices, write hardware.md and draw its pictures."""
    kept = kept_before.Kept(kept_in, again=again)
    differing = [point for group in classes() for point in group.points]
    chosen = _chosen("--only", keys, differing if of_classes else points())
    if of_classes:
        with terminal.progress("placing", len(chosen) * (1 + len(SEEDS))) as advance:
            text = "\n".join(spread(measure(chosen, kept, advance)))
        terminal.report({}, False, text)
        return
    if keys:
        with terminal.progress("placing", len(chosen) * (1 + len(SEEDS))) as advance:
            placed = measure(chosen, kept, advance)
        text = "\n".join([*goals(placed), "", *devices(placed), "", *paths(placed)])
        terminal.report({}, False, text)
        return

    def compute(images: Path) -> tuple[str, list[Path]]:
        wanted = others or tuple(one.key for one in placed_designs() if not one.tuned)
        beside = _chosen("--differing", wanted, differing) if wanted else []
        total = (len(chosen) + len(beside)) * (1 + len(SEEDS)) + len(BUDGETS) + 2
        with terminal.progress("placing", total) as advance:
            placed = measure(chosen, kept, advance)
            corners = design_space(kept, advance)
            differed = measure(beside, kept, advance)
        kept.drop_others()
        counted_on.write(rates, counted_on.rows(placed, differed))
        return document(placed, corners, differed), draw(images, placed, corners)

    documents.write_document(folder / "hardware.md", compute)


def _chosen(option: str, keys: tuple[str, ...], offered: Sequence[Point]) -> list[Point]:
    """Those of the keys; all if there are none."""
    known = [point.key for point in offered]
    for key in keys:
        if key not in known:
            raise InputError(f"{option} {key}: not in the table, give one of {', '.join(known)}")
    return [point for point in offered if not keys or point.key in keys]
