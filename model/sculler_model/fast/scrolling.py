"""High-resolution position for arrays: the exact twin of `scrolling.HighResolution`.

What Savage-98 Eq. 105 sums up sample by sample is a sum of products, in which Δυ_m and Δα_m can be
put outside the brackets.  With N samples, r = N - m that follow sample m, b the sample before it
and d its own, α, υ and S the sums before it (S over 12),

    scrolling = Σ P_m × Δυ_m + Σ Q_m × Δα_m + 18 Σ b_α × b_υ
    P_m = 360 r (8 α + b_α + 2 d_α) + 780 α + 102 b_α - 42 d_α - 60 S_α + [r > 0] (300 α + 240 d_α)
    Q_m = 360 r (4 υ + b_υ) + 1020 υ + 78 b_υ + 60 S_υ + [r > 0] 60 υ

The counts on the right are taken in digits, so narrow that no sum passes 64 bits; where even P and
Q may, everything is Python integers.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sculler_model.algorithms import scrolling_weights_total
from sculler_model.design import Interval


class FastHighResolution:
    """s_alpha, s_nu and scrolling of many major intervals at once.

    Args:
        samples: N, samples in a major interval.
        counts: the range of gyro and accelerometer counts.
    """

    def __init__(self, samples: int, counts: Interval) -> None:
        self.samples = samples
        largest = max(-counts.lo, counts.hi)
        # the sum of all products with a right factor of 1: also more than any P or Q
        sums = max(2 * scrolling_weights_total(samples), 4096 * samples**2) * largest
        self._bits = 63 - sums.bit_length()
        self._dtype = np.dtype(np.int64 if self._bits > 0 else object)
        if self._bits <= 0:
            self._bits = counts.bits
        self._digits = -(-counts.bits // self._bits)

    def components(self, rows: NDArray[Any]) -> NDArray[Any]:
        """(R, 9) Python integers: s_alpha, s_nu, scrolling.

        Args:
            rows: (1 + R N, 6) gyro and accelerometer counts; the first row is the sample before.
        """
        N = self.samples
        columns = np.ascontiguousarray(rows.T, self._dtype).reshape(2, 3, -1)
        d, b = columns[:, :, 1:].reshape(2, 3, -1, N), columns[:, :, :-1].reshape(2, 3, -1, N)
        sums = d.cumsum(axis=3) - d  # alpha and nu before each sample
        parts = 12 * sums + 5 * d + b
        doubly = parts.cumsum(axis=3)
        s = doubly - parts

        r = np.arange(N - 1, -1, -1).astype(self._dtype)
        more = (r > 0).astype(self._dtype)
        P = (2880 * r + 780 + 300 * more) * sums[0] - 60 * s[0]
        P += (360 * r + 102) * b[0] + (720 * r - 42 + 240 * more) * d[0]
        Q = (1440 * r + 1020 + 60 * more) * sums[1] + (360 * r + 78) * b[1] + 60 * s[1]

        scrolling = np.zeros((3, d.shape[2]), object)
        for digit in range(self._digits):
            d_low, b_low = (self._digit(x, digit) for x in (d, b[1]))
            total = _crossed(P, d_low[1]) + _crossed(Q, d_low[0]) + 18 * _crossed(b[0], b_low)
            scrolling += total.astype(object) << self._bits * digit
        return np.concatenate([*doubly[..., -1].astype(object), scrolling]).T

    def _digit(self, x: NDArray[Any], digit: int) -> NDArray[Any]:
        """A digit of the numbers, the lowest is 0; the highest keeps the sign."""
        higher: NDArray[Any] = x >> self._bits * digit
        return higher if digit == self._digits - 1 else higher & ((1 << self._bits) - 1)


def _crossed(left: NDArray[Any], right: NDArray[Any]) -> NDArray[Any]:
    """(3, R) sums of left x right over the samples, both (3, R, N)."""
    y, z = np.array([1, 2, 0]), np.array([2, 0, 1])
    sums: NDArray[Any] = np.stack(
        [
            np.einsum("rn,rn->r", left[y[i]], right[z[i]])
            - np.einsum("rn,rn->r", left[z[i]], right[y[i]])
            for i in range(3)
        ]
    )
    return sums
