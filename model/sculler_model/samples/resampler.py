"""Samples at their own instants to increments on a uniform grid, streaming.

What an IMU log gives as rates at instants, or as increments over unequal steps, becomes the
increments over equal steps that a strapdown algorithm wants.  Between two samples a curve is taken
as the cubic through the two and their two neighbours:

* Rates: the cubic is integrated exactly.  With equal steps h that is the four-point rule
  h/24·(-1, 13, 13, -1), whose error is 11/720·h⁵·ω'''' where the trapezoid leaves -1/12·h³·ω''.  A
  coning motion of frequency Ω is seen with 1 - 11/360·(Ωh)⁴ of its true drift, by the trapezoid
  with 1 - (Ωh)²/6: of the 3948 °/h of a half angle of 1° at 20 Hz, sampled at 1 kHz, the one loses
  0.030 °/h and the other 10.4 °/h.
* Increments: the cubic interpolates their running total, so that the grid's increments add up to
  the same total whatever the steps.

At the first and the last step, which have a neighbour on one side only, the cubic goes through the
four samples at that end.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sculler_model.algorithms import SensorKind
from sculler_model.errors import InputError

Kind: TypeAlias = SensorKind
"""What samples are: increments over steps, or rates at instants."""

_NODES = 4
_GAUSS = 0.5 / np.sqrt(3.0)  # two-point Gauss-Legendre: exact for cubics
_ON_GRID = 1e-6  # of the interval: a stamp this close before a grid point reaches it


class Gridded(NamedTuple):
    """Consecutive samples on the grid.

    Attributes:
        values: (N, C) increments over the N steps of the grid, or rates at N of its points.
        faults: (N,) 1 where a faulty sample or step took part.
        times: (N,) s on the scale of the given stamps: the ends of the steps, or the instants of
            the rates (of means over a step its middle).
    """

    values: NDArray[np.float64]
    faults: NDArray[np.uint8]
    times: NDArray[np.float64]


class Resampler:
    """Brings samples with time stamps to a grid of equal steps, streaming.

    The grid begins where the log does: at the first stamp for rates; one interval before it for
    increments, since a stamp is the end of its increment's step and nothing tells how long the
    first one was.  Point k of the grid is k intervals later.  What lies after the last point
    that the stamps reach is left out.  However the input is cut, the output is the same to
    rounding.

    Args:
        interval: step of the grid, s.
        given: whether the samples are rates (unit/s) at their stamps, or increments (unit) over
            the step from the stamp before to their own.
        wanted: increments over the steps of the grid, or rates: of given rates their values at
            the grid's points, of given increments their mean over each step of the grid.

    Raises:
        InputError: the interval is not a number > 0.
    """

    def __init__(self, interval: float, given: Kind, wanted: Kind) -> None:
        if not (np.isfinite(interval) and interval > 0):
            raise InputError(f"interval: {interval} s is not allowed, give a number > 0")
        self._T, self._given, self._wanted = interval, given, wanted
        self._points_only = given == wanted == "rate"
        self._times = np.empty(0)  # of the nodes that are still needed
        self._nodes = np.empty((0, 0))  # rates, or the running total of the increments
        self._flags = np.empty(0, np.int64)  # whether the step that ends at the node is faulty
        self._last_fault = 0  # of the last sample
        self._done = 0  # index in _times: steps that end here or before are worked off
        self._origin = 0.0  # time of the grid's point 0
        self._next = 0 if self._points_only else 1  # grid point to give next
        self._total: NDArray[np.float64] = np.empty(0)  # integral from the last grid point to here
        self._tail_fault = 0  # whether a faulty step lies between that point and here

    def __call__(
        self,
        times: NDArray[np.float64],
        values: NDArray[np.float64],
        faults: NDArray[np.uint8] | None = None,
    ) -> Gridded:
        """What the grid has up to the last step whose neighbours are all known.

        Args:
            times: (N,) stamps, s, growing.
            values: (N, C).
            faults: (N,) of 0 and 1; None for none.
        """
        times, values = np.asarray(times, np.float64), np.asarray(values, np.float64)
        if not len(times):
            return self._empty(values.shape[1])
        flags = np.zeros(len(times), np.int64) if faults is None else faults.astype(np.int64)
        first = not len(self._times)
        if self._given == "increment":
            if first:
                self._begin(float(times[0]) - self._T, values.shape[1])
                self._times = np.array([self._origin])
                self._nodes = np.zeros((1, values.shape[1]))
                self._flags = np.zeros(1, np.int64)
            nodes = self._nodes[-1] + np.cumsum(values, axis=0)
            steps = flags
        else:
            if first:
                self._begin(float(times[0]), values.shape[1])
                self._nodes = np.empty((0, values.shape[1]))
            nodes = values
            before = flags[0] if first else self._last_fault
            steps = flags | np.concatenate([[before], flags[:-1]])
            self._last_fault = int(flags[-1])
        self._times = np.concatenate([self._times, times])
        self._nodes = np.concatenate([self._nodes, nodes])
        self._flags = np.concatenate([self._flags, steps])
        if len(self._times) < _NODES:
            return self._empty(values.shape[1])
        return self._work(len(self._times) - 2)

    def finish(self) -> Gridded:
        """The rest, once no more samples come."""
        if not len(self._times):
            return self._empty(0)
        return self._work(len(self._times) - 1)

    @property
    def left_out(self) -> float:
        """Seconds from the last grid point given to the last stamp."""
        if not len(self._times):
            return 0.0
        return float(self._times[-1]) - (self._origin + (self._next - 1) * self._T)

    def _begin(self, origin: float, columns: int) -> None:
        self._origin = origin
        self._total = np.zeros(columns)

    def _empty(self, columns: int) -> Gridded:
        return Gridded(np.empty((0, columns)), np.empty(0, np.uint8), np.empty(0))

    def _work(self, end: int) -> Gridded:
        """Work off the steps that end at nodes `_done` + 1 to `end`."""
        begin, T = self._done, self._T
        times, nodes = self._times, self._nodes
        reach = (times[end] - self._origin) / T + _ON_GRID
        points = np.arange(self._next, int(np.floor(reach)) + 1)
        instants = self._origin + points.astype(np.float64) * T
        at = np.minimum(instants, times[end])
        # the step that holds each point: from node step - 1 to node step
        step = np.clip(np.searchsorted(times, at, side="left"), begin + 1, max(end, begin + 1))
        if self._points_only:
            if len(times) == 1:
                step = np.zeros_like(step)
            given = self._curve(step, at), self._flags[step].astype(np.uint8)
        else:
            given = self._increments(begin, end, step, at)
        self._next += len(points)
        drop = max(0, end - 2)  # the last step of all wants the four last nodes
        self._times, self._nodes, self._flags = times[drop:], nodes[drop:], self._flags[drop:]
        self._done = end - drop
        if self._given == "increment":
            self._nodes = self._nodes - self._nodes[-1]  # keeps the running total small
        if self._given == "increment" and self._wanted == "rate":
            instants = instants - 0.5 * T  # the mean over a step is the rate in its middle
        return Gridded(*given, instants)

    def _increments(
        self, begin: int, end: int, step: NDArray[np.int64], at: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.uint8]]:
        """Increments over the grid's steps that end at times `at`, in the given steps; faults."""
        nodes = self._nodes
        if self._given == "rate":
            steps = np.arange(begin + 1, end + 1)
            whole = self._integral(steps, self._times[steps])
            running = np.concatenate([np.zeros((1, nodes.shape[1])), np.cumsum(whole, axis=0)])
            totals = running[step - 1 - begin] + self._integral(step, at)
            rest = running[-1]
        else:
            totals = self._curve(step, at) - nodes[begin]
            rest = nodes[end] - nodes[begin]
        totals = totals + self._total
        values = np.diff(totals, axis=0, prepend=np.zeros((1, nodes.shape[1])))
        self._total = self._total + rest - (totals[-1] if len(totals) else 0.0)

        # faulty steps up to and with each; a grid step takes those from its own first to its last
        count = np.concatenate([[self._tail_fault], self._flags[begin + 1 : end + 1]]).cumsum()
        upto = count[step - begin] if end > begin else np.zeros(0, np.int64)
        before = count[step - 1 - begin] if end > begin else np.zeros(0, np.int64)
        # the next grid step begins within this given step, unless the point is the step's end
        inside = at < self._times[step] - _ON_GRID * self._T
        start = np.where(inside, before, upto)
        faults = upto > np.concatenate([[0], start[:-1]])[: len(upto)]
        self._tail_fault = int(count[-1] > (start[-1] if len(start) else 0))

        if self._wanted == "rate":
            values = values / self._T
        return values, faults.astype(np.uint8)

    def _window(self, step: NDArray[np.int64]) -> NDArray[np.int64]:
        """(N, up to 4) nodes of the curve over each step: its ends and their neighbours."""
        size = min(_NODES, len(self._times))
        first = np.clip(step - 2, 0, len(self._times) - size)
        return first[:, None] + np.arange(size)

    def _curve(self, step: NDArray[np.int64], at: NDArray[np.float64]) -> NDArray[np.float64]:
        """(N, C) values at times `at` of the cubic over each step."""
        window = self._window(step)
        weights = lagrange_weights(self._times[window], at)
        value: NDArray[np.float64] = np.einsum("nk,nkc->nc", weights, self._nodes[window])
        return value

    def _integral(self, step: NDArray[np.int64], to: NDArray[np.float64]) -> NDArray[np.float64]:
        """(N, C) integrals of the cubic from the step's beginning to times `to`."""
        begin = self._times[step - 1]
        length, middle = to - begin, 0.5 * (begin + to)
        ends = [self._curve(step, middle + sign * _GAUSS * length) for sign in (-1.0, 1.0)]
        integral: NDArray[np.float64] = 0.5 * length[:, None] * (ends[0] + ends[1])
        return integral


def lagrange_weights(nodes: NDArray[np.float64], at: NDArray[np.float64]) -> NDArray[np.float64]:
    """Weights of the polynomial through values at the nodes.

    Args:
        nodes: (N, m) distinct instants.
        at: (N,) where each polynomial is wanted.

    Returns:
        (N, m): the value is the sum of weight times node value.
    """
    count = nodes.shape[1]
    from_node = at[:, None] - nodes
    weights = np.ones_like(nodes)
    for k in range(count):
        for other in range(count):
            if other != k:
                weights[:, k] *= from_node[:, other] / (nodes[:, k] - nodes[:, other])
    return weights
