"""Any integer type goes in, at its extremes, and nothing ever wraps in silence."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from host_path import fine_design
from sculler_model.algorithms import high_resolution
from sculler_model.analysis.third_order import third_order_vectors
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.fast import run_fast
from sculler_model.golden import CycleModel, GoldenModel, Timing
from sculler_model.host import major_increments
from sculler_model.samples import Quantiser, Resampler

DTYPES = [np.dtype(f"{sign}{size}") for sign in "iu" for size in (1, 2, 4, 8)]
WIDTH = 32  # of the counts
DESIGNS = {
    "plain": fine_design(4, 0, 5),
    "history": fine_design(2, 2, 3),
    "rates": fine_design(4, 0, 2, kind="rate"),
    "high-resolution": fine_design(3, 0, 4, position="high-resolution"),
}


def samples(dtype: np.dtype[Any], count: int = 100) -> Any:
    """Counts of a type, its extremes (as far as a count goes) above all, in no pattern."""
    info = np.iinfo(dtype)
    least, most = max(info.min, -(2 ** (WIDTH - 1))), min(info.max, 2 ** (WIDTH - 1) - 1)
    rng = np.random.default_rng(dtype.itemsize)
    return rng.choice(
        np.array([least, most, most // 3, 1], dtype), (count, 6), p=[0.4, 0.4, 0.1, 0.1]
    )


@pytest.fixture(params=DTYPES, ids=str)
def dtype(request: pytest.FixtureRequest) -> np.dtype[Any]:
    found: np.dtype[Any] = request.param
    return found


@pytest.fixture(params=DESIGNS)
def design(request: pytest.FixtureRequest) -> Design:
    return DESIGNS[request.param]


def rows(design: Design, counts: list[list[int]]) -> list[tuple[int, ...]]:
    """What the reference model makes of integers of Python."""
    found = GoldenModel(design).run(((a, b, c), (d, e, f), 0) for a, b, c, d, e, f in counts)
    return [result.row() for result in found]


def test_golden_model(dtype: np.dtype[Any], design: Design) -> None:
    counts = samples(dtype)
    model = GoldenModel(design)
    found = [model.step(tuple(row[:3]), tuple(row[3:])) for row in counts]  # numpy's scalars
    arrays = GoldenModel(design)
    same = [arrays.step(row[:3], row[3:]) for row in counts]
    expected = rows(design, counts.tolist())
    assert [result.row() for result in found if result is not None] == expected
    assert [result.row() for result in same if result is not None] == expected
    assert all(type(value) is int for row in expected for value in row)


def test_fast_model(dtype: np.dtype[Any], design: Design) -> None:
    counts = samples(dtype)
    expected = rows(design, counts.tolist())
    assert list(run_fast(design, counts).rows()) == expected
    assert list(run_fast(design, np.asfortranarray(counts)[::1]).rows()) == expected
    swapped = counts.astype(dtype.newbyteorder())
    assert list(run_fast(design, swapped).rows()) == expected


@pytest.mark.parametrize("wide", [np.int64, np.uint64])
@pytest.mark.parametrize(
    "value", [2**31, 2**32, 2**63 - 1, 2**63, 2**64 - 1, -(2**31) - 1, -(2**63)]
)
def test_what_does_not_fit_is_refused_not_wrapped(wide: type, value: int) -> None:
    if not np.iinfo(wide).min <= value <= np.iinfo(wide).max:
        pytest.skip("not a number of this type")
    design = DESIGNS["plain"]
    counts = np.zeros((40, 6), wide)
    counts[7, 4] = value
    for feed in (
        lambda: run_fast(design, counts),
        lambda: [GoldenModel(design).step(row[:3], row[3:]) for row in counts[7:8]],
    ):
        with pytest.raises(InputError, match=f"accel_y = {value} does not fit 32 bits"):
            feed()


@pytest.mark.parametrize("bad", [1.0, 0.5, np.float32(1), np.float64(2), "1", None, 1j])
def test_what_is_no_whole_number_is_refused(bad: object) -> None:
    design = DESIGNS["plain"]
    for gyro, accel, name in (((0, bad, 0), (0, 0, 0), "gyro"), ((0, 0, 0), (bad, 0, 0), "accel")):
        with pytest.raises(InputError, match=f"sample 0: {name}: .*give three whole numbers"):
            GoldenModel(design).step(gyro, accel)  # type: ignore[arg-type]
        with pytest.raises(InputError, match="give three whole numbers"):
            list(high_resolution([(gyro, accel)], 1))  # type: ignore[list-item]
    with pytest.raises(InputError, match="give three whole numbers"):
        GoldenModel(design).step((0, 0), (0, 0, 0))  # type: ignore[arg-type]
    if not isinstance(bad, str | None):
        with pytest.raises(InputError, match="give integers of shape"):
            run_fast(design, np.full((40, 6), bad))


def test_cycle_model(dtype: np.dtype[Any]) -> None:
    design = DESIGNS["plain"]
    counts = samples(dtype, 40)
    shown = []
    for source in (counts, counts.tolist()):
        model = CycleModel(design, Timing(latency=3))
        clocks = [model.clock((tuple(row[:3]), tuple(row[3:]), 0), 1) for row in source]
        shown.append([*clocks, *(model.clock(None, 1) for _ in range(5))])
    assert shown[0] == shown[1]
    assert sum(ports.result_valid for ports in shown[0]) == 2


def test_scrolling(dtype: np.dtype[Any]) -> None:
    counts = samples(dtype, 12)
    pairs = [(tuple(row[:3]), tuple(row[3:])) for row in counts]
    plain = [(tuple(row[:3]), tuple(row[3:])) for row in counts.tolist()]
    assert list(high_resolution(pairs, 4)) == list(high_resolution(plain, 4))  # type: ignore[arg-type]


def test_third_order(dtype: np.dtype[Any]) -> None:
    counts = samples(dtype)
    found, expected = (
        third_order_vectors(DESIGNS["plain"], each) for each in (counts, counts.astype(np.int64))
    )
    assert found.within.tolist() == expected.within.tolist()
    assert found.between.tolist() == expected.between.tolist()


def test_host(dtype: np.dtype[Any], design: Design) -> None:
    """Components of a narrow type, as a program of one's own may hold them."""
    block = run_fast(design, np.ones((60, 6), np.int64))
    info = np.iinfo(dtype)
    values = np.random.default_rng(1).choice(
        np.array([info.min, info.max, info.max // 3], dtype), block.components.shape
    )
    narrow = type(block)(block.major, block.status.astype(np.uint8), values)
    wide = type(block)(block.major, block.status, values.astype(object))
    found, expected = (major_increments(design, each) for each in (narrow, wide))
    assert np.array_equal(found.phi, expected.phi)
    assert np.array_equal(found.dv_sf, expected.dv_sf)
    assert found.leading_short == expected.leading_short


def test_quantiser(dtype: np.dtype[Any]) -> None:
    """Whole numbers of an SI unit."""
    design = fine_design(2, gyro_lsb=2.0**-3, accel_lsb=2.0**-2)
    most = min(np.iinfo(dtype).max, 2**27)
    values = np.full((5, 6), most, dtype)
    assert Quantiser(design)(values).tolist() == [[most * 8] * 3 + [most * 4] * 3] * 5


@pytest.mark.parametrize("given", ["increment", "rate"])
@pytest.mark.parametrize("wanted", ["increment", "rate"])
def test_resampler(dtype: np.dtype[Any], given: Any, wanted: Any) -> None:
    most = min(np.iinfo(dtype).max, 2**50)
    values = np.full((9, 2), most, dtype)
    times = np.arange(1, 10).astype(dtype)
    marks = np.zeros(9, dtype)
    results = []
    for t, v in ((times, values), (times.astype(float), values.astype(float))):
        resampler = Resampler(1.0, given, wanted)
        results.append([resampler(t, v, marks), resampler.finish()])
    for found, expected in zip(*results, strict=True):
        assert np.array_equal(found.values, expected.values)
        assert np.array_equal(found.times, expected.times)
        assert found.values == pytest.approx(float(most))


def test_resampler_of_single_precision_does_not_sum_in_it() -> None:
    values = np.full((100_000, 1), 0.1, np.float32)
    resampler = Resampler(1.0, "increment", "increment")
    parts = [resampler(np.arange(1.0, 100_001), values), resampler.finish()]
    total = sum(float(part.values.sum()) for part in parts)
    assert total == pytest.approx(100_000 * float(np.float32(0.1)), rel=1e-12)
