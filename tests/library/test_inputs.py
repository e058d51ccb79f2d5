"""Inputs of any form become exact counts or are refused; outputs keep every integer."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sculler
from sculler.formats.log import COUNTS

DESIGN = sculler.Design.preset("stim300")
ROWS = [[k, -k, 3 * k, 8_388_607, -8_388_608, 0] for k in range(45)]
SMALL = [[k, 1, 2, 3, 4, 100 - k] for k in range(45)]


def _expected(rows: list[list[int]]) -> list[tuple[int, ...]]:
    model = sculler.GoldenModel(DESIGN)
    samples = (((a, b, c), (d, e, f), 0) for a, b, c, d, e, f in rows)
    return [result.row() for result in model.run(samples)]


@pytest.mark.parametrize(
    "dtype",
    [
        np.int8,
        np.uint8,
        np.int16,
        np.uint16,
        np.int32,
        np.uint32,
        np.int64,
        np.uint64,
        object,
        np.float32,
        np.float64,
        ">i4",
    ],
)
def test_any_dtype_gives_the_integers_of_the_golden_model(dtype: Any) -> None:
    block = sculler.FastModel(DESIGN).feed(np.array(SMALL).astype(dtype))
    assert list(block.rows()) == _expected(SMALL)


def test_lists_of_python_integers_do_too() -> None:
    assert list(sculler.FastModel(DESIGN).feed(ROWS).rows()) == _expected(ROWS)


@pytest.mark.parametrize(
    "value", [2**23, -(2**23) - 1, 2**24, 2**32, 2**63, 2**64, 2**64 - 1, 10**30, -(2**63) - 1]
)
@pytest.mark.parametrize("column", [0, 5])
def test_what_does_not_fit_is_refused_and_never_wrapped(value: int, column: int) -> None:
    rows: list[list[int]] = [[0] * 6 for _ in range(3)]
    rows[2][column] = value
    forms: list[Any] = [rows, np.array(rows, object)]
    if 0 <= value < 2**64:
        forms.append(np.array(rows, np.uint64))
    if -(2**63) <= value < 2**63:
        forms.append(np.array(rows, np.int64))
    for form in forms:
        model = sculler.FastModel(DESIGN)
        with pytest.raises(sculler.InputError, match=str(value)):
            model.feed(form)
        assert model.samples == 0


@pytest.mark.parametrize("value", [0.5, np.nan, np.inf, 2.0**53, -1e300])
@pytest.mark.parametrize("dtype", [float, object])
def test_floats_that_are_not_whole_are_refused(value: float, dtype: type) -> None:
    counts = np.zeros((4, 6), dtype)
    counts[1, 3] = value
    with pytest.raises(sculler.InputError, match=r"^counts: .* at \(1, 3\) is not a whole number"):
        sculler.FastModel(DESIGN).feed(counts)


@pytest.mark.parametrize(
    "counts",
    [
        np.zeros((4, 6), bool),
        np.zeros((4, 5), int),
        np.zeros((2, 2, 6), int),
        np.zeros((4, 6), complex),
        np.full((4, 6), "1"),
        np.full((4, 6), None),
        np.full((4, 6), True, object),
        [[1, 2, 3, 4, 5, 6], [1]],
        "no array",
        7,
    ],
)
def test_other_forms_are_refused(counts: Any) -> None:
    with pytest.raises(sculler.InputError, match=r"^counts: .*give"):
        sculler.FastModel(DESIGN).feed(counts)


def test_faults_and_stamps_are_checked() -> None:
    zeros = np.zeros((3, 6), int)
    for given in (
        {"faults": [0, 2, 0]},
        {"faults": [0, 1]},
        {"times": [0, np.nan, 1]},
        {"times": ["a", "b", "c"]},
        {"sequence": [1, 2]},
        {"sequence": [1, 2, 2.5]},
    ):
        with pytest.raises(sculler.InputError, match=f"^{next(iter(given))}: "):
            sculler.Log.of(zeros, **given)  # type: ignore[arg-type]


def _frame(library: str, columns: dict[str, Any]) -> Any:
    return pytest.importorskip(library).DataFrame(columns)


@pytest.mark.parametrize("library", ["pandas", "polars"])
def test_frames_are_taken_with_all_their_columns(library: str) -> None:
    columns = {name: [row[k] for row in ROWS] for k, name in enumerate(COUNTS)}
    columns = {"fault": [k == 21 for k in range(45)], **dict(reversed(columns.items()))}
    frame = _frame(library, columns | {"time_s": [0.0005 * (k + 1) for k in range(45)]})
    block = sculler.FastModel(DESIGN).feed(frame)
    rows = _expected(ROWS)
    assert [row[2:] for row in block.rows()] == [row[2:] for row in rows]
    # rails, and the fault in the second interval
    assert block.status.tolist() == [rows[0][1], rows[1][1] | 2]
    assert block.times is not None
    assert block.times.tolist() == pytest.approx([0.01, 0.02])


@pytest.mark.parametrize("library", ["pandas", "polars"])
def test_frames_with_holes_are_refused(library: str) -> None:
    columns: dict[str, Any] = {name: [1, 2] for name in COUNTS}
    with pytest.raises(sculler.InputError, match="column accel_y is missing"):
        sculler.Log.of(_frame(library, {k: v for k, v in columns.items() if k != "accel_y"}))
    with pytest.raises(sculler.InputError, match="a value of column gyro_z is missing"):
        sculler.Log.of(_frame(library, columns | {"gyro_z": [1, None]}))
    with pytest.raises(sculler.InputError, match=r"gyro_z: 1\.5 at 1 is not a whole number"):
        sculler.Log.of(_frame(library, columns | {"gyro_z": [1.0, 1.5]}))


def _wide() -> sculler.Design:
    """A design whose components pass 64 bits."""
    return sculler.Design.parse(
        {
            "name": "wide",
            "sensor": {
                "kind": "increment",
                "sample_rate_hz": 1000.0,
                "gyro": {"bits": 32, "lsb": 1e-9},
                "accel": {"bits": 32, "lsb": 1e-7},
            },
            "algorithm": {"family": "frequency-taylor", "samples": 5, "history": 0, "minors": 64},
        }
    )


@pytest.mark.parametrize("design", [DESIGN, _wide()], ids=["narrow", "wide"])
def test_outputs_keep_every_integer(design: sculler.Design) -> None:
    pytest.importorskip("pandas")
    span = design.samples_per_major
    lo, hi = design.words.gyro.lo, design.words.gyro.hi
    counts = np.random.default_rng(5).choice([lo, hi, 3], (2 * span, 6))
    block = sculler.FastModel(design).feed(counts)
    model = sculler.GoldenModel(design)
    rows = [
        result.row()
        for row in counts.tolist()
        if (result := model.step(tuple(row[:3]), tuple(row[3:])))
    ]
    assert [tuple(row) for row in block.to_numpy().tolist()] == rows
    frame = block.to_pandas()
    assert list(frame.columns) == list(design.columns)
    assert [tuple(map(int, row)) for row in frame.itertuples(index=False)] == rows
    widest = max(abs(value) for row in rows for value in row)
    if design is DESIGN:
        assert block.to_numpy().dtype == np.int64
    else:
        assert widest >= 2**63
        assert block.to_numpy().dtype == object


def test_a_log_goes_to_pandas_and_to_a_file_and_back(tmp_path: Path) -> None:
    pytest.importorskip("pandas")
    log = sculler.Log.of(ROWS, faults=[k % 2 for k in range(45)], times=np.arange(45) / 7)
    sculler.write_log(tmp_path / "log.csv", log)
    for other in (sculler.read_log(tmp_path / "log.csv"), sculler.Log.of(log.to_pandas())):
        for name, column in log.named_columns().items():
            assert np.array_equal(column, other.named_columns()[name]), name
    assert log.to_numpy().tolist() == ROWS


def test_without_pandas_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "pandas", None)
    with pytest.raises(sculler.InputError, match=r"install sculler\[frames\]"):
        sculler.Log.of(ROWS).to_pandas()
