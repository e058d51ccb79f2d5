"""Designs with channels, and samples for them at random."""

from __future__ import annotations

import numpy as np

from sculler_model.design import Design
from strategies import DESIGNS, make_design, with_hardware

OWN = {
    design.name: design
    for design in (
        # its last phase has no tap, so that what an earlier one summed up is told by it
        make_design("early_taps_2", 2, 1, 1, (8, 9), denominator=3, taps=[[2, 1], []]),
        make_design("both_taps_2", 2, 1, 1, (8, 9), denominator=3, taps=[[0, 2], [-1]]),
    )
}


def many(name: str, **hardware: object) -> Design:
    return with_hardware((DESIGNS | OWN)[name], **{"core": "compact", **hardware})


def drawn(design: Design, samples: int, seed: int) -> tuple[np.ndarray, ...]:
    """Counts, channels, faults and restarts at random."""
    rng = np.random.default_rng(seed)
    words = design.words
    lo = np.array([words.gyro.lo] * 3 + [words.accel.lo] * 3)
    hi = np.array([words.gyro.hi] * 3 + [words.accel.hi] * 3)
    counts, edge = rng.integers(lo, hi + 1, (samples, 6)), rng.random((samples, 6))
    counts = np.where(edge < 0.02, lo, np.where(edge > 0.98, hi, counts))
    channels = rng.integers(0, design.channels, samples)
    marks = rng.random((2, samples)) < [[0.05], [0.03]]
    return counts, channels, *marks.astype(int)
