"""The command line of `python -m studies.mutate`."""

from __future__ import annotations

import json
from pathlib import Path

import click

from sculler import terminal
from sculler_model.errors import InputError
from sculler_model.outputs import make_folder, replacing
from sculler_sim.prove.shapes import SHAPES
from studies.mutate.verdicts import judge

RESULTS = Path("build/mutants")


@click.command(
    epilog=terminal.examples(
        "python -m studies.mutate",
        "python -m studies.mutate --only compact_one --count 100 --seconds 60",
    )
)
@click.option(
    "-o",
    "--output",
    "folder",
    type=click.Path(file_okay=False, path_type=Path),
    default=RESULTS,
    show_default=True,
    metavar="FOLDER",
    help="Where SHAPE-COUNT.json goes; what is there already is not run again.",
)
@click.option(
    "--only",
    "names",
    multiple=True,
    metavar="SHAPE",
    help="A shape; several times for several: " + ", ".join(SHAPES) + ".",
)
@click.option(
    "--count", type=click.IntRange(1), default=30, show_default=True, help="Changes of the gates."
)
@click.option(
    "--seconds", type=click.IntRange(1), default=60, show_default=True, help="A survivor's proof."
)
def command(folder: Path, names: tuple[str, ...], count: int, seconds: int) -> None:
    """Run changed cores against the test bench that is handed out, in Icarus Verilog.

    A survivor is held against the core by the model checker.  Exit status 1 where one can be told
    from the core: a fault of the bench.
    """
    for name in names:
        if name not in SHAPES:
            raise InputError(f"--only {name}: no shape, give one of {', '.join(SHAPES)}")
    make_folder(folder)
    faults = []
    for name in names or SHAPES:
        path = folder / f"{name}-{count}.json"
        if not path.is_file():
            with terminal.progress(name, count) as advance:
                found = judge(SHAPES[name], count, seconds, lambda: advance(1))
            with replacing(path) as temporary:
                temporary.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
        judged = json.loads(path.read_text(encoding="utf-8"))
        survivors = [each for each in judged if not each["killed"]]
        equal = sum(each["proof"] == "equivalent" for each in survivors)
        click.echo(
            f"{name}: {len(judged)} mutants, {len(judged) - len(survivors)} killed,"
            f" {equal} equivalent, {len(survivors) - equal} others"
        )
        for each in survivors:
            click.echo(f"  {each['proof']}: {each['change']}")
        faults += [each for each in survivors if each["proof"].startswith("differs")]
    if faults:
        raise click.exceptions.Exit(1)
