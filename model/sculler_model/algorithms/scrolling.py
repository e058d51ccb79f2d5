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
from functools import lru_cache
from typing import NamedTuple

from sculler_model.algorithms.integer_vectors import (
    ZERO,
    Vec,
    cross,
    times,
    vector_sum,
    whole_numbers,
)
from sculler_model.errors import InputError

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


class HighResolution:
    """The doubly integrated vectors since the start of the major interval, sample by sample.

    Attributes:
        d_alpha, d_nu: the newest sample's counts, zero before the first.
        alpha, nu, s_alpha, s_nu, scrolling: as in `DoublyIntegrated`, so far.
        sculling: over 12, so far.
    """

    def __init__(self) -> None:
        self.d_alpha = self.d_nu = ZERO
        self.clear()

    def clear(self) -> None:
        """Begin a major interval; the newest sample stays the one before it."""
        self.alpha = self.nu = self.s_alpha = self.s_nu = ZERO
        self.sculling = self.scrolling = ZERO

    def step(self, d_alpha: Vec, d_nu: Vec) -> None:
        """Take the increments of a sample: Δα of the gyro, Δυ of the accelerometer, in counts.

        Raises:
            InputError: they are not whole numbers.
        """
        d_alpha, d_nu = whole_numbers("gyro", d_alpha), whole_numbers("accel", d_nu)
        alpha, nu, s_alpha, s_nu = self.alpha, self.nu, self.s_alpha, self.s_nu
        slope_alpha = vector_sum(d_alpha, times(-1, self.d_alpha))  # Δα - Δα'
        slope_nu = vector_sum(d_nu, times(-1, self.d_nu))
        # ΔS - α' = (5 Δα + Δα')/12                                          Eq. 103, 104
        part_alpha = vector_sum(times(5, d_alpha), self.d_alpha)
        part_nu = vector_sum(times(5, d_nu), self.d_nu)

        # δR_A = Δv_scul' + ½[α' - (Δα-Δα')/12] × (ΔS_υ - υ')
        #                 + ½[υ' - (Δυ-Δυ')/12] × (ΔS_α - α')                       Eq. 105
        scrolling_a = vector_sum(
            times(360, self.sculling),
            times(15, cross(vector_sum(times(12, alpha), times(-1, slope_alpha)), part_nu)),
            times(15, cross(vector_sum(times(12, nu), times(-1, slope_nu)), part_alpha)),
        )
        # δR_B = 1/6 [S_υ' + (Δυ-Δυ')/24] × Δα - 1/6 [S_α' + (Δα-Δα')/24] × Δυ
        #      + 1/6 [α' - (Δα-Δα')/6] × [υ' - (Δυ-Δυ')/6] - 1/2160 (Δα-Δα') × (Δυ-Δυ')
        scrolling_b = vector_sum(
            times(30, cross(vector_sum(times(2, s_nu), slope_nu), d_alpha)),
            times(-30, cross(vector_sum(times(2, s_alpha), slope_alpha), d_nu)),
            times(
                20,
                cross(
                    vector_sum(times(6, alpha), times(-1, slope_alpha)),
                    vector_sum(times(6, nu), times(-1, slope_nu)),
                ),
            ),
            times(-2, cross(slope_alpha, slope_nu)),
        )
        self.scrolling = vector_sum(self.scrolling, scrolling_a, scrolling_b)
        # δv_scul = ½[(α' + Δα'/6) × Δυ + (υ' + Δυ'/6) × Δα]                            Eq. 61
        self.sculling = vector_sum(
            self.sculling,
            cross(vector_sum(times(6, alpha), self.d_alpha), d_nu),
            cross(vector_sum(times(6, nu), self.d_nu), d_alpha),
        )
        self.s_alpha = vector_sum(s_alpha, times(12, alpha), part_alpha)
        self.s_nu = vector_sum(s_nu, times(12, nu), part_nu)
        self.alpha, self.nu = vector_sum(alpha, d_alpha), vector_sum(nu, d_nu)
        self.d_alpha, self.d_nu = d_alpha, d_nu


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
    sums = HighResolution()
    for number, (d_alpha, d_nu) in enumerate(samples, start=1):
        sums.step(d_alpha, d_nu)
        if number % samples_per_major == 0:
            yield DoublyIntegrated(sums.alpha, sums.nu, sums.s_alpha, sums.s_nu, sums.scrolling)
            sums.clear()


def scrolling_weight(i: int, j: int, samples: int) -> int:
    """c_ij of  scrolling = Σ c_ij Δα_i × Δυ_j,  which Eq. 61 and 102-105 come to.

    Args:
        i, j: 0 the sample before the interval, 1..N those of it.
        samples: N, samples in the interval.
    """
    after = samples - max(i, j)  # samples that follow the later of the two
    if i == j:
        return 18 if i == 0 else 216 + 720 * after if after else -42
    apart = abs(i - j)
    if min(i, j) == 0:
        if apart > 1:
            return -60
        return 102 + 360 * after if i < j else -78 - 360 * after
    adjacent, inside = apart == 1, after > 0
    if i < j:
        return 2880 * after - 720 * apart + 1140 + 300 * inside + (360 * after + 162) * adjacent
    return -(1440 * after + 720 * apart + 660 + 60 * inside + (360 * after + 18) * adjacent)


@lru_cache(maxsize=256)
def scrolling_weights_total(samples: int) -> int:
    """Σ |c_ij| over all pairs of samples.

    Args:
        samples: N, samples in the interval.
    """

    def weight(i: int, j: int) -> int:
        return scrolling_weight(i, j, samples)

    total = abs(weight(0, 0))
    for last in range(1, samples + 1):  # the later sample of a pair
        total += abs(weight(last, last)) + abs(weight(0, last)) + abs(weight(last, 0))
        if last > 1:
            total += abs(weight(last - 1, last)) + abs(weight(last, last - 1))
        if last > 2:  # those between, 1..last - 2, each 720 from the next
            total += _magnitudes(weight(1, last), weight(last - 2, last))
            total += _magnitudes(weight(last, 1), weight(last, last - 2))
    return total


def _magnitudes(first: int, last: int) -> int:
    """Sum of |w| for w = first, first + 720, ... last."""
    count = (last - first) // 720 + 1
    negative = min(max(-(first // 720), 0), count)
    return (first + last) * count // 2 - (2 * first + 720 * (negative - 1)) * negative
