"""From a core's integers to major increments.

Only here do scale factors and denominators enter, in double precision, once a major interval
(docs/explanation/theory.md).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sculler_model.algorithms import S_DENOMINATOR, SCROLLING_DENOMINATOR
from sculler_model.design import Design
from sculler_model.fast import VectorBlock
from sculler_model.host.compensation import (
    displacement,
    velocity_higher_orders,
    velocity_rotation,
)
from sculler_model.host.increments import MajorIncrements
from sculler_model.host.third_order import ThirdOrder

Array = NDArray[np.float64]


def major_increments(
    design: Design, block: VectorBlock, third_order: bool = False
) -> MajorIncrements:
    """φ, α, ΔV_SF and ΔR_SF of each major interval of a block, in the sensor's axes.

        φ     = g alpha/Dw + g² (coning_within/Dc + coning_between/(2 Dw²))
        ΔV_SF = υ + ΔV_rot(α, υ) + a g (sculling_within/Dc + sculling_between/(2 Dw²))

    with g and a the scales of gyro and accelerometer counts (Savage-98 Eq. 37, with Eq. 51 for
    the rotation; Yang Eq. 14 with the half that his Eq. 20a lacks).  A design with high-resolution
    position gives ΔR_SF as well (`displacement`, with S_α = g T_l s_alpha/12, S_υ = a T_l s_nu/12
    and ΔR_scrl = a g T_l scrolling/4320), and ΔV_SF to higher orders (`velocity_higher_orders`).

    Args:
        design: the design.
        block: consecutive major intervals.
        third_order: correct φ as `ThirdOrder` does, which says when that helps; the block's first
            two intervals stay as they are.

    Returns:
        The increments, with the block's status and, where it has them, its times.
    """
    g, a = design.gyro_scale, design.accel_scale
    alpha, upsilon = _sums(design, block)
    coning, sculling = _correction(design, block, "coning"), _correction(design, block, "sculling")
    increments = MajorIncrements(
        phi=alpha + g * g * coning,
        alpha=alpha,
        dv_sf=upsilon + velocity_rotation(alpha, upsilon) + a * g * sculling,
        status=block.status,
        times=block.times,
    )
    if design.high_resolution:
        T = design.sample_interval
        s_alpha = block.vector("s_alpha").astype(np.float64) * (g * T / S_DENOMINATOR)
        s_upsilon = block.vector("s_nu").astype(np.float64) * (a * T / S_DENOMINATOR)
        scrolling = block.vector("scrolling").astype(np.float64)
        scrolling *= a * g * T / SCROLLING_DENOMINATOR
        higher = velocity_higher_orders(alpha, a * g * sculling, scrolling, design.major_interval)
        increments = replace(
            increments,
            dv_sf=increments.dv_sf + higher,
            dr_sf=displacement(alpha, upsilon, s_alpha, s_upsilon, scrolling),
        )
    return ThirdOrder()(increments) if third_order else increments


def uncorrected(design: Design, block: VectorBlock) -> MajorIncrements:
    """What an integrator gets that knows nothing of coning and sculling.

    It sees only the sums: φ = α, and ΔV_SF = υ + ΔV_rot(α, υ), since the rotation compensation
    needs no more than the sums either.
    """
    alpha, upsilon = _sums(design, block)
    dv_sf = upsilon + velocity_rotation(alpha, upsilon)
    return MajorIncrements(alpha, alpha, dv_sf, status=block.status, times=block.times)


def second_order_corrections(design: Design, block: VectorBlock) -> tuple[Array, Array]:
    """Coning (rad) and sculling (m/s) of consecutive major intervals taken as one, each (3,).

    What ``½ ∫ α×ω`` and ``½ ∫ (α×f + υ×ω)`` from the first interval's start to the last one's end
    come to: the intervals' own, and between them as between minor intervals (Savage-20 Eq. 5).
    """
    alpha, upsilon = _sums(design, block)
    before = np.cumsum(alpha, axis=0) - alpha, np.cumsum(upsilon, axis=0) - upsilon
    coning = 0.5 * np.cross(before[0], alpha)
    sculling = 0.5 * (np.cross(before[0], upsilon) + np.cross(before[1], alpha))
    g, a = design.gyro_scale, design.accel_scale
    coning += g * g * _correction(design, block, "coning")
    sculling += a * g * _correction(design, block, "sculling")
    return coning.sum(axis=0), sculling.sum(axis=0)


def _sums(design: Design, block: VectorBlock) -> tuple[Array, Array]:
    """α (rad) and υ (m/s), each (R, 3)."""
    weight_unit = design.table.sum_denominator
    alpha = block.vector("alpha").astype(np.float64) * (design.gyro_scale / weight_unit)
    upsilon = block.vector("nu").astype(np.float64) * (design.accel_scale / weight_unit)
    return alpha, upsilon


def _correction(design: Design, block: VectorBlock, name: str) -> Array:
    """Within plus between, (R, 3), in counts²."""
    table = design.table
    within = block.vector(f"{name}_within").astype(np.float64) / table.denominator
    between = block.vector(f"{name}_between").astype(np.float64) / (2 * table.sum_denominator**2)
    corrections: Array = within + between
    return corrections
