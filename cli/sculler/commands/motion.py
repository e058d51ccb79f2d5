"""`sculler motion`: an integer IMU log of a known motion, and its truth."""

from __future__ import annotations

import inspect
from math import floor, radians
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from sculler import terminal

if TYPE_CHECKING:
    from sculler_model.design import Design
    from sculler_model.motion import Motion, Vibration

PLACE = {"lat": 48.0, "lon": 11.0, "h": 500.0}
"""Where motions begin if nothing else is said, degrees and m."""


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
    "rocking": Option("--rocking", "DEG", "Amplitude of the rocking.", 0, 90),
    "arm": Option("--arm", "M", "Centre to sensors along each axis.", -1e3, 1e3),
    "before": Option("--before", "S", "Time from the start to the pole.", 0, 1e5),
}


def _motion_options(command: Any) -> Any:
    for name, option in reversed(OPTIONS.items()):
        command = click.option(
            option.flag,
            name,
            type=terminal.number_type(option.least, option.most, option.above),
            metavar=option.metavar,
            help=option.help,
        )(command)
    return command


NAMES = {
    "rest": "standing still",
    "coning": "classical coning in one place",
    "sculling": "classical sculling in one place",
    "spin-cone": "spinning about an axis that goes round a cone",
    "spin-rock-size": "spinning and rocking, the sensors off the centre",
    "turn": "a coordinated turn: constant rate and specific force",
    "great-circle": "constant speed and height; passes over poles, too",
    "pole": "across the north pole along a meridian",
    "flight": "an hour: take-off, climbs, turns, two full circles, descent, landing",
    "demo": "what `sculler demo` uses: a turn with coning and sculling",
}
"""The catalogue's (`sculler_model.motion.MOTIONS`), here so that `--help` need not import it."""

_HELP = (
    """Write the IMU log that DESIGN's sensor gives of the motion NAME, and the motion's truth.

\b
"""
    + "\n".join(f"{name:16}{text}" for name, text in NAMES.items())
    + """

All of it happens on the turning WGS-84 Earth and is known in closed form; the samples are exact
integrals, counted as a pulse-counting sensor does, remainder carried.  A rate sensor gets rates
averaged over the sample interval about their instant.

Time 0 is the beginning of the first increment, or the instant of the first rate.  The truth has
rows at the ends of the major intervals from the first one at or after time 0 on (or, from there,
every --truth-every seconds), with the columns of `sculler navigate`'s output: time_s; the
quaternion q_w, q_x, q_y, q_z from body (forward, right, down) to north-east-down; roll_deg,
pitch_deg, heading_deg; v_north, v_east, v_down (m/s); lat_deg, lon_deg (geodetic), height_m (over
the ellipsoid).
"""
)


@click.command(
    short_help="Write an IMU log of a known motion, and its truth.",
    help=_HELP,
    epilog=terminal.examples(
        "sculler motion flight --design stim300 -o imu.csv --truth truth.csv",
        "sculler motion rest --design stim300 -o imu.csv --truth truth.csv --duration 10800 \\\n"
        "    --lat 45 --heading 30",
        "sculler motion coning --design examples/stim300_4x5.toml -o imu.csv --truth truth.csv \\\n"
        "    --half-angle 1 --frequency 20 --vibration 0.5 --vibration-band 20-200",
    ),
)
@click.argument("name", metavar="NAME", type=click.Choice(tuple(NAMES)))
@click.option("--design", "design_name", required=True, metavar="DESIGN", help="Gives the sensor.")
@terminal.output_option
@click.option(
    "--truth",
    type=terminal.OutputFile(),
    required=True,
    metavar="FILE",
    help="Where to write the truth.",
)
@click.option(
    "--duration",
    type=terminal.number_type(0, 1e7, above=True),
    metavar="SECONDS",
    help="How long; 60 if left out, a flight and a great circle 3600, over the pole 600.",
)
@click.option(
    "--truth-every",
    type=terminal.number_type(0, 1e7, above=True),
    metavar="SECONDS",
    help="Time between the truth's rows; a major interval if left out.",
)
@_motion_options
@click.option(
    "--vibration",
    type=terminal.number_type(0, 1e3),
    default=0.0,
    metavar="G",
    help="Random vibration on top: acceleration along each axis, g rms.",
)
@click.option(
    "--vibration-rate",
    type=terminal.number_type(0, 1e5),
    default=0.0,
    metavar="DEG/S",
    help="Random angular vibration on top: rate about each axis, °/s rms.",
)
@click.option(
    "--vibration-band",
    default="20-200",
    show_default=True,
    metavar="LOW-HIGH",
    help="Band of both, Hz.",
)
@click.option(
    "--vibration-lines",
    type=click.IntRange(1, 1000),
    default=20,
    show_default=True,
    help="Sinusoids that make it up, each axis.",
)
@click.option(
    "--seed",
    type=click.IntRange(0),
    default=1,
    show_default=True,
    help="Of the vibration's random numbers.",
)
@terminal.json_option
def command(
    name: str,
    design_name: str,
    output: Path,
    truth: Path,
    duration: float | None,
    truth_every: float | None,
    vibration: float,
    vibration_rate: float,
    vibration_band: str,
    vibration_lines: int,
    seed: int,
    as_json: bool,
    **given: float | None,
) -> None:
    """Write the IMU log of a known motion, and its truth."""
    from sculler.commands.origin import write_origin
    from sculler_model.errors import InputError
    from sculler_model.motion import MOTIONS

    design = terminal.load_design(design_name)
    motion = _made(name, given)
    shaking = _vibration(vibration, vibration_rate, vibration_band, vibration_lines, seed)
    if shaking is not None:
        motion = shaking.on(motion)
    seconds = MOTIONS[name].seconds if duration is None else duration
    samples = round(seconds * design.sensor.sample_rate_hz)
    if samples < 1:
        raise InputError(f"--duration: {seconds:g} s are shorter than a sample, give more")
    every = design.major_interval if truth_every is None else truth_every

    full_scale, truth_rows = _write(design, motion, samples, output, truth, every)
    data = {
        "motion": name,
        "design": design.name,
        "options": {key: value for key, value in given.items() if value is not None},
        "seconds": samples * design.sample_interval,
        "samples": samples,
        "full_scale": full_scale,
        "truth_every_s": every,
        "truth_rows": truth_rows,
        "output": str(output),
        "truth": str(truth),
    }
    if shaking is not None:
        data["vibration"] = {
            "g_rms": vibration,
            "rate_deg_per_s_rms": vibration_rate,
            "band_hz": [shaking.low, shaking.high],
            "lines": shaking.lines,
            "seed": seed,
        }
    write_origin(output, {"design": design_name}, data)
    terminal.report(data, as_json, terminal.facts(_facts(data)))


