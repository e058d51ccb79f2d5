"""The reference of what stands before the core: (C1) of `design.CompensationPlan`, in plain Python.

y_i(t) = Σ factor · x_source(t - lag) + Σ factor · x_first(t - lag) x_second(t - lag) + offset_i
"""

from __future__ import annotations

from collections import deque

from sculler_model.algorithms import Vec
from sculler_model.design import CompensationPlan

Counts = tuple[int, ...]


class Compensator:
    """Makes each sample of the core of the sensor's counts up to it.

    Counts before the first are zero.

    Args:
        plan: the integers.
    """

    def __init__(self, plan: CompensationPlan) -> None:
        self.plan = plan
        kept = plan.reach + 1
        self._counts: deque[Counts] = deque([(0,) * 6] * kept, kept)  # the newest first
        self._marks: deque[tuple[int, bool]] = deque([(0, False)] * kept, kept)

    def step(self, gyro: Vec, accel: Vec, fault: int, rail: bool) -> tuple[Vec, Vec, int, bool]:
        """Take the sensor's next sample.

        Args:
            gyro, accel: counts.
            fault: the sensor's mark.
            rail: whether a count stands at its rail.

        Returns:
            The core's sample: three integers for the gyros and three for the accelerometers, over
            D; and fault and rail of the samples it is made of, the newest and `reach` before.
        """
        self._counts.appendleft((*gyro, *accel))
        self._marks.appendleft((fault, rail))
        x = self._counts
        parts = zip(self.plan.outputs, self.plan.products, self.plan.offsets, strict=True)
        y = [
            sum(factor * x[lag][source] for source, lag, factor in terms)
            + sum(factor * x[lag][one] * x[lag][two] for one, two, lag, factor in products)
            + offset
            for terms, products, offset in parts
        ]
        faults, rails = zip(*self._marks, strict=True)
        return (y[0], y[1], y[2]), (y[3], y[4], y[5]), int(any(faults)), any(rails)
