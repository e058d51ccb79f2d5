"""`sculler analyze coning`: residual drift against the coning frequency."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from sculler import terminal
from sculler.commands.analyze.frequency import run
from sculler.commands.options import analysis as options


@click.command(
    short_help="Residual drift against coning frequency.",
    epilog=terminal.examples(
        "sculler analyze coning stim300 --family frequency-taylor --samples 2 --samples 3 \\\n"
        "    -o build/coning.png",
        "sculler analyze coning --family frequency-taylor --family time-taylor --samples 4 --json",
    ),
)
@options.subject_options
@options.half_angle_option
@options.frequency_options("°/h", options.REQUIREMENTS)
@options.degree_option
@options.picture_option
@terminal.json_option
def command(half_angle: float, output: Path | None, as_json: bool, **asked: Any) -> None:
    """Show the drift that coning leaves, against its frequency.

    The drift is computed minus true, in °/h about the cone's axis: by closed form, by the core's
    integers (second order, exactly comparable), and by the attitude that the host arrives at,
    where the triple products that these algorithms leave out show too.  Beside them stands what the
    samples allow: the attitude iterated to convergence on a polynomial through them.  A design runs
    on its own sensor, a family on one so fine that it does not show.
    """
    from sculler.runs.analysis import coning

    run(coning(half_angle), asked, output, as_json)
