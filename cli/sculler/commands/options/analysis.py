"""Groups of options of `analyze`: which designs, the picture, the band of a study."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sculler import terminal
from sculler.commands.options.group import Command, group

if TYPE_CHECKING:
    from sculler.runs.analysis import FrequencyPlan, Kind, Subject
    from sculler_model.design import Design

REQUIREMENTS = (1.7e-4, 1.7e-5)
"""°/h: for 1 nmph and 0.1 nmph navigation (Savage-20, NEW ATTITUDE ALGORITHM REQUIREMENTS)."""

subject_options = group(
    click.argument("designs", metavar="[DESIGN]...", nargs=-1),
    click.option(
        "--family", "families", multiple=True, metavar="NAME", help="A family; repeatable."
    ),
    click.option(
        "--samples",
        type=click.IntRange(1),
        multiple=True,
        metavar="N",
        help="Samples of a minor interval of the families; repeatable.",
    ),
    click.option(
        "--history",
        type=click.IntRange(0),
        multiple=True,
        metavar="P",
        help="Samples before the interval of the families; repeatable, 0 if left out.",
    ),
    click.option(
        "--minors",
        type=click.IntRange(1),
        metavar="M",
        help="Minor intervals of a major one of the families; what is nearest to 10 ms if left"
        " out.",
    ),
    click.option(
        "--rate",
        type=terminal.number_type(0, 1e9, above=True),
        default=2000.0,
        show_default=True,
        metavar="HZ",
        help="Sample rate of the families.",
    ),
    click.option(
        "--band",
        nargs=2,
        type=terminal.number_type(0),
        metavar="LOW HIGH",
        help="Band (Hz) that least-squares is fitted over.",
    ),
)
"""DESIGN... and the options that make designs of families; see `subjects`."""

half_angle_option = click.option(
    "--half-angle",
    type=terminal.number_type(0, 45, above=True),
    default=0.1,
    show_default=True,
    metavar="DEG",
    help="Half angle of the cone.",
)
"""`half_angle`, degrees."""

degree_option = click.option(
    "--degree",
    type=click.IntRange(1, 30),
    default=10,
    show_default=True,
    help="Of the polynomial through the samples that the yardstick (iteration) is solved on.",
)
"""`degree`, of `sculler_model.analysis.iteration`."""

fine_option = click.option(
    "--fine", is_flag=True, help="Run designs on a fine sensor, as families are."
)

picture_option = click.option(
    "-o",
    "--output",
    type=terminal.OutputFile(),
    metavar="FILE",
    help="Draw a picture (PNG).",
)
"""`-o FILE`: where to draw, if at all; see `require_picture`."""


def frequency_options(unit: str, requirements: Sequence[float]) -> Callable[[Command], Command]:
    """The band, how many frequencies, the sensor and the requirement lines."""
    return group(
        click.option(
            "--from",
            "low",
            type=terminal.number_type(0, above=True),
            default=1.0,
            show_default=True,
            metavar="HZ",
            help="Lowest frequency.",
        ),
        click.option(
            "--to",
            "high",
            type=terminal.number_type(0, above=True),
            metavar="HZ",
            help="Highest frequency; the fastest design's Nyquist limit if left out.",
        ),
        click.option(
            "--points",
            type=click.IntRange(2, 1_000_000),
            default=1000,
            show_default=True,
            help="Frequencies by closed form.",
        ),
        click.option(
            "--integer-points",
            type=click.IntRange(1, 1000),
            default=10,
            show_default=True,
            help="Frequencies through the integer path.",
        ),
        fine_option,
        click.option(
            "--requirement",
            "requirements",
            type=terminal.number_type(0, above=True),
            multiple=True,
            default=tuple(requirements),
            show_default=bool(requirements),
            metavar="DRIFT",
            help=f"A requirement to hold it against, {unit}; repeatable.",
        ),
    )


def require_picture(output: Path | None) -> None:
    """See that a wanted picture can be drawn, before any work is done.

    Raises:
        InputError: its name is not that of a PNG, or matplotlib is absent.
    """
    from sculler_model.errors import InputError

    if output is None:
        return
    if output.suffix.lower() != ".png":
        raise InputError(f"{output}: pictures are PNG, give a name that ends in .png")
    from sculler.plots.pictures import require_matplotlib

    require_matplotlib()


def picture_told(output: Path | None) -> list[str]:
    """The report's line about it."""
    return [] if output is None else [f"picture: {terminal.verbatim(output)}"]


def filtered_told(*designs: Design) -> list[str]:
    """The report's line about designs whose samples passed a filter that is stated."""
    names = [design.name for design in designs if design.sensor_response is not None]
    if not names:
        return []
    return [
        f"behind the sensor's filter: {', '.join(names)}; iteration does not know of it, tuned"
        " tables do"
    ]


def frequency_plan(kind: Kind, options: Mapping[str, Any]) -> FrequencyPlan:
    """What the options of `subject_options` and `frequency_options` ask for."""
    from sculler.runs.analysis import FrequencyPlan

    return FrequencyPlan(
        kind,
        subjects(options),
        options["low"],
        options["high"],
        options["points"],
        options["integer_points"],
        options["fine"],
        options["requirements"],
        options.get("degree"),
    )


def subjects(options: Mapping[str, Any]) -> dict[str, Subject]:
    """Subjects of `subject_options` by the name that tables and pictures give them.

    Raises:
        UsageError: the options do not go together, or there is nothing to study.
        InputError: a design has faults, or a family is not known.
    """
    from sculler.runs.analysis import Subject, of_family, require_band

    designs, families, samples = options["designs"], options["families"], options["samples"]
    if not designs and not families:
        raise click.UsageError("nothing to analyze, give a design file, a preset or --family")
    if families and not samples:
        raise click.UsageError(
            "--family needs --samples, as in --family frequency-taylor --samples 4"
        )
    if samples and not families:
        raise click.UsageError("--samples belongs to --family, give that too")
    require_band(families, options["band"])
    found = {}
    for name in designs:
        design = terminal.load_bare_design(name)
        found[design.name] = Subject(design, False)
    for family, n, p in product(families, samples, options["history"] or (0,)):
        found[f"{family} n={n}" + (f" p={p}" if p else "")] = of_family(
            family, n, p, options["minors"], options["rate"], options["band"]
        )
    return found
