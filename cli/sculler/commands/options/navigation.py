"""Options of `navigate`, in groups, and what they ask for as a `Plan`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import inf, radians
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sculler import terminal
from sculler.commands.options.group import Command, group

if TYPE_CHECKING:
    from sculler.runs.navigation import Given, Plan
    from sculler_model.design import Design
    from sculler_model.navigation import HeightReference, SensorNoise

Options = Mapping[str, Any]
"""The verb's options by their names in Python."""

_ANGLES = ("roll", "pitch", "heading")
_VELOCITIES = ("vn", "ve", "vd")
_PLACE = ("lat", "lon", "height")
_NOISE = ("gyro_noise", "accel_noise", "gyro_bias_sigma", "accel_bias_sigma")


class Span(click.ParamType):  # type: ignore[type-arg]
    """Two times, `A:B`."""

    name = "span"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[float, float]:
        """Seconds."""
        if isinstance(value, tuple):
            return value
        first, colon, last = str(value).partition(":")
        try:
            begin, end = float(first), float(last)
        except ValueError:
            colon = ""
        if not colon or not begin < end < inf or begin == -inf:
            self.fail(f"{value!r} is not a span, give A:B in seconds with A < B, as 10:70", param)
        return begin, end


def _numbers(*described: tuple[str, str], **settings: Any) -> list[Callable[[Command], Command]]:
    """Options that take a number each: flag and help."""
    return [
        click.option(flag, type=terminal.number_type(), help=text, **settings)
        for flag, text in described
    ]


initial_state_options = group(
    *_numbers(
        ("--lat", "Initial geodetic latitude, degrees north."),
        ("--lon", "Initial longitude, degrees east."),
        ("--height", "Initial height over the ellipsoid, m."),
        ("--roll", "Initial roll, degrees; 0 if left out."),
        ("--pitch", "Initial pitch, degrees, nose up; 0 if left out."),
        ("--heading", "Initial heading, degrees from north to east; 0 if left out."),
        ("--vn", "Initial velocity north, m/s; 0 if left out."),
        ("--ve", "Initial velocity east, m/s; 0 if left out."),
        ("--vd", "Initial velocity down, m/s; 0 if left out."),
    )
)
"""Where and how the run begins."""

span_options = group(
    click.option(
        "--start",
        type=terminal.number_type(),
        metavar="SECONDS",
        help="Begin at this time on the log's clock, the end of a major interval, and pass over"
        " what comes before.",
    ),
    click.option(
        "--stop",
        type=terminal.number_type(),
        metavar="SECONDS",
        help="End with the last major interval that ends at this time or before.",
    ),
    terminal.breaks_option(
        "Where a result does not follow the one before: refuse the vectors, or begin anew after the"
        " break (from the truth, by aligning again, or by going on as before)."
    ),
)
"""Which of the vectors are navigated with."""

alignment_options = group(
    click.option(
        "--align",
        type=terminal.number_type(0, above=True),
        metavar="SECONDS",
        help="Find the attitude from this long at rest at the beginning: levelled and"
        " gyro-compassed.",
    ),
    click.option(
        "--fine",
        is_flag=True,
        help="Refine --align by a Kalman filter, meant for navigation-grade sensors, and take out"
        " the gyro bias that it finds.",
    ),
)
"""How the attitude is found."""

attitude_options = group(
    click.option(
        "--attitude-only",
        is_flag=True,
        help="Carry the attitude alone: no place, no velocity, no gravity. With --lat it is against"
        " the turning Earth, else against the frame of the start among the stars.",
    ),
    click.option(
        "--calibration",
        type=terminal.InputFile(Path),
        metavar="FILE",
        help="Take these errors of the sensor out: TOML with the tables of [sensor.errors], of"
        " numbers (bias, scale factor, misalignment, g-sensitivity); what needs the samples,"
        " `convert --calibration` takes out of the log.",
    ),
    click.option(
        "--rest",
        type=Span(),
        metavar="A:B",
        help="Take out the gyro bias that is seen from A to B seconds on the log's clock, where the"
        " unit rests; less the Earth's rate where the latitude is known.",
    ),
)
"""Attitude without a place, and errors of the sensor that are taken out."""

