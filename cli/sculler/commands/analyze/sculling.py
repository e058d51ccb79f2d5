"""`sculler analyze sculling`: residual acceleration against the sculling frequency."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from sculler import terminal
from sculler.commands.analyze.frequency import run
from sculler.commands.options import analysis as options


@click.command(
    short_help="Residual acceleration against sculling frequency.",
    epilog=terminal.examples(
        "sculler analyze sculling stim300 --family frequency-taylor --samples 2 --samples 3 \\\n"
        "    -o build/sculling.png",
    ),
)
@options.subject_options
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
@options.frequency_options("µg", ())
@options.degree_option
@options.picture_option
@terminal.json_option
def command(angle: float, force: float, output: Path | None, as_json: bool, **asked: Any) -> None:
    """Show the acceleration that sculling leaves, against its frequency.

    The body rocks about x and feels a force along y in phase with it, which rectifies along z.  The
    error is computed minus true, in µg: by closed form, by the core's integers (second order), and
    by the velocity that the host arrives at.  Beside them stands what the samples allow: attitude
    and velocity iterated to convergence on a polynomial through them.
    """
    from sculler.runs.analysis import sculling

    run(sculling(angle, force), asked, output, as_json)
