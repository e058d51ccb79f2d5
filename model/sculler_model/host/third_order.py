"""Beyond the second order, from the increments of five major intervals: of φ and of ΔV_SF."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import comb

import numpy as np
from numpy.typing import NDArray

from sculler_model.host.increments import MajorIncrements

Array = NDArray[np.float64]

INTERVALS = 5
"""Consecutive intervals whose sums tell the rate: a polynomial of fourth degree."""

WINDOW = 10
"""Intervals over which it is judged whether the rate is smooth."""

SMOOTH = 0.13
"""Third differences of α squared against second ones, at most; of a vibration of f Hz and an
interval T it is 4 sin²(π f T), so this is f T = 0.058: a seventeenth of the update rate."""

LARGEST = 1.0
"""rad that the body may turn in an interval; the series are cut off."""

FIT = (
    (-71, 364, -746, 684, 1689, 1920),
    (9, -50, 120, -174, 95, 48),
    (7, -36, 74, -68, 23, 16),
    (3, -14, 24, -18, 5, 12),
    (1, -4, 6, -4, 1, 24),
)
"""aT, bT², cT³, ... about the middle of the last of five intervals: factors of their integrals, the
oldest first, and what they stand over."""


class ThirdOrder:
    """The triple products of rotation vector and velocity, from what is handed over alone.

    The core's φ is of second order (Savage-20 Eq. 2 against Eq. 3).  If the rate is a smooth
    function over five major intervals, their α show its slopes, and with them what is left out
    (see `rotation_terms`, `velocity_terms`).  In manoeuvres that takes the error of φ from the
    fourth to the sixth power of the interval.

    Vibration inside an interval it cannot see, and faster vibration it would take for something
    else.  So it leaves an interval as it is where the rate is not smooth: where, over the last
    `WINDOW` intervals, the third differences of α are not small against the second ones
    (`SMOOTH`: a vibration above a seventeenth of the update rate, or noise), or where the body
    turns by more than `LARGEST`.  `corrected` and `left` count.

    Call it with the increments of consecutive intervals, in blocks of any length; it keeps what
    it needs.  Attitude is causal: no interval waits for a later one.  The first four intervals
    tell too little, so what they lack is added to the fifth, from whose end on attitude and
    velocity are as if all had been corrected.  So begin it with the first interval that is
    navigated with.  An interval of short history tells no rate; it begins anew after one.

    Attributes:
        corrected: intervals that were corrected so far, the first four of each beginning too.
        left: intervals that were left as they are.
    """

    def __init__(self) -> None:
        self.corrected = self.left = 0
        self._begin()

    def _begin(self) -> None:
        self._before = np.zeros((2, 0, 3))

    def __call__(self, increments: MajorIncrements) -> MajorIncrements:
        """The increments, corrected."""
        first = increments.leading_short
        turns, velocities = increments.alpha[first:], increments.dv_sf[first:]
        # in the body's own axes, to second order
        now = np.stack((turns, velocities - 0.5 * np.cross(turns, velocities)))
        if first:
            self.left += first + self.waiting
            self._begin()
        known = self._before.shape[1]
        alpha, upsilon = both = np.concatenate((self._before, now), axis=1)
        self._before = both[:, -(WINDOW + 2) :]
        smooth = smooth_intervals(alpha)[max(known, INTERVALS - 1) :]
        if not len(smooth):
            return increments
        starts = known < INTERVALS
        self._count(smooth, starts)
        starts = starts and bool(smooth[0])
        # the last intervals, as many as may be corrected, and the four before them
        alpha, upsilon = (each[-(len(smooth) + INTERVALS - 1) :] for each in (alpha, upsilon))
        rates, forces = slopes(alpha), slopes(upsilon)
        phi = increments.phi.copy()
        rows = np.arange(len(phi) - len(smooth), len(phi))[smooth]
        phi[rows] += rotation_terms(rates)[smooth]
        if starts:
            phi[rows[0]] += _of_the_first(alpha, rates)
        if increments.dr_sf is not None:
            return replace(increments, phi=phi)
        dv_sf = increments.dv_sf.copy()
        dv_sf[rows] += velocity_terms(rates, forces)[smooth]
        if starts:
            dv_sf[rows[0]] += _of_the_first(alpha, rates, forces)
        return replace(increments, phi=phi, dv_sf=dv_sf)

    def _count(self, smooth: NDArray[np.bool_], starts: bool) -> None:
        """Intervals that are corrected or not; the fifth one speaks for the four before it."""
        good = int(np.count_nonzero(smooth))
        self.corrected += good
        self.left += len(smooth) - good
        if starts and smooth[0]:
            self.corrected += INTERVALS - 1
        elif starts:
            self.left += INTERVALS - 1

    @property
    def waiting(self) -> int:
        """Intervals that wait for the fifth one."""
        known: int = self._before.shape[1]
        return known if known < INTERVALS else 0


def smooth_intervals(alpha: Array) -> NDArray[np.bool_]:
    """Whether the rate is smooth up to an interval, by those before it.

    Args:
        alpha: (R, 3) rad, of consecutive intervals.

    Returns:
        (R,) of each; False for the first four, of which too little is known.
    """
    rows = max(len(alpha) - 3, 0)
    second, third = np.zeros((2, rows + WINDOW - 1))
    if rows:
        second[WINDOW - 1 :] = _square(np.diff(alpha, 2, axis=0)[1:])
        third[WINDOW - 1 :] = _square(np.diff(alpha, 3, axis=0))
    seconds, thirds = np.zeros((2, rows))
    for oldest in range(WINDOW):
        seconds += second[oldest : oldest + rows]
        thirds += third[oldest : oldest + rows]
    smooth = np.zeros(len(alpha), np.bool_)
    smooth[3:] = thirds <= SMOOTH * seconds
    smooth &= _square(alpha) <= LARGEST * LARGEST
    smooth[: INTERVALS - 1] = False
    return smooth


def slopes(sums: Array) -> list[Array]:
    """aT, bT², cT³, dT⁴, eT⁵ of ω = a + bτ + cτ² + dτ³ + eτ⁴ about the middle of an interval T.

    Args:
        sums: (R, 3) integrals of ω over consecutive intervals.

    Returns:
        Five times (R - 4, 3), of the intervals from the fifth on; none if there are fewer.
    """
    rows = max(len(sums) - INTERVALS + 1, 0)
    found = []
    for *factors, divisor in FIT:
        total = np.zeros((rows, 3))
        for i, factor in enumerate(factors):
            total = total + factor * sums[i : i + rows]
        found.append(total / divisor)
    return found


def of_part(rates: Sequence[Array], middle: float, length: float) -> list[Array]:
    """The same polynomials about another middle and for another length, both in intervals."""
    found = []
    for k in range(INTERVALS):
        total = rates[k]
        for j in range(k + 1, INTERVALS):
            total = total + comb(j, k) * middle ** (j - k) * rates[j]
        found.append(length ** (k + 1) * total)
    return found


def third_order_terms(alpha1: Array, alpha2: Array, alpha3: Array) -> Array:
    """What the second-order φ lacks where the rate is a parabola.

    With ω = a + bτ + cτ², τ from the middle of an interval T, and α1 = aT, α2 = bT², α3 = cT³,

        φ - (α + ½∫α×ω dt) = α1×(α1×α3)/360 - α2×(α1×α2)/240 - α1×(α1×(α1×α2))/720 + O(T⁷)

    the third- and fourth-order terms of the Magnus series for a rate in body axes.

    Args:
        alpha1, alpha2, alpha3: (R, 3) rad.

    Returns:
        (R, 3) rad.
    """
    once = np.cross(alpha1, alpha2)
    terms: Array = (
        np.cross(alpha1, np.cross(alpha1, alpha3)) / 360
        - np.cross(alpha2, once) / 240
        - np.cross(alpha1, np.cross(alpha1, once)) / 720
    )
    return terms


def rotation_terms(rates: Sequence[Array]) -> Array:
    """What the second-order φ lacks where the rate is a polynomial of fourth degree.

    `third_order_terms` of both halves of the interval, put together: with φ' and φ″ of the halves
    and w = φ'×φ″,

        φ = φ' + φ″ + ½ w + 1/12 (φ' - φ″)×w - 1/24 φ″×(φ'×w) + ...

    (Baker, Campbell and Hausdorff, for a rate in body axes; what follows is T⁷).  In a cone that
    leaves a third to an eighth of what `third_order_terms` of the whole do.  The exact coning of
    the whole takes its part of this, ½ α'×α″ and the coning of the halves; the rest is summed
    without it, so that nothing cancels.

    Args:
        rates: as `slopes` gives them.

    Returns:
        (R, 3) rad.
    """
    alpha, small, terms = zip(*(_half(rates, middle) for middle in (-0.25, 0.25)), strict=True)
    left, right = alpha[0] + small[0], alpha[1] + small[1]
    w = np.cross(left, right)
    mixed = np.cross(small[0], right) + np.cross(alpha[0], small[1])
    total: Array = terms[0] + terms[1] + 0.5 * mixed + np.cross(left - right, w) / 12
    return total - np.cross(right, np.cross(left, w)) / 24


def _half(rates: Sequence[Array], middle: float) -> tuple[Array, Array, Array]:
    """Of half an interval: its α, what φ has beyond it, and what of that is of third order on."""
    a1, a2, a3, _, a5 = of_part(rates, middle, 0.5)
    terms = third_order_terms(a1, a2, a3)
    return a1 + a3 / 12 + a5 / 80, np.cross(a1, a2) / 12 + terms, terms


def velocity_terms(rates: Sequence[Array], forces: Sequence[Array]) -> Array:
    """What ΔV_SF of second order lacks where rate and force are parabolas.

    With α1 = aT, α2 = bT², α3 = cT³ of ω = a + bτ + cτ², and υ1, υ2, υ3 of the specific force
    likewise, τ from the middle of an interval,

        ΔV_SF - (υ + ΔV_rot + ΔV_scul) =
            [α1×(α1×υ2) - α2×(α1×υ1)]/24
            + α1×(α1×υ3)/360 + α1×(α2×υ2)/240 - α1×(α3×υ1)/180
            - α2×(α1×υ2)/120 + α2×(α2×υ1)/240 + α3×(α1×υ1)/360
            + α1×[α1×(α1×υ2)/80 + α1×(α2×υ1)/240 - α2×(α1×υ1)/240] - α2×(α1×(α1×υ1))/80 + O(T⁶)

    the third and fourth order of the series of nested integrals ∫ω×∫ω× ... f.

    Args:
        rates, forces: α1, α2, α3 (rad) and υ1, υ2, υ3 (m/s), each (R, 3), as `slopes` gives them;
            what comes after them is not used.

    Returns:
        (R, 3) m/s.
    """
    (a1, a2, a3), (u1, u2, u3) = rates[:3], forces[:3]
    once, slope, turned = np.cross(a1, u1), np.cross(a1, u2), np.cross(a2, u1)
    inner = slope / 80 + turned / 240
    first = slope / 24 + np.cross(a1, u3) / 360 + np.cross(a2, u2) / 240 - np.cross(a3, u1) / 180
    first = first + np.cross(a1, inner) - np.cross(a2, once) / 240
    second = once / 24 + slope / 120 - turned / 240 + np.cross(a1, once) / 80
    terms: Array = np.cross(a1, first) - np.cross(a2, second) + np.cross(a3, once) / 360
    return terms


def _of_the_first(
    alpha: Array, rates: Sequence[Array], forces: Sequence[Array] | None = None
) -> Array:
    """What the first four intervals lack, for the fifth: of φ, or with forces of ΔV_SF.

    Args:
        alpha: (R, 3) of all intervals from the first on.
        rates, forces: as `slopes` gives them, the fifth interval's first.

    Returns:
        (3,) in the body frame of the fifth interval: of φ in its middle, of ΔV_SF at its start.
    """
    total = np.zeros((1, 3))
    for k in range(INTERVALS - 1):
        there = of_part([each[:1] for each in rates], k - 4.0, 1.0)
        turn = 0.5 * alpha[k] if forces is None else alpha[k]
        for between in alpha[k + 1 : INTERVALS - 1]:
            turn = turn + between
        if forces is None:
            lacking, turn = rotation_terms(there), turn + 0.5 * alpha[INTERVALS - 1]
        else:
            forces_there = of_part([each[:1] for each in forces], k - 4.0, 1.0)
            lacking = velocity_terms(there, forces_there)
        across = np.cross(turn, lacking)
        total = total + (lacking - across + 0.5 * np.cross(turn, across))
    moved: Array = total[0]
    return moved


def _square(vectors: Array) -> Array:
    """(R,) of (R, 3)."""
    x, y, z = vectors.T
    square: Array = x * x + y * y + z * z
    return square
