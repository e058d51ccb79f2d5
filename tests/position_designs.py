"""Designs with high-resolution position, and the counts that drive scrolling furthest."""

from __future__ import annotations

from functools import lru_cache
from operator import mul
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sculler_model.algorithms import scrolling_weight
from sculler_model.design import Design, Interval
from strategies import Counts, make_design


def _design(
    name: str, samples: int, history: int, minors: int, bits: tuple[int, int], **table: Any
) -> Design:
    return make_design(
        *(name, samples, history, minors, bits),
        options={"position": "high-resolution"},
        hardware={"core": "compact"},
        **table,
    )


_ALL = [
    # a result at every sample: each is an interval's first and last
    _design("smallest_hr", 1, 1, 1, (8, 9)),
    _design("savage_hr", 1, 1, 6, (16, 12)),
    _design("stim300_hr", 4, 0, 5, (24, 24)),
    _design("wide_hr", 4, 0, 5, (32, 32)),
    _design("taylor_2p1_hr", 2, 1, 7, (24, 16)),
    # one minor interval, which is first and last, and long history
    _design("taylor_3p3_hr", 3, 3, 1, (8, 32)),
    # taps in other phases than the last
    _design("dense_hr", 3, 0, 4, (11, 20), denominator=7, taps=[[0, -3, 0, 5], [], [1, 0, -2]]),
    # so many samples that the weights pass 18 bits
    _design("long_hr", 3, 0, 70, (10, 8)),
    # a product of two digits by two in C, whose range would need two
    _design("edge_hr", 4, 0, 10, (13, 8)),
]

HIGH_RESOLUTION: dict[str, Design] = {design.name: design for design in _ALL}
"""By name: n 1-4, p 0-n, M 1-70, widths 8-32, all on the compact core."""


def furthest(design: Design, axis: int, sign: int) -> Counts:
    """Counts whose second major interval has a scrolling component near its extreme.

    scrolling_x = Σ c_ij (s_y[i] r_z[j] - s_z[i] r_y[j]), where i and j run over the interval and
    the sample before it.  For given s_y the best r_z follows count by count from the sign of its
    factor, and the other way round: so in turns, until nothing gets better.

    Args:
        design: a design of `HIGH_RESOLUTION`.
        axis: of the component, 0..2.
        sign: 1 for the greatest, -1 for the least value.
    """
    samples, words = design.samples_per_major, design.words
    form = _form(samples)
    counts = np.zeros((2 * samples, 6), np.int64)
    for i, j, side in ((1, 2, sign), (2, 1, -sign)):
        s, r = _furthest(side * form, words.gyro, words.accel)
        counts[samples - 1 :, (axis + i) % 3] = s
        counts[samples - 1 :, 3 + (axis + j) % 3] = r
    return counts


@lru_cache
def _form(samples: int) -> NDArray[np.int64]:
    every = range(samples + 1)
    return np.array([[scrolling_weight(i, j, samples) for j in every] for i in every])


def _furthest(
    form: NDArray[np.int64], s_box: Interval, r_box: Interval
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """s and r of near greatest s' form r: the best from several starts."""
    rng = np.random.default_rng(5)
    found = []
    for _ in range(8):
        s = rng.choice((s_box.lo, s_box.hi), len(form))
        values = [-1]
        while len(values) < 2 or values[-1] > values[-2]:
            r = np.where(s @ form > 0, r_box.hi, r_box.lo)
            s = np.where(form @ r > 0, s_box.hi, s_box.lo)
            values.append(sum(map(mul, s.tolist(), (form @ r).tolist())))
        found.append((values[-1], s, r))
    _, s, r = max(found, key=lambda each: each[0])
    return s, r
