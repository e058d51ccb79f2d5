"""Every candidate held against the requirement, and ranked by its cost."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import degrees, hypot, pi, sin, sqrt

import numpy as np

from sculler_model.algorithms import ORDERS
from sculler_model.analysis import frequency
from sculler_model.analysis.advice.candidates import (
    MAX_TURN,
    WIDEST_BAND,
    Environment,
    Requirement,
    candidates,
)
from sculler_model.analysis.advice.coning import coning_drift
from sculler_model.analysis.advice.cost import Cost, cost
from sculler_model.analysis.advice.paths import Path, Paths
from sculler_model.analysis.oscillation import Scull
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
        angle, velocity: left of the environment's manoeuvre, ° and m/s; None where there is none,
            or where the design fails otherwise.
        position: left of position, m, likewise.

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
    angle: float | None = None
    velocity: float | None = None
    position: float | None = None

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
    _require_a_question(environment, requirement)
    judge = _Judge(environment, requirement)
    found = [
        candidate
        for design in candidates(
            base,
            environment,
            requirement,
            most_samples=most_samples,
            most_history=most_history,
            slowest=slowest,
        )
        for candidate in judge.variants(design)
    ]

    def rank(candidate: Candidate) -> tuple[bool, float, float]:
        if candidate.meets:
            # of two that cost the FPGA alike, what spares the host
            return False, float(getattr(candidate.cost, by)), 1 / candidate.design.major_interval
        return True, candidate.excess, 0.0

    return sorted(found, key=rank)


def by_order(
    candidate: Candidate, environment: Environment, requirement: Requirement
) -> list[Candidate]:
    """A design with each order that it can have: what is left of its motion, and its cost.

    Under a vibration the order makes no difference to what is left: the bound is of second order.

    Args:
        candidate: the design, of any order.
        environment, requirement: as for `advise`.
    """
    judge = _Judge(environment, requirement)
    plain = candidate.design.as_json()
    plain["name"] = candidate.design.name.split("_order_")[0]
    plain["algorithm"].pop("order", None)
    designs = (of_order(Design.parse(plain), order) for order in ORDERS)
    return [judge(design) for design in designs if design is not None]


def _require_a_question(environment: Environment, requirement: Requirement) -> None:
    """See that environment and requirement go together.

    Raises:
        InputError: they do not; says what is missing.
    """
    e, r = environment, requirement
    asked = (r.drift, r.force, r.angle, r.velocity, r.position)
    if all(limit is None for limit in asked):
        raise InputError(
            "the requirement: give °/h, µg or both, or what manoeuvres and position may leave"
        )
    shaken = e.spectrum is not None
    if not (shaken or e.half_angle or e.sculling_angle or e.manoeuvre or e.peak_force):
        raise InputError(
            "the environment: neither a vibration nor coning is given, give a spectrum or an"
            " amplitude and a frequency"
        )
    if r.force is not None and not (shaken or e.sculling_angle):
        raise InputError(
            "the requirement: pure coning has no specific force to leave µg of, give a vibration"
        )
    if r.drift is not None and not (shaken or e.half_angle):
        raise InputError(
            "the requirement: there is no coning to leave °/h of, give coning or a vibration"
        )
    if (r.angle is not None or r.velocity is not None) and e.manoeuvre is None:
        raise InputError(
            "the requirement: attitude and velocity at the end of a manoeuvre need one, give it"
        )
    still = not (e.peak_force or e.force_ramp or e.sculling_force or e.manoeuvre)
    if r.position is not None and still and not shaken:
        raise InputError(
            "the requirement: nothing moves the position, give a peak force, a manoeuvre, sculling"
            " or a vibration"
        )


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


def _variant(design: Design, minors: int, fine: bool = False) -> Design:
    """A candidate with another M, or with high-resolution position too; its name says so."""
    data = design.as_json()
    before = f"_x{design.algorithm.minors}_"
    data["name"] = design.name.replace(before, f"_x{minors}_") + "_fine" * fine
    data["algorithm"] |= {"minors": minors} | ({"position": "high-resolution"} if fine else {})
    return Design.parse(data)


def of_order(design: Design, order: int) -> Design | None:
    """A candidate with another order, as its name says; None where it can have no such order.

    Args:
        design: of second order.
        order: 2, 3 or 4.
    """
    data = design.as_json()
    data["name"] = design.name if order == 2 else f"{design.name}_order_{order}"
    data["algorithm"]["order"] = order
    try:
        return Design.parse(data)
    except InputError:
        return None


class _Judge:
    """Holds designs against environment and requirement."""

    def __init__(self, environment: Environment, requirement: Requirement) -> None:
        self.environment, self.requirement = environment, requirement
        self._shaken: dict[float, _Shaken] = {}
        shaking = environment.sculling_force / sqrt(2), environment.sculling_hertz
        random = environment.spectrum is not None
        if environment.spectrum is not None:  # as Savage-98 has it, about the mount's resonance
            response = respond(environment.spectrum, environment.mount, WIDEST_BAND)
            shaking = response.force_rms, environment.mount.hz
        self._paths = Paths(environment, requirement, shaking, random)
        r = requirement
        self._has_path = not (r.angle is None and r.velocity is None and r.position is None)

    def variants(self, design: Design) -> Iterator[Candidate]:
        """The design; and if coning, manoeuvres or position are too much for it, what mends that.

        Third and fourth order mend coning and manoeuvres; high-resolution position position; a
        smaller M, whose results come more often, manoeuvres and position.
        """
        first = self(design)
        yield first
        if self._orders_help(first):
            for order in ORDERS[1:]:
                higher = of_order(design, order)
                if higher is not None:
                    found = self(higher)
                    yield found
                    if found.meets:
                        break
        if first.meets or (first.angle is None and first.position is None):
            return
        position = self.requirement.position
        over = position is not None and first.position is not None and first.position > position
        bases = [design]
        if over and design.sensor.kind == "increment":
            fine = _variant(design, design.algorithm.minors, fine=True)
            found = self(fine)
            yield found
            bases += [] if found.meets else [fine]
        for base in bases:
            minors = base.algorithm.minors // 2
            while minors:
                found = self(_variant(base, minors))
                if found.meets or minors == 1:
                    yield found
                    break
                minors //= 2

    def _orders_help(self, found: Candidate) -> bool:
        """Whether coning or the manoeuvre, and neither counts nor results, are what is too much."""
        if self.environment.spectrum is not None:  # whose bound is of second order
            return False
        r = self.requirement
        pairs = ((found.drift, r.drift), (found.angle, r.angle), (found.velocity, r.velocity))
        over = sum(left is not None and limit is not None and left > limit for left, limit in pairs)
        return 0 < over == len(found.faults)

    def __call__(self, design: Design) -> Candidate:
        drift, force = self._left(design)
        allowed = self.requirement
        faults, excess = [], 1.0

        def hold(what: str, left: float | None, limit: float | None, unit: str) -> None:
            """Note a fault if more is left than allowed."""
            nonlocal excess
            if limit is not None and left is not None and not left <= limit:
                faults.append(f"{what} leaves {left:.3g} {unit}, over {limit:g}")
                excess = max(excess, left / limit)

        hold("coning", drift, allowed.drift, "°/h")
        hold("sculling", force, allowed.force, "µg")
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
        path = Path()
        if self._has_path and not faults:
            path = self._paths(design)
            hold("the manoeuvre", path.angle, allowed.angle, "°")
            hold("the manoeuvre", path.velocity, allowed.velocity, "m/s")
            way = (
                "high resolution" if design.algorithm.position == "high-resolution" else "trapezoid"
            )
            hold(f"position by {way}", path.position, allowed.position, "m")
        return Candidate(design, drift, force, cost(design), tuple(faults), excess, *path)

    def _left(self, design: Design) -> tuple[float, float | None]:
        """Sizes of what is left: °/h and µg."""
        T, kind = design.sample_interval, design.sensor.kind
        if self.environment.spectrum is None:
            return self._cone(design), self._scull(design)
        bound = self._assembly(design).bound
        left = bound.errors(design.table, T, kind, design.sensor_response)
        return left.coning * PER_HOUR, hypot(*left.sculling.tolist()) / G * 1e6

    def _cone(self, design: Design) -> float:
        """Left of classical coning, °/h; 0 where there is none."""
        if not self.environment.half_angle:
            return 0.0
        drift = coning_drift(
            design.table,
            design.algorithm.minors,
            self.environment.half_angle,
            2 * pi * self.environment.hertz,
            design.sample_interval,
            design.sensor.kind,
            design.sensor_response,
            design.order,
        )
        return abs(drift) * PER_HOUR

    def _scull(self, design: Design) -> float | None:
        """Left of classical sculling, µg; None where there is none."""
        e = self.environment
        if not e.sculling_angle:
            return None
        motion = Scull(e.sculling_angle, e.sculling_force)
        left = frequency.drift(design, motion, np.array([e.sculling_hertz]))
        return abs(float(left[0])) / G * 1e6

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
        else:
            e = self.environment
            rate += 2 * pi * e.hertz * sin(e.half_angle)
            rate += 2 * pi * e.sculling_hertz * e.sculling_angle
            force += e.sculling_force
        T = design.sample_interval if design.sensor.kind == "increment" else 1.0
        yield "the gyro", rate * T / design.sensor.gyro.lsb, float(design.words.gyro.hi)
        yield "the accelerometer", force * T / design.sensor.accel.lsb, float(design.words.accel.hi)
