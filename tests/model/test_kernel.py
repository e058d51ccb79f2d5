"""The compiled kernel equals the reference model, number by number, and the twin in numpy."""

from __future__ import annotations

import importlib
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from position_designs import HIGH_RESOLUTION, furthest
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.fast import FastModel, VectorBlock, component_limbs, limbs_of, run_fast
from sculler_model.fast import model as module
from sculler_model.golden import GoldenModel
from strategies import DESIGNS, Counts, designs, make_design, random_counts

needs_numba = pytest.mark.skipif(
    module.kernel_class() is None, reason="Numba (extra `fast`) is missing"
)


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(19980115)


def golden(design: Design, counts: Counts, faults: Any = None) -> VectorBlock:
    marks = [0] * len(counts) if faults is None else [int(bool(f)) for f in faults]
    samples = (
        ((a, b, c), (d, e, f), mark)
        for (a, b, c, d, e, f), mark in zip(counts.tolist(), marks, strict=True)
    )
    return VectorBlock.from_results(GoldenModel(design).run(samples), design)


def assert_same(ours: VectorBlock, theirs: VectorBlock) -> None:
    assert len(ours) == len(theirs)
    assert ours.first_difference(theirs) is None
    assert np.array_equal(limbs_of(ours.components), limbs_of(theirs.components))


def compiled(design: Design, counts: Any, faults: Any = None, block: int = 70) -> VectorBlock:
    return FastModel(design, block=block, compiled=True).feed(counts, faults)


