"""`sculler navigate`: attitude, velocity and position from the vectors."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import chain
from math import cos, degrees, hypot, pi, radians, sin
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from sculler import terminal

if TYPE_CHECKING:
    from sculler.against_truth import AgainstTruth
    from sculler_model.blocks import VectorBlock
    from sculler_model.design import Design
    from sculler_model.host import MajorIncrements
    from sculler_model.navigation import Alignment, FineAlignment, Mechanisation, NavState

_ANGLES = ("roll", "pitch", "heading")
_VELOCITIES = ("vn", "ve", "vd")


@click.command(
    short_help="Carry attitude, velocity and position with the vectors.",
    epilog=terminal.examples(
        "sculler navigate examples/lasergyro.toml vectors.csv -o nav.csv --axes y,x,-z \\\n"
        "    --lat 34.246048 --lon 108.909664 --height 380 --align 300",
        "sculler navigate stim300 vectors.csv -o nav.csv --heading 90 --ve 30 \\\n"
        "    --lat 48 --lon 11 --height 500",
        "sculler navigate stim300 vectors.csv -o nav.csv --truth truth.csv --report run.html",
    ),
)
@terminal.design_argument
@click.argument("vectors", metavar="VECTORS", type=terminal.InputFile())
@terminal.output_option
@click.option(
    "--lat",
    type=terminal.number_type(),
    help="Initial geodetic latitude, degrees north.",
)
@click.option("--lon", type=terminal.number_type(), help="Initial longitude, degrees east.")
@click.option(
    "--height",
    type=terminal.number_type(),
    help="Initial height over the ellipsoid, m.",
)
@click.option("--roll", type=terminal.number_type(), help="Initial roll, degrees; 0 if left out.")
@click.option(
    "--pitch", type=terminal.number_type(), help="Initial pitch, degrees, nose up; 0 if left out."
)
@click.option(
    "--heading",
    type=terminal.number_type(),
    help="Initial heading, degrees from north to east; 0 if left out.",
)
@click.option(
    "--vn", type=terminal.number_type(), help="Initial velocity north, m/s; 0 if left out."
)
@click.option(
    "--ve", type=terminal.number_type(), help="Initial velocity east, m/s; 0 if left out."
)
@click.option(
    "--vd", type=terminal.number_type(), help="Initial velocity down, m/s; 0 if left out."
)
@click.option(
    "--start",
    "begin",
    type=terminal.number_type(0),
    metavar="SECONDS",
    help="Begin at this time, the end of a major interval, and pass over what comes before.",
)
@click.option(
    "--align",
    "align_seconds",
    type=terminal.number_type(0, above=True),
    metavar="SECONDS",
    help="Find the attitude from this long at rest at the beginning: levelled and gyro-compassed.",
)
@click.option(
    "--fine",
    is_flag=True,
    help="Refine --align by a Kalman filter, meant for navigation-grade sensors, and take out the"
    " gyro bias that it finds.",
)
@click.option(
    "--axes",
    default="x,y,z",
    metavar="MAP",
    help='Sensor axes that point forward, right, down: "y,x,-z" for a unit right, forward, up.',
)
@click.option(
    "--mechanisation",
    type=click.Choice(["wander", "geographic"]),
    default="wander",
    show_default=True,
    help="Wander azimuth, which works at the poles too, or north-pointing.",
)
@click.option(
    "--position-every",
    type=click.IntRange(min=1),
    default=1,
    show_default=True,
    metavar="J",
    help="Major intervals from one position update to the next (wander only).",
)
@click.option(
    "--height-damping",
    type=terminal.number_type(0, above=True),
    metavar="SECONDS",
    help="Hold the height to the initial one by a third-order loop with this time constant"
    " (wander only).",
)
@click.option(
    "--third-order",
    is_flag=True,
    help="Correct the rotation vectors for the triple products of smooth manoeuvres.",
)
@click.option(
    "--truth",
    type=terminal.InputFile(Path),
    metavar="FILE",
    help="Hold the run against this truth (of `motion`, or an npz, MAT or Parquet file with such"
    " columns); what of the initial state is left out comes from its first row.",
)
@click.option(
    "--report",
    "page",
    type=terminal.OutputFile(),
    metavar="FILE.html",
    help="Write the run as one HTML page: figures, pictures, settings, design.",
)
@click.option(
    "--plots/--no-plots", default=True, show_default=True, help="Pictures beside the output."
)
@terminal.json_option
def command(
    design_name: str,
    vectors: str,
    output: Path,
    lat: float | None,
    lon: float | None,
    height: float | None,
    begin: float | None,
    align_seconds: float | None,
    fine: bool,
    axes: str,
    mechanisation: str,
    position_every: int,
    height_damping: float | None,
    third_order: bool,
    truth: Path | None,
    page: Path | None,
    plots: bool,
    as_json: bool,
    **initial: float | None,
) -> None:
    """Navigate with the VECTORS (CSV of `model` or `simulate`) of DESIGN.

    Float, once a major interval: exact attitude, velocity and position over WGS-84.  The body frame
    is forward, right, down.  Columns of the output, a row at the start and after every major
    interval: time_s; the attitude quaternion q_w, q_x, q_y, q_z from body to north-east-down;
    roll_deg, pitch_deg, heading_deg (heading from north to east); v_north, v_east, v_down (m/s);
    lat_deg, lon_deg (geodetic) and height_m (over the ellipsoid): all of true north, in either
    mechanisation; and wander_deg, from north to the x axis of the frame that was carried (0 if
    that points north): heading_deg - wander_deg runs on over a pole.

    With --truth the errors of attitude, velocity and position are told and drawn.  They are formed
    at the instants of whichever of the two is sparser; where the other has no state at such an
    instant it is interpolated: position by a cubic, velocity linearly, attitude evenly.
    """
    from sculler.against_truth import AgainstTruth, table
    from sculler.history import HistoryWriter, Thinned
    from sculler_model.errors import InputError
    from sculler_model.host import ThirdOrder, major_increments
    from sculler_model.navigation import AxisMap, NavHistory, trajectory
    from sculler_sim.files import replacing
    from sculler_sim.vectors_file import read_vectors

    design = terminal.load_design(design_name)
    axis_map = AxisMap.parse(axes)
    if align_seconds is not None:
        for name, value in initial.items():
            if value is not None:
                raise click.UsageError(f"--{name} and --align contradict each other, give one")
        if begin is not None:
            raise click.UsageError("--start and --align contradict each other, give one")
    if fine and align_seconds is None:
        raise click.UsageError("--fine refines --align, give that too")
    if truth is None:
        for name, value in (("lat", lat), ("lon", lon), ("height", height)):
            if value is None:
                raise click.UsageError(
                    f"Missing option '--{name}' (or --truth, which says where the run begins)"
                )
    no_pictures = _claim_pictures(output, truth) if plots else None
    plots = plots and no_pictures is None
    reference = None if truth is None else AgainstTruth(truth, design.major_interval, begin)
    place = _place(lat, lon, height, reference)
    faults = _Faults()

    with (
        terminal.progress("navigating", _rows(vectors)) as advance,
        replacing(output) as temporary,
    ):
        increments: Iterator[MajorIncrements] = (
            major_increments(design, block).in_axes(axis_map)
            for block in faults.count(read_vectors(vectors, design), advance)
        )
        if third_order:
            increments = map(ThirdOrder(), increments)
        alignment = finely = None
        if align_seconds is not None:
            window, increments = _split(increments, round(align_seconds / design.major_interval))
            alignment, start = _aligned(design, window, place, align_seconds)
            if fine:
                finely, start = _finely(design, window, place)
                T = design.major_interval
                increments = (finely.corrected(block, T) for block in increments)
        else:
            begin = begin or 0.0 if reference is None else reference.first.time
            skipped = _intervals(
                begin, design.major_interval, "--start" if truth is None else truth
            )
            increments = _after(increments, skipped)
            start = _given(begin, place, initial, reference)
        shown = Thinned()
        with HistoryWriter(temporary, wander=True) as writer:
            navigator = _mechanisation(
                mechanisation, start, design.major_interval, position_every, height_damping
            )
            track = trajectory(navigator, increments)
            for part in chain([NavHistory.from_states([start])], track):
                writer.write(part)
                shown.add(part)
                if reference is not None:
                    reference.add(part)
        if navigator.state == start:
            raise InputError(f"{vectors}: no results to navigate with, give a longer log")
        if reference is not None:
            reference.finish()
    data = _summary(design, vectors, output, start, navigator.state, alignment)
    data["fault_results"] = faults.results
    if no_pictures is not None:
        data["no_pictures"] = no_pictures
    fine_position = design.high_resolution and mechanisation == "wander"
    data["position_algorithm"] = "high-resolution" if fine_position else "trapezoidal"
    if finely is not None:
        data["alignment"] |= _fine_facts(finely)
    if reference is not None:
        data["errors"] = reference.summary()
    if plots:
        from sculler.plots import navigation_pictures

        pictures = navigation_pictures(shown.history(), output)
        if reference is not None:
            from sculler.plots_truth import truth_pictures

            pictures += truth_pictures(*reference.shown(), reference.growth, output)
        data["plots"] = [str(path) for path in pictures]
    if page is not None:
        data["report"] = str(page)
        _write_report(page, design, data, _settings(click.get_current_context()))
    errors = () if reference is None else ("", table(data["errors"]))
    terminal.report(data, as_json, terminal.facts(_facts(data)), *errors)


def _claim_pictures(output: Path, truth: Path | None) -> str | None:
    """Set the pictures' files aside; or why there will be none, in a line."""
    from sculler.plots import left_out, navigation_picture_paths
    from sculler.plots_truth import truth_picture_paths
    from sculler_model import inputs

    reason = left_out()
    if reason is None:
        beside = truth_picture_paths(output) if truth is not None else []
        for path in [*navigation_picture_paths(output), *beside]:
            inputs.claim(path)
    return reason


