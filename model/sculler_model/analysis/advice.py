"""Which designs meet a requirement in an environment, and which of them is cheapest.

Errors come from closed forms: under a vibration the bound (V4) of `analysis.vibration`, under
classical coning the drift of the whole computation, triple products included (`coning_drift`).
Cost is counted from the word lengths and the tap table, in one-bit full-adder operations, which is
what additions and multiplications come down to in gates: an addition of w bits is w of them, a
product of l by r bits is l·r.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from math import atan2, ceil, cos, degrees, hypot, log2, pi, sin, sqrt
from typing import Any

import numpy as np

from sculler_model.algorithms import SensorKind, TapTable
from sculler_model.analysis.vibration import (
    G,
    Mount,
    Response,
    Spectrum,
    respond,
    sensor_filter,
    step_for,
)
from sculler_model.design import Design, Interval
from sculler_model.errors import InputError
from sculler_model.frames import from_rotation_vector, product
from sculler_model.motion import Coning

PER_HOUR = degrees(1) * 3600
"""°/h per rad/s."""

MAX_TURN = 0.05
"""Largest angle (rad) of a major interval: the algorithms are of first order in it (Savage-98 after
Eq. 23)."""

WIDEST_BAND = 0.25
"""Hz, of the sums over frequency."""

FITTED_BITS = 16
"""Denominator 2^16 of fitted taps."""

FITTED_POINTS = 24
"""Points of the weight that fits are given."""


@dataclass(frozen=True)
class Cost:
    """What a design takes.

    Attributes:
        rows: non-zero tap rows a minor interval.
        additions: of shifted samples, to form A, B, θ and v once (canonical signed digits, three
            axes, both sensors); a minor interval's work.
        multiplications: a sample, on average.
        widest: bits of the widest accumulator.
        area: full adders of all products and tap sums, each counted once whatever is shared,
            and bits of history and accumulators.
        work: full-adder operations a second.
    """

    rows: int
    additions: int
    multiplications: float
    widest: int
    area: int
    work: float


def signed_digits(value: int) -> int:
    """Non-zero digits of the canonical signed-digit form: 7 = 8 - 1 has two."""
    value = abs(value)
    return (value ^ (3 * value)).bit_count()


def cost(design: Design) -> Cost:
    """Count a design's hardware and work."""
    table, words = design.table, design.words
    n, between = table.samples, design.algorithm.minors > 1
    gyro, accel, A, B = words.gyro, words.accel, words.gyro_taps, words.accel_taps
    minors = design.algorithm.minors
    alpha, nu = (item.repeated(max(minors - 1, 1)) for item in (words.theta, words.v))

    def products(pairs: Sequence[tuple[Interval, Interval]]) -> int:
        """Full adders of the cross products of these pairs, six products each."""
        return sum(6 * left.bits * right.bits for left, right in pairs)

    within_cells = products([(A, gyro), (A, accel), (B, gyro)])
    between_cells = products([(alpha, words.theta), (alpha, words.v), (nu, words.theta)])
    between_cells *= between

    rows = [row for row in table.taps if any(row)]
    digits = [sum(map(signed_digits, row)) - 1 for row in [*rows, table.weights]]
    # each addition for three axes of both sensors; weights make θ and v
    widths = [A.bits + B.bits] * len(rows) + [words.theta.bits + words.v.bits]
    tap_cells = [3 * count * width for count, width in zip(digits, widths, strict=True)]

    vectors = ["alpha", "nu", "coning_within", "sculling_within"]
    vectors += ["coning_between", "sculling_between"] * between
    registers = 3 * sum(getattr(words, vector).bits for vector in vectors)
    registers += 3 * table.history * (gyro.bits + accel.bits)
    minor = len(rows) * within_cells + between_cells + sum(tap_cells)
    return Cost(
        rows=len(rows),
        additions=6 * sum(digits),
        multiplications=18 * (len(rows) + between) / n,
        widest=max(getattr(words, vector).bits for vector in vectors),
        area=within_cells + between_cells + sum(tap_cells) + registers,
        work=minor * design.sensor.sample_rate_hz / n,
    )


def coning_drift(
    table: TapTable,
    minors: int,
    half_angle: float,
    omega: float,
    interval: float,
    kind: SensorKind = "increment",
) -> float:
    """Drift about the axis of classical coning, computed minus true, to all orders (rad/s).

    Seen from a frame that goes round with the cone every major interval is the same, so one is
    enough: with D the computed rotation of an interval of length H from cone angle 0,
    ``D Rz(ΩH)`` is a rotation about (nearly) the cone's axis, truly by ΩH, and what it turns
    beyond that is the drift.  Where ΩH is a multiple of 2π it is the size of the whole drift.

    Args:
        table: the tap table.
        minors: M.
        half_angle: rad.
        omega: Ω, rad/s.
        interval: T, s.
        kind: what the samples are (rates pass sinc(ΩT/2)).
    """
    n, reach = table.samples, table.history
    count = n * minors
    motion = Coning(half_angle, omega)
    if kind == "increment":
        s = motion.increments(count + reach, interval, -reach)[:, :3]
    else:
        s = motion.rates(count + reach, interval, 1 - reach)[:, :3] * interval
    phi = np.zeros(3)
    alpha = np.zeros(3)
    for first in range(reach, reach + count, n):
        for k, row in enumerate(table.taps):
            taps = [(d, tap) for d, tap in enumerate(row, start=1) if tap]
            A = sum((tap * s[first + k - d] for d, tap in taps), np.zeros(3))
            phi += np.cross(A, s[first + k]) / table.denominator
        last = first + n - 1
        theta = sum((w * s[last - d] for d, w in enumerate(table.weights) if w), np.zeros(3))
        theta = theta / table.sum_denominator
        phi += 0.5 * np.cross(alpha, theta)
        alpha = alpha + theta
    phi += alpha
    H = count * interval
    turned = (cos(omega * H / 2), 0.0, 0.0, sin(omega * H / 2))
    w, x, y, z = product(from_rotation_vector((phi[0], phi[1], phi[2])), turned)
    # the cone's axis in the body at cone angle 0, where the body is turned about x
    forward = y * sin(half_angle) + z * cos(half_angle) >= 0
    sine = sqrt(x * x + y * y + z * z)
    excess = 2 * atan2(sine if forward else -sine, w) - omega * H
    return ((excess + pi) % (2 * pi) - pi) / H


