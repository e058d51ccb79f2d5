"""A navigated run held against its truth: figures for people and machines, and what to draw."""

from __future__ import annotations

from dataclasses import replace
from math import isnan, nan
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sculler.formats.history import Thinned
from sculler.formats.truth import read_truth
from sculler.units import MILES_PER_HOUR, NAMES, UNITS
from sculler.words import plural, three_digits
from sculler_model.errors import InputError
from sculler_model.navigation import (
    NORTH_EAST_DOWN,
    Comparison,
    Figures,
    NavErrors,
    NavHistory,
    NavState,
    Start,
    navigation_errors,
)

Array = NDArray[np.float64]


class AgainstTruth:
    """Takes a run's states as they come and forms their errors against a truth file.

    Args:
        path: the truth file.
        interval: a major interval, s.
        attitude_only: look at nothing else that it tells.

    Attributes:
        passed_over: rows of the truth that were passed over because of NaN.
        latitude: with `attitude_only` the first that the truth tells, rad; NaN if it tells none.

    Raises:
        InputError: the file cannot be read or has a fault.
    """

    def __init__(self, path: Path, interval: float, *, attitude_only: bool = False) -> None:
        self.path = path
        self.passed_over = 0
        self.latitude = nan
        blocks = read_truth(path, passed_over=self._pass_over)
        if attitude_only:
            blocks = map(self._attitude_of, blocks)
        self._comparison = Comparison(blocks, interval, str(path))
        self._estimate, self._truth = Thinned(), Thinned()

    def _attitude_of(self, part: NavHistory) -> NavHistory:
        """The same states, NaN in all but the attitude; their latitude is looked at."""
        there = part.lat[np.isfinite(part.lat)]
        if isnan(self.latitude) and len(there):
            self.latitude = float(there[0])
        nothing = np.full(len(part), np.nan)
        return replace(part, v=np.full((len(part), 3), np.nan), lat=nothing, lon=nothing, h=nothing)

    def _pass_over(self, rows: int) -> None:
        self.passed_over += rows

    @property
    def first(self) -> NavState:
        """The truth's first state."""
        return self._comparison.first

    @property
    def known(self) -> tuple[str, ...]:
        """Which of attitude, velocity and position the truth tells."""
        return self._comparison.known

    def start(self, instants: Array) -> Start | None:
        """Where a run can begin; see `Comparison.start`."""
        return self._comparison.start(instants)

    def ended(self, time: float) -> bool:
        """Whether the truth ends before a time; see `Comparison.ended`."""
        return self._comparison.ended(time)

    def no_overlap(self, begin: float, end: float) -> InputError:
        """What to say of a run that has nothing in common with the truth."""
        return self._comparison.no_overlap(begin, end)

    def begin(self) -> None:
        """A new stretch of the run, after a break; see `Comparison.begin`."""
        self._comparison.begin()

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
            "rows_passed_over": self.passed_over,
            "left_out_s": comparison.left_out._asdict(),
            "step_s": comparison.step,
        }
        for quantity, by_component in comparison.figures().items():
            _, scale, key = UNITS[quantity]
            names = (*NORTH_EAST_DOWN, "horizontal" if quantity == "position" else "total")
            data[key] = {
                name: _scaled(figures, scale)
                for name, figures in zip(names, by_component.values(), strict=True)
            }
        if "position" in self.known:
            data["horizontal_growth_nmi_per_h"] = comparison.growth * MILES_PER_HOUR
        return data

    @property
    def instants(self) -> int:
        """How many instants run and truth have been compared at."""
        return self._comparison.instants

    @property
    def growth(self) -> float:
        """Growth of the horizontal error, m/s; see `Comparison.growth`."""
        return self._comparison.growth

    def shown(self) -> tuple[NavHistory, NavHistory, NavErrors]:
        """Estimate, truth and errors at not too many instants, for pictures."""
        estimate, truth = self._estimate.history(), self._truth.history()
        return estimate, truth, navigation_errors(estimate, truth)


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
        if key not in errors:  # the truth does not tell it
            continue
        for name, figures in zip(NAMES[quantity], errors[key].values(), strict=True):
            numbers = (three_digits(figures[k]) for k in ("rms", "max", "final"))
            lines.append((f"{quantity}, {name}", unit, *numbers))
    return lines


def facts(errors: dict[str, Any]) -> dict[str, str]:
    """What to say beside the table."""
    instants = f"{errors['instants']:,} instants of {errors['truth']}"
    if errors["interpolated"]:
        instants += f", {errors['interpolated']:,} of them by interpolation"
    shown = {"compared at": instants}
    if errors["rows_passed_over"]:
        shown["truth passed over"] = f"{plural(errors['rows_passed_over'], 'row')} with NaN"
    if left := _left_out(errors):
        shown["left out"] = left
    if "horizontal_growth_nmi_per_h" in errors:
        growth = three_digits(errors["horizontal_growth_nmi_per_h"])
        shown["horizontal error"] = (
            f"grows {growth} nautical miles an hour (the line through zero that fits best)"
        )
    return shown


def _left_out(errors: dict[str, Any]) -> str:
    """What only one of run and truth has, where it is more than a step of the truth."""
    words = {
        "run_before": "{} s of the run before the truth begins",
        "run_after": "{} s of the run after it ends",
        "truth_before": "{} s of the truth before the run begins",
        "truth_after": "{} s of the truth after it ends",
        "run_in_gaps": "{} s of the run in gaps of the truth",
    }
    left = errors["left_out_s"]
    return ", ".join(
        text.format(f"{left[key]:,.6g}")
        for key, text in words.items()
        if left[key] > 1.5 * errors["step_s"]
    )
