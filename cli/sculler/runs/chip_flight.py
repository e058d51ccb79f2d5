"""A log flown by a chip in Verilator, held against the models."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from sculler.formats import comparison
from sculler.formats.log import read_log
from sculler.formats.telemetry import FRAME, frames_of
from sculler.runs.chip import Chip
from sculler.soc import ChipRecord, Flight, Followed, fly_log, follow
from sculler_model.errors import InputError
from sculler_model.fast import FastModel, VectorBlock
from sculler_model.frames import SEMI_MAJOR_AXIS

QUANTITIES = {"attitude": "rad", "velocity": "m/s", "position": "m"}
COUNTERS = ("taken", "bad", "missed", "late", "lost")


@dataclass(frozen=True)
class Flown:
    """A log that a chip flew.

    Attributes:
        flight: what the chip sent.
        model: the core's results by the golden model's twin.
        followed: what Python's navigator makes of the results that came.
    """

    flight: Flight
    model: VectorBlock
    followed: Followed

    @property
    def record(self) -> ChipRecord:
        """What the telemetry tells, as far as the log went."""
        return self.flight.record

    @property
    def equal_results(self) -> int:
        """Results that are the model's, integer for integer, from the first one on."""
        found = comparison.difference(self.model, self.record.results)
        return len(self.model) if found is None else found.row

    def differences(self) -> dict[str, float]:
        """The largest difference of the states from Python's: rad, m/s, m."""
        return dict(zip(QUANTITIES, differences(self.record, self.followed), strict=True))

    @property
    def same(self) -> bool:
        """Whether all results are the model's, and as many states came as there should."""
        whole = self.equal_results == len(self.model) == len(self.record.results)
        ended = all(each.same_end for each in self.followed.alignments)
        return whole and ended and len(self.record.states) == len(self.followed.rows)


def differences(record: ChipRecord, followed: Followed) -> tuple[float, float, float]:
    """The largest difference of states that were told from those that should have been.

    Returns:
        Of attitude, rad; velocity, m/s; position, m.
    """
    status = np.zeros(len(followed.rows), np.int64)
    expected = np.frombuffer(frames_of(followed.states, status, 0), FRAME)
    numbers = record.numbers[followed.rows]
    _, ours, theirs = np.intersect1d(record.states["number"], numbers, return_indices=True)

    def away(name: str, scale: float | list[float] = 1.0) -> float:
        apart = record.states[name][ours] - expected[name][theirs]
        return float(np.abs(apart * scale).max(initial=0.0))

    on_earth = [SEMI_MAJOR_AXIS, SEMI_MAJOR_AXIS, 1.0]  # latitude and longitude as m
    return away("q", 2.0), away("v"), away("place", on_earth)


def fly(chip: Chip, log: Path) -> Flown:
    """Fly a log: its samples on the sensor's line, in Verilator.

    Raises:
        InputError: the log has a fault or less than a result, or Verilator fails.
    """
    chunks = list(read_log(log, chip.plan.design))
    counts = np.concatenate([chunk.counts for chunk in chunks])
    marks = [c.faults if c.faults is not None else np.zeros(len(c.counts), int) for c in chunks]
    return flown(chip, counts.tolist(), np.concatenate(marks).tolist())


def flown(chip: Chip, counts: list[list[int]], faults: list[int]) -> Flown:
    """The same of samples in memory: (N, 6) counts and (N,) fault marks."""
    model = FastModel(chip.plan.design).feed(np.array(counts, np.int64), np.array(faults, np.uint8))
    if not (np.asarray(model.status) & 1 == 0).any():
        raise InputError(
            f"the log has {len(counts)} samples, less than a result to navigate with; give a"
            " longer one"
        )
    flight = fly_log(chip.plan, chip.generated, chip.firmware, counts, faults)
    kept = flight.record.first(len(model))
    return Flown(replace(flight, record=kept), model, follow(chip.plan, kept))


def figures(chip: Chip, flown: Flown) -> dict[str, Any]:
    """Of a flight, as plain data."""
    record, followed, front = flown.record, flown.followed, chip.plan.design.hardware.front
    assert front is not None
    clock, rows = front.clock_hz, followed.rows
    steady = slice(
        int(rows[0]) + 2 if len(rows) else 0, None
    )  # the first update is worked out twice
    update = (record.ended - record.begun)[steady]
    busy = record.free[steady][1:] - record.begun[steady][:-1]
    after = [end - begin for begin, end in _last_bytes(flown)]
    return {
        "clock_hz": clock,
        "clocks": flown.flight.clocks,
        "results": len(record.results),
        "results_of_the_model": len(flown.model),
        "identical_results": flown.equal_results,
        "states": len(record.states),
        "states_expected": len(rows),
        "coasted_s": followed.coasted,
        "largest_difference": flown.differences(),
        "update_clocks": int(np.median(update)) if len(update) else None,
        "busy_clocks": int(np.median(busy)) if len(busy) else None,
        "updates_per_second": float(clock / np.median(busy)) if len(busy) else None,
        "core_clocks": int(np.median(record.result_clock - record.sample_clock)),
        "wait_clocks": int(np.median(record.begun - record.result_clock)),
        "telemetry_clocks": int(np.median(after)) if after else None,
        "counters": dict(
            zip(
                COUNTERS, record.counters[-1].tolist() if len(record.counters) else (), strict=False
            )
        ),
        "alignments": [
            {
                "error": int(each.told["error"]),
                "seconds": float(each.told["seconds"]),
                "from_python_rad": each.apart,
                "clocks": _clocks_of(flown, int(each.told["number"])),
            }
            for each in followed.alignments
        ],
    }


def _clocks_of(flown: Flown, number: int) -> int:
    """From a result's being taken up to what came of it."""
    (row,) = np.flatnonzero(flown.record.numbers == number)
    return int(flown.record.ended[row] - flown.record.begun[row])


def _last_bytes(flown: Flown) -> Iterator[tuple[int, int]]:
    """Of each state the clocks of its interval's last sample, and of its own last byte."""
    record = flown.record
    begins = dict(zip(record.numbers.tolist(), record.sample_clock.tolist(), strict=True))
    for number, place in record.state_ends:
        if number in begins:
            yield begins[number], flown.flight.sent.clocks[place]


def told(found: dict[str, Any]) -> dict[str, str]:
    """`figures` in words, row by row."""
    away = found["largest_difference"]
    states = ", ".join(f"{name} {away[name]:.1e} {unit}" for name, unit in QUANTITIES.items())
    rows = {
        "results": f"{found['identical_results']} of {found['results_of_the_model']} are the"
        " model's, integer for integer",
        "states": f"{found['states']}: Python's to the last bit"
        if not any(away.values())
        else f"{found['states']}; off from Python's by at most {states}",
    }
    if found["busy_clocks"]:
        rows["update"] = (
            f"{found['update_clocks']:,} clocks, {found['busy_clocks']:,} with telemetry:"
            f" {found['updates_per_second']:.0f} a second at {found['clock_hz'] / 1e6:g} MHz"
        )
    for number, one in enumerate(found["alignments"]):
        rows["alignment" + f" {number + 1}" * (number > 0)] = (
            f"{one['seconds']:g} s at rest, {one['from_python_rad']:.1e} rad from Python's"
            if not one["error"]
            else f"refused, error {one['error']} of sculler_error"
        )
    if found["coasted_s"]:
        rows["coasted"] = f"{found['coasted_s']:g} s, over results that are missing"
    return rows
