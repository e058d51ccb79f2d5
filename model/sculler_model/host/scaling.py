"""From a core's integers to major increments.

Only here do scale factors and denominators enter, in double precision, once a major interval
(docs/explanation/theory.md).
"""

from __future__ import annotations

import sys
from dataclasses import replace
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sculler_model.algorithms import S_DENOMINATOR, SCROLLING_DENOMINATOR
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.fast import FastModel, VectorBlock, from_limbs, limbs_of
from sculler_model.host.compensation import (
    displacement,
    velocity_higher_orders,
    velocity_rotation,
)
from sculler_model.host.compiled import compiled_floats, compiled_scale
from sculler_model.host.increments import MajorIncrements
from sculler_model.host.next_orders import next_orders
from sculler_model.host.third_order import ThirdOrder

Array = NDArray[np.float64]

WORTH_COMPILING = 500_000
"""Intervals of a block that numpy takes as long for as Numba takes to be loaded."""

WORTH_WHEN_LOADED = 200_000
"""Where Numba is in use already, as its code takes; the bursts of a live host must not wait."""

PART = 8192
"""Intervals that numpy scales at a time: few enough for the cache."""

RESULTS = 8192
"""Results held at a time: so few stay in the cache of a processor's core."""


def major_increments(
    design: Design,
    block: VectorBlock,
    third_order: bool = False,
    rotation: Literal["exact", "first-order"] = "exact",
) -> MajorIncrements:
    """φ, α, ΔV_SF and ΔR_SF of each major interval of a block, in the sensor's axes.

        φ     = g alpha/Dw + g² (coning_within/Dc + coning_between/(2 Dw²))
        ΔV_SF = υ + ΔV_rot(α, υ) + a g (sculling_within/Dc + sculling_between/(2 Dw²))

    with g and a the scales of gyro and accelerometer counts (Savage-98 Eq. 37, with Eq. 51 for
    the rotation; Yang Eq. 14 with the half that his Eq. 20a lacks).  A design with high-resolution
    position gives ΔR_SF as well (`displacement`, with S_α = g T_l s_alpha/12, S_υ = a T_l s_nu/12
    and ΔR_scrl = a g T_l scrolling/4320), and ΔV_SF to higher orders (`velocity_higher_orders`).

    A design of third or fourth order adds g³ coning_third/D3 and g⁴ coning_fourth/D4 to φ, and

        ΔV_SF = w + ΔV_rot(φ, w),   w = υ + sculling + a g² sculling_third/D3 + ...

    with the denominators of `Design.composition`, and to both the first terms of what follows
    (`next_orders`; docs/explanation/higher-order.md).

    Args:
        design: the design.
        block: consecutive major intervals.
        third_order: correct φ and ΔV_SF as `ThirdOrder` does, which says where that holds; what
            the block's first four intervals lack is added to the fifth.
        rotation: "first-order" for the cheap compensations of Savage-98, to see what they cost:
            ½ α×υ (Eq. 39; with sculling that is Eq. 40-41) and (S_α×υ + α×S_υ)/6 (Eq. 86), and
            nothing of higher order.

    Returns:
        The increments, with the block's status and, where it has them, its times.

    Raises:
        InputError: there is no such rotation, or `third_order` is asked for of a design that has
            those terms in its integers.
    """
    if rotation not in ("exact", "first-order"):
        raise InputError(f'rotation: {rotation!r} is not allowed, give "exact" or "first-order"')
    if third_order:
        refuse_third_order(design)
    if rotation == "first-order":
        increments = _first_order(design, block)
    elif design.high_resolution:
        increments = _with_displacement(design, block)
    elif design.order > 2:
        increments = _with_higher_orders(design, block)
    elif _is_worth_compiling(len(block)):
        increments = _compiled(design, block)
    else:
        increments = _scaled(design, block)
    return ThirdOrder()(increments) if third_order else increments


def refuse_third_order(design: Design) -> None:
    """See that the host's own third-order terms are not added to integers that hold them.

    Raises:
        InputError: the design is of third or fourth order.
    """
    if design.order > 2:
        raise InputError(
            f"third order: the integers of {design.name}, with order = {design.order}, hold these"
            " terms already; leave the host's third order out"
        )


