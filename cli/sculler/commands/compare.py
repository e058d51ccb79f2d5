"""`sculler compare`: two vectors files, integer for integer."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path

import click

from sculler import terminal
from sculler.words import plural

_FAILED = 1


@click.command(epilog=terminal.examples("sculler compare model.csv rtl.csv"))
@click.argument("first", metavar="A", type=click.Path(path_type=Path))
@click.argument("second", metavar="B", type=click.Path(path_type=Path))
@terminal.json_option
def command(first: Path, second: Path, as_json: bool) -> int:
    """Say whether the vectors files A and B are identical.

    Exit status 0 if they are; else 1, with the first difference: major, column and both values.
    """
    from sculler.formats.comparison import compare
    from sculler.formats.vectors import results_in

    difference = compare(first, second)
    data = {"first": str(first), "second": str(second), "identical": difference is None}
    if difference is None:
        rows = results_in(first)
        told = "" if rows is None else f": {plural(rows, 'row')}"
        terminal.report(data | {"rows": rows}, as_json, f"identical{told}")
        return 0
    terminal.report(
        data | {"difference": asdict(difference)},
        as_json,
        f"different: {terminal.verbatim(difference.describe(first, second))}",
    )
    return _FAILED
