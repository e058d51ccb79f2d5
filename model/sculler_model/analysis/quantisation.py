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

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from math import pi, sin, sqrt

import numpy as np
from numpy.typing import NDArray

from sculler_model.algorithms import TapTable
from sculler_model.analysis.frequency import drift, record
from sculler_model.analysis.integer_path import changed
from sculler_model.analysis.oscillation import Cone
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.fast import FastModel, VectorBlock

Array = NDArray[np.float64]

TRIAL_SAMPLES = 4000
"""Samples of a trial, at least."""

TOGETHER = 1 << 16
"""Samples of trials that go through the core at once."""


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
        s: (N,) samples about one axis, or (N, C) of C records side by side.

    Returns:
        Of s's shape: entry t is what a sample at t about the other axis is multiplied with in C.
    """
    n, N = table.samples, len(s)
    out = np.zeros_like(s)
    for k in table.active_phases:
        for d, tap in enumerate(table.taps[k - 1], start=1):
            if tap:
                late = k - 1 + max(-((k - 1 - d) // n), 0) * n  # the first one that is >= d
                c = tap / table.denominator
                out[late - d : N - d : n] += c * s[late::n]
                out[late::n] -= c * s[late - d : N - d : n]
    weights = [(d, w / table.sum_denominator) for d, w in enumerate(table.weights) if w]
    theta = np.zeros_like(s[n - 1 :: n])
    for d, w in weights:
        into, first = theta[d // n :], n - 1 + d // n * n - d  # the one before has a share in it
        into += w * s[first : N - d : n]
    until = np.cumsum(theta, axis=0)
    later_less_earlier = (until[-1] - until) - (until - theta)
    for d, w in weights:
        into = out[n - 1 + d // n * n - d : N - d : n]
        into += 0.5 * w * later_less_earlier[d // n :]
    return out


def form(table: TapTable, minors: int) -> Array:
    """Dᵀ K D of a record of so many minor intervals, (N - 1, N - 1), its last sample left out."""
    K = products_with(table, np.eye(minors * table.samples))
    result: Array = np.diff(np.diff(K, axis=0), axis=1)
    return result


@lru_cache(maxsize=64)
def _form_power(table: TapTable) -> tuple[float, float]:
    """|Dᵀ K D|² of a minor interval's rows: near entries, and those with each interval far off."""
    n, aside = table.samples, _aside(table)
    B = form(table, 2 * aside + 3)
    first = (aside + 1) * n
    rows = B[first : first + n]
    near = float(np.sum(rows[:, n : n + (2 * aside + 1) * n] ** 2))
    far = float(np.sum(rows[:, :n] ** 2))
    return near, far