def increments_of(
    model: FastModel, counts: ArrayLike, faults: ArrayLike | None = None
) -> MajorIncrements:
    """φ, α, ΔV_SF and ΔR_SF of the major intervals that consecutive samples complete.

    What `major_increments` makes of `FastModel.feed`, bit for bit, but the integers of a part at a
    time, which stay in the processor's cache: with short intervals twice as fast or more.

    Args:
        model: takes the samples, as by `feed`.
        counts, faults: as for `FastModel.feed`.

    Raises:
        InputError: as `FastModel.feed`; then nothing of the samples is taken.
    """
    design = model.design
    majors = (model.leftover + len(np.asarray(counts))) // design.samples_per_major
    plain = not design.high_resolution and design.order == 2
    if plain and _is_worth_compiling(majors) and compiled_scale() is not None:
        whole = _none_yet(majors)

        def fill(first: int, limbs: NDArray[np.int64]) -> None:
            _fill(design, limbs, whole[first : first + len(limbs)])

        return replace(whole, status=model.feed_to(fill, counts, faults, RESULTS))
    parts = {0: major_increments(design, VectorBlock.from_rows([], design))}

    def scale(first: int, limbs: NDArray[np.int64]) -> None:
        parts[first] = major_increments(design, _bare(limbs))

    status = model.feed_to(scale, counts, faults, RESULTS)
    return replace(
        MajorIncrements.concatenate([parts[first] for first in sorted(parts)]), status=status
    )


def _bare(limbs: NDArray[np.int64]) -> VectorBlock:
    """Results of which only the integers are known."""
    none = np.zeros(len(limbs), np.int64)
    return VectorBlock(none, none, from_limbs(limbs))


def _is_worth_compiling(majors: int) -> bool:
    return majors >= (WORTH_WHEN_LOADED if "numba" in sys.modules else WORTH_COMPILING)


def _none_yet(majors: int) -> MajorIncrements:
    """Memory for increments."""
    phi, alpha, dv_sf = (np.empty((majors, 3)) for _ in range(3))
    return MajorIncrements(phi, alpha, dv_sf)


def _scaled(design: Design, block: VectorBlock) -> MajorIncrements:
    """φ, α and ΔV_SF, in numpy."""
    phi, alpha, dv_sf = (np.empty((len(block), 3)) for _ in range(3))
    units = _units(design)
    for first in range(0, len(block), PART):
        part = slice(first, first + PART)
        some = block[part]
        alpha[part], upsilon = _sums(some, units)
        phi[part] = alpha[part] + units.coning * _correction(some, "coning", units)
        turned = upsilon + velocity_rotation(alpha[part], upsilon)
        dv_sf[part] = turned + units.sculling * _correction(some, "sculling", units)
    return MajorIncrements(phi, alpha, dv_sf, status=block.status, times=block.times)


def _compiled(design: Design, block: VectorBlock) -> MajorIncrements:
    """The same numbers through Numba, where it is there."""
    if compiled_scale() is None:
        return _scaled(design, block)
    found = replace(_none_yet(len(block)), status=block.status, times=block.times)
    limbs = limbs_of(block.components)
    for first in range(0, len(block), RESULTS):
        part = slice(first, first + RESULTS)
        _fill(design, limbs[part], found[part])
    return found


def _fill(design: Design, limbs: NDArray[np.int64], found: MajorIncrements) -> None:
    """Fill in φ, α and ΔV_SF through Numba, which is there."""
    scale, floats = compiled_scale(), compiled_floats()
    assert scale is not None
    assert floats is not None
    numbers: NDArray[Any] = limbs
    if numbers.shape[2] == 1:
        numbers = numbers[..., 0]
    else:
        numbers = np.empty(limbs.shape[:2])
        floats(limbs, numbers)
    left = scale(numbers, _units(design), found.phi, found.alpha, found.dv_sf)
    if left.any():
        found.dv_sf[left] = _scaled(design, _bare(limbs[left])).dv_sf


def _with_displacement(design: Design, block: VectorBlock) -> MajorIncrements:
    """φ, α, ΔV_SF and ΔR_SF of a design with high-resolution position."""
    increments, units = _scaled(design, block), _units(design)
    alpha, upsilon = _sums(block, units)
    s_alpha, s_upsilon, scrolling = _double_integrals(design, block)
    sculling = units.sculling * _correction(block, "sculling", units)
    higher = velocity_higher_orders(
        alpha, upsilon, s_alpha, s_upsilon, sculling, scrolling, design.major_interval
    )
    return replace(
        increments,
        dv_sf=increments.dv_sf + higher,
        dr_sf=displacement(alpha, upsilon, s_alpha, s_upsilon, scrolling),
    )


