"""Pictures of `sculler analyze`, in the style of `sculler.plots.pictures`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import cycle, islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sculler.plots.pictures import BLUE, GREEN, GREY, PURPLE, VERMILION, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]

# The rest of Okabe and Ito's palette that shows on white
ORANGE, SKY = "#E69F00", "#56B4E9"

COLOURS = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY)
ITERATION = "what the samples allow (iteration)"
STYLES = ("-", (0, (6, 3)), (0, (2, 2)), (0, (8, 2, 2, 2)))


def looks(count: int) -> Iterator[tuple[str, Any]]:
    """Colour and line style of each of so many curves: where curves coincide, all are seen."""
    return islice(zip(cycle(COLOURS), cycle(STYLES), strict=False), count)


def frequency_picture(path: Path, title: str, unit: str, data: Mapping[str, Any]) -> None:
    """Drift against frequency: curves by closed form, marks by the integer path.

    Args:
        path: the picture.
        title: what vibration it is.
        unit: of drifts.
        data: what `sculler analyze coning --json` prints.
    """
    from matplotlib.ticker import LogLocator, NullLocator

    hertz = np.array(data["frequency_hz"])
    without = np.abs(np.array(data["uncorrected"]))
    designs = data["designs"]
    bottom = _decade_below(float(without.max()) * 1e-12)
    with new_figure(path, 10, 6.8) as figure:
        axes = figure.subplots()
        axes.loglog(hertz, without, color="black", ls=(0, (5, 2)), label="uncorrected")
        for (name, found), (colour, style) in zip(
            designs.items(), looks(len(designs)), strict=True
        ):
            _design_curve(axes, hertz, name, found, colour, style, bottom)
        _requirement_lines(axes, data["requirements"], unit, float(hertz[0]))
        _nyquist_lines(axes, designs, float(hertz[-1]), bottom)
        axes.plot([], [], color=GREY, label="closed form")
        axes.plot([], [], "o", color=GREY, ms=5.5, ls="", label="the core's integers")
        axes.plot([], [], "D", color=GREY, ms=5, mfc="none", mew=1.2, ls="", label="the host")
        if "degree" in data:
            axes.plot([], [], color=GREY, lw=1.2, ls=":", marker="x", ms=4, label=ITERATION)
        axes.set(
            title=title,
            xlabel="frequency (Hz)",
            ylabel=f"drift left, magnitude ({unit})",
            xlim=(hertz[0], hertz[-1] * 1.15),
            ylim=(bottom, _decade_below(float(without.max())) * 10),
        )
        axes.yaxis.set_major_locator(LogLocator(base=10, numticks=30))
        axes.yaxis.set_minor_locator(NullLocator())
        axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1), borderaxespad=0)


def _design_curve(
    axes: Axes,
    hertz: Array,
    name: str,
    found: Mapping[str, Any],
    colour: str,
    style: Any,
    bottom: float,
) -> None:
    """A design's drift: the curve, and the marks of the integer path."""
    drift = np.abs(np.array(found["drift"], dtype=np.float64))
    axes.loglog(
        hertz,
        np.where(drift > bottom / 10, drift, np.nan),
        ls=style,
        color=colour,
        lw=1.8,
        label=name,
    )
    at = [point["hertz"] for point in found["integer_path"]]
    for key, mark, size, fill in (
        ("second_order", "o", 5.5, colour),
        ("complete", "D", 5.0, "none"),
    ):
        values = np.abs([point[key] for point in found["integer_path"]])
        axes.plot(at, values, mark, color=colour, ms=size, mfc=fill, mew=1.2, zorder=3, ls="")
    allowed = [abs(point["iteration"]) for point in found["integer_path"] if "iteration" in point]
    if allowed:
        axes.plot(at, allowed, color=colour, lw=1.2, ls=":", marker="x", ms=4)


def _nyquist_lines(axes: Axes, designs: Mapping[str, Any], highest: float, bottom: float) -> None:
    """Where the designs' sensors see no more."""
    for limit in sorted({found["nyquist_hz"] for found in designs.values()}):
        if limit <= highest * 1.001:
            axes.axvline(limit, color=GREY, lw=1.0, ls=":")
            axes.annotate(
                f"Nyquist, {limit:g} Hz",
                (limit, bottom),
                xytext=(-4, 6),
                textcoords="offset points",
                rotation=90,
                ha="right",
                va="bottom",
                color=GREY,
                fontsize=9,
            )


def manoeuvre_picture(path: Path, data: Mapping[str, Any]) -> None:
    """The rates, and the error against the update rate: sources one by one, and both.

    Args:
        path: the picture.
        data: what `sculler analyze manoeuvre --json` prints.
    """
    from matplotlib.ticker import LogLocator, NullFormatter, ScalarFormatter

    with new_figure(path, 10, 8.6) as figure:
        top, axes = figure.subplots(2, 1, height_ratios=(1, 2.6))
        _manoeuvre_rates(top, data)
        rates = _manoeuvre_errors(axes, data)
        axes.plot([], [], color=GREY, label="source 2: the coefficients")
        axes.plot([], [], "o", color=GREY, ms=5, ls="", label="both, through the core")
        axes.plot([], [], color=GREY, ls=(0, (4, 2)), label="both, host at third order")
        axes.plot([], [], color=GREY, lw=1.2, ls=":", label=ITERATION)
        axes.set(
            title=f"Attitude error after it ({data['unit']})",
            xlabel="attitude updates (Hz)",
            ylabel="error (µrad)",
            xscale="log",
            yscale="log",
        )
        axes.set_xticks(
            [
                hz
                for hz in (25, 50, 75, 100, 150, 200, 300, 400, 800)
                if rates[0] * 0.99 <= hz <= rates[-1] * 1.01
            ]
        )
        axes.xaxis.set_major_formatter(ScalarFormatter())
        axes.xaxis.set_minor_formatter(NullFormatter())
        axes.yaxis.set_major_locator(LogLocator(base=10, numticks=30))
        axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1), borderaxespad=0)