@needs_numba
@pytest.mark.parametrize("name", [*DESIGNS, *HIGH_RESOLUTION])
def test_equals_golden_for_named_designs(name: str, rng: np.random.Generator) -> None:
    design = (DESIGNS | HIGH_RESOLUTION)[name]
    span = design.samples_per_major
    counts = random_counts(design, 7 * span + span // 2 + 1, rng).astype(np.int32)
    faults = rng.random(len(counts)) < 0.5 / span
    expected = golden(design, counts, faults)
    model = FastModel(design, block=50, compiled=True)
    assert_same(model.feed(counts, faults), expected)
    model.reset()
    cuts = [0, *sorted(rng.integers(0, len(counts), 9).tolist()), len(counts)]
    parts = [model.feed(counts[a:b], faults[a:b]) for a, b in pairwise(cuts)]
    assert_same(VectorBlock.concatenate(parts), expected)


WIDE = {
    # 3 limbs of results, 3 of weighted sums
    "sixteen": make_design("sixteen", 16, 16, 3, (32, 31)),
    # 7 limbs, 6 of weighted sums, 2 of rates with Newton-Cotes weights
    "rates": make_design("rates", 16, 16, 40, (32, 32), family="filtered-rate", kind="rate"),
}


@needs_numba
@pytest.mark.parametrize("name", ["sixteen", pytest.param("rates", marks=pytest.mark.deep)])
def test_equals_golden_where_results_are_widest(name: str, rng: np.random.Generator) -> None:
    design = WIDE[name]
    assert component_limbs(design) == {"sixteen": 3, "rates": 7}[name]
    counts = random_counts(design, 3 * design.samples_per_major, rng).astype(np.int32)
    assert_same(compiled(design, counts), golden(design, counts))


@needs_numba
@settings(max_examples=60, deadline=None)
@given(design=designs(), data=st.data())
def test_equals_golden_for_any_design_of_up_to_two_limbs(
    design: Design, data: st.DataObject
) -> None:
    words = design.words
    if component_limbs(design) > 2 or max(words.gyro_taps.bits, words.accel_taps.bits) > 60:
        return  # another one to compile
    span = design.samples_per_major
    rng = np.random.default_rng(data.draw(st.integers(0, 2**32)))
    majors = data.draw(st.integers(1, max(2, 200 // span)))
    counts = random_counts(design, min(majors * span + 3, 2000), rng).astype(np.int32)
    block = data.draw(st.integers(1, 400))
    assert_same(compiled(design, counts, block=block), golden(design, counts))


@pytest.mark.deep
@needs_numba
@settings(max_examples=30, deadline=None)
@given(
    taps=st.lists(st.integers(-(10**80), 10**80), min_size=1, max_size=6).filter(any),
    weights=st.lists(st.integers(-(10**60), 10**60), min_size=1, max_size=4).filter(any),
    bits=st.tuples(st.integers(8, 32), st.integers(8, 32)),
    seed=st.integers(0, 2**32),
)
def test_equals_golden_for_coefficients_of_hundreds_of_bits(
    taps: list[int], weights: list[int], bits: tuple[int, int], seed: int
) -> None:
    design = make_design("huge", 3, 1, 4, bits, denominator=1, taps=taps, weights=weights)
    counts = random_counts(design, 40, np.random.default_rng(seed)).astype(np.int32)
    assert_same(compiled(design, counts), golden(design, counts))


@needs_numba
@pytest.mark.parametrize(
    ("n", "p", "minors", "bits", "majors"),
    [(1, 1, 4096, (8, 9), 2), (2, 1, 4096, (32, 30), 1), (8, 8, 1, (8, 32), 9)],
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
    counts = random_counts(design, majors * design.samples_per_major, rng).astype(np.int32)
    if lowest:
        # every product at its end with a constant sign: x and y samples against z
        words = design.words
        counts[:] = [words.gyro.lo] * 3 + [words.accel.lo] * 3
        counts[n - 1 :: n, 0::3] = words.gyro.hi, words.accel.hi
    found = compiled(design, counts)
    assert_same(found, golden(design, counts))
    assert not lowest or (found.status & 4).all()


@needs_numba
@pytest.mark.parametrize("sign", [0, 1])
def test_sums_of_digits_at_their_largest(sign: int) -> None:
    # 2^31 - 1 has the largest digit of 30 bits, and against the most negative count four products
    # of one sign come within 2^33 of 2^63
    one: dict[str, Any] = {"denominator": 1, "taps": [[], [1]], "weights": [1, 1]}
    design = make_design("digits", 2, 0, 3, (32, 32), **one)
    assert component_limbs(design) == 2
    lo, hi = -(2**31), 2**31 - 1
    counts = np.full((12, 6), hi, np.int32)
    counts[1::2, [2 - sign, 5 - sign]] = lo
    assert_same(compiled(design, counts), golden(design, counts))
    counts[1::2] = lo
    counts[1::2, [2 - sign, 5 - sign]] = hi
    assert_same(compiled(design, counts), golden(design, counts))


@needs_numba
@pytest.mark.parametrize("name", ["wide_hr", "smallest_hr", "dense_hr"])
def test_scrolling_at_its_extremes(name: str) -> None:
    design = HIGH_RESOLUTION[name]
    for axis in range(3):
        for sign in (1, -1):
            counts = furthest(design, axis, sign).astype(np.int32)
            assert_same(compiled(design, counts), golden(design, counts))


@needs_numba
@pytest.mark.parametrize(
    "dtype", ["i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8", ">i4", ">u8", ">i8"]
)
def test_any_integer_type_and_memory_order(dtype: str, rng: np.random.Generator) -> None:
    design = DESIGNS["smallest"]
    counts = rng.integers(0 if "u" in dtype else -128, 128, (140, 6))
    expected = golden(design, counts)
    given = counts.astype(dtype)
    frozen = given.copy()
    frozen.flags.writeable = False
    unaligned = np.zeros(given.nbytes + 1, np.uint8)[1:].view(dtype).reshape(given.shape)
    unaligned[:] = given
    for each in (given, frozen, unaligned, np.asfortranarray(given), np.repeat(given, 2, 0)[::2]):
        assert_same(compiled(design, each), expected)
    assert_same(compiled(design, counts.tolist()), expected)
    model = FastModel(design, compiled=True)
    parts = [model.feed(given[a:b]) for a, b in pairwise([0, 0, 3, 90, 140])]
    assert_same(VectorBlock.concatenate(parts), expected)


@needs_numba
@pytest.mark.parametrize("dtype", [np.int32, np.int64])
def test_a_count_at_either_end_of_its_own_width_marks_its_interval_alone(dtype: type) -> None:
    design = make_design("rails", 2, 0, 2, (9, 12))  # -256 to 255, -2048 to 2047
    counts = np.zeros((44, 6), dtype)
    counts[[0, 7, 14, 17, 27, 36], [0, 1, 2, 3, 4, 5]] = -256, 255, -255, 255, 2047, -2048
    counts[[21, 31, 40], [3, 4, 2]] = -256, 2046, 254
    assert compiled(design, counts).status.tolist() == [4, 4, 0, 0, 0, 0, 4, 0, 0, 4, 0]


@needs_numba
@pytest.mark.parametrize(
    ("dtype", "count"),
    [
        (np.int32, -1025),
        (np.int32, 2**31 - 1),
        (np.int32, -(2**31)),
        (np.int64, 2**63 - 1),
        (np.int64, -(2**63)),
        (np.int64, 2**32),
        (np.uint64, 2**64 - 1),
        (np.uint64, 2**63),
    ],
)
@pytest.mark.parametrize("sample", [0, 5, 52, 63])
def test_count_outside_the_width_is_refused_whole(
    dtype: type, count: int, sample: int, rng: np.random.Generator
) -> None:
    design = DESIGNS["dense_odd_3"]  # 8 and 11 bits
    first, good = (np.abs(random_counts(design, size, rng)).clip(0, 127) for size in (4, 64))
    counts = good.astype(dtype)
    counts[sample, 4] = count
    counts[63, 5] = 1024  # a later one, in the interval that is not complete
    message = f"sample {4 + sample}: accel_y = {count} does not fit 11 bits, give -1024 to 1023"
    model = FastModel(design, block=10, compiled=True)
    blocks = [model.feed(first)]
    with pytest.raises(InputError) as raised:
        model.feed(counts)
    assert str(raised.value) == message
    assert model.samples == 4
    blocks.append(model.feed(good))
    assert_same(VectorBlock.concatenate(blocks), golden(design, np.concatenate([first, good])))


@needs_numba
def test_many_blocks_side_by_side_stay_in_order(rng: np.random.Generator) -> None:
    design = DESIGNS["stim300_4x5"]
    counts = random_counts(design, 50_000, rng).astype(np.int32)
    expected = FastModel(design, compiled=False).feed(counts)
    assert_same(FastModel(design, block=999, compiled=True).feed(counts), expected)
    for t in (1, 30_000, 49_999):
        counts[t, 4] = 1 << 23
    with pytest.raises(InputError, match=r"^sample 1: accel_y"):
        FastModel(design, block=999, compiled=True).feed(counts)


@needs_numba
def test_a_long_run_goes_on_compiled(
    rng: np.random.Generator, monkeypatch: pytest.MonkeyPatch
) -> None:
    design = DESIGNS["stim300_4x5"]
    counts = random_counts(design, 3000, rng).astype(np.int32)
    monkeypatch.setattr(module, "WORTH_COMPILING", 1000)
    made: list[Design] = []
    kernel = module.kernel_class()
    assert kernel is not None
    monkeypatch.setattr(module, "kernel_class", lambda: lambda d: made.append(d) or kernel(d))
    model = FastModel(design)
    parts = []
    for start in range(0, 3000, 300):
        parts.append(model.feed(counts[start : start + 300]))
        assert made == ([] if start < 900 else [design])
    assert_same(VectorBlock.concatenate(parts), golden(design, counts))
    never = FastModel(design, compiled=False)
    never.feed(counts)
    assert len(made) == 1


def test_without_numba_numpy_does_it(
    rng: np.random.Generator, monkeypatch: pytest.MonkeyPatch
) -> None:
    design = DESIGNS["wide_5p0"]
    counts = random_counts(design, 500, rng)
    monkeypatch.setattr(module, "WORTH_COMPILING", 0)
    monkeypatch.setattr(module, "kernel_class", lambda: None)
    assert_same(run_fast(design, counts), golden(design, counts))
    with pytest.raises(InputError, match=r"^the compiled model needs Numba: install sculler\[fast"):
        FastModel(design, compiled=True)


@needs_numba
def test_code_of_other_sources_has_another_name() -> None:
    # what Numba kept of another version must not be found: it looks at its own file only
    kernel = importlib.import_module("sculler_model.fast.kernel")
    lanes = importlib.import_module("sculler_model.fast.lanes")
    digest = kernel.digest_of(lanes)
    assert digest in kernel._vectors.py_func.__qualname__
    assert digest in kernel._position.py_func.__qualname__
    assert digest != kernel.digest_of(module)