def _made(name: str, given: dict[str, float | None]) -> Motion:
    """The catalogue's motion with the options given.

    Raises:
        UsageError: an option does not belong to this motion.
    """
    from sculler_model.motion import MOTIONS

    make = MOTIONS[name].make
    allowed = inspect.signature(make).parameters
    values: dict[str, float] = {}
    for key, value in given.items():
        if key in allowed and value is None and allowed[key].default is inspect.Parameter.empty:
            value = PLACE[key]
        if value is None:
            continue
        if key not in allowed:
            mine = ", ".join(OPTIONS[each].flag for each in OPTIONS if each in allowed) or "none"
            raise click.UsageError(
                f"{OPTIONS[key].flag} does not belong to the motion {name}, whose options are"
                f" {mine}"
            )
        values[key] = radians(value) if OPTIONS[key].angular else value
    return make(**values)


def _vibration(g: float, rate: float, band: str, lines: int, seed: int) -> Vibration | None:
    """The vibration of the options, if there is any."""
    from sculler_model.errors import InputError
    from sculler_model.frames import STANDARD_GRAVITY
    from sculler_model.motion import Vibration

    low, _, high = band.partition("-")
    try:
        edges = float(low), float(high)
    except ValueError:
        raise InputError(
            f'--vibration-band: "{band}" is not allowed, give LOW-HIGH in Hz'
        ) from None
    shaking = Vibration(STANDARD_GRAVITY * g, radians(rate), *edges, lines, seed)
    return shaking if g or rate else None


def _write(
    design: Design, motion: Motion, samples: int, output: Path, truth: Path, every: float
) -> tuple[float, int]:
    """Both files, each whole or not at all; largest count as a share of full scale, and rows."""
    import numpy as np

    from sculler.formats.history import HistoryWriter
    from sculler.formats.log import LogWriter
    from sculler_model.motion import CHUNK
    from sculler_model.outputs import replacing
    from sculler_model.samples import Quantiser, end_after_stamp, interval_end, sample_stamp

    quantise = Quantiser(design)
    begin = interval_end(design, -1)
    if begin < 0:  # a rate's first interval reaches before time 0
        begin = interval_end(design, 0)
    end = sample_stamp(design, samples - 1) + end_after_stamp(design)
    rows = max(floor((end - begin) / every + 1e-9) + 1, 1)
    with (
        terminal.progress(f"writing {motion.name}", samples + rows) as advance,
        replacing(output) as temporary,
    ):
        with LogWriter(temporary) as log:
            for chunk in motion.chunks(design.sensor.kind, samples, design.sample_interval):
                log.write(quantise(chunk))
                advance(len(chunk))
        with replacing(truth) as temporary_truth, HistoryWriter(temporary_truth) as states:
            for first in range(0, rows, CHUNK):
                number = np.arange(first, min(first + CHUNK, rows), dtype=np.float64)
                states.write(motion.state(begin + number * every))
                advance(len(number))
    return max(quantise.report().full_scale), rows


def _facts(data: dict[str, Any]) -> dict[str, str]:
    shown = {
        "motion": data["motion"],
        "log": f"{data['samples']:,} samples, {data['seconds']:,.6g} s, for {data['design']}",
        "largest count": f"{100 * data['full_scale']:.3g} % of full scale",
        "truth": f"{data['truth_rows']:,} rows, every {data['truth_every_s']:g} s",
    }
    if "vibration" in data:
        found = data["vibration"]
        low, high = found["band_hz"]
        shown["vibration"] = (
            f"{found['g_rms']:g} g and {found['rate_deg_per_s_rms']:g} °/s rms an axis,"
            f" {low:g} to {high:g} Hz, {found['lines']} lines, seed {found['seed']}"
        )
    return shown | {"wrote": f"{data['output']}, {data['truth']}"}
