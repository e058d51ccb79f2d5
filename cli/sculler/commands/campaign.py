"""`sculler campaign`: many runs with imperfect sensors, and their statistics."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from sculler import terminal
from sculler.words import warning_rows

if TYPE_CHECKING:
    from rich.table import Table


_FAILED = 1


@click.command(
    short_help="Fly a motion many times with imperfect sensors: error growth, CEP.",
    epilog=terminal.examples(
        "sculler campaign campaign.toml -o build/campaign",
        "sculler campaign campaign.toml -o build/campaign --workers 1 --json",
        "sculler campaign campaign.toml -o build/campaign --scheduler tcp://host:8786",
    ),
)
@click.argument("file", metavar="FILE", type=terminal.InputFile(Path))
@click.option(
    "-o",
    "--output",
    "folder",
    type=click.Path(path_type=Path),
    required=True,
    metavar="FOLDER",
    help="Where to write results.parquet, summary.json and growth.png; what is there is kept.",
)
@click.option(
    "--workers",
    type=click.IntRange(1, 1024),
    metavar="N",
    help="Processes of this machine; as many as it has cores if left out.",
)
@click.option(
    "--scheduler", metavar="ADDRESS", help="A Dask scheduler whose workers do it instead."
)
@click.option("--dry-run", is_flag=True, help="Say what would be flown, and fly nothing.")
@terminal.json_option
def command(
    file: Path,
    folder: Path,
    workers: int | None,
    scheduler: str | None,
    dry_run: bool,
    as_json: bool,
) -> int:
    """Fly the motion of FILE with its designs and [sensor.errors], once for each seed.

    Each run goes through counts, the exact integers of the core (the fast twin of the golden
    model), and the navigator, and is held against the truth.  Told are the errors at the end that
    50 % (of the horizontal error: the CEP) and 95 % of the runs do not exceed, each with its
    confidence interval of 95 %.

    A run depends on its seed alone: the results are the same with any number of workers.  An
    interrupted campaign goes on where it stopped, and more runs are added to those that are there.

    With a table [rtl] some runs go through the hardware too, and every integer is held against the
    fast twin's: exit status 1 if one differs.
    """
    from sculler.runs.campaign import Campaign, hardware_told, run_campaign
    from sculler_model.errors import ContradictionError

    if workers is not None and scheduler is not None:
        raise ContradictionError("--workers and --scheduler do not go together, give one of them")
    campaign = Campaign.load(file)
    if dry_run:
        data = campaign.as_json()
        told = {label: f"{samples:,} samples a run" for label, samples in data["designs"].items()}
        told |= {"runs": f"{data['runs']:,} of each, seeds from {data['first_seed']} on"}
        if "rtl_seeds" in data:
            told["hardware"] = f"seeds {', '.join(map(str, data['rtl_seeds']))} of each"
        terminal.report(data, as_json, terminal.facts(told))
        return 0
    total = campaign.tables.runs * len(campaign.designs)
    with terminal.progress("flying", total) as advance:
        outcome = run_campaign(
            campaign, file, folder, workers=workers, scheduler=scheduler, advance=advance
        )
    facts = {"hardware": hardware_told(outcome.held)} if outcome.held else {}
    facts |= {"wrote": f"{folder}: {', '.join(outcome.files)}"} | warning_rows(outcome.warnings)
    terminal.report(outcome.as_json(), as_json, _table(*outcome.table()), terminal.facts(facts))
    return 0 if outcome.identical else _FAILED


def _table(titles: list[str], rows: list[list[str]]) -> Table:
    from rich.table import Table
    from rich.text import Text

    table = Table(box=None, header_style="bold")
    for number, title in enumerate(titles):
        table.add_column(title, justify="right" if number else "left")
    for row in rows:
        table.add_row(*map(Text, row))
    return table
