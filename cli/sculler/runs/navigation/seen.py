"""What a run of the navigator came by, and the words for it."""

from __future__ import annotations

from dataclasses import dataclass, field

from sculler.words import plural
from sculler_model.design import STATUS_FAULT, STATUS_LOST, STATUS_RAIL, STATUS_UPSET
from sculler_model.navigation import Alignment, FineAlignment, NavState

STATUSES = {
    "fault_results": (STATUS_FAULT, "with faulty samples (status bit 1)"),
    "rail_results": (STATUS_RAIL, "with a count at its rail (status bit 2)"),
    "lost_results": (STATUS_LOST, "after samples that were lost (status bit 3)"),
    "upset_results": (STATUS_UPSET, "that an upset may have spoilt (status bit 4)"),
}
"""By key in JSON: status bits that are told, and what they say of a result."""

BEFORE, NOTHING = "before the run", "nothing is navigated after it, for the truth begins later"
FROM_TRUTH, ALIGNED = "begun anew from the truth", "aligned anew"
CARRIED = "attitude and velocity are taken over it, the position goes on with the velocity"
"""What became of a break."""

BREAKS_TOLD = 5
"""Breaks that get a warning of their own; the others are counted."""


@dataclass
class Seen:
    """What a run came by.

    Attributes:
        start, end: its first and last state.
        alignment, fine: at its beginning.
        statuses: by key of `STATUSES`, how many of the results used carry it, and when the first
            of them ends.
        left_out: results of short history at the beginning that the run begins after.
        breaks: as plain data.
        third_order: intervals that the third order corrected, and those it left as they are.
        warnings: what to look at before trusting the run.
    """

    start: NavState | None = None
    end: NavState | None = None
    alignment: Alignment | None = None
    fine: FineAlignment | None = None
    statuses: dict[str, tuple[int, float]] = field(default_factory=dict)
    left_out: int = 0
    breaks: list[dict[str, float | int | str]] = field(default_factory=list)
    third_order: tuple[int, int] = (0, 0)
    warnings: list[str] = field(default_factory=list)

    def status_warnings(self) -> list[str]:
        """Each status bit that results carried, in words."""
        return [
            f"{plural(count, 'result')} {STATUSES[key][1]}, the first one ends at {time:.15g} s"
            for key, (count, time) in self.statuses.items()
        ]
