"""The command line of `python -m studies.campaigns`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from sculler import terminal
from sculler.words import three_digits
from studies import documents
from studies.campaigns.measure import RATE, WARM, Timed, timed

PAGE = "campaign-speed.md"

_ABOUT = (
    "`python -m studies.campaigns` (`make campaigns`) writes this page. Every run flies through"
    " imperfect sensors with all errors of the STIM300's data sheet, flicker too, counts, the"
    " core's integers and the navigator. What more workers are worth is measured on fewer runs; the"
    " whole is flown by as many workers as were best."
)


CROWDED = (
    " Other programs had most of the processors meanwhile, so look at the processor time, not at"
    " the clock."
)


@click.command(
    epilog=terminal.examples(
        "python -m studies.campaigns",
        "python -m studies.campaigns --runs 20 --compared 4 --seconds 10 -o build",
    )
)
@documents.folder_option(PAGE)
@click.option("--runs", type=click.IntRange(1, 1_000_000), default=1000, show_default=True)
@click.option(
    "--compared",
    type=click.IntRange(1, 1_000_000),
    default=100,
    show_default=True,
    help="Runs of each number of workers.",
)
@click.option(
    "--seconds", type=terminal.number_type(1, 86400), default=600.0, show_default=True, metavar="S"
)
@click.option(
    "--workers",
    type=click.IntRange(1, 1024),
    multiple=True,
    default=(1, 2),
    show_default=True,
    help="Repeatable, the fewest first.",
)
@click.option(
    "--build",
    type=click.Path(file_okay=False, path_type=Path),
    default=Path("build/campaigns"),
    show_default=True,
    help="Where the campaigns go.",
)
def command(
    folder: Path, runs: int, compared: int, seconds: float, workers: tuple[int, ...], build: Path
) -> None:
    """Time campaigns, with one worker and with more; write campaign-speed.md."""
    timed(build, WARM, 1.0, 1)
    each = []
    with terminal.progress("flying", len(workers) + 1) as advance:
        for many in workers:
            each.append(timed(build, compared, seconds, many))
            advance(1)
        best = min(each, key=lambda found: found.clock)
        whole = timed(build, runs, seconds, best.workers)
        advance(1)
    documents.write_document(folder / PAGE, lambda _: (document(each, whole), []))


def document(each: Sequence[Timed], whole: Timed) -> str:
    """The page.

    Args:
        each: the same campaign with some numbers of workers, the fewest first.
        whole: the large one.
    """
    same = "identical" if len({found.digest for found in each}) == 1 else "**not** identical"
    return "\n".join(
        [
            "# How long campaigns take",
            "",
            documents.paragraph(_ABOUT),
            "",
            documents.paragraph(
                f"{whole.runs:,} flights of {whole.seconds / 60:g} minutes at {RATE} Hz took"
                f" {three_digits(whole.clock / 60)} minutes with {whole.workers} workers:"
                f" {three_digits(whole.samples)} samples, {three_digits(whole.a_sample)} µs of"
                " processor time each. A thousand flights of ten minutes are"
                f" {three_digits(free_minutes(whole, 2))} minutes of two processors that do nothing"
                " else." + (CROWDED if whole.busy < 0.5 else "")
            ),
            "",
            *documents.table(
                "rrrrrrr",
                (
                    "workers",
                    "runs",
                    "minutes",
                    "runs a minute",
                    "growth",
                    "processor, µs a sample",
                    "busy",
                ),
                [*(_row(found, each[0]) for found in each), _row(whole, each[0])],
            ),
            "",
            documents.paragraph(
                "*Growth* is runs a minute over those of the first row. *Busy* is the share of the"
                " workers' time in which they had a processor: what is missing from 1 was another"
                " program's, the start of a process, or a wait. The results of the rows that are"
                f" compared are {same}, bit for bit."
            ),
            "",
        ]
    )


def free_minutes(found: Timed, processors: int) -> float:
    """Minutes that a thousand flights of ten take, if the processors have nothing else to do."""
    return 1000 * 600.0 * RATE * found.a_sample * 1e-6 / 60 / processors


def _row(found: Timed, first: Timed) -> list[str]:
    return [
        str(found.workers),
        f"{found.runs:,}",
        three_digits(found.clock / 60),
        three_digits(found.a_minute),
        f"{found.a_minute / first.a_minute:.2f}",
        three_digits(found.a_sample),
        f"{found.busy:.2f}",
    ]
