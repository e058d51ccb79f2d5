"""Attitude error over a manoeuvre, against the update rate."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Any

from sculler.runs.analysis.subject import Subject
from sculler.words import Advance, silent
from sculler_model.analysis.iteration import DEGREE
from sculler_model.analysis.manoeuvre import MANOEUVRES, split, update_minors

REQUIREMENT = 0.07
"""µrad: 4e-6 °, for all manoeuvres of a flight of 0.1 nmph navigation (Savage-20)."""


@dataclass(frozen=True)
class ManoeuvrePlan:
    """What to study.

    Attributes:
        subjects: by name.
        manoeuvre: of `sculler_model.analysis.manoeuvre.MANOEUVRES`.
        low, high: update rates, Hz.
        fine: run designs, too, on a sensor so fine that it does not show.
        degree: of the polynomial that the samples are iterated on.
    """

    subjects: Mapping[str, Subject]
    manoeuvre: str = "extreme"
    low: float = 50.0
    high: float = 400.0
    fine: bool = False
    degree: int = DEGREE

    @cached_property
    def minors(self) -> dict[str, list[int]]:
        """By name, the numbers M that give an update rate in the band.

        Raises:
            InputError: there is none.
        """
        return {
            name: list(update_minors(subject.design, self.low, self.high))
            for name, subject in self.subjects.items()
        }

    @property
    def steps(self) -> int:
        """What `Advance` is told in all."""
        return sum(map(len, self.minors.values()))


def manoeuvre_study(plan: ManoeuvrePlan, *, advance: Advance = silent) -> dict[str, Any]:
    """The attitude error of each subject at each update rate, µrad, and its sources.

    Returns:
        What --json prints, but for the picture.
    """
    manoeuvre = MANOEUVRES[plan.manoeuvre]
    designs: dict[str, Any] = {}
    for name, subject in plan.subjects.items():
        own = not (plan.fine or subject.of_family)
        rows = []
        for M in plan.minors[name]:
            rows.append(asdict(split(subject.design, manoeuvre, M, own, plan.degree)))
            advance(1)
        designs[name] = {"sensor": "own" if own else "fine", "updates": rows}
    return {
        "study": "manoeuvre",
        "manoeuvre": plan.manoeuvre,
        "seconds": manoeuvre.duration,
        "peak_deg_per_s": manoeuvre.peak_degrees(),
        "unit": "µrad",
        "degree": plan.degree,
        "requirement": REQUIREMENT,
        "profile": manoeuvre.profile(201),
        "designs": designs,
    }
