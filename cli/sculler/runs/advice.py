"""The designs that meet a requirement, cheapest first: from a plan to an `Outcome`."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from math import radians
from pathlib import Path
from typing import Any, Literal

from sculler_model.analysis.advice import (
    Candidate,
    Environment,
    Requirement,
    advise,
    by_order,
)
from sculler_model.analysis.flight import Profile
from sculler_model.analysis.sensed import require_known
from sculler_model.analysis.vibration import G, Mount, Spectrum
from sculler_model.design import Design
from sculler_model.errors import ContradictionError, InputError
from sculler_model.outputs import replacing

MOST_SAMPLES = 1_000_000
"""Of a run."""


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
        sculling: a classical sculling: half angle (degrees), specific force (g), frequency (Hz).
        force_ramp: fastest change of the specific force, g/s.
        manoeuvre: one of the user's own.
        angle, velocity: what it may leave at its end, degrees and m/s; None for any.
        position: what position may leave, cm; None for any.
        over: s, of the position.

    Raises:
        ContradictionError: not one environment, or no requirement that it can have.
        InputError: a coning that no sensor has, or that this one's filter is not known at.
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
    sculling: tuple[float, float, float] | None = None
    force_ramp: float = 0.0
    manoeuvre: Profile | None = None
    angle: float | None = None
    velocity: float | None = None
    position: float | None = None
    over: float = 10.0

    def __post_init__(self) -> None:
        tones = self.coning is not None or self.sculling is not None
        moved = self.manoeuvre is not None or self.position is not None
        if (self.spectrum is not None and tones) or not (self.spectrum or tones or moved):
            raise ContradictionError(
                "give an environment: --spectrum or --coning and --sculling, or --manoeuvre"
            )
        limits = (self.drift, self.force, self.angle, self.velocity, self.position)
        if all(limit is None for limit in limits):
            raise ContradictionError(
                "give a requirement: --drift, --force, --angle, --velocity, --position or"
                " --nmi-per-hour"
            )
        self._require_partners()
        if self.position is not None and self.over * self._rate > MOST_SAMPLES:
            raise InputError(f"--over: {self.over:g} s is too long for this sensor, give less")
        for flag, tone in (("--coning", self.coning), ("--sculling", self.sculling)):
            if tone is None:
                continue
            angle, hertz = tone[0], tone[-1]
            if angle > 45:
                raise InputError(f"{flag}: {angle:g}° is not allowed, give at most 45")
            if hertz >= self._rate / 2:
                raise InputError(
                    f"{flag}: {hertz:g} Hz is not below the Nyquist limit of {self._rate / 2:g} Hz,"
                    " give less"
                )
            require_known(self.base, hertz, flag)

    def _require_partners(self) -> None:
        """See that what is asked of something comes with it.

        Raises:
            ContradictionError: it does not.
        """
        shaken = self.spectrum is not None
        if self.force is not None and not shaken and self.sculling is None:
            raise ContradictionError(
                "--force needs --spectrum or --sculling: pure coning has no specific force"
            )
        if self.drift is not None and not shaken and self.coning is None:
            raise ContradictionError("--drift needs --spectrum or --coning")
        for flag in ("angle", "velocity"):
            if getattr(self, flag) is not None and self.manoeuvre is None:
                raise ContradictionError(f"--{flag} needs --manoeuvre")
        moving = self.peak_force or self.force_ramp or self.manoeuvre or self.sculling or shaken
        if self.position is not None and not moving:
            raise ContradictionError(
                "--position needs --peak-force, --manoeuvre, --sculling or --spectrum"
            )

    @property
    def _rate(self) -> float:
        return self.base.sensor.sample_rate_hz

    @property
    def environment(self) -> Environment:
        """In SI."""
        half_angle, hertz = self.coning or (0.0, 0.0)
        angle, force, sculling_hertz = self.sculling or (0.0, 0.0, 0.0)
        peaks = (0.0, 0.0) if self.manoeuvre is None else self.manoeuvre.peaks
        return Environment(
            spectrum=self.spectrum,
            mount=self.mount,
            half_angle=radians(half_angle),
            hertz=hertz,
            peak_rate=max(radians(self.peak_rate), peaks[0]),
            peak_force=max(G * self.peak_force, peaks[1]),
            sculling_angle=radians(angle),
            sculling_force=G * force,
            sculling_hertz=sculling_hertz,
            force_ramp=G * self.force_ramp,
            manoeuvre=self.manoeuvre,
        )

    @property
    def requirement(self) -> Requirement:
        """In SI."""
        position = None if self.position is None else self.position / 100
        return Requirement(
            self.drift,
            self.force,
            self.host_rate,
            self.angle,
            self.velocity,
            position,
            self.over,
        )


@dataclass(frozen=True)
class Outcome:
    """What was found.

    Attributes:
        base: the design whose sensor it is.
        meet: the designs that meet the requirement, cheapest first.
        fail: the others, the nearest first.
        orders: the cheapest, or else the nearest, with each order; where the order matters.
    """

    base: Design
    meet: list[Candidate]
    fail: list[Candidate]
    orders: list[Candidate] = field(default_factory=list)

    def as_json(self) -> dict[str, Any]:
        """Plain data."""
        return {
            "sensor": self.base.name,
            "meet": [_as_json(candidate) for candidate in self.meet],
            "fail": [_as_json(candidate) for candidate in self.fail],
            "orders": [_as_json(candidate) for candidate in self.orders],
        }


def find_designs(plan: Plan) -> Outcome:
    """Try families, n, p and slower samples, and sort them by cost."""
    environment, requirement = plan.environment, plan.requirement
    found = advise(plan.base, environment, requirement, by=plan.by)
    meet = [candidate for candidate in found if candidate.meets]
    fail = [candidate for candidate in found if not candidate.meets]
    # a vibration's bound is of second order, and position is not of any
    if environment.spectrum is None and (environment.half_angle or environment.manoeuvre):
        best = next((one for one in found if one.design.algorithm.position is None), None)
        orders = [] if best is None else by_order(best, environment, requirement)
        return Outcome(plan.base, meet, fail, orders)
    return Outcome(plan.base, meet, fail)


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
        "order": design.order,
        "sample_rate_hz": design.sensor.sample_rate_hz,
        "minor_rate_hz": design.sensor.sample_rate_hz / design.algorithm.samples,
        "major_rate_hz": 1 / design.major_interval,
        "position": design.algorithm.position,
        "angle_deg": candidate.angle,
        "velocity_m_per_s": candidate.velocity,
        "position_cm": None if candidate.position is None else 100 * candidate.position,
        "drift_deg_per_h": candidate.drift,
        "force_ug": candidate.force,
        "cost": asdict(candidate.cost),
        "faults": list(candidate.faults),
        "design": design.as_json(),
    }
