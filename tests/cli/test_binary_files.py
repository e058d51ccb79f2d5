"""Logs, vectors, states and truths as npz and Parquet: the same numbers as CSV, or a refusal."""

from __future__ import annotations

import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from position_designs import HIGH_RESOLUTION
from sculler.formats import compiled
from sculler.formats.comparison import Difference, compare
from sculler.formats.log import COUNTS, LogWriter, read_log
from sculler.formats.tables import Column, columns, writing_table
from sculler.formats.vectors import VectorsWriter, read_vectors, results_in
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.fast import FastModel, VectorBlock
from strategies import DESIGNS, make_design, random_counts

pa = pytest.importorskip("pyarrow")
pq = pytest.importorskip("pyarrow.parquet")

ENDINGS = ("csv", "npz", "parquet")
WIDE = {
    "narrow": DESIGNS["stim300_4x5"],
    "nine vectors, 71 bits": HIGH_RESOLUTION["stim300_hr"],
    "111 bits": DESIGNS["taylor_8p8"],
    "142 bits": make_design("wide_12p12", 12, 12, 64, (32, 32)),
    "394 bits": make_design("wide_16p16", 16, 16, 4096, (32, 32), "filtered-rate", kind="rate"),
}
"""Designs whose widest component is an int64, a decimal128, a decimal256 and limbs."""


