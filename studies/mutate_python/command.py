"""The command line of `python -m studies.mutate_python`."""

from __future__ import annotations

import tempfile
from functools import cache, partial
from pathlib import Path

import click

from sculler import terminal
from sculler_model.errors import InputError
from sculler_model.outputs import make_folder
from studies import documents
from studies.mutate_python.subjects import DRAWS, SUBJECTS

RESULTS = Path("studies/mutate_python/found")
PAGE = documents.PAGES / "mutants-python.md"


@click.command(
    epilog=terminal.examples(
        "python -m studies.mutate_python",
        "python -m studies.mutate_python --only golden --count 40 --seed 7",
        "python -m studies.mutate_python --draws 2 --again --write",
    )
)
@documents.results_option(
    RESULTS, "Where SUBJECT.json goes; a mutant that is there already is not run again."
)
@documents.only_option("subject", SUBJECTS)
@click.option(
    "--count",
    type=click.IntRange(1),
    default=15,
    show_default=True,
    help="Mutants of each subject in a draw.",
)
@click.option(
    "--draws",
    type=click.IntRange(1, len(DRAWS)),
    default=1,
    show_default=True,
    help="How many; a later one draws from what the earlier ones left.",
)
@click.option("--seed", default=1, show_default=True, help="Of the draws.")
@click.option("--again", is_flag=True, help="Run those again that lived and are not equivalent.")
@click.option("--write", is_flag=True, help=f"Write {PAGE} from what came out.")
def command(
    folder: Path,
    names: tuple[str, ...],
    count: int,
    draws: int,
    seed: int,
    again: bool,
    write: bool,
) -> int:
    """Change the Python in one place at a time, and see whether its fast tests fail.

    Exit status 1 where a mutant lives that nobody has judged to compute the same.
    """
    try:
        from studies.mutate_python import page, runs, verdicts
    except ImportError as error:
        raise InputError(f"{error.name} is not installed: install sculler[mutants]") from error
    make_folder(folder)
    found = {}
    with tempfile.TemporaryDirectory(prefix="sculler-mutants-") as work:
        copy = cache(lambda: runs.copy(Path(work)))
        for name in names or SUBJECTS:
            with terminal.progress(name, draws * count) as advance:
                kept = folder / f"{name}.json"
                found[name] = verdicts.sample(
                    SUBJECTS[name],
                    count,
                    seed,
                    kept,
                    copy,
                    draws=draws,
                    again=again,
                    done=partial(advance, 1),
                )
    judged = verdicts.judgements()
    terminal.report({}, False, "\n".join(page.results(found, judged)))
    if write:
        documents.write_page(PAGE, page.document(found, judged, count, draws, seed))
    return int(bool(page.unjudged(found, judged)))
