"""Samples through the sensor's own filter, for motions whose samples passed nothing yet."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sculler_model.algorithms import Digital
from sculler_model.design import Design

Array = NDArray[np.float64]


class Passing:
    """The filter of a design's sensor, run over its samples block by block.

    It is exact where every stage is a digital filter that is clocked with the samples, and the
    sensor counts increments; elsewhere nothing is done, and `left_out` says so.  Before the first
    sample everything stood as in that sample, which a filter lets through as it is.

    Args:
        design: `sensor.filter` is what counts.

    Attributes:
        left_out: whether there is a filter that this cannot run.
    """

    def __init__(self, design: Design) -> None:
        response = design.sensor_response
        stages = () if response is None else response.stages
        self._stages: list[_Stage] = []
        for stage in stages:
            if isinstance(stage, Digital) and stage.step == 1:
                self._stages.append(_Stage(stage))
        self.left_out = len(self._stages) < len(stages)
        if design.sensor.kind == "rate" and stages:
            self.left_out = True
        if self.left_out:
            self._stages = []

    def __call__(self, samples: Array) -> Array:
        """The next samples (N, 6) as the sensor hands them over."""
        for stage in self._stages:
            samples = stage(samples)
        return samples


class _Stage:
    """y_t = Σ b_k x_(t-k) - Σ_(k>0) a_k y_(t-k), with a_0 = 1 and no gain at zero frequency."""

    def __init__(self, filter: Digital) -> None:
        top, bottom = (
            np.array([float(c) for c in part]) for part in (filter.numerator, filter.denominator)
        )
        self._b = top * (bottom.sum() / top.sum() / bottom[0])
        self._a = bottom[1:] / bottom[0]
        self._before: tuple[Array, Array] | None = None

    def __call__(self, x: Array) -> Array:
        if not len(x):
            return x
        back = max(len(self._b), len(self._a) + 1) - 1
        if self._before is None:
            still = np.repeat(x[:1], back, axis=0)
            self._before = still, still
        past, answered = self._before
        whole = np.concatenate((past, x))
        y = np.zeros((back + len(x), x.shape[1]))
        y[:back] = answered
        for k, b in enumerate(self._b):
            y[back:] += b * whole[back - k : len(whole) - k]
        if len(self._a):
            newest_last = self._a[::-1]
            for t in range(back, len(y)):
                y[t] -= newest_last @ y[t - len(self._a) : t]
        kept = len(whole) - back
        self._before = whole[kept:], y[kept:]
        return y[back:]
