"""High-resolution position in the compact core's schedule, run in plain Python; no hardware yet.

What the schedule of every design must keep to is in `test_compact_program`.
"""

import re
from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from position_designs import HIGH_RESOLUTION, furthest
from sculler_hdl.plan.compact.digits import digit_count
from sculler_hdl.plan.compact.instructions import When
from sculler_hdl.plan.compact.interpreter import Interpreter
from sculler_hdl.plan.compact.plan import plan_compact
from sculler_hdl.plan.compact.scrolling import WEIGHTS, factor_ranges
from sculler_model.algorithms import scrolling_weight
from sculler_model.design import Interval
from sculler_model.golden import GoldenModel, to_words
from strategies import DESIGNS, make_design, random_counts, with_hardware

EACH = pytest.mark.parametrize("design", HIGH_RESOLUTION.values(), ids=HIGH_RESOLUTION)


def samples_of(counts):
    return [(tuple(row[:3]), tuple(row[3:]), 0) for row in counts.tolist()]


def interpreter_of(design):
    made = plan_compact(design)
    return Interpreter(made.program, made.pipeline.store)


def runs_as_the_golden_model(design, counts):
    """Results of both are equal word by word; the interpreter checks ranges."""
    interpreter, golden = interpreter_of(design), GoldenModel(design)
    results = []
    for sample in samples_of(counts):
        words, result = interpreter.step(sample), golden.step(*sample)
        assert (words is None) == (result is None)
        if result is not None:
            assert words == to_words(design, result.row())
            results.append(result)
    return results


@settings(deadline=None, max_examples=25)
@given(
    st.integers(1, 6),
    st.integers(1, 12),
    st.tuples(st.integers(8, 32), st.integers(8, 32)),
    st.integers(0, 2**32 - 1),
    st.sampled_from([{}, {"target": "ice40"}, {"multipliers": 0}]),
)
def test_schedule_of_any_design_gives_the_golden_vectors(n, minors, bits, seed, hardware):
    design = make_design(
        *("any", n, int(n == 1), minors, bits),
        options={"position": "high-resolution"},
        hardware={"core": "compact", **hardware},
    )
    counts = random_counts(design, 3 * design.samples_per_major, np.random.default_rng(seed))
    runs_as_the_golden_model(design, counts)


@EACH
@pytest.mark.parametrize(("axis", "sign"), [(0, 1), (1, -1), (2, 1)])
def test_near_the_extremes_of_scrolling(design, axis, sign):
    results = runs_as_the_golden_model(design, furthest(design, axis, sign))
    assert sign * results[1].scrolling[axis] > 0.55 * design.words.scrolling.hi


@pytest.mark.parametrize("name", ["smallest_hr", "savage_hr", "taylor_2p1_hr", "dense_hr"])
def test_the_sums_are_what_the_result_would_be_if_only_zeros_came(name):
    """At any time; so no partial sum can leave the range of its result."""
    design = HIGH_RESOLUTION[name]
    length = design.samples_per_major
    samples = samples_of(random_counts(design, 2 * length, np.random.default_rng(6)))
    zero = ((0, 0, 0), (0, 0, 0), 0)
    interpreter = interpreter_of(design)
    for t, sample in enumerate(samples):
        interpreter.step(sample)
        if t >= length:
            ended = [*samples[: t + 1], *[zero] * (2 * length - t - 1)]
            _, result = GoldenModel(design).run(ended)
            for vector in ("alpha", "nu", "s_alpha", "s_nu", "scrolling"):
                assert held(interpreter, vector) == getattr(result, vector)


def held(interpreter, vector):
    """What the left memory holds of an accumulated vector."""
    names = interpreter.program.left.names
    digits = digit_count(getattr(interpreter.program.design.words, vector).bits)
    return tuple(
        sum(
            interpreter.memory["left"][names.index(f"{vector}_{axis}.{i}")] << 16 * i
            for i in range(digits)
        )
        for axis in "xyz"
    )