def _manoeuvre_rates(top: Axes, data: Mapping[str, Any]) -> None:
    """The rates against time."""
    profile = data["profile"]
    for axis, colour in zip("xyz", (BLUE, VERMILION, GREEN), strict=True):
        top.plot(profile["seconds"], profile[axis], color=colour, label=f"about {axis}")
    top.set(
        title=f"The manoeuvre: {data['manoeuvre']}",
        xlabel="time (s)",
        ylabel="rate (°/s)",
        xlim=(0, data["seconds"]),
    )
    top.legend(loc="upper left", bbox_to_anchor=(1.01, 1), borderaxespad=0)


def _manoeuvre_errors(axes: Axes, data: Mapping[str, Any]) -> list[float]:
    """The errors against the update rate; all update rates."""
    designs = data["designs"]
    shared: dict[float, float] = {}
    for i, (name, found) in enumerate(designs.items()):
        rows, colour = found["updates"], COLOURS[i % len(COLOURS)]
        width = min(1.4 + 0.7 * (len(designs) - 1 - i), 4.2)  # those below are seen, too
        hertz = [row["update_hz"] for row in rows]
        shared |= {row["update_hz"]: row["source_1"] for row in rows}
        axes.plot(hertz, [r["source_2"] for r in rows], color=colour, lw=width, label=name)
        axes.plot(hertz, [r["third_order"] for r in rows], color=colour, ls=(0, (4, 2)))
        axes.plot(hertz, [r["iteration"] for r in rows], color=colour, lw=1.2, ls=":")
        axes.plot(
            hertz, [r["integer_path"] for r in rows], "o", color=colour, ms=5, zorder=3, ls=""
        )
    rates = sorted(shared)
    axes.plot(
        rates,
        [shared[hz] for hz in rates],
        color="black",
        lw=1.8,
        label="source 1, all designs",
    )
    axes.axhline(data["requirement"], color=GREY, lw=1.0, ls=(0, (1, 1.5)))
    axes.annotate(
        f"requirement for a whole flight, {data['requirement']:g} µrad",
        (rates[-1], data["requirement"]),
        xytext=(-4, 3),
        textcoords="offset points",
        ha="right",
        color=GREY,
        fontsize=9,
    )
    return rates


def quantisation_picture(path: Path, data: Mapping[str, Any]) -> None:
    """Drift added by quantisation against the LSB: theory as lines, Monte Carlo as marks.

    Args:
        path: the picture.
        data: what `sculler analyze quantisation --json` prints.
    """
    from matplotlib.ticker import LogLocator, NullLocator

    designs = data["designs"]
    with new_figure(path, 10, 6.8) as figure:
        axes = figure.subplots()
        axes.set(xscale="log", yscale="log")
        for (name, found), (colour, style) in zip(
            designs.items(), looks(len(designs)), strict=True
        ):
            rows = found["levels"]
            lsb = np.array([row["lsb"] for row in rows])
            axes.plot(lsb, [row["theory"] for row in rows], ls=style, color=colour, label=name)
            axes.plot(lsb, [row["deviation"] for row in rows], "o", color=colour, ms=5.5)
            axes.plot(lsb, [abs(row["mean"]) for row in rows], "x", color=colour, ms=5.5, mew=1.4)
            if found["lsb"] is not None:
                axes.axvline(found["lsb"], color=colour, lw=1.0, ls=":")
                axes.annotate(
                    f"LSB of {name}",
                    (found["lsb"], 1),
                    xycoords=("data", "axes fraction"),
                    xytext=(-3, -4),
                    textcoords="offset points",
                    rotation=90,
                    ha="right",
                    va="top",
                    color=colour,
                    fontsize=9,
                )
        axes.plot([], [], color=GREY, label="standard deviation, theory")
        axes.plot([], [], "o", color=GREY, ms=5.5, ls="", label="standard deviation, measured")
        axes.plot([], [], "x", color=GREY, ms=5.5, mew=1.4, ls="", label="mean, magnitude")
        axes.set(
            title=f"Drift that quantisation adds to {data['half_angle_deg']:g}° coning at"
            f" {data['frequency_hz']:g} Hz, over {data['seconds']:.3g} s",
            xlabel="LSB (rad)",
            ylabel="drift (°/h)",
        )
        left, right = axes.get_xlim()
        _requirement_lines(axes, data["requirements"], "°/h", left)
        axes.set_xlim(left, right)
        axes.yaxis.set_major_locator(LogLocator(base=10, numticks=30))
        axes.yaxis.set_minor_locator(NullLocator())
        axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1), borderaxespad=0)


def _requirement_lines(axes: Axes, requirements: list[float], unit: str, left: float) -> None:
    for limit in requirements:
        axes.axhline(limit, color=GREY, lw=1.0, ls=(0, (1, 1.5)))
        axes.annotate(
            f"requirement {limit:g} {unit}",
            (left, limit),
            xytext=(5, 3),
            textcoords="offset points",
            color=GREY,
            fontsize=9,
        )


def _decade_below(value: float) -> float:
    return float(10 ** np.floor(np.log10(value)))