@pytest.fixture(params=[False, True], ids=["in Python", "compiled"])
def _both_ways(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Text read and written by numpy and Python, and by compiled loops."""
    if request.param:
        pytest.importorskip("numba")
        monkeypatch.setattr(compiled, "WORTH_READING", 0)
        monkeypatch.setattr(compiled, "WORTH_WRITING", 0)
    else:
        monkeypatch.setattr(compiled, "loaded", lambda: None)


def extremes(design: Design, rows: int = 40) -> VectorBlock:
    """Rows at and beside the ends of each component's range, at nothing, and anywhere between."""
    rng = np.random.default_rng(5)
    made = []
    for row in range(rows):
        values = []
        for name in design.columns[2:]:
            allowed = getattr(design.words, name[:-2])
            choice = int(rng.integers(6))
            share = int(rng.integers(0, 2**62))
            between = allowed.lo + (allowed.hi - allowed.lo) * share // 2**62
            values.append((allowed.lo, allowed.hi, 0, -1, between, between)[choice])
        made.append([row, row % 16, *values])
    made[0][2:] = [getattr(design.words, name[:-2]).lo for name in design.columns[2:]]
    made[1][2:] = [getattr(design.words, name[:-2]).hi for name in design.columns[2:]]
    return VectorBlock.from_rows(made, design)


def stamped(block: VectorBlock) -> VectorBlock:
    times = 1.4e9 + np.arange(len(block)) / 3
    return VectorBlock(block.major, block.status, block.components, times)


def write(path: Path, design: Design, *blocks: VectorBlock, known: bool = True) -> Path:
    with VectorsWriter(path, design.columns, design=design if known else None) as writer:
        for block in blocks:
            writer.write(block)
    return path


def part(block: VectorBlock, rows: slice) -> VectorBlock:
    times = None if block.times is None else block.times[rows]
    return VectorBlock(block.major[rows], block.status[rows], block.components[rows], times)


@pytest.mark.usefixtures("_both_ways")
@pytest.mark.parametrize("ending", ENDINGS)
@pytest.mark.parametrize("name", WIDE)
def test_vectors_come_back_from_every_kind_of_file(tmp_path: Path, name: str, ending: str) -> None:
    design, block = WIDE[name], stamped(extremes(WIDE[name]))
    for known in (True, False):
        path = tmp_path / f"{known}.{ending}"
        write(path, design, part(block, slice(7)), part(block, slice(7, None)), known=known)
        assert results_in(path) == len(block)
        for reader in (design, None):
            back = VectorBlock.concatenate([*read_vectors(path, reader, chunk=11)])
            assert [*back.rows()] == [*block.rows()]
            assert back.times is not None
            assert back.times.tolist() == block.times.tolist()  # type: ignore[union-attr]


@pytest.mark.usefixtures("_both_ways")
@pytest.mark.parametrize("name", WIDE)
def test_the_text_has_the_same_bytes_however_it_is_written(tmp_path: Path, name: str) -> None:
    block = stamped(extremes(WIDE[name]))
    path = write(tmp_path / "v.csv", WIDE[name], block)
    lines = [
        ",".join(map(str, row)) + f",{time!r}"
        for row, time in zip(block.rows(), block.times.tolist(), strict=True)  # type: ignore[union-attr]
    ]
    assert path.read_text().split("\n") == [",".join((*block.columns, "time_s")), *lines, ""]


def test_parquet_has_the_types_that_the_word_lengths_allow(tmp_path: Path) -> None:
    for name, kinds in {
        "narrow": {"int64"},
        "111 bits": {"int64", "decimal128(38, 0)"},
        "142 bits": {"int64", "decimal128(38, 0)", "decimal256(76, 0)"},
        "394 bits": {
            *("decimal128(38, 0)", "decimal256(76, 0)"),
            *("int64", "fixed_size_list<element: int64 not null>[7]"),
        },
    }.items():
        design = WIDE[name]
        schema = pq.read_schema(write(tmp_path / "v.parquet", design, extremes(design)))
        assert schema.names == list(design.columns)
        assert {str(field.type) for field in schema} == kinds
        for column in design.columns[2:]:
            bits = getattr(design.words, column[:-2]).bits
            assert (schema.field(column).type == pa.int64()) == (bits <= 64)


def test_other_programs_read_the_same_integers(tmp_path: Path) -> None:
    design = WIDE["142 bits"]
    block = extremes(design)
    table = pq.read_table(write(tmp_path / "v.parquet", design, block))
    rows = zip(*(table.column(name).to_pylist() for name in design.columns), strict=True)
    assert [tuple(map(int, row)) for row in rows] == [*block.rows()]
    arrays = np.load(write(tmp_path / "v.npz", design, block))
    assert sorted(arrays) == sorted(design.columns)
    for place, name in enumerate(design.columns):
        array = arrays[name]
        assert array.dtype == np.int64
        limbs = array if array.ndim == 2 else array[:, None]
        told = [
            sum((limb % 2**64) << 64 * k for k, limb in enumerate(row[:-1]))
            + (row[-1] << 64 * (len(row) - 1))
            for row in limbs.tolist()
        ]
        assert told == [row[place] for row in block.rows()]


@pytest.mark.parametrize("kinds", [("csv", "parquet"), ("npz", "csv"), ("parquet", "npz")])
@pytest.mark.parametrize("name", ["narrow", "142 bits", "394 bits"])
def test_compare_across_kinds(tmp_path: Path, kinds: tuple[str, str], name: str) -> None:
    design = WIDE[name]
    block = extremes(design)
    one = write(tmp_path / f"a.{kinds[0]}", design, block)
    assert compare(one, write(tmp_path / f"b.{kinds[1]}", design, block)) is None
    rows = [list(row) for row in block.rows()]
    rows[17][4] += 1 if rows[17][4] < 0 else -1
    other = write(tmp_path / f"c.{kinds[1]}", design, VectorBlock.from_rows(rows, design))
    first = [*block.rows()][17][4]
    assert compare(one, other) == Difference(17, 17, design.columns[4], first, rows[17][4])
    short = write(tmp_path / f"d.{kinds[1]}", design, part(block, slice(30)))
    assert compare(one, short) == Difference(30, 30, "major", 30, None)
    assert compare(short, one) == Difference(30, 30, "major", None, 30)
    timed = write(tmp_path / f"e.{kinds[1]}", design, stamped(block))
    assert compare(one, timed) is None
    late = stamped(block)
    late.times[3] += 1  # type: ignore[index]
    again = write(tmp_path / f"f.{kinds[0]}", design, late)
    found = compare(timed, again)
    assert found is not None
    assert (found.row, found.column) == (3, "time_s")
    assert found.second == found.first + 1


@pytest.fixture
def small_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in ("npz", "parquet"):
        monkeypatch.setattr(f"sculler.formats.tables.{module}.BLOCK_ROWS", 100)
    monkeypatch.setattr("sculler.formats.tables.parquet._GROUP_BYTES", 1 << 13)


@pytest.mark.usefixtures("small_blocks")
@pytest.mark.parametrize("ending", ["npz", "parquet"])
def test_logs_come_back_block_by_block(tmp_path: Path, ending: str) -> None:
    design = DESIGNS["stim300_4x5"]
    counts = random_counts(design, 1000, np.random.default_rng(2))
    faults, times = np.arange(1000, dtype=np.uint8) % 2, 1e6 + np.arange(1000) / 7
    path = tmp_path / f"imu.{ending}"
    with LogWriter(path, faults=True, times=True) as writer:
        for first in range(0, 1000, 300):
            rows = slice(first, first + 300)
            writer.write(counts[rows], faults[rows], times[rows])
    told: list[int] = []
    chunks = [*read_log(path, design, told.append)]
    assert [len(chunk.counts) for chunk in chunks] == [100] * 10
    assert sum(told) == pytest.approx(path.stat().st_size, rel=0.02)
    assert np.array_equal(np.concatenate([chunk.counts for chunk in chunks]), counts)
    assert np.array_equal(np.concatenate([chunk.faults for chunk in chunks]), faults)
    assert np.concatenate([chunk.times for chunk in chunks]).tolist() == times.tolist()
    assert {chunk.sequence is None for chunk in chunks} == {True}


def good_log(rows: int = 5) -> dict[str, Any]:
    return {name: np.arange(rows) + place for place, name in enumerate(COUNTS)}


def save(path: Path, columns: dict[str, Any]) -> Path:
    """A file of the kind that its ending says, by other programs' own writers."""
    if path.suffix == ".npz":
        np.savez_compressed(path, **columns)
    else:
        pq.write_table(pa.table(columns), path)
    return path


@pytest.mark.parametrize("ending", ["npz", "parquet"])
def test_logs_of_other_programs(tmp_path: Path, ending: str) -> None:
    narrow = {name: column.astype(np.int16) for name, column in good_log().items()}
    path = save(
        tmp_path / f"imu.{ending}",
        {
            "sequence": np.arange(5, dtype=np.uint32),
            **dict(reversed(narrow.items())),
            "fault": np.array([False, True, False, False, True]),
        },
    )
    (chunk,) = read_log(path, None)
    assert chunk.counts.tolist() == [[row + place for place in range(6)] for row in range(5)]
    assert chunk.faults is not None
    assert chunk.faults.tolist() == [0, 1, 0, 0, 1]
    assert chunk.sequence is not None
    assert chunk.sequence.tolist() == [0, 1, 2, 3, 4]


Whole = np.array
BAD_LOGS: dict[str, tuple[dict[str, Any], str]] = {
    "a column is missing": ({"gyro_y": None}, "column gyro_y is missing, add it"),
    "an unknown column": ({"temp": Whole([1] * 5)}, "unknown column 'temp'"),
    "floats": ({"gyro_x": np.arange(5.0)}, "gyro_x is of type float64, give whole numbers"),
    "flags for counts": ({"gyro_x": np.ones(5, bool)}, "gyro_x is of type bool, give whole"),
    "too wide": (
        {"accel_y": Whole([0, 1, 2**23, 0, 0])},
        "row 3: accel_y = 8388608 does not fit the sensor's 24 bits, give -8388608 to 8388607",
    ),
    "too low": ({"gyro_x": Whole([0, -(2**23) - 1, 0, 0, 0])}, "row 2: gyro_x = -8388609 does"),
    "beyond 64 bits": (
        {"gyro_x": Whole([0, 0, 0, 2**63, 0], np.uint64)},
        "row 4: gyro_x does not fit 64 bits",
    ),
    "no flag": ({"fault": Whole([0, 1, 0, 2, 0])}, "row 4: fault is 2, give 0 or 1"),
    "a stamp is no number": (
        {"time_s": np.array([0, 1, np.nan, 3, 4])},
        "row 3: time_s is nan, give seconds",
    ),
    "stamps of another type": ({"time_s": np.arange(5)}, "time_s is of type int64, give float64"),
    "stamps in nanoseconds": (
        {"time_s": 1.4e18 + np.arange(5.0)},
        "row 1: time_s = 1.4e+18 is more than 1e+12 s, give seconds (not nanoseconds)",
    ),
    "a long counter": (
        {"sequence": Whole([10**18 + 1, 0, 0, 0, 0])},
        "row 1: sequence has more than 18 digits",
    ),
}


@pytest.mark.parametrize("ending", ["npz", "parquet"])
@pytest.mark.parametrize("case", BAD_LOGS)
def test_bad_logs_are_refused(
    tmp_path: Path, refused: Callable[..., str], case: str, ending: str
) -> None:
    changes, message = BAD_LOGS[case]
    columns = {k: v for k, v in (good_log() | changes).items() if v is not None}
    path = save(tmp_path / f"bad.{ending}", columns)
    line = refused("model", "stim300", path, "-o", tmp_path / f"out.{ending}")
    assert line.startswith(f"sculler: {path}: {message}")


@pytest.mark.parametrize("ending", ["npz", "parquet"])
def test_logs_without_samples(tmp_path: Path, refused: Callable[..., str], ending: str) -> None:
    path = save(tmp_path / f"bad.{ending}", good_log(0))
    line = refused("model", "stim300", path, "-o", tmp_path / "out.csv")
    assert line == f"sculler: {path}: the log has no samples, give some"


def test_columns_of_unlike_lengths(tmp_path: Path, refused: Callable[..., str]) -> None:
    path = save(tmp_path / "bad.npz", good_log() | {"accel_x": np.arange(4)})
    line = refused("model", "stim300", path, "-o", tmp_path / "out.csv")
    assert line == f"sculler: {path}: accel_x has 4 rows and gyro_x 5, give as many"


def test_a_cell_without_a_value(tmp_path: Path, refused: Callable[..., str]) -> None:
    path = save(tmp_path / "bad.parquet", good_log() | {"gyro_z": [1, 2, None, 4, 5]})
    line = refused("model", "stim300", path, "-o", tmp_path / "out.csv")
    assert line == f"sculler: {path}: row 3: gyro_z is empty, give a number"


def test_arrays_of_objects_and_of_columns(tmp_path: Path, refused: Callable[..., str]) -> None:
    for array, message in (
        (np.array([{}] * 5), "gyro_x is of type object, give numbers"),
        (np.asfortranarray(np.zeros((5, 2), int)), "gyro_x is stored column by column, give rows"),
        (np.zeros((5, 2, 2), int), "gyro_x is of shape (5, 2, 2), give a column (N,)"),
    ):
        path = tmp_path / "bad.npz"
        np.savez(path, **(good_log() | {"gyro_x": array}))  # type: ignore[arg-type]
        line = refused("model", "stim300", path, "-o", tmp_path / "out.csv")
        assert line.startswith(f"sculler: {path}: {message}")


def damaged(good: Path) -> Iterator[bytes]:
    """A file cut at several places, with bytes changed, and something else."""
    content = good.read_bytes()
    for share in (0.1, 0.5, 0.9, 0.999):
        yield content[: int(share * len(content))]
    for place in range(4, len(content), len(content) // 40):
        yield content[:place] + bytes([content[place] ^ 0x41]) + content[place + 1 :]
    yield b""
    yield b"gyro_x,gyro_y\n1,2\n"


@pytest.mark.parametrize("ending", ["npz", "parquet"])
def test_damaged_files_get_one_line(tmp_path: Path, run: Callable[..., Any], ending: str) -> None:
    """Cut, it is refused; a byte changed, it is refused or still holds numbers that fit."""
    good = save(tmp_path / f"good.{ending}", good_log(400))
    refusals = 0
    for content in damaged(good):
        path = tmp_path / f"bad.{ending}"
        path.write_bytes(content)
        outcome = run("model", "stim300", path, "-o", tmp_path / "out.csv")
        assert outcome.status in (0, 2)
        if outcome.status == 2:
            refusals += 1
            assert outcome.err.startswith(f"sculler: {path}: ")
            assert outcome.err.count("\n") == 1
    assert refusals > 6  # those that were cut at least


def bad_vectors(path: Path, block: VectorBlock, **changes: Any) -> Path:
    columns = dict(zip(block.columns, np.array([*block.rows()]).T, strict=True)) | changes
    return save(path, {name: each for name, each in columns.items() if each is not None})


@pytest.mark.parametrize("ending", ["npz", "parquet"])
@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"nu_x": None}, "column nu_x is missing; is this a vectors file"),
        ({"nu_x": np.zeros(3)}, "nu_x is of type float64, give whole numbers"),
        ({"x": np.zeros(3, int)}, "unknown column 'x', a vectors file has major,status,alpha"),
        ({"major": Whole([0, 2, 3])}, "row 2: major is 2 where 1 should follow"),
        ({"status": Whole([0, 1, 16])}, "row 3: status is 16, must be 0 to 15"),
        ({"status": Whole([0, -1, 0])}, "row 2: status is -1, must be 0 to 15"),
        ({"alpha_x": Whole([0, 0, 128])}, "row 3: alpha_x is 128, more than design smallest can"),
        ({"time_s": np.array([0, np.inf, 1])}, "row 2: time_s is inf, give seconds"),
        ({"s_nu_x": Whole([0, 0, 0])}, "column s_alpha_x is missing; is this"),
    ],
)
def test_bad_vectors_are_refused(
    tmp_path: Path, ending: str, changes: dict[str, Any], message: str
) -> None:
    design = DESIGNS["smallest"]  # 8-bit gyro, a result at every sample: alpha_x is 8 bits
    path = bad_vectors(tmp_path / f"v.{ending}", extremes(design, 3), **changes)
    with pytest.raises(InputError, match=f"^{path}: {message}") as caught:
        [*read_vectors(path, design)]
    assert "\n" not in str(caught.value)


