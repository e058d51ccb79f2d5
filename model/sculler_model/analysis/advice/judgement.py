"""Every candidate held against the requirement, and ranked by its cost."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import degrees, hypot, pi, sin

import numpy as np

from sculler_model.analysis.advice.candidates import (
    MAX_TURN,
    WIDEST_BAND,
    Environment,
    Requirement,
    candidates,
)
from sculler_model.analysis.advice.coning import coning_drift
from sculler_model.analysis.advice.cost import Cost, cost
from sculler_model.analysis.vibration import (
    G,
    MountResponse,
    Rectified,
    respond,
    step_for,
)
from sculler_model.design import Design
from sculler_model.errors import InputError

PER_HOUR = degrees(1) * 3600
"""°/h per rad/s."""


@dataclass(frozen=True)
class Candidate:
    """A design, what it leaves, what it takes, and why it will not do.

    Attributes:
        design: the design.
        drift: °/h left of coning, size.
        force: µg left of sculling, size; None where the environment has none.
        cost: what it takes.
        faults: why it fails, in words; none if it meets everything.
        excess: largest ratio of what is left to what is allowed.

    Examples:
        >>> import math, sculler
        >>> coning = sculler.Environment(half_angle=math.radians(0.1), hertz=50)
        >>> base = sculler.Design.preset("stim300")
        >>> found = sculler.advise(base, coning, sculler.Requirement(drift=1e-9), most_samples=1)
        >>> isinstance(found[0], sculler.Candidate), found[0].meets, len(found[0].faults) > 0
        (True, False, True)
    """

    design: Design
    drift: float
    force: float | None
    cost: Cost
    faults: tuple[str, ...]
    excess: float

    @property
    def meets(self) -> bool:
        """Whether it meets the requirement."""
        return not self.faults


def advise(
    base: Design,
    environment: Environment,
    requirement: Requirement,
    *,
    most_samples: int = 6,
    most_history: int = 2,
    slowest: int = 8,
    by: str = "work",
) -> list[Candidate]:
    """Every candidate, those that meet the requirement first and cheapest first.

    Args:
        base: the sensor; its algorithm is not looked at.
        environment: what it must bear.
        requirement: what may be left.
        most_samples, most_history: n and p go up to these.
        slowest: increments are also summed by 2, 4, ... up to this many into slower samples.
        by: the cost that ranks, "work" or "area".

    Raises:
        InputError: there is nothing to hold against a requirement.
    """
    if environment.spectrum is None and not environment.half_angle:
        raise InputError(
            "the environment: neither a vibration nor coning is given, give a spectrum or an"
            " amplitude and a frequency"
        )
    if requirement.drift is None and requirement.force is None:
        raise InputError("the requirement: give °/h, µg or both")
    if environment.spectrum is None and requirement.force is not None:
        raise InputError(
            "the requirement: pure coning has no specific force to leave µg of, give a vibration"
        )
    judge = _Judge(environment, requirement)
    found = [
        judge(design)
        for design in candidates(
            base,
            environment,
            requirement,
            most_samples=most_samples,
            most_history=most_history,
            slowest=slowest,
        )
    ]

    def rank(candidate: Candidate) -> tuple[bool, float]:
        if candidate.meets:
            return False, float(getattr(candidate.cost, by))
        return True, candidate.excess

    return sorted(found, key=rank)


@dataclass(frozen=True)
class _Shaken:
    """The sensor assembly under the environment's vibration.

    Attributes:
        bound: of what that rectifies to, whatever the phases.
        rate_rms, force_rms: about and along an axis at most, rad/s and m/s².
    """

    bound: Rectified
    rate_rms: float
    force_rms: float

    @classmethod
    def under(cls, response: MountResponse) -> _Shaken:
        omega = 2 * np.pi * response.frequency
        swing = response.power * omega**2 * np.maximum(abs(response.y), abs(response.z)) ** 2
        return cls(response.worst_phase, float(np.sqrt(swing.sum())), response.force_rms)


class _Judge:
    """Holds designs against environment and requirement."""

    def __init__(self, environment: Environment, requirement: Requirement) -> None:
        self.environment, self.requirement = environment, requirement
        self._shaken: dict[float, _Shaken] = {}

    def __call__(self, design: Design) -> Candidate:
        drift, force = self._left(design)
        faults = []
        excess = 1.0
        for what, left, allowed, unit in (
            ("coning", drift, self.requirement.drift, "°/h"),
            ("sculling", force, self.requirement.force, "µg"),
        ):
            if allowed is None or left is None:
                continue
            if not left <= allowed:
                faults.append(f"{what} leaves {left:.3g} {unit}, over {allowed:g}")
                excess = max(excess, left / allowed)
        turn = self.environment.peak_rate * design.major_interval
        if turn > MAX_TURN * (1 + 1e-9):
            faults.append(
                f"{degrees(self.environment.peak_rate):g} °/s turns {turn:.2g} rad in"
                f" {1000 * design.major_interval:.3g} ms, over {MAX_TURN:g}"
            )
            excess = max(excess, turn / MAX_TURN)
        results = 1 / design.major_interval
        if results < self.requirement.host_rate * (1 - 1e-9):
            faults.append(f"{results:.3g} results/s, under {self.requirement.host_rate:g}")
            excess = max(excess, self.requirement.host_rate / results)
        for name, needed, full in self._counts(design):
            if needed > full:
                faults.append(f"{name} needs {needed:.3g} counts, the word holds {full:.3g}")
                excess = max(excess, needed / full)
        return Candidate(design, drift, force, cost(design), tuple(faults), excess)

    def _left(self, design: Design) -> tuple[float, float | None]:
        """Sizes of what is left: °/h and µg."""
        T, kind = design.sample_interval, design.sensor.kind
        if self.environment.spectrum is None:
            drift = coning_drift(
                design.table,
                design.algorithm.minors,
                self.environment.half_angle,
                2 * pi * self.environment.hertz,
                T,
                kind,
                design.sensor_response,
            )
            return abs(drift) * PER_HOUR, None
        bound = self._assembly(design).bound
        left = bound.errors(design.table, T, kind, design.sensor_response)
        return left.coning * PER_HOUR, hypot(*left.sculling.tolist()) / G * 1e6

    def _assembly(self, design: Design) -> _Shaken:
        assert self.environment.spectrum is not None
        step = step_for(design.algorithm.samples, design.sensor.sample_rate_hz)
        # the narrower bands are for the poles of rate sensors; increments have none
        if design.sensor.kind == "increment":
            step = WIDEST_BAND
        if step not in self._shaken:
            response = respond(self.environment.spectrum, self.environment.mount, step)
            self._shaken[step] = _Shaken.under(response)
        return self._shaken[step]

    def _counts(self, design: Design) -> Iterator[tuple[str, float, float]]:
        """Largest counts, manoeuvre and three sigma of vibration, and what the words hold."""
        rate, force = self.environment.peak_rate, self.environment.peak_force
        if self.environment.spectrum is not None:
            assembly = self._assembly(design)
            rate += 3 * assembly.rate_rms
            force += 3 * assembly.force_rms
        elif self.environment.half_angle:
            rate += 2 * pi * self.environment.hertz * sin(self.environment.half_angle)
        T = design.sample_interval if design.sensor.kind == "increment" else 1.0
        yield "the gyro", rate * T / design.sensor.gyro.lsb, float(design.words.gyro.hi)
        yield "the accelerometer", force * T / design.sensor.accel.lsb, float(design.words.accel.hi)
