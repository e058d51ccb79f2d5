"""The pictures of hardware.md, in the style of `sculler.plots.pictures`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from sculler.plots.pictures import BLUE, VERMILION, new_figure
from sculler_sim.place.placement import Placement
from studies.hardware.measure import Corner
from studies.hardware.points import Point


def draw(
    folder: Path, placed: Sequence[tuple[Point, Placement]], corners: Sequence[Corner]
) -> list[Path]:
    """The document's pictures, into a folder that is there."""
    paths = [folder / "hardware-speed-area.png", folder / "hardware-design-space.png"]
    speed_area_picture(
        paths[0],
        [
            (f"{point.what}, {placement.device}", placement.area.luts, placement.samples_per_second)
            for point, placement in placed
            if placement.samples_per_second is not None
        ],
    )
    design_space_picture(paths[1], [(c.name, c.multipliers, c.luts, c.clocks) for c in corners])
    return paths


def speed_area_picture(path: Path, rows: Sequence[tuple[str, int, float]]) -> None:
    """Samples per second against look-up tables, each design in a device a numbered mark.

    Args:
        path: the picture.
        rows: label, look-up tables, samples per second.
    """
    with new_figure(path, 11, 6) as figure:
        axes = figure.subplots()
        for number, (label, luts, rate) in enumerate(
            sorted(rows, key=lambda row: row[2], reverse=True), start=1
        ):
            compact = "compact" in label
            axes.loglog(
                [luts],
                [rate],
                "s" if compact else "o",
                color=VERMILION if compact else BLUE,
                ls="none",
                label=f"{number}  {label}",
            )
            above = number % 2 == 1  # and on the left; its neighbours in speed below, on the right
            axes.annotate(
                str(number),
                (luts, rate),
                xytext=(-5, 4) if above else (5, -4),
                textcoords="offset points",
                ha="right" if above else "left",
                va="bottom" if above else "top",
            )
        axes.margins(0.1)
        axes.set(
            title="Speed against area",
            xlabel="look-up tables, result buffers included",
            ylabel="samples/s at the median clock rate",
        )
        figure.legend(loc="outside right upper", fontsize=9)


def design_space_picture(path: Path, rows: Sequence[tuple[str, int, int, float]]) -> None:
    """Clocks a sample and look-up tables against multipliers.

    Args:
        path: the picture.
        rows: core, multipliers, look-up tables, clocks a sample.
    """
    with new_figure(path, 10, 6.8) as figure:
        clocks, area = figure.subplots(2, 1, sharex=True)
        for axes, column, unit in ((clocks, 3, "clocks a sample"), (area, 2, "LUTs")):
            for kind, colour, chosen in (
                ("pipelined", BLUE, [row for row in rows if "compact" not in row[0]]),
                ("compact", VERMILION, [row for row in rows if "compact" in row[0]]),
            ):
                ordered = sorted(chosen, key=lambda row: row[1])
                axes.plot(
                    [row[1] for row in ordered],
                    [float(row[column]) for row in ordered],
                    "o-" if kind == "pipelined" else "s-",
                    color=colour,
                    label=kind,
                )
            axes.set_yscale("log")
            axes.set_ylabel(unit)
        clocks.set_title("24-bit design, ECP5: what multipliers buy")
        clocks.legend()
        area.set_xlabel("multiplier blocks")
