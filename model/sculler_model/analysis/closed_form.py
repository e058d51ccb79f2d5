"""Analytic coning and sculling: the true corrections, an algorithm's exact response, its residual.

The base motion is Yang Eq. 5: two orthogonal oscillations of amplitudes a and b, a quarter of a
cycle apart,

    ω = a Ω cos Ωt I + b Ω sin Ωt J                 (coning, rad/s)

For sculling the second one is the specific force, ``f = b Ω sin Ωt J`` with b in m/s; since the
algorithm treats angle and velocity alike, every result here serves both (Yang after Eq. 4): it is
for a·b = 1, and times a·b it is rad along I×J, or m/s.

With λ = Ω ΔT the phase of one sample interval, everything is a function of λ and the tap table.
All rates are second order in the amplitudes, as the algorithms are.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import factorial
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sculler_model.algorithms import TapTable

Array = NDArray[np.float64]

Sampling = Literal["increment", "rate"]
"""Integrated increments, or rate samples that passed the filter sinc(λ/2) (Zeng Eq. 2)."""


def coning_increments(a: float, b: float, omega: float, times: Array) -> Array:
    """Angle increments of Yang Eq. 5 between consecutive times (Yang Eq. 7).

    Args:
        a, b: amplitudes, rad.
        omega: Ω, rad/s.
        times: (N + 1,), s.

    Returns:
        (N, 3) rad.
    """
    phase = omega * times
    x, y = a * np.diff(np.sin(phase)), -b * np.diff(np.cos(phase))
    return np.stack((x, y, np.zeros_like(x)), axis=1)


def true_correction(samples: int, phase: ArrayLike) -> Array:
    """Coning (sculling) over one minor interval of n samples (Yang Eq. 6 with 1/Ω): per a·b.

    Args:
        samples: n.
        phase: λ, rad, any shape.

    Returns:
        ``½ (nλ - sin nλ)``, of phase's shape.
    """
    total = samples * np.asarray(phase, np.float64)
    return _versine_like(total)


def algorithm_correction(table: TapTable, phase: ArrayLike) -> Array:
    """What the tap table makes of one minor interval: per a·b (Yang Eq. 9, Zeng Eq. 20-22).

    A sample is Re, Im of a phasor of size ``2 sin(λ/2)``, for increments as for filtered rates, so
    a product of samples d apart gives ``4 sin²(λ/2) sin dλ`` at whatever phase of the motion.
    """
    phase = np.asarray(phase, np.float64)
    total = np.zeros_like(phase)
    for d, K in enumerate(map(sum, zip(*table.taps, strict=True)), start=1):
        if K:  # all that coning sees of taps at a distance is their sum
            total = total + K * np.sin(d * phase)
    correction: Array = _sample_power(phase) * total / table.denominator
    return correction


def residual(table: TapTable, phase: ArrayLike, sampling: Sampling = "increment") -> Array:
    """Algorithm minus truth over one minor interval, per a·b: exact in λ.

    For increments the sums θ are the true ones, and so is everything that the integer core and
    the host make of them between minor and major intervals; what is left is
    ``algorithm_correction - true_correction``, whatever M.  The sum that a rate sensor's weights
    form is not the true angle: its amplitude error changes what the sums give between
    intervals, which for all intervals together is ``¼ |θ|² cot(nλ/2)`` each in place of
    ``½ sin nλ``; so this is the residual of the whole drift.  Where nλ is a multiple of 2π a rate
    sensor's sums alias to a constant rate, and the result has a pole.
    """
    phase = np.asarray(phase, np.float64)
    difference = algorithm_correction(table, phase) - true_correction(table.samples, phase)
    if sampling == "increment":
        return difference
    total = table.samples * phase
    shift = np.exp(-1j * np.multiply.outer(phase, np.arange(len(table.weights))))
    weights = np.array(table.weights) / table.sum_denominator
    theta_power = np.abs(shift @ weights) ** 2 * _sample_power(phase)
    with np.errstate(divide="ignore", invalid="ignore"):
        between = np.where(phase == 0, 0.0, theta_power / (4 * np.tan(total / 2)))
    result: Array = difference + between - 0.5 * np.sin(total)
    return result


def drift_rate(
    table: TapTable,
    a: float,
    b: float,
    omega: ArrayLike,
    sample_interval: float,
    sampling: Sampling = "increment",
) -> Array:
    """Drift that the algorithm leaves, computed minus true.

    Args:
        table: the tap table.
        a, b: amplitudes: rad and rad for coning (rad/s results), rad and m/s for sculling (m/s²).
            Classical coning of half angle α has a = b = sin α.
        omega: Ω, rad/s, any shape.
        sample_interval: ΔT, s.
        sampling: what the samples are.
    """
    phase = np.asarray(omega, np.float64) * sample_interval
    rate: Array = residual(table, phase, sampling) * (a * b / (table.samples * sample_interval))
    return rate


def uncorrected_rate(a: float, b: float, omega: ArrayLike) -> Array:
    """Drift of an integrator without any correction, less its ripple: ``-½ a b Ω``."""
    rate: Array = -0.5 * a * b * np.asarray(omega, np.float64)
    return rate


@dataclass(frozen=True)
class LeadingTerm:
    """First term of the residual's power series: ``coefficient λ^power`` per a·b."""

    coefficient: Fraction
    power: int


