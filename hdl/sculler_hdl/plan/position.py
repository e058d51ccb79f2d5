"""High-resolution position: each sample counted at once as the interval's end will have it.

The page (`algorithms.scrolling`) integrates twice, sample after sample.  The core knows how many
samples q are still to come, so one sum does it.  With s and r the newest sample, s' and r' the one
before, s0 and r0 the last before the interval, and alpha, nu, T, U as they were before the newest:

    scrolling/6 += C x r + D x s     (+ 3 s' x r' in the interval's first sample)
    C            = 120 T + 60 P' - 33 s' - 10 s0 + 120 P + 36 s   (in its last - 50 alpha - 7 s)
    D            = 120 U + 60 Q' - 57 r' + 10 r0                  (in its last - 10 nu)
    T           += 4 P - 3 s - 5 alpha
    U           += 2 Q - nu
    s_alpha     += 12 alpha + 5 s + s'                            Savage-98 Eq. 103; s_nu alike

P = p s and Q = p r are the only products besides the array's, and rows of AND gates make them: p is
q, but with the last sample, for which q is 0, the number N that are to come of the next interval.
P' and Q' are those of the sample before.

    s, r ─┬▶ P, Q, sums ─▶ T, U ─▶ C, D ─┐
          └▶ delayed ────────────────────┴▶ CrossArray ─▶ times 6

Why: Savage-98 Eq. 61 and 102-105, multiplied out, give each pair of samples i and j a weight
(`scrolling_weight`).  Where k = j - i > 1 samples lie from i to j, that of s_i in C is
120 (4 q + 2 - k) and that of r_i in D is 120 (2 q + 1 + k), q counted from j.  With each sample
more k grows and q falls by 1; neighbours and the interval's ends have weights of their own.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

from sculler_hdl.plan.accumulator import AccumulatorPlan
from sculler_hdl.plan.adder_tree import Addend, AdderTreePlan
from sculler_hdl.plan.arrival import Arrival, Limbs, at_once, last_clock, later
from sculler_hdl.plan.cross_array import SCROLLING, CrossArrayPlan, Folding, Operand
from sculler_hdl.plan.dot_product import DotProductPlan, Weights
from sculler_hdl.targets import Target
from sculler_model.algorithms import scrolling_weight
from sculler_model.design import Interval, WordLengths

DIVISOR = 6
"""Of all weights of scrolling."""


class Gated(NamedTuple):
    """A word that is shown in some samples only, a clock later; in the others it is 0.

    Attributes:
        word: its name.
        last: whether in an interval's last sample, or in all but that.
    """

    word: str
    last: bool


GATED = {
    "sample_last": Gated("sample", last=True),
    "sample_not_last": Gated("sample", last=False),
    "sum_last": Gated("sum", last=True),
    "product_not_last": Gated("product", last=False),
}
"""By the names that they have in `Side`."""

DOUBLY: Weights = {"sum": 12, "sample": 5, "before": 1}
"""What s_alpha and s_nu grow by."""
FIRST: Weights = {"before_first": 3}
"""What s' is multiplied by r' with, in an interval's first sample."""


class Side(NamedTuple):
    """What is of the gyro or of the accelerometer alone.

    Attributes:
        trend: what T or U grows by.
        ahead: 1/60 of that part of C or D which has the factors 120 and 60.
        factor: C or D.
    """

    trend: Weights
    ahead: Weights
    factor: Weights


GYRO = Side(
    trend={"product": 4, "sample": -3, "sum": -5},
    ahead={"trend": 2, "product_before": 1, "product_not_last": 2},
    factor={
        "ahead": 60,
        "before": -33,
        "start": -10,
        "sample_not_last": 36,
        "sample_last": -7,
        "sum_last": -50,
    },
)
ACCEL = Side(
    trend={"product": 2, "sum": -1},
    ahead={"trend": 2, "product_before": 1},
    factor={"ahead": 60, "before": -57, "start": 10, "sum_last": -10},
)