def test_wide_components_beyond_their_design_are_refused(tmp_path: Path) -> None:
    wide = WIDE["142 bits"]
    for name in ("coning_within_x", "nu_z"):
        allowed = getattr(wide.words, name[:-2])
        place = wide.columns.index(name)
        for value in (allowed.hi + 1, allowed.lo - 1, -(2**200)):
            rows = [list(row) for row in extremes(wide, 6).rows()]
            rows[4][place] = value
            block = VectorBlock.from_rows(rows)
            for ending in ENDINGS:
                path = write(tmp_path / f"v.{ending}", wide, block, known=False)
                unit, number = ("line", 6) if ending == "csv" else ("row", 5)
                with pytest.raises(InputError, match=f"{unit} {number}: {name} is .* more than"):
                    [*read_vectors(path, wide)]


def test_columns_of_another_design_are_refused(tmp_path: Path) -> None:
    path = write(tmp_path / "v.npz", DESIGNS["smallest"], extremes(DESIGNS["smallest"]))
    with pytest.raises(
        InputError, match=rf"^{path}: 20 columns, but design stim300_hr .* gives 29"
    ):
        next(read_vectors(path, HIGH_RESOLUTION["stim300_hr"]))


@pytest.mark.parametrize("ending", ["npz", "parquet"])
def test_what_a_column_cannot_hold_is_never_cut(tmp_path: Path, ending: str) -> None:
    for bits, value in ((66, 2**65), (66, -(2**65) - 1), (120, 2**119), (130, 2**129)):
        limbs = [[value & 2**64 - 1, (value >> 64) & 2**64 - 1, (value >> 128) & 2**64 - 1]]
        numbers = np.array(limbs, np.uint64).view(np.int64)
        with (
            pytest.raises(ValueError, match=f"a number of more than {bits} bits"),
            writing_table(tmp_path / f"t.{ending}", [Column("a", bits=bits)]) as table,
        ):
            table.write({"a": numbers})
    fits = np.array([[2**64 - 1, 1, 0]], np.uint64).view(np.int64)
    assert columns.limbs_of(Column("a", bits=66), fits).tolist() == [[-1, 1]]


