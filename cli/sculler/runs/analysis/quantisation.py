"""What the LSB does to the coning correction."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from math import radians
from typing import Any

from sculler.runs.analysis.subject import Subject
from sculler.words import Advance, silent
from sculler_model.analysis import quantisation as analysis
from sculler_model.analysis.advice import PER_HOUR


@dataclass(frozen=True)
class QuantisationPlan:
    """What to study.

    Attributes:
        subjects: by name.
        half_angle: of the cone, degrees.
        frequency: of the cone, Hz.
        levels: how many LSBs, beside a design's own.
        trials: at each LSB.
        seed: of the random numbers.
        requirements: drifts to hold it against, °/h.
    """

    subjects: Mapping[str, Subject]
    half_angle: float = 0.1
    frequency: float = 50.0
    levels: int = 8
    trials: int = 20
    seed: int = 1
    requirements: tuple[float, ...] = ()

    @property
    def steps(self) -> int:
        """What `Advance` is told, at most."""
        return len(self.subjects) * (self.levels + 1) * self.trials


def quantisation_study(plan: QuantisationPlan, *, advance: Advance = silent) -> dict[str, Any]:
    """Mean and deviation of the drift that quantisation adds, °/h, at each LSB, and the theory's.

    Returns:
        What --json prints, but for the picture.
    """
    data: dict[str, Any] = {
        "study": "quantisation",
        "half_angle_deg": plan.half_angle,
        "frequency_hz": plan.frequency,
        "trials": plan.trials,
        "seed": plan.seed,
        "unit": "°/h",
        "requirements": list(plan.requirements),
        "designs": {},
    }
    for name, subject in plan.subjects.items():
        data["designs"][name] = _of_design(plan, subject, advance)
        data["seconds"] = analysis.trial_seconds(subject.design, plan.frequency)
    return data


def _of_design(plan: QuantisationPlan, subject: Subject, advance: Advance) -> dict[str, Any]:
    design, angle = subject.design, radians(plan.half_angle)
    own = None if subject.of_family else design.gyro_scale
    lsbs = analysis.levels(design, angle, plan.frequency, plan.levels)
    rows = []
    for lsb in sorted({*lsbs, *([own] if own and own > lsbs[0] else [])}):
        level = analysis.monte_carlo(
            design, angle, plan.frequency, lsb, plan.trials, plan.seed, advance
        )
        row = asdict(level)
        for key in ("mean", "deviation", "theory"):
            row[key] *= PER_HOUR
        rows.append(row)
    return {"lsb": own, "levels": rows}
