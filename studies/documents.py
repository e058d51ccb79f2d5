"""What the commands share that compute a page and draw its pictures: where it goes, Markdown."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from os.path import normpath
from pathlib import Path
from textwrap import fill

import click

from sculler import terminal
from sculler.plots.pictures import require_matplotlib
from sculler_model.errors import InputError
from sculler_model.outputs import make_folder, replacing

PAGES = Path("docs/explanation")
"""Where the pages go."""

IMAGES = "../images"
"""The folder of their pictures, as seen from there."""

WIDTH = 105
"""Columns of a document's paragraphs."""

_RULES = {"l": "---", "r": "---:"}


def folder_option(name: str) -> Callable[[terminal.Command], terminal.Command]:
    """`-o FOLDER`, in which `write_document` puts the document of this name."""
    return click.option(
        "-o",
        "--output",
        "folder",
        type=click.Path(file_okay=False, path_type=Path),
        default=PAGES,
        show_default=True,
        metavar="FOLDER",
        help=f"Where {name} and {IMAGES}/ go.",
    )


def results_option(folder: Path, holds: str) -> Callable[[terminal.Command], terminal.Command]:
    """`-o FOLDER`, in which results are kept from run to run; `holds` says which."""
    return click.option(
        "-o",
        "--output",
        "folder",
        type=click.Path(file_okay=False, path_type=Path),
        default=folder,
        show_default=True,
        metavar="FOLDER",
        help=holds,
    )


def only_option(
    what: str, known: Collection[str]
) -> Callable[[terminal.Command], terminal.Command]:
    """`--only NAME`, repeatable: `names`, each of them known, of what there are many."""

    def checked(_context: object, _option: object, names: tuple[str, ...]) -> tuple[str, ...]:
        for name in names:
            if name not in known:
                raise InputError(f"--only {name}: no {what}, give one of {', '.join(known)}")
        return names

    return click.option(
        "--only",
        "names",
        multiple=True,
        metavar=what.upper(),
        callback=checked,
        help=f"A {what}; several times for several: " + ", ".join(known) + ".",
    )


def write_document(path: Path, compute: Callable[[Path], tuple[str, list[Path]]]) -> None:
    """Write a document whole or not at all, and tell so.

    Args:
        path: of the document.
        compute: given the folder of its pictures (`IMAGES`, seen from the document), draws them
            there; returns the text and the pictures.

    Raises:
        InputError: matplotlib is absent, or a folder cannot be made or written to.
    """
    require_matplotlib()
    images = make_folder(Path(normpath(make_folder(path.parent) / IMAGES)))
    text, pictures = compute(images)
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
    terminal.report(
        {}, False, f"wrote {terminal.verbatim(path)} and {len(pictures)} pictures in {images}"
    )


def write_page(path: Path, text: str) -> None:
    """Write a document without pictures whole or not at all, and tell so.

    Raises:
        InputError: the folder cannot be made or written to.
    """
    path = make_folder(path.parent) / path.name
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
    terminal.report({}, False, f"wrote {terminal.verbatim(path)}")


def opening(title: str, takes: str, command: str) -> Iterator[str]:
    """A page's title and the command that writes it, which takes so long that no test runs it."""
    yield f"# {title}"
    yield ""
    yield "Written by"
    yield ""
    yield f"<!-- not run: takes {takes} -->"
    yield "```sh"
    yield command
    yield "```"
    yield ""


def joined(sections: Iterable[Iterable[str]]) -> str:
    """The text of a page of these sections, an empty line between them."""
    return "\n".join(line for section in sections for line in (*section, "")).rstrip() + "\n"


def paragraph(text: str) -> str:
    """Text filled to `WIDTH`."""
    return fill(text, WIDTH)


def table(sides: str, headings: Sequence[str], rows: Iterable[Sequence[str]]) -> Iterator[str]:
    """Lines of a Markdown table.

    Args:
        sides: a letter a column, `l` or `r`: the side to which it is set.
        headings: of the columns.
        rows: their cells.
    """
    yield _row(headings)
    yield "|" + "|".join(_RULES[side] for side in sides) + "|"
    yield from map(_row, rows)


def _row(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cells) + " |"
