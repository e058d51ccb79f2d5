"""Groups of options of `motion`: the motions' own, and the vibration on top."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from math import radians
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from sculler import terminal
from sculler.commands.options.group import group

if TYPE_CHECKING:
    from sculler.runs.motion import Plan, Shaking
    from sculler_model.design import Design
    from sculler_model.motion import Motion

Options = Mapping[str, Any]


class Option(NamedTuple):
    """An option of some motions, named as their functions' parameter.

    Attributes:
        flag: on the command line.
        metavar: its unit; DEG and DEG/S become radians.
        help: what it is.
        least, most: allowed, in its unit.
        above: `least` itself is not allowed.
    """

    flag: str
    metavar: str
    help: str
    least: float = -1e9
    most: float = 1e9
    above: bool = False

    @property
    def angular(self) -> bool:
        """Degrees on the command line, radians inside."""
        return self.metavar.startswith("DEG")


OPTIONS = {
    "lat": Option("--lat", "DEG", "Geodetic latitude of the start [48].", -90, 90),
    "lon": Option("--lon", "DEG", "Longitude of the start [11].", -180, 180),
    "h": Option("--height", "M", "Height of the start over the ellipsoid [500].", -1e4, 1e6),
    "roll": Option("--roll", "DEG", "Roll.", -180, 180),
    "pitch": Option("--pitch", "DEG", "Pitch.", -90, 90),
    "heading": Option("--heading", "DEG", "Heading; of a flight's runway, of a circle.", -360, 360),
    "speed": Option("--speed", "M/S", "Speed over the Earth.", 0, 10_000, True),
    "turn_rate": Option("--turn-rate", "DEG/S", "Rate of the turn.", 0, 1000, True),
    "half_angle": Option("--half-angle", "DEG", "Half angle of the cone.", 0, 90, True),
    "hertz": Option("--frequency", "HZ", "Frequency of the vibration.", 0, 1e5, True),
    "angle": Option("--angle", "DEG", "Amplitude of the angle.", 0, 90),
    "force": Option("--force", "M/S2", "Amplitude of the acceleration.", 0, 1e4),
    "elevation": Option("--elevation", "DEG", "Spin axis over the horizontal.", -90, 90),
    "cone_rate": Option("--cone-rate", "DEG/S", "Rate of the spin axis round its cone.", -1e5, 1e5),
    "spin_rate": Option("--spin-rate", "DEG/S", "Rate of the spin.", -1e5, 1e5),
    "roll_rate": Option("--roll-rate", "DEG/S", "Rate about the body's x.", -1e5, 1e5),
    "pitch_rate": Option("--pitch-rate", "DEG/S", "Rate about the body's y.", -1e5, 1e5),
    "yaw_rate": Option("--yaw-rate", "DEG/S", "Rate about the body's z.", -1e5, 1e5),
    "forward": Option("--forward", "M/S2", "Acceleration along the body's x.", -1e4, 1e4),
    "right": Option("--right", "M/S2", "Acceleration along the body's y.", -1e4, 1e4),
    "down": Option("--down", "M/S2", "Acceleration along the body's z.", -1e4, 1e4),
    "rocking": Option("--rocking", "DEG", "Amplitude of the rocking.", 0, 90),
    "arm": Option("--arm", "M", "Centre to sensors along each axis.", -1e3, 1e3),
    "before": Option("--before", "S", "Time from the start to the pole.", 0, 1e5),
}

motion_options = group(
    *(
        click.option(
            option.flag,
            name,
            type=terminal.number_type(option.least, option.most, option.above),
            metavar=option.metavar,
            help=option.help,
        )
        for name, option in OPTIONS.items()
    )
)
"""Of the motions; see `motion`."""

vibration_options = group(
    click.option(
        "--vibration",
        type=terminal.number_type(0, 1e3),
        default=0.0,
        metavar="G",
        help="Random vibration on top: acceleration along each axis, g rms.",
    ),
    click.option(
        "--vibration-rate",
        type=terminal.number_type(0, 1e5),
        default=0.0,
        metavar="DEG/S",
        help="Random angular vibration on top: rate about each axis, °/s rms.",
    ),
    click.option(
        "--vibration-band",
        default="20-200",
        show_default=True,
        metavar="LOW-HIGH",
        help="Band of both, Hz.",
    ),
    click.option(
        "--vibration-lines",
        type=click.IntRange(1, 1000),
        default=20,
        show_default=True,
        help="Sinusoids that make it up, each axis.",
    ),
    click.option(
        "--seed",
        type=click.IntRange(0),
        default=1,
        show_default=True,
        help="Of the random numbers of the vibration and of [sensor.errors].",
    ),
)
"""Random vibration on top; see `shaking`."""

NAMES = {
    "rest": "standing still",
    "coning": "classical coning in one place",
    "sculling": "classical sculling in one place",
    "spin-cone": "spinning about an axis that goes round a cone",
    "spin-rock-size": "spinning and rocking, the sensors off the centre",
    "spin-accel": "constant rate and acceleration in body axes",
    "turn": "a coordinated turn: constant rate and specific force",
    "great-circle": "constant speed and height; passes over poles, too",
    "pole": "across the north pole along a meridian",
    "flight": "an hour: take-off, climbs, turns, two full circles, descent, landing",
    "demo": "what `sculler demo` uses: a turn with coning and sculling",
}
"""The catalogue's (`sculler_model.motion.MOTIONS`), here so that `--help` need not import it."""