@pytest.mark.parametrize("ending", ["npz", "parquet"])
def test_an_error_while_writing_leaves_nothing(tmp_path: Path, ending: str) -> None:
    design = DESIGNS["smallest"]

    def blocks() -> Iterator[VectorBlock]:
        yield extremes(design)
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        half_written(tmp_path / f"v.{ending}", design, blocks())
    assert [*tmp_path.iterdir()] == []


def half_written(path: Path, design: Design, blocks: Iterator[VectorBlock]) -> None:
    with VectorsWriter(path, design.columns) as writer:
        for block in blocks:
            writer.write(block)


@pytest.mark.parametrize("ending", ["npz", "parquet"])
def test_the_whole_chain(tmp_path: Path, run: Callable[..., Any], ending: str) -> None:
    """motion, model, compare, navigate and convert: what CSV gives, in every number."""

    def name(stem: str, suffix: str) -> Path:
        return tmp_path / f"{stem}.{suffix}"

    for suffix in ("csv", ending):
        log, truth, out, nav = (name(stem, suffix) for stem in ("imu", "truth", "v", "nav"))
        for words in (
            ("motion", "turn", "--design", "hg4930", "--duration", 5, "-o", log, "--truth", truth),
            ("model", "hg4930", log, "-o", out),
            ("navigate", "hg4930", out, "-o", nav, "--truth", truth, "--no-plots"),
        ):
            outcome = run(*words)
            assert outcome.status == 0, outcome
    assert run("compare", name("v", "csv"), name("v", ending)).out == "identical: 125 rows\n"
    (first,), (second,) = (read_log(name("imu", each), None) for each in ("csv", ending))
    assert np.array_equal(first.counts, second.counts)
    for stem in ("truth", "nav"):
        text = np.genfromtxt(name(stem, "csv"), delimiter=",", names=True)
        path = name(stem, ending)
        table = np.load(path) if ending == "npz" else pq.read_table(path)
        for column in text.dtype.names:
            assert np.asarray(table[column]).tolist() == text[column].tolist()
    counts = ("--gyro-unit", "counts", "--accel-unit", "counts")
    axes = ("--gyro-columns", ",".join(COUNTS[:3]), "--accel-columns", ",".join(COUNTS[3:]))
    again = name("again", ending)
    outcome = run("convert", name("imu", ending), "--design", "hg4930", *counts, *axes, "-o", again)
    assert outcome.status == 0, outcome
    (third,) = read_log(again, None)
    assert np.array_equal(first.counts, third.counts)


