"""What the generated test bench does from one reset to the next, and the samples for it.

Two long runs come first.  They have random stalls, and major intervals made for the status bits: a
fault in the first or last sample alone, one count alone at one of its rails, all counts at their
rails and then all at the other ones.  Where a core drops results, those of some of these intervals
are taken in any case (`bench_dropping`).  Short runs follow, each ended by a reset that comes so
many clocks after its last sample: one for each clock of the latency, where these are few, and else
above all for those near its end.  The last run is for the counters, which the bench sets just below
where they carry.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from enum import Enum
from itertools import cycle, islice
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sculler_model.design import Design, Interval
from sculler_model.golden import Timing, clocks_per_major, words_per_column, words_per_result

_SEED = 2001
_DROPPING = 5  # major intervals after which a result has been dropped
_CLOCKS = 3  # a sample; cores that take more get fewer samples than `Least` says
_MOST_CLOCKS = 30_000
_NEAR = 16  # clocks of a latency, and a tenth of a long one, in which a program ends

PATTERN = 16
"""Major intervals until each of the twelve rails was touched alone."""

ROUND = 24
"""Where results are dropped, major intervals of which the first `Run.shown` are all taken."""


class Least(NamedTuple):
    """How long a test bench is.

    Attributes:
        before, after: major intervals and samples, so many at least, before the first reset and
            after it.
        directed: major intervals made for the status bits, of those after it.
        resets: resets with a result on its way; 0 for the two long runs alone, without goals.
        clocks: that directed intervals may take, and as many that resets may; slow cores get fewer
            of them.
    """

    before: tuple[int, int]
    after: tuple[int, int]
    directed: int
    resets: int
    clocks: int = _MOST_CLOCKS


LEAST = Least((1, 200), (2, 400), PATTERN, 60)
"""What a test bench runs that is handed out."""


class Kind(Enum):
    """How a run goes."""

    STALLS = "STALLS"  # both handshakes stall; it ends when all results are taken
    QUICK = "QUICK"  # no stalls; a reset ends it
    CUT = "CUT"  # stalls; a reset ends it
    HELD = "HELD"  # the first result stays half taken; a reset ends it
    COUNTERS = "COUNTERS"  # counters are set, before every other result; as STALLS else


@dataclass(frozen=True)
class Run:
    """From a reset to the next.

    Attributes:
        kind: how it goes.
        samples: that it takes.
        delay: clocks between the one that takes the last of them and the reset.
        reset: clocks of that reset.
        shown: where results are dropped, how many of every `ROUND` are not.
    """

    kind: Kind
    samples: int
    delay: int
    reset: int
    shown: int = 0

    def shows(self, interval: int) -> bool:
        """Whether the result of a major interval, counted from 0, is at the ports in any case."""
        if self.kind is Kind.STALLS:
            return interval % ROUND < self.shown
        return interval == 0


def run_lengths(design: Design, timing: Timing, least: Least) -> tuple[int, int]:
    """Samples of the two long runs.

    Whole major intervals and a part of one (where one is more than a sample).
    """
    per_major = design.samples_per_major
    slowness = max(1, clocks_per_major(design, timing) // (_CLOCKS * per_major))
    directed = _directed(design, timing, least)
    fewest = max(least.after[0], directed + (_DROPPING if design.drops_results else 0))
    before, after = (
        max(intervals, -(-samples // slowness // per_major)) * per_major + per_major // 2
        for intervals, samples in (least.before, (fewest, least.after[1]))
    )
    return before, after


def _directed(design: Design, timing: Timing, least: Least) -> int:
    """Major intervals made for the status bits, of the second run."""
    return min(least.directed, least.clocks // clocks_per_major(design, timing))


def plan_runs(design: Design, timing: Timing, least: Least) -> list[Run]:
    """The runs of a bench."""
    before, after = run_lengths(design, timing, least)
    shown = min(PATTERN, _directed(design, timing, least)) if design.drops_results else 0
    long = [Run(Kind.STALLS, before, 0, 3), Run(Kind.STALLS, after, 0, 1, shown)]
    if not least.resets:
        return long
    return [
        *long,
        *_resets(design, timing, least),
        Run(Kind.COUNTERS, counter_intervals(design, timing) * design.samples_per_major, 0, 0),
    ]


def _resets(design: Design, timing: Timing, least: Least) -> Iterator[Run]:
    """Runs that a reset ends while a result is on its way, is handed over, or waits."""
    rng = random.Random(_SEED)
    span, clocks = design.samples_per_major, clocks_per_major(design, timing)
    intervals = 1 + -(-(timing.latency + 8) // clocks)
    room = max(1, min(least.resets, least.clocks // (clocks * intervals + timing.startup)))
    delays = _delays(rng, range(timing.latency - 1), room)
    parts = words_per_result(design) if design.hardware.handover == "stream" else 1
    whole = timing.latency + parts * (timing.handover_spacing + 1)
    back_to_back = 3 + -(-2 * whole // clocks)  # so many that two results come meanwhile
    for i, delay in enumerate(delays):
        samples = (back_to_back if i == 0 else intervals) * span
        yield Run(Kind.QUICK, samples, delay, 3 if i % 4 == 3 else 1)
    for _ in range(max(1, room // 4)):
        samples = intervals * span + rng.randrange(span)
        yield Run(Kind.CUT, samples, rng.randrange(whole), 1)
    for _ in range(2 if room > 2 else 1):
        samples = span + rng.randrange(span)
        yield Run(Kind.HELD, samples, whole + rng.randrange(8), 1)


def _delays(rng: random.Random, stages: range, room: int) -> list[int]:
    """All of them, or so many: every other one near the end, where a compact core's program ends.

    There a word of the program must not act any more after the reset.
    """
    if len(stages) <= room:
        return list(stages)
    near = min(len(stages), max(_NEAR, len(stages) // 10))
    late = min(near, max(room - room // 2, room - (len(stages) - near)))
    return sorted(rng.sample(stages[:-near], room - late) + rng.sample(stages[-near:], late))


def stages(runs: Sequence[Run]) -> int:
    """Resets that come while a result is on its way for certain."""
    return sum(run.kind is Kind.QUICK for run in runs)


def number_bits(design: Design) -> int:
    """Width of a result's number at the ports."""
    return 16 * words_per_column(design) if design.hardware.handover == "stream" else 64


