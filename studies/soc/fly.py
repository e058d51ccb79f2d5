"""A truth motion through the chip, whole and with damage on the wire."""

from __future__ import annotations

import resource
from dataclasses import dataclass
from typing import Any

import numpy as np

from sculler.formats import comparison
from sculler.library import motions
from sculler.runs.chip import Chip, make_chip
from sculler.runs.chip_flight import Flown, figures, flown
from sculler.soc import SocPlan, fly_log
from sculler_model.fast import FastModel
from sculler_model.front import FrontModel, FrontSample
from sculler_model.motion import Motion
from sculler_model.navigation import NavHistory
from studies.soc.designs import DESIGN

MOTION = "demo"
SECONDS = 1.2
DAMAGED_SECONDS = 0.2
CORRUPTED, LOST = {25, 130, 207}, {61, 62, 63, 64, 65, 66, 301}
"""Numbers of the datagrams of the damaged flight; six in a row are more than a time-out waits."""


@dataclass(frozen=True)
class Damaged:
    """A flight with damage on the wire.

    Attributes:
        results: that came; equal: the model's of what the front end's model makes of these bytes.
        flagged: results with status bit 1.
        states: that came.
        counters: taken, bad, missed, late, lost.
        away: m, the last position from that of the whole flight.
    """

    results: int
    equal: int
    flagged: int
    states: int
    counters: dict[str, int]
    away: float


@dataclass(frozen=True)
class Measured:
    """The flights.

    Attributes:
        chip: that flew.
        flown: the whole one.
        figures: of it, as `sculler soc --json` tells them.
        cpu_seconds: of a processor, for a second of flight.
        truth: at the instants of the states.
        damaged: the other.
    """

    chip: Chip
    flown: Flown
    figures: dict[str, Any]
    cpu_seconds: float
    truth: NavHistory
    damaged: Damaged


def chip_of(motion: Motion) -> Chip:
    """The chip, beginning where the motion does."""
    start = motion.state(np.zeros(1)).state(0)
    return make_chip(SocPlan(DESIGN, start))


def usual_chip() -> Chip:
    """The chip that flies.

    Raises:
        InputError: a tool is missing.
    """
    return chip_of(motions.motion(MOTION))


def measure() -> Measured:
    """Fly both.

    Raises:
        InputError: a tool is missing.
    """
    motion = motions.motion(MOTION)
    chip = chip_of(motion)
    log = motions.record(DESIGN, motion, SECONDS)
    counts, none = log.counts.tolist(), [0] * len(log.counts)
    flown(chip, counts[: 2 * DESIGN.samples_per_major], none[: 2 * DESIGN.samples_per_major])
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    found = flown(chip, counts, none)
    spent = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    seconds = found.flight.clocks / figures(chip, found)["clock_hz"]
    return Measured(
        chip,
        found,
        figures(chip, found),
        spent / seconds,
        motion.state(found.record.states["time"]),
        _damaged(chip, counts[: round(DAMAGED_SECONDS * DESIGN.sensor.sample_rate_hz)], found),
    )


def _damaged(chip: Chip, counts: list[list[int]], whole: Flown) -> Damaged:
    link = DESIGN.front
    assert link is not None
    front, samples = FrontModel(link), list[FrontSample]()

    def wire(number: int, frame: bytes) -> bytes:
        if number in LOST:
            return b""
        if number in CORRUPTED:
            frame = frame[:14] + bytes([frame[14] ^ 0x10]) + frame[15:]
        clock = round((number + 0.4) * link.interval)  # some way into the interval
        for byte in frame:
            samples.extend(front.take(byte, clock))
        return frame

    flight = fly_log(chip.plan, chip.generated, chip.firmware, counts, wire=wire)
    rows = np.array([[*sample.gyro, *sample.accel] for sample in samples], np.int64)
    faults = np.array([sample.fault for sample in samples], np.uint8)
    model = FastModel(DESIGN).feed(rows, faults)
    record = flight.record.first(len(model))
    found = comparison.difference(model, record.results)
    names = ("taken", "bad", "missed", "late", "lost")
    last = len(record.states) - 1
    apart = record.states["place"][last] - whole.record.states["place"][last]
    return Damaged(
        len(record.results),
        len(model) if found is None else found.row,
        int((np.asarray(record.results.status) & 2 > 0).sum()),
        len(record.states),
        dict(zip(names, record.counters[-1].tolist(), strict=True)),
        float(np.linalg.norm(apart * [6.4e6, 6.4e6 * np.cos(0.84), 1.0])),
    )
