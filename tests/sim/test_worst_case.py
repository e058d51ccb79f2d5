"""The word-length theorem at its worst case.

For every component of the result the inputs that drive it to its true extreme are constructed
(`extremes`), and given to golden model and both cores.  Where the interval of `WordLengths` can be
reached, it is reached to the last count.  Where it cannot, because one count enters two factors of
the same sum, it is seen how far the true extreme stays inside, and whether a bit could be saved.
"""

from functools import lru_cache

import numpy as np
import pytest

from extremes import Extreme, bilinear, extreme, linear, minor_sums, reach_of
from rtl import golden
from sculler_model.design import COLUMNS, VECTORS, ZERO_RANGE, Interval
from sculler_model.golden import GoldenModel
from sculler_sim.engine import simulate
from strategies import CORES, DESIGNS, on_cores, random_counts
from tiers import few_of

WITHIN = ("coning_within", "sculling_within")
BETWEEN = ("coning_between", "sculling_between")
ENDS = [(axis, sign) for axis in range(3) for sign in (1, -1)]

SOLVED = [name for name in DESIGNS if name not in ("savage_1p1", "taylor_8p8", "rate_2p0")]
"""The others have too many corners to go through."""

SLOW = ("late_sum_2", "rate_4p1")

SIMULATED = """stim300_4x5 taylor_2p0 taylor_2p1 taylor_3p3 taylor_7p0 wide_5p0 rate_1p0 rate_4p1
    dense_time_3 dense_uncompressed_4 dense_odd_3 time_3p2 smallest late_sum_2""".split()

EACH_SIMULATED = pytest.mark.parametrize(
    "name", few_of(SIMULATED, "stim300_4x5 dense_odd_3 smallest".split())
)

# Designs whose sums would fit one bit less than the intervals give them.  In the within sums of
# dense tables a count is factor of one product and tap of another; in the between sums a minor
# interval's theta is both a factor and a part of alpha later on.
SPARE_WITHIN = "dense_uncompressed_4 time_3p2 uncompressed_5p0".split()
SPARE_BETWEEN = """stim300_4x5 taylor_2p0 taylor_2p1 wide_5p0 rate_1p0 rate_4p1 dense_time_3
    dense_uncompressed_4 uncompressed_5p0 fit_4p1 tuned_rate_3p0 late_sum_2""".split()


@lru_cache
def solved(name: str, vector: str, sign: int) -> Extreme:
    return extreme(DESIGNS[name], vector, sign)


def true_range(name: str, vector: str) -> Interval:
    return Interval(-solved(name, vector, -1).value, solved(name, vector, 1).value)


def compressed(design):
    """Only the last phase has taps, and they stay inside the minor interval."""
    table = design.table
    last_only = table.active_phases == (table.samples,)
    return last_only and not any(table.taps[-1][table.samples - 1 :])


@pytest.mark.parametrize("name", few_of(SOLVED, [n for n in SOLVED if n not in SLOW]))
def test_how_far_the_intervals_are_from_the_true_extremes(name):
    design = DESIGNS[name]
    words, minors = design.words, design.algorithm.minors
    for vector in ("alpha", "nu"):
        assert true_range(name, vector) == getattr(words, vector)
    for vectors, spare in ((WITHIN, SPARE_WITHIN), (BETWEEN, SPARE_BETWEEN)):
        for vector in vectors:
            interval, true = getattr(words, vector), true_range(name, vector)
            assert interval | true == interval  # inside
            assert interval.bits - true.bits == (name in spare)
            if vector in WITHIN and (compressed(design) or minors == 1):
                assert interval == true
            if vector in BETWEEN and minors <= 2:
                assert interval == true
    if minors > 2:
        # theta like (H, H) for the first half of the minor intervals and (-H, H) for the second
        # makes the most of alpha x theta: M^2/2 of H^2, of the M (M - 1) the intervals allow
        share = minors**2 // 2 / (minors * (minors - 1))
        coarse = 2.0 ** (3 - min(design.sensor.gyro.bits, design.sensor.accel.bits))
        for vector in BETWEEN:
            interval, true = getattr(words, vector), true_range(name, vector)
            assert true.hi / interval.hi == pytest.approx(share, rel=coarse)
            assert true.lo / interval.lo == pytest.approx(share, rel=coarse)


