"""The twin of `golden.Compensator` for arrays of counts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sculler_model.design import CompensationPlan

Marks = NDArray[np.int64]
"""Numbers of samples that carry a mark, in order."""


class FastCompensator:
    """Makes the core's samples of blocks of the sensor's counts.

    A compensated sample fits 64 bits (`CompensationPlan.ranges`), so what wraps on the way to it
    wraps back.

    Args:
        plan: the integers.

    Attributes:
        kept: the last `reach` counts, the oldest first; zeros before the first.
    """

    def __init__(self, plan: CompensationPlan) -> None:
        self.plan = plan
        self.kept: NDArray[np.int64] = np.zeros((plan.reach, 6), np.int64)

    def __call__(self, counts: NDArray[np.integer]) -> NDArray[np.int64]:
        """(N, 6) samples of the core of the sensor's next (N, 6) counts."""
        reach, many = self.plan.reach, len(counts)
        rows = np.concatenate([self.kept, counts]).astype(np.int64)
        self.kept = rows[many:].copy()
        made = np.tile(np.array(self.plan.offsets, np.int64), (many, 1))
        for i, terms in enumerate(self.plan.outputs):
            for source, lag, factor in terms:
                made[:, i] += factor * rows[reach - lag : reach - lag + many, source]
        for i, products in enumerate(self.plan.products):
            for first, second, lag, factor in products:
                then = rows[reach - lag : reach - lag + many]
                made[:, i] += factor * (then[:, first] * then[:, second])
        return made

    def spread(self, marked: Marks) -> Marks:
        """The samples of the core that marked samples of the sensor go into, each once."""
        later = marked[:, None] + np.arange(self.plan.reach + 1)
        return np.unique(later)
