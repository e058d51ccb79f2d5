"""What the host makes of a major interval's integers: rotation vector, velocity, displacement.

Only here do scale factors and denominators enter, in double precision, once a major interval
(DESIGN section 3).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import factorial

import numpy as np
from numpy.typing import NDArray

from sculler_model.algorithms import S_DENOMINATOR, SCROLLING_DENOMINATOR
from sculler_model.design import STATUS_SHORT_HISTORY, Design
from sculler_model.errors import InputError
from sculler_model.fast import VectorBlock
from sculler_model.frames import AxisMap

Array = NDArray[np.float64]


@dataclass(frozen=True)
class MajorIncrements:
    """Increments over R consecutive major intervals.

    Attributes:
        phi: (R, 3) rotation vector over the interval, rad: the body's attitude at the end against
            its attitude at the start, relative to inertial space.
        alpha: (R, 3) integral of the angular rate over the interval, rad.
        dv_sf: (R, 3) integral of the specific force, m/s, in the body frame at the START of the
            interval, held fixed in inertial space.
        dr_sf: (R, 3) running integral of that over the interval, m, in the same frame: how far
            the specific force has moved the body by the interval's END.  None where the design
            has no high-resolution position.
        status: (R,) status bits of the results they come from (`sculler_model.design`); None for
            none set.  Nobody navigates or aligns with an interval of short history (bit 0): its
            sums and corrections lack the samples before the first one (`require_whole`).
        times: (R,) s, the instant of each interval's END (`sculler_model.samples`); None where
            it is not told.
    """

    phi: Array
    alpha: Array
    dv_sf: Array
    dr_sf: Array | None = None
    status: NDArray[np.int64] | None = None
    times: Array | None = None

    def __len__(self) -> int:
        return len(self.phi)

    def __getitem__(self, part: slice) -> MajorIncrements:
        """Consecutive intervals."""
        cut = self._each(lambda vectors: vectors[part])
        status = None if self.status is None else self.status[part]
        return replace(cut, status=status, times=None if self.times is None else self.times[part])

    def in_axes(self, axes: AxisMap) -> MajorIncrements:
        """The same increments in body axes, from the sensor's."""
        return self._each(axes.apply)

    @property
    def short(self) -> NDArray[np.bool_]:
        """(R,) whether the interval's history is short (status bit 0)."""
        if self.status is None:
            return np.zeros(len(self), np.bool_)
        short: NDArray[np.bool_] = (np.asarray(self.status) & STATUS_SHORT_HISTORY) != 0
        return short

    @property
    def leading_short(self) -> int:
        """How many intervals to leave out so that none of short history is left.

        The state to navigate on from is then that at the END of the last one left out.
        """
        found = np.flatnonzero(self.short)
        return int(found[-1]) + 1 if len(found) else 0

    def require_whole(self, what: str) -> None:
        """Refuse intervals of short history.

        Args:
            what: is to be done with them, for the message.

        Raises:
            InputError: there is such an interval.
        """
        short = self.short
        if not short.any():
            return
        row = int(np.argmax(short))
        at = "" if self.times is None else f", which ends at {float(self.times[row]):.9g} s,"
        raise InputError(
            f"{what}: interval {row} of these{at} reaches before the first sample (status bit 0),"
            " so its sums or corrections are not whole; begin after it, with the state at its end"
            " (increments[increments.leading_short:]), or take it as it is (accepted_as_whole())"
        )

    def accepted_as_whole(self) -> MajorIncrements:
        """The same increments with status bit 0 cleared: what is missing is known to do no harm."""
        status = self.status
        if status is not None:
            status = np.asarray(status, np.int64) & ~STATUS_SHORT_HISTORY
        return replace(self, status=status)

    def _each(self, change: Callable[[Array], Array]) -> MajorIncrements:
        return replace(
            self,
            phi=change(self.phi),
            alpha=change(self.alpha),
            dv_sf=change(self.dv_sf),
            dr_sf=None if self.dr_sf is None else change(self.dr_sf),
        )

    @classmethod
    def concatenate(cls, parts: list[MajorIncrements]) -> MajorIncrements:
        """Join in order; parts without a status count as whole.

        Raises:
            ValueError: there is no part, or only some have ΔR_SF or times.
        """
        status = None
        if any(part.status is not None for part in parts):
            none = [np.zeros(len(part), np.int64) for part in parts]
            pairs = zip(parts, none, strict=True)
            status = np.concatenate([n if p.status is None else p.status for p, n in pairs])
        return cls(
            np.concatenate([part.phi for part in parts]),
            np.concatenate([part.alpha for part in parts]),
            np.concatenate([part.dv_sf for part in parts]),
            _all_or_none("dr_sf", [part.dr_sf for part in parts]),
            status,
            _all_or_none("times", [part.times for part in parts]),
        )


