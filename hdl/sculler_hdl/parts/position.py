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

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

from amaranth import Cat, Module, Mux, Signal, Value
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from sculler_hdl.parts.accumulate import Accumulation, Accumulator
from sculler_hdl.parts.cross import SCROLLING, CrossArray, Crossing, Operand, Sharing
from sculler_hdl.parts.layout import vector
from sculler_hdl.parts.weighted_sum import signed_digits
from sculler_hdl.parts.words import (
    Addend,
    Arrival,
    FlagLine,
    Limbs,
    Sum,
    Word,
    at_once,
    last_clock,
    later,
    spans,
)
from sculler_hdl.target import Target
from sculler_model.algorithms import scrolling_weight
from sculler_model.design import AXES, ZERO_RANGE, Interval, WordLengths

DIVISOR = 6
"""Of all weights of scrolling."""

Weights = Mapping[str, int]
"""Of words by name.  Those of NAME_last and NAME_not_last are 0 in the other samples."""

DOUBLY: Weights = {"sum": 12, "sample": 5, "before": 1}
"""What s_alpha and s_nu grow by."""
FIRST: Weights = {"before_first": 3}


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


class Linear:
    """The plan of a sum of words times constant integers.

    Args:
        weights: the integers.
        words: what is known of the words.
        limb: how sums are cut.
        result: range of the sum, if narrower than interval arithmetic has it.

    Attributes:
        made: what is known of the sum.
    """

    def __init__(
        self,
        weights: Weights,
        words: Mapping[str, Addend],
        limb: Limbs,
        result: Interval | None = None,
    ) -> None:
        digits = [(name, *digit) for name, w in weights.items() for digit in signed_digits(w)]
        if result is None:
            result = sum((words[name].range.scaled(w) for name, w in weights.items()), ZERO_RANGE)
        self._names = [name for name, _, _ in digits]
        self._sum = Sum(
            [replace(words[name], low=low, negative=sign < 0) for name, low, sign in digits],
            result,
            limb,
        )
        self.made = Addend(result, self._sum.arrival)

    def build(self, m: Module, name: str, values: Mapping[str, Value]) -> Value:
        """Put the sum into a module."""
        return self._sum.build(m, name, [values[term] for term in self._names]).value


class Lookahead:
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
        self.product = Sum(rows, counts.repeated(samples), limb)
        words["product"] = Addend(self.product.result, self.product.arrival)
        words["product_before"] = words["product"]
        before = counts.repeated(samples - 1)
        self.sum = Accumulation(counts, now, counts.repeated(samples), limb, before, gap=gap)
        words["sum"] = Addend(self.sum.before, self.sum.before_arrival)
        for name in ("sample", "sum", "product"):
            there = words[name]
            gated = replace(there, arrival=later(there.arrival, 1))
            words |= {f"{name}_last": gated, f"{name}_not_last": gated}

        self.trend_item = Linear(side.trend, words, limb)
        item = self.trend_item.made
        self.trend = Accumulation(item.range, item.arrival, trend, limb, gap=gap)
        words["trend"] = Addend(self.trend.before, self.trend.before_arrival)
        self.ahead = Linear(side.ahead, words, limb)
        words["ahead"] = self.ahead.made
        self.whole = Linear(side.factor, words, limb, factor)
        self.factor = Operand(factor, self.whole.made.arrival)
        self.doubly_item = Linear(DOUBLY, words, limb)
        item = self.doubly_item.made
        self.doubly = Accumulation(item.range, item.arrival, doubly, limb, gap=gap)
        self.arrival = self.doubly.arrival
        self.words = words


