"""The picture of a motion through points: the curve beside the points."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sculler.plots.pictures import (
    BLUE,
    GREEN,
    VERMILION,
    TimeAxis,
    from_above,
    legend,
    new_figure,
)
from sculler_model.motion import Motion, Points
from sculler_model.navigation import NavHistory

_INSTANTS = 4000  # of the curve
_MARKS = 1500  # points marked at the most


def points_picture_path(output: Path) -> Path:
    """Where `points_picture` draws."""
    return output.with_name(f"{output.stem}_points.png")


def points_picture(motion: Motion, points: Points, seconds: float, output: Path) -> Path:
    """Track, height, attitude, speed, rates and forces of the curve, the points marked.

    Args:
        motion: through the points.
        points: its time 0 is the first one's.
        seconds: how long it is drawn.
        output: the log, names the picture.
    """
    path = points_picture_path(output)
    curve = motion.state(np.linspace(0.0, seconds, _INSTANTS))
    marks = _marked(points, seconds)
    axis = TimeAxis(curve.time)
    with new_figure(path, 15, 8) as figure:
        track, height, attitude, speed, rate, force = figure.subplots(2, 3).ravel()
        far = max(map(np.ptp, from_above(curve, curve))) > 5000
        scale, unit = (1000.0, "km") if far else (1.0, "m")
        north, east = from_above(curve, curve)
        track.plot(east / scale, north / scale, color=BLUE, label="curve")
        north, east = from_above(marks, curve)
        track.plot(east / scale, north / scale, ".", color=VERMILION, label="points", ms=4)
        track.set(title="Ground track", xlabel=f"east ({unit})", ylabel=f"north ({unit})")
        track.set_aspect("equal", adjustable="datalim")
        height.plot(axis.t, curve.h, color=BLUE, label="curve")
        height.plot(axis.at(marks.time), marks.h, ".", color=VERMILION, label="points", ms=4)
        height.set(title="Height over the ellipsoid", ylabel="m")
        angles = np.unwrap(np.degrees(curve.euler), period=360, axis=0)
        colours = (BLUE, VERMILION, GREEN)
        for k, name in enumerate(("roll", "pitch", "heading")):
            attitude.plot(axis.t, angles[:, k], color=colours[k], label=name)
        attitude.set(title="Attitude", ylabel="degrees")
        speed.plot(axis.t, np.linalg.norm(curve.v, axis=1), color=BLUE, label="over the Earth")
        speed.set(title="Speed", ylabel="m/s")
        sensed = motion.sensed(curve.time)
        for k, name in enumerate(("x", "y", "z")):
            rate.plot(axis.t, np.degrees(sensed[:, k]), color=colours[k], label=name)
            force.plot(axis.t, sensed[:, 3 + k], color=colours[k], label=name)
        rate.set(title="Rates that the sensor feels", ylabel="°/s")
        force.set(title="Specific force that it feels", ylabel="m/s²")
        for axes in (track, height, attitude, speed, rate, force):
            legend(axes)
            if axes is not track:
                axes.set_xlabel(axis.label)
    return path


def _marked(points: Points, seconds: float) -> NavHistory:
    """Some of the points up to the end, evenly taken, as states."""
    time: NDArray[np.float64] = points.time - points.time[0]
    inside = np.flatnonzero(time <= seconds)
    some = inside[:: -(-len(inside) // _MARKS)]
    nothing = np.full((len(some), 4), np.nan)
    return NavHistory(
        time[some], nothing, nothing[:, :3], points.lat[some], points.lon[some], points.h[some]
    )
