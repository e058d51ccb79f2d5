"""The environment, the requirement, and the designs that are held against them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from math import ceil, log2
from typing import Any

import numpy as np

from sculler_model.analysis.flight import Profile
from sculler_model.analysis.vibration import Mount, Spectrum, respond
from sculler_model.design import Design, at_another_rate

MAX_TURN = 0.05
"""Largest angle (rad) of a major interval: the algorithms are of first order in it (Savage-98 after
Eq. 23)."""

WIDEST_BAND = 0.25
"""Hz, of the sums over frequency."""

FITTED_BITS = 16
"""Denominator 2^16 of fitted taps."""

TUNED_BITS = 24
"""Denominator 2^24 of taps that are matched behind a filter, whose exact ones may be long."""

FITTED_POINTS = 24
"""Points of the weight that fits are given."""


@dataclass(frozen=True)
class Environment:
    """What the sensor must bear.

    Attributes:
        spectrum, mount: random vibration and the isolators, or None.
        half_angle, hertz: classical coning (rad, Hz), or 0.
        sculling_angle, sculling_force, sculling_hertz: classical sculling (rad, m/s², Hz), or 0.
        peak_rate: largest angular rate of manoeuvres, rad/s.
        peak_force, force_ramp: largest specific force of manoeuvres and its rate of change, m/s²
            and m/s³.
        manoeuvre: one of them, point by point, or None.

    Examples:
        >>> import math, sculler
        >>> coning = sculler.Environment(half_angle=math.radians(0.1), hertz=50)
        >>> coning.spectrum is None, coning.peak_rate
        (True, 0.0)
    """

    spectrum: Spectrum | None = None
    mount: Mount = field(default_factory=Mount)
    half_angle: float = 0.0
    hertz: float = 0.0
    peak_rate: float = 0.0
    peak_force: float = 0.0
    sculling_angle: float = 0.0
    sculling_force: float = 0.0
    sculling_hertz: float = 0.0
    force_ramp: float = 0.0
    manoeuvre: Profile | None = None


@dataclass(frozen=True)
class Requirement:
    """What may be left.

    Attributes:
        drift: °/h, or None.
        force: µg, or None.
        host_rate: results a second that the host wants at least, Hz.
        angle, velocity: of attitude (°) and velocity (m/s) at the end of the manoeuvre, or None.
        position: m at the end of the manoeuvre, and over `seconds` under the peaks, or None.
        seconds: s.

    Examples:
        >>> import sculler
        >>> sculler.Requirement(drift=0.01).host_rate
        100.0
    """

    drift: float | None = None
    force: float | None = None
    host_rate: float = 100.0
    angle: float | None = None
    velocity: float | None = None
    position: float | None = None
    seconds: float = 10.0


def candidates(
    base: Design,
    environment: Environment,
    requirement: Requirement,
    *,
    most_samples: int,
    most_history: int,
    slowest: int,
) -> Iterator[Design]:
    """The designs that are looked at.

    M is as large as `MAX_TURN` at the peak rate and the host's rate allow, at least 1: that spares
    the host most.
    """
    for summed in _factors(base, slowest):
        sensor = _slower(base, summed)
        rate = sensor["sample_rate_hz"]
        least_hz = max(requirement.host_rate, environment.peak_rate / MAX_TURN)
        for n in range(1, most_samples + 1):
            minors = min(max(int(rate / (n * least_hz) * (1 + 1e-12)), 1), 4096)
            for p in range(min(n, most_history) + 1):
                for family, options in _families(sensor, n, p, environment):
                    kind = family.replace("-", "_") + "_fitted" * ("match" in options)
                    yield Design.parse(
                        {
                            "name": f"{kind}_{n}_{p}_x{minors}_{rate:.0f}hz",
                            "sensor": sensor,
                            "algorithm": {
                                "family": family,
                                "samples": n,
                                "history": p,
                                "minors": minors,
                                **options,
                            },
                        }
                    )


def _factors(base: Design, slowest: int) -> list[int]:
    """How many samples are summed into one; rates cannot be, they would need another filter."""
    if base.sensor.kind == "rate":
        return [1]
    return [1 << k for k in range(max(int(log2(slowest)), 0) + 1)]


def _slower(base: Design, summed: int) -> dict[str, Any]:
    """The sensor with increments summed; words grow, to 32 bits at most, and the filter stays."""
    data = base.as_json()
    sensor: dict[str, Any] = data["sensor"]
    for axes in ("gyro", "accel"):
        bits = min(sensor[axes]["bits"] + ceil(log2(summed)), 32)
        sensor[axes] = sensor[axes] | {"bits": bits}
    rate = base.sensor.sample_rate_hz
    # a design file of before has the sensor's filter with the algorithm
    if passed := sensor.get("filter") or data["algorithm"].get("filter"):
        sensor = sensor | {"filter": at_another_rate(passed, rate, summed)}
    return sensor | {"sample_rate_hz": rate / summed}


def _families(
    sensor: dict[str, Any], n: int, p: int, environment: Environment
) -> Iterator[tuple[str, dict[str, Any]]]:
    """Families for a sensor, each once where several are the same table."""
    filtered = "filter" in sensor
    if sensor["kind"] == "rate":
        yield "filtered-rate", {}
        # one whose samples passed nothing else took the mean over the sample interval
        yield "tuned", {"sum": "plain"} | ({} if filtered else {"filter": [{"kind": "sinc"}]})
        return
    if n + p < 2:
        return
    yield "frequency-taylor", {}
    if n + p > 2:  # of two samples all families make the same
        yield "time-taylor", {}
        yield "uncompressed", {}
    band = fitted_band(sensor["sample_rate_hz"], environment)
    fit = {"band": band, "denominator_bits": FITTED_BITS}
    if filtered:
        if not any(stage["kind"] == "measured" for stage in sensor["filter"]):
            yield "tuned", {"denominator_bits": TUNED_BITS}
        if band is not None and p <= 1:
            yield "tuned", {"match": "least-squares", **fit}
    elif band is not None and p <= 1:
        yield "least-squares", fit


@lru_cache(maxsize=32)
def fitted_band(rate: float, environment: Environment) -> dict[str, Any] | None:
    """Where a least-squares fit should look: at the coning, or where the vibration rectifies.

    The error is Σ rectified(f)·2 residual(λ)/(nλ), so (rectified/f)² is the residual's weight.

    Returns:
        [algorithm.band] of a design file, or None where there is nothing to see.
    """
    nyquist = 0.9 * rate / 2
    if environment.spectrum is None:
        tones = [f for f in (environment.hertz, environment.sculling_hertz) if f]
        if not tones:
            return None
        low, high = 0.8 * min(tones), min(1.25 * max(tones), nyquist)
        return {"low_hz": low, "high_hz": high} if low < high else None
    worst = respond(environment.spectrum, environment.mount, WIDEST_BAND).worst_phase
    low, high = float(worst.frequency[0]), min(float(worst.frequency[-1]), nyquist)
    if low >= high:
        return None
    at = np.geomspace(low, high, FITTED_POINTS).round(4)
    rectified = np.zeros_like(at)
    for bands in (worst.coning, np.hypot(*worst.sculling[:, 1:].T)):
        if bands.any():
            rectified += np.interp(at, worst.frequency, bands / bands.sum())
    weight = (rectified / at) ** 2
    if not weight.any():
        return None
    weights = [float(f"{w:.4g}") for w in (weight / weight.max()).tolist()]
    return {"psd": [list(row) for row in zip(at.tolist(), weights, strict=True)]}
