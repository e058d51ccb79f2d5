"""The runs themselves: samples, counts, exact core, navigator, and the errors at some instants."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sculler.runs.campaign.plan import Campaign, InitialTable
from sculler_model.design import Design
from sculler_model.errors import Error, InputError
from sculler_model.fast import FastModel
from sculler_model.frames import from_rotation_vector, product, radii
from sculler_model.host import major_increments
from sculler_model.motion import delivered
from sculler_model.navigation import (
    HeightDamping,
    HeightReference,
    NavHistory,
    Navigator,
    NavState,
    navigation_errors,
)
from sculler_model.samples import Imperfect, Quantiser, interval_end

COLUMNS = (
    "design",
    "seed",
    "time_s",
    *(f"tilt_{axis}_rad" for axis in ("north", "east", "down")),
    *(f"velocity_{axis}_m_s" for axis in ("north", "east", "down")),
    *(f"position_{axis}_m" for axis in ("north", "east", "down")),
)
"""Of the results: a row for each run and checkpoint; errors are estimate less truth."""

Array = NDArray[np.float64]

_COMPILED = find_spec("numba") is not None  # from the first interval on, in every run alike


def fly(campaign: Campaign, number: int, seeds: Sequence[int]) -> dict[str, NDArray[Any]]:
    """Runs of one design over the same motion, side by side, in bounded memory.

    A run depends on its seed alone, not on those beside it.

    Args:
        campaign: the campaign.
        number: of the design, from 0.
        seeds: of the runs.

    Returns:
        `COLUMNS`, the checkpoints of the first run, then of the next.

    Raises:
        InputError: a count does not fit the sensor, or a height runs away.
    """
    design = campaign.designs[number]
    samples = round(campaign.tables.seconds * design.sensor.sample_rate_hz)
    checks = Checkpoints(campaign, design, samples)
    runs = [_Run(campaign, design, checks, seed) for seed in seeds]
    for chunk in felt(campaign, design):
        for run in runs:
            run.take(chunk)
    rows = np.concatenate([run.errors() for run in runs])
    many = len(checks.intervals)
    found: dict[str, NDArray[Any]] = {
        "design": np.full(len(rows), number, np.int64),
        "seed": np.repeat(np.array(list(seeds), np.int64), many),
        "time_s": np.tile(checks.truth.time, len(runs)),
    }
    return found | dict(zip(COLUMNS[3:], rows.T, strict=True))


def felt(campaign: Campaign, design: Design) -> Iterator[Array]:
    """The samples of perfect sensors that every run of a design begins with, block by block."""
    samples = round(campaign.tables.seconds * design.sensor.sample_rate_hz)
    return delivered(campaign.motion, design, samples)


class Checkpoints:
    """The instants at which errors are kept, and the truth there.

    Attributes:
        first: number of the first major interval that is navigated.
        start: time of its beginning, s.
        intervals: numbers of the intervals at whose end errors are kept.
        truth: the states there.
        barometer: instants (s) and true heights (m) to hold to; None for the initial one.

    Raises:
        InputError: there is no whole major interval.
    """

    def __init__(self, campaign: Campaign, design: Design, samples: int) -> None:
        self.first = design.short_majors
        last = samples // design.samples_per_major
        while interval_end(design, self.first - 1) < 0:  # the first intervals of rates
            self.first += 1
        if last <= self.first:
            raise InputError(
                f"seconds: {campaign.tables.seconds:g} s hold no major interval of {design.name},"
                " give more"
            )
        many = min(campaign.tables.checkpoints, last - self.first)
        steps = np.arange(1, many + 1) * (last - self.first) / many
        self.intervals = self.first + np.rint(steps).astype(np.int64) - 1
        self.start = interval_end(design, self.first - 1)
        times = [interval_end(design, number) for number in self.intervals.tolist()]
        self.truth = campaign.motion.state(np.array(times))
        self.barometer: tuple[Array, Array] | None = None
        if campaign.tables.navigator.height == "true":
            many = round(10 * campaign.tables.seconds) + 1
            instants = 0.1 * np.arange(many, dtype=np.float64)
            self.barometer = instants, campaign.motion.state(instants).h


class _Run:
    """One run, as far as it has come."""

    def __init__(self, campaign: Campaign, design: Design, checks: Checkpoints, seed: int) -> None:
        self._design, self._checks, self._seed = design, checks, seed
        self._imperfect, self._quantise = Imperfect(design, seed), Quantiser(design)
        self._model = FastModel(design)
        true = campaign.motion.state(np.array([checks.start])).state(0)
        table = campaign.tables.navigator
        damping = None
        self._height: HeightReference | None = None
        if table.height_damping is not None:
            damping = HeightDamping(true.h, table.height_damping)
            if checks.barometer is not None:
                self._height = HeightReference(*checks.barometer)
                damping = HeightDamping(None, table.height_damping, self._height.hold)
        self._navigator = Navigator(
            disturbed(true, campaign.tables.initial, seed),
            design.major_interval,
            position_every=table.position_every,
            height_damping=damping,
            compiled=_COMPILED,
        )
        self._number = 0  # of the next major interval
        self._kept: list[NavHistory] = []

    def take(self, chunk: Array) -> None:
        """The next samples of perfect sensors."""
        try:
            block = self._model.feed(self._quantise(self._imperfect(chunk)))
            found = major_increments(self._design, block)
            begin, end = self._number, self._number + len(found)
            if self._height is not None:
                first, T = interval_end(self._design, begin - 1), self._design.major_interval
                begins = first + T * np.arange(len(found))
                found = replace(found, heights=self._height.at(begins))
            self._number = end
            skipped = min(max(self._checks.first - begin, 0), len(found))
            if skipped == len(found):
                return
            states = self._navigator.run(found[skipped:])
        except Error as error:
            raise InputError(f"seed {self._seed} of {self._design.name}: {error}") from error
        begin += skipped
        wanted = self._checks.intervals
        here = wanted[(wanted >= begin) & (wanted < end)] - begin
        if len(here):
            self._kept.append(states.rows(here))

    def errors(self) -> Array:
        """(checkpoints, 9): attitude (rad), velocity and position errors."""
        states = replace(NavHistory.concatenate(self._kept), time=self._checks.truth.time)
        found = navigation_errors(states, self._checks.truth)
        return np.hstack((found.attitude, found.velocity, found.position))


def disturbed(true: NavState, table: InitialTable, seed: int) -> NavState:
    """An initial state with errors drawn for a seed, normally distributed."""
    numbers = np.random.default_rng([seed, 2]).standard_normal(9).tolist()
    tilt, heading = 1e-3 * table.tilt_mrad, 1e-3 * table.heading_mrad
    turn = (tilt * numbers[0], tilt * numbers[1], heading * numbers[2])
    v = tuple(a + table.velocity * b for a, b in zip(true.v, numbers[3:6], strict=True))
    north, east, down = (table.position * number for number in numbers[6:])
    meridian, prime_vertical = radii(float(np.sin(true.lat)))
    return NavState(
        true.time,
        product(from_rotation_vector(turn), true.q),
        (v[0], v[1], v[2]),
        true.lat + north / (meridian + true.h),
        true.lon + east / ((prime_vertical + true.h) * float(np.cos(true.lat))),
        true.h - down,
    )
