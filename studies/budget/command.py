"""The command line of `python -m studies.budget`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import click

from sculler import terminal
from sculler.plots.campaign import campaign_picture
from sculler.runs.campaign import Outcome, hardware_told
from sculler.runs.campaign.statistics import Statistics
from sculler.words import three_digits
from sculler_model.analysis.requirement import Grade, budget
from studies import documents
from studies.budget.flown import ALGORITHM, ALL, DESIGN, RUNS, campaign_text, fly, label, sources

PAGE, PICTURE = "error-budget.md", "error-budget.png"

_ABOUT = (
    "Savage-20 takes the error budgets of inertial navigators of 1 and 0.1 nautical miles an hour"
    " apart, and asks what the attitude algorithm may leave: a hundredth. Here both are flown. Each"
    " run draws the sensors' errors anew (normally distributed, the paper's figures as standard"
    " deviations of each axis), flies an hour's flight of climbs, turns and two full circles"
    " through counts, the core's integers and the navigator, and begins perfectly aligned."
)


@click.command(epilog=terminal.examples("python -m studies.budget"))
@documents.folder_option(PAGE)
@click.option("--runs", type=click.IntRange(2, 10_000), default=RUNS, show_default=True)
@click.option(
    "--build",
    type=click.Path(file_okay=False, path_type=Path),
    default=Path("build/budget"),
    show_default=True,
    help="Where the campaign's files go; what is flown there stays.",
)
def command(folder: Path, runs: int, build: Path) -> None:
    """Fly Savage-20's error budgets, source by source; write error-budget.md."""
    total = runs * campaign_text(runs, 1.0).count("[[design]]")
    with terminal.progress("flying", total) as advance:
        outcome = fly(build, runs, advance=advance)

    def compute(images: Path) -> tuple[str, list[Path]]:
        shown = {
            name: outcome.statistics[name] for name in (label(1.0, ALL), label(0.1, ALL), ALGORITHM)
        }
        return document(outcome), [campaign_picture(shown, images / PICTURE)]

    documents.write_document(folder / PAGE, compute)


def document(outcome: Outcome) -> str:
    """The page."""
    found, runs = outcome.statistics, outcome.campaign.tables.runs
    lines = [
        "# Error budgets flown",
        "",
        "<!-- made by python -m studies.budget -->",
        "",
        documents.paragraph(_ABOUT),
        "",
        "<!-- not run: flies for minutes -->",
        "```sh",
        "python -m studies.budget",
        "```",
        "",
        documents.paragraph(
            f"{runs} runs of each. Growth is the horizontal error over the time, of which half of"
            " the runs stay below; in brackets the ends of its confidence interval of 95 %. The"
            " paper's column is `sculler_model.analysis.requirement.budget`: the average rate of"
            " the vertical that the source makes, as nautical miles an hour."
        ),
        "",
        *documents.table(
            "lrrrrr",
            ("1 nmi/h", "σ", "budget, nmi/h", "flown, nmi/h", "heading, ″", "tilt, ″"),
            _rows(found),
        ),
        "",
        *documents.table(
            "lrrr",
            ("all of them", "flown, nmi/h", "heading, ″", "tilt, ″"),
            _totals(found),
        ),
        "",
        f"![Horizontal error of both grades]({documents.IMAGES}/{PICTURE})",
        "",
        documents.paragraph(_judged(found)),
        "",
        documents.paragraph(f"Hardware: {hardware_told(outcome.held)}."),
        "",
        "The design, `ins.toml`:",
        "",
        "```toml",
        DESIGN.rstrip("\n"),
        "```",
    ]
    return "\n".join(lines) + "\n"


def _rows(found: Mapping[str, Statistics]) -> list[tuple[str, ...]]:
    """The sources of 1 nmi/h one by one."""
    parts = {part.source: part for part in budget(1.0).parts}
    rows: list[tuple[str, ...]] = []
    for name in sources(Grade.of(1.0)):
        part = parts[name]
        drift = three_digits(part.nmi_per_hour) if part.drift else "a swing"
        rows.append(
            (name, f"{part.value:g} {part.unit}", drift, *_figures(found[label(1.0, name)]))
        )
    return rows


def _totals(found: Mapping[str, Statistics]) -> list[tuple[str, ...]]:
    """Both grades, and what the algorithm leaves without any error."""
    rows = [(f"{rate:g} nmi/h", *_figures(found[label(rate, ALL)])) for rate in (1.0, 0.1)]
    return [*rows, (ALGORITHM, *_figures(found[ALGORITHM]))]


def _figures(found: Statistics) -> tuple[str, str, str]:
    value, low, high = (three_digits(each) for each in found.growth[0.5])
    heading, tilt = three_digits(found.heading[0.5][0]), three_digits(found.tilt[0.5][0])
    return f"{value} ({low} to {high})", heading, tilt


def _judged(found: Mapping[str, Statistics]) -> str:
    """What the figures say of the algorithm."""
    alone = found[ALGORITHM]
    growth, tilt = alone.growth[0.5][0], alone.tilt[0.5][0]
    allowed = budget(0.1)
    told = three_digits(100 * growth / 0.1)
    return (
        f"The algorithm alone, with counts of 32 bits, leaves {three_digits(growth)} nmi/h and a"
        f" tilt of {three_digits(tilt)}″ after the hour: {told} % of the budget of 0.1 nmi/h, of"
        f" which Savage-20 allows it 1 %, and {three_digits(allowed.algorithm_angle * 3600)}″ of"
        " manoeuvres. That is of a flight without vibration; what vibration takes is in"
        " [accuracy](accuracy.md)."
    )
