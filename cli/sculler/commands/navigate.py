"""`sculler navigate`: attitude, velocity and position from the vectors."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import cos, degrees, hypot, pi, radians, sin
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sculler import terminal
from sculler.commands.options import navigation as navigation_options

if TYPE_CHECKING:
    from sculler.runs.navigation import Given
    from sculler_model.design import Design
    from sculler_model.fast import VectorBlock
    from sculler_model.navigation import Alignment, FineAlignment, Gravity, Mechanisation, NavState

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
    type=terminal.number_type(),
    metavar="SECONDS",
    help="Begin at this time on the log's clock, the end of a major interval, and pass over what"
    " comes before.",
)
@click.option(
    "--stop",
    type=terminal.number_type(),
    metavar="SECONDS",
    help="End with the last major interval that ends at this time or before.",
)
@terminal.breaks_option(
    "Where a result does not follow the one before: refuse the vectors, or begin anew after the"
    " break (from the truth, by aligning again, or by going on as before)."
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
    " columns); what of the initial state is left out comes from it.",
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
@navigation_options.gravity_option
@navigation_options.noise_options
@terminal.json_option
def command(
    design_name: str,
    vectors: str,
    output: Path,
    lat: float | None,
    lon: float | None,
    height: float | None,
    begin: float | None,
    stop: float | None,
    breaks: str,
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
    gravity: str,
    gyro_noise: float | None,
    accel_noise: float | None,
    gyro_bias_sigma: float | None,
    accel_bias_sigma: float | None,
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

    Times are on the log's own clock (on one that began with the log where it has no time_s).  The
    first result may reach before the first sample (status bit 0): the run then begins at its end,
    where the initial state holds.

    With --truth the errors of attitude, velocity and position are told and drawn.  They are formed
    at the instants of whichever of the two is sparser; where the other has no state at such an
    instant it is interpolated: position by a cubic, velocity linearly, attitude evenly.  What only
    one of the two has is left out, and said.  A truth may tell attitude, velocity or position
    alone; what it does not tell of the initial state comes from the options.
    """
    from sculler.formats.history import HistoryWriter, Thinned
    from sculler.formats.vectors import read_vectors
    from sculler.runs.against_truth import AgainstTruth, table
    from sculler.runs.navigation import STATUSES, NavigationRun, Plan
    from sculler_model.frames import AxisMap
    from sculler_model.navigation import NavHistory
    from sculler_model.outputs import replacing

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
    known = {
        "gyro_noise": gyro_noise,
        "accel_noise": accel_noise,
        "gyro_bias_sigma": gyro_bias_sigma,
        "accel_bias_sigma": accel_bias_sigma,
    }
    navigation_options.refuse_noise_without(align_seconds, known)
    noise = navigation_options.sensor_noise(**known)
    model = navigation_options.gravity_model(gravity)
    if begin is not None and stop is not None and not stop > begin:
        raise click.UsageError(f"--stop {stop:g} is not after --start {begin:g}, give a later time")
    if truth is None:
        for name, value in (("lat", lat), ("lon", lon), ("height", height)):
            if value is None:
                raise click.UsageError(
                    f"Missing option '--{name}' (or --truth, which says where the run begins)"
                )
    no_pictures = _claim_pictures(output, truth) if plots else None
    plots = plots and no_pictures is None

    def carrier(start: NavState, reference_height: float) -> Mechanisation:
        return _mechanisation(
            mechanisation,
            start,
            design.major_interval,
            position_every,
            height_damping,
            reference_height,
            model,
        )

    plan = Plan(
        design,
        vectors,
        _given(lat, lon, height, initial),
        carrier,
        axis_map,
        start=begin,
        stop=stop,
        align=align_seconds,
        fine=fine,
        third_order=third_order,
        split=breaks == "split",
        gravity=model,
        noise=noise,
    )
    reference = None if truth is None else AgainstTruth(truth, design.major_interval)
    shown = Thinned()
    with (
        terminal.progress("navigating", _rows(vectors)) as advance,
        replacing(output) as temporary,
        HistoryWriter(temporary, wander=True) as writer,
    ):

        def sink(part: NavHistory) -> None:
            writer.write(part)
            shown.add(part)

        run = NavigationRun(plan, sink, reference)
        run.take(_advancing(read_vectors(vectors, design, missing=True), advance))
    seen = run.seen
    assert seen.start is not None
    assert seen.end is not None
    data = _summary(design, vectors, output, seen.start, seen.end, seen.alignment)
    for key in STATUSES:
        data[key] = seen.statuses.get(key, (0, 0.0))[0]
    data["short_history_results_left_out"] = seen.left_out
    data["breaks"] = seen.breaks
    data["gravity"] = str(model)
    data["warnings"] = seen.warnings
    if no_pictures is not None:
        data["no_pictures"] = no_pictures
        data["warnings"].append(no_pictures)
    fine_position = design.high_resolution and mechanisation == "wander"
    data["position_algorithm"] = "high-resolution" if fine_position else "trapezoidal"
    if seen.fine is not None:
        data["alignment"] |= _fine_facts(seen.fine)
    if reference is not None:
        data["errors"] = reference.summary()
    if plots:
        from sculler.plots.pictures import navigation_pictures

        found = seen.fine or seen.alignment
        euler = None if found is None else [degrees(sigma) for sigma in found.euler_sigma]
        pictures = navigation_pictures(shown.history(), output, euler)
        if reference is not None and data["errors"]["instants"] > 1:
            from sculler.plots.truth import truth_pictures

            sigma = None if found is None else found.sigma
            pictures += truth_pictures(*reference.shown(), reference.growth, output, sigma)
        data["plots"] = [str(path) for path in pictures]
    if page is not None:
        data["report"] = str(page)
        files = {"vectors": vectors, "design": design_name}
        files |= {} if truth is None else {"truth": str(truth)}
        files |= {} if model.table is None else {"gravity table": gravity}
        _write_report(page, design, data, files)
    errors = () if reference is None else ("", table(data["errors"]))
    terminal.report(data, as_json, terminal.facts(_facts(data)), *errors)


