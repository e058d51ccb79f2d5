"""High-resolution position at the sample rate in exact integers (Savage-98 Eq. 61 and 102-105).

With time in samples (T_l = 1) everything is rational: the doubly integrated increments S_α and
S_υ over 12, the sculling that scrolling is made of over 12, and the scrolling ΔR_scrl over 4320.
Like the core's other vectors these numerators are held exactly; nothing is rounded.

Two misprints are put right: Eq. 105 prints δR_scrlA with ½[υ - Δυ/12 - Δυ'] for
½[υ - (Δυ - Δυ')/12], and Eq. 95 a sum for the cross product α × S_υ.  With them S and ΔR_scrl are
exact wherever rate and specific force are straight lines.

It is written to be held against the page; a prime marks the values one sample back, as Savage
writes l-1.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from sculler_model.errors import InputError
from sculler_model.golden import ZERO, cross, plus, times
from sculler_model.vectors import Vec

S_DENOMINATOR = 12
"""Of `s_alpha` and `s_nu`."""
SCROLLING_DENOMINATOR = 4320
"""Of `scrolling`."""


class DoublyIntegrated(NamedTuple):
    """The vectors of one major interval, integer numerators, time in samples.

    With g and a the scales of gyro (rad) and accelerometer (m/s) counts and T_l the sample
    interval (s):  S_α = g T_l s_alpha/12 (rad·s),  S_υ = a T_l s_nu/12 (m),
    ΔR_scrl = g a T_l scrolling/4320 (m).

    Attributes:
        alpha, nu: sums of the gyro's and the accelerometer's counts.
        s_alpha, s_nu: their running integrals, over 12.
        scrolling: over 4320.
    """

    alpha: Vec
    nu: Vec
    s_alpha: Vec
    s_nu: Vec
    scrolling: Vec


def high_resolution(
    samples: Iterable[tuple[Vec, Vec]], samples_per_major: int
) -> Iterator[DoublyIntegrated]:
    """The doubly integrated vectors of all complete major intervals.

    Args:
        samples: increment counts of gyro and accelerometer, one pair for each sample.  The sample
            before the first one is zero; from then on history runs across the intervals.
        samples_per_major: samples in a major interval.

    Yields:
        One result for each major interval, at its end.

    Raises:
        InputError: the number of samples in an interval is below 1.
    """
    if samples_per_major < 1:
        raise InputError(
            f"samples in a major interval: {samples_per_major} is not allowed, give 1 or more"
        )
    before: tuple[Vec, Vec] = (ZERO, ZERO)  # Δα', Δυ'
    alpha = nu = s_alpha = s_nu = sculling = scrolling = ZERO
    for number, (d_alpha, d_nu) in enumerate(samples, start=1):
        slope_alpha = plus(d_alpha, times(-1, before[0]))  # Δα - Δα'
        slope_nu = plus(d_nu, times(-1, before[1]))
        # ΔS - α' = (5 Δα + Δα')/12                                          Eq. 103, 104
        part_alpha = plus(times(5, d_alpha), before[0])
        part_nu = plus(times(5, d_nu), before[1])

        # δR_A = Δv_scul' + ½[α' - (Δα-Δα')/12] × (ΔS_υ - υ')
        #                 + ½[υ' - (Δυ-Δυ')/12] × (ΔS_α - α')                       Eq. 105
        scrolling_a = plus(
            times(360, sculling),
            times(15, cross(plus(times(12, alpha), times(-1, slope_alpha)), part_nu)),
            times(15, cross(plus(times(12, nu), times(-1, slope_nu)), part_alpha)),
        )
        # δR_B = 1/6 [S_υ' + (Δυ-Δυ')/24] × Δα - 1/6 [S_α' + (Δα-Δα')/24] × Δυ
        #      + 1/6 [α' - (Δα-Δα')/6] × [υ' - (Δυ-Δυ')/6] - 1/2160 (Δα-Δα') × (Δυ-Δυ')
        scrolling_b = plus(
            times(30, cross(plus(times(2, s_nu), slope_nu), d_alpha)),
            times(-30, cross(plus(times(2, s_alpha), slope_alpha), d_nu)),
            times(
                20,
                cross(
                    plus(times(6, alpha), times(-1, slope_alpha)),
                    plus(times(6, nu), times(-1, slope_nu)),
                ),
            ),
            times(-2, cross(slope_alpha, slope_nu)),
        )
        scrolling = plus(scrolling, scrolling_a, scrolling_b)
        # δv_scul = ½[(α' + Δα'/6) × Δυ + (υ' + Δυ'/6) × Δα]                            Eq. 61
        sculling = plus(
            sculling,
            cross(plus(times(6, alpha), before[0]), d_nu),
            cross(plus(times(6, nu), before[1]), d_alpha),
        )
        s_alpha = plus(s_alpha, times(12, alpha), part_alpha)
        s_nu = plus(s_nu, times(12, nu), part_nu)
        alpha, nu = plus(alpha, d_alpha), plus(nu, d_nu)
        before = (d_alpha, d_nu)

        if number % samples_per_major == 0:
            yield DoublyIntegrated(alpha, nu, s_alpha, s_nu, scrolling)
            alpha = nu = s_alpha = s_nu = sculling = scrolling = ZERO
