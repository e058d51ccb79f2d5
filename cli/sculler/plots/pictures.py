"""Pictures (matplotlib), in colours that colour-blind readers can tell apart."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sculler.words import three_digits
from sculler_model.errors import InputError
from sculler_model.frames import SEMI_MAJOR_AXIS, radii
from sculler_model.navigation import NavHistory
from sculler_model.outputs import replacing

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

# Okabe and Ito's palette
BLUE, VERMILION, GREEN, PURPLE, GREY = "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#555555"

_STYLE: dict[Any, Any] = {
    "font.size": 10.5,
    "axes.titlesize": 11.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.formatter.useoffset": False,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.7,
    "legend.frameon": False,
    "lines.linewidth": 1.4,
    "agg.path.chunksize": 2000,  # long lines in pieces: a third of the memory
}


def left_out() -> str | None:
    """Why a verb that also draws leaves its pictures out, in a line; None if it can draw."""
    try:
        require_matplotlib()
    except InputError:
        return "no pictures: matplotlib is not installed, run: pip install 'sculler[plots]'"
    return None


def require_matplotlib() -> None:
    """Ask for matplotlib before any work is done.

    Raises:
        InputError: it is absent; says how to get it.
    """
    try:
        import matplotlib  # noqa: F401
    except ImportError as error:
        raise InputError("pictures need matplotlib, run: pip install 'sculler[plots]'") from error


@contextmanager
def new_figure(path: Path, width: float, height: float) -> Iterator[Figure]:
    """A figure that is saved to `path` in the end, whole or not at all."""
    require_matplotlib()
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    with rc_context(_STYLE):
        figure = Figure(figsize=(width, height), layout="constrained")
        yield figure
        _part_titles(figure)
        with replacing(path) as temporary:
            # no version in the file: the same data give the same bytes
            figure.savefig(temporary, dpi=130, metadata={"Software": None})


def _part_titles(figure: Figure) -> None:
    """Lift titles that a legend on their line would cover to a line of their own."""
    figure.draw_without_rendering()
    for axes in figure.axes:
        shown, text = axes.get_legend(), axes.get_title(loc="left")
        if shown is None or not text:
            continue
        title = axes.set_title(text)
        if title.get_window_extent().overlaps(shown.get_window_extent()):
            axes.set_title(text, pad=24)


def local_metres(history: NavHistory, origin: NavHistory) -> tuple[Array, Array, Array]:
    """North, east, up (m) of states from the first state of `origin`."""
    lat, lon, h = origin.lat[0], origin.lon[0], origin.h[0]
    meridian, prime_vertical = radii(np.sin(lat))
    turned = np.mod(history.lon - lon + np.pi, 2 * np.pi) - np.pi
    north = (history.lat - lat) * (meridian + h)
    east = turned * (prime_vertical + h) * np.cos(lat)
    return north, east, history.h - h


def from_above(history: NavHistory, origin: NavHistory) -> tuple[Array, Array]:
    """North and east (m) of the first state of `origin`: distance and azimuth kept from there.

    On a sphere; it serves at the poles and half round the Earth.
    """
    lat, lon = float(origin.lat[0]), float(origin.lon[0])
    turned = history.lon - lon
    # small differences by half angles, which keep their digits
    across = np.cos(history.lat) * np.sin(turned)
    along = np.sin(history.lat - lat) + 2 * np.sin(lat) * np.cos(history.lat) * (
        np.sin(0.5 * turned) ** 2
    )
    half = np.sqrt(
        np.sin(0.5 * (history.lat - lat)) ** 2
        + np.cos(lat) * np.cos(history.lat) * np.sin(0.5 * turned) ** 2
    )
    distance = 2 * SEMI_MAJOR_AXIS * np.arcsin(np.minimum(half, 1.0))
    length = np.hypot(along, across)
    stretch = np.divide(distance, length, out=np.zeros_like(length), where=length > 0)
    return along * stretch, across * stretch


def navigation_picture_paths(output: Path) -> list[Path]:
    """Where `navigation_pictures` draws."""
    return [output.with_suffix(".png")]


def navigation_pictures(
    history: NavHistory, output: Path, sigma: Sequence[float] | None = None
) -> list[Path]:
    """Ground track, velocity, height and attitude, beside the CSV `output`.

    Args:
        history: the states.
        output: names the picture.
        sigma: of roll, pitch and heading after the alignment, degrees; None where it is not known.
    """
    (path,) = navigation_picture_paths(output)
    north, east = from_above(history, history)
    axis = TimeAxis(history.time)
    t = axis.t
    factor, speed = fitting("m/s", history.v)
    with new_figure(path, 15, 8) as figure:
        track, velocity, height, *attitude = figure.subplots(
            2, 3, gridspec_kw={"wspace": 0.06}
        ).ravel()
        _track(track, {"track": (north, east, BLUE, 1.4)})
        for column, (name, colour) in enumerate(
            (("north", BLUE), ("east", VERMILION), ("down", GREEN))
        ):
            velocity.plot(t, factor * history.v[:, column], color=colour, label=name)
        velocity.set(title="Velocity", ylabel=speed, xlabel=axis.label)
        legend(velocity)
        height.plot(t, history.h, color=BLUE)
        height.set(title="Height over the ellipsoid", ylabel="m", xlabel=axis.label)
        _attitude(attitude, history, axis, sigma)
    return [path]


def attitude_pictures(
    history: NavHistory, output: Path, sigma: Sequence[float] | None = None
) -> list[Path]:
    """The attitude alone; the arguments are those of `navigation_pictures`."""
    (path,) = navigation_picture_paths(output)
    with new_figure(path, 15, 4.5) as figure:
        panels = list(figure.subplots(1, 3, gridspec_kw={"wspace": 0.06}))
        _attitude(panels, history, TimeAxis(history.time), sigma)
    return [path]


def _attitude(
    panels: Sequence[Axes], history: NavHistory, axis: TimeAxis, sigma: Sequence[float] | None
) -> None:
    """Roll, pitch and heading, a panel each."""
    angles = np.unwrap(np.degrees(history.euler), period=360, axis=0)  # no jump at ±180°
    for k, (axes, name) in enumerate(zip(panels, ("Roll", "Pitch", "Heading"), strict=True)):
        axes.plot(axis.t, angles[:, k], color=GREEN)
        axes.set(title=name, ylabel="degrees", xlabel=axis.label)
        if sigma is not None:
            within(axes, axis.t, angles[:, k], sigma[k])


def within(axes: Axes, t: Array, middle: Array, sigma: float) -> None:
    """What is known to be likely: a band of one standard deviation on either side."""
    band = axes.fill_between(
        t, middle - sigma, middle + sigma, color=GREY, alpha=0.18, lw=0, zorder=0
    )
    band.set_label(f"1 σ of the alignment, ±{sigma:.2g}")
    legend(axes, [band])


SMALLER = {
    "arcsec": ("arcsec", "mas", "µas", "nas"),
    "m/s": ("m/s", "mm/s", "µm/s", "nm/s"),
    "m": ("m", "mm", "µm", "nm"),
}
"""Units, each a thousandth of the one before."""


def fitting(unit: str, *values: Array) -> tuple[float, str]:
    """How many of which unit one `unit` is, so that the largest value has digits to read."""
    largest = max(float(np.abs(series).max()) for series in values)
    step = 0
    while 0 < largest * 1000**step < 0.2 and step < len(SMALLER[unit]) - 1:
        step += 1
    return float(1000**step), SMALLER[unit][step]


LONG_CLOCK = 100
"""Lengths of a run after which its clock's numbers are too long for an axis."""