class _Faults:
    """Counts the results that carry the status bit of a faulty sample."""

    def __init__(self) -> None:
        self.results = 0

    def count(
        self, blocks: Iterable[VectorBlock], advance: terminal.Advance
    ) -> Iterator[VectorBlock]:
        """Pass the blocks on, and tell how many results went by."""
        from sculler_model.vectors import STATUS_FAULT

        for block in blocks:
            self.results += int(((block.status & STATUS_FAULT) != 0).sum())
            yield block
            advance(len(block))


def _rows(vectors: str) -> int | None:
    """Results in a vectors file, for the progress; None where it cannot be told beforehand."""
    path = Path(vectors)
    if not path.is_file():  # a pipe can be read but once
        return None
    try:
        with path.open("rb") as file:
            return sum(block.count(b"\n") for block in iter(lambda: file.read(1 << 16), b"")) - 1
    except OSError:  # told where it is read
        return None


def _write_report(
    page: Path, design: Design, data: dict[str, Any], settings: dict[str, Any]
) -> None:
    """The run as one page."""
    from sculler.report import write_report

    pictures = [Path(path) for path in data.get("plots", [])]
    errors, warnings = data.get("errors"), _warnings(data)
    write_report(page, design, _facts(data), errors, pictures, settings, warnings)


