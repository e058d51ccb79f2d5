"""Position by trapezoid or at high resolution: Savage-98's selection, and what each leaves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from math import degrees, radians
from typing import Any

from sculler.runs.analysis.subject import Subject
from sculler.words import Advance, silent
from sculler_model.analysis.position import Conditions, Left, Selection, Term, left, seen, selection
from sculler_model.analysis.vibration import G
from sculler_model.design import Design
from sculler_model.errors import InputError

MOST_SAMPLES = 1_000_000
"""Of a run, which is held in memory whole."""


@dataclass(frozen=True)
class PositionPlan:
    """What to study.

    Attributes:
        subjects: by name; one at least.
        peak_force, force_ramp: g and g/s.
        peak_rate, rate_ramp: °/s and °/s².
        vibration: root mean square (g) and frequency (Hz), or None.
        rocking: amplitude of a rotation in phase with it, °.
        limit, seconds: cm over so long.

    Raises:
        InputError: a rocking without a vibration, or a run that is too long.
    """

    subjects: Mapping[str, Subject]
    peak_force: float = 3.0
    force_ramp: float = 3.0
    peak_rate: float = degrees(1)
    rate_ramp: float = 0.0
    vibration: tuple[float, float] | None = (3.6, 50.0)
    rocking: float = 0.0
    limit: float = 0.01
    seconds: float = 10.0

    def __post_init__(self) -> None:
        if self.rocking and self.vibration is None:
            raise InputError("--rocking goes in phase with a vibration, give --vibration too")
        for name, subject in self.subjects.items():
            sensor = subject.design.sensor
            if sensor.sample_rate_hz * self.seconds > MOST_SAMPLES:
                raise InputError(
                    f"--over: {self.seconds:g} s of {name} are more than {MOST_SAMPLES:,} samples,"
                    " give less"
                )
            if self.vibration and self.vibration[1] >= sensor.sample_rate_hz / 2:
                raise InputError(
                    f"--vibration: {self.vibration[1]:g} Hz is not below the Nyquist limit of"
                    f" {name}, {sensor.sample_rate_hz / 2:g} Hz, give less"
                )

    @property
    def conditions(self) -> Conditions:
        """In SI."""
        rms, hertz = self.vibration or (0.0, 0.0)
        return Conditions(
            force=G * self.peak_force,
            force_ramp=G * self.force_ramp,
            rate=radians(self.peak_rate),
            rate_ramp=radians(self.rate_ramp),
            vibration=G * rms,
            hertz=hertz,
            rocking=radians(self.rocking),
            limit=self.limit / 100,
            seconds=self.seconds,
        )


def position_study(plan: PositionPlan, *, advance: Advance = silent) -> dict[str, Any]:
    """Selection and errors of each design, behind its sensor's filter; lengths in cm.

    Raises:
        InputError: a filter is not known at the vibration's frequency.
    """
    conditions = plan.conditions
    designs = {}
    for name, subject in plan.subjects.items():
        design = subject.design
        shown, missed = seen(design, conditions)
        chosen = selection(shown, design.major_interval)
        designs[name] = _of_design(design, chosen, left(design, shown))
        if design.sensor_response is not None:
            designs[name]["filter_takes"] = 100 * missed
        advance(1)
    given = {key: value for key, value in asdict(plan).items() if key != "subjects"}
    return {"study": "position", "unit": "cm", **given, "designs": designs}


def _of_design(design: Design, chosen: Selection, found: Left) -> dict[str, Any]:
    rate = design.sensor.sample_rate_hz
    return {
        "l_hz": rate,
        "m_hz": rate / design.algorithm.samples,
        "n_hz": 1 / design.major_interval,
        "velocity_rms_cm_per_s": 100 * chosen.velocity_rms,
        "choice": "high-resolution" if chosen.high_resolution else "trapezoid",
        "trapezoid": [_term(term) for term in chosen.trapezoid],
        "terms": [_term(term) for term in chosen.terms],
        "left": {
            key: None if error is None else {k: 100 * v for k, v in asdict(error).items()}
            for key, error in (
                ("trapezoid", found.trapezoid),
                ("exact_integrals", found.exact_integrals),
                ("core", found.core),
            )
        },
    }


def _term(term: Term) -> dict[str, Any]:
    return {
        "name": term.name,
        "each": 100 * term.each,
        "a_second": 100 * term.a_second,
        "systematic": 100 * term.systematic,
        "random": 100 * term.random,
        "over": term.over,
    }
