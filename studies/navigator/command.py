"""The command line of `python -m studies.navigator`."""

from __future__ import annotations

from math import hypot
from typing import Any, NamedTuple

import click
import numpy as np
from rich.table import Table

from sculler import terminal
from sculler_model.frames import Quaternion, from_dcm
from sculler_model.host import MajorIncrements
from sculler_model.navigation import (
    NORMAL,
    Gravity,
    Navigator,
    NavState,
    table_of_gravity,
)
from studies.navigator import truth


class Ends(NamedTuple):
    """Errors where a run ends."""

    horizontal: float
    height: float
    velocity: float
    attitude: float


def flown(
    seconds: int, interval: float, gravity: Gravity = NORMAL, *, compiled: bool | None = None
) -> Ends:
    """Errors (m, m, m/s, rad) of the navigator at the end of the independent flight."""
    flight, count = truth.Flight(), round(seconds / interval)
    phi, dv = truth.increments(flight, count, interval)
    navigator = Navigator(start_of(flight), interval, gravity=gravity)
    navigator.run(MajorIncrements(phi, phi, dv), compiled=compiled)
    return ends(flight, navigator.state, count * interval)


def start_of(flight: truth.Flight) -> NavState:
    """Where it begins."""
    t = np.zeros(1)
    lat, lon, h = (float(jet.x[0]) for jet in flight.place(t))
    north, east, down = flight.velocity(t)[0].tolist()
    rows = [tuple(row) for row in flight.to_north(t)[0].tolist()]
    return NavState(0.0, from_dcm((rows[0], rows[1], rows[2])), (north, east, down), lat, lon, h)


def ends(flight: truth.Flight, found: NavState, seconds: float) -> Ends:
    """Errors of a state at a time."""
    t = np.array([seconds])
    lat, lon, h = (float(jet.x[0]) for jet in flight.place(t))
    north = (found.lat - lat) * truth.A
    east = (found.lon - lon) * truth.A * np.cos(lat)
    off = _matrix(found.q) @ flight.to_north(t)[0].T
    return Ends(
        hypot(north, east),
        abs(found.h - h),
        float(np.abs(np.array(found.v) - flight.velocity(t)[0]).max()),
        float(np.abs(truth.rotation_vectors(off[None])).max()),
    )


def _matrix(q: Quaternion) -> truth.Array:
    w, *v = q
    x, y, z = v
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    found: truth.Array = np.eye(3) + 2 * w * cross + 2 * cross @ cross
    return found


def series_of_second_order() -> Gravity:
    """Gravity by the series, at points dense enough for straight lines in between."""
    lats, heights = np.radians(np.linspace(43, 51, 81)), np.linspace(0, 10e3, 101)
    return table_of_gravity(lats, heights, truth.series(lats[:, None], heights[None, :]))


@click.command(epilog=terminal.examples("python -m studies.navigator --seconds 600"))
@click.option("--seconds", type=click.IntRange(60, 3600), default=3600, show_default=True)
@terminal.json_option
def command(seconds: int, as_json: bool) -> None:
    """Navigate over a truth that shares no code with the navigator, and say where it ends.

    A flight at 1 to 9 km, 100 Hz: with the normal field, and with the series of second order in
    height that most navigators have.
    """
    shown = Table(title=f"after {seconds} s", title_justify="left")
    for name in ("gravity", "horizontal, m", "height, m", "velocity, m/s", 'attitude, "'):
        shown.add_column(name, justify="left" if name == "gravity" else "right")
    data: dict[str, Any] = {"seconds": seconds}
    for name, gravity in (("closed form", NORMAL), ("series", series_of_second_order())):
        found = flown(seconds, 0.01, gravity)
        data[name] = found._asdict()
        arc = np.degrees(found.attitude) * 3600
        shown.add_row(name, *(f"{value:.2g}" for value in (*found[:3], arc)))
    terminal.report(data, as_json, shown)
