"""The command line of `python -m studies.mutate`."""

from __future__ import annotations

from pathlib import Path

import click

from sculler import terminal
from sculler_model.outputs import make_folder
from studies import documents
from studies.mutate.page import document, results
from studies.mutate.shapes import SHAPES
from studies.mutate.verdicts import judge

RESULTS = Path("studies/mutate/found")


@click.command(
    epilog=terminal.examples(
        "python -m studies.mutate",
        "python -m studies.mutate --only compact_one --count 100 --seconds 60",
        "python -m studies.mutate --only one_minor --only compact_one --write",
    )
)
@documents.results_option(
    RESULTS,
    "Where SHAPE-COUNT.json goes; what is there of the same core and bench is not run again.",
)
@documents.only_option("shape", SHAPES)
@click.option(
    "--count", type=click.IntRange(1), default=60, show_default=True, help="Changes of the gates."
)
@click.option(
    "--seconds",
    type=click.IntRange(0),
    default=60,
    show_default=True,
    help="For the proof of a survivor; 0 for simulation alone.",
)
@click.option(
    "--write",
    is_flag=True,
    help=f"Write {documents.PAGES / 'mutants.md'} from what came out.",
)
def command(folder: Path, names: tuple[str, ...], count: int, seconds: int, write: bool) -> int:
    """Run changed cores against the test bench that is handed out, in Verilator and Icarus Verilog.

    A survivor is held against the core by the model checker.  Exit status 1 where one can be told
    from the core: a fault of the bench.
    """
    make_folder(folder)
    found = {}
    for name in SHAPES if not names else [name for name in SHAPES if name in names]:
        with terminal.progress(name, count) as advance:
            path = folder / f"{name}-{count}.json"
            found[name] = judge(SHAPES[name], count, seconds, path, lambda: advance(1))
    terminal.report({}, False, "\n".join(results(found)))
    if write:
        documents.write_page(documents.PAGES / "mutants.md", document(found, count, seconds))
    every = [mutant for mutants in found.values() for mutant in mutants]
    return int(any(mutant.proof.startswith("differs") for mutant in every))
