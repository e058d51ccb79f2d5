"""The command line of `python -m studies.evidence`."""

from __future__ import annotations

import json
from pathlib import Path

import click

from sculler import terminal
from sculler_model.errors import InputError
from sculler_model.outputs import make_folder, replacing
from studies import documents
from studies.evidence.evidence import as_json, dangling, requirements
from studies.evidence.page import page

PAGE = "evidence.md"


@click.command(
    epilog=terminal.examples(
        f"python -m studies.evidence -o {documents.PAGES}",
        "python -m studies.evidence --data build/evidence.json",
    )
)
@documents.folder_option(PAGE)
@click.option(
    "--data",
    type=click.Path(dir_okay=False, path_type=Path),
    default=Path("build/evidence.json"),
    show_default=True,
    metavar="FILE",
    help="Where the same goes as JSON.",
)
def command(folder: Path, data: Path) -> None:
    """Write what is required of the core, and the design, tests and proofs of each requirement.

    It runs no test and no proof: it finds those that are there, and what `make prove` has written.
    """
    listed = requirements()
    wrong = dangling(listed)
    if wrong:
        raise InputError(f"studies/evidence/requirements.toml: {'; '.join(wrong)}: mend the names")
    for path, text in (
        (make_folder(folder) / PAGE, page(listed)),
        (make_folder(data.parent) / data.name, json.dumps(as_json(listed), indent=2) + "\n"),
    ):
        with replacing(path) as temporary:
            temporary.write_text(text, encoding="utf-8")
        terminal.report({}, False, f"wrote {terminal.verbatim(path)}")
