"""What a study is about: a design, or a family that has no sensor of its own."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any, NamedTuple

from sculler_model.design import Design
from sculler_model.errors import ContradictionError, InputError

FITTED = "least-squares"
"""The family that a band is for; what else is fitted comes from a design file."""

_FINE_LSB = {"gyro": {"bits": 32, "lsb": 1e-10}, "accel": {"bits": 32, "lsb": 1e-9}}
"""Sensor of a family that comes without a design: full scale 0.21 rad and 2.1 m/s a sample."""


def require_band(families: Collection[str], band: tuple[float, float] | None) -> None:
    """See that a band comes with the family that is fitted over it, and only with that.

    Raises:
        ContradictionError: one without the other.
    """
    if (FITTED in families) != (band is not None):
        raise ContradictionError(f"--family {FITTED} and --band belong together, give both or none")


def require_increments(design: Design, name: str) -> None:
    """See that a design's sensor counts increments.

    Raises:
        InputError: it does not.
    """
    if design.sensor.kind != "increment":
        raise InputError(f'{name}: sensor.kind is "rate", give a design with increments')


def require_below_nyquist(design: Design, hertz: float) -> None:
    """See that a cone's frequency is one that the samples tell.

    Raises:
        InputError: it is not.
    """
    limit = design.sensor.sample_rate_hz / 2
    if hertz >= limit:
        raise InputError(f"--frequency: {hertz:g} Hz is not below the Nyquist limit, {limit:g} Hz")


def require_whole_interval(seconds: float, minors: Collection[int], interval: float) -> None:
    """See that a run holds the longest major interval.

    Args:
        seconds: of the run.
        minors: numbers of minor intervals of a major one.
        interval: a minor one, s.

    Raises:
        InputError: it does not.
    """
    longest = max(minors) * interval
    if seconds < longest:
        raise InputError(f"--seconds: {seconds:g} is too short, give at least {longest:g}")


class Subject(NamedTuple):
    """A design to study; of_family if it has no sensor of its own."""

    design: Design
    of_family: bool


def of_family(
    family: str,
    samples: int,
    history: int = 0,
    minors: int | None = None,
    rate: float = 2000.0,
    band: tuple[float, float] | None = None,
) -> Subject:
    """A family on a sensor so fine that it does not show.

    Args:
        family: its name.
        samples, history: n and p of its tables.
        minors: minor intervals of a major one; None for what is nearest to 10 ms.
        rate: samples a second, Hz.
        band: that `FITTED` is fitted over, Hz.

    Raises:
        InputError: there is no such family, or not with these numbers.
    """
    minors = minors or max(round(rate / (100 * samples)), 1)
    algorithm: dict[str, Any] = {
        "family": family,
        "samples": samples,
        "history": history,
        "minors": minors,
    }
    if band is not None and family == FITTED:
        algorithm["band"] = {"low_hz": band[0], "high_hz": band[1]}
    kind = "rate" if family == "filtered-rate" else "increment"
    scale = rate if kind == "rate" else 1.0
    sensor: dict[str, Any] = {"kind": kind, "sample_rate_hz": rate}
    for axes, word in _FINE_LSB.items():
        sensor[axes] = word | {"lsb": word["lsb"] * scale}
    said = f"{family[:40]}_{samples}_{history}"
    name = "family_" + "".join(c if c.isalnum() else "_" for c in said)
    data = {"name": name, "sensor": sensor, "algorithm": algorithm}
    return Subject(Design.parse(data, where=family), True)
