"""`sculler analyze coning`: residual drift against the coning frequency."""

from __future__ import annotations

from math import degrees, radians
from pathlib import Path
from typing import Any

import click

from sculler import terminal
from sculler.commands.analyze import subjects
from sculler.commands.options.analysis import frequency_options

REQUIREMENTS = (1.7e-4, 1.7e-5)
"""°/h: for 1 nmph and 0.1 nmph navigation (Savage-20, NEW ATTITUDE ALGORITHM REQUIREMENTS)."""


@click.command(
    short_help="Residual drift against coning frequency.",
    epilog=terminal.examples(
        "sculler analyze coning stim300 --family frequency-taylor --samples 2 --samples 3 \\\n"
        "    -o build/coning.png",
        "sculler analyze coning --family frequency-taylor --family time-taylor --samples 4 --json",
    ),
)
@subjects.subject_options
@subjects.half_angle_option
@frequency_options("°/h", REQUIREMENTS)
@subjects.picture_option
@terminal.json_option
def command(half_angle: float, output: Path | None, as_json: bool, **options: Any) -> None:
    """Show the drift that coning leaves, against its frequency.

    The drift is computed minus true, in °/h about the cone's axis: by closed form, by the core's
    integers (second order, exactly comparable), and by the attitude that the host arrives at,
    where the triple products that these algorithms leave out show too.  A design runs on its own
    sensor, a family on one so fine that it does not show.
    """
    from sculler.commands.analyze.frequency import Kind
    from sculler.commands.options.analysis import run_frequency_study
    from sculler_model.analysis.frequency import Cone

    kind = Kind(
        "coning",
        f"Drift left of {half_angle:g}° coning",
        "°/h",
        degrees(1) * 3600,
        "host's attitude",
    )
    run_frequency_study(kind, Cone(radians(half_angle)), output, as_json, **options)
