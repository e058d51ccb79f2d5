"""What the LSB does to the coning correction: theory, and Monte Carlo through the integer path.

A sensor that carries its remainder gives ``s[t] = true increment + LSB·(q[t] - q[t-1])``, s = Dθ
for short, with the remainder q in ±½.  Where every sample counts alike the angle is never off by
more than an LSB, and all that accumulates does so through the products.  The correction of a
whole record about z is a bilinear form of the samples, C = s_xᵀ K s_y with K = -Kᵀ; so with q white
and uniform, of variance 1/12, quantisation adds to C no mean and the variance

    LSB²/12 · ( |Dᵀ K s_x|² + |Dᵀ K s_y|² )  +  LSB⁴/144 · |Dᵀ K D|²

The first term is remainder times motion, the second remainder times remainder, there even at rest.
For increments Dᵀ K D is a band along the diagonal and the second term grows with the record; with
weights that differ, as those of Newton and Cotes for rates do, its far entries do not vanish: the
remainders then no longer cancel, and the angle itself walks.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, pi, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from sculler_model.algorithms import TapTable
from sculler_model.analysis.frequency import Cone, drift, record, stated_filter
from sculler_model.analysis.integer_path import changed
from sculler_model.design import Design
from sculler_model.fast import FastModel, VectorBlock
from sculler_model.host import major_increments, second_order_corrections
from sculler_model.samples import Quantiser

Array = NDArray[np.float64]

TRIAL_SAMPLES = 4000
"""Samples of a trial, at least."""


@dataclass(frozen=True)
class QuantisationError:
    """Quantisation error at one LSB; rates are rad/s over a trial's record.

    Attributes:
        lsb: rad (of a rate sensor: rad/s times the sample interval).
        counts: the largest sample in counts.
        mean, deviation: of the drift that quantisation adds, over the trials.
        theory: its standard deviation, for a white remainder.
        angle_error: the largest error of the angle over the record, in LSB; None for rates, whose
            sums are not the angle.
    """

    lsb: float
    counts: float
    mean: float
    deviation: float
    theory: float
    angle_error: float | None


def products_with(table: TapTable, s: Array) -> Array:
    """K s of a record that consists of whole minor intervals.

    Args:
        table: the tap table.
        s: (N,) samples about one axis.

    Returns:
        (N,): entry t is what a sample at t about the other axis is multiplied with in C.
    """
    n, N = table.samples, len(s)
    out = np.zeros(N)
    for k in table.active_phases:
        t = np.arange(k - 1, N, n)
        for d, tap in enumerate(table.taps[k - 1], start=1):
            if tap:
                late = t[t >= d]
                c = tap / table.denominator
                np.add.at(out, late - d, c * s[late])
                np.subtract.at(out, late, c * s[late - d])
    ends = np.arange(n - 1, N, n)
    weights = [(d, w / table.sum_denominator) for d, w in enumerate(table.weights) if w]
    theta = np.zeros(len(ends))
    for d, w in weights:
        theta[ends >= d] += w * s[ends[ends >= d] - d]
    until = np.cumsum(theta)
    later_less_earlier = (until[-1] - until) - (until - theta)
    for d, w in weights:
        np.add.at(out, ends[ends >= d] - d, 0.5 * w * later_less_earlier[ends >= d])
    return out


def form(table: TapTable, minors: int) -> Array:
    """Dᵀ K D of a record of so many minor intervals, (N - 1, N - 1), its last sample left out."""
    unit = np.eye(minors * table.samples)
    K = np.stack([products_with(table, column) for column in unit], axis=1)
    result: Array = np.diff(np.diff(K, axis=0), axis=1)
    return result


def _form_power(table: TapTable, minors: int) -> float:
    """|Dᵀ K D|² of a long record, from its middle rows and its far entries."""
    n = table.samples
    aside = -(-(table.history + 2) // n) + 1  # minor intervals that the products reach, on a side
    B = form(table, 2 * aside + 3)
    first = (aside + 1) * n
    rows = B[first : first + n]
    near = float(np.sum(rows[:, n : n + (2 * aside + 1) * n] ** 2))
    far = float(np.sum(rows[:, :n] ** 2))
    return minors * (near + max(minors - 2 * aside - 1, 0) * far)


def deviation(design: Design, half_angle: float, hertz: float, lsb: float, samples: int) -> float:
    """Theory: standard deviation of the drift (rad/s) that quantisation adds over a record.

    Args:
        design: gives table and sample rate.
        half_angle: a, rad.
        hertz: the coning's frequency.
        lsb: rad per count of the products.
        samples: length of the record, whole minor intervals.
    """
    phase = 2 * pi * hertz * design.sample_interval
    size, response = 2 * sin(half_angle) * sin(phase / 2), stated_filter(design)
    if response is not None:
        unfiltered = size if design.sensor.kind == "increment" else sin(half_angle) * phase
        size = unfiltered * abs(response.value(phase))
    turn = phase * np.arange(samples)
    linear = sum(
        float(np.sum(np.diff(products_with(design.table, size * wave)) ** 2))
        for wave in (np.cos(turn), np.sin(turn))
    )
    square = _form_power(design.table, samples // design.table.samples)
    return sqrt(lsb**2 / 12 * linear + lsb**4 / 144 * square) / (samples * design.sample_interval)


def monte_carlo(
    design: Design, half_angle: float, hertz: float, lsb: float, trials: int, seed: int
) -> QuantisationError:
    """Run trials through the integer path, each with its own phase and starting remainder.

    The half angle too differs from trial to trial, by up to 2 %: a pure tone meets the same
    remainders again and again, which a real vibration does not.  At a few counts of amplitude that
    is not enough, and the remainders are not white.

    Args:
        design: the design; its sensor's LSB is replaced, its word by one of 32 bits.
        half_angle, hertz: the coning.
        lsb: rad per count of the products.
        trials: how many, 2 or more.
        seed: the same one gives the same result.

    Raises:
        InputError: the coning does not fit 32 bits of so fine an LSB, or is out of range.
    """
    rate = design.sensor.kind == "rate"
    count_lsb = lsb / design.sample_interval if rate else lsb
    design = changed(design, sensor={"gyro": {"bits": 32, "lsb": count_lsb}})
    periods, samples = record(design, hertz, TRIAL_SAMPLES)
    seconds = samples * design.sample_interval
    hertz = periods / seconds
    omega = 2 * pi * hertz
    span = design.samples_per_major
    before = -(-(design.table.history + 1) // span)  # no tap reaches before the first sample

    random = np.random.default_rng(seed)
    core = FastModel(design)
    added, largest = np.empty(trials), 0.0
    for trial in range(trials):
        cone = Cone(half_angle * random.uniform(0.98, 1.02))
        inputs = cone.samples(design, omega, samples + before * span)
        turn = random.uniform(0.0, 2 * pi)  # about the cone's axis: any phase, not only a sample's
        turned = np.array([[cos(turn), sin(turn)], [-sin(turn), cos(turn)]])
        inputs[:, :2] = inputs[:, :2] @ turned
        true_angle = inputs[before * span :, :3].sum(axis=0)
        inputs[0, :3] += random.uniform(-0.5, 0.5, 3) * count_lsb
        core.reset()
        block = core.feed(Quantiser(design)(inputs))
        block = VectorBlock(block.major[before:], block.status[before:], block.components[before:])
        known = float(drift(design, cone, np.array([hertz]))[0])
        known += 0.5 * omega * sin(cone.half_angle) ** 2
        added[trial] = second_order_corrections(design, block)[0][2] / seconds - known
        if not rate:
            angle = major_increments(design, block).alpha.sum(axis=0)
            largest = max(largest, float(np.abs(angle - true_angle).max()) / lsb)
    peak = Cone(half_angle).peaks(design, omega)[0]
    return QuantisationError(
        lsb,
        peak / count_lsb,
        float(added.mean()),
        float(added.std(ddof=1)),
        deviation(design, half_angle, hertz, lsb, samples),
        None if rate else largest,
    )


def levels(design: Design, half_angle: float, hertz: float, count: int) -> list[float]:
    """LSBs (rad) worth a look: from the finest that 32 bits allow to four times a sample.

    Raises:
        InputError: the frequency is out of range.
    """
    peak = Cone(half_angle).peaks(design, 2 * pi * hertz)[0]
    if design.sensor.kind == "rate":
        peak *= design.sample_interval
    spread: list[float] = np.geomspace(peak / 2.0**29, 4 * peak, count).tolist()
    return spread


def trial_seconds(design: Design, hertz: float) -> float:
    """Length of a trial's record, s."""
    return record(design, hertz, TRIAL_SAMPLES)[1] * design.sample_interval
