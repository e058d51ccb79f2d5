"""A navigated run held against its truth: figures for people and machines, and what to draw."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sculler import terminal
from sculler.history import Thinned
from sculler.truth_file import read_truth
from sculler_model.errors import InputError
from sculler_model.navigation import NavHistory, NavState
from sculler_model.navigation_errors import (
    COMPONENTS,
    NAUTICAL_MILE,
    SAME_INSTANT,
    Comparison,
    Figures,
    NavErrors,
    navigation_errors,
)
from sculler_model.navigation_errors import rows as states

if TYPE_CHECKING:
    from rich.table import Table

ARCSEC = np.degrees(1) * 3600
"""Arcseconds in a radian."""

MILES_PER_HOUR = 3600 / NAUTICAL_MILE
"""Nautical miles per hour in a metre per second."""

UNITS = {
    "attitude": ("arcsec", ARCSEC, "attitude_arcsec"),
    "velocity": ("m/s", 1.0, "velocity_m_s"),
    "position": ("m", 1.0, "position_m"),
}
"""By quantity: unit, how many of them an SI unit is, and the key in JSON."""

NAMES = {
    "attitude": ("tilt about north", "tilt about east", "heading", "in all"),
    "velocity": ("north", "east", "down", "in all"),
    "position": ("north", "east", "down", "horizontal"),
}
"""By quantity: its components north, east, down, and their sum."""


class AgainstTruth:
    """Takes a run's states as they come and forms their errors against a truth file.

    Args:
        path: the truth file.
        interval: a major interval, s.
        begin: pass over what comes before this time, s; there must be a row at it.

    Raises:
        InputError: the file cannot be read or has a fault.
    """

    def __init__(self, path: Path, interval: float, begin: float | None = None) -> None:
        self.path = path
        blocks = read_truth(path)
        if begin is not None:
            blocks = _since(begin, blocks)
        self._comparison = Comparison(blocks, interval, str(path))
        if begin is not None and self.first.time > begin + SAME_INSTANT:
            raise InputError(
                f"{path}: the truth has no row at {begin:.9g} s, where the run is to begin, only"
                f" at {self.first.time:.9g} s; give that to --start"
            )
        self._estimate, self._truth = Thinned(), Thinned()

    @property
    def first(self) -> NavState:
        """The truth's first state."""
        return self._comparison.first

    def add(self, part: NavHistory) -> None:
        """Take the next states."""
        estimate, truth = self._comparison.add(part)
        self._estimate.add(estimate)
        self._truth.add(truth)

    def finish(self) -> None:
        """The run is over; see `Comparison.finish`."""
        self._comparison.finish()

    def summary(self) -> dict[str, Any]:
        """The figures, as plain data."""
        comparison = self._comparison
        data: dict[str, Any] = {
            "truth": str(self.path),
            "instants": comparison.instants,
            "interpolated": comparison.interpolated,
        }
        for quantity, by_component in comparison.figures().items():
            _, scale, key = UNITS[quantity]
            names = (*COMPONENTS, "horizontal" if quantity == "position" else "total")
            data[key] = {
                name: _scaled(figures, scale)
                for name, figures in zip(names, by_component.values(), strict=True)
            }
        data["horizontal_growth_nmi_per_h"] = comparison.growth * MILES_PER_HOUR
        return data

    @property
    def growth(self) -> float:
        """Growth of the horizontal error, m/s; see `Comparison.growth`."""
        return self._comparison.growth

    def shown(self) -> tuple[NavHistory, NavHistory, NavErrors]:
        """Estimate, truth and errors at not too many instants, for pictures."""
        estimate, truth = self._estimate.history(), self._truth.history()
        return estimate, truth, navigation_errors(estimate, truth)


def _since(begin: float, blocks: Iterator[NavHistory]) -> Iterator[NavHistory]:
    """The states from a time on."""
    for block in blocks:
        later = states(block, block.time > begin - SAME_INSTANT)
        if len(later):
            yield later


def _scaled(figures: Figures, scale: float) -> dict[str, float]:
    return {
        "rms": scale * figures.rms,
        "max": scale * figures.largest,
        "final": scale * figures.final,
    }


def rows(errors: dict[str, Any]) -> list[tuple[str, ...]]:
    """Lines of the table of errors: what, unit, rms, largest, final."""
    lines = []
    for quantity, (unit, _, key) in UNITS.items():
        for name, figures in zip(NAMES[quantity], errors[key].values(), strict=True):
            numbers = (terminal.three_digits(figures[k]) for k in ("rms", "max", "final"))
            lines.append((f"{quantity}, {name}", unit, *numbers))
    return lines


def table(errors: dict[str, Any]) -> Table:
    """The table of errors for a terminal."""
    from rich.table import Table

    shown = Table(title="errors against the truth", title_justify="left")
    for name in ("", "unit", "rms", "largest", "at the end"):
        shown.add_column(name, justify="left" if name in ("", "unit") else "right")
    for number, line in enumerate(rows(errors), start=1):
        shown.add_row(*line, end_section=number % 4 == 0)
    return shown


def facts(errors: dict[str, Any]) -> dict[str, str]:
    """What to say beside the table."""
    instants = f"{errors['instants']:,} instants of {errors['truth']}"
    if errors["interpolated"]:
        instants += f", {errors['interpolated']:,} of them by interpolation"
    growth = errors["horizontal_growth_nmi_per_h"]
    return {
        "compared at": instants,
        "horizontal error": f"grows {terminal.three_digits(growth)} nautical miles an hour (the"
        " line through zero that fits best)",
    }