carrier_options = group(
    click.option(
        "--axes",
        default="x,y,z",
        metavar="MAP",
        help='Sensor axes that point forward, right, down: "y,x,-z" for a unit right, forward, up.',
    ),
    click.option(
        "--mechanisation",
        type=click.Choice(["wander", "geographic"]),
        default="wander",
        show_default=True,
        help="Wander azimuth, which works at the poles too, or north-pointing.",
    ),
    click.option(
        "--position-every",
        type=click.IntRange(min=1),
        default=1,
        show_default=True,
        metavar="J",
        help="Major intervals from one position update to the next (wander only).",
    ),
    click.option(
        "--height-damping",
        type=terminal.number_type(0, above=True),
        metavar="SECONDS",
        help="Hold the height by a third-order loop with this time constant: to the initial one, or"
        " to --height-reference (100 s then if left out).",
    ),
    click.option(
        "--height-reference",
        type=terminal.InputFile(Path),
        metavar="FILE",
        help="Hold the height to a measured one, as a barometer's: a CSV with time_s (on the log's"
        " clock) and height_m (above the ellipsoid), at its own rate.",
    ),
    click.option(
        "--height-lag",
        type=terminal.number_type(0),
        metavar="SECONDS",
        help="How long before its time_s a height of --height-reference was true; 0 if left out.",
    ),
    click.option(
        "--height-noise",
        type=terminal.number_type(0),
        metavar="METRES",
        help="One sigma of a height of --height-reference, for the warning where the height leaves"
        " it; 0 if left out.",
    ),
    click.option(
        "--third-order",
        is_flag=True,
        help="Correct rotation vectors and velocities for the triple products of smooth"
        " manoeuvres, where the rate is smooth over five intervals; the others stay as they are.",
    ),
    click.option(
        "--azimuth",
        type=click.Choice(["wander", "free"]),
        default="wander",
        show_default=True,
        help="The wander azimuth's frame does not turn about the vertical over the Earth, or, free,"
        " not against the stars.",
    ),
    click.option(
        "--attitude",
        type=click.Choice(["quaternion", "cosines"]),
        default="quaternion",
        show_default=True,
        help="What the attitude is carried as (wander only): the same to rounding.",
    ),
    click.option(
        "--level-every",
        type=click.IntRange(min=1),
        default=1,
        show_default=True,
        metavar="K",
        help="Major intervals from one turn of the level frame to the next, in between to first"
        " order (wander only): to see what that costs.",
    ),
    click.option(
        "--rotation",
        type=click.Choice(["exact", "first-order"]),
        default="exact",
        show_default=True,
        help="Rotation compensation of velocity and displacement: exact, or the first-order forms"
        " of Savage-98 (Eq. 39, 86), to see what they cost.",
    ),
    click.option(
        "--engine",
        type=click.Choice(["python", "c"]),
        default="python",
        show_default=True,
        help="What computes: Python, or the host in C of `generate --host c`, compiled here (needs"
        " a C compiler); the same numbers.",
    ),
)
"""What carries the state, and how."""

noise_options = group(
    *(
        click.option(flag, type=terminal.number_type(0), metavar=metavar, help=text)
        for flag, metavar, text in (
            (
                "--gyro-noise",
                "DEG/SQRT(H)",
                "Random walk of each gyro, for --align; the window shows it if left out.",
            ),
            (
                "--accel-noise",
                "M/S/SQRT(H)",
                "Random walk of each accelerometer, for --align; the window shows it if left out.",
            ),
            (
                "--gyro-bias-sigma",
                "DEG/H",
                "How far a gyro's bias may be off (1 sigma); in no stated sigma if left out, for no"
                " window shows it.",
            ),
            (
                "--accel-bias-sigma",
                "M/S^2",
                "How far an accelerometer's bias may be off (1 sigma); likewise.",
            ),
        )
    ),
)
"""What is known of the sensors' noise and biases."""

