"""The kernel that Numba compiles gives the golden model's integers, status and refusals."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from against_golden import assert_same, golden, in_chunks
from higher_order_designs import HIGHER_ORDER
from position_designs import HIGH_RESOLUTION, furthest
from sculler_model.design import STATUS_RAIL, Design
from sculler_model.errors import InputError
from sculler_model.fast import FastModel, component_limbs, limbs_of
from sculler_model.fast import model as fast
from strategies import DESIGNS, huge_designs, make_design, random_counts
from tiers import few_of

pytest.importorskip("numba")

WIDER = {
    "three_limbs": make_design("three_limbs", 16, 16, 3, (32, 31)),
    "rates_of_16": make_design(
        "rates_of_16", 16, 16, 2, (32, 32), family="filtered-rate", kind="rate"
    ),
    "a_long_interval": make_design("a_long_interval", 1, 1, 4096, (8, 9)),
}
SECOND = {**DESIGNS, **HIGH_RESOLUTION, **WIDER}
ALL = {**SECOND, **HIGHER_ORDER}
QUICK = [name for name in SECOND if component_limbs(ALL[name]) == 1 and name != "a_long_interval"]
QUICK += ["wide_5p0", "rate_4p1"]


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(20120217)


@pytest.mark.parametrize("name", few_of(list(ALL), QUICK))
def test_equals_golden(name: str, rng: np.random.Generator) -> None:
    """At once and in random chunks, with faults and counts at rails."""
    design = ALL[name]
    span = design.samples_per_major
    counts = random_counts(design, 3 * span + span // 2 + 1, rng)
    faults = rng.random(len(counts)) < 0.5 / span
    expected = golden(design, counts, faults)
    model = FastModel(design, block=50, compiled=True)
    assert_same(model.feed(counts, faults), expected)
    model.reset()
    cuts = rng.integers(0, len(counts), 9).tolist()
    assert_same(in_chunks(model, counts, cuts, faults), expected)


@pytest.mark.parametrize("name", ["stim300_4x5", "wide_5p0", "stim300_hr"])
def test_counts_at_their_rails(name: str, rng: np.random.Generator) -> None:
    """All at the lowest, which makes the longest sums, and each at either end."""
    design = ALL[name]
    ends = [(w.lo, w.hi) for w in (design.words.gyro, design.words.accel) for _ in range(3)]
    lowest = np.tile([low for low, _ in ends], (3 * design.samples_per_major, 1))
    either = np.column_stack([rng.choice(end, len(lowest)) for end in ends])
    for counts in (lowest, either):
        block = FastModel(design, compiled=True).feed(counts)
        assert_same(block, golden(design, counts))
        assert (block.status & STATUS_RAIL).all()


@pytest.mark.parametrize("opposed", [2, 1])
def test_sums_of_digits_at_their_largest(opposed: int) -> None:
    """2^31 - 1 has the largest digit of 30 bits: against -2^31 four products come near 2^63."""
    one: dict[str, Any] = {"denominator": 1, "taps": [[], [1]], "weights": [1, 1]}
    design = make_design("digits", 2, 0, 3, (32, 32), **one)
    assert component_limbs(design) == 2
    lo, hi = -(2**31), 2**31 - 1
    counts = np.full((12, 6), hi)
    counts[1::2, [opposed, 3 + opposed]] = lo
    assert_same(FastModel(design, compiled=True).feed(counts), golden(design, counts))
    counts[1::2] = lo
    counts[1::2, [opposed, 3 + opposed]] = hi
    assert_same(FastModel(design, compiled=True).feed(counts), golden(design, counts))


@pytest.mark.parametrize("name", ["wide_hr", "smallest_hr"])
def test_scrolling_at_its_extremes(name: str) -> None:
    design = HIGH_RESOLUTION[name]
    for axis in range(3):
        for sign in (1, -1):
            counts = furthest(design, axis, sign)
            assert_same(FastModel(design, compiled=True).feed(counts), golden(design, counts))


@pytest.mark.deep
@settings(max_examples=30, deadline=None)
@given(design=huge_designs(), seed=st.integers(0, 2**32))
def test_equals_golden_for_coefficients_of_hundreds_of_bits(design: Design, seed: int) -> None:
    counts = random_counts(design, 40, np.random.default_rng(seed))
    assert_same(FastModel(design, compiled=True).feed(counts), golden(design, counts))


@pytest.mark.parametrize(
    "kind", ["i1", "u1", "<i2", ">i2", "<u2", "<i4", ">i4", "<u4", "<i8", ">i8", "<u8"]
)
def test_any_type_of_integer(kind: str, rng: np.random.Generator) -> None:
    """Also arrays that are not contiguous, or cannot be written to."""
    design = DESIGNS["smallest"]
    low = 0 if "u" in kind else -128
    counts = rng.integers(low, 128, (7 * design.samples_per_major, 6))
    expected = golden(design, counts)
    apart = np.zeros((2 * len(counts), 7), kind)
    apart[::2, :6] = counts
    fixed = counts.astype(kind)
    fixed.flags.writeable = False
    askew = np.zeros(fixed.nbytes + 1, np.uint8)[1:].view(kind).reshape(fixed.shape)
    askew[:] = fixed
    for array in (apart[::2, :6], fixed, np.asfortranarray(fixed), askew):
        assert_same(FastModel(design, compiled=True).feed(array), expected)


@pytest.mark.parametrize("dtype", [np.int32, np.int64, np.uint32, np.uint64])
def test_a_count_beyond_its_width_is_named_and_nothing_is_taken(dtype: Any) -> None:
    design = DESIGNS["smallest"]
    counts = np.zeros((200, 6), dtype)
    most = np.iinfo(dtype).max
    counts[123, 4] = most
    model = FastModel(design, block=20, compiled=True)
    with pytest.raises(InputError, match=rf"sample 123: accel_y = {most} does not fit"):
        model.feed(counts)
    assert model.samples == 0


def test_it_is_taken_once_there_are_enough_samples(monkeypatch: pytest.MonkeyPatch) -> None:
    """And numpy where there are few, or Numba is missing; the results are the same."""
    monkeypatch.setattr(fast, "WORTH_COMPILING", 100)
    design = DESIGNS["smallest"]
    counts = random_counts(design, 100, np.random.default_rng(1))
    model = FastModel(design)
    model.feed(counts[:99])
    assert model._kernel is None
    model.feed(counts[99:])
    assert model._kernel is not None
    for expected, taken in ((99, False), (100, True)):
        model = FastModel(design, expected=expected)
        model.feed(counts[:10])
        model.feed(counts[10:20])
        assert (model._kernel is not None) == taken
    whole = FastModel(design, compiled=True).feed(counts)
    by_numpy = FastModel(design, compiled=False).feed(counts)
    assert np.array_equal(limbs_of(whole.components), limbs_of(by_numpy.components))
    monkeypatch.setattr(fast, "kernel_class", lambda: None)
    assert_same(FastModel(design).feed(counts), whole)
    with pytest.raises(InputError, match=r"needs Numba: install sculler\[fast\]"):
        FastModel(design, compiled=True)


def test_one_thread_or_many(rng: np.random.Generator) -> None:
    design = Design.preset("stim300")
    counts = random_counts(design, 4000, rng)
    blocks = [
        FastModel(design, block=100, threads=threads, compiled=compiled).feed(counts)
        for threads in (1, 2)
        for compiled in (False, True)
    ]
    for block in blocks[1:]:
        assert_same(block, blocks[0])