class TimeAxis:
    """Times as an axis shows them: in a fitting unit, on the log's own clock.

    Where the clock began long before, the axis counts from a whole second that its label names.

    Args:
        time: (N,) s.

    Attributes:
        t: (N,) to draw at.
        label: of the axis.
    """

    def __init__(self, time: Array) -> None:
        length = float(time[-1] - time[0])
        self._scale, unit = (3600.0, "h") if length >= 4 * 3600 else (60.0, "min")
        if length < 1000:
            self._scale, unit = 1.0, "s"
        far = abs(float(time[0])) > LONG_CLOCK * max(length, 1.0)
        self._origin = float(np.floor(time[0])) if far else 0.0
        self.t: Array = self.at(time)
        self.label = f"time ({unit}) after {self._origin:.0f} s" if far else f"time ({unit})"

    def at(self, time: Array) -> Array:
        """Where to draw other times (s)."""
        return (time - self._origin) / self._scale


def _track(axes: Axes, tracks: Mapping[str, tuple[Array, Array, str, float]]) -> None:
    """Tracks from above, in m or km, true to shape; the start is marked."""
    sides = [side for north, east, _, _ in tracks.values() for side in (north, east)]
    factor, unit = fitting("m", *sides)
    scale, unit = (1000.0, "km") if max(map(np.ptp, sides)) > 5000 else (1 / factor, unit)
    for name, (north, east, colour, width) in tracks.items():
        axes.plot(east / scale, north / scale, color=colour, lw=width, label=name)
    axes.plot(0, 0, "o", color="black", label="start")
    axes.set(title="Ground track", xlabel=f"east ({unit})", ylabel=f"north ({unit})")
    axes.set_aspect("equal", adjustable="datalim")
    legend(axes)


