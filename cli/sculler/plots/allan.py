"""The picture of `sculler motion --allan`: what the samples have, beside what was asked for."""

from __future__ import annotations

from math import degrees
from pathlib import Path

from sculler.plots.pictures import BLUE, GREEN, GREY, VERMILION, new_figure
from sculler_model.design import Design
from sculler_model.frames import STANDARD_GRAVITY
from sculler_model.samples import AllanCurve, asked_deviation, deviation_of

PARTS = (
    ("Gyros", "°/h", degrees(1) * 3600, slice(0, 3)),
    ("Accelerometers", "mg", 1e3 / STANDARD_GRAVITY, slice(3, 6)),
)


def allan_picture(path: Path, curve: AllanCurve, design: Design) -> None:
    """Allan deviation against averaging time, gyros and accelerometers.

    Args:
        path: the picture.
        curve: of the samples less the truth.
        design: its [sensor.errors] is what was asked for.
    """
    asked = asked_deviation(design, curve.tau)
    known = deviation_of(curve.clusters)
    with new_figure(path, 12, 5.4) as figure:
        for axes, (name, unit, scale, part) in zip(figure.subplots(1, 2), PARTS, strict=True):
            line = scale * asked[:, part.start]
            axes.fill_between(
                curve.tau,
                line * (1 - known).clip(0.05),
                line * (1 + known),
                color=GREY,
                alpha=0.18,
                lw=0,
                label="1 σ of chance",
            )
            axes.loglog(curve.tau, line, color="black", ls=(0, (5, 2)), label="asked for")
            for axis, colour in zip(range(3), (BLUE, VERMILION, GREEN), strict=True):
                made = scale * curve.deviation[:, part][:, axis]
                axes.loglog(curve.tau, made, "o-", color=colour, ms=3, lw=1, label="xyz"[axis])
            axes.set(title=name, xlabel="averaging time (s)", ylabel=f"Allan deviation ({unit})")
            axes.legend()