def numbers(design: Design, timing: Timing) -> list[int]:
    """Numbers of results that the bench sets, for the next results to count on from.

    First those after which a carry runs into one more limb of 16 bits each; limbs above are 7fff,
    so that it runs through all of the next one.  Then those after which a limb is 5555 or aaaa, so
    that each of its bits is high once and low once.  Where major intervals are long the first ones,
    or all ones alone.
    """
    limbs = number_bits(design) // 16
    ones, ripple = 0xFFFF, 0x7FFF
    carried = [
        sum((ones if limb < low else ripple) << 16 * limb for limb in range(limbs))
        for low in range(1, limbs + 1)
    ]
    checkered = [
        sum(
            (ones, sum_ - 1, ripple)[(limb >= at) + (limb > at)] << 16 * limb
            for limb in range(limbs)
        )
        for at in range(limbs)
        for sum_ in (0x5555, 0xAAAA)
    ]
    room = _MOST_CLOCKS // clocks_per_major(design, timing)
    choices = ([*carried, *checkered], carried, carried[-1:])
    return next((each for each in choices if len(each) < room), choices[-1])


def carries(design: Design, timing: Timing) -> int:
    """How many of them a carry out of the lowest limb follows."""
    return sum(number & 0xFFFF == 0xFFFF for number in numbers(design, timing))