def _settings(context: click.Context) -> dict[str, Any]:
    """What the command line said, in its own names, and the defaults that came to be used."""
    settings = {}
    for parameter in context.command.params:
        assert parameter.name is not None
        value = context.params[parameter.name]
        if value not in (None, False):
            option = isinstance(parameter, click.Option)
            settings[parameter.opts[-1] if option else parameter.human_readable_name] = value
    return settings


def _warnings(data: dict[str, Any]) -> list[str]:
    """What to look at before trusting the run."""
    warnings = list(data.get("alignment", {}).get("warnings", []))
    if data["fault_results"]:
        warnings.append(
            f"{terminal.plural(data['fault_results'], 'result')} with faulty samples (status bit 1)"
        )
    if "no_pictures" in data:
        warnings.append(data["no_pictures"])
    return warnings


class _Place(NamedTuple):
    """Initial position: rad, rad, m."""

    lat: float
    lon: float
    height: float


def _place(
    lat: float | None, lon: float | None, height: float | None, reference: AgainstTruth | None
) -> _Place:
    """Of the options (degrees, m), and of the truth what they leave out."""
    given = (
        None if lat is None else radians(lat),
        None if lon is None else radians(lon),
        height,
    )
    first = (0.0, 0.0, 0.0)
    if reference is not None:
        first = (reference.first.lat, reference.first.lon, reference.first.h)
    return _Place(
        *(there if here is None else here for here, there in zip(given, first, strict=True))
    )


def _mechanisation(
    name: str, start: NavState, interval: float, position_every: int, damping: float | None
) -> Mechanisation:
    """What carries the state, as the options choose it."""
    from sculler_model.navigation import GeographicNavigator, HeightDamping, Navigator

    if name == "geographic":
        if position_every > 1 or damping is not None:
            raise click.UsageError(
                "--position-every and --height-damping are for the wander azimuth, leave them out"
                " or give --mechanisation wander"
            )
        return GeographicNavigator(start, interval)
    loop = None if damping is None else HeightDamping(start.h, damping)
    return Navigator(start, interval, position_every=position_every, height_damping=loop)


