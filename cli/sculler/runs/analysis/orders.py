"""What each order of rotation vector and velocity leaves at the end of a motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from math import degrees, radians
from typing import Any

from sculler.runs.analysis.subject import (
    require_below_nyquist,
    require_increments,
    require_whole_interval,
)
from sculler.words import Advance, silent
from sculler_model.analysis.manoeuvre import MANOEUVRES
from sculler_model.analysis.orders import HeldConing, Manoeuvred, left_by_order
from sculler_model.analysis.triple import ConingTurn
from sculler_model.design import Design
from sculler_model.errors import ContradictionError


@dataclass(frozen=True)
class OrdersPlan:
    """What to study.

    Attributes:
        design: gives sample rate and coefficients; its sensor counts increments.
        name: of the design, for messages.
        half_angle: of the cone, degrees.
        frequency: of the cone, Hz.
        turn: rate about the vertical, °/s.
        bank: in the turn, degrees.
        spin: about the axis that goes round the cone, °/s.
        manoeuvre: a name of `MANOEUVRES`, in place of the cone.
        minors: numbers of minor intervals of a major one.
        seconds: length of the run; 10, or that of the manoeuvre, if left out.

    Raises:
        InputError: the design or the motion does not fit the study.
        ContradictionError: a manoeuvre and a part of a cone.
    """

    design: Design
    name: str
    half_angle: float | None = None
    frequency: float | None = None
    turn: float | None = None
    bank: float | None = None
    spin: float | None = None
    manoeuvre: str | None = None
    minors: tuple[int, ...] = (1, 5)
    seconds: float | None = None

    def __post_init__(self) -> None:
        require_increments(self.design, self.name)
        if self.manoeuvre is not None:
            for key in ("half_angle", "frequency", "turn", "bank", "spin"):
                if getattr(self, key) is not None:
                    raise ContradictionError(
                        f"--{key.replace('_', '-')} is of a cone, leave it out with --manoeuvre"
                    )
        else:
            require_below_nyquist(self.design, self.cone.hertz)
        require_whole_interval(self.length, self.minors, self.minor_interval)

    @property
    def cone(self) -> ConingTurn:
        """The cone, if it is one: 45° at 10 Hz if nothing is said."""
        half_angle, frequency = self.half_angle, self.frequency
        return ConingTurn(
            radians(45.0 if half_angle is None else half_angle),
            10.0 if frequency is None else frequency,
            radians(self.turn or 0.0),
            radians(self.bank or 0.0),
            radians(self.spin or 0.0),
        )

    @property
    def motion(self) -> HeldConing | Manoeuvred:
        """What the body does."""
        if self.manoeuvre is None:
            return HeldConing(self.cone)
        return Manoeuvred(MANOEUVRES[self.manoeuvre])

    @property
    def length(self) -> float:
        """Of the run, s."""
        if self.seconds is not None:
            return self.seconds
        return 10.0 if self.manoeuvre is None else MANOEUVRES[self.manoeuvre].duration

    @property
    def minor_interval(self) -> float:
        """Seconds."""
        return self.design.algorithm.samples * self.design.sample_interval

    def told(self) -> str:
        """The motion in words."""
        if self.manoeuvre is not None:
            return f"manoeuvre {self.manoeuvre}"
        cone = self.cone
        said = f"{degrees(cone.half_angle):g}° coning at {cone.hertz:g} Hz"
        said += f" in a {degrees(cone.turn):g} °/s turn" if cone.turn else ""
        return said + (f", spin {degrees(cone.spin):g} °/s" if cone.spin else "")


def orders_study(plan: OrdersPlan, *, advance: Advance = silent) -> dict[str, Any]:
    """Attitude (″) and velocity (m/s) for each M and order.

    Returns:
        What --json prints.

    Raises:
        InputError: the design can have no third order.
    """
    rows = []
    for found in left_by_order(plan.design, plan.motion, plan.minors, plan.length):
        row = asdict(found)
        for key in ("attitude", "largest", "iteration"):
            row[f"{key}_arcsec"] = degrees(row.pop(key)) * 3600
        rows.append({"hand_over_hz": 1 / (found.minors * plan.minor_interval), **row})
        advance(1)
    return {
        "study": "orders",
        "design": plan.design.name,
        "motion": plan.told(),
        "seconds": plan.length,
        "orders": rows,
        "warnings": _warnings(rows),
    }


_FLOOR_ARCSEC = 1e-5
"""What counts of 32 bits allow, and some more."""


def _warnings(rows: Sequence[dict[str, Any]]) -> list[str]:
    """Where a higher order leaves more attitude error than a lower one, and what to take there."""
    told = []
    for M in dict.fromkeys(row["minors"] for row in rows):
        left = {row["order"]: row["largest_arcsec"] for row in rows if row["minors"] == M}
        best = min(left, key=lambda order: left[order])
        for order in (3, 4):
            lower = min(range(2, order), key=lambda order: left[order])
            if left[order] > 1.02 * left[lower] + _FLOOR_ARCSEC:
                told.append(
                    f"M = {M}: order {order} leaves {left[order]:.2g}\N{DOUBLE PRIME} where order"
                    f" {lower} leaves {left[lower]:.2g}\N{DOUBLE PRIME}, take order {best} or a"
                    " shorter major interval"
                )
    return told
