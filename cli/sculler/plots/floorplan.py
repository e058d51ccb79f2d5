"""Where a placed core's parts stand in the device."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from sculler.plots.pictures import BLUE, GREEN, GREY, PURPLE, VERMILION, new_figure
from sculler_sim.place.parts import PARTS

_COLOURS = dict(zip(PARTS, (VERMILION, BLUE, GREEN, PURPLE, GREY), strict=True))


def floor_picture(path: Path, places: Mapping[str, Sequence[tuple[int, int]]], title: str) -> None:
    """The tiles of nextpnr's grid that the core is in, each in the colour of most of its cells.

    Args:
        path: of the PNG.
        places: columns and rows of the cells, by part (`PARTS`).
        title: of the picture.

    Raises:
        InputError: matplotlib is missing, or the file cannot be written.
    """
    tiles: dict[tuple[int, int], Counter[str]] = {}
    for part, found in places.items():
        for place in found:
            tiles.setdefault(place, Counter())[part] += 1
    columns, rows = np.array([*tiles, (0, 0)]).T
    shown = np.full((rows.max() + 1, columns.max() + 1), np.nan)
    for (column, row), counts in tiles.items():
        shown[row, column] = PARTS.index(max(PARTS, key=lambda part: counts[part]))
    with new_figure(path, 8, 6) as figure:
        from matplotlib.colors import ListedColormap
        from matplotlib.patches import Patch
        from matplotlib.ticker import MaxNLocator

        axes = figure.add_subplot()
        colours = ListedColormap(list(_COLOURS.values()))
        axes.imshow(shown, cmap=colours, vmin=-0.5, vmax=len(PARTS) - 0.5, interpolation="nearest")
        axes.grid(False)
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_locator(MaxNLocator(integer=True))
        axes.set_xlabel("column")
        axes.set_ylabel("row")
        axes.set_title(title, loc="left")
        handles = [
            Patch(color=_COLOURS[part], label=f"{part}, {len(places[part]):,} cells")
            for part in PARTS
            if places.get(part)
        ]
        figure.legend(handles=handles, loc="outside lower center", ncols=3)