class LookaheadAxis(wiring.Component):
    """s_alpha and C of one axis of the gyro, or s_nu and D of one of the accelerometer.

    Members:
        step (clock 0): a sample stands on `sample`.
        first, last (clock 0): it is the first, the last of its major interval.
        weight, sample (clock 0): p and the sample.
        doubly: s_alpha or s_nu, as `plan.arrival` says.
        factor: C or D, as `plan.factor` says.

    One sample every `gap` clocks.  Reset makes the sample before the first one 0.

    Args:
        plan: the plan.
    """

    def __init__(self, plan: Lookahead) -> None:
        self.plan = plan
        super().__init__(
            {
                "step": In(1),
                "first": In(1),
                "last": In(1),
                "weight": In(plan.weight_bits),
                "sample": In(plan.counts.bits),
                "doubly": Out(plan.doubly.total.bits),
                "factor": Out(plan.factor.range.bits),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m, plan = Module(), self.plan
        step, last = FlagLine(m, "step", self.step), FlagLine(m, "last", self.last)
        values: dict[str, Value] = {"sample": self.sample}

        def word(name: str) -> Word:
            return Word(m, name, values[name], plan.words[name].arrival)

        def accumulate(name: str, part: Accumulation, item: Value) -> Accumulator:
            m.submodules[name] = adder = Accumulator(part)
            m.d.comb += [
                adder.step.eq(step.at(part.clock)),
                adder.last.eq(last.at(part.clock)),
                adder.input.eq(item),
            ]
            return adder

        rows = []
        for bit in range(plan.weight_bits):
            row = Signal(plan.counts.bits, name=f"row{bit}", reset_less=True)
            m.d.sync += row.eq(Mux(self.weight[bit], self.sample, 0))
            rows.append(row)
        values["product"] = plan.product.build(m, "product", rows).value
        values["before"] = previous(word("sample"), step)
        values["product_before"] = previous(word("product"), step)
        start = Signal(plan.counts.bits, reset_less=True)
        with m.If(self.step & self.first):
            m.d.sync += start.eq(values["before"])
        values["start"] = start
        values["sum"] = accumulate("sum", plan.sum, self.sample).before
        used = {*plan.side.ahead, *plan.side.factor}
        for name in ("sample", "sum", "product"):
            if f"{name}_last" in used:
                values[f"{name}_last"] = where(last, word(name))
            if f"{name}_not_last" in used:
                values[f"{name}_not_last"] = where(last, word(name), level=0)

        item = plan.trend_item.build(m, "trend_item", values)
        values["trend"] = accumulate("trend", plan.trend, item).before
        values["ahead"] = plan.ahead.build(m, "ahead", values)
        doubly = accumulate(
            "doubly_sum", plan.doubly, plan.doubly_item.build(m, "doubly_item", values)
        )
        m.d.comb += [
            self.factor.eq(plan.whole.build(m, "whole", values)),
            self.doubly.eq(doubly.newest),
        ]
        return m


class Positioning:
    """The plan of a `Position`.

    Args:
        words: the design's word lengths.
        samples: N, samples in a major interval.
        sharing: how the array's units are shared; the next sample may come after its steps.
        target: whose multiplier blocks.
        limb: how sums are cut.
        fringe: most low bits of an operand that may go to rows of AND gates.

    Attributes:
        tiles: multiplier blocks.
        arrivals: for each vector, when the bits of its components are there.
        lanes: for each axis of scrolling, the component on the port.
    """

    def __init__(
        self,
        words: WordLengths,
        samples: int,
        sharing: Sharing,
        target: Target,
        limb: Limbs,
        fringe: int,
    ) -> None:
        s_alpha, s_nu, scrolling = words.s_alpha, words.s_nu, words.scrolling
        if s_alpha is None or s_nu is None or scrolling is None:
            raise ValueError("the design has no high-resolution position")
        self.samples = samples
        self.ranges = {"s_alpha": s_alpha, "s_nu": s_nu, "scrolling": scrolling}
        self.counts = {"gyro": words.gyro, "accel": words.accel}
        most = most_ahead(samples)
        self.sides = {
            sensor: Lookahead(
                side,
                self.counts[sensor],
                samples,
                doubly,
                both_ways(self.counts[sensor], trend),
                both_ways(self.counts[sensor], factor),
                limb,
                sharing.steps,
            )
            for sensor, side, doubly, (trend, factor) in (
                ("gyro", GYRO, s_alpha, most.gyro),
                ("accel", ACCEL, s_nu, most.accel),
            )
        }

        # the samples, and those before, wait for the first limbs of C and D
        C, D = (side.factor for side in self.sides.values())
        self.launch = min(last_clock(item.arrival[:1]) for item in (C, D))
        now = {
            sensor: Operand(c, at_once(c.bits, self.launch)) for sensor, c in self.counts.items()
        }
        gated = Addend(words.gyro, at_once(words.gyro.bits, self.launch - 1))
        self.first = Linear(FIRST, {"before_first": gated}, limb)
        first = Operand(self.first.made.range, self.first.made.arrival)

        def launched(*items: Operand) -> list[Operand]:
            return [Operand(item.range, later(item.arrival, -self.launch)) for item in items]

        self.crossing = Crossing(
            launched(C, D, first),
            launched(now["accel"], now["gyro"], now["accel"]),
            [Interval(scrolling.lo // DIVISOR, scrolling.hi // DIVISOR)],
            sharing,
            target,
            limb,
            fringe,
            SCROLLING,
        )
        self.tiles = self.crossing.tiles

        (components,) = self.crossing.results.values()
        (total,) = self.crossing.totals.values()
        self.lanes = [lane for lane, _ in components]
        self.wholes = [
            Linear(
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


class Position(wiring.Component):
    """s_alpha, s_nu and scrolling of a major interval.

    Members:
        step (clock 0): a sample stands on `gyro` and `accel`.
        first, last (clock 0): it is the first, the last of its major interval.
        gyro, accel (clock 0): the newest sample, three axes.
        s_alpha, s_nu, scrolling: the sums with the last sample, as `plan.arrivals` says; of
            scrolling the components, or the newest of them if axes take turns.

    One sample every `plan.sharing.steps` clocks.  Reset makes the sample before the first one 0.

    Args:
        plan: the plan.
        primitive: whether to instantiate the target's multiplier blocks.
    """

    def __init__(self, plan: Positioning, *, primitive: bool = True) -> None:
        self.plan = plan
        self.primitive = primitive
        lanes = plan.crossing.lanes
        super().__init__(
            {
                "step": In(1),
                "first": In(1),
                "last": In(1),
                **{name: In(vector(counts)) for name, counts in plan.counts.items()},
                "s_alpha": Out(vector(plan.ranges["s_alpha"])),
                "s_nu": Out(vector(plan.ranges["s_nu"])),
                "scrolling": Out(data.ArrayLayout(plan.ranges["scrolling"].bits, lanes)),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m, plan = Module(), self.plan
        step, first = (FlagLine(m, name, getattr(self, name)) for name in ("step", "first"))
        weight = Signal(range(plan.samples + 1), init=plan.samples - 1 or plan.samples)
        with m.If(self.step):
            m.d.sync += weight.eq(Mux(weight == 1, plan.samples, weight - 1))

        m.submodules.scrolling = array = CrossArray(
            plan.crossing, plan.launch, primitive=self.primitive
        )
        m.d.comb += [array.launch.eq(self.step), array.last.eq(self.last)]
        for i, axis in enumerate(AXES):
            factors: dict[str, Value] = {}
            now: dict[str, Value] = {}
            before: dict[str, Word] = {}
            for sensor, doubly in (("gyro", "s_alpha"), ("accel", "s_nu")):
                m.submodules[f"{sensor}_{axis}"] = part = LookaheadAxis(plan.sides[sensor])
                sample = Value.cast(getattr(self, sensor)[i])
                m.d.comb += [
                    part.step.eq(self.step),
                    part.first.eq(self.first),
                    part.last.eq(self.last),
                    part.weight.eq(weight),
                    part.sample.eq(sample),
                    getattr(self, doubly)[i].eq(part.doubly),
                ]
                factors[sensor] = part.factor
                word = Word(m, f"{sensor}_{axis}", sample, at_once(len(sample)))
                now[sensor] = word.window(0, len(sample), plan.launch)
                # the gyro's is a clock early, for a gate is in its way
                clock = plan.launch - (2 if sensor == "gyro" else 0)
                shown = word.window(0, len(sample), clock)
                arrival = at_once(len(sample), clock)
                name = f"{sensor}_{axis}_before"
                old = previous(Word(m, f"{sensor}_{axis}_now", shown, arrival), step)
                before[sensor] = Word(m, name, old, arrival)
            gated = where(first, before["gyro"])
            operands = {
                "left0": factors["gyro"],
                "left1": factors["accel"],
                "left2": plan.first.build(m, f"first_{axis}", {"before_first": gated}),
                "right0": now["accel"],
                "right1": now["gyro"],
                "right2": before["accel"].value,
            }
            for name, value in operands.items():
                m.d.comb += getattr(array, name)[i].eq(value)
        for lane in range(plan.crossing.lanes):
            totals = {"total": array.scrolling[lane]}
            whole = plan.wholes[lane].build(m, f"scrolling_{AXES[lane]}", totals)
            m.d.comb += self.scrolling[lane].eq(whole)
        return m


def previous(word: Word, step: FlagLine) -> Value:
    """The word of the sample before, at the clocks at which the word's bits are there."""
    pieces = []
    for lo, hi, clock in spans(word.arrival):
        register = Signal(hi - lo, name=f"{word.name}_previous_{lo}")
        with word.m.If(step.at(clock)):
            word.m.d.sync += register.eq(word.value[lo:hi])
        pieces.append(register)
    return Cat(*pieces)


def where(flag: FlagLine, word: Word, *, level: int = 1) -> Value:
    """The word, a clock later, in samples with the flag, or without it if `level` is 0; else 0."""
    pieces = []
    for lo, hi, clock in spans(word.arrival):
        name = f"{word.name}_{flag.name}{level}_{lo}"
        register = Signal(hi - lo, name=name, reset_less=True)
        bits = word.value[lo:hi]
        choices = (bits, 0) if level else (0, bits)
        word.m.d.sync += register.eq(Mux(flag.at(clock), *choices))
        pieces.append(register)
    return Cat(*pieces)


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
