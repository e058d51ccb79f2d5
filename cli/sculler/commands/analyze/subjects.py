"""What the studies have in common: which designs they are about, the picture, the number types."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from sculler import terminal

if TYPE_CHECKING:
    from sculler_model.design import Design

Command = TypeVar("Command", bound=Callable[..., Any])

FITTED = "least-squares"
"""The family that --band is for; what else is fitted comes from a design file."""

FINE_LSB = {"gyro": {"bits": 32, "lsb": 1e-10}, "accel": {"bits": 32, "lsb": 1e-9}}
"""Sensor of a family that comes without a design: full scale 0.21 rad and 2.1 m/s a sample."""


@dataclass(frozen=True)
class Subject:
    """A design to study; of_family if it has no sensor of its own."""

    design: Design
    of_family: bool


def chain(command: Command, *options: Callable[[Command], Command]) -> Command:
    """The command with options in the order of its help."""
    for option in reversed(options):
        command = option(command)
    return command


def subject_options(command: Command) -> Command:
    """DESIGN... and the options that make designs of families."""
    return chain(
        command,
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
            help="Samples of the previous interval of the families; repeatable, 0 if left out.",
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
            help=f"Band (Hz) that {FITTED} is fitted over.",
        ),
    )


def picture_option(command: Command) -> Command:
    """`-o FILE`: where to draw, if at all."""
    return click.option(
        "-o",
        "--output",
        type=terminal.OutputFile(),
        metavar="FILE",
        help="Draw a picture (PNG).",
    )(command)


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


def subjects(
    designs: tuple[str, ...],
    families: tuple[str, ...],
    samples: tuple[int, ...],
    history: tuple[int, ...],
    minors: int | None,
    rate: float,
    band: tuple[float, float] | None,
) -> dict[str, Subject]:
    """Subjects by the name that tables and pictures give them.

    Raises:
        InputError: a design has faults, a family is not known, or there is nothing to study.
    """
    if not designs and not families:
        raise click.UsageError("nothing to analyze, give a design file, a preset or --family")
    if families and not samples:
        raise click.UsageError(
            "--family needs --samples, as in --family frequency-taylor --samples 4"
        )
    if samples and not families:
        raise click.UsageError("--samples belongs to --family, give that too")
    if (FITTED in families) != (band is not None):
        raise click.UsageError(f"--family {FITTED} and --band belong together, give both or none")
    found = {}
    for name in designs:
        design = terminal.load_design(name)
        found[design.name] = Subject(design, False)
    for family, n, p in product(families, samples, history or (0,)):
        design = _of_family(family, n, p, minors or max(round(rate / (100 * n)), 1), rate, band)
        found[f"{family} n={n}" + (f" p={p}" if p else "")] = Subject(design, True)
    return found


def _of_family(
    family: str, n: int, p: int, minors: int, rate: float, band: tuple[float, float] | None
) -> Design:
    from sculler_model.design import Design

    algorithm: dict[str, Any] = {"family": family, "samples": n, "history": p, "minors": minors}
    if band is not None and family == FITTED:
        algorithm["band"] = {"low_hz": band[0], "high_hz": band[1]}
    kind = "rate" if family == "filtered-rate" else "increment"
    scale = rate if kind == "rate" else 1.0
    sensor: dict[str, Any] = {"kind": kind, "sample_rate_hz": rate}
    for axes, word in FINE_LSB.items():
        sensor[axes] = word | {"lsb": word["lsb"] * scale}
    name = "family_" + "".join(c if c.isalnum() else "_" for c in f"{family[:40]}_{n}_{p}")
    return Design.parse({"name": name, "sensor": sensor, "algorithm": algorithm}, where=family)


half_angle_option = click.option(
    "--half-angle",
    type=terminal.number_type(0, 45, above=True),
    default=0.1,
    show_default=True,
    metavar="DEG",
    help="Half angle of the cone.",
)
"""`half_angle`, degrees."""
