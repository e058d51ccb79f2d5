"""`sculler analyze sculling`: residual acceleration against the sculling frequency."""

from __future__ import annotations

from math import radians
from pathlib import Path
from typing import Any

import click

from sculler import terminal
from sculler.commands.analyze import subjects
from sculler.commands.options.analysis import frequency_options

MICRO_G = 9.80665e-6
"""m/s² per µg."""


@click.command(
    short_help="Residual acceleration against sculling frequency.",
    epilog=terminal.examples(
        "sculler analyze sculling stim300 --family frequency-taylor --samples 2 --samples 3 \\\n"
        "    -o build/sculling.png",
    ),
)
@subjects.subject_options
@click.option(
    "--angle",
    type=terminal.number_type(0, 45, above=True),
    default=0.1,
    show_default=True,
    metavar="DEG",
    help="Amplitude of the rotation.",
)
@click.option(
    "--force",
    type=terminal.number_type(0, above=True),
    default=10.0,
    show_default=True,
    metavar="M/S2",
    help="Amplitude of the specific force.",
)
@frequency_options("µg", ())
@subjects.picture_option
@terminal.json_option
def command(angle: float, force: float, output: Path | None, as_json: bool, **options: Any) -> None:
    """Show the acceleration that sculling leaves, against its frequency.

    The body rocks about x and feels a force along y in phase with it, which rectifies along z.  The
    error is computed minus true, in µg: by closed form, by the core's integers (second order), and
    by the velocity that the host arrives at.
    """
    from sculler.commands.analyze.frequency import Kind
    from sculler.commands.options.analysis import run_frequency_study
    from sculler_model.analysis.frequency import Scull

    kind = Kind(
        "sculling",
        f"Acceleration left of sculling, {angle:g}° with {force:g} m/s²",
        "µg",
        1 / MICRO_G,
        "host's velocity",
    )
    run_frequency_study(kind, Scull(radians(angle), force), output, as_json, **options)
