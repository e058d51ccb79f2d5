"""Known errors of a sensor taken out of major intervals, where the core has summed them up."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.fast import VectorBlock
from sculler_model.host.compensation import velocity_rotation
from sculler_model.host.increments import MajorIncrements
from sculler_model.samples import Calibration

Array = NDArray[np.float64]


def calibrated(
    design: Design, block: VectorBlock, increments: MajorIncrements, calibration: Calibration
) -> MajorIncrements:
    """Increments of a block without biases, scale factors, misalignments and g-sensitivity.

    With M the inverse of the gyros' matrix and K that of the accelerometers',

        α = M (α_felt - b T - G υ)        υ = K (υ_felt - b T)

    exactly.  The coning of the core, ½∫α×ω, is that of the felt vectors; cof M = det M · M⁻ᵀ takes
    it to the true ones, exactly but for bias times the motion's change over the interval, which has
    no mean.  Sculling, of two sensors, goes by the
    mean of M and K: what is left is misalignment times sculling.

    Args:
        design: the design.
        block: its results.
        increments: what `major_increments` makes of them, in the sensor's axes.
        calibration: what is known.

    Raises:
        InputError: as `refuse_of_samples`.
    """
    refuse_of_samples(design, calibration)
    gyro, accel, interval = calibration.gyro, calibration.accel, design.major_interval
    M, K = _inverse(gyro.linear), _inverse(accel.linear)
    alpha_felt = increments.alpha
    coning = increments.phi - alpha_felt
    scale = design.accel_scale / design.table.sum_denominator
    upsilon_felt = block.vector("nu").astype(np.float64) * scale
    sculling = increments.dv_sf - upsilon_felt - velocity_rotation(alpha_felt, upsilon_felt)
    upsilon = (upsilon_felt - interval * accel.bias) @ K.T
    alpha = (alpha_felt - interval * gyro.bias - gyro.g_sensitivity * upsilon) @ M.T
    phi = alpha + coning @ _cofactor(M).T
    sculled = sculling @ _cofactor(0.5 * (M + K)).T
    dv_sf = upsilon + velocity_rotation(alpha, upsilon) + sculled
    return replace(increments, phi=phi, alpha=alpha, dv_sf=dv_sf)


def refuse_of_samples(design: Design, calibration: Calibration) -> None:
    """See that `calibrated` can undo a calibration in results of a design.

    Raises:
        InputError: it has what only samples can be freed of, or the design has ΔR_SF.
    """
    if calibration.of_samples:
        raise InputError(
            f"calibration: {', '.join(calibration.of_samples)} cannot be undone in results, which"
            " are sums over samples; undo it in the log, by convert --calibration"
        )
    if design.high_resolution:
        raise InputError(
            "calibration: results of high-resolution position cannot be freed of it, undo it in the"
            " log, by convert --calibration"
        )


def _cofactor(matrix: Array) -> Array:
    """det M · M⁻ᵀ: what cross products of transformed vectors are transformed by."""
    return float(np.linalg.det(matrix)) * _inverse(matrix).T


def _inverse(matrix: Array) -> Array:
    return np.asarray(np.linalg.inv(matrix), np.float64)