@pytest.mark.parametrize("samples", [1, 2, 3, 5, 20, 300])
def test_ranges_of_the_factors_hold_and_waste_little(samples):
    """C of sample u is the sum of c_iu Δα_i, i <= u; D that of -c_uj Δυ_j, j < u."""
    counts = Interval.signed(24)

    def weights(of):
        return [sum(abs(of(i, u)) for i in range(u)) for u in range(1, samples + 1)]

    def c(i, j):
        return scrolling_weight(i, j, samples)

    own = [abs(c(u, u)) for u in range(1, samples + 1)]
    needed_c = counts.repeated(max(map(sum, zip(weights(c), own, strict=True))))
    needed_d = counts.repeated(max(weights(lambda j, i: c(i, j))))
    range_c, range_d = factor_ranges(counts, counts, samples)
    for needed, found in ((needed_c, range_c), (needed_d, range_d)):
        assert found | needed == found
        assert found.bits <= needed.bits + 1
    if samples == 20:  # of the default design
        digits = [digit_count(one.bits) for one in (needed_c, range_c, needed_d, range_d)]
        assert digits == [3, 3, 3, 3]


@pytest.mark.parametrize("samples", [1, 2, 7])
def test_ranges_of_the_weights(samples):
    """From the values themselves."""
    for weight in WEIGHTS:
        values = [weight.at(to_come) for to_come in range(samples)]
        values[0] += weight.last
        assert weight.range(samples) == Interval(min(values), max(values))


def test_instructions_of_the_default_design():
    """Counted by hand: digits are 2 of s, r, alpha, nu, 3 of s_alpha, s_nu, C, D, 5 of scrolling,
    and a column of the result has 5 words."""
    design = HIGH_RESOLUTION["stim300_hr"]
    by_phase = {}
    for phase, instructions in plan_compact(design).program.phases.items():
        names = (re.sub("_[xyz]$", "", i.text.split(".")[0]) for i in instructions)
        by_phase[phase] = Counter(names)
    weights = {"c_alpha": 2, "c_1": 2, "c_0": 2, "d_nu": 2, "d_1": 2, "w": 2}  # state and step
    each = Counter(
        weights,
        C=3 * (2 + 2 + 2 + 3),
        D=3 * (2 + 2 + 3),
        s_alpha=3 * (3 + 2),  # state, sample
        s_nu=3 * (3 + 2),
        alpha=3 * (2 + 2),
        nu=3 * (2 + 2),
        scrolling=3 * (5 + 4 * 6),  # state, four products of 3 x 2 digits
    )
    assert by_phase[2] == by_phase[3] == each
    # where it starts: first values of the weights, 2 digits of s' or r', and 18 s' x r'
    start = Counter(dict.fromkeys(weights, 1), C=6, D=6, s_alpha=6, s_nu=6, E=6)
    start["scrolling"] = 3 * 2 * 4
    assert by_phase[1] == each + start
    # what the last sample differs by, and the words of the sign
    end = Counter(c_alpha=1, c_0=1, d_nu=1, w=1, alpha=9, nu=9, s_alpha=6, s_nu=6)
    # and what every design has, as the same one without has it, with 5 words for 4
    rest = Counter(A=18, B=18, theta=24, v=24, major=5 + 1, status=1 + 1)
    rest |= {f"coning_{where}": 3 * (5 + 2 * 4) for where in ("within", "between")}
    rest |= {f"sculling_{where}": 3 * (5 + 4 * 4) for where in ("within", "between")}
    assert by_phase[4] == each + end + rest
    # and the last one's way: 8 to its store, 2 to its fetch, 1 to begin
    assert plan_compact(design).timing.work == tuple(
        c.total() + 8 + 2 + 1 for c in by_phase.values()
    )
    assert plan_compact(design).resources["clocks_per_minor"] == 1238


def test_the_listing_says_what_the_page_says():
    text = plan_compact(HIGH_RESOLUTION["stim300_hr"]).listing
    for meaning in (
        "C_x.0 = alpha_x.0 * c_alpha",
        "C_x.0 += c_1 * s_x[t-1].0",
        "C_x.0 += c_0 * s_x[t].0",
        "C_x.0 += s_alpha_x.0 * -60",
        "s_alpha_y.1 += w * s_y[t].1",
        "scrolling_z.2 -= D_y.2 * s_x[t].0",
        "first_minor  in the major interval's first minor interval",
    ):
        assert meaning in text
    assert max(map(len, text.splitlines())) <= 110


@pytest.mark.parametrize("name", DESIGNS)
def test_other_designs_use_no_condition_that_their_engine_has_not(name):
    made = plan_compact(with_hardware(DESIGNS[name], core="compact")).program
    used = {instruction.when for phase in made.phases.values() for instruction in phase}
    assert used.isdisjoint({When.FIRST_MINOR, When.MAJOR_END})
