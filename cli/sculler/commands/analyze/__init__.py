"""`sculler analyze`: what a design leaves, in numbers and pictures; one module a sub-verb."""

from __future__ import annotations

import click

from sculler import terminal
from sculler.verbs import VerbGroup

VERBS = (
    "coning",
    "sculling",
    "manoeuvre",
    "vibration",
    "quantisation",
    "third-order",
    "orders",
    "position",
)


@click.group(
    cls=VerbGroup,
    package=__name__,
    verbs=VERBS,
    epilog=terminal.examples("sculler analyze coning stim300 --family time-taylor --samples 4"),
)
def command() -> None:
    """Show what a design leaves: by closed form and through the integer path.

    Most studies take design files, presets and families (all combinations of --family, --samples
    and --history), and set them side by side in a table, as JSON, and in a picture (-o).
    """