@dataclass(frozen=True)
class Environment:
    """What the sensor must bear.

    Attributes:
        spectrum, mount: random vibration and the isolators, or None.
        half_angle, hertz: classical coning (rad, Hz), or 0.
        peak_rate: largest angular rate of manoeuvres, rad/s.
        peak_force: largest specific force of manoeuvres, m/s².
    """

    spectrum: Spectrum | None = None
    mount: Mount = field(default_factory=Mount)
    half_angle: float = 0.0
    hertz: float = 0.0
    peak_rate: float = 0.0
    peak_force: float = 0.0


@dataclass(frozen=True)
class Requirement:
    """What may be left.

    Attributes:
        drift: °/h, or None.
        force: µg, or None.
        host_rate: results a second that the host wants at least, Hz.
    """

    drift: float | None = None
    force: float | None = None
    host_rate: float = 100.0


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
                for family, options in _families(base.sensor.kind, n, p, rate, environment):
                    yield Design.parse(
                        {
                            "name": f"{family.replace('-', '_')}_{n}_{p}_x{minors}_{rate:.0f}hz",
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
    """The sensor with increments summed; words grow, to 32 bits at most."""
    sensor: dict[str, Any] = base.as_json()["sensor"]
    for axes in ("gyro", "accel"):
        bits = min(sensor[axes]["bits"] + ceil(log2(summed)), 32)
        sensor[axes] = sensor[axes] | {"bits": bits}
    return sensor | {"sample_rate_hz": base.sensor.sample_rate_hz / summed}


def _families(
    kind: str, n: int, p: int, rate: float, environment: Environment
) -> Iterator[tuple[str, dict[str, Any]]]:
    """Families for a sensor, each once where several are the same table."""
    if kind == "rate":
        yield "filtered-rate", {}
        yield "tuned", {"filter": [{"kind": "sinc"}], "sum": "plain"}
        return
    if n + p < 2:
        return
    yield "frequency-taylor", {}
    if n + p > 2:  # of two samples all families make the same
        yield "time-taylor", {}
        yield "uncompressed", {}
    band = fitted_band(rate, environment)
    if band is not None and p <= 1:
        yield "least-squares", {"band": band, "denominator_bits": FITTED_BITS}


@lru_cache(maxsize=32)
def fitted_band(rate: float, environment: Environment) -> dict[str, Any] | None:
    """Where a least-squares fit should look: at the coning, or where the vibration rectifies.

    The error is Σ rectified(f)·2 residual(λ)/(nλ), so (rectified/f)² is the residual's weight.

    Returns:
        [algorithm.band] of a design file, or None where there is nothing to see.
    """
    nyquist = 0.9 * rate / 2
    if environment.spectrum is None:
        low, high = 0.8 * environment.hertz, min(1.25 * environment.hertz, nyquist)
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


class _Judge:
    """Holds designs against environment and requirement."""

    def __init__(self, environment: Environment, requirement: Requirement) -> None:
        self.environment, self.requirement = environment, requirement
        self._responses: dict[float, Response] = {}

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
            )
            return abs(drift) * PER_HOUR, None
        bound = self._response(design).worst_phase
        left = bound.errors(design.table, T, kind, self._filter(design))
        return left.coning * PER_HOUR, hypot(*left.sculling.tolist()) / G * 1e6

    def _filter(self, design: Design) -> Any:
        """Tuned designs here are tuned to sinc, which the closed forms of rates assume anyway."""
        return None if design.algorithm.family == "tuned" else sensor_filter(design)

    def _response(self, design: Design) -> Response:
        assert self.environment.spectrum is not None
        step = step_for(design.algorithm.samples, design.sensor.sample_rate_hz)
        # the narrower bands are for the poles of rate sensors; increments have none
        if design.sensor.kind == "increment":
            step = WIDEST_BAND
        if step not in self._responses:
            self._responses[step] = respond(self.environment.spectrum, self.environment.mount, step)
        return self._responses[step]

    def _counts(self, design: Design) -> Iterator[tuple[str, float, float]]:
        """Largest counts, manoeuvre and three sigma of vibration, and what the words hold."""
        rate, force = self.environment.peak_rate, self.environment.peak_force
        if self.environment.spectrum is not None:
            response = self._response(design)
            omega = 2 * np.pi * response.frequency
            swing = response.power * omega**2 * np.maximum(abs(response.y), abs(response.z)) ** 2
            rate += 3 * float(np.sqrt(swing.sum()))
            force += 3 * response.force_rms
        elif self.environment.half_angle:
            rate += 2 * pi * self.environment.hertz * sin(self.environment.half_angle)
        T = design.sample_interval if design.sensor.kind == "increment" else 1.0
        yield "the gyro", rate * T / design.sensor.gyro.lsb, float(design.words.gyro.hi)
        yield "the accelerometer", force * T / design.sensor.accel.lsb, float(design.words.accel.hi)