def _advancing(blocks: Iterable[VectorBlock], advance: terminal.Advance) -> Iterator[VectorBlock]:
    """The same blocks; tells how many results went by."""
    for block in blocks:
        yield block
        advance(len(block))


def _claim_pictures(output: Path, truth: Path | None) -> str | None:
    """Set the pictures' files aside; or why there will be none, in a line."""
    from sculler.plots.pictures import left_out, navigation_picture_paths
    from sculler.plots.truth import truth_picture_paths
    from sculler_model import inputs

    reason = left_out()
    if reason is None:
        beside = truth_picture_paths(output) if truth is not None else []
        for path in [*navigation_picture_paths(output), *beside]:
            inputs.claim(path)
    return reason


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


def _write_report(page: Path, design: Design, data: dict[str, Any], files: dict[str, str]) -> None:
    """The run as one page."""
    from sculler.formats.origin import chain, settings
    from sculler.report import write_report

    pictures = [Path(path) for path in data.get("plots", [])]
    errors, warnings = data.get("errors"), data["warnings"]
    said = settings(click.get_current_context())
    steps = [step for kind, path in files.items() for step in chain(kind, path)]
    write_report(page, design, _facts(data), errors, pictures, said, warnings, steps)


def _given(
    lat: float | None, lon: float | None, height: float | None, initial: dict[str, float | None]
) -> Given:
    """The initial state as the options tell it, in degrees, as far as they do."""
    from sculler.runs.navigation import Given

    def inside(value: float | None) -> float | None:
        return None if value is None else radians(value)

    roll, pitch, heading = (inside(initial[name]) for name in _ANGLES)
    north, east, down = (initial[name] for name in _VELOCITIES)
    return Given((roll, pitch, heading), (north, east, down), (inside(lat), inside(lon), height))


def _mechanisation(
    name: str,
    start: NavState,
    interval: float,
    position_every: int,
    damping: float | None,
    reference_height: float,
    gravity: Gravity,
) -> Mechanisation:
    """What carries the state, as the options choose it."""
    from sculler_model.navigation import GeographicNavigator, HeightDamping, Navigator

    if name == "geographic":
        if position_every > 1 or damping is not None:
            raise click.UsageError(
                "--position-every and --height-damping are for the wander azimuth, leave them out"
                " or give --mechanisation wander"
            )
        return GeographicNavigator(start, interval, gravity)
    loop = None if damping is None else HeightDamping(reference_height, damping)
    return Navigator(
        start,
        interval,
        position_every=position_every,
        height_damping=loop,
        gravity=gravity,
    )


def _fine_facts(found: FineAlignment) -> dict[str, Any]:
    """What the fine stage adds to the alignment's data."""
    north, east, _ = map(degrees, found.sigma)
    return navigation_options.sigma_facts(found, found.coarse.noise) | {
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
    from sculler_model.frames import radii, to_euler

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
            "warnings": list(alignment.warnings),
            **navigation_options.sigma_facts(alignment, alignment.noise),
        }
    return data


_POSITION = {
    "high-resolution": "of high resolution, by the vectors s_alpha, s_nu and scrolling",
    "trapezoidal": "by the trapezoid",
}


def _facts(data: dict[str, Any]) -> dict[str, str]:
    from sculler.runs import against_truth

    rows = {}
    if "alignment" in data:
        found = data["alignment"]
        rows["alignment"] = (
            f"{found['seconds']:g} s at rest: rate {found['rate_deg_per_h']:.3f} °/h, implied"
            f" latitude {found['implied_latitude_deg']:.3f}°;"
            f" {navigation_options.sigmas_told(found)}"
        )
        if "level_sigma_deg" in found:
            bias = ", ".join(f"{rate:+.4f}" for rate in found["gyro_bias_deg_per_h"])
            rows["fine alignment"] = (
                f"level to {found['level_sigma_deg']:.2g}°, gyro biases {bias} °/h in the body,"
                f" {navigation_options.biases_told(found)}"
            )
    for number, warning in enumerate(data["warnings"], start=1):
        rows[f"warning {number}"] = warning
    if data["short_history_results_left_out"]:
        rows["short history"] = (
            f"{terminal.plural(data['short_history_results_left_out'], 'result')} reached before"
            " the first sample (status bit 0) and cannot be carried: the run begins after that, at"
            f" {data['start_s']:.15g} s, where the initial state holds"
        )

    def attitude(angles: dict[str, float]) -> str:
        return ", ".join(f"{name} {_four_places(angle)}°" for name, angle in angles.items())

    moved, velocity, place = data["moved_m"], data["end_velocity"], data["end_position"]
    return rows | {
        "duration": f"{data['seconds']:,.6g} s from {data['start_s']:.15g} s on",
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
        "gravity": data["gravity"],
        "position": _POSITION[data["position_algorithm"]],
        "wrote": data["output"],
        **(against_truth.facts(data["errors"]) if "errors" in data else {}),
        **({"pictures": ", ".join(data["plots"])} if "plots" in data else {}),
        **({"report": data["report"]} if "report" in data else {}),
    }


def _four_places(value: float) -> str:
    """With four decimals, and no minus sign before a zero."""
    return f"{round(value, 4) + 0.0:.4f}"
