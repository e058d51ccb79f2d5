"""The picture of a campaign: growth of the horizontal error, and where runs end."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from sculler.plots.pictures import BLUE, GREEN, GREY, PURPLE, VERMILION, TimeAxis, new_figure

Array = NDArray[np.float64]
_COLOURS = (BLUE, VERMILION, GREEN, PURPLE, GREY)


class Drawn(Protocol):
    """What is drawn of a design's runs."""

    @property
    def time(self) -> Array:
        """(C,) s."""

    @property
    def track(self) -> Array:
        """(C, 2) m: what 50 % and 95 % of the runs do not exceed."""


def campaign_picture(statistics: Mapping[str, Drawn], path: Path) -> Path:
    """Horizontal error over time that 50 % and 95 % of the runs do not exceed, by design.

    Args:
        statistics: by label.
        path: the picture.
    """
    with new_figure(path, 9, 5.5) as figure:
        axes = figure.subplots()
        label = "time"
        for number, (name, found) in enumerate(statistics.items()):
            axis, colour = TimeAxis(found.time), _COLOURS[number % len(_COLOURS)]
            axes.plot(axis.t, found.track[:, 0], color=colour, label=f"{name}, 50 %")
            axes.plot(axis.t, found.track[:, 1], "--", color=colour, label=f"{name}, 95 %")
            label = axis.label
        axes.set(title="Horizontal error that so many runs keep", xlabel=label, ylabel="m")
        axes.set_ylim(bottom=0)
        axes.legend(loc="upper left", frameon=False)
    return path