@pytest.mark.parametrize("ending", ["npz", "parquet"])
def test_rows_are_counted_from_one(
    tmp_path: Path, refused: Callable[..., str], run: Callable[..., Any], ending: str
) -> None:
    """Breaks and odd counts of a log, breaks of vectors: the row where a CSV has its line."""
    counts = dict(zip(COUNTS, np.random.default_rng(1).integers(-500, 500, (6, 100)), strict=True))
    counts["accel_z"][30] = 2**23 - 1
    sequence = np.arange(100)
    sequence[60:] += 5
    log = save(tmp_path / f"imu.{ending}", counts | {"sequence": sequence})
    line = refused("model", "stim300", log, "-o", tmp_path / "v.csv")
    assert f"{log}: row 61: sequence goes from 59 to 65, 5 samples are missing" in line
    out = tmp_path / f"v.{ending}"
    done = run("model", "stim300", log, "-o", out, "--breaks", "split", "--json")
    assert '"line": 61,' in done.out
    assert "stands at its rail in 1 sample, first at row 31" in done.out
    start = ("--lat", 48, "--lon", 11, "--height", 5, "-o", tmp_path / "nav.csv", "--no-plots")
    line = refused("navigate", "stim300", out, *start)
    assert f"{out}: row 4: major falls back from 2 to 0, the core was reset" in line


