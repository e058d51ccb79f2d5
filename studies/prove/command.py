"""The command line of `python -m studies.prove`."""

from __future__ import annotations

import tempfile
from pathlib import Path

import click

from sculler import terminal
from sculler_model.errors import InputError
from sculler_sim.prove.claims import settle
from sculler_sim.prove.engine import Outcome, Verdict
from sculler_sim.prove.shapes import SHAPES
from studies import documents
from studies.prove.page import document, results

SECONDS = 20
"""For each property."""


@click.command(
    epilog=terminal.examples(
        f"python -m studies.prove -o {documents.PAGES}",
        "python -m studies.prove --only one_minor --seconds 60",
        "python -m studies.prove --only one_minor --only compact_one --write",
    )
)
@documents.folder_option("proof.md")
@click.option(
    "--only",
    "names",
    multiple=True,
    metavar="SHAPE",
    help="A shape, shown and not written; several times for several: " + ", ".join(SHAPES) + ".",
)
@click.option("--write", is_flag=True, help="Write the page of these shapes alone, too.")
@click.option(
    "--seconds", type=click.IntRange(1), default=SECONDS, show_default=True, help="A property."
)
def command(folder: Path, names: tuple[str, ...], write: bool, seconds: int) -> int:
    """Prove what is claimed of the cores on small shapes, and write proof.md.

    Exit status 1 where a claim is refuted.
    """
    for name in names:
        if name not in SHAPES:
            raise InputError(f"--only {name}: no shape, give one of {', '.join(SHAPES)}")
    found = _settle([name for name in SHAPES if not names or name in names], seconds)
    if names:
        terminal.report({}, False, "\n".join(results(found)))
    if write or not names:
        documents.write_page(folder / "proof.md", document(found, seconds))
    refuted = [
        f"{name}: {label}"
        for name, outcomes in found.items()
        for label, outcome in outcomes.items()
        if outcome.verdict is Verdict.REFUTED
    ]
    if refuted:
        click.echo("refuted: " + ", ".join(refuted), err=True)
    return 1 if refuted else 0


def _settle(names: list[str], seconds: int) -> dict[str, dict[str, Outcome]]:
    found: dict[str, dict[str, Outcome]] = {}
    with terminal.progress("proving", len(names)) as advance:
        for name in names:
            with tempfile.TemporaryDirectory(prefix="sculler-prove-") as work:
                found[name] = settle(SHAPES[name], Path(work), seconds)
            advance(1)
    return found