def plan(design: Design, name: str, options: Options) -> Plan:
    """What the options ask for.

    Args:
        design: gives the sensor.
        name: of the motion, one of `NAMES`.
        options: the verb's, of both groups above, and `duration` and `truth_every`.

    Raises:
        ContradictionError: an option does not belong to this motion.
        InputError: a value is not allowed.
    """
    from sculler.runs.motion import Plan
    from sculler_model.motion import MOTIONS

    made, shaken = motion(name, options), shaking(options)
    seconds = options["duration"]
    return Plan(
        design,
        name,
        made,
        MOTIONS[name].seconds if seconds is None else seconds,
        options["truth_every"],
        shaken,
        {key: options[key] for key in OPTIONS if options[key] is not None},
        seed=options["seed"],
    )


def motion(name: str, options: Options) -> Motion:
    """The catalogue's motion with the options given.

    Raises:
        ContradictionError: an option does not belong to this motion.
    """
    from sculler_model.errors import ContradictionError
    from sculler_model.motion import MOTIONS, PLACE

    make = MOTIONS[name].make
    allowed = inspect.signature(make).parameters
    place = dict(zip(("lat", "lon", "h"), PLACE, strict=True))
    values = {
        key: place[key]
        for key, parameter in allowed.items()
        if key in OPTIONS and parameter.default is inspect.Parameter.empty
    }
    for key, option in OPTIONS.items():
        value = options[key]
        if value is None:
            continue
        if key not in allowed:
            mine = ", ".join(OPTIONS[each].flag for each in OPTIONS if each in allowed) or "none"
            raise ContradictionError(
                f"{option.flag} does not belong to the motion {name}, whose options are {mine}"
            )
        values[key] = radians(value) if option.angular else value
    return make(**values)


def shaking(options: Options) -> Shaking | None:
    """The vibration of the options, if there is any.

    Raises:
        InputError: the band is not one.
    """
    from sculler.runs.motion import Shaking
    from sculler_model.errors import InputError

    band = options["vibration_band"]
    low, _, high = band.partition("-")
    try:
        edges = float(low), float(high)
    except ValueError:
        raise InputError(
            f'--vibration-band: "{band}" is not allowed, give LOW-HIGH in Hz'
        ) from None
    g, rate = options["vibration"], options["vibration_rate"]
    found = Shaking(g, rate, *edges, options["vibration_lines"], options["seed"])
    return found if g or rate else None