def _all_or_none(name: str, parts: list[Array | None]) -> Array | None:
    """Arrays that all parts have joined, or None if none has."""
    there = [part for part in parts if part is not None]
    if len(there) not in (0, len(parts)):
        raise ValueError(f"{len(there)} of {len(parts)} parts have {name}")
    return np.concatenate(there) if there else None


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


class ThirdOrder:
    """The triple products of the rotation vector equation, from what is handed over alone.

    The core's φ is of second order (Savage-20 Eq. 2 against Eq. 3).  If the rate is a smooth
    function over three major intervals, their α show its slope and curvature, and with them what
    is left out (see `third_order_terms`).  In manoeuvres that takes the error from the fourth to
    the fifth power of the interval.  Vibration inside an interval it cannot see, and vibration
    above about a third of the update rate it takes for something else: there a shorter interval
    helps, this does not.

    Call it with the increments of consecutive intervals, in blocks of any length; it keeps the
    last two.  Attitude is causal: no interval waits for a later one.  An interval of short history
    tells no rate, so it begins anew after one.
    """

    def __init__(self) -> None:
        self._before = np.zeros((0, 3))

    def __call__(self, increments: MajorIncrements) -> MajorIncrements:
        """The increments with φ corrected; the first two whole intervals stay as they are."""
        first = increments.leading_short
        before = np.zeros((0, 3)) if first else self._before
        alpha = np.concatenate((before, increments.alpha[first:]))
        self._before = alpha[-2:]
        terms = third_order_terms(alpha)
        phi = increments.phi.copy()
        phi[len(phi) - len(terms) :] += terms
        return replace(increments, phi=phi)


def third_order_terms(alpha: Array) -> Array:
    """What the second-order φ lacks where the rate is a parabola over three major intervals.

    With ω = a + bτ + cτ², τ from the middle of an interval T, and α1 = aT, α2 = bT², α3 = cT³,

        φ - (α + ½∫α×ω dt) = α1×(α1×α3)/360 - α2×(α1×α2)/240 - α1×(α1×(α1×α2))/720 + O(T⁷)

    the third- and fourth-order terms of the Magnus series for a rate in body axes.

    Args:
        alpha: (R, 3) rad, of consecutive intervals.

    Returns:
        (R - 2, 3) rad for the intervals from the third on; none if there are fewer.
    """
    if len(alpha) < 3:
        return np.zeros((0, 3))
    oldest, before, now = alpha[:-2], alpha[1:-1], alpha[2:]
    alpha2 = 1.5 * now - 2 * before + 0.5 * oldest
    alpha3 = 0.5 * now - before + 0.5 * oldest
    alpha1 = now - alpha3 / 12
    once = np.cross(alpha1, alpha2)
    terms: Array = (
        np.cross(alpha1, np.cross(alpha1, alpha3)) / 360
        - np.cross(alpha2, once) / 240
        - np.cross(alpha1, np.cross(alpha1, once)) / 720
    )
    return terms


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


def velocity_rotation(alpha: Array, upsilon: Array) -> Array:
    """ΔV_rot(α, υ), exact for constant rate and specific force (Savage-98 Eq. 51).

    Args:
        alpha, upsilon: (R, 3), rad and m/s.

    Returns:
        (R, 3) m/s, in the body frame at the start of the interval.
    """
    angle = np.sqrt(np.sum(alpha * alpha, axis=1, keepdims=True))
    first = np.cross(alpha, upsilon)
    second = np.cross(alpha, first)
    result: Array = one_minus_cosine(angle) * first + one_minus_sine(angle) * second
    return result