def leading_term(
    table: TapTable, sampling: Sampling = "increment", max_power: int = 99
) -> LeadingTerm:
    """The first non-zero term of `residual` in λ, as an exact rational.

    Raises:
        ValueError: there is none up to max_power.
    """
    n, length = table.samples, (max_power + 1) // 2
    # odd series: entry i belongs to λ^(2i+1)
    half_sine = [_sine_term(n, i) / 2 for i in range(length)]
    series = list(half_sine)  # minus the truth, ½ nλ - ½ sin nλ
    series[0] -= Fraction(n, 2)
    for row in table.taps:
        for d, tap in enumerate(row, start=1):
            for i in range(length if tap else 0):
                # 4 sin²(λ/2) sin dλ = 2 sin dλ - sin (d+1)λ - sin (d-1)λ
                terms = 2 * _sine_term(d, i) - _sine_term(d + 1, i) - _sine_term(d - 1, i)
                series[i] += Fraction(tap, table.denominator) * terms
    if sampling == "rate":
        between = _between_series(table, length)
        series = [s + b - h for s, b, h in zip(series, between, half_sine, strict=True)]
    for i, entry in enumerate(series):
        if entry:
            return LeadingTerm(entry, 2 * i + 1)
    raise ValueError(f"the residual vanishes up to the power {max_power} of λ")


def _between_series(table: TapTable, length: int) -> list[Fraction]:
    """¼ |θ|² cot(nλ/2), entry i for λ^(2i+1); from even series, entry k for λ^(2k)."""
    weights = [Fraction(w, table.sum_denominator) for w in table.weights]
    half = Fraction(table.samples, 2)
    orders = range(length)
    # |Σ w_d e^(-idλ)|² = Σ w_i w_j cos (i-j)λ
    spread = [
        sum(
            (
                wi * wj * _cosine_term(i - j, k)
                for i, wi in enumerate(weights)
                for j, wj in enumerate(weights)
            ),
            Fraction(0),
        )
        for k in orders
    ]
    power = [-2 * _cosine_term(1, k + 1) for k in orders]  # 4 sin²(λ/2) / λ²
    cosine = [_cosine_term(half, k) for k in orders]
    sine = [_sine_term(half, k) for k in orders]  # sin(nλ/2) / λ
    quotient = _divide(_multiply(_multiply(spread, power), cosine), sine)
    return [entry / 4 for entry in quotient]


def _multiply(a: list[Fraction], b: list[Fraction]) -> list[Fraction]:
    size = min(len(a), len(b))
    return [sum((a[j] * b[i - j] for j in range(i + 1)), Fraction(0)) for i in range(size)]


def _divide(a: list[Fraction], b: list[Fraction]) -> list[Fraction]:
    quotient: list[Fraction] = []
    for i in range(min(len(a), len(b))):
        known = sum((quotient[j] * b[i - j] for j in range(i)), Fraction(0))
        quotient.append((a[i] - known) / b[0])
    return quotient


def _sine_term(d: int | Fraction, i: int) -> Fraction:
    """Coefficient of λ^(2i+1) in sin dλ."""
    return Fraction((-1) ** i, factorial(2 * i + 1)) * Fraction(d) ** (2 * i + 1)


def _cosine_term(d: int | Fraction, i: int) -> Fraction:
    """Coefficient of λ^(2i) in cos dλ."""
    return Fraction((-1) ** i, factorial(2 * i)) * Fraction(d) ** (2 * i)


def _sample_power(phase: Array) -> Array:
    """|sample|² = 4 sin²(λ/2)."""
    power: Array = 4 * np.sin(phase / 2) ** 2
    return power


def _versine_like(total: Array) -> Array:
    """½ (x - sin x), by its series where |x| < 1 so that small x loses nothing."""
    small = np.abs(total) < 1
    square = np.where(small, total * total, 0.0)
    series = np.zeros_like(square)
    for k in range(9, 0, -1):
        series = square * (1 / factorial(2 * k + 1) - series)
    result: Array = 0.5 * np.where(small, total * series, total - np.sin(total))
    return result