class LookaheadPlan:
    """The plan of a `LookaheadAxis`.

    Args:
        side: the weights.
        counts: range of one count.
        samples: N, samples in a major interval.
        doubly: range of s_alpha or s_nu.
        trend, factor: ranges of T and C, or U and D.
        limb: how sums are cut.
        gap: clocks from one sample to the next, at least.

    Attributes:
        arrival: clocks from a sample's step at which the bits of s_alpha or s_nu are there.
        factor: C or D, with the clocks at which its bits are there.
        words: all words that are added, by the names of `Side`.
        product, sum: P or Q; alpha or nu.
        trend_item, trend: what T or U grows by, and T or U.
        ahead, whole: the part of C or D with the factors 120 and 60, over 60; all of it.
        doubly_item, doubly: what s_alpha or s_nu grows by, and s_alpha or s_nu.
    """

    def __init__(
        self,
        side: Side,
        counts: Interval,
        samples: int,
        doubly: Interval,
        trend: Interval,
        factor: Interval,
        limb: Limbs,
        gap: int,
    ) -> None:
        self.side = side
        self.counts = counts
        self.weight_bits = samples.bit_length()
        now = at_once(counts.bits)
        words = {
            "sample": Addend(counts, now),
            "before": Addend(counts, now),
            "start": Addend(counts, later(now, 1)),
        }
        rows = [Addend(counts, later(now, 1), low) for low in range(self.weight_bits)]
        self.product = AdderTreePlan(rows, counts.repeated(samples), limb)
        words["product"] = Addend(self.product.result, self.product.arrival)
        words["product_before"] = words["product"]
        before = counts.repeated(samples - 1)
        self.sum = AccumulatorPlan(counts, now, counts.repeated(samples), limb, before, gap=gap)
        words["sum"] = Addend(self.sum.before, self.sum.before_arrival)
        for name, gated in GATED.items():
            there = words[gated.word]
            words[name] = replace(there, arrival=later(there.arrival, 1))

        self.trend_item = DotProductPlan(side.trend, words, limb)
        item = self.trend_item.made
        self.trend = AccumulatorPlan(item.range, item.arrival, trend, limb, gap=gap)
        words["trend"] = Addend(self.trend.before, self.trend.before_arrival)
        self.ahead = DotProductPlan(side.ahead, words, limb)
        words["ahead"] = self.ahead.made
        self.whole = DotProductPlan(side.factor, words, limb, factor)
        self.factor = Operand(factor, self.whole.made.arrival)
        self.doubly_item = DotProductPlan(DOUBLY, words, limb)
        item = self.doubly_item.made
        self.doubly = AccumulatorPlan(item.range, item.arrival, doubly, limb, gap=gap)
        self.arrival = self.doubly.arrival
        self.words = words


