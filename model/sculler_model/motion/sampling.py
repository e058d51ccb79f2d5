"""What sensors deliver of a motion: exact increments, or rates, by quadrature."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from math import lgamma, log
from typing import Literal

import numpy as np

from sculler_model.motion.curves import Array

CHUNK = 1 << 15
"""Samples generated at a time."""


def legendre_nodes(phase: float) -> tuple[Array, Array]:
    """Gauss-Legendre nodes and weights on 0..1, enough for a wave of so many radians.

    The error of n nodes over a wave of phase λ is λ^(2n) (n!)^4 / ((2n+1) ((2n)!)³) of the
    wave's amplitude; n is the first that brings it below 1e-17.
    """
    n = 2
    if phase > 0:
        while (
            2 * n * log(phase) + 4 * lgamma(n + 1) - log(2 * n + 1) - 3 * lgamma(2 * n + 1)
        ) > log(1e-17):
            n += 1
    nodes, weights = np.polynomial.legendre.leggauss(n)
    return 0.5 * (nodes + 1), 0.5 * weights


class Sampled(ABC):
    """Samples of perfect sensors from what they feel at any instant."""

    @abstractmethod
    def sensed(self, t: Array) -> Array:
        """What perfect sensors feel at times t (N,).

        Returns:
            (N, 6): ω_ib (rad/s), then specific force (m/s²), in the body frame.
        """

    @property
    @abstractmethod
    def highest(self) -> float:
        """A bound on the frequencies (rad/s) that matter in `sensed`."""

    def increments(self, samples: int, interval: float, first: int = 0) -> Array:
        """Exact integrals of `sensed` over sample intervals.

        Args:
            samples: N, how many.
            interval: T, s.
            first: number of the first sample; sample i covers the time from i T to (i+1) T.

        Returns:
            (N, 6): angle increments (rad) and velocity increments (m/s), to about 1e-15 of their
            size, vibrations to the rounding of their phase Ω t.
        """
        return interval * self._mean(first + np.arange(samples, dtype=np.float64), interval)

    def rates(self, samples: int, interval: float, first: int = 0, filtered: bool = True) -> Array:
        """What rate sensors deliver.

        Args:
            samples: N, how many.
            interval: T, s.
            first: number of the first sample; sample i is the rate at time i T
                (`sculler_model.samples`).
            filtered: average over T, centred: Zeng's filter sinc(Ω T/2); else the plain value.

        Returns:
            (N, 6): rad/s and m/s².
        """
        number = first + np.arange(samples, dtype=np.float64)
        if filtered:
            return self._mean(number - 0.5, interval)
        return self.sensed(number * interval)

    def chunks(
        self,
        kind: Literal["increment", "rate"],
        samples: int,
        interval: float,
        chunk: int | None = None,
    ) -> Iterator[Array]:
        """Samples from time 0 on for a sensor of a kind, block by block, in bounded memory.

        The first increment begins there; the first rate is the one at time 0, and where it is
        averaged over T the motion half a sample before that takes part.

        Args:
            kind: what the sensor delivers.
            samples: how many in all.
            interval: T, s.
            chunk: samples of a block, `CHUNK` if left out.

        Yields:
            (N, 6) as `increments` and `rates` give them.
        """
        chunk = chunk or CHUNK
        for first in range(0, samples, chunk):
            count = min(chunk, samples - first)
            if kind == "increment":
                yield self.increments(count, interval, first)
            else:
                yield self.rates(count, interval, first)

    def _mean(self, number: Array, interval: float) -> Array:
        """Mean of `sensed` from number·T to (number+1)·T, by Gauss-Legendre quadrature."""
        nodes, weights = legendre_nodes(self.highest * interval)
        total = np.zeros((len(number), 6))
        for node, weight in zip(nodes, weights, strict=True):
            total += weight * self.sensed((number + node) * interval)
        return total
