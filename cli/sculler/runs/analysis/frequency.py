"""Drift left of coning or sculling, against its frequency."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cached_property
from math import degrees, pi, radians
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from sculler.runs.analysis.subject import Subject
from sculler.words import Advance, silent
from sculler_model.analysis import frequency as analysis
from sculler_model.analysis.oscillation import Cone, Oscillation, Scull
from sculler_model.analysis.sensed import known_hz
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.frames import STANDARD_GRAVITY

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Kind:
    """How a study speaks of its drift.

    Attributes:
        verb: what rectifies.
        title: of the picture.
        unit: of drifts.
        scale: units per rad/s or m/s².
        complete: what the host arrives at.
        vibration: the motion.
    """

    verb: Literal["coning", "sculling"]
    title: str
    unit: str
    scale: float
    complete: str
    vibration: Oscillation


def coning(half_angle: float) -> Kind:
    """Coning of a half angle, degrees; drifts in °/h about the cone's axis."""
    return Kind(
        "coning",
        f"Drift left of {half_angle:g}° coning",
        "°/h",
        degrees(1) * 3600,
        "host's attitude",
        Cone(radians(half_angle)),
    )


def sculling(angle: float, force: float) -> Kind:
    """Sculling of an angle (degrees) and a specific force (m/s²); drifts in µg."""
    return Kind(
        "sculling",
        f"Acceleration left of sculling, {angle:g}° with {force:g} m/s²",
        "µg",
        1e6 / STANDARD_GRAVITY,
        "host's velocity",
        Scull(radians(angle), force),
    )


@dataclass(frozen=True)
class FrequencyPlan:
    """What to study.

    Attributes:
        kind: the motion, and the words.
        subjects: by name.
        low: lowest frequency, Hz.
        high: highest frequency, Hz; None is the Nyquist limit of the fastest design.  No design is
            studied above its own, or above the end of its sensor's measured response.
        points, integer_points: how many frequencies by closed form and through the integer path.
        fine: run designs, too, on a sensor so fine that it does not show.
        requirements: drifts in the kind's unit.
        degree: of the polynomial that the samples are iterated on; None for none.

    Raises:
        InputError: the band is empty for a design.
    """

    kind: Kind
    subjects: Mapping[str, Subject]
    low: float = 1.0
    high: float | None = None
    points: int = 1000
    integer_points: int = 10
    fine: bool = False
    requirements: tuple[float, ...] = ()
    degree: int | None = None

    def __post_init__(self) -> None:
        fastest = max(self.nyquist.values())
        if self.top > fastest:
            raise InputError(
                f"--to: {self.top:g} Hz is above the Nyquist limit of {fastest:g} Hz, give less"
            )
        for name, subject in self.subjects.items():
            limit = known_hz(subject.design)
            if self.low >= min(self.top, limit):
                raise InputError(
                    f"--from: {self.low:g} Hz leaves no band below {min(self.top, limit):g} Hz for"
                    f" {name}, give less"
                )

    @cached_property
    def nyquist(self) -> dict[str, float]:
        """Hz, by name."""
        return {name: s.design.sensor.sample_rate_hz / 2 for name, s in self.subjects.items()}

    @property
    def top(self) -> float:
        """The highest frequency, Hz."""
        return self.high or max(self.nyquist.values())

    @property
    def steps(self) -> int:
        """What `Advance` is told in all."""
        return len(self.subjects) * (self.integer_points + 2)


def frequency_study(plan: FrequencyPlan, *, advance: Advance = silent) -> dict[str, Any]:
    """Drift, computed minus true: by closed form, and through the integer path.

    Returns:
        What --json prints, but for the picture.
    """
    kind = plan.kind
    hertz = np.geomspace(plan.low, plan.top, plan.points)
    return {
        "study": kind.verb,
        "vibration": asdict(kind.vibration),
        "unit": kind.unit,
        "requirements": list(plan.requirements),
        **({} if plan.degree is None else {"degree": plan.degree}),
        "frequency_hz": hertz.tolist(),
        "uncorrected": (kind.scale * analysis.uncorrected(kind.vibration, hertz)).tolist(),
        "designs": {
            name: _of_design(plan, subject, plan.nyquist[name], hertz, advance)
            for name, subject in plan.subjects.items()
        },
    }


def _of_design(
    plan: FrequencyPlan, subject: Subject, nyquist: float, hertz: Array, advance: Advance
) -> dict[str, Any]:
    kind, design = plan.kind, subject.design
    top = min(plan.top, known_hz(design))
    inside = np.where(hertz <= top, hertz, np.nan)
    curve = kind.scale * analysis.drift(design, kind.vibration, inside)
    law = analysis.law(design, kind.vibration)
    advance(2)
    own_sensor = not (plan.fine or subject.of_family)
    measured, too_large = _integer_points(plan, design, own_sensor, top, advance)
    return {
        "nyquist_hz": nyquist,
        "sensor": "own" if own_sensor else "fine",
        "drift": [None if np.isnan(x) else x for x in curve.tolist()],
        "law": {
            "constant": None if law.constant is None else str(law.constant),
            "order": law.order,
            "measured_constant": law.measured_constant,
            "measured_order": law.measured_order,
            "measured_hz": [p / (2 * pi * design.sample_interval) for p in law.phases],
        },
        "meets_up_to_hz": [_meets_up_to(hertz, curve, limit) for limit in plan.requirements],
        "integer_path": [
            {
                **asdict(point),
                **{
                    key: kind.scale * getattr(point, key)
                    for key in ("closed_form", "second_order", "complete")
                },
                **_iterated(plan, design, point.hertz),
            }
            for point in measured
        ],
        "does_not_fit_sensor_hz": too_large,
    }


def _iterated(plan: FrequencyPlan, design: Design, hertz: float) -> dict[str, float]:
    """What the samples allow at a point's frequency, in the kind's unit."""
    if plan.degree is None:
        return {}
    drift = analysis.iteration_drift(design, plan.kind.vibration, hertz, plan.degree)[1]
    return {"iteration": plan.kind.scale * drift}


def _integer_points(
    plan: FrequencyPlan, design: Design, own_sensor: bool, high: float, advance: Advance
) -> tuple[list[Any], list[float]]:
    """Points through the integer path, and the frequencies that do not fit the sensor."""
    vibration = plan.kind.vibration
    if not own_sensor:
        design = analysis.fine(design, vibration, high)
    measured, too_large = [], []
    for hertz in np.geomspace(plan.low, 0.95 * high, plan.integer_points).tolist():
        if analysis.fits(design, vibration, hertz):
            measured.append(analysis.integer_point(design, vibration, hertz))
        else:
            too_large.append(hertz)
        advance(1)
    return measured, too_large


def _meets_up_to(hertz: Array, drift: Array, limit: float) -> float | None:
    """The highest frequency up to which the drift stays within a limit; None if it never does."""
    over = np.flatnonzero(~(np.abs(drift) <= limit))
    if len(over) == 0:
        return float(hertz[-1])
    return float(hertz[over[0] - 1]) if over[0] else None
