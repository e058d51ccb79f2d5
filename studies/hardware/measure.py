"""What Yosys and nextpnr find of the points, and of the design space."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sculler.words import Advance, silent
from sculler_model.errors import InputError
from sculler_sim.place.placement import Placement
from studies.hardware.kept import Kept
from studies.hardware.points import Point, variant

SEEDS = (1, 2, 3)


def measure(chosen: Sequence[Point], kept: Kept, advance: Advance) -> list[tuple[Point, Placement]]:
    """Place the points that changed, one after the other, each with its seeds side by side."""
    return [
        (point, kept.place(point.design, point.device, point.speed, SEEDS, advance))
        for point in chosen
    ]


BUDGETS = (None, 28, 16, 12, 8, 6, 4)
"""Multipliers of the pipelined core in the picture of the design space."""


@dataclass(frozen=True)
class Corner:
    """A core in the design space, synthesised and packed but not placed.

    Attributes:
        name: for the picture.
        multipliers: multiplier blocks it takes.
        luts: look-up tables it takes.
        clocks: between samples in the long run.
    """

    name: str
    multipliers: int
    luts: int
    clocks: float


def design_space(kept: Kept, advance: Advance = silent) -> list[Corner]:
    """The 24-bit core with ever fewer multipliers, in an ECP5."""
    designs = [
        (
            "as many as it takes" if budget is None else f"at most {budget}",
            {"core": "pipelined"} | ({} if budget is None else {"multipliers": budget}),
        )
        for budget in BUDGETS
    ]
    designs += [
        ("compact", {"core": "compact"}),
        ("compact, none", {"core": "compact", "multipliers": 0}),
    ]
    corners: list[Corner] = []
    for name, hardware in designs:
        try:
            design = variant(24, "corner", target="ecp5", **hardware)
            found = kept.place(design, "LFE5U-85F", None, (), silent)
        except InputError:
            if hardware["core"] == "compact" or "multipliers" not in hardware:
                raise
            continue  # too few for the pipelined core
        finally:
            advance(1)
        corner = Corner(name, found.area.multipliers, found.area.luts, found.clocks_per_sample)
        if all((corner.multipliers, corner.clocks) != (c.multipliers, c.clocks) for c in corners):
            corners.append(corner)
    return corners