def counter_intervals(design: Design, timing: Timing) -> int:
    """Major intervals of the run for the counters: two for each number, and some to lose more."""
    more = max(8, 64 // design.samples_per_major) if design.drops_results else timing.results + 2
    return 1 + 2 * len(numbers(design, timing)) + more


def samples_of(design: Design, runs: Sequence[Run]) -> list[NDArray[np.int64]]:
    """(samples, 7) counts and fault of each run.

    Of eight major intervals one has all counts at their rails, or random ones; its counterpart all
    at the others.  One has none there, but all a single bit from it, one bit after the other.  Six
    have one alone, at one rail after the other.  Every fourth has a faulty sample, its first, its
    last or any.  Where results are dropped, there is all of this in intervals whose results are
    not.
    """
    rng = random.Random(_SEED)
    words, span = design.words, design.samples_per_major
    allowed = [words.gyro] * 3 + [words.accel] * 3
    lows, highs = ([getattr(word, end) for word in allowed] for end in ("lo", "hi"))
    nearly, dropped = _nearly(allowed), _nearly(allowed)
    parts, touched = [], 0
    for number, run in enumerate(runs):
        rows = _wild(rng, allowed, run.samples)
        faults = np.zeros((run.samples, 1), np.int64)
        for place, first in enumerate(range(0, run.samples, span)):
            interval = number + place
            mine, marks = rows[first : first + span], faults[first : first + span]
            if interval % 8 == 1 and run.kind is Kind.STALLS:
                mine[:] = np.where(
                    _coins(interval // 16, mine.shape), *_turn(interval, lows, highs)
                )
            elif interval % 8 != 5 and run.kind is Kind.STALLS:
                mine[:] = mine.clip([low + 1 for low in lows], [high - 1 for high in highs])
                ends = lows if touched % 2 else highs
                axis = touched // 2 % 6
                mine[(0, len(mine) - 1, rng.randrange(len(mine)))[touched % 3], axis] = ends[axis]
                touched += 1
            elif interval % 4 == 1:
                seen = not design.drops_results or run.shows(place)
                mine[:] = list(islice(nearly if seen else dropped, len(mine)))
            if interval % 4 == 2:
                marks[(0, len(marks) - 1, rng.randrange(len(marks)))[interval // 4 % 3]] = 1
        parts.append(np.hstack([rows, faults]))
    return parts


def _nearly(allowed: Sequence[Interval]) -> Iterator[list[int]]:
    """Six counts that differ from a rail by one bit: each bit below the sign, at either rail."""
    places = [(word.lo, word.hi, word.bits - 1) for word in allowed]
    return cycle(
        [
            [
                lo + (1 << bit % below) if at_low else hi - (1 << bit % below)
                for lo, hi, below in places
            ]
            for bit in range(max(below for _, _, below in places))
            for at_low in (True, False)
        ]
    )


def _coins(seed: int, shape: tuple[int, ...]) -> NDArray[np.bool_]:
    rng = random.Random(_SEED + seed)
    return np.array([[rng.random() < 0.5 for _ in range(shape[1])] for _ in range(shape[0])])


def _turn(interval: int, lows: list[int], highs: list[int]) -> tuple[list[int], list[int]]:
    return (lows, highs) if interval % 16 == 1 else (highs, lows)


def _wild(rng: random.Random, allowed: Sequence[Interval], count: int) -> NDArray[np.int64]:
    """(count, 6) random counts: half of them full-scale, some in long runs."""
    rows: list[list[int]] = []
    small, sixth = _below(rng, 7), _below(rng, 6)
    anywhere = [(word.lo, word.hi, _below(rng, word.hi - word.lo + 1)) for word in allowed]
    while len(rows) < count:
        held = [rng.choice((word.lo, word.hi)) for word in allowed]  # drives sums to their ends
        for _ in range(rng.choice((1, 2, 3, 40))):
            row = []
            for end, (lo, hi, uniform) in zip(held, anywhere, strict=True):
                far, near = lo + uniform(), small() - 3
                row.append((end, end, lo, hi, near, far)[sixth()])
            rows.append(row)
    return np.array(rows[:count], np.int64)


def _below(rng: random.Random, limit: int) -> Callable[[], int]:
    """Whole numbers from 0 to below a limit, as `rng.randrange(limit)` has them."""
    draw, bits = rng.getrandbits, limit.bit_length()

    def one() -> int:
        while (found := draw(bits)) >= limit:
            pass
        return found

    return one