@pytest.mark.parametrize("ending", ["npz", "parquet"])
def test_a_pipe_takes_csv_only(tmp_path: Path, refused: Callable[..., str], ending: str) -> None:
    import os

    pipe = tmp_path / f"imu.{ending}"
    os.mkfifo(pipe)
    line = refused("model", "stim300", pipe, "-o", tmp_path / "out.csv")
    assert line.startswith(f"sculler: {pipe}: is a pipe")


def test_without_pyarrow_one_line_says_what_to_install(
    tmp_path: Path, refused: Callable[..., str], monkeypatch: pytest.MonkeyPatch
) -> None:
    log = save(tmp_path / "imu.npz", good_log(400))
    parquet = save(tmp_path / "imu.parquet", good_log(400))
    monkeypatch.setitem(__import__("sys").modules, "pyarrow", None)
    line = refused("model", "stim300", log, "-o", tmp_path / "v.parquet")
    assert "needs pyarrow, run: pip install 'sculler[formats]'" in line
    line = refused("model", "stim300", parquet, "-o", tmp_path / "v.npz")
    assert "needs pyarrow, run: pip install 'sculler[formats]'" in line


def test_npz_is_an_archive_that_numpy_reads_whatever_its_size(tmp_path: Path) -> None:
    """The same bytes for the same numbers, stored without compression."""
    for stem in ("a", "b"):
        with LogWriter(tmp_path / f"{stem}.npz") as writer:
            writer.write(np.arange(60).reshape(10, 6))
    one, other = (tmp_path / f"{stem}.npz" for stem in ("a", "b"))
    assert one.read_bytes() == other.read_bytes()
    with zipfile.ZipFile(one) as archive:
        assert {entry.compress_type for entry in archive.infolist()} == {zipfile.ZIP_STORED}


def test_the_model_gives_the_same_file_through_every_kind(tmp_path: Path) -> None:
    design = WIDE["nine vectors, 71 bits"]
    block = FastModel(design).feed(random_counts(design, 400, np.random.default_rng(1)))
    paths = [write(tmp_path / f"v.{ending}", design, block) for ending in ENDINGS]
    for path in paths:
        again = VectorBlock.concatenate([*read_vectors(path, design)])
        copy = write(tmp_path / "copy.csv", design, again)
        assert copy.read_bytes() == paths[0].read_bytes()