sensor_options = group(
    click.option(
        "--gravity",
        "gravity",
        default="normal",
        show_default=True,
        metavar="normal|constant[:G]|FILE",
        help="Gravity to navigate by: the normal field of WGS-84, one value everywhere (9.80665, or"
        " G in m/s^2), or a CSV lat_deg,height_m,gravity: a grid, a profile or one measured point.",
    ),
    noise_options,
)
"""Gravity, and what is known of the sensors."""


def plan(design: Design, vectors: str, truth: Path | None, options: Options) -> Plan:
    """What the options ask for.

    Args:
        design: the design.
        vectors: the file of vectors.
        truth: the file to hold the run against, which can tell where it begins.
        options: the verb's, of all groups above.

    Raises:
        ContradictionError: options contradict each other.
        UsageError: one is missing.
        InputError: one of them has a fault.
    """
    from sculler.formats.calibration import read_calibration
    from sculler.formats.gravity import gravity_model
    from sculler.runs.navigation import Carrier, Plan
    from sculler.runs.navigation.plan import DAMPING
    from sculler_model.frames import AxisMap

    axes = AxisMap.parse(options["axes"])
    refuse_contradictions(options)
    noise, gravity = sensor_noise(options), gravity_model(options["gravity"])
    if truth is None and not options["attitude_only"]:
        require_place(options)
    known = None
    if options["calibration"] is not None:
        known = read_calibration(options["calibration"])
    reference, damping = _height_reference(options), options["height_damping"]
    if damping is None and reference is not None:
        damping = DAMPING
    carrier = Carrier(
        options["mechanisation"],
        options["position_every"],
        damping,
        azimuth=options["azimuth"],
        attitude=options["attitude"],
        level_every=options["level_every"],
    )
    return Plan(
        design,
        vectors,
        given_state(options),
        carrier,
        axes,
        start=options["start"],
        stop=options["stop"],
        align=options["align"],
        fine=options["fine"],
        third_order=options["third_order"],
        rotation=options["rotation"],
        split=options["breaks"] == "split",
        gravity=gravity,
        height_reference=reference,
        noise=noise,
        engine=options["engine"],
        attitude_only=options["attitude_only"],
        rest=options["rest"],
        calibration=known,
        channel=options["channel"],
    )


def refuse_contradictions(options: Options) -> None:
    """See that a verb's options, of those of the groups above, go together.

    Raises:
        ContradictionError: two of them do not.
    """
    from sculler.runs.navigation import plan

    plan.refuse_contradictions(options, called=lambda name: f"--{name.replace('_', '-')}")


def _height_reference(options: Options) -> HeightReference | None:
    """The measured height, where there is one."""
    from sculler.formats.height import read_height_reference

    if options["height_reference"] is None:
        return None
    lag, noise = options["height_lag"] or 0.0, options["height_noise"] or 0.0
    return read_height_reference(options["height_reference"], lag, noise)


def sensor_noise(options: Options) -> SensorNoise:
    """What the options say of the sensors, in SI."""
    from sculler_model.navigation import SensorNoise

    gyro, accel, gyro_bias, accel_bias = (options[name] for name in _NOISE)
    return SensorNoise(
        angle_random_walk=None if gyro is None else radians(gyro) / 60,
        velocity_random_walk=None if accel is None else accel / 60,
        gyro_bias=None if gyro_bias is None else radians(gyro_bias) / 3600,
        accel_bias=accel_bias,
    )


def require_place(options: Options) -> None:
    """See that the options tell the initial position, as nothing else does.

    Raises:
        UsageError: one is missing.
    """
    for name in _PLACE:
        if options[name] is None:
            raise click.UsageError(
                f"Missing option '--{name}' (or --truth, which says where the run begins)"
            )


def given_state(options: Options) -> Given:
    """The initial state as the options tell it, as far as they do."""
    from sculler.runs.navigation import Given

    def inside(name: str) -> float | None:
        return None if options[name] is None else radians(options[name])

    roll, pitch, heading = map(inside, _ANGLES)
    north, east, down = (options[name] for name in _VELOCITIES)
    place = (inside("lat"), inside("lon"), options["height"])
    return Given((roll, pitch, heading), (north, east, down), place)
