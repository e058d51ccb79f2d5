"""The fast twin equals the reference model, number by number."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from against_golden import assert_same, golden, in_chunks
from position_designs import HIGH_RESOLUTION, furthest
from sculler_model.design import Design, Interval
from sculler_model.errors import InputError
from sculler_model.fast import FastModel, VectorBlock, component_limbs, run_fast
from sculler_model.fast import arithmetic as fast
from strategies import DESIGNS, designs, huge_designs, make_design, random_counts


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(20120217)


@pytest.mark.parametrize("few_minors", [0, fast.FEW_MINORS, 4096])
@pytest.mark.parametrize("name", [*DESIGNS, *HIGH_RESOLUTION])
def test_equals_golden_for_named_designs(
    name: str, few_minors: int, rng: np.random.Generator
) -> None:
    design = (DESIGNS | HIGH_RESOLUTION)[name]
    span = design.samples_per_major
    counts = random_counts(design, 7 * span + span // 2 + 1, rng)
    faults = rng.random(len(counts)) < 0.5 / span
    expected = golden(design, counts, faults)
    model = FastModel(design, block=50, few_minors=few_minors)
    assert_same(model.feed(counts, faults), expected)
    model.reset()
    cuts = rng.integers(0, len(counts), 9).tolist()
    assert_same(in_chunks(model, counts, cuts, faults), expected)


def equals_golden(design: Design, data: st.DataObject) -> None:
    span = design.samples_per_major
    majors = data.draw(st.integers(1, max(2, 200 // span)))
    rng = np.random.default_rng(data.draw(st.integers(0, 2**32)))
    counts = random_counts(design, min(majors * span + 3, 2000), rng)
    cuts = data.draw(st.lists(st.integers(0, len(counts)), max_size=6))
    few, block = data.draw(st.sampled_from([0, 16, 4096])), data.draw(st.integers(1, 400))
    model = FastModel(design, block=block, few_minors=few)
    assert_same(in_chunks(model, counts, cuts), golden(design, counts))


@settings(max_examples=40, deadline=None)
@given(design=designs(), data=st.data())
def test_equals_golden_for_any_design(design: Design, data: st.DataObject) -> None:
    equals_golden(design, data)


@pytest.mark.deep
@settings(max_examples=400, deadline=None)
@given(design=designs(), data=st.data())
def test_equals_golden_for_many_designs(design: Design, data: st.DataObject) -> None:
    equals_golden(design, data)


@pytest.mark.parametrize(
    ("n", "p", "minors", "bits", "majors"),
    [
        (1, 1, 4096, (8, 9), 2),
        (2, 1, 4096, (32, 30), 1),
        (16, 16, 3, (32, 31), 4),
        (16, 16, 1, (8, 32), 9),
        (16, 0, 64, (32, 32), 1),
        (13, 5, 2, (24, 24), 5),
    ],
)
@pytest.mark.parametrize("lowest", [False, True], ids=["mixed", "all most negative"])
def test_equals_golden_at_the_corners(
    n: int,
    p: int,
    minors: int,
    bits: tuple[int, int],
    majors: int,
    lowest: bool,
    rng: np.random.Generator,
) -> None:
    design = make_design("corner", n, p, minors, bits)
    counts = random_counts(design, majors * design.samples_per_major, rng)
    if lowest:
        # every product at its end with a constant sign: x and y samples against z
        words = design.words
        counts[:] = [words.gyro.lo] * 3 + [words.accel.lo] * 3
        counts[n - 1 :: n, 0::3] = words.gyro.hi, words.accel.hi
    assert_same(run_fast(design, counts), golden(design, counts))


@settings(max_examples=30, deadline=None)
@given(design=huge_designs(), seed=st.integers(0, 2**32))
def test_equals_golden_for_coefficients_of_hundreds_of_bits(design: Design, seed: int) -> None:
    counts = random_counts(design, 40, np.random.default_rng(seed))
    assert_same(run_fast(design, counts), golden(design, counts))


def test_digits_are_used_where_a_component_can_pass_64_bits_and_only_there() -> None:
    for design in DESIGNS.values():
        assert (fast.digit_bits(design) < 64) == (component_limbs(design) > 1)
    assert component_limbs(DESIGNS["wide_5p0"]) == 2
    assert component_limbs(DESIGNS["stim300_4x5"]) == 1


@pytest.mark.parametrize("bits", [1, 2, 7, 20])
@pytest.mark.parametrize("width", [1, 2, 8, 9, 21, 22, 40])
def test_digits_hold_every_number_of_a_word(bits: int, width: int) -> None:
    word = Interval.signed(width)
    count = fast.digit_count(word, bits)
    for number in (word.lo, word.lo + 1, -1, 0, word.hi // 3, word.hi):
        digits = fast.split_digits(number, bits, count)
        assert sum(digit << bits * i for i, digit in enumerate(digits)) == number
        assert all(0 <= digit < 1 << bits for digit in digits[:-1])
        assert digits[-1] in Interval.signed(bits + 1)


@pytest.mark.parametrize("minors", [1, 2, 3, 20, 40])
@pytest.mark.parametrize("phases", [[16], [2, 4, 6, 8, 10, 12, 14, 16]])
def test_digits_at_their_largest(minors: int, phases: list[int]) -> None:
    # taps at even phases, y full scale before them and z at them: nothing cancels, and all but
    # the highest digits are as large as digits can be
    taps = [[1] if k in phases else [] for k in range(1, 17)]
    one: dict[str, Any] = {"denominator": 1, "taps": taps, "weights": [1]}
    design = make_design("even", 16, 0, minors, (32, 32), **one)
    full = 2**31 - 1
    counts = np.zeros((design.samples_per_major, 6), np.int64)
    counts[0::2, [1, 4]] = counts[1::2, [2, 5]] = full
    # of the sums theta, y in the first half and z in the second
    counts[15 : 16 * (minors // 2) : 16] = [0, full, 0, 0, full, 0]
    expected = golden(design, counts)
    assert component_limbs(design) > 1
    assert_same(run_fast(design, counts), expected)


def test_one_sample_at_a_time(rng: np.random.Generator) -> None:
    design = DESIGNS["taylor_3p1"]
    counts = random_counts(design, 50, rng)
    assert_same(in_chunks(FastModel(design), counts, list(range(1, 50))), golden(design, counts))


def test_several_blocks_at_full_size(rng: np.random.Generator) -> None:
    design = DESIGNS["late_sum_2"]
    counts = random_counts(design, 3 * fast.BLOCK // 2, rng)
    whole = run_fast(design, counts)
    assert_same(in_chunks(FastModel(design), counts, [fast.BLOCK - 7, fast.BLOCK + 1]), whole)
    early = golden(design, counts[: 5 * design.samples_per_major])
    assert_same(VectorBlock(whole.major[:5], whole.status[:5], whole.components[:5]), early)


@pytest.mark.parametrize(
    "dtype", ["int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64", ">i4"]
)
def test_any_integer_type_and_memory_order(dtype: str, rng: np.random.Generator) -> None:
    design = DESIGNS["smallest"]
    counts = rng.integers(0 if "u" in dtype else -128, 128, (40, 6))
    expected = golden(design, counts)
    assert_same(run_fast(design, counts.astype(dtype)), expected)
    assert_same(run_fast(design, np.asfortranarray(counts.astype(dtype))), expected)
    assert_same(run_fast(design, np.repeat(counts.astype(dtype), 2, axis=0)[::2]), expected)
    assert_same(in_chunks(FastModel(design), counts.astype(dtype), [0, 3, 3, 20]), expected)
    assert_same(run_fast(design, counts.tolist()), expected)


def test_kept_samples_are_copies(rng: np.random.Generator) -> None:
    design = DESIGNS["taylor_2p1"]
    counts = random_counts(design, 30, rng)
    model, buffer = FastModel(design), np.empty((10, 6), np.int64)
    blocks = []
    for start in (0, 10, 20):
        buffer[:] = counts[start : start + 10]
        blocks.append(model.feed(buffer))
    assert_same(VectorBlock.concatenate(blocks), golden(design, counts))


def test_reset_forgets_history_faults_and_the_incomplete_interval(
    rng: np.random.Generator,
) -> None:
    design = DESIGNS["taylor_2p1"]
    model = FastModel(design)
    model.feed(random_counts(design, 19, rng), np.ones(19, bool))
    model.reset()
    assert (model.samples, model.leftover) == (0, 0)
    counts = random_counts(design, 42, rng)
    assert_same(model.feed(counts), golden(design, counts))


def test_faults_mark_their_interval_alone(rng: np.random.Generator) -> None:
    design = DESIGNS["stim300_4x5"]
    counts = random_counts(design, 100, rng)
    faults = np.zeros(100, np.int8)
    faults[[20, 59, 60]] = 1, 1, -7
    expected = [0, 2, 2, 2, 0]
    counts = counts.clip(-1000, 1000)  # away from the rails
    assert run_fast(design, counts, faults).status.tolist() == expected
    assert run_fast(design, counts, faults != 0).status.tolist() == expected
    assert in_chunks(FastModel(design), counts, [30, 59, 70], faults).status.tolist() == expected


@pytest.mark.parametrize("dtype", [np.int16, np.int32, np.int64])
def test_a_count_at_either_end_of_its_own_width_marks_its_interval_alone(dtype: type) -> None:
    design = make_design("rails", 2, 0, 2, (9, 12))  # -256 to 255, -2048 to 2047
    counts = np.zeros((44, 6), dtype)
    counts[[0, 7, 14, 17, 27, 36], [0, 1, 2, 3, 4, 5]] = -256, 255, -255, 255, 2047, -2048
    counts[[21, 31, 40], [3, 4, 2]] = -256, 2046, 254
    expected = [4, 4, 0, 0, 0, 0, 4, 0, 0, 4, 0]
    assert run_fast(design, counts).status.tolist() == expected
    assert in_chunks(FastModel(design), counts, [1, 7, 8, 29, 43]).status.tolist() == expected
    assert golden(design, counts).status.tolist() == expected


def test_no_samples() -> None:
    design = DESIGNS["stim300_4x5"]
    model = FastModel(design)
    block = model.feed(np.zeros((0, 6), np.int32))
    assert (len(block), block.components.shape, model.samples) == (0, (0, 18), 0)


@pytest.mark.parametrize(
    ("column", "name", "lo", "hi"),
    [(0, "gyro_x", -128, 127), (2, "gyro_z", -128, 127), (4, "accel_y", -1024, 1023)],
)
@pytest.mark.parametrize("sample", [0, 5, 21, 52, 63])
@pytest.mark.parametrize("below", [False, True])
def test_count_outside_the_width_is_refused_whole(
    column: int, name: str, lo: int, hi: int, sample: int, below: bool, rng: np.random.Generator
) -> None:
    design = DESIGNS["dense_odd_3"]
    first, counts = random_counts(design, 4, rng), random_counts(design, 64, rng)
    good = counts.copy()
    count = lo - 1 if below else hi + 1
    counts[sample, column] = counts[min(sample + 1, 63), 5] = count
    counts[sample, 5] = 0
    counts[63, 1] = 999
    bits = {127: 8, 1023: 11}[hi]
    if sample == 63 and column > 1:
        column, name, count, lo, hi, bits = 1, "gyro_y", 999, -128, 127, 8
    message = f"sample {4 + sample}: {name} = {count} does not fit {bits} bits, give {lo} to {hi}"
    model = FastModel(design)
    blocks = [model.feed(first)]
    with pytest.raises(InputError) as raised:
        model.feed(counts, np.ones(64, bool))
    assert str(raised.value) == message
    assert model.samples == 4
    blocks.append(model.feed(good))
    assert_same(VectorBlock.concatenate(blocks), golden(design, np.concatenate([first, good])))


def test_count_outside_the_width_is_refused_before_an_interval_is_complete() -> None:
    design = DESIGNS["stim300_4x5"]
    model = FastModel(design)
    model.feed(np.zeros((3, 6), int))
    bad = np.zeros((2, 6), int)
    bad[1, 2] = -(2**23) - 1
    with pytest.raises(InputError, match="sample 4: gyro_z = -8388609 does not fit 24 bits"):
        model.feed(bad)
    assert (model.samples, model.leftover) == (3, 3)
    assert model.feed(np.ones((17, 6), int)).components[0, 0] == 17


def test_the_message_is_the_reference_models(rng: np.random.Generator) -> None:
    design = DESIGNS["wide_5p0"]
    counts = random_counts(design, 40, rng)
    counts[37, 3] = 1 << 31
    messages = []
    for run in (run_fast, golden):
        with pytest.raises(InputError) as raised:
            run(design, counts)
        messages.append(str(raised.value))
    assert messages[0] == messages[1]
    assert "sample 37: accel_x = 2147483648 does not fit 32 bits" in messages[0]


@pytest.mark.parametrize("value", [2**63, 2**64 - 1])
def test_unsigned_counts_do_not_wrap(value: int) -> None:
    design = DESIGNS["smallest"]
    counts = np.zeros((3, 6), np.uint64)
    counts[1, 3] = value
    model = FastModel(design)
    model.feed(np.zeros((2, 6), int))
    with pytest.raises(InputError, match=f"sample 3: accel_x = {value} does not fit 9 bits"):
        model.feed(counts)


@pytest.mark.parametrize(
    "counts",
    [
        np.zeros((4, 6)),
        np.full((4, 6), np.nan),
        np.zeros((4, 6), np.bool_),
        np.zeros((4, 6), object),
        np.zeros((4, 5), int),
        np.zeros(6, int),
        np.zeros((2, 2, 6), int),
        [],
    ],
)
def test_counts_of_another_form_are_refused(counts: Any) -> None:
    with pytest.raises(InputError, match=r"^counts: .* give integers of shape \(N, 6\)$"):
        run_fast(DESIGNS["smallest"], counts)


@pytest.mark.parametrize("faults", [[0], [[0], [1]], [0.0, 1.0], ["0", "1"], [True] * 3])
def test_faults_of_another_form_are_refused(faults: Any) -> None:
    with pytest.raises(InputError, match=r"^faults: .* give 2 integers or booleans"):
        run_fast(DESIGNS["smallest"], np.zeros((2, 6), int), faults)


def test_blocks_computed_side_by_side_stay_in_order() -> None:
    design = DESIGNS["stim300_4x5"]
    counts = random_counts(design, 5 * fast.BLOCK, np.random.default_rng(8))
    model = FastModel(design)
    one_by_one = [model.feed(part) for part in np.array_split(counts, 20)]
    whole = run_fast(design, counts)
    assert (whole.components == VectorBlock.concatenate(one_by_one).components).all()
    for t in (1, 3 * fast.BLOCK, 5 * fast.BLOCK - 1):
        counts[t, 4] = 1 << 23
    with pytest.raises(InputError, match=r"^sample 1: accel_y"):
        run_fast(design, counts)


@settings(max_examples=40, deadline=None)
@given(
    n=st.integers(1, 8),
    minors=st.integers(1, 40),
    bits=st.tuples(st.integers(8, 32), st.integers(8, 32)),
    data=st.data(),
)
def test_high_resolution_position_equals_golden(
    n: int, minors: int, bits: tuple[int, int], data: st.DataObject
) -> None:
    options = {"position": "high-resolution"}
    compact = {"core": "compact"}
    p = data.draw(st.integers(1 if n == 1 else 0, n))
    design = make_design("any", n, p, minors, bits, options=options, hardware=compact)
    span = design.samples_per_major
    rng = np.random.default_rng(data.draw(st.integers(0, 2**32)))
    counts = random_counts(design, min(6 * span + 3, 1000), rng)
    cuts = data.draw(st.lists(st.integers(0, len(counts)), max_size=6))
    model = FastModel(design, block=data.draw(st.integers(1, 400)))
    assert_same(in_chunks(model, counts, cuts), golden(design, counts))


@pytest.mark.parametrize(("minors", "bits"), [(4096, (32, 32)), (1000, (32, 8)), (1, (32, 32))])
@pytest.mark.parametrize("lowest", [False, True], ids=["mixed", "all most negative"])
def test_high_resolution_position_at_the_corners(
    minors: int, bits: tuple[int, int], lowest: bool, rng: np.random.Generator
) -> None:
    options = {"position": "high-resolution"}
    compact = {"core": "compact"}
    design = make_design("corner", 1, 1, minors, bits, options=options, hardware=compact)
    counts = random_counts(design, 2 * design.samples_per_major, rng)
    if lowest:
        counts[:] = [design.words.gyro.lo] * 3 + [design.words.accel.lo] * 3
        counts[:, ::3] = design.words.gyro.hi, design.words.accel.hi
    assert_same(run_fast(design, counts), golden(design, counts))


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("name", HIGH_RESOLUTION)
def test_high_resolution_position_where_scrolling_is_furthest(name: str, sign: int) -> None:
    """Half of the counts then have every digit but the highest at its largest."""
    design = HIGH_RESOLUTION[name]
    counts = np.concatenate([furthest(design, axis, sign) for axis in range(3)])
    assert_same(run_fast(design, counts), golden(design, counts))