def _intervals(begin: float, interval: float, where: str | Path) -> int:
    """Major intervals before a time at which the run begins."""
    from sculler_model.errors import InputError
    from sculler_model.navigation_errors import SAME_INSTANT

    count = round(begin / interval)
    if count < 0 or abs(begin - count * interval) > SAME_INSTANT:
        raise InputError(
            f"{where}: the run cannot begin at {begin:.9g} s, which is not the end of a major"
            f" interval of {interval:g} s; give another time to --start"
        )
    return count


def _given(
    begin: float, place: _Place, initial: dict[str, float | None], reference: AgainstTruth | None
) -> NavState:
    """The initial state of the options, and of the truth what they leave out; else level, still."""
    from sculler_model.navigation import NavState
    from sculler_model.navigation.rotation import from_euler

    origin = NavState(begin, (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), *place)
    if reference is not None:
        origin = reference.first
    q = origin.q
    if any(initial[name] is not None for name in _ANGLES):
        roll, pitch, heading = (
            here if (value := initial[name]) is None else radians(value)
            for name, here in zip(_ANGLES, origin.euler, strict=True)
        )
        q = from_euler(roll, pitch, heading)
    vn, ve, vd = (
        here if (value := initial[name]) is None else value
        for name, here in zip(_VELOCITIES, origin.v, strict=True)
    )
    return NavState(origin.time, q, (vn, ve, vd), *place)


def _after(increments: Iterator[MajorIncrements], rows: int) -> Iterator[MajorIncrements]:
    """All but the first `rows` intervals."""
    for block in increments:
        if rows < len(block):
            yield block[rows:]
        rows = max(0, rows - len(block))


def _split(
    increments: Iterator[MajorIncrements], rows: int
) -> tuple[list[MajorIncrements], Iterator[MajorIncrements]]:
    """The first `rows` intervals, and the rest."""
    first: list[MajorIncrements] = []
    for block in increments:
        first.append(block[:rows])
        rows -= len(first[-1])
        if not rows:
            rest = block[len(first[-1]) :]
            return first, chain([rest], increments)
    return first, iter(())


def _aligned(
    design: Design,
    window: list[MajorIncrements],
    place: _Place,
    wanted: float,
) -> tuple[Alignment, NavState]:
    """Alignment over the window, and the state at its end."""
    from sculler_model.errors import InputError
    from sculler_model.host import MajorIncrements
    from sculler_model.navigation import align

    T = design.major_interval
    seconds = sum(len(part) for part in window) * T
    if seconds < wanted - 0.5 * T - 1e-9:
        raise InputError(
            f"--align: {wanted:g} s are more than the {seconds:g} s of vectors, give less"
        )
    alignment = align(MajorIncrements.concatenate(window), T, place.lat, place.height)
    return alignment, alignment.state(*place)


def _finely(
    design: Design, window: list[MajorIncrements], place: _Place
) -> tuple[FineAlignment, NavState]:
    """Fine alignment over the window, and the state at its end."""
    from sculler_model.host import MajorIncrements
    from sculler_model.navigation import align_finely

    rest = MajorIncrements.concatenate(window)
    found = align_finely(rest, design.major_interval, place.lat, place.height)
    return found, found.state(*place)


def _fine_facts(found: FineAlignment) -> dict[str, Any]:
    """What the fine stage adds to the alignment's data."""
    north, east, heading = map(degrees, found.sigma)
    return {
        "heading_sigma_deg": heading,
        "level_sigma_deg": hypot(north, east),
        "gyro_bias_deg_per_h": [degrees(rate) * 3600 for rate in found.gyro_bias],
        "surprise": found.surprise,
        "warnings": list(found.warnings),
    }


