"""The designs that meet a requirement, cheapest first: from a plan to an `Outcome`."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from math import radians
from pathlib import Path
from typing import Any, Literal

from sculler_model.analysis.advice import Candidate, Environment, Requirement, advise
from sculler_model.analysis.vibration import G, Mount, Spectrum
from sculler_model.design import Design
from sculler_model.errors import ContradictionError, InputError
from sculler_model.outputs import replacing


@dataclass(frozen=True)
class Plan:
    """What is asked for.

    Attributes:
        base: the design whose sensor it is.
        mount: that the spectrum passes.
        spectrum: a vibration; or
        coning: a classical coning, half angle (degrees) and frequency (Hz).
        peak_rate: fastest turn, °/s.
        peak_force: largest specific force of manoeuvres, g.
        drift: what coning may leave, °/h; None for any.
        force: what sculling may leave, µg; None for any.
        host_rate: results a second that the host wants at least.
        by: cheapest by what.

    Raises:
        ContradictionError: not one environment, or no requirement that it can have.
        InputError: a coning that no sensor has.
    """

    base: Design
    mount: Mount
    spectrum: Spectrum | None = None
    coning: tuple[float, float] | None = None
    peak_rate: float = 200.0
    peak_force: float = 0.0
    drift: float | None = None
    force: float | None = None
    host_rate: float = 100.0
    by: Literal["work", "area"] = "work"

    def __post_init__(self) -> None:
        if (self.spectrum is None) == (self.coning is None):
            raise ContradictionError("give an environment: --spectrum or --coning")
        if self.drift is None and self.force is None:
            raise ContradictionError("give a requirement: --drift, --force or both")
        if self.coning is None:
            return
        half_angle, hertz = self.coning
        if self.force is not None:
            raise ContradictionError("--force needs --spectrum: pure coning has no specific force")
        if half_angle > 45:
            raise InputError(f"--coning: {half_angle:g}° is not allowed, give at most 45")
        nyquist = self.base.sensor.sample_rate_hz / 2
        if hertz >= nyquist:
            raise InputError(
                f"--coning: {hertz:g} Hz is not below the Nyquist limit of {nyquist:g} Hz,"
                " give less"
            )

    @property
    def environment(self) -> Environment:
        """In SI."""
        half_angle, hertz = self.coning or (0.0, 0.0)
        return Environment(
            spectrum=self.spectrum,
            mount=self.mount,
            half_angle=radians(half_angle),
            hertz=hertz,
            peak_rate=radians(self.peak_rate),
            peak_force=G * self.peak_force,
        )


@dataclass(frozen=True)
class Outcome:
    """What was found.

    Attributes:
        base: the design whose sensor it is.
        meet: the designs that meet the requirement, cheapest first.
        fail: the others, the nearest first.
    """

    base: Design
    meet: list[Candidate]
    fail: list[Candidate]

    def as_json(self) -> dict[str, Any]:
        """Plain data."""
        return {
            "sensor": self.base.name,
            "meet": [_as_json(candidate) for candidate in self.meet],
            "fail": [_as_json(candidate) for candidate in self.fail],
        }


def find_designs(plan: Plan) -> Outcome:
    """Try families, n, p and slower samples, and sort them by cost."""
    requirement = Requirement(plan.drift, plan.force, plan.host_rate)
    found = advise(plan.base, plan.environment, requirement, by=plan.by)
    meet = [candidate for candidate in found if candidate.meets]
    return Outcome(plan.base, meet, [candidate for candidate in found if not candidate.meets])


def write_design(path: Path, design: Design) -> None:
    """The design as a file that `sculler` reads."""
    data = design.as_json()
    lines = ["# found by sculler advise", f"name = {_toml(data.pop('name'))}"]
    for part, values in data.items():
        lines += ["", f"[{part}]", *(f"{key} = {_toml(value)}" for key, value in values.items())]
    with replacing(path) as temporary:
        temporary.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _toml(value: Any) -> str:
    """A value on one line of TOML."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {_toml(item)}" for key, item in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(_toml, value)) + "]"
    return json.dumps(value)  # strings, numbers and booleans are written alike


def _as_json(candidate: Candidate) -> dict[str, Any]:
    design = candidate.design
    return {
        "name": design.name,
        "family": design.algorithm.family,
        "samples": design.algorithm.samples,
        "history": design.algorithm.history,
        "minors": design.algorithm.minors,
        "sample_rate_hz": design.sensor.sample_rate_hz,
        "drift_deg_per_h": candidate.drift,
        "force_ug": candidate.force,
        "cost": asdict(candidate.cost),
        "faults": list(candidate.faults),
        "design": design.as_json(),
    }
