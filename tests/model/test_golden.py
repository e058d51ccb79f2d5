"""The reference model against the mathematics: double sums over all pairs, and exact motions."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from fractions import Fraction
from itertools import combinations
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from position_designs import HIGH_RESOLUTION
from sculler_model.algorithms import Vec, high_resolution
from sculler_model.design import Design, Result
from sculler_model.errors import InputError
from sculler_model.golden import GoldenModel, Sample
from strategies import DESIGNS, designs, make_design, random_counts

F = Fraction
Rational = tuple[Fraction, ...]
Pairs = dict[tuple[int, int], Fraction]
"""Coefficient of the pair of samples (earlier, later)."""


def cross(a: tuple[Any, ...], b: tuple[Any, ...]) -> Rational:
    return tuple(
        F(a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3]) for i in range(3)
    )


def plus(a: Rational, b: Rational) -> Rational:
    return tuple(x + y for x, y in zip(a, b, strict=True))


def scaled(vector: Vec, denominator: int) -> Rational:
    return tuple(F(c, denominator) for c in vector)


def samples_of(rows: list[list[int]]) -> list[Sample]:
    return [((a, b, c), (d, e, f), 0) for a, b, c, d, e, f in rows]


def run(design: Design, rows: list[list[int]]) -> list[Result]:
    return list(GoldenModel(design).run(samples_of(rows)))


def pair_coefficients(design: Design, major: int) -> tuple[Pairs, Pairs, dict[int, Fraction]]:
    """Of one major interval: within, between, and each sample's share of the angle.

    The correction to the rotation vector is then one double sum over pairs of samples, k s_i x s_j
    (sculling: k (s_i x r_j + r_i x s_j)); nothing is accumulated.
    """
    table, n, M = design.table, design.algorithm.samples, design.algorithm.minors
    first = major * n * M
    within: Pairs = defaultdict(F)
    for t in range(first, first + n * M):
        for d, tap in enumerate(table.taps[t % n], start=1):
            within[t - d, t] += F(tap, table.denominator)
    weights = {
        minor: {
            first + minor * n + n - 1 - d: F(w, table.sum_denominator)
            for d, w in enumerate(table.weights)
        }
        for minor in range(M)
    }
    between: Pairs = defaultdict(F)
    for earlier, later in combinations(range(M), 2):
        for i, w_i in weights[earlier].items():
            for j, w_j in weights[later].items():
                between[i, j] += w_i * w_j / 2
    share: dict[int, Fraction] = defaultdict(F)
    for minor in weights.values():
        for i, w in minor.items():
            share[i] += w
    return within, between, share


def direct(design: Design, rows: list[list[int]], major: int) -> list[Rational]:
    """alpha, coning within and between, nu, sculling within and between, as rationals."""
    at = defaultdict(lambda: (0,) * 6, enumerate(map(tuple, rows)))  # zero before the first

    def s(i: int) -> tuple[int, ...]:
        return at[i][:3]

    def r(i: int) -> tuple[int, ...]:
        return at[i][3:]

    def total(terms: Iterable[tuple[Fraction, tuple[Any, ...]]]) -> Rational:
        sums: Rational = (F(0),) * 3
        for factor, vector in terms:
            sums = plus(sums, tuple(factor * c for c in vector))
        return sums

    def coning(pairs: Pairs) -> Rational:
        return total((k, cross(s(i), s(j))) for (i, j), k in pairs.items())

    def sculling(pairs: Pairs) -> Rational:
        return total((k, plus(cross(s(i), r(j)), cross(r(i), s(j)))) for (i, j), k in pairs.items())

    within, between, share = pair_coefficients(design, major)
    return [
        total((w, s(i)) for i, w in share.items()),
        coning(within),
        coning(between),
        total((w, r(i)) for i, w in share.items()),
        sculling(within),
        sculling(between),
    ]


def as_host_reads_it(design: Design, result: Result) -> list[Rational]:
    """The six vectors over their denominators, in counts and counts squared."""
    Dc, Dw = design.table.denominator, design.table.sum_denominator
    return [
        scaled(result.alpha, Dw),
        scaled(result.coning_within, Dc),
        scaled(result.coning_between, 2 * Dw**2),
        scaled(result.nu, Dw),
        scaled(result.sculling_within, Dc),
        scaled(result.sculling_between, 2 * Dw**2),
    ]


def assert_is_the_double_sum(design: Design, rows: list[list[int]]) -> None:
    results = run(design, rows)
    assert [result.major for result in results] == list(
        range(len(rows) // design.samples_per_major)
    )
    for result in results:
        assert as_host_reads_it(design, result) == direct(design, rows, result.major)


@pytest.mark.parametrize("name", DESIGNS)
def test_named_designs_are_the_double_sum(name: str) -> None:
    design = DESIGNS[name]
    rng = np.random.default_rng(4)
    counts = random_counts(design, 2 * design.samples_per_major + 1, rng)
    assert_is_the_double_sum(design, counts.tolist())


@settings(max_examples=60, deadline=None)
@given(design=designs(max_samples=6, max_minors=5), majors=st.integers(1, 3), data=st.data())
def test_any_design_is_the_double_sum(design: Design, majors: int, data: st.DataObject) -> None:
    words = design.words
    gyro = st.integers(words.gyro.lo, words.gyro.hi) | st.just(words.gyro.lo)
    accel = st.integers(words.accel.lo, words.accel.hi) | st.just(words.accel.lo)
    sample = st.tuples(gyro, gyro, gyro, accel, accel, accel).map(list)
    size = majors * design.samples_per_major
    if size <= 12:
        rows = data.draw(st.lists(sample, min_size=size, max_size=size))
    else:
        seed = data.draw(st.integers(0, 2**32))
        rows = random_counts(design, size, np.random.default_rng(seed)).tolist()
    assert_is_the_double_sum(design, rows)


@settings(max_examples=100, deadline=None)
@given(
    n=st.integers(1, 8),
    p=st.integers(0, 8),
    minors=st.integers(1, 9),
    vectors=st.lists(st.tuples(*[st.integers(-50, 50)] * 3), min_size=4, max_size=4),
)
def test_a_linear_ramp_is_integrated_without_error(
    n: int, p: int, minors: int, vectors: list[Vec]
) -> None:
    """omega = A + B t, f = C + D t (t in samples) turn over N samples by what closed forms say.

    Coning, half the integral of alpha x omega, is A x B N^3/12; sculling, half that of
    alpha x f + upsilon x omega, is (A x D + C x B) N^3/12.  Every table matches the lowest power
    of frequency, and so these, without error.
    """
    if n + p < 2:
        n = 2
    design = make_design("ramp", n, min(p, n), minors, (32, 32))
    A, B, C, D = vectors
    N = design.samples_per_major
    rows = [  # the increment over [t, t+1] is A + B (t + 1/2); doubled to be integer
        [2 * a + b * (2 * t + 1) for a, b in zip((*A, *C), (*B, *D), strict=True)]
        for t in range(3 * N)
    ]
    settled = [result for result in run(design, rows) if not result.status]
    assert settled
    for result in settled:
        alpha, within, between, _, s_within, s_between = as_host_reads_it(design, result)
        start = result.major * N
        assert alpha == tuple(
            F(2 * a * N + b * ((start + N) ** 2 - start**2)) for a, b in zip(A, B, strict=True)
        )
        factor = F(4 * N**3, 12)
        assert plus(within, between) == tuple(factor * c for c in cross(A, B))
        assert plus(s_within, s_between) == tuple(
            factor * c for c in plus(cross(A, D), cross(C, B))
        )


@pytest.mark.parametrize("name", DESIGNS)
def test_constant_rate_and_force_need_no_coning(name: str) -> None:
    design = DESIGNS[name]
    rows = [[7, -5, 3, 14, -10, 6]] * (3 * design.samples_per_major + 40)
    last = run(design, rows)[-1]
    assert last.coning_within == last.coning_between == (0, 0, 0)
    assert last.sculling_within == last.sculling_between == (0, 0, 0)
    table, M = design.table, design.algorithm.minors
    assert last.alpha == tuple(c * M * sum(table.weights) for c in (7, -5, 3))
    assert last.nu == tuple(c * M * sum(table.weights) for c in (14, -10, 6))


def test_yang_example_by_hand() -> None:
    """n = 2, M = 2: A = 2 s1, Dc = 3; theta1 = s1 + s2, theta2 = s3 + s4."""
    design = make_design("hand", 2, 0, 2, (8, 8))
    rows = [[1, 0, 0, 0, 0, 9], [0, 1, 0, 0, 0, 0], [0, 0, 1, 0, 0, 0], [1, 0, 0, 5, 0, 0]]
    assert run(design, rows) == [
        Result(
            major=0,
            status=0,
            alpha=(2, 1, 1),
            coning_within=(0, 2, 2),  # 2 x x y + 2 z x x
            coning_between=(1, -1, -1),  # (1, 1, 0) x (1, 0, 1)
            nu=(5, 0, 9),
            sculling_within=(-18, 10, 0),  # 18 z x y, 2 z x 5 x
            sculling_between=(0, 9, -5),  # (1, 1, 0) x (5, 0, 0) + (0, 0, 9) x (1, 0, 1)
        )
    ]


class TestStatus:
    @pytest.mark.parametrize(
        ("n", "table", "minors", "short"),
        [
            (3, {"taps": [1, 1]}, 1, 0),
            (3, {"taps": [1, 1, 1]}, 1, 1),
            (3, {"taps": [1, 1, 0, 0]}, 1, 0),
            (3, {"taps": [0, 0, 0, 0, 0, 1]}, 1, 2),
            (3, {"taps": [0, 0, 0, 0, 1]}, 1, 1),
            (3, {"taps": [[1], [], []]}, 1, 1),
            (3, {"taps": [[0, 0, 0, 0, 0, 0, 1], [], [1]]}, 1, 3),
            (3, {"taps": [[0, 0, 0, 0, 0, 0, 1], [], [1]]}, 2, 2),
            (3, {"taps": [[0, 0, 0, 0, 0, 0, 1], [], [1]]}, 3, 1),
            (1, {"taps": [0, 0, 0, 0, 1]}, 1, 5),
            (2, {"taps": [1], "weights": [1, 1]}, 1, 0),
            (2, {"taps": [1], "weights": [1, 1, 1]}, 1, 1),
            (2, {"taps": [1], "weights": [1, 1, 0]}, 1, 0),
        ],
    )
    def test_short_history_is_marked_until_no_coefficient_reaches_before_the_first_sample(
        self, n: int, table: dict[str, Any], minors: int, short: int
    ) -> None:
        design = make_design("history", n, 0, minors, (8, 8), denominator=3, **table)
        rows = [[0] * 6] * (6 * n * minors)
        assert [result.status for result in run(design, rows)] == [1] * short + [0] * (6 - short)

    @pytest.mark.parametrize("name", [*DESIGNS, *HIGH_RESOLUTION])
    def test_short_history_is_where_earlier_samples_would_make_a_difference(
        self, name: str
    ) -> None:
        rng = np.random.default_rng(19680220)
        design = (DESIGNS | HIGH_RESOLUTION)[name]
        span = design.samples_per_major
        lead = span * -(-max(design.table.history, 1) // span)
        counts = random_counts(design, lead + span * 3, rng)
        # the same samples after two pasts: vectors that differ have reached into the past
        pasts = [random_counts(design, lead, rng) for _ in range(2)]
        runs = [run(design, np.concatenate([past, counts]).tolist()) for past in pasts]
        count = len(counts) // span
        vectors = [[result[2:] for result in results[-count:]] for results in runs]
        differ = [one != other for one, other in zip(*vectors, strict=True)]
        assert [bool(r.status & 1) for r in run(design, counts.tolist())] == differ

    def test_a_fault_marks_its_own_interval(self) -> None:
        model = GoldenModel(make_design("fault", 2, 0, 2, (8, 8)))
        zero = (0, 0, 0)
        samples: list[Sample] = [(zero, zero, int(t in {4, 7, 11})) for t in range(16)]
        assert [result.status for result in model.run(samples)] == [0, 2, 2, 0]

    @pytest.mark.parametrize("column", range(6))
    def test_a_count_at_either_rail_marks_its_own_interval(self, column: int) -> None:
        model = GoldenModel(make_design("rail", 2, 0, 2, (8, 11)))
        low, high = (-128, 127) if column < 3 else (-1024, 1023)
        rows = [[0] * 6 for _ in range(24)]
        for t, count in ((4, low), (11, high), (13, low + 1), (14, high - 1), (16, 127), (23, low)):
            rows[t][column] = count
        found = [result.status for result in model.run(samples_of(rows))]
        assert found == [0, 4, 4, 0, 4 if column < 3 else 0, 4]

    def test_a_lost_sample_marks_the_interval_of_the_next_one(self) -> None:
        model = GoldenModel(make_design("lost", 2, 0, 2, (8, 8)))
        found = []
        for t in range(20):  # lost before samples 0, 6, 7, 12
            for _ in range({0: 1, 6: 1, 7: 3, 12: 1}.get(t, 0)):
                model.lose()
            found.append(model.step((0, 0, 0), (0, 0, 0)))
        assert [result.status for result in found if result] == [8, 8, 0, 8, 0]
        model.lose()
        model.reset()
        assert [r.status for r in model.run([((0, 0, 0), (0, 0, 0), 0)] * 4)] == [0]

    def test_all_four_bits(self) -> None:
        model = GoldenModel(DESIGNS["savage_1p1"])
        model.lose()
        end = model.design.words.accel.hi
        samples: list[Sample] = [((0, 0, 0), (0, end, 0), 1)] * 64
        assert [result.status for result in model.run(samples)] == [15]

    def test_a_mark_that_comes_twice_stays(self) -> None:
        model = GoldenModel(make_design("marks", 2, 0, 1, (8, 8)))
        for _ in range(2):
            model.lose()
            model.upset()
        sample: Sample = ((127, 0, 0), (0, -128, 0), 1)
        assert [result.status for result in model.run([sample] * 4)] == [2 + 4 + 8 + 16, 2 + 4]

    def test_both_bits(self) -> None:
        model = GoldenModel(DESIGNS["savage_1p1"])
        zero = (0, 0, 0)
        assert [r.status for r in model.run([(zero, zero, 1)] * 128)] == [3, 2]


@pytest.mark.parametrize("name", ["taylor_3p3", "rate_4p1", "dense_odd_3", "late_sum_2"])
def test_history_runs_on_over_majors_and_ends_at_reset(name: str) -> None:
    design = DESIGNS[name]
    span = design.samples_per_major
    rows = random_counts(design, 4 * span, np.random.default_rng(9)).tolist()
    model = GoldenModel(design)
    list(model.run(samples_of(rows[: span + span // 2])))
    model.reset()
    again = list(model.run(samples_of(rows)))
    assert again == run(design, rows)
    # without the first interval before it, the second comes out otherwise
    second = run(design, rows[span:])[0]
    assert second[2:] != again[1][2:]


@pytest.mark.parametrize("vector", [(1, 2), (1, 2, 3, 4), (1, 2, 3.0), "123", 7])
def test_three_whole_numbers_are_wanted(vector: Any) -> None:
    """What is given instead is shown, as much of it as a line holds."""
    model, zero = GoldenModel(DESIGNS["smallest"]), (0, 0, 0)
    for name, pair in (("gyro", (vector, zero)), ("accel", (zero, vector))):
        with pytest.raises(InputError) as raised:
            model.step(*pair)
        said = f"sample 0: {name}: {vector} is not allowed, give three whole numbers"
        assert str(raised.value) == said
    with pytest.raises(InputError, match=r"gyro: 1{40} is not"):
        model.step("1" * 50, zero)  # type: ignore[arg-type]
    assert model.t == 0


class TestWidths:
    @pytest.mark.parametrize(
        ("gyro", "accel", "message"),
        [
            ((128, 0, 0), (0, 0, 0), "gyro_x = 128 does not fit 8 bits, give -128 to 127"),
            ((0, -129, 0), (0, 0, 0), "gyro_y = -129 does not fit 8 bits, give -128 to 127"),
            ((0, 0, 0), (0, 0, 1024), "accel_z = 1024 does not fit 11 bits, give -1024 to 1023"),
            ((0, 0, 0), (-1025, 0, 0), "accel_x = -1025 does not fit 11 bits, give -1024 to 1023"),
        ],
    )
    def test_a_count_outside_is_refused_and_not_taken(
        self, gyro: Vec, accel: Vec, message: str
    ) -> None:
        model = GoldenModel(DESIGNS["dense_odd_3"])
        model.step((-128, 127, 0), (-1024, 1023, 0))
        with pytest.raises(InputError) as raised:
            model.step(gyro, accel, fault=1)
        assert str(raised.value) == f"sample 1: {message}"
        rows = [[1, 2, 3, 4, 5, 6]] * 14
        (result,) = model.run(samples_of(rows))
        expected = run(DESIGNS["dense_odd_3"], [[-128, 127, 0, -1024, 1023, 0], *rows])
        assert [result] == expected


@pytest.mark.parametrize("name", HIGH_RESOLUTION)
def test_high_resolution_position_beside_the_six_vectors(name: str) -> None:
    design = HIGH_RESOLUTION[name]
    rows = random_counts(design, 4 * design.samples_per_major, np.random.default_rng(3)).tolist()
    plain = Design.parse(
        {
            **design.as_json(),
            "algorithm": {**design.as_json()["algorithm"], "position": "trapezoidal"},
        }
    )
    both = [(gyro, accel) for gyro, accel, _ in samples_of(rows)]
    expected = high_resolution(both, design.samples_per_major)
    for found, six, more in zip(run(design, rows), run(plain, rows), expected, strict=True):
        assert found[2:8] == six[2:8]
        assert found[8:11] == more[2:]
        assert found.row() == (*six.row()[:1], found.status, *six.row()[2:], *sum(more[2:], ()))
        assert found.status == (six.status | 1 if found.major == 0 else six.status)
        assert six[8:] == (None,) * 7


def test_high_resolution_position_after_reset() -> None:
    design = HIGH_RESOLUTION["savage_hr"]
    rows = random_counts(design, 15, np.random.default_rng(4)).tolist()
    model = GoldenModel(design)
    list(model.run(samples_of(rows)))
    model.reset()
    assert list(model.run(samples_of(rows))) == run(design, rows)
