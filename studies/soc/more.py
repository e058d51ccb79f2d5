"""What else a chip does: it aligns, has order 4, a sensor on SPI, a processor that is too slow."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sculler.library import motions
from sculler.runs.chip import make_chip
from sculler.runs.chip_flight import Flown, differences, figures, flown
from sculler.soc import SocPlan, chip_alignment
from sculler_model.design import Design
from sculler_model.navigation import SensorNoise
from studies.soc.designs import ORDER_FOUR, SLOW, TOO_SLOW, spi_design

ALIGNMENT_S = 10.08
NOISE = SensorNoise(angle_random_walk=4e-5, velocity_random_walk=1e-3)


@dataclass(frozen=True)
class Further:
    """A flight of its own.

    Attributes:
        what: in words.
        plan: of the chip.
        flown: the flight.
        code: bytes of the firmware.
        aligned: rad from Python's attitude, and clocks that the end of the window took; None where
            there is no alignment.
    """

    what: str
    plan: SocPlan
    flown: Flown
    code: int
    aligned: tuple[float, int] | None

    @property
    def came(self) -> int:
        """Results that came."""
        return len(self.flown.record.results)

    @property
    def equal(self) -> int:
        """Of them, the model's of the same number."""
        model = {row[0]: row for row in self.flown.model.rows()}
        return sum(model.get(row[0]) == row for row in self.flown.record.results.rows())

    @property
    def away(self) -> tuple[float, float, float]:
        """Largest differences of the states: rad, m/s, m."""
        return differences(self.flown.record, self.flown.followed)


def further() -> list[Further]:
    """All of them.

    Raises:
        InputError: a tool is missing.
    """
    found = [
        _one("order 4, spinning and coning", ORDER_FOUR, "spin-cone", 5.12),
        _one("a sensor on SPI, by bursts", spi_design("adis16505"), "turn", 1.6),
        _one("a sensor on SPI, register by register", spi_design("adis16488"), "turn", 1.6),
        _one("a processor that is too slow", TOO_SLOW, "turn", 3.2),
    ]
    for fine, name, after in ((False, "coarse", 1.0), (True, "fine", 9.0)):
        what = f"{name} alignment, {ALIGNMENT_S:g} s"
        found.append(_one(what, SLOW, "rest", ALIGNMENT_S + after, fine))
    return found


def _one(what: str, design: Design, name: str, seconds: float, fine: bool | None = None) -> Further:
    motion = motions.motion(name)
    start, align = motion.state(np.zeros(1)).state(0), None
    if fine is not None:
        align = chip_alignment(design, ALIGNMENT_S, fine, NOISE, start.lat)
    plan = SocPlan(design, start, align=align)
    chip = make_chip(plan)
    counts = motions.record(design, motion, seconds).counts.tolist()
    found = flown(chip, counts, [0] * len(counts))
    told = figures(chip, found)["alignments"]
    aligned = (told[0]["from_python_rad"], told[0]["clocks"]) if told else None
    return Further(what, plan, found, chip.firmware.code, aligned)