def legend(axes: Axes, lines: Sequence[Artist] | None = None) -> None:
    """A legend on the title's line, where it hides nothing."""
    lines = axes.get_lines() if lines is None else lines
    axes.legend(
        lines,
        [str(line.get_label()) for line in lines],
        loc="lower right",
        bbox_to_anchor=(1, 1),
        borderaxespad=0.1,
        ncols=len(lines),
        handlelength=1.2,
        columnspacing=1.0,
    )


Errors = Mapping[str, tuple[Array, Array, Array]]
"""By navigator: attitude (arcsec), velocity (m/s) and position (m) errors over time."""

_PAIR = (BLUE, VERMILION)  # the corrected navigator, the uncorrected


def error_picture(path: Path, time: Array, errors: Errors) -> None:
    """Errors against truth on a logarithmic scale, one navigator beside the other.

    The first instant is left out: it is the start, taken from the truth, and shows rounding only.
    """
    quantities = (
        ("Attitude error", "arcsec"),
        ("Velocity error", "m/s"),
        ("Position error", "m"),
    )
    with new_figure(path, 9, 10) as figure:
        panels: Any = figure.subplots(3, 1, sharex=True)
        for row, ((title, unit), axes) in enumerate(zip(quantities, panels, strict=True)):
            for (name, series), colour in zip(errors.items(), _PAIR, strict=True):
                shown = np.where(series[row] > 0, series[row], np.nan)
                axes.semilogy(time[1:], shown[1:], color=colour, label=name)
                axes.annotate(
                    f"{three_digits(float(series[row][-1]))} {unit}",
                    (float(time[-1]), float(series[row][-1])),
                    xytext=(5, 0),
                    textcoords="offset points",
                    color=colour,
                    va="center",
                    annotation_clip=False,
                )
            axes.set(title=title, ylabel=unit, xlim=(0, float(time[-1])))
            legend(axes)
        panels[-1].set_xlabel("time (s)")


def track_picture(path: Path, truth: NavHistory, estimates: Mapping[str, NavHistory]) -> None:
    """The true ground track and where the navigators believe to have been."""
    with new_figure(path, 7.5, 7.5) as figure:
        north, east, _ = local_metres(truth, truth)
        tracks = {"truth": (north, east, "#bbbbbb", 5.0)}
        for (name, history), colour in zip(estimates.items(), _PAIR, strict=True):
            north, east, _ = local_metres(history, truth)
            tracks[name] = (north, east, colour, 1.4)
        _track(figure.subplots(), tracks)


def coning_picture(
    path: Path,
    frequency: Array,
    curves: Mapping[str, Array],
    marked_hz: float,
    half_angle: str,
    sample_rate: float,
) -> None:
    """Drift left of coning over frequency.

    Args:
        path: the picture.
        frequency: (N,) Hz.
        curves: drift (N,) in °/h by name, the uncorrected integrator's first.
        marked_hz: a frequency to mark.
        half_angle, sample_rate: of what coning and at which rate (Hz), for the title.
    """
    with new_figure(path, 9, 6) as figure:
        axes = figure.subplots()
        colours = (VERMILION, BLUE, GREEN, PURPLE)
        for (name, drift), colour in zip(curves.items(), colours, strict=True):
            axes.loglog(frequency, np.abs(drift), color=colour, label=name)
        axes.axvline(marked_hz, color=GREY, ls=":", label=f"{marked_hz:g} Hz, as in the demo")
        axes.set(
            title=f"Drift left of {half_angle} coning, {sample_rate:g} samples/s (closed form)",
            xlabel="coning frequency (Hz)",
            ylabel="drift (°/h)",
            ylim=(1e-9, None),
            xlim=(frequency[0], frequency[-1]),
        )
        axes.legend(loc="upper left")
