"""`sculler navigate`: attitude, velocity and position from the vectors."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain
from math import cos, degrees, hypot, pi, radians, sin
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sculler import terminal

if TYPE_CHECKING:
    from sculler_model.design import Design
    from sculler_model.host import MajorIncrements
    from sculler_model.navigation import Alignment, NavState

_ANGLES = ("roll", "pitch", "heading")
_VELOCITIES = ("vn", "ve", "vd")


@click.command(
    short_help="Carry attitude, velocity and position with the vectors.",
    epilog=terminal.examples(
        "sculler navigate examples/lasergyro.toml vectors.csv -o nav.csv --axes y,x,-z \\\n"
        "    --lat 34.246048 --lon 108.909664 --height 380 --align 300",
        "sculler navigate stim300 vectors.csv -o nav.csv --heading 90 --ve 30 \\\n"
        "    --lat 48 --lon 11 --height 500",
    ),
)
@terminal.design_argument
@click.argument("vectors", metavar="VECTORS")
@terminal.output_option
@click.option(
    "--lat",
    type=terminal.number_type(),
    required=True,
    help="Initial geodetic latitude, degrees north.",
)
@click.option(
    "--lon", type=terminal.number_type(), required=True, help="Initial longitude, degrees east."
)
@click.option(
    "--height",
    type=terminal.number_type(),
    required=True,
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
    "--align",
    "align_seconds",
    type=terminal.number_type(0, above=True),
    metavar="SECONDS",
    help="Find the attitude from this long at rest at the beginning: levelled and gyro-compassed.",
)
@click.option(
    "--axes",
    default="x,y,z",
    metavar="MAP",
    help='Sensor axes that point forward, right, down: "y,x,-z" for a unit right, forward, up.',
)
@click.option(
    "--third-order",
    is_flag=True,
    help="Correct the rotation vectors for the triple products of smooth manoeuvres.",
)
@click.option(
    "--plots/--no-plots", default=True, show_default=True, help="Pictures beside the output."
)
@terminal.json_option
def command(
    design_name: str,
    vectors: str,
    output: Path,
    lat: float,
    lon: float,
    height: float,
    align_seconds: float | None,
    axes: str,
    third_order: bool,
    plots: bool,
    as_json: bool,
    **initial: float | None,
) -> None:
    """Navigate with the VECTORS (CSV of `model` or `simulate`) of DESIGN.

    Float, once a major interval: exact attitude, velocity and position over WGS-84.  The body frame
    is forward, right, down.  Columns of the output, a row at the start and after every major
    interval: time_s; the attitude quaternion q_w, q_x, q_y, q_z from body to north-east-down;
    roll_deg, pitch_deg, heading_deg (heading from north to east); v_north, v_east, v_down (m/s);
    lat_deg, lon_deg (geodetic) and height_m (over the ellipsoid).
    """
    from sculler.history import HistoryWriter, Thinned
    from sculler_model.errors import InputError
    from sculler_model.host import ThirdOrder, major_increments
    from sculler_model.navigation import AxisMap, NavHistory, Navigator, trajectory
    from sculler_sim.files import replacing
    from sculler_sim.vectors_file import read_vectors

    design = terminal.load_design(design_name)
    axis_map = AxisMap.parse(axes)
    if align_seconds is not None:
        for name, value in initial.items():
            if value is not None:
                raise click.UsageError(f"--{name} and --align contradict each other, give one")
    if plots:
        from sculler.plots import require_matplotlib

        require_matplotlib()

    with (
        terminal.progress("navigating", None) as advance,
        replacing(output) as temporary,
    ):
        increments: Iterator[MajorIncrements] = (
            major_increments(design, block).in_axes(axis_map)
            for block in read_vectors(vectors, design)
        )
        if third_order:
            increments = map(ThirdOrder(), increments)
        alignment = None
        if align_seconds is not None:
            window, increments = _split(increments, round(align_seconds / design.major_interval))
            alignment, start = _aligned(design, window, lat, lon, height, align_seconds)
        else:
            start = _given(lat, lon, height, initial)
        shown = Thinned()
        with HistoryWriter(temporary) as writer:
            navigator = Navigator(start, design.major_interval)
            track = trajectory(navigator, increments)
            for part in chain([NavHistory.from_states([start])], track):
                writer.write(part)
                shown.add(part)
                advance(len(part))
        if navigator.state == start:
            raise InputError(f"{vectors}: no results to navigate with, give a longer log")
    data = _summary(design, vectors, output, start, navigator.state, alignment)
    if plots:
        from sculler.plots import navigation_pictures

        data["plots"] = [str(path) for path in navigation_pictures(shown.history(), output)]
    terminal.report(data, as_json, terminal.facts(_facts(data)))


def _given(lat: float, lon: float, height: float, initial: dict[str, float | None]) -> NavState:
    """The initial state as the options give it."""
    from sculler_model.navigation import NavState
    from sculler_model.navigation.rotation import from_euler

    roll, pitch, heading = (radians(initial[name] or 0.0) for name in _ANGLES)
    vn, ve, vd = (initial[name] or 0.0 for name in _VELOCITIES)
    q = from_euler(roll, pitch, heading)
    return NavState(0.0, q, (vn, ve, vd), radians(lat), radians(lon), height)


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
    lat: float,
    lon: float,
    height: float,
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
    alignment = align(MajorIncrements.concatenate(window), T, radians(lat), height)
    return alignment, alignment.state(radians(lat), radians(lon), height)


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


def _facts(data: dict[str, Any]) -> dict[str, str]:
    rows = {}
    if "alignment" in data:
        found = data["alignment"]
        rows["alignment"] = (
            f"{found['seconds']:g} s at rest: rate {found['rate_deg_per_h']:.3f} °/h, implied"
            f" latitude {found['implied_latitude_deg']:.3f}°, heading scatter"
            f" {found['heading_sigma_deg']:.3f}°"
        )
        for number, warning in enumerate(found["warnings"], start=1):
            rows[f"warning {number}"] = warning

    def attitude(angles: dict[str, float]) -> str:
        return ", ".join(f"{name} {angle:.4f}°" for name, angle in angles.items())

    moved, velocity, place = data["moved_m"], data["end_velocity"], data["end_position"]
    return rows | {
        "duration": f"{data['seconds']:,.6g} s from {data['start_s']:g} s on",
        "start attitude": attitude(data["start_attitude_deg"]),
        "end attitude": attitude(data["end_attitude_deg"]),
        "end velocity": ", ".join(f"{name} {v:.4f}" for name, v in velocity.items()) + " m/s",
        "end position": f"lat {place['lat_deg']:.7f}°, lon {place['lon_deg']:.7f}°,"
        f" height {place['height_m']:.2f} m",
        "moved": ", ".join(f"{name} {metres:,.2f} m" for name, metres in moved.items()),
        "moved per hour": f"{data['moved_horizontally_km_per_h']:.4g} km/h horizontally, start to"
        " end",
        "heading change": f"{data['heading_change_deg']:.4f}°,"
        f" {data['heading_change_deg_per_h']:.4f} °/h",
        "wrote": data["output"],
        **({"pictures": ", ".join(data["plots"])} if "plots" in data else {}),
    }
