"""The command line of `python -m studies.prove`."""

from __future__ import annotations

import tempfile
from pathlib import Path

import click

from sculler import terminal
from sculler_model.outputs import make_folder
from sculler_sim.prove.claims import settle
from sculler_sim.prove.engine import Verdict
from sculler_sim.prove.shapes import SHAPES
from studies import documents
from studies.prove.kept import Kept
from studies.prove.page import Found, document, results

SECONDS = 20
"""For each property."""

RESULTS = Path("studies/prove/found")


@click.command(
    epilog=terminal.examples(
        "python -m studies.prove --write",
        "python -m studies.prove --only one_minor --seconds 60",
        "python -m studies.prove --only one_minor --only compact_one --cheap --write",
    )
)
@documents.results_option(
    RESULTS, "Where SHAPE.json goes; what is settled there of the same core is not tried again."
)
@documents.only_option("shape", SHAPES)
@click.option("--write", is_flag=True, help=f"Write {documents.PAGES / 'proof.md'}.")
@click.option(
    "--cheap", is_flag=True, help="Try nothing on the first results, which takes minutes each."
)
@click.option(
    "--seconds",
    type=click.IntRange(0),
    default=SECONDS,
    show_default=True,
    help="A property; 0 to try none.",
)
def command(folder: Path, names: tuple[str, ...], write: bool, cheap: bool, seconds: int) -> int:
    """Prove what is claimed of the cores on small shapes.

    What is found is kept, so that a later run goes on: it tries again what is open, if it has more
    seconds.  Exit status 1 where a claim is refuted.
    """
    found = _found([name for name in SHAPES if not names or name in names], folder, seconds, cheap)
    terminal.report({}, False, "\n".join(results(found)))
    if write:
        documents.write_page(documents.PAGES / "proof.md", document(found))
    refuted = [
        f"{name}: {label}"
        for name, claims in found.items()
        for label, (outcome, _) in claims.items()
        if outcome.verdict is Verdict.REFUTED
    ]
    if refuted:
        click.echo("refuted: " + ", ".join(refuted), err=True)
    return 1 if refuted else 0


def _found(names: list[str], folder: Path, seconds: int, cheap: bool) -> Found:
    """What is known of each shape, and what more can be found out in so many seconds."""
    make_folder(folder)
    found = {}
    for name in names:
        kept = Kept.read(folder / f"{name}.json", SHAPES[name])
        if seconds:
            with (
                tempfile.TemporaryDirectory(prefix="sculler-prove-") as work,
                terminal.progress(name, 0) as advance,
            ):
                known = kept.known(seconds)
                for label, outcome in settle(SHAPES[name], Path(work), seconds, known, cheap=cheap):
                    kept.add(label, outcome, seconds)
                    advance(1)
        found[name] = kept.claims
    return found