def velocity_higher_orders(
    alpha: Array, sculling: Array, scrolling: Array, interval: float
) -> Array:
    """What ΔV_SF lacks beyond second order where the body turns steadily, whatever the force does.

    At a constant rate, α(t) = α t/T, sculling and scrolling are α × moments of the force about the
    interval's start.  With m_k = ∫ t^k f dt,

        ΔV_scul = α×(m_1/T - m_0/2)         d = 7/6 ΔV_scul - ΔR_scrl/T = α×(m_2/T² - m_0/3)

    and what Eq. 51 leaves of the third and fourth order is

        ½ α×(α×(m_2/T² - m_0/3)) + 1/6 α×(α×(α×(m_3/T³ - m_0/4)))
            = ½ α×d + α×(α×(d/4 - ΔV_scul/10))

    exactly in third order; in fourth with m_3 as a force has that is a parabola over the interval,
    m_3/T³ = 3/2 m_2/T² - 3/5 m_1/T + m_0/20.  Constant rate and force give 0.

    Args:
        alpha: (R, 3) integral of the angular rate, rad.
        sculling, scrolling: (R, 3) ΔV_scul, m/s, and ΔR_scrl, m.
        interval: T, length of a major interval, s.

    Returns:
        (R, 3) m/s, in the body frame at the start of the interval.
    """
    d = 7 / 6 * sculling - scrolling / interval
    fourth = np.cross(alpha, d / 4 - sculling / 10)
    result: Array = np.cross(alpha, d / 2 + fourth)
    return result


def displacement(
    alpha: Array, upsilon: Array, s_alpha: Array, s_upsilon: Array, scrolling: Array
) -> Array:
    """ΔR_SF: what the specific force adds to the way over each interval (Savage-98 Eq. 84).

        ΔR_SF = S_υ + ΔR_rot + ΔR_scrl

    the running integral of ΔV_SF(t), from the interval's start to its end.

    Args:
        alpha, upsilon: (R, 3) integrals of angular rate (rad) and specific force (m/s).
        s_alpha, s_upsilon: (R, 3) their running integrals (Savage-98 Eq. 85), rad·s and m.
        scrolling: (R, 3) ΔR_scrl (Savage-98 Eq. 86), m.

    Returns:
        (R, 3) m, in the body frame at the START of the interval, held fixed in inertial space.
    """
    rotation = position_rotation(alpha, upsilon, s_alpha, s_upsilon)
    total: Array = s_upsilon + rotation + scrolling
    return total


def position_rotation(alpha: Array, upsilon: Array, s_alpha: Array, s_upsilon: Array) -> Array:
    """ΔR_rot, exact for constant rate and specific force (Savage-98 Eq. 99).

    Args:
        alpha, upsilon, s_alpha, s_upsilon: as for `displacement`.

    Returns:
        (R, 3) m, in the body frame at the start of the interval.
    """
    angle = np.sqrt(np.sum(alpha * alpha, axis=1, keepdims=True))
    first = np.cross(s_alpha, upsilon) + np.cross(alpha, s_upsilon)
    result: Array = one_minus_sine(angle) * first
    result += half_minus_cosine(angle) * np.cross(alpha, first)
    return result


def one_minus_cosine(x: Array) -> Array:
    """(1 - cos x)/x², to rounding for every x: half the square of sin(x/2)/(x/2)."""
    return 0.5 * np.sinc(x / (2 * np.pi)) ** 2


def one_minus_sine(x: Array) -> Array:
    """(1 - sin x/x)/x², to rounding for every x: by its series where |x| < 1 (Savage-98 Eq. 52)."""
    large = np.where(np.abs(x) < 1, 1.0, x)
    return np.where(np.abs(x) < 1, _series(3, x), (1 - np.sin(large) / large) / large**2)


def half_minus_cosine(x: Array) -> Array:
    """(½ - (1 - cos x)/x²)/x², to rounding for every x: by its series where |x| < 1 (Eq. 99)."""
    large = np.where(np.abs(x) < 1, 1.0, x)
    return np.where(np.abs(x) < 1, _series(4, x), (0.5 - one_minus_cosine(large)) / large**2)


def _series(first: int, x: Array) -> Array:
    """1/n! - x²/(n+2)! + x⁴/(n+4)! - ... from n = first on; to rounding for |x| < 1."""
    square = np.where(np.abs(x) < 1, x * x, 0.0)
    series = np.zeros_like(square)
    for n in range(first + 18, first - 1, -2):
        series = 1 / factorial(n) - square * series
    return series
