"""What a design leaves of manoeuvres and of position, which the results' rate decides."""

from __future__ import annotations

from dataclasses import replace
from math import degrees, sqrt
from typing import NamedTuple

from sculler_model.analysis.advice.candidates import Environment, Requirement
from sculler_model.analysis.flight import flown
from sculler_model.analysis.position import Conditions, left, seen, selection
from sculler_model.design import Design

MOST_SECONDS = 20.0
"""That are run at high resolution; beyond, errors go on as they do."""


class Path(NamedTuple):
    """Sizes of what is left.

    Attributes:
        angle: of attitude at the end of the manoeuvre, °; None without one.
        velocity: there, m/s; None without one.
        position: m, there or over the requirement's time; None where none is asked for.
    """

    angle: float | None = None
    velocity: float | None = None
    position: float | None = None


class Paths:
    """Finds `Path` of designs in an environment.

    Args:
        environment: the manoeuvre, or the peaks of many.
        requirement: over what time position is wanted.
        shaking: root mean square of a vibration's specific force, m/s², and its frequency, Hz.
        random: whether that is a random vibration.
    """

    def __init__(
        self,
        environment: Environment,
        requirement: Requirement,
        shaking: tuple[float, float],
        random: bool,
    ) -> None:
        self.environment, self.requirement = environment, requirement
        self.random = random
        rms, hertz = shaking
        self.conditions: Conditions | None = None
        if requirement.position is not None:
            self.conditions = Conditions(
                force=environment.peak_force,
                force_ramp=environment.force_ramp,
                rate=environment.peak_rate,
                vibration=rms,
                hertz=hertz,
                rocking=0.0 if random else environment.sculling_angle,
                limit=requirement.position,
                seconds=requirement.seconds,
            )
        self._kept: dict[tuple[float, int], float] = {}

    def __call__(self, design: Design) -> Path:
        """What a design leaves."""
        found = Path()
        if self.environment.manoeuvre is not None:
            end = flown(design, self.environment.manoeuvre)
            found = Path(degrees(end.angle), end.velocity, end.position)
        if self.conditions is None:
            return found._replace(position=None)
        conditions, missed = seen(design, self.conditions)
        if design.algorithm.position == "high-resolution":
            steady = self._high(design, conditions)
        else:
            steady = self._trapezoid(design.major_interval, conditions)
        return found._replace(position=max(steady + missed, found.position or 0.0))

    def _trapezoid(self, T: float, conditions: Conditions) -> float:
        """The largest of its errors over the requirement's time (`position.selection`), m."""
        errors = {term.name: term for term in selection(conditions, T).trapezoid}
        aliased = errors.pop("trapezoid, vibration aliased")
        largest = max(term.systematic for term in errors.values())
        tone = conditions.hertz
        return max(largest, aliased.random if self.random else self._aliased(aliased.each, T, tone))

    def _aliased(self, each: float, T: float, hertz: float) -> float:
        """Of a tone: it grows only where the tone is near a multiple of the results' rate."""
        cycles = hertz * T
        apart = abs(cycles - round(cycles)) / T
        grown = self.requirement.seconds
        if apart > 0:
            grown = min(grown, 1 / (2 * apart))
        return sqrt(2) * each * grown / T if round(cycles) else sqrt(2) * each

    def _high(self, design: Design, conditions: Conditions) -> float:
        """At high resolution, m: it does not know the family (`position.left`)."""
        key = design.sensor.sample_rate_hz, design.samples_per_major
        if key not in self._kept:
            seconds = min(conditions.seconds, MOST_SECONDS)
            error = left(design, replace(conditions, seconds=seconds)).core
            assert error is not None
            grown = max(conditions.seconds / seconds, 1.0)
            self._kept[key] = error.largest * grown
        return self._kept[key]
