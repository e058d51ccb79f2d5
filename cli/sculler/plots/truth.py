"""Pictures of a run against its truth, in the style of `sculler.plots.pictures`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sculler.plots.pictures import (
    BLUE,
    GREEN,
    GREY,
    VERMILION,
    TimeAxis,
    fitting,
    from_above,
    legend,
    new_figure,
)
from sculler.units import MILES_PER_HOUR, NAMES, UNITS
from sculler.words import three_digits
from sculler_model.navigation import NAUTICAL_MILE, NavErrors, NavHistory, known_quantities

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]

SCHULER_PERIOD = 84.4 * 60
"""s; of a pendulum as long as the Earth's radius."""


def truth_picture_paths(output: Path) -> list[Path]:
    """Where `truth_pictures` draws."""
    names = ("errors", "growth", "track")
    return [output.with_name(f"{output.stem}_{name}.png") for name in names]


def truth_pictures(
    estimate: NavHistory,
    truth: NavHistory,
    errors: NavErrors,
    growth: float,
    output: Path,
    sigma: Sequence[float] | None = None,
) -> list[Path]:
    """Errors over time, growth of the horizontal error, and tracks, beside the CSV `output`.

    What the truth does not tell is not drawn.

    Args:
        estimate, truth: states at the same instants.
        errors: of the one against the other.
        growth: of the horizontal error, m/s.
        output: names the pictures.
        sigma: of the attitude about north, east and down after the alignment, rad; None where it
            is not known.
    """
    told = known_quantities(truth)
    paths = truth_picture_paths(output)
    if "position" not in told:
        del paths[1:]
    _errors(paths[0], errors, told, sigma)
    if len(paths) > 1:
        _growth(paths[1], errors, growth)
        _tracks(paths[2], estimate, truth, errors)
    return paths


def _errors(
    path: Path, errors: NavErrors, told: tuple[str, ...], sigma: Sequence[float] | None
) -> None:
    """Level components on the left; heading and the vertical, which runs its own way, right."""
    axis = TimeAxis(errors.time)
    t = axis.t
    with new_figure(path, 12, 9) as figure:
        grid: Any = figure.subplots(len(told), 2, sharex=True, squeeze=False)
        for panels, quantity in zip(grid, told, strict=True):
            of, size, _ = UNITS[quantity]
            north, east, down = (size * getattr(errors, quantity)).T
            level, vertical = panels
            names = NAMES[quantity]
            factor, shown = fitting(of, north, east)
            level.plot(t, factor * north, color=BLUE, label=names[0])
            level.plot(t, factor * east, color=VERMILION, label=names[1])
            level.set(title=f"{quantity.capitalize()} error", ylabel=shown, xlim=(t[0], t[-1]))
            factor, shown = fitting(of, down)
            vertical.plot(t, factor * down, color=GREEN, label=names[2])
            vertical.set_ylabel(shown)
            for axes in panels:
                legend(axes)
            if quantity == "attitude" and sigma is not None:
                _known_to(level, t, fitting(of, north, east)[0] * size * max(sigma[:2]))
                _known_to(vertical, t, factor * size * sigma[2])
            for axes in panels:
                _mark_schuler(axes, errors.time, axis)
        for axes in grid[-1]:
            axes.set_xlabel(_time_label(errors.time, axis))


def _known_to(axes: Axes, t: Array, sigma: float) -> None:
    """What the alignment may have been off, from zero to either side; told alone if it is far."""
    lines, limits = axes.get_lines(), axes.get_ylim()
    band = axes.fill_between(t, -sigma, sigma, color=GREY, alpha=0.18, lw=0, zorder=0)
    band.set_label(f"1 σ ±{three_digits(sigma)}")
    if sigma > 5 * max(map(abs, limits)):
        axes.set_ylim(limits)
    legend(axes, [*lines, band])


def _growth(path: Path, errors: NavErrors, growth: float) -> None:
    axis = TimeAxis(errors.time)
    t = axis.t
    factor, shown = fitting("m", errors.horizontal)
    with new_figure(path, 9, 5.5) as figure:
        axes = figure.subplots()
        line = growth * (errors.time - errors.time[0])
        rate = f"{three_digits(growth * MILES_PER_HOUR)} nautical miles an hour"
        axes.plot(t, factor * errors.horizontal, color=BLUE, label="horizontal error")
        axes.plot(t, factor * line, color=VERMILION, ls="--", label=rate)
        axes.set(title="Horizontal error", ylabel=shown, xlim=(t[0], t[-1]))
        axes.set_xlabel(_time_label(errors.time, axis))
        axes.set_ylim(bottom=0)
        legend(axes)
        _mark_schuler(axes, errors.time, axis)
        if float(errors.horizontal.max()) > 0.01 * NAUTICAL_MILE:
            size = factor * NAUTICAL_MILE
            both: Any = (lambda y: np.divide(y, size), lambda y: np.multiply(y, size))
            miles = axes.secondary_yaxis("right", functions=both)
            miles.set_ylabel("nautical miles")
            miles.spines["right"].set_visible(True)


def _mark_schuler(axes: Axes, time: Array, axis: TimeAxis) -> None:
    """A line after every Schuler period since the start."""
    for x in axis.at(time[0] + SCHULER_PERIOD * np.arange(1, 1 + _periods(time))).tolist():
        axes.axvline(x, color=GREY, ls=":", lw=1)


def _periods(time: Array) -> int:
    return int(float(time[-1] - time[0]) / SCHULER_PERIOD)


def _time_label(time: Array, axis: TimeAxis) -> str:
    """For the time axis, which says what the lines across it are."""
    return axis.label + (", dotted: Schuler periods of 84.4 min" if _periods(time) else "")


def _tracks(path: Path, estimate: NavHistory, truth: NavHistory, errors: NavErrors) -> None:
    with new_figure(path, 12, 6) as figure:
        track, gap = figure.subplots(1, 2)
        true, believed = from_above(truth, truth), from_above(estimate, truth)
        extent = max(float(np.ptp(c)) for c in (*true, *believed))
        scale, unit = (1000.0, "km") if extent > 5000 else (1.0, "m")
        track.plot(true[1] / scale, true[0] / scale, color="#bbbbbb", lw=5, label="truth")
        track.plot(believed[1] / scale, believed[0] / scale, color=BLUE, label="navigated")
        track.plot(0, 0, "o", color="black", label="start")
        track.set(title="Ground track", xlabel=f"east ({unit})", ylabel=f"north ({unit})")

        factor, shown = fitting("m", errors.horizontal)
        north, east = factor * errors.position[:, 0], factor * errors.position[:, 1]
        gap.plot(east, north, color=BLUE, label="error")
        gap.plot(east[0], north[0], "o", color="black", label="start")
        gap.plot(east[-1], north[-1], "s", color=VERMILION, label="end")
        gap.set(title="Horizontal error", xlabel=f"east ({shown})", ylabel=f"north ({shown})")
        for axes in (track, gap):
            axes.set_aspect("equal", adjustable="datalim")
            legend(axes)
