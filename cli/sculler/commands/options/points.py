"""Options of `motion --from`: a motion through the points of a file."""

from __future__ import annotations

from collections.abc import Mapping
from math import radians
from typing import TYPE_CHECKING, Any

import click

from sculler import terminal
from sculler.commands.options import motion
from sculler.commands.options.group import group

if TYPE_CHECKING:
    from sculler.runs.motion import Plan
    from sculler_model.design import Design

points_options = group(
    click.option(
        "--from",
        "from_file",
        type=terminal.InputFile(),
        metavar="FILE",
        help="In place of NAME: a motion through the places and attitudes of a file.",
    ),
    click.option(
        "--smoothness",
        type=click.IntRange(2, 4),
        metavar="2|3|4",
        help="Continuous derivatives of the curve through the points; 3 if left out.",
    ),
    click.option(
        "--spacing",
        type=terminal.number_type(0, 1e6, above=True),
        metavar="SECONDS",
        help="Take points that are so far apart only; all if left out.",
    ),
    click.option(
        "--plots/--no-plots",
        default=True,
        show_default=True,
        help="With --from, a picture of the curve beside the points.",
    ),
)
"""Where the points are, and how the curve goes through them."""

_PLACE = ("lat", "lon", "h")


def plan(design: Design, name: str | None, options: Mapping[str, Any]) -> Plan:
    """What the options ask for: a motion of the catalogue, or one through points.

    Args:
        design: gives the sensor.
        name: of the motion in the catalogue, or None.
        options: the verb's.

    Raises:
        ContradictionError: both a name and a file are given, or neither, or an option belongs to
            the other kind.
        InputError: a value or the file is not allowed.
    """
    from sculler_model.errors import ContradictionError

    if name is not None:
        given = [flag for key, flag in _OWN.items() if options[key] is not None]
        if given:
            raise ContradictionError(f"{given[0]} and the motion {name}: give one of them")
        return motion.plan(design, name, options)
    if options["from_file"] is None:
        raise ContradictionError(
            f"no motion is given, give one of {', '.join(motion.NAMES)}, or --from FILE"
        )
    for key, option in motion.OPTIONS.items():
        if key not in _PLACE and options[key] is not None:
            raise ContradictionError(
                f"{option.flag} does not belong to a motion through points, leave it out"
            )
    return _through(design, options)


def _through(design: Design, options: Mapping[str, Any]) -> Plan:
    from sculler.runs.motion import Plan, read_points
    from sculler_model.errors import ContradictionError
    from sculler_model.motion import PLACE

    said = {key: options[key] for key in _PLACE if options[key] is not None}
    values = {key: radians(value) if key != "h" else value for key, value in said.items()}
    lat, lon, h = (values.get(key, usual) for key, usual in zip(_PLACE, PLACE, strict=True))
    given = read_points(
        options["from_file"], (lat, lon, h), options["smoothness"] or 3, options["spacing"]
    )
    if said and not given.local:
        flag = motion.OPTIONS[next(iter(said))].flag
        raise ContradictionError(f"{flag}: {given.path} tells places itself, leave it out")
    seconds = given.seconds if options["duration"] is None else options["duration"]
    shaken, every = motion.shaking(options), options["truth_every"]
    return Plan(
        design, "points", given.motion(), seconds, every, shaken, said, given, options["seed"]
    )


_OWN = {"from_file": "--from", "smoothness": "--smoothness", "spacing": "--spacing"}
