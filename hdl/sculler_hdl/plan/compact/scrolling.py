"""High-resolution position: each sample counted at once as the interval's end will have it.

The page (`algorithms.scrolling`) integrates twice, sample after sample.  The core knows how many
samples q are still to come, and so keeps one sum for each result: what the result would be if only
zeros came.  No sum can therefore leave the range of its result.  With s and r the newest sample,
s' and r' the one before, and alpha, nu, s_alpha, s_nu as they were before the newest:

    s_alpha   += w s                    s_nu += w r
    C          = c_alpha alpha + c_1 s' + c_0 s - 60 s_alpha
    D          = d_nu nu + d_1 r' + 60 s_nu
    scrolling += C x r + D x s
    alpha     += s                      nu += r

In the interval's first sample s_alpha and s_nu begin with s' and r', and scrolling with E x r',
E = 18 s'.  The numbers w, c and d are `WEIGHTS`.

Why: a sample counts in s_alpha 5 times at once, once more with the next and 12 times with each to
come, 6 + 12 q together but for the interval's last.  Savage-98 Eq. 105, multiplied out, is

    scrolling += 360 (sculling + 2 alpha x nu)
               + (780 alpha + 102 s' - 42 s - 60 S_alpha) x r + (1020 nu + 78 r' + 60 S_nu) x s
               + (300 alpha + 18 s') x r' + 60 nu x s'

where sculling + 2 alpha x nu, which grows by (8 alpha + s' + 2 s) x r + (4 nu + r') x s, counts in
each of the q to come; where the last line is known a sample earlier, as (300 alpha + 258 s) x r +
60 nu x s and, from before the interval, 18 s' x r'; and where the page's S_alpha, which does not
look ahead, is s_alpha - 12 (q + 1) alpha - s', S_nu alike.
"""

from __future__ import annotations

from typing import NamedTuple

from sculler_model.design import Interval


class Weight(NamedTuple):
    """A number that goes down by `step` with each sample of a major interval.

    Attributes:
        name: as above.
        step: more of it for each sample still to come.
        least: with none to come, were it not for `last`.
        last: what the interval's last sample adds to it.
    """

    name: str
    step: int
    least: int
    last: int

    def at(self, to_come: int) -> int:
        """Its value with so many samples to come, `last` apart."""
        return self.least + self.step * to_come

    def range(self, samples: int) -> Interval:
        """Its range over a major interval of so many samples."""
        values = [self.at(0) + self.last]
        if samples > 1:
            values += [self.at(1), self.at(samples - 1)]
        return Interval(min(values), max(values))


C_ALPHA = Weight("c_alpha", 3600, 1800, -300)
C_1 = Weight("c_1", 360, 162, 0)
C_0 = Weight("c_0", 720, 216, -258)
D_NU = Weight("d_nu", 720, 360, -60)
D_1 = Weight("d_1", 360, 18, 0)
W = Weight("w", 12, 6, -1)

WEIGHTS = (C_ALPHA, C_1, C_0, D_NU, D_1, W)
"""In the order in which they are needed first."""
LEFT_WEIGHTED = (C_ALPHA, D_NU)
"""Weights of left operands, right operands themselves; the others are of samples."""

S_WEIGHT = 60
"""Of s_nu in D, and of -s_alpha in C."""
FIRST_WEIGHT = 18
"""Of s' x r' in the interval's first sample."""


def factor_ranges(gyro: Interval, accel: Interval, samples: int) -> tuple[Interval, Interval]:
    """Ranges that hold the components of C and of D, by the magnitudes of all their weights.

    Args:
        gyro, accel: of the counts.
        samples: N, samples in a major interval.
    """
    most_c = most_d = 0
    for before in range(samples):  # samples of the interval before the newest
        to_come = samples - 1 - before
        doubly = S_WEIGHT * (6 * before * (2 * samples - before) + 1)  # their w, and of s' or r'
        c = C_ALPHA.at(to_come) * before + C_1.at(to_come) + C_0.at(to_come)
        d = D_NU.at(to_come) * before + D_1.at(to_come)
        most_c, most_d = max(most_c, c + doubly), max(most_d, d + doubly)
    return gyro.repeated(most_c) | -gyro.repeated(most_c), accel.repeated(most_d)