def _summary(
    design: Design,
    vectors: str,
    output: Path,
    start: NavState,
    end: NavState,
    alignment: Alignment | None,
) -> dict[str, Any]:
    """Where it went, as plain data."""
    from sculler_model.navigation.earth import radii
    from sculler_model.navigation.rotation import to_euler

    meridian, prime_vertical = radii(sin(start.lat))
    north = (end.lat - start.lat) * (meridian + start.h)
    turned = (end.lon - start.lon + pi) % (2 * pi) - pi
    east = turned * (prime_vertical + start.h) * cos(start.lat)
    seconds = end.time - start.time
    angles = [degrees(angle) for angle in to_euler(start.q)]
    end_angles = [degrees(angle) for angle in to_euler(end.q)]
    heading_change = (end_angles[2] - angles[2] + 180) % 360 - 180
    per_hour = 3600 / seconds if seconds else 0.0
    data: dict[str, Any] = {
        "design": design.name,
        "vectors": vectors,
        "output": str(output),
        "start_s": start.time,
        "seconds": seconds,
        "start_attitude_deg": dict(zip(_ANGLES, angles, strict=True)),
        "end_attitude_deg": dict(zip(_ANGLES, end_angles, strict=True)),
        "end_velocity": dict(zip(("north", "east", "down"), end.v, strict=True)),
        "end_position": {
            "lat_deg": degrees(end.lat),
            "lon_deg": degrees(end.lon),
            "height_m": end.h,
        },
        "moved_m": {"north": north, "east": east, "up": end.h - start.h},
        "moved_horizontally_m": hypot(north, east),
        "moved_horizontally_km_per_h": hypot(north, east) * per_hour / 1000,
        "heading_change_deg": heading_change,
        "heading_change_deg_per_h": heading_change * per_hour,
    }
    if alignment is not None:
        data["alignment"] = {
            "seconds": alignment.seconds,
            "rate_deg_per_h": degrees(alignment.rate) * 3600,
            "specific_force": alignment.specific_force,
            "gravity": alignment.gravity,
            "implied_latitude_deg": degrees(alignment.latitude),
            "heading_sigma_deg": degrees(alignment.heading_sigma),
            "warnings": list(alignment.warnings),
        }
    return data


_POSITION = {
    "high-resolution": "of high resolution, by the vectors s_alpha, s_nu and scrolling",
    "trapezoidal": "by the trapezoid",
}


def _facts(data: dict[str, Any]) -> dict[str, str]:
    from sculler import against_truth

    rows = {}
    if "alignment" in data:
        found = data["alignment"]
        rows["alignment"] = (
            f"{found['seconds']:g} s at rest: rate {found['rate_deg_per_h']:.3f} °/h, implied"
            f" latitude {found['implied_latitude_deg']:.3f}°, heading scatter"
            f" {found['heading_sigma_deg']:.3f}°"
        )
        if "level_sigma_deg" in found:
            bias = ", ".join(f"{rate:+.4f}" for rate in found["gyro_bias_deg_per_h"])
            rows["fine alignment"] = (
                f"level to {found['level_sigma_deg']:.2g}°, heading to"
                f" {found['heading_sigma_deg']:.2g}° (1 σ), gyro biases {bias} °/h in the body"
            )
    for number, warning in enumerate(_warnings(data), start=1):
        rows[f"warning {number}"] = warning

    def attitude(angles: dict[str, float]) -> str:
        return ", ".join(f"{name} {_four_places(angle)}°" for name, angle in angles.items())

    moved, velocity, place = data["moved_m"], data["end_velocity"], data["end_position"]
    return rows | {
        "duration": f"{data['seconds']:,.6g} s from {data['start_s']:g} s on",
        "start attitude": attitude(data["start_attitude_deg"]),
        "end attitude": attitude(data["end_attitude_deg"]),
        "end velocity": ", ".join(f"{name} {_four_places(v)}" for name, v in velocity.items())
        + " m/s",
        "end position": f"lat {place['lat_deg']:.7f}°, lon {place['lon_deg']:.7f}°,"
        f" height {place['height_m']:.2f} m",
        "moved": ", ".join(f"{name} {metres:,.2f} m" for name, metres in moved.items()),
        "moved per hour": f"{data['moved_horizontally_km_per_h']:.4g} km/h horizontally, start to"
        " end",
        "heading change": f"{_four_places(data['heading_change_deg'])}°,"
        f" {_four_places(data['heading_change_deg_per_h'])} °/h",
        "position": _POSITION[data["position_algorithm"]],
        "wrote": data["output"],
        **(against_truth.facts(data["errors"]) if "errors" in data else {}),
        **({"pictures": ", ".join(data["plots"])} if "plots" in data else {}),
        **({"report": data["report"]} if "report" in data else {}),
    }


def _four_places(value: float) -> str:
    """With four decimals, and no minus sign before a zero."""
    return f"{round(value, 4) + 0.0:.4f}"