def _with_higher_orders(design: Design, block: VectorBlock) -> MajorIncrements:
    """φ, α and ΔV_SF of a design of third or fourth order, and what follows it (`next_orders`)."""
    units, composed, g = _units(design), design.composition, design.gyro_scale
    alpha, upsilon = _sums(block, units)
    coning = units.coning * _correction(block, "coning", units)
    sculling = units.sculling * _correction(block, "sculling", units)
    orders = [(alpha, upsilon), (coning, sculling)]
    scales = {"third": g * g / composed.third, "fourth": g**3 / composed.fourth}
    for name in ("third", "fourth")[: design.order - 2]:
        angle = block.vector(f"coning_{name}").astype(np.float64)
        velocity = block.vector(f"sculling_{name}").astype(np.float64)
        scale = scales[name]
        orders.append((g * scale * angle, design.accel_scale * scale * velocity))
    tail = next_orders(orders)
    phi, w = orders[0]
    for angle, velocity in (*orders[1:], tail):
        phi, w = phi + angle, w + velocity
    dv_sf = w + velocity_rotation(phi, w)
    return MajorIncrements(phi, alpha, dv_sf, status=block.status, times=block.times)


def _first_order(design: Design, block: VectorBlock) -> MajorIncrements:
    """The same with the compensations of first order (Savage-98 Eq. 39, 86)."""
    increments, units = _scaled(design, block), _units(design)
    alpha, upsilon = _sums(block, units)
    sculling = units.sculling * _correction(block, "sculling", units)
    dv_sf, dr_sf = upsilon + 0.5 * np.cross(alpha, upsilon) + sculling, None
    if design.high_resolution:
        s_alpha, s_upsilon, scrolling = _double_integrals(design, block)
        turned = np.cross(s_alpha, upsilon) + np.cross(alpha, s_upsilon)
        dr_sf = s_upsilon + turned / 6 + scrolling
    return replace(increments, dv_sf=dv_sf, dr_sf=dr_sf)


def _double_integrals(design: Design, block: VectorBlock) -> tuple[Array, Array, Array]:
    """S_α (rad s), S_υ and ΔR_scrl (m), each (R, 3)."""
    g, a, T = design.gyro_scale, design.accel_scale, design.sample_interval
    scrolling = block.vector("scrolling").astype(np.float64)
    return (
        block.vector("s_alpha").astype(np.float64) * (g * T / S_DENOMINATOR),
        block.vector("s_nu").astype(np.float64) * (a * T / S_DENOMINATOR),
        scrolling * (a * g * T / SCROLLING_DENOMINATOR),
    )


class _Units(NamedTuple):
    """Scales, and what corrections within and between minor intervals stand over.

    Those of alpha (rad) and nu (m/s) are of a count, those of coning and sculling of a count².
    """

    alpha: float
    nu: float
    within: float
    between: float
    coning: float
    sculling: float


def _units(design: Design) -> _Units:
    g, a, table = design.gyro_scale, design.accel_scale, design.table
    return _Units(
        alpha=g / table.sum_denominator,
        nu=a / table.sum_denominator,
        within=float(table.denominator),
        between=float(2 * table.sum_denominator**2),
        coning=g * g,
        sculling=a * g,
    )


def uncorrected(design: Design, block: VectorBlock) -> MajorIncrements:
    """What an integrator gets that knows nothing of coning and sculling.

    It sees only the sums: φ = α, and ΔV_SF = υ + ΔV_rot(α, υ), since the rotation compensation
    needs no more than the sums either.
    """
    alpha, upsilon = _sums(block, _units(design))
    dv_sf = upsilon + velocity_rotation(alpha, upsilon)
    return MajorIncrements(alpha, alpha, dv_sf, status=block.status, times=block.times)


def second_order_corrections(design: Design, block: VectorBlock) -> tuple[Array, Array]:
    """Coning (rad) and sculling (m/s) of consecutive major intervals taken as one, each (3,).

    What ``½ ∫ α×ω`` and ``½ ∫ (α×f + υ×ω)`` from the first interval's start to the last one's end
    come to: the intervals' own, and between them as between minor intervals (Savage-20 Eq. 5).
    """
    units = _units(design)
    alpha, upsilon = _sums(block, units)
    before = np.cumsum(alpha, axis=0) - alpha, np.cumsum(upsilon, axis=0) - upsilon
    coning = 0.5 * np.cross(before[0], alpha)
    sculling = 0.5 * (np.cross(before[0], upsilon) + np.cross(before[1], alpha))
    coning += units.coning * _correction(block, "coning", units)
    sculling += units.sculling * _correction(block, "sculling", units)
    return coning.sum(axis=0), sculling.sum(axis=0)


def _sums(block: VectorBlock, units: _Units) -> tuple[Array, Array]:
    """α (rad) and υ (m/s), each (R, 3)."""
    alpha = block.vector("alpha").astype(np.float64) * units.alpha
    upsilon = block.vector("nu").astype(np.float64) * units.nu
    return alpha, upsilon


def _correction(block: VectorBlock, name: str, units: _Units) -> Array:
    """Within plus between, (R, 3), in counts²."""
    within = block.vector(f"{name}_within").astype(np.float64) / units.within
    between = block.vector(f"{name}_between").astype(np.float64) / units.between
    corrections: Array = within + between
    return corrections
