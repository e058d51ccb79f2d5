"""Word lengths: exact interval arithmetic, nothing leaves its range, and the ranges are tight."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from position_designs import HIGH_RESOLUTION, furthest
from sculler_model.algorithms import Vec
from sculler_model.design import (
    HIGH_RESOLUTION_VECTORS,
    VECTORS,
    ZERO_RANGE,
    Design,
    Interval,
    Result,
    cross_range,
    range_of_sum,
    word_lengths,
)
from sculler_model.errors import InputError
from sculler_model.golden import GoldenModel
from strategies import DESIGNS, designs, make_design, random_counts

SMALL = [Interval(lo, hi) for lo in range(-4, 5) for hi in range(lo, 5)]


def values(interval: Interval) -> range:
    return range(interval.lo, interval.hi + 1)


def hull(numbers: Iterable[int]) -> Interval:
    numbers = list(numbers)
    return Interval(min(numbers), max(numbers))


class TestInterval:
    @pytest.mark.parametrize("interval", SMALL, ids=str)
    def test_one_interval(self, interval: Interval) -> None:
        assert -interval == hull(-a for a in values(interval))
        assert [v for v in range(-6, 7) if v in interval] == list(values(interval))
        for factor in range(-3, 4):
            assert interval.scaled(factor) == hull(factor * a for a in values(interval))
        for count in range(4):
            sums = (sum(choice) for choice in product((interval.lo, interval.hi), repeat=count))
            assert interval.repeated(count) == hull(sums)

    @pytest.mark.parametrize(
        ("ours", "each"),
        [
            (Interval.__add__, int.__add__),
            (Interval.__sub__, int.__sub__),
            (Interval.__mul__, int.__mul__),
        ],
    )
    def test_two_intervals(
        self,
        ours: Callable[[Interval, Interval], Interval],
        each: Callable[[int, int], int],
    ) -> None:
        for left, right in product(SMALL, SMALL):
            assert ours(left, right) == hull(
                each(a, b) for a in values(left) for b in values(right)
            )
            assert left | right == hull([*values(left), *values(right)])

    def test_cross(self) -> None:
        few = [i for i in SMALL if i.hi - i.lo in (0, 3) or i.lo == -4]
        for left, right in product(few, few):
            ends = product(*[(left.lo, left.hi)] * 2, *[(right.lo, right.hi)] * 2)
            assert cross_range(left, right) == hull(a * d - b * c for a, b, c, d in ends)

    def test_total(self) -> None:
        assert range_of_sum([]) == ZERO_RANGE
        assert range_of_sum([Interval(-1, 2), Interval(3, 4), Interval(-9, -9)]) == Interval(-7, -3)

    def test_bits_is_the_narrowest_word(self) -> None:
        for lo in range(-20, 21):
            for hi in range(lo, 21):
                interval = Interval(lo, hi)
                word = Interval.signed(interval.bits)
                assert word | interval == word
                if interval.bits > 1:
                    narrower = Interval.signed(interval.bits - 1)
                    assert narrower | interval != narrower

    @pytest.mark.parametrize("bits", range(1, 70))
    def test_signed_word(self, bits: int) -> None:
        word = Interval.signed(bits)
        assert (word.lo, word.hi, word.bits) == (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1, bits)

    def test_empty(self) -> None:
        with pytest.raises(ValueError, match=r"empty interval 3\.\.2"):
            Interval(3, 2)


class Watched(GoldenModel):
    """The reference model, looked at after every sum and every sample."""

    def _weighted_sum(self, coefficients: Iterable[tuple[int, int]], counts: list[Vec]) -> Vec:
        pairs = list(coefficients)
        value = super()._weighted_sum(pairs, counts)
        taps = "gyro_taps", "accel_taps"
        sums = "theta", "v"
        name = (sums if pairs and pairs[0][0] == 0 else taps)[counts is self.r]
        self.inside(name, value)
        return value

    def step(self, gyro: Vec, accel: Vec, fault: int = 0) -> Result | None:
        result = super().step(gyro, accel, fault)
        for name in VECTORS:
            self.inside(name, getattr(result or self, name))
        if self.position is not None:
            for name in HIGH_RESOLUTION_VECTORS:
                self.inside(name, getattr(result or self.position, name))
        return result

    def inside(self, name: str, vector: Vec) -> None:
        allowed = getattr(self.design.words, name)
        assert all(component in allowed for component in vector), name


def watch(design: Design, rows: list[list[int]]) -> list[Result]:
    return list(Watched(design).run(((a, b, c), (d, e, f), 0) for a, b, c, d, e, f in rows))


class TestNothingLeavesItsRange:
    @settings(max_examples=60, deadline=None)
    @given(design=designs(max_minors=12), seed=st.integers(0, 2**32))
    def test_any_design(self, design: Design, seed: int) -> None:
        samples = min(2 * design.samples_per_major, 300)
        watch(design, random_counts(design, samples, np.random.default_rng(seed)).tolist())

    @settings(max_examples=60, deadline=None)
    @given(design=designs(max_samples=4, max_minors=4), data=st.data())
    def test_every_axis_at_an_end_for_a_whole_phase(
        self, design: Design, data: st.DataObject
    ) -> None:
        words, n = design.words, design.algorithm.samples
        ends = [(words.gyro.lo, words.gyro.hi)] * 3 + [(words.accel.lo, words.accel.hi)] * 3
        phases = data.draw(
            st.lists(st.tuples(*map(st.sampled_from, ends)).map(list), min_size=n, max_size=n)
        )
        watch(design, phases * (3 * design.algorithm.minors))

    @pytest.mark.parametrize("name", DESIGNS)
    def test_named_designs(self, name: str) -> None:
        design = DESIGNS[name]
        words = design.words
        rng = np.random.default_rng(7)
        watch(design, random_counts(design, 3 * design.samples_per_major, rng).tolist())
        low = [words.gyro.lo] * 3 + [words.accel.lo] * 3
        watch(design, [low] * (2 * design.samples_per_major))


def x_range_over_corners(design: Design, vector: str, first: int, second: int) -> Interval:
    """What the x component of a vector reaches when `first` samples, then `second`, repeat.

    Each group's y and z counts stand at any of their ends, 2^8 inputs.  A product of sums over
    different samples is extreme at a corner, so this is the whole range.
    """
    g, a = design.words.gyro, design.words.accel
    four = [(g.lo, g.hi)] * 2 + [(a.lo, a.hi)] * 2
    repeats = design.samples_per_major // (first + second)
    reached = []
    for gy, gz, ay, az, gy2, gz2, ay2, az2 in product(*four, *four):
        rows = [[0, gy, gz, 0, ay, az]] * first + [[0, gy2, gz2, 0, ay2, az2]] * second
        reached.append(getattr(watch(design, rows * repeats)[0], vector)[0])
    return hull(reached)


class TestRangesAreReached:
    """With p = 0 no sample enters two factors of a product: the ends of the ranges do occur."""

    @pytest.mark.parametrize("end", ["lo", "hi"])
    @pytest.mark.parametrize("name", DESIGNS)
    def test_alpha_and_nu(self, name: str, end: str) -> None:
        design = DESIGNS[name]
        words, table = design.words, design.table
        other = {"lo": "hi", "hi": "lo"}[end]
        assert table.weights[0] * table.weights[-1] >= 0  # a shared sample wants one end only
        rows = []
        for t in range(2 * design.samples_per_major):
            phase = t % table.samples + 1
            weight = table.weights[table.samples - phase] or table.weights[-1]
            at = end if weight >= 0 else other
            rows.append([getattr(words.gyro, at)] * 3 + [getattr(words.accel, at)] * 3)
        result = watch(design, rows)[-1]
        assert result.alpha == (getattr(words.alpha, end),) * 3
        assert result.nu == (getattr(words.nu, end),) * 3

    @pytest.mark.parametrize("bits", [(8, 11), (11, 8), (9, 9)])
    @pytest.mark.parametrize(("n", "minors"), [(2, 1), (3, 2), (4, 1)])
    @pytest.mark.parametrize("vector", ["coning_within", "sculling_within"])
    def test_within(self, n: int, minors: int, bits: tuple[int, int], vector: str) -> None:
        design = make_design("tight", n, 0, minors, bits)
        reached = x_range_over_corners(design, vector, n - 1, 1)
        assert getattr(design.words, vector) == reached

    @pytest.mark.parametrize("bits", [(8, 11), (11, 8), (9, 9)])
    @pytest.mark.parametrize("vector", ["coning_between", "sculling_between"])
    def test_between_of_two_minor_intervals(self, bits: tuple[int, int], vector: str) -> None:
        # alpha is the first theta alone, so both factors are free
        design = make_design("tight", 2, 0, 2, bits)
        assert getattr(design.words, vector) == x_range_over_corners(design, vector, 2, 2)

    @pytest.mark.parametrize("name", DESIGNS)
    def test_taps(self, name: str) -> None:
        # a sum of independent counts: every count at the end its tap's sign asks for
        design = DESIGNS[name]
        words, table = design.words, design.table
        for tapped, counts in ((words.gyro_taps, words.gyro), (words.accel_taps, words.accel)):
            ends = [
                [sum(c * (lo if (c > 0) == low else hi) for c in row) for row in table.taps]
                for low in (True, False)
                for lo, hi in [(counts.lo, counts.hi)]
            ]
            assert tapped == hull([0, *ends[0], *ends[1]])

    @pytest.mark.parametrize("minors", [3, 8, 64])
    def test_between_is_within_two_bits_for_many(self, minors: int) -> None:
        # theta enters as a factor and in alpha, so the end itself is out of reach: half the
        # interval along y, then half along z, makes a quarter of what the range allows
        design = make_design("loose", 2, 0, minors, (8, 8))
        lo = design.words.gyro.lo
        half = minors // 2
        rows = [[0, lo, 0, 0, 0, 0]] * (2 * half) + [[0, 0, lo, 0, 0, 0]] * (2 * (minors - half))
        result = watch(design, rows)[0]
        reached = Interval(0, result.coning_between[0])
        assert design.words.coning_between.bits - reached.bits <= 2

    def test_one_minor_interval_has_no_between(self) -> None:
        words = DESIGNS["taylor_7p0"].words
        assert words.coning_between == words.sculling_between == ZERO_RANGE


def test_widths_of_the_default_design_by_hand() -> None:
    """Taps 54 + 92 + 214 = 360, n = 4, M = 5, 24 bits: with c = 2^23,

    A in +-360 c, one cross product in +-2 * 360 c^2 (less what the positive end lacks), five of
    them and for sculling twice that.
    """
    words = DESIGNS["stim300_4x5"].words
    c = 2**23
    assert words.gyro_taps == Interval(-360 * c, 360 * (c - 1))
    assert words.theta == Interval(-4 * c, 4 * (c - 1))
    assert words.alpha == words.nu == Interval(-20 * c, 20 * (c - 1))
    largest = 5 * 360 * (c * c + c * (c - 1))
    assert words.coning_within == Interval(-largest, largest)
    assert words.sculling_within == Interval(-2 * largest, 2 * largest)
    # alpha before minor m is m theta: 0 + 1 + 2 + 3 + 4 = 10 products of two thetas
    largest = 10 * 16 * (c * c + c * (c - 1))
    assert words.coning_between == Interval(-largest, largest)
    assert words.sculling_between == Interval(-2 * largest, 2 * largest)
    assert words.s_alpha is words.s_nu is words.scrolling is words.higher is None


def test_second_order_without_position_is_what_is_not_asked_for() -> None:
    table = DESIGNS["stim300_4x5"].table
    found = word_lengths(24, 24, 5, table)
    assert found == word_lengths(24, 24, 5, table, False, 2) == DESIGNS["stim300_4x5"].words
    assert found.s_alpha is found.coning_third is None


def test_results_of_512_bits_are_the_widest() -> None:
    """Sculling sums four products of a tap of 2^k and two counts of 8 bits: k + 17 bits."""
    counts = {"bits": 8, "lsb": 1e-6}
    sensor = {"kind": "increment", "sample_rate_hz": 100.0, "gyro": counts, "accel": counts}

    def made(k: int) -> Design:
        table = {"denominator": 3, "taps": [[], [2**k]]}
        algorithm = {"samples": 2, "minors": 1, "family": "table", "table": table}
        return Design.parse({"name": "wide", "sensor": sensor, "algorithm": algorithm})

    assert made(495).words.sculling_within.bits == 512
    with pytest.raises(InputError, match="sculling_within would have 513 bits, more than the 512"):
        made(496)


class TestHighResolutionPosition:
    @pytest.mark.parametrize("name", HIGH_RESOLUTION)
    @pytest.mark.parametrize("end", ["lo", "hi"])
    def test_doubly_integrated_sums_reach_their_ends(self, name: str, end: str) -> None:
        design = HIGH_RESOLUTION[name]
        words = design.words
        row = [getattr(words.gyro, end)] * 3 + [getattr(words.accel, end)] * 3
        result = watch(design, [row] * (2 * design.samples_per_major))[-1]
        assert words.s_alpha is not None
        assert words.s_nu is not None
        assert result.s_alpha == (getattr(words.s_alpha, end),) * 3
        assert result.s_nu == (getattr(words.s_nu, end),) * 3

    @pytest.mark.parametrize("name", HIGH_RESOLUTION)
    def test_random_counts_stay_inside(self, name: str) -> None:
        design = HIGH_RESOLUTION[name]
        samples = min(6 * design.samples_per_major, 600)
        watch(design, random_counts(design, samples, np.random.default_rng(2)).tolist())

    @pytest.mark.parametrize(("minors", "share"), [(1, 0.99), (2, 0.92), (3, 0.84)])
    def test_scrolling_over_all_corners_of_few_samples(self, minors: int, share: float) -> None:
        """All counts at an end, y and z of both sensors in the interval and the sample before.

        What a component reaches is the sum of what its two products reach, s_y r_z and s_z r_y.
        """
        options = {"position": "high-resolution"}
        compact = {"core": "compact"}
        design = make_design("tight", 1, 1, minors, (9, 8), options=options, hardware=compact)
        words = design.words
        count = minors + 1
        ends = product(
            product((words.gyro.lo, words.gyro.hi), repeat=count),
            product((words.accel.lo, words.accel.hi), repeat=count),
        )
        reached = []
        for s, r in ends:
            rows = [[0] * 6] * (minors - 1)
            rows += [[0, y, 0, 0, 0, z] for y, z in zip(s, r, strict=True)]
            vector = watch(design, rows)[-1].scrolling
            assert vector is not None
            reached.append(vector[0])
        one = hull(reached)
        both = one - one  # the other product is subtracted
        assert words.scrolling is not None
        assert words.scrolling | both == words.scrolling
        assert share < both.hi / words.scrolling.hi <= 1
        assert share < both.lo / words.scrolling.lo <= 1

    @pytest.mark.parametrize("sign", [1, -1])
    @pytest.mark.parametrize("name", HIGH_RESOLUTION)
    def test_scrolling_is_at_most_a_bit_wider_than_it_need_be(self, name: str, sign: int) -> None:
        """Constructed counts come to 56 % of the end or more, whatever the number of samples."""
        design = HIGH_RESOLUTION[name]
        allowed = design.words.scrolling
        assert allowed is not None
        for axis in range(3):
            vector = watch(design, furthest(design, axis, sign).tolist())[1].scrolling
            assert vector is not None
            end = allowed.hi if sign > 0 else allowed.lo
            assert 0.56 < vector[axis] / end <= 1
            assert allowed.bits - Interval(min(0, vector[axis]), max(0, vector[axis])).bits <= 1

    def test_widths_of_24_bits_and_20_samples_by_hand(self) -> None:
        words = HIGH_RESOLUTION["stim300_hr"].words
        c = 2**23
        # the k-th last of 20 samples counts 12 k + 6, the last 5, the one before the interval 1
        weight = sum(12 * k + 6 for k in range(20))
        assert words.s_alpha == words.s_nu == Interval(-weight * c, weight * (c - 1))
        largest = 6000084 * (c * c + c * (c - 1))
        assert words.scrolling == Interval(-largest, largest)
        assert words.scrolling.bits == 71
