"""The page accuracy.md, put together and written."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import click

from sculler import terminal
from studies import documents
from studies.accuracy.pictures import draw
from studies.accuracy.position import position
from studies.accuracy.recursion import recursion
from studies.accuracy.savage_20 import savage_20
from studies.accuracy.savage_98 import in_time, savage_98
from studies.accuracy.section import Section
from studies.accuracy.yang import yang
from studies.accuracy.zeng import zeng

SECTIONS: tuple[Callable[[], Section], ...] = (
    savage_20,
    savage_98,
    in_time,
    position,
    zeng,
    yang,
    recursion,
)

HEAD = """# Accuracy: the papers' figures beside ours

Every figure of ours on this page is computed by `make accuracy` (`python -m studies.accuracy`),
which also draws the pictures. Drifts are computed minus true. Papers: see [theory](theory.md).
Functions stand in `sculler_model` and its `analysis`, commands in `sculler`."""


def document() -> str:
    """The whole of the page."""
    lines = [HEAD]
    with terminal.progress("computing", len(SECTIONS)) as advance:
        for section in SECTIONS:
            lines += section().lines()
            advance(1)
    return "\n".join(lines) + "\n"


@click.command(epilog=terminal.examples(f"python -m studies.accuracy -o {documents.PAGES}"))
@documents.folder_option("accuracy.md")
def command(folder: Path) -> None:
    """Compute accuracy.md and draw its pictures."""
    documents.write_document(folder / "accuracy.md", lambda images: (document(), draw(images)))