def test_the_extremes_of_a_bilinear_form_by_going_through_all_corners():
    rng = np.random.default_rng(1)
    p_box, q_box = Interval(-4, 3), Interval(-7, 5)
    for _ in range(60):
        size = int(rng.integers(1, 7))
        form = (rng.integers(-3, 4, (size, size)) * (rng.random((size, size)) < 0.5)).astype(object)
        form[rng.integers(size)] = -2 * form[0]  # rows that go together
        corners = np.array(np.meshgrid(*[[0, 1]] * size)).reshape(size, -1).T
        p = np.where(corners, p_box.hi, p_box.lo)
        q = np.where(corners, q_box.hi, q_box.lo)
        value, *found = bilinear(form, p_box, q_box)
        assert value == (p @ form @ q.T).max()
        assert value == found[0] @ form @ np.array(found[1], object)


def log_of(design, counts, rng):
    """Samples in which a major interval begins after the history that `counts` prescribe.

    Args:
        design: the design.
        counts: by sensor axis, ending with the interval; where they say nothing, random full-scale
            counts stand.
        rng: the source of those.
    """
    reach, per_major = reach_of(design), design.samples_per_major
    lead = -(-reach // per_major) * per_major
    rows = random_counts(design, lead + per_major, rng)
    for (sensor, axis), column in counts.items():
        rows[len(rows) - len(column) :, axis + (3 if sensor == "accel" else 0)] = column
    return rows


def check_cores(design, counts):
    """Both cores give the golden model's rows, in Verilator; the golden rows."""
    faults = np.zeros(len(counts), int)
    reference = list(golden(design, counts, faults).rows())
    for core in on_cores(design, CORES).values():
        rows = [row for block in simulate(core, [(counts, faults)]) for row in block.rows()]
        assert rows == reference
    return reference


@EACH_SIMULATED
def test_the_extreme_of_every_component_is_reached_and_held(verilator, name):
    """All six vectors, all axes, both ends: by the golden model and by both cores."""
    design, rng = DESIGNS[name], np.random.default_rng(3)
    logs, wanted = [], []
    length = 0
    for vector in VECTORS:
        if getattr(design.words, vector) == ZERO_RANGE:
            continue
        for axis, sign in ENDS:
            found = solved(name, vector, sign)
            counts = {(s, (axis + after) % 3): c for (s, after), c in found.counts.items()}
            logs.append(log_of(design, counts, rng))
            length += len(logs[-1])
            column = COLUMNS.index(f"{vector}_{'xyz'[axis]}")
            wanted.append((length // design.samples_per_major - 1, column, sign * found.value))
    rows = check_cores(design, np.concatenate(logs))
    for major, column, value in wanted:
        assert rows[major][column] == value, (major, COLUMNS[column])


class Watched(GoldenModel):
    """A golden model that keeps what its sums were: A and B at every sample, theta and v."""

    def __init__(self, design):
        super().__init__(design)
        self.sums = []

    def _weighted_sum(self, coefficients, counts):
        total = super()._weighted_sum(coefficients, counts)
        self.sums.append(total)
        return total


@EACH_SIMULATED
def test_the_extremes_of_the_sums_are_reached_and_held(verilator, name):
    """A, B, theta and v, which the result does not show, in factors that it does show."""
    design, rng = DESIGNS[name], np.random.default_rng(4)
    table, words = design.table, design.words
    length = reach_of(design) + design.samples_per_major
    first_of_last = length - table.samples  # of the last minor interval
    logs = []
    for axis, sign in ENDS:
        for sensor in ("gyro", "accel"):
            for phase in table.active_phases:
                taps = np.zeros(length, object)
                for d, tap in enumerate(table.taps[phase - 1], start=1):
                    taps[first_of_last + phase - 1 - d] = tap
                _, counts = linear(sign * taps, getattr(words, sensor))
                logs.append(log_of(design, {(sensor, axis): counts}, rng))
            _, counts = linear(sign * minor_sums(design)[-1], getattr(words, sensor))
            logs.append(log_of(design, {(sensor, axis): counts}, rng))
    counts = np.concatenate(logs)
    check_cores(design, counts)

    model = Watched(design)
    seen = {"gyro_taps": [], "accel_taps": [], "theta": [], "v": []}
    for t, row in enumerate(counts.tolist()):
        model.sums.clear()
        model.step(tuple(row[:3]), tuple(row[3:]))
        if (t + 1) % design.samples_per_major == 0 or t >= reach_of(design):
            for sums, at in zip(seen.values(), model.sums, strict=False):
                sums.append(at)
    for quantity, vectors in seen.items():
        for axis in range(3):
            numbers = [vector[axis] for vector in vectors]
            assert Interval(min(numbers), max(numbers)) == getattr(words, quantity)
