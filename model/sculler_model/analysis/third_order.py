"""Third order in exact integers: a study of two more accumulators, which no hardware forms (yet).

Composing minor intervals to third order (Baker, Campbell, Hausdorff; for a rate in body axes the
bracket is the cross product) adds to the rotation vector of a major interval

    γ += ½ (β × θ + α × δ) + 1/12 (α - θ) × (α × θ)         every minor end, before α and β move on

with α, β the angle and coning so far, θ, δ those of the minor interval.  In the core's integers

    third_within  += coning_within × theta + alpha × within                     over 2·Dc·Dw
    third_between += 3 coning_between × theta + (alpha - theta) × (alpha × theta)   over 12·Dw³

where `within` is what this minor interval adds to coning_within.  It sees vibration that the host,
which gets only the sums over the major interval, cannot (`host.ThirdOrder` is for manoeuvres).
What is of third order inside one minor interval stays.  docs/explanation/analysis.md holds it
against simply taking shorter major intervals.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sculler_model.design import Design, Interval, cross_range
from sculler_model.fast import run_fast

Integers = NDArray[Any]
"""Python integers in an object array."""


@dataclass(frozen=True)
class ThirdOrderVectors:
    """The two accumulators of consecutive major intervals, each (R, 3) exact integers."""

    within: Integers
    between: Integers

    def rotation(self, design: Design) -> NDArray[np.float64]:
        """γ, (R, 3) rad: what to add to φ."""
        Dc, Dw = design.table.denominator, design.table.sum_denominator
        g = design.gyro_scale
        gamma: NDArray[np.float64] = g**3 * (
            self.within.astype(np.float64) / (2 * Dc * Dw)
            + self.between.astype(np.float64) / (12 * Dw**3)
        )
        return gamma


def third_order_vectors(design: Design, counts: ArrayLike) -> ThirdOrderVectors:
    """The accumulators of all complete major intervals of a sequence of samples.

    Args:
        design: the design.
        counts: (N, 6) as `FastModel.feed` takes them.

    Raises:
        InputError: as `FastModel.feed`.
    """
    return composed(*minor_vectors(design, counts), design.algorithm.minors)


def minor_vectors(design: Design, counts: ArrayLike) -> tuple[Integers, Integers]:
    """What each minor interval of a sequence of samples has of theta and of coning_within, (R, 3).

    Raises:
        InputError: as `FastModel.feed`.
    """
    # the same core with M = 1 hands over every minor interval's theta and within
    single = design.model_copy(
        update={"algorithm": design.algorithm.model_copy(update={"minors": 1})}
    )
    single = Design.parse(single.as_json())
    minors = run_fast(single, counts)
    return minors.vector("alpha").astype(object), minors.vector("coning_within").astype(object)


def composed(theta: Integers, within: Integers, minors: int) -> ThirdOrderVectors:
    """The accumulators of all complete major intervals.

    Args:
        theta, within: (R, 3) of consecutive minor intervals (`minor_vectors`).
        minors: M, of them in a major interval.
    """
    M, majors = minors, len(theta) // minors
    theta, within = (each[: majors * M].reshape(majors, M, 3) for each in (theta, within))
    alpha, coning_within, coning_between, third_within, third_between = (
        np.zeros((majors, 3), object) for _ in range(5)
    )
    for m in range(M):
        turned = _cross(alpha, theta[:, m])
        third_within = (
            third_within + _cross(coning_within, theta[:, m]) + _cross(alpha, within[:, m])
        )
        third_between = (
            third_between
            + 3 * _cross(coning_between, theta[:, m])
            + _cross(alpha - theta[:, m], turned)
        )
        coning_within = coning_within + within[:, m]
        coning_between = coning_between + turned
        alpha = alpha + theta[:, m]
    return ThirdOrderVectors(third_within, third_between)


def third_order_words(design: Design) -> dict[str, Interval]:
    """Ranges of the accumulators over all input sequences, as `word_lengths` finds the others."""
    words, M = design.words, design.algorithm.minors
    within = cross_range(words.coning_within, words.theta) + cross_range(
        words.alpha, words.coning_within
    )
    double = words.alpha + words.theta.scaled(-1)
    between = cross_range(words.coning_between, words.theta).scaled(3) + cross_range(
        double, cross_range(words.alpha, words.theta)
    )
    return {"third_within": within.repeated(M), "third_between": between.repeated(M)}


def _cross(a: Integers, b: Integers) -> Integers:
    """Row by row, without leaving Python integers."""
    ax, ay, az = a.T
    bx, by, bz = b.T
    return np.stack((ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx), axis=1)
