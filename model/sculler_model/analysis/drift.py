"""What a tap table leaves of coning and sculling behind the sensors' filters, in floats.

The counterpart of `closed_form` for any filter, and for gyros and accelerometers that
do not pass the same one.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sculler_model.algorithms import Response, SensorKind, TapTable, distance_sums
from sculler_model.analysis.closed_form import true_correction

Array = NDArray[np.float64]


def filtered_residual(
    table: TapTable,
    phase: ArrayLike,
    kind: SensorKind = "increment",
    gyro: Response | None = None,
    accel: Response | None = None,
) -> Array:
    """Computed minus true drift per minor interval for unit amplitudes a quarter cycle apart.

        Re(F_g F_a*) (σ Σ_d K_d sin dλ + ¼ |W|² σ cot(nλ/2)) - ½ nλ

    with W the sum of the table's weights' phasors (docs/explanation/families.md Eq. 9); for
    increments the second term is ½ sin nλ.  All intervals' sums are included, so this
    is the whole drift.

    Args:
        table: the tap table.
        phase: λ = Ω T, any shape, not a multiple of 2π/n for rate samples with unequal weights.
        kind: what the samples are.
        gyro: F of the gyros, None for 1.
        accel: F of the accelerometers (sculling), None for the gyros' own.
    """
    phase = np.asarray(phase, np.float64)
    power = _cross_power(phase, gyro, accel).real
    correction = _correction(table, phase, kind)
    # ½ nλ - ½ sin nλ is kept in one piece, which loses nothing at small λ
    half_sine = 0.5 * np.sin(table.samples * phase)
    true = true_correction(table.samples, phase) + half_sine * (1 - power)
    result: Array = power * (correction - half_sine) - true
    return result


def in_phase_drift(
    table: TapTable,
    phase: ArrayLike,
    kind: SensorKind,
    gyro: Response,
    accel: Response,
) -> Array:
    """Drift per minor interval of sculling in phase, whose true drift is zero.

        Im(F_g F_a*) (σ Σ_d K_d sin dλ + ¼ |W|² σ cot(nλ/2))

    for the angle cos Ωt and the specific force's integral cos Ωt, unit amplitudes.  Unlike delays
    of gyro and accelerometer turn it into drift, which no tap table can undo.
    """
    phase = np.asarray(phase, np.float64)
    result: Array = _cross_power(phase, gyro, accel).imag * _correction(table, phase, kind)
    return result


def _cross_power(
    phase: Array, gyro: Response | None, accel: Response | None
) -> NDArray[np.complex128]:
    """F_g F_a*."""
    accel = accel or gyro

    def values(response: Response | None) -> NDArray[np.complex128]:
        if response is None:
            return np.ones(phase.shape, np.complex128)
        flat = [response.value(value) for value in phase.ravel().tolist()]
        return np.array(flat, np.complex128).reshape(phase.shape)

    result: NDArray[np.complex128] = values(gyro) * np.conj(values(accel))
    return result


def _correction(table: TapTable, phase: Array, kind: SensorKind) -> Array:
    """σ Σ_d K_d sin dλ + ¼ |W|² σ cot(nλ/2)."""
    sample = phase * phase if kind == "rate" else 4 * np.sin(phase / 2) ** 2
    within = sum(
        (float(K) * np.sin(d * phase) for d, K in enumerate(distance_sums(table), start=1) if K),
        np.zeros_like(phase),
    )
    n = table.samples
    if kind == "increment" and table.weights == (*[1] * n, 0):
        return np.asarray(sample * within + 0.5 * np.sin(n * phase))
    back = np.exp(-1j * np.multiply.outer(phase, np.arange(n + 1)))
    weights = np.array(table.weights) / table.sum_denominator
    with np.errstate(divide="ignore", invalid="ignore"):
        between = np.abs(back @ weights) ** 2 / (4 * np.tan(n * phase / 2))
    between = np.where(phase == 0, 0.0, between)
    return np.asarray(sample * (within + between))
