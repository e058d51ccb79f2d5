"""The picture of `sculler analyze vibration`, in the style of `sculler.plots.pictures`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sculler.plots.analysis import COLOURS
from sculler.plots.pictures import BLUE, GREEN, GREY, VERMILION, new_figure
from sculler.words import three_digits
from sculler_model.analysis.vibration import (
    G,
    MountResponse,
    Spectrum,
    relative_error,
)
from sculler_model.design import Design

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]

PER_HOUR = degrees(1) * 3600
POINTS = 1500
"""Points of a curve: enough for the resonances, few enough to draw."""


def vibration_picture(
    path: Path, spectrum: Spectrum, response: MountResponse, designs: Mapping[str, Design]
) -> None:
    """Vibration before and behind the mount, and what of it rectifies, by frequency.

    Args:
        path: the picture.
        spectrum: the vehicle's vibration.
        response: the sensor assembly's.
        designs: whose errors are shown, by name.
    """
    f = response.frequency
    shown = _thinned(f)
    density = response.power / response.step
    worst = response.worst_phase
    coning = PER_HOUR * worst.coning / response.step
    sculling = 1e6 / G * np.hypot(*worst.sculling[:, 1:].T) / response.step
    with new_figure(path, 12, 8.4) as figure:
        acceleration, rotation, cone, scull = figure.subplots(2, 2, sharex=True).ravel()
        force = density * np.abs(response.force) ** 2 / G**2
        acceleration.loglog(
            f[shown], density[shown] / G**2, color=GREY, label=f"vehicle, {spectrum.rms:.3g} g rms"
        )
        acceleration.loglog(
            f[shown],
            force[shown],
            color=BLUE,
            label=f"sensor assembly, {response.force_rms / G:.3g} g rms",
        )
        acceleration.set(title="Acceleration", ylabel="g²/Hz")
        _rotations(rotation, f, shown, density, response)
        rotation.set(title="Rotation of the sensor assembly", ylabel="µrad/√Hz")
        for axes, title, unit, true in (
            (cone, "Coning", "°/h", coning),
            (scull, "Sculling", "µg", sculling),
        ):
            if true.any():
                _left(axes, f, true, response.step, designs, shown, unit)
            else:
                axes.text(0.5, 0.5, "none", transform=axes.transAxes, ha="center", color=GREY)
            axes.set(
                title=f"{title} that it rectifies to, at most",
                ylabel=f"{unit} per Hz",
                xlabel="frequency (Hz)",
            )
        for axes in (acceleration, rotation, cone, scull):
            handles = axes.get_legend_handles_labels()[0]
            if handles:
                axes.legend(loc="lower left" if axes in (acceleration, rotation) else "upper right")
            axes.set_xlim(f[0], f[-1])


def _rotations(
    rotation: Axes, f: Array, shown: NDArray[np.intp], density: Array, response: MountResponse
) -> None:
    """How the sensor assembly turns, about its two axes."""
    for name, transfer, rms, colour, style in (
        ("z", response.z, response.angle_rms[1], GREEN, "-"),
        ("y", response.y, response.angle_rms[0], VERMILION, "--"),
    ):
        if rms > 0:
            amplitude = 1e6 * np.sqrt(density) * np.abs(transfer)
            rotation.loglog(
                f[shown],
                amplitude[shown],
                style,
                color=colour,
                label=f"about {name}, {1e6 * rms:.3g} µrad rms",
            )


def _left(
    axes: Axes,
    f: Array,
    true: Array,
    step: float,
    designs: Mapping[str, Design],
    shown: NDArray[np.intp],
    unit: str,
) -> None:
    """The rectified density, and what each design leaves of it."""
    total = float(true.sum()) * step
    axes.loglog(
        f[shown], true[shown], color="black", label=f"true, {three_digits(total)} {unit} in all"
    )
    top = float(true.max())
    for (name, design), colour in zip(designs.items(), COLOURS * len(designs), strict=False):
        phase = 2 * np.pi * f * design.sample_interval
        share = np.abs(
            relative_error(design.table, phase, design.sensor.kind, design.sensor_response)
        )
        left = true * share
        axes.loglog(
            f[shown],
            np.where(left > 0, left, np.nan)[shown],
            color=colour,
            label=f"left by {name}, {float(left.sum()) * step:.2g} {unit}",
        )
    axes.set_ylim(top * 1e-12, top * 300)


def _thinned(frequency: Array) -> NDArray[np.intp]:
    """Indices of about `POINTS` frequencies, even on a logarithmic axis."""
    wanted = np.geomspace(frequency[0], frequency[-1], POINTS)
    found: NDArray[np.intp] = np.unique(
        np.searchsorted(frequency, wanted).clip(0, len(frequency) - 1)
    )
    return found


def drift_picture(
    path: Path,
    title: str,
    hertz: Array,
    curves: Mapping[str, tuple[Array, Sequence[float], Sequence[float]]],
    marked_hz: float,
    marked: str,
) -> None:
    """Drift over the coning frequency: lines by closed form, marks of the attitude.

    Args:
        path: the picture.
        title: what motion and which sensor.
        hertz: (N,) of the lines.
        curves: by name: the line (°/h), the marks' frequencies and their drifts.
        marked_hz, marked: a frequency to mark, and its name.
    """
    with new_figure(path, 9, 5.8) as figure:
        axes = figure.subplots()
        for (name, (line, at, drifts)), colour in zip(curves.items(), COLOURS, strict=False):
            axes.loglog(hertz, np.abs(line), color=colour, label=name)
            axes.plot(at, np.abs(drifts), "o", color=colour, mfc="white", mew=1.3, ms=5.5)
        axes.axvline(marked_hz, color=GREY, ls=":", lw=1)
        axes.annotate(
            f"{marked}, {marked_hz:g} Hz",
            (marked_hz, 0),
            xycoords=("data", "axes fraction"),
            xytext=(4, 6),
            textcoords="offset points",
            color=GREY,
            fontsize=9,
        )
        _requirements(axes)
        top = max(float(np.nanmax(np.abs(line))) for line, _, _ in curves.values())
        axes.set(
            title=title,
            xlabel="coning frequency (Hz)",
            ylabel="|drift| (°/h)",
            xlim=(hertz[0], hertz[-1]),
            ylim=(1e-9, min(top * 10, 1e5)),
        )
        axes.legend(loc="upper left")


def effect_picture(path: Path, title: str, ratio: Array, lines: Mapping[str, Array]) -> None:
    """The coning effect over frequency up to Nyquist, relative to that of an ideal sensor there.

    Args:
        path: the picture.
        title: what is shown.
        ratio: (N,) frequency times sample interval, 0 to ½.
        lines: (N,) by name, in the unit of `ratio`.
    """
    with new_figure(path, 9, 4.6) as figure:
        axes = figure.subplots()
        for (name, line), colour, style in zip(
            lines.items(), COLOURS, ("-", (0, (2, 1.5))), strict=False
        ):
            axes.plot(ratio, line / ratio[-1], ls=style, color=colour, label=name)
        axes.set(
            title=title,
            xlabel="frequency × sample interval (½: Nyquist)",
            ylabel="coning effect, ideal at Nyquist = 1",
            xlim=(0, 0.5),
            ylim=(0, 1),
        )
        axes.legend(loc="upper left")


def order_picture(
    path: Path,
    title: str,
    totals: Sequence[int],
    series: Mapping[str, tuple[Sequence[float], Sequence[float]]],
) -> None:
    """Drift over n + p: what the table leaves, and what the attitude shows.

    Args:
        path: the picture.
        title: what motion and which sensor.
        totals: values of n + p.
        series: by half angle: closed form and attitude, °/h.
    """
    with new_figure(path, 9, 5.8) as figure:
        axes = figure.subplots()
        for (name, (left, whole)), colour in zip(series.items(), COLOURS, strict=False):
            axes.semilogy(totals, np.abs(left), "--", color=colour, lw=1.1)
            axes.semilogy(
                totals, np.abs(whole), "o-", color=colour, ms=5, label=f"half angle {name}"
            )
            axes.annotate(
                f"floor {abs(whole[-1]):.2g} °/h",
                (totals[-1], abs(whole[-1])),
                xytext=(9, 0),
                textcoords="offset points",
                va="center",
                color=colour,
                annotation_clip=False,
            )
        axes.plot([], [], "o-", color=GREY, ms=5, label="attitude, triple products and all")
        axes.plot([], [], "--", color=GREY, lw=1.1, label="closed form, what the table leaves")
        _requirements(axes)
        axes.set(
            title=title,
            xlabel="n + p",
            ylabel="|drift| (°/h)",
            xticks=list(totals),
            xlim=(totals[0] - 0.1, totals[-1]),
        )
        figure.legend(loc="outside lower center", ncols=3)


def _requirements(axes: Axes) -> None:
    """The requirements of Savage-20."""
    for limit in (1.7e-4, 1.7e-5):
        axes.axhline(limit, color=GREY, lw=1.0, ls=(0, (1, 1.5)))
        axes.annotate(
            f"allowed {limit:.6f}".rstrip("0") + " °/h",
            (1, limit),
            xycoords=("axes fraction", "data"),
            xytext=(-4, 3),
            textcoords="offset points",
            ha="right",
            color=GREY,
            fontsize=9,
        )
