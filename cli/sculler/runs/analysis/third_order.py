"""Coning in a turn: what the triple products leave, and what mends them."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from math import degrees, radians
from typing import Any

from sculler.runs.analysis.subject import (
    require_below_nyquist,
    require_increments,
    require_whole_interval,
)
from sculler.words import Advance, silent
from sculler_model.analysis.iteration import DEGREE
from sculler_model.analysis.triple import ConingTurn, left
from sculler_model.design import Design


@dataclass(frozen=True)
class ThirdOrderPlan:
    """What to study.

    Attributes:
        design: gives samples and coefficients; its sensor counts increments.
        name: of the design, for messages.
        half_angle: of the cone, degrees.
        frequency: of the cone, Hz.
        turn: rate about the vertical, °/s.
        bank: in the turn, degrees.
        minors: numbers of minor intervals of a major one.
        seconds: length of the run.
        spin: rate about the axis that goes round the cone, °/s.
        degree: of the polynomial that the samples are iterated on.

    Raises:
        InputError: the design or the motion does not fit the study.
    """

    design: Design
    name: str
    half_angle: float = 0.1
    frequency: float = 50.0
    turn: float = 0.0
    bank: float = 0.0
    minors: tuple[int, ...] = (1, 2, 5, 10)
    seconds: float = 20.0
    spin: float = 0.0
    degree: int = DEGREE

    def __post_init__(self) -> None:
        require_increments(self.design, self.name)
        require_below_nyquist(self.design, self.frequency)
        require_whole_interval(self.seconds, self.minors, self.minor_interval)

    @property
    def minor_interval(self) -> float:
        """Seconds."""
        return self.design.algorithm.samples * self.design.sample_interval


def third_order_study(plan: ThirdOrderPlan, *, advance: Advance = silent) -> dict[str, Any]:
    """Attitude drift for each M, °/h.

    Returns:
        What --json prints.
    """
    motion = ConingTurn(
        radians(plan.half_angle),
        plan.frequency,
        radians(plan.turn),
        radians(plan.bank),
        radians(plan.spin),
    )
    rows = []
    for found in left(plan.design, motion, plan.minors, plan.seconds, plan.degree):
        row = asdict(found)
        rows.append({k: v if k == "minors" else degrees(v) * 3600 for k, v in row.items()})
        advance(1)
    return {
        "study": "third-order",
        "design": plan.design.name,
        "half_angle_deg": plan.half_angle,
        "frequency_hz": plan.frequency,
        "turn_deg_per_s": plan.turn,
        "bank_deg": plan.bank,
        "spin_deg_per_s": plan.spin,
        "degree": plan.degree,
        "seconds": plan.seconds,
        "unit": "deg/h",
        "minors": rows,
    }
