"""High-resolution position for arrays: the exact twin of `scrolling.HighResolution`.

What Savage-98 Eq. 105 sums up sample by sample is a sum of products, in which Δυ_m and Δα_m can be
put outside the brackets.  With N samples, r = N - m that follow sample m, b the sample before it
and d its own, α, υ and S the sums before it (S over 12),

    scrolling = Σ P_m × Δυ_m + Σ Q_m × Δα_m + 18 Σ b_α × b_υ
    P_m = 360 r (8 α + b_α + 2 d_α) + 780 α + 102 b_α - 42 d_α - 60 S_α + [r > 0] (300 α + 240 d_α)
    Q_m = 360 r (4 υ + b_υ) + 1020 υ + 78 b_υ + 60 S_υ + [r > 0] 60 υ

With counts up to c and k = N - 1 - r samples before m, |P| and |Q| are at most 2880 r k + 360 k² +
1080 (N - 1) + 384 times c, the first two at most 823 (N - 1)²: so they stay below 1024 N² c.  Both
sides are taken in digits, so narrow that no sum of products passes 64 bits; where even P and Q may,
everything is Python integers.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sculler_model.design import Interval
from sculler_model.fast.digits import digit_count, split_digits


class FastHighResolution:
    """s_alpha, s_nu and scrolling of many major intervals at once.

    Args:
        samples: N, samples in a major interval.
        counts: the range of gyro and accelerometer counts.
    """

    def __init__(self, samples: int, counts: Interval) -> None:
        self.samples = samples
        left = max(-counts.lo, counts.hi) * 1024 * samples**2  # more than any P or Q
        self._dtype = np.dtype(np.int64 if left.bit_length() < 64 else object)
        spare = 63 - (6 * samples).bit_length()  # of a product: three kinds, two of a cross product
        if left.bit_length() > 63:
            spare = 2 * left.bit_length()  # one digit on either side
        self._right_bits = min(counts.bits, spare // 2)
        self._left_bits = spare - self._right_bits
        self._left_digits = digit_count(Interval(-left, left), self._left_bits)
        self._right_digits = digit_count(counts, self._right_bits)

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

        left = np.concatenate([P, Q, 18 * b[0]], axis=2)
        right = np.concatenate([d[1], d[0], b[1]], axis=2)
        scrolling = np.zeros((3, d.shape[2]), object)
        for i, x in enumerate(split_digits(left, self._left_bits, self._left_digits)):
            for j, y in enumerate(split_digits(right, self._right_bits, self._right_digits)):
                place = i * self._left_bits + j * self._right_bits
                scrolling += _crossed(x, y).astype(object) << place
        return np.concatenate([*doubly[..., -1].astype(object), scrolling]).T


def _crossed(left: NDArray[Any], right: NDArray[Any]) -> NDArray[Any]:
    """(3, R) sums of left x right over the products, both (3, R, 3 N)."""
    y, z = np.array([1, 2, 0]), np.array([2, 0, 1])
    sums: NDArray[Any] = np.stack(
        [
            np.einsum("rn,rn->r", left[y[i]], right[z[i]])
            - np.einsum("rn,rn->r", left[z[i]], right[y[i]])
            for i in range(3)
        ]
    )
    return sums
