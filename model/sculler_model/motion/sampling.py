"""What sensors deliver of a motion: exact increments, or rates, by quadrature."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from functools import lru_cache
from math import lgamma, log
from typing import Literal, NamedTuple

import numpy as np
from numpy.polynomial import legendre

from sculler_model.motion.compiled import loops
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


class PanelRule(NamedTuple):
    """Means over each of equal parts of a panel, from values at a few nodes of it.

    Attributes:
        nodes: (n,) on 0..1, the panel.
        weights: (m, n) of the nodes in the mean of each part.
    """

    nodes: Array
    weights: Array

    @property
    def shape(self) -> tuple[int, int]:
        """Parts, nodes."""
        many, nodes = self.weights.shape
        return many, nodes


_MOST_PARTS, _LONGEST_WAVE, _ROUGH_PHASE, _AT_ONCE = 64, 96.0, 0.125, 4096


@lru_cache(maxsize=64)
def panel_rule(phase: float, rough: float = 0.0) -> PanelRule:
    """The rule for a motion whose waves turn by so many radians in a sample interval.

    A panel of one sample is integrated by Gauss-Legendre quadrature.  In a panel of more, up to 64,
    the polynomial through its Gauss-Legendre nodes is integrated over each of them: over a wave of
    phase λ n nodes leave less than λ^n n!/(2n)! of its amplitude; n is the first that brings it
    below 1e-17.  The panel is the one that needs the fewest nodes a sample.

    Args:
        phase: of the highest frequency in the motion, rad.
        rough: of the highest frequency in what is no analytic function, rad: a panel then is at
            most 1/8 rad of it long, which is safe at the knots of a `Spline`.
    """
    nodes, weights = legendre_nodes(phase)
    best, fewest = 1, len(nodes)
    many = 2
    while many <= _MOST_PARTS and many * phase <= _LONGEST_WAVE and many * rough <= _ROUGH_PHASE:
        count = _panel_nodes(many * phase)
        if count * best < fewest * many:
            best, fewest = many, count
        many *= 2
    if best == 1:
        return PanelRule(nodes, weights[None])
    return _parts_of_a_panel(best, fewest)


def _panel_nodes(wave: float) -> int:
    """Nodes that are enough for a panel over a wave of so many radians."""
    n = 2
    while wave and n * log(wave) + lgamma(n + 1) - lgamma(2 * n + 1) > log(1e-17):
        n += 1
    return n


def _parts_of_a_panel(many: int, n: int) -> PanelRule:
    """The polynomial through n Gauss-Legendre nodes, integrated over each of equal parts."""
    nodes, gauss = legendre.leggauss(n)
    inner, shares = legendre.leggauss(n // 2 + 1)
    places = (2 * np.arange(many)[:, None] + 1 + inner) / many - 1
    # Lagrange's polynomials in barycentric form, exact to rounding for any n
    apart = places[..., None] - nodes
    met = apart == 0
    pull = (-1.0) ** np.arange(n) * np.sqrt((1 - nodes * nodes) * gauss)
    pull = np.where(met.any(-1, keepdims=True), met, pull / np.where(met, 1.0, apart))
    lagrange = pull / pull.sum(-1, keepdims=True)
    weights = np.einsum("jgi,g->ji", lagrange, 0.5 * shares)
    return PanelRule(0.5 * (nodes + 1), weights / weights.sum(axis=1, keepdims=True))


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

    @property
    def rough(self) -> float:
        """The same of what in `sensed` is no analytic function of time; 0 if all is."""
        return 0.0

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
        return interval * self._mean(first, samples, interval)

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
        if filtered:
            return self._mean(first, samples, interval, 0.5)
        return self.sensed((first + np.arange(samples, dtype=np.float64)) * interval)

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

    def _mean(self, first: int, samples: int, interval: float, lead: float = 0.0) -> Array:
        """Means of `sensed` from (i - lead) T to (i + 1 - lead) T, i from `first` on, (N, 6)."""
        rule = panel_rule(self.highest * interval, self.rough * interval)
        many, nodes = rule.shape
        begin = first // many * many  # panels stand still, wherever a chunk begins
        panels = -(-(first + samples - begin) // many)
        at_once = max(1, _AT_ONCE // nodes)
        parts = []
        for panel in range(0, panels, at_once):
            count = min(at_once, panels - panel)
            number = begin + many * (panel + np.arange(count, dtype=np.float64)) - lead
            t = (number + many * rule.nodes[:, None]) * interval
            values = self.sensed(t.ravel()).reshape(nodes, count, 6)
            parts.append(_means(rule.weights, values).reshape(-1, 6))
        return np.concatenate(parts)[first - begin : first - begin + samples]


def _means(weights: Array, values: Array) -> Array:
    """Weights (m, n) times values (n, panels, 6), one after the other: (panels, m, 6)."""
    many, panels = len(weights), values.shape[1]
    machine = loops(0, values.dtype)
    if machine is not None:
        found = np.empty((panels, many, 6))
        machine.mean(np.ascontiguousarray(weights.T), values, found)
        return found
    total = np.zeros((many, panels, 6))
    share = np.empty_like(total)
    for each, value in zip(weights.T, values, strict=True):
        np.multiply(each[:, None, None], value, out=share)
        total += share
    return total.swapaxes(0, 1)