def _aside(table: TapTable) -> int:
    """Minor intervals that the products reach, on a side."""
    return -(-(table.history + 2) // table.samples) + 1


@lru_cache(maxsize=64)
def _wave_power(table: TapTable, phase: float, samples: int) -> float:
    """|Dᵀ K s|² for cosine and sine of a record together, their amplitude 1."""
    turn = phase * np.arange(samples)
    return sum(
        float(np.sum(np.diff(products_with(table, wave)) ** 2))
        for wave in (np.cos(turn), np.sin(turn))
    )


def deviation(design: Design, half_angle: float, hertz: float, lsb: float, samples: int) -> float:
    """Theory: standard deviation of the drift (rad/s) that quantisation adds over a record.

    Args:
        design: gives table and sample rate.
        half_angle: a, rad.
        hertz: the coning's frequency.
        lsb: rad per count of the products.
        samples: length of the record, whole minor intervals.
    """
    table, phase = design.table, 2 * pi * hertz * design.sample_interval
    size, response = 2 * sin(half_angle) * sin(phase / 2), design.sensor_response
    if response is not None:
        unfiltered = size if design.sensor.kind == "increment" else sin(half_angle) * phase
        size = unfiltered * abs(response.value(phase))
    linear = size**2 * _wave_power(table, phase, samples)
    minors, (near, far) = samples // table.samples, _form_power(table)
    square = minors * (near + max(minors - 2 * _aside(table) - 1, 0) * far)
    return sqrt(lsb**2 / 12 * linear + lsb**4 / 144 * square) / (samples * design.sample_interval)


def monte_carlo(
    design: Design,
    half_angle: float,
    hertz: float,
    lsb: float,
    trials: int,
    seed: int,
    advance: Callable[[int], object] | None = None,
) -> QuantisationError:
    """Run trials through the integer path, each with its own phase and starting remainder.

    The half angle too differs from trial to trial, by up to 2 %: a pure tone meets the same
    remainders again and again, which a real vibration does not.  At a few counts of amplitude that
    is not enough, and the remainders are not white.

    Many trials go through the core at once, one after another in one array: each begins with
    samples enough that no tap reaches into the one before.

    Args:
        design: the design; its gyro gets this LSB and a word as narrow as holds the coning.
        half_angle, hertz: the coning.
        lsb: rad per count of the products.
        trials: how many, 2 or more.
        seed: the same one gives the same result; see `draws`.
        advance: told how many more trials are done, now and then.

    Raises:
        InputError: the coning does not fit 32 bits of so fine an LSB, or is out of range.
    """
    record = _Record(design, half_angle, hertz, lsb)
    core = FastModel(record.design, expected=trials * record.length)
    at_once = max(TOGETHER // record.length, 1)
    drawn = draws(half_angle, trials, seed)
    added, largest = [], 0.0
    for first in range(0, trials, at_once):
        some = drawn[first : first + at_once]
        counts, turned = record.counts(some)
        block = core.feed(counts.reshape(-1, 6))
        alpha = record.alpha(block)
        added.append(record.coning(block, alpha, some) / record.seconds)
        largest = max(largest, float(np.abs(alpha.sum(axis=2).T - turned).max()))
        if advance is not None:
            advance(len(some))
    drifts = np.concatenate(added)
    return QuantisationError(
        lsb,
        Cone(half_angle).peaks(design, record.omega)[0] / record.count_lsb,
        float(drifts.mean()),
        float(drifts.std(ddof=1)),
        deviation(design, half_angle, record.hertz, lsb, record.samples),
        None if design.sensor.kind == "rate" else largest,
    )


def draws(half_angle: float, trials: int, seed: int) -> Array:
    """What is random: (trials, 5) half angle (rad), turn (rad), remainders about x, y, z (LSB).

    They are drawn trial by trial in this order, so that the first trials of many are those of few.
    The turn is about the cone's axis: any phase of the motion, not only a sample's.
    """
    random = np.random.default_rng(seed)
    low, high = [0.98, 0.0, -0.5, -0.5, -0.5], [1.02, 2 * pi, 0.5, 0.5, 0.5]
    drawn = random.uniform(low, high, (trials, 5))
    drawn[:, 0] *= half_angle
    return drawn


class _Record:
    """Coning over whole periods at one LSB: what all trials have in common.

    Attributes:
        design: on a sensor that holds the coning.
        count_lsb: of a sample.
        samples: of the record.
        length: with those before it.
        seconds: of the record.
        hertz, omega: of the coning, adjusted to whole periods.
    """

    def __init__(self, design: Design, half_angle: float, hertz: float, lsb: float) -> None:
        span = design.samples_per_major
        periods, self.samples = record(design, hertz, TRIAL_SAMPLES)
        self.seconds = self.samples * design.sample_interval
        self.hertz = periods / self.seconds
        self.omega = 2 * pi * self.hertz
        # no tap reaches before the first sample
        self._before = -(-(design.table.history + 1) // span)
        self.length = self.samples + self._before * span
        self.count_lsb = lsb / (design.sample_interval if design.sensor.kind == "rate" else 1.0)

        cone = Cone(half_angle)
        samples = cone.samples(design, self.omega, self.length)[:, :3] / self.count_lsb
        swing = float(np.hypot(samples[:, 0], samples[:, 1]).max())
        bits = int(1.05 * (swing + abs(samples[0, 2])) + 2).bit_length() + 1
        if bits > 32:
            raise InputError(
                f"coning of {swing:.3g} counts of {lsb:g} rad a sample does not fit 32 bits, give"
                " a larger LSB or a smaller cone"
            )
        # the sensor as fine and no wider: what the core makes of the counts does not depend on it
        self.design = changed(
            design,
            sensor={
                "gyro": {"bits": max(bits, 8), "lsb": self.count_lsb},
                "accel": {"bits": 8, "lsb": design.sensor.accel.lsb},
            },
            algorithm={"position": None},
        )
        # angles in LSB after each sample: of a cone of sine 1 about x and y, of this one about z
        self._x, self._y = (
            np.concatenate(([0.0], np.cumsum(samples[:, axis]))) / sin(half_angle)
            for axis in (0, 1)
        )
        self._z = samples[0, 2] / sin(half_angle / 2) ** 2 * np.arange(self.length + 1.0)
        known = float(drift(design, cone, np.array([self.hertz]))[0])
        self._known = known / sin(half_angle) ** 2 + 0.5 * self.omega

    def counts(self, drawn: Array) -> tuple[NDArray[np.int64], Array]:
        """Counts of trials, (T, length, 6), and the angles that their records turn by, (T, 3) LSB.

        The counts so far are the rounded angle so far, as `samples.Quantiser` has it.
        """
        half_angle, turn, *remainders = drawn.T[:, :, None]
        size = np.sin(half_angle)
        c, s = size * np.cos(turn), size * np.sin(turn)
        start = self._before * self.design.samples_per_major
        counts = np.zeros((len(drawn), self.length, 6), np.int64)
        turned = np.empty((len(drawn), 3))
        for axis, remainder in enumerate(remainders):
            if axis == 0:
                angle = c * self._x
                angle -= s * self._y
            elif axis == 1:
                angle = s * self._x
                angle += c * self._y
            else:
                angle = np.sin(half_angle / 2) ** 2 * self._z
            turned[:, axis] = angle[:, -1] - angle[:, start]
            angle += remainder + 0.5
            np.floor(angle, out=angle)
            np.subtract(angle[:, 1:], angle[:, :-1], out=counts[:, :, axis], casting="unsafe")
        return counts, turned

    def coning(self, block: VectorBlock, alpha: Array, drawn: Array) -> Array:
        """Coning of each record about z less what it truly is and what the table leaves, (T,) rad.

        To second order, as `host.second_order_corrections` puts intervals together.

        Args:
            block: of the trials.
            alpha: (3, T, R) LSB of its records, of `alpha`.
            drawn: of the trials.
        """
        table = self.design.table
        x, y, _ = alpha
        before_x, before_y = np.cumsum(x, axis=1) - x, np.cumsum(y, axis=1) - y
        apart = 0.5 * (before_x * y - before_y * x)
        apart += self._of_records(block, "coning_within", 2) / table.denominator
        if self.design.algorithm.minors > 1:
            between = self._of_records(block, "coning_between", 2)
            apart += between / (2 * table.sum_denominator**2)
        known = self._known * self.seconds * np.sin(drawn[:, 0]) ** 2
        whole: Array = self.design.gyro_scale**2 * apart.sum(axis=1) - known
        return whole

    def alpha(self, block: VectorBlock) -> Array:
        """Angles of the major intervals of the trials' records, (3, T, R) LSB."""
        axes = [self._of_records(block, "alpha", axis) for axis in range(3)]
        return np.stack(axes) / self.design.table.sum_denominator

    def _of_records(self, block: VectorBlock, vector: str, axis: int) -> Array:
        """A component of the trials' records, (T, R), as floats."""
        majors = self.length // self.design.samples_per_major
        values = block.vector(vector)[:, axis].astype(np.float64)
        return values.reshape(-1, majors)[:, self._before :]


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
