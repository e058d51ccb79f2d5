"""Third and fourth order for arrays: the exact twin of `algorithms.HigherOrder`.

A dual vector of R major intervals is an array (2, 3, R) of Python integers: angle and velocity,
axis, interval.  The minor intervals are taken one after another, all major intervals at once.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sculler_model.design import Design

Exact = NDArray[Any]
"""Python integers."""


class FastHigherOrder:
    """coning_third, sculling_third and those of fourth order of many major intervals at once.

    Args:
        design: of third or fourth order.
        history: rows before the first major interval.
    """

    def __init__(self, design: Design, history: int) -> None:
        self.n, self.M = design.table.samples, design.algorithm.minors
        self.order, self.history = design.order, history
        self.composition = design.composition
        self.taps = {
            k: [(d, c) for d, c in enumerate(design.table.taps[k - 1], start=1) if c]
            for k in design.table.active_phases
        }

    def components(self, rows: NDArray[Any]) -> Exact:
        """(R, 6 or 12) Python integers.

        Args:
            rows: (history + R n M, 6) gyro and accelerometer counts.
        """
        majors = (len(rows) - self.history) // (self.n * self.M)
        counts = np.ascontiguousarray(rows.T).astype(object).reshape(2, 3, -1)
        alpha, within, between, third, fourth = (np.zeros((2, 3, majors), object) for _ in range(5))
        for minor in range(self.M):

            def back(k: int, d: int, minor: int = minor) -> Exact:
                """The sample d before that of phase k, in every major interval."""
                first = self.history + minor * self.n + k - 1 - d
                return counts[:, :, first :: self.n * self.M][:, :, :majors]

            samples = [back(self.n, d) for d in range(self.n)]
            theta: Exact = sum(samples[1:], samples[0])
            kappa = self._kappa(back, majors)
            turned = _cross(alpha, theta)
            to_third, to_fourth = self._grown(
                samples, theta, alpha, within, between, kappa, turned, third
            )
            third, fourth = third + to_third, fourth + to_fourth
            alpha, within, between = alpha + theta, within + kappa, between + turned
        results = [third, fourth][: self.order - 2]
        return np.concatenate([each.reshape(6, majors) for each in results]).T

    def _kappa(self, back: Any, majors: int) -> Exact:
        """Products within the minor interval."""
        total = np.zeros((2, 3, majors), object)
        for k, row in self.taps.items():
            tapped = sum((c * back(k, d) for d, c in row), np.zeros_like(total))
            total = total + _cross(tapped, back(k, 0))
        return total

    def _grown(
        self,
        samples: list[Exact],
        theta: Exact,
        alpha: Exact,
        within: Exact,
        between: Exact,
        kappa: Exact,
        P: Exact,
        third: Exact,
    ) -> tuple[Exact, Exact]:
        """What a minor interval adds to the third and the fourth order."""
        c, taps = self.composition, self.composition.taps
        f, t, Dc = c.third_composed, c.third_triple, c.within

        def weighted(weights: tuple[int, ...]) -> Exact:
            return sum(
                (w * s for w, s in zip(weights, samples, strict=True) if w), np.zeros_like(theta)
            )

        b = 6 * within + Dc * (3 * between + P)
        k = 6 * kappa + Dc * P
        X = _cross(b, theta) + _cross(alpha, k)
        tau = _cross(theta, _cross(theta, weighted(taps.curvature)))
        tau = t * (tau + _cross(weighted(taps.slope), _cross(theta, weighted(taps.partner))))
        if self.order == 3:
            return tau + f * X, np.zeros_like(theta)
        p, q = f * Dc * _cross(P, theta), f * Dc * _cross(alpha, P)
        outer = _cross(6 * third + 2 * (f * X - p) + q, theta)
        outer = outer + _cross(alpha, 6 * tau + 2 * (f * X - q) + p)
        inner = _cross(theta, _cross(theta, _cross(theta, weighted(taps.fourth))))
        to_fourth = c.fourth_inner * inner + c.fourth_outer * outer
        return tau + f * X, to_fourth + c.fourth_pairs * _cross(b, k)


def _cross(a: Exact, b: Exact) -> Exact:
    """(a + εu) × (b + εv), each (2, 3, R)."""
    return np.stack([_plain(a[0], b[0]), _plain(a[0], b[1]) + _plain(a[1], b[0])])


def _plain(a: Exact, b: Exact) -> Exact:
    return np.stack(
        [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ]
    )
