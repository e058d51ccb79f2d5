"""How good a design is: closed forms for one, and advice which to take."""

from __future__ import annotations

from math import pi, radians

import numpy as np

from sculler_model.analysis import advice, frequency
from sculler_model.analysis.advice import Candidate, Environment, Requirement
from sculler_model.analysis.oscillation import Scull
from sculler_model.analysis.sensed import require_known
from sculler_model.design import Design
from sculler_model.errors import InputError


def _require_frequency(design: Design, hertz: float) -> None:
    if not 0 < hertz < float("inf"):
        raise InputError(f"hertz: {hertz} is not allowed, give a frequency > 0")
    require_known(design, hertz, "hertz")


def coning_drift(design: Design, half_angle: float, hertz: float) -> float:
    """The drift that a design leaves under classical coning, computed minus true.

    To all orders: the whole computation in double precision, without rounding to counts
    (docs/explanation/analysis.md).

    Args:
        design: its tap table, M, sample rate, kind and sensor's filter count.
        half_angle: of the cone, degrees.
        hertz: frequency of the coning, Hz.

    Returns:
        The drift about the cone's axis, °/h.

    Raises:
        InputError: a number is out of its range.

    Examples:
        >>> import sculler
        >>> design = sculler.Design.preset("stim300")
        >>> left = sculler.coning_drift(design, half_angle=0.1, hertz=50)
        >>> abs(left) < 0.01  # without correction it would be 99 °/h
        True
    """
    _require_frequency(design, hertz)
    if not 0 < half_angle < 90:
        raise InputError(
            f"half_angle: {half_angle} is not allowed, give more than 0° and under 90°"
        )
    drift = advice.coning_drift(
        design.table,
        design.algorithm.minors,
        radians(half_angle),
        2 * pi * hertz,
        design.sample_interval,
        design.sensor.kind,
        design.sensor_response,
    )
    return drift * advice.PER_HOUR


def sculling_drift(design: Design, angle: float, force: float, hertz: float) -> float:
    """The error that a design leaves under classical sculling, computed minus true.

    To second order in the amplitudes (Yang Eq. 5-9 with angle and velocity, docs/explanation).

    Args:
        design: its tap table, sample rate, kind and sensor's filter count.
        angle: amplitude of the rocking, degrees.
        force: amplitude of the specific force, m/s².
        hertz: frequency of both, Hz.

    Returns:
        The specific force, m/s², square to both.

    Raises:
        InputError: the frequency is not > 0.

    Examples:
        >>> import sculler
        >>> design = sculler.Design.preset("stim300")
        >>> abs(sculler.sculling_drift(design, angle=0.1, force=10.0, hertz=35)) < 1e-6
        True
    """
    _require_frequency(design, hertz)
    motion = Scull(radians(angle), force)
    return float(frequency.drift(design, motion, np.array([float(hertz)]))[0])


def advise(
    base: Design, environment: Environment, requirement: Requirement, *, most_samples: int = 6
) -> list[Candidate]:
    """The designs for a sensor held against a requirement, the cheapest that meets it first.

    Args:
        base: the sensor; its algorithm is not looked at.
        environment: what it must bear: `sculler.Environment`, coning, sculling, a vibration, or
            manoeuvres.
        requirement: what may be left: `sculler.Requirement`, °/h or µg; attitude, velocity and
            position.
        most_samples: n goes up to this.

    Returns:
        Candidates: `design`, `drift` (°/h), `force` (µg), `cost`, `meets` and why not, `faults`.

    Raises:
        InputError: there is nothing to hold against a requirement.

    Examples:
        >>> import math, sculler
        >>> coning = sculler.Environment(half_angle=math.radians(0.1), hertz=50)
        >>> base = sculler.Design.preset("stim300")
        >>> found = sculler.advise(base, coning, sculler.Requirement(drift=0.01), most_samples=2)
        >>> found[0].meets, found[0].drift <= 0.01
        (True, True)
    """
    return advice.advise(base, environment, requirement, most_samples=most_samples)