class PositionPlan:
    """The plan of a `Position`.

    Args:
        words: the design's word lengths.
        samples: N, samples in a major interval.
        folding: how the array's units are shared; the next sample may come after its steps.
        target: whose multiplier blocks.
        limb: how sums are cut.
        residue: most low bits of an operand that may go to rows of AND gates.
        spread, apart: as of `CrossArrayPlan`.

    Attributes:
        counts, ranges: of the samples, by sensor; of the results, by vector.
        sides: of each sensor, what its axes are built of.
        launch: the clock at which the array takes its operands.
        first: 3 s', which the array sees in an interval's first sample.
        array: the products.
        wholes: scrolling from scrolling/6, for each lane of the array.
        block_count: multiplier blocks.
        arrivals: for each vector, when the bits of its components are there.
        lanes: for each axis of scrolling, the component on the port.
    """

    def __init__(
        self,
        words: WordLengths,
        samples: int,
        folding: Folding,
        target: Target,
        limb: Limbs,
        residue: int,
        *,
        spread: bool = False,
        apart: bool = False,
    ) -> None:
        s_alpha, s_nu, scrolling = words.s_alpha, words.s_nu, words.scrolling
        if s_alpha is None or s_nu is None or scrolling is None:
            raise ValueError("the design has no high-resolution position")
        self.samples = samples
        self.ranges = {"s_alpha": s_alpha, "s_nu": s_nu, "scrolling": scrolling}
        self.counts = {"gyro": words.gyro, "accel": words.accel}
        self.sides = self._sides(limb, folding.steps)

        # the samples, and those before, wait for the first limbs of C and D
        C, D = (side.factor for side in self.sides.values())
        self.launch = min(last_clock(item.arrival[:1]) for item in (C, D))
        now = {
            sensor: Operand(c, at_once(c.bits, self.launch)) for sensor, c in self.counts.items()
        }
        gated = Addend(words.gyro, at_once(words.gyro.bits, self.launch - 1))
        self.first = DotProductPlan(FIRST, {"before_first": gated}, limb)
        first = Operand(self.first.made.range, self.first.made.arrival)

        def launched(*items: Operand) -> list[Operand]:
            return [Operand(item.range, later(item.arrival, -self.launch)) for item in items]

        self.array = CrossArrayPlan(
            launched(C, D, first),
            launched(now["accel"], now["gyro"], now["accel"]),
            [Interval(scrolling.lo // DIVISOR, scrolling.hi // DIVISOR)],
            folding,
            target,
            limb,
            residue,
            SCROLLING,
            spread=spread,
            apart=apart,
        )
        self.block_count = self.array.block_count

        (components,) = self.array.results.values()
        (total,) = self.array.totals.values()
        self.lanes = [lane for lane, _ in components]
        self.wholes = [
            DotProductPlan(
                {"total": DIVISOR},
                {"total": Addend(total, later(arrival, self.launch))},
                limb,
                scrolling,
            )
            for _, arrival in components
        ]
        self.arrivals: dict[str, list[Arrival]] = {
            "s_alpha": [self.sides["gyro"].arrival] * 3,
            "s_nu": [self.sides["accel"].arrival] * 3,
            "scrolling": [whole.made.arrival for whole in self.wholes],
        }

    def _sides(self, limb: Limbs, gap: int) -> dict[str, LookaheadPlan]:
        most = most_ahead(self.samples)
        return {
            sensor: LookaheadPlan(
                side,
                self.counts[sensor],
                self.samples,
                self.ranges[doubly],
                both_ways(self.counts[sensor], trend),
                both_ways(self.counts[sensor], factor),
                limb,
                gap,
            )
            for sensor, side, doubly, (trend, factor) in (
                ("gyro", GYRO, "s_alpha", most.gyro),
                ("accel", ACCEL, "s_nu", most.accel),
            )
        }


class MostAhead(NamedTuple):
    """(trend, factor) of each sensor: the greatest sum of the magnitudes of a sample's weights."""

    gyro: tuple[int, int]
    accel: tuple[int, int]


@lru_cache(maxsize=64)
def most_ahead(samples: int) -> MostAhead:
    """How far T, C, U and D can go.

    Args:
        samples: N, samples in a major interval.
    """

    def factor(last: int, gyro: bool) -> int:
        def weight(i: int) -> int:
            first, second = (i, last) if gyro else (last, i)
            return scrolling_weight(first, second, samples) // DIVISOR

        apart = _magnitudes(weight(1), weight(last - 2), last - 2)
        ends = {0, last - 1, last} if gyro else {0, last - 1}
        return apart + sum(abs(weight(i)) for i in ends)

    T = U = C = D = 0
    for newest in range(1, samples + 1):
        before, to_come = newest - 1, samples - newest
        T = max(T, _magnitudes(4 * to_come + 1, 4 * to_come + 2 - before, before))
        U = max(U, _magnitudes(2 * to_come + 2, 2 * to_come + 1 + before, before))
        C = max(C, factor(newest, gyro=True))
        D = max(D, factor(newest, gyro=False))
    return MostAhead((T, C), (U, D))


def _magnitudes(first: int, last: int, count: int) -> int:
    """Sum of the magnitudes of so many numbers in equal steps."""
    if count <= 1:
        return abs(first) * (count == 1)
    step = (last - first) // (count - 1)
    if first > last:
        first, last, step = -first, -last, -step
    negative = min(max(-(first // step), 0), count)
    return (first + last) * count // 2 - (2 * first + step * (negative - 1)) * negative


def both_ways(counts: Interval, magnitudes: int) -> Interval:
    """Range of a sum of counts whose weights have this sum of magnitudes."""
    span = counts.repeated(magnitudes)
    return span | -span
