"""IMU logs: what is read, what is refused and in which words."""

from __future__ import annotations

import io
import re
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from sculler.formats import log_text
from sculler.formats.compiled import scanning
from sculler.formats.compiled.decimals import lower_powers
from sculler.formats.lines import BLOCK_BYTES, whole_lines
from sculler.formats.log import Chunk, LogWriter, read_log
from sculler.formats.log_text import _Layout, _nanoseconds, decimals, is_far
from sculler.formats.plain_rows import parse
from sculler_model.design import Design
from sculler_model.errors import InputError

HEADER = "gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z"
ROW = "1,-2,3,-4,5,-6"


@pytest.fixture
def small(design: Path) -> Design:
    return Design.load(design)


def read(path: Path, design: Design) -> tuple[np.ndarray, np.ndarray | None]:
    chunks = list(read_log(path, design))
    faults = [chunk.faults for chunk in chunks if chunk.faults is not None]
    counts = np.concatenate([chunk.counts for chunk in chunks])
    return counts, np.concatenate(faults) if faults else None


def text(tmp_path: Path, content: str | bytes) -> Path:
    path = tmp_path / "log.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def test_counts_come_back_as_written(tmp_path: Path, small: Design, counts: np.ndarray) -> None:
    flags = np.arange(len(counts), dtype=np.uint8) % 2
    path = tmp_path / "log.csv"
    with LogWriter(path, faults=True) as writer:
        writer.write(counts[:10], flags[:10])
        writer.write(counts[10:], flags[10:])
    got, faults = read(path, small)
    assert got.dtype == np.int64
    assert got.tolist() == counts.tolist()
    assert faults is not None
    assert faults.tolist() == flags.tolist()
    assert path.read_text().splitlines()[0] == HEADER + ",fault"


def test_32_bit_extremes_are_exact(tmp_path: Path) -> None:
    design = Design.preset("hg4930")
    rows = [[-(2**31)] * 6, [2**31 - 1] * 6, [0, -1, 9, -10, 2147483646, -2147483647]]
    path = text(tmp_path, "\n".join([HEADER, *(",".join(map(str, r)) for r in rows)]) + "\n")
    assert read(path, design)[0].tolist() == rows


def test_columns_in_any_order(tmp_path: Path, small: Design) -> None:
    path = text(tmp_path, "accel_z,fault,gyro_y,gyro_x,gyro_z,accel_y,accel_x\n6,1,2,1,3,5,4\n")
    got, faults = read(path, small)
    assert got.tolist() == [[1, 2, 3, 4, 5, 6]]
    assert faults is not None
    assert faults.tolist() == [1]


@pytest.mark.parametrize(
    "content",
    [
        f"\ufeff{HEADER}\n{ROW}\n",
        f"{HEADER}\r\n{ROW}\r\n",
        f"{HEADER}\n1, -2,+3 ,-4,5,-06\n",
    ],
    ids=["byte order mark", "windows line ends", "spaces, plus, zeros"],
)
def test_harmless_spellings_are_read(tmp_path: Path, small: Design, content: str) -> None:
    assert read(text(tmp_path, content), small)[0].tolist() == [[1, -2, 3, -4, 5, -6]]


def test_long_log_streams_in_blocks(tmp_path: Path, small: Design) -> None:
    rng = np.random.default_rng(2)
    counts = rng.integers(-2048, 2048, (40_000, 6))
    path = tmp_path / "log.csv"
    with LogWriter(path) as writer:
        writer.write(counts)
    told: list[int] = []
    chunks = [c for c, *_ in read_log(path, small, told.append)]
    assert path.stat().st_size > 3 * BLOCK_BYTES
    assert len(chunks) > 3
    assert np.array_equal(np.concatenate(chunks), counts)
    assert sum(told) == path.stat().st_size - len(HEADER) - 1


def test_stdin(monkeypatch: pytest.MonkeyPatch, small: Design) -> None:
    stdin = io.TextIOWrapper(io.BytesIO(f"{HEADER}\n{ROW}\n".encode()))
    monkeypatch.setattr("sys.stdin", stdin)
    assert read(Path("-"), small)[0].tolist() == [[1, -2, 3, -4, 5, -6]]


FAULTS = {
    "empty": ("", "the log is empty"),
    "header only": (f"{HEADER}\n", "has a header and no samples"),
    "header without end": (HEADER, "has a header and no samples"),
    "no header": (f"{ROW}\n{ROW}\n", "line 1: no header"),
    "missing column": (
        "gyro_x,gyro_z,accel_x,accel_y,accel_z\n1,2,3,4,5\n",
        "line 1: column gyro_y is missing",
    ),
    "column of many letters": (
        f"{HEADER},{'a' * 50}\n{ROW},7\n",
        f"unknown column '{'a' * 40}', giv",
    ),
    "cell of many letters": (f"{HEADER}\n1,2,3,4,5,{'a' * 50}\n", f"is '{'a' * 40}', give a wh"),
    "stamp of many letters": (f"{HEADER},time_s\n{ROW},{'a' * 50}\n", f"is '{'a' * 40}', give dec"),
    "count of many digits": (f"{HEADER}\n1,2,3,4,5,{'7' * 50}\n", f"= {'7' * 40} does not fit"),
    "unknown column": (f"{HEADER},temp\n{ROW},7\n", "line 1: unknown column 'temp'"),
    "column twice": (f"{HEADER},gyro_x\n{ROW},7\n", "line 1: column gyro_x is there twice"),
    "float": (f"{HEADER}\n{ROW}\n1,2,3.0,4,5,6\n", "line 3: gyro_z is '3.0'"),
    "exponent": (f"{HEADER}\n1,2,3e2,4,5,6\n", "line 2: gyro_z is '3e2'"),
    "nan": (f"{HEADER}\n{ROW}\n{ROW}\n1,2,3,nan,5,6\n", "line 4: accel_x is 'nan'"),
    "word": (f"{HEADER}\n1,2,3,4,5,six\n", "line 2: accel_z is 'six'"),
    "nothing": (f"{HEADER}\n1,,3,4,5,6\n", "line 2: gyro_y is empty"),
    "lone minus": (f"{HEADER}\n1,-,3,4,5,6\n", "line 2: gyro_y is '-'"),
    "inner minus": (f"{HEADER}\n1,2-2,3,4,5,6\n", "line 2: gyro_y is '2-2'"),
    "two minuses": (f"{HEADER}\n1,--2,3,4,5,6\n", "line 2: gyro_y is '--2'"),
    "underscore": (f"{HEADER}\n1_0,2,3,4,5,6\n", "line 2: gyro_x is '1_0'"),
    "colon": (f"{HEADER}\n1,2:3,3,4,5,6\n", "line 2: gyro_y is '2:3'"),
    "other digits": (f"{HEADER}\n٣,2,3,4,5,6\n", "line 2: gyro_x is '٣'"),
    "short line": (f"{HEADER}\n{ROW}\n1,2,3\n{ROW}\n", "line 3: 3 values, give 6"),
    "long line": (f"{HEADER}\n{ROW},7\n{ROW}\n", "line 2: 7 values, give 6"),
    "two rows in a line": (f"{HEADER}\n{ROW},{ROW}\n", "line 2: 12 values, give 6"),
    "a row in two lines": (f"{HEADER}\n1,-2,3\n-4,5,-6\n", "line 2: 3 values, give 6"),
    "blanks for commas": (f"{HEADER}\n1 2 3 4 5 6\n", "line 2: 1 values, give 6"),
    "lines that even out": (f"{HEADER}\n{ROW},7\n1,2,3,4,5\n", "line 2: 7 values, give 6"),
    "empty line": (f"{HEADER}\n{ROW}\n\n{ROW}\n", "line 3: an empty line"),
    "cut in a number": (f"{HEADER}\n{ROW}\n1,2,3,4,5,6", "line 3: the last line has no line end"),
    "cut in a row": (f"{HEADER}\n{ROW}\n1,2,3", "line 3: the last line has no line end"),
    "cut in the header": ("gyro_x,gyro_y,gy", "column gyro_z is missing"),
    "gyro too large": (
        f"{HEADER}\n{ROW}\n1,32768,3,4,5,6\n",
        "line 3: gyro_y = 32768 does not fit",
    ),
    "gyro too small": (f"{HEADER}\n-32769,2,3,4,5,6\n", "line 2: gyro_x = -32769 does not fit"),
    "accel too large": (f"{HEADER}\n1,2,3,4,5,2048\n", "line 2: accel_z = 2048 does not fit"),
    "beyond 64 bits": (f"{HEADER}\n1,2,3,{10**30},5,6\n", "line 2: accel_x = 1000000"),
    "wraps in 64 bits": (f"{HEADER}\n1,2,3,{2**64 + 1},5,6\n", "does not fit the sensor's 12 bits"),
    "fault not 0 or 1": (f"{HEADER},fault\n{ROW},0\n{ROW},2\n", "line 3: fault is 2, give 0 or 1"),
    "stamp no number": (f"{HEADER},time_s\n{ROW},0.1\n{ROW},x\n", "line 3: time_s is 'x'"),
    "stamp empty": (f"{HEADER},time_s\n{ROW},\n", "line 2: time_s is empty, give decimal"),
    "stamp nan": (f"{HEADER},time_s\n{ROW},nan\n", "line 2: time_s is 'nan'"),
    "stamp infinite": (f"{HEADER},time_s\n{ROW},1e999\n", "line 2: time_s = inf is more than"),
    "stamp in ns": (f"{HEADER},time_s\n{ROW},1403636580238555500\n", "give seconds (not nano"),
    "stamp of two points": (f"{HEADER},time_s\n{ROW},1.2.3\n", "line 2: time_s is '1.2.3'"),
    "point elsewhere": (f"time_s,{HEADER}\n7,1,2.,3,4,5,6\n", "line 2: gyro_y is '2.'"),
    "long stamp, letter": (f"{HEADER},time_s\n{ROW},1.23456789012345678x\n", "line 2: time_s is"),
    "sequence no number": (f"{HEADER},sequence\n{ROW},1.0\n", "line 2: sequence is '1.0'"),
    "sequence too long": (f"{HEADER},sequence\n{ROW},{10**19}\n", "line 2: sequence has more"),
    "sequence twice": (f"{HEADER},sequence,sequence\n{ROW},1,1\n", "column sequence is there tw"),
    "fault negative": (f"{HEADER},fault\n{ROW},-1\n", "line 2: fault is -1, give 0 or 1"),
}


LIMITS = {
    "time_s": (
        ["1000000000000", "-1e12", "999999999999.9999"],
        ["1000000000001", "-1.00000001e12"],
    ),
    "time_s of many digits": ([f" 0.{'1' * 997}"], [f" 0.{'1' * 998}"]),
    "sequence": ([str(10**18), str(-(10**18))], [str(10**18 + 1), str(-(10**18) - 1)]),
    "fault": (["0", "1", f"{'0' * 1200}1"[-1000:]], ["-1", "2", "0" * 1001]),
}


@pytest.mark.parametrize("case", LIMITS)
def test_a_limit_is_read_and_what_is_beyond_is_refused(
    tmp_path: Path, small: Design, case: str
) -> None:
    """As text and as numbers of a binary file; the message is a line that can be read."""
    column = case.split()[0]
    inside, outside = LIMITS[case]
    for cell in inside + outside:
        path = text(tmp_path, f"{HEADER},{column}\n{ROW},{cell}\n")
        paths = [path]
        if len(cell) < 25:
            paths.append(tmp_path / "log.npz")
            number = np.array([float(cell) if column == "time_s" else int(cell)])
            names = zip(HEADER.split(","), ROW.split(","), strict=True)
            np.savez(
                paths[1], **{name: np.array([int(c)]) for name, c in names}, **{column: number}
            )
        for path in paths:
            if cell in inside:
                chunk = whole(list(read_log(path, small)))
                found = {"time_s": chunk.times, "sequence": chunk.sequence, "fault": chunk.faults}
                assert found[column] == [float(cell) if column == "time_s" else int(cell)]
            else:
                with pytest.raises(InputError, match=f"{column} ") as fault:
                    read(path, small)
                assert len(str(fault.value)) < len(str(path)) + 150


def laid_out(
    path: Path, columns: dict[str, list[str]], order: list[str], rng: np.random.Generator
) -> None:
    """A log of these cells, its columns in an order; some cells as people write them, too."""
    rows = [order, *(list(row) for row in zip(*(columns[name] for name in order), strict=True))]
    if rng.random() < 0.5:  # no longer plain: the slow path
        for row in rows[1:]:
            at = int(rng.integers(len(row)))
            row[at] = f" {row[at]} "
    path.write_text("\n".join(",".join(row) for row in rows) + "\n")


def of_units(design: Design, units: int) -> Design:
    """The same for so many units."""
    data = design.model_dump(mode="json", exclude_none=True)
    return Design.parse(data | {"hardware": {"core": "compact", "channels": units}})


def of_three(design: Design) -> Design:
    """The same for three units."""
    return of_units(design, 3)


def saved(path: Path, columns: dict[str, list[Any]]) -> Path:
    """A log of these columns, of the kind that its name says."""
    if path.suffix == ".csv":
        rows = [",".join(map(str, row)) for row in zip(*columns.values(), strict=True)]
        path.write_text("\n".join([",".join(columns), *rows]) + "\n")
    else:
        np.savez(path, **{name: np.array(column) for name, column in columns.items()})  # type: ignore[arg-type]
    return path


def still(rows: int, **columns: list[Any]) -> dict[str, list[Any]]:
    """Counts of nothing, and these columns."""
    return {name: [0] * rows for name in HEADER.split(",")} | columns


@pytest.mark.parametrize("ending", ["csv", "npz"])
@pytest.mark.parametrize(("gyro", "accel"), [(16, 12), (12, 16)])
def test_each_count_just_inside_its_word_and_just_beyond(
    tmp_path: Path, small: Design, gyro: int, accel: int, ending: str
) -> None:
    data = small.model_dump(mode="json", exclude_none=True)
    data["sensor"]["gyro"]["bits"], data["sensor"]["accel"]["bits"] = gyro, accel
    design, path = Design.parse(data), tmp_path / f"log.{ending}"
    for place, name in enumerate(HEADER.split(",")):
        half = 2 ** ((gyro if place < 3 else accel) - 1)
        for number in (-half, half - 1):
            saved(path, still(3, **{name: [0, number, 0]}))
            assert whole(list(read_log(path, design))).counts[:, place].tolist() == [0, number, 0]
        for number in (-half - 1, half):
            saved(path, still(3, **{name: [0, number, 0]}))
            at = "line 3" if ending == "csv" else "row 2"
            told = f"{at}: {name} = {number} does not fit .*, give {-half} to {half - 1}$"
            with pytest.raises(InputError, match=told):
                list(read_log(path, design))


@pytest.mark.parametrize("ending", ["csv", "npz"])
def test_two_units_are_units_too(tmp_path: Path, small: Design, ending: str) -> None:
    design, path = of_units(small, 2), tmp_path / f"log.{ending}"

    def refusal(**columns: list[Any]) -> str:
        with pytest.raises(InputError) as fault:
            list(read_log(saved(path, still(2, **columns)), design, channels=True))
        return str(fault.value)

    assert "column channel is missing, add it: hardware.channels = 2" in refusal()
    assert "column sequence is not read" in refusal(channel=[0, 1], sequence=[5, 6])
    for channel in (-1, 2):
        assert refusal(channel=[0, channel]).endswith(f": channel is {channel}, give 0 to 1")
    for restart in (-1, 2):
        told = refusal(channel=[0, 1], restart=[0, restart])
        assert told.endswith(f": restart is {restart}, give 0 or 1")
    saved(path, still(3, channel=[1, 0, 1], restart=[0, 1, 0]))
    chunk = whole(list(read_log(path, design, channels=True)))
    assert chunk.channels is not None
    assert chunk.restarts is not None
    assert (chunk.channels.tolist(), chunk.restarts.tolist()) == ([1, 0, 1], [0, 1, 0])
    with pytest.raises(InputError, match="a log of 2 channels is read by model and simulate"):
        list(read_log(path, design))


@pytest.mark.parametrize("ending", ["csv", "npz"])
def test_a_log_without_a_design_is_one_units(tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"log.{ending}"
    saved(path, still(2, fault=[0, 1], time_s=[0.5, 0.75], sequence=[7, 8]))
    chunk = whole(list(read_log(path, None)))
    assert [column.tolist() for column in chunk[1:4]] == [[0, 1], [0.5, 0.75], [7, 8]]
    assert chunk[4:] == (None, None)
    with pytest.raises(InputError, match=r"column channel is for a design with hardware\.channels"):
        list(read_log(saved(path, still(2, channel=[0, 0])), None))


@pytest.mark.parametrize("ending", ["npz", "parquet"])
def test_rows_are_counted_through_all_blocks(
    tmp_path: Path, small: Design, monkeypatch: pytest.MonkeyPatch, ending: str
) -> None:
    """A count, a mark and a stamp that stand alone in the third block of a hundred rows."""
    for module in ("npz", "parquet"):
        monkeypatch.setattr(f"sculler.formats.tables.{module}.BLOCK_ROWS", 100)
    for name, value, told in (
        ("accel_y", 5000, "row 231: accel_y = 5000 does not fit"),
        ("fault", 2, "row 231: fault is 2, give 0 or 1"),
        ("time_s", 2e12, r"row 231: time_s = 2e\+12 is more than 1e\+12 s"),
    ):
        columns = {key: np.zeros(300, np.int64) for key in HEADER.split(",")}
        columns[name] = np.zeros(300, float if name == "time_s" else int)
        columns[name][230] = value
        path = tmp_path / f"log.{ending}"
        if ending == "npz":
            np.savez(path, **columns)  # type: ignore[arg-type]
        else:
            pq = pytest.importorskip("pyarrow.parquet")
            pq.write_table(pytest.importorskip("pyarrow").table(columns), path)
        with pytest.raises(InputError, match=told):
            list(read_log(path, small))


def test_columns_of_a_binary_log_have_the_types_of_the_page(tmp_path: Path) -> None:
    with LogWriter(tmp_path / "log.npz", True, True, True, True) as writer:
        marks = np.array([1], np.uint8)
        writer.write(np.ones((1, 6), int), marks, np.zeros(1), 0.0, np.zeros(1, int), marks)
    types = {name: str(column.dtype) for name, column in np.load(tmp_path / "log.npz").items()}
    assert types == dict.fromkeys([*HEADER.split(","), "channel"], "int64") | {
        "fault": "uint8",
        "restart": "uint8",
        "time_s": "float64",
    }


@pytest.mark.parametrize("ending", ["csv", "npz"])
@pytest.mark.parametrize("origin", [0.0, 4e6, 2.0**33, -5.0])
def test_stamps_are_written_from_their_origin(tmp_path: Path, origin: float, ending: str) -> None:
    """The float nearest to their sum, near and far, whatever the file."""
    times, path = np.array([0.5, 1.0, 0.001953125]), tmp_path / f"log.{ending}"
    with LogWriter(path, times=True) as writer:
        writer.write(np.zeros((3, 6), int), times=times, origin=origin)
    (chunk,) = read_log(path, None)
    assert chunk.times is not None
    exact = [float(Fraction(time) + Fraction(origin)) for time in times.tolist()]
    assert chunk.times.tolist() == exact


def test_a_name_is_a_file_unless_it_is_a_dash(
    tmp_path: Path, small: Design, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever sorts before a dash, as a browser's second copy; and stdin that cannot be read."""
    monkeypatch.chdir(tmp_path)
    Path("(1)").write_text(f"{HEADER}\n{ROW}\n")
    assert read(Path("(1)"), small)[0].tolist() == [[1, -2, 3, -4, 5, -6]]
    with pytest.raises(InputError, match=r"^\(2\): cannot read the log \(No such file"):
        read(Path("(2)"), small)

    def readline(_: int) -> bytes:
        raise OSError(5, "Input/output error")

    stdin = SimpleNamespace(buffer=SimpleNamespace(readline=readline))
    monkeypatch.setattr("sys.stdin", stdin)
    with pytest.raises(InputError, match=r"^stdin: cannot read the log \(Input/output error\)"):
        read(Path("-"), small)


def test_a_log_of_three_units_is_not_read_as_one_units(tmp_path: Path, small: Design) -> None:
    path = text(tmp_path, f"{HEADER},channel\n{ROW},2\n")
    with pytest.raises(InputError, match=r"a log of 3 channels is read by model and simulate"):
        next(read_log(path, of_three(small)))
    assert whole(list(read_log(path, of_three(small), channels=True))).channels == [2]


@pytest.mark.parametrize("seed", range(30))
def test_columns_of_any_layout_come_back(tmp_path: Path, small: Design, seed: int) -> None:
    """Any of the optional columns, in any order, of one unit and of three."""
    rng = np.random.default_rng(seed)
    channels = 3 if seed % 3 == 0 else 1
    rows = 7
    gyro, accel = small.words.gyro, small.words.accel
    counts = np.column_stack([rng.integers(w.lo, w.hi + 1, (rows, 3)) for w in (gyro, accel)])
    counts[0], counts[1] = [gyro.lo] * 3 + [accel.lo] * 3, [gyro.hi] * 3 + [accel.hi] * 3
    marks = rng.integers(0, 2, (2, rows))
    more = {
        "fault": marks[0].tolist(),
        "time_s": (rng.uniform(-1, 1, rows) * 10.0 ** rng.integers(-3, 12, rows)).tolist(),
    }
    more |= (
        {"channel": rng.integers(0, 3, rows).tolist(), "restart": marks[1].tolist()}
        if channels == 3
        else {"sequence": rng.integers(-(10**18), 10**18 + 1, rows).tolist()}
    )
    kept = [name for name in more if name == "channel" or rng.random() < 0.6]
    values = dict(zip(HEADER.split(","), counts.T.tolist(), strict=True))
    values |= {name: more[name] for name in kept}
    order = list(rng.permutation(list(values)))
    cells = {name: [f"{value}" for value in column] for name, column in values.items()}
    for at, time in enumerate(values.get("time_s", [])):
        cells["time_s"][at] = f"{time:.6f}"
        values["time_s"][at] = float(cells["time_s"][at])
    path = tmp_path / "log.csv"
    laid_out(path, cells, order, rng)
    chunk = whole(list(read_log(path, of_three(small) if channels == 3 else small, channels=True)))
    assert chunk.counts.tolist() == counts.tolist()
    for name, found in zip(
        ("fault", "time_s", "sequence", "channel", "restart"), chunk[1:], strict=True
    ):
        assert (found is None) == (name not in values), name
        assert found is None or found.tolist() == values[name]


@pytest.mark.parametrize("case", FAULTS)
def test_faults_are_named(tmp_path: Path, small: Design, case: str) -> None:
    content, message = FAULTS[case]
    path = text(tmp_path, content)
    with pytest.raises(InputError) as fault:
        read(path, small)
    assert str(fault.value).startswith(f"{path}: ")
    assert message in str(fault.value)
    assert "\n" not in str(fault.value)


@pytest.mark.parametrize("content", [b"\x80\x81\xff\x00", b"\x00" * 100_000, b"\xff\xfeg\x00"])
def test_binary_files_are_refused(tmp_path: Path, small: Design, content: bytes) -> None:
    with pytest.raises(InputError, match=r"UTF-8|no header"):
        read(text(tmp_path, content), small)


def test_binary_rows_are_refused(tmp_path: Path, small: Design) -> None:
    path = text(tmp_path, HEADER.encode() + b"\n1,2,3,\xff\xfe,5,6\n")
    with pytest.raises(InputError, match="line 2: accel_x is"):
        read(path, small)


@pytest.mark.parametrize("name", ["absent.csv", "."])
def test_unreadable_log(tmp_path: Path, small: Design, name: str) -> None:
    path = tmp_path / name
    with pytest.raises(InputError, match=f"^{re.escape(str(path))}: cannot read the log"):
        read(path, small)


def test_line_numbers_far_into_a_long_log(tmp_path: Path, small: Design) -> None:
    path = text(tmp_path, f"{HEADER}\n" + f"{ROW}\n" * 60_000 + "1,2,3,4,x,6\n" + f"{ROW}\n" * 9)
    with pytest.raises(InputError, match="line 60002: accel_y is 'x'"):
        read(path, small)


def test_fast_parser_agrees_with_the_slow_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """The fast parser takes exactly plain integers, and then with int()'s values."""
    rng = np.random.default_rng(11)
    alphabet = np.frombuffer(b"0123456789" * 3 + b"--,,\n\n +.e\r", np.uint8)
    taken = 0
    for _ in range(3000):
        cells = [
            str(rng.integers(-(10 ** int(rng.integers(1, 11))), 10 ** int(rng.integers(1, 11))))
            for _ in range(6)
        ]
        block = bytearray((",".join(cells[:3]) + "\n" + ",".join(cells[3:]) + "\n").encode())
        if rng.random() < 0.7:
            block[int(rng.integers(len(block) - 1))] = int(rng.choice(alphabet))
        got = parse(bytes(block), 3)
        lines = bytes(block).split(b"\n")[:-1]
        plain = [cell for line in lines if line.count(b",") == 2 for cell in line.split(b",")]
        good = (
            len(lines) == 2
            and len(plain) == 6
            and all(
                c.removeprefix(b"-").isdigit() and len(c.removeprefix(b"-")) <= 10 for c in plain
            )
        )
        assert (got is not None) == good, bytes(block)
        if got is not None:
            taken += 1
            assert got.whole.ravel().tolist() == [int(c) for c in plain]
    assert taken > 1000


def whole(chunks: list[Chunk]) -> Chunk:
    """The chunks as one; all of the same columns."""
    columns = zip(*chunks, strict=True)
    return Chunk(*(None if c[0] is None else np.concatenate(c) for c in columns))


def test_stamps_and_counter_come_back_as_written(tmp_path: Path, small: Design) -> None:
    """Every float as itself, whatever its digits; chunks and the order of columns do not matter."""
    rng = np.random.default_rng(3)
    times = np.concatenate(
        [
            rng.uniform(-1, 1, 9000) * 10.0 ** rng.integers(-9, 11, 9000),
            1403636579.763555527 + 0.005 * np.arange(9000),
            [0.0, -0.0, 5e-324, 1e-7, 2.0**-40, 999999999999.9999, 0.1, 1 / 3, 2**33 + 2**-19],
        ]
    )
    counts = rng.integers(-2048, 2048, (len(times), 6))
    path = tmp_path / "log.csv"
    with LogWriter(path, times=True) as writer:
        writer.write(counts[:7], times=times[:7])
        writer.write(counts[7:], times=times[7:])
    assert "e" not in path.read_text().split("\n", 1)[1]
    got = whole(list(read_log(path, small)))
    assert got.faults is got.sequence is None
    assert got.counts.tolist() == counts.tolist()
    assert got.times is not None
    assert got.times.tobytes() == times.tobytes()
    lines = path.read_text().splitlines()
    number = [10**18 - len(lines) + i for i in range(len(lines))]
    path.write_text(
        "time_s,sequence," + HEADER + "\n"
        + "".join(f"{line.rpartition(',')[2]},{at},{line.rpartition(',')[0]}\n"
                  for at, line in zip(number[1:], lines[1:], strict=True))
    )  # fmt: skip
    again = whole(list(read_log(path, small)))
    assert again.times is not None
    assert again.sequence is not None
    assert again.times.tobytes() == times.tobytes()
    assert again.sequence.tolist() == number[1:]
    assert again.counts.tolist() == counts.tolist()


@pytest.mark.parametrize("cell", ["1e-3", "+0.25", ".5", " 7 ", "5.", "00012.50", "-0", "1E2"])
def test_stamps_in_other_spellings(tmp_path: Path, small: Design, cell: str) -> None:
    path = text(tmp_path, f"{HEADER},time_s\n{ROW},{cell}\n")
    assert whole(list(read_log(path, small))).times == [float(cell)]


def test_decimals_are_the_nearest_floats() -> None:
    """Digits of all lengths, and the hard ones: close to half way between two floats."""
    rng = np.random.default_rng(5)
    cells = ["7", "0.5", "12.", "-3.25", "0.1", "-0.0", "4503599627370497.5", "9007199254740993"]
    for _ in range(20_000):
        whole_digits, places = int(rng.integers(1, 16)), int(rng.integers(1, 19))
        digits = "".join(map(str, rng.integers(0, 10, whole_digits + places)))
        cells.append(
            "-" * bool(rng.random() < 0.3) + digits[:whole_digits] + "." + digits[-places:]
        )
    for k in range(
        1, 6000
    ):  # half way: 2**33 + an odd number of 2**-20; and a last digit beside it
        half = Fraction(2**33) + Fraction(2 * k + 1, 2**20)
        digits = str(int(half * 10**20))
        for cut in (20, 17, 15, 14, 12):
            cells.append(f"{digits[:-20]}.{digits[-20:][:cut]}")
    for power in range(4, 40):  # below a power of two floats lie twice as close
        for part in (1, 2, 3, 4, 5, 6):
            value = Fraction(2**power) - Fraction(2**power, part * 2**53)
            digits = str(int(value * 10**15))
            cells.append(f"{digits[:-15]}.{digits[-15:]}")
    cells = [cell for cell in cells if len(cell.lstrip("-").partition(".")[0]) <= 15]
    block = "".join(f"{i},{cell},-1\n" for i, cell in enumerate(cells)).encode()
    got = parse(block, 3, decimal=1)
    assert got is not None
    assert got.decimals is not None
    wanted = np.array([float(cell) for cell in cells])
    assert np.flatnonzero(got.decimals != wanted).tolist() == []
    assert np.signbit(got.decimals).tolist() == np.signbit(wanted).tolist()
    assert got.whole[:, 0].tolist() == list(range(len(cells)))
    assert not got.whole[:, 1].any()


@pytest.mark.parametrize("origin", [1403636579, 2**33, 0, -5])
def test_nanoseconds_are_those_of_the_decimals(origin: int) -> None:
    """What compiled loops print: rounded as the exact product, or left to others where unsure."""
    rng = np.random.default_rng(4)
    times = np.concatenate([np.arange(400) / 2000, rng.uniform(0, 100, 400), [0.0, 6.0, 1e6]])
    halves = (rng.integers(0, 2**40, 50) + 0.5) / 1e9
    if origin < 0:
        assert _nanoseconds(times[:9], origin) is None  # some come before 0
        times = times[times > 5]
    found = _nanoseconds(times, origin)
    assert found is not None
    exact = [round(Fraction(time) * 10**9) + origin * 10**9 for time in times.tolist()]
    assert found.tolist() == exact
    assert _nanoseconds(np.array([1.0, 1.1e6]), origin) is None
    assert _nanoseconds(np.array([1.0]), 10**10) is None
    for time in halves.tolist():
        told = _nanoseconds(np.array([6.0, time]), max(origin, 0))
        near = round(Fraction(time) * 10**9) + max(origin, 0) * 10**9
        assert told is None or told[1] == near


@pytest.mark.parametrize(
    ("digits", "long", "read"),
    [(10, False, True), (11, False, False), (18, True, True), (19, True, False)],
)
def test_digits_of_whole_numbers(digits: int, long: bool, read: bool) -> None:
    number = int("1234567890123456789"[:digits])
    got = parse(f"{number},-{number}\n".encode(), 2, long=long)
    assert (got is not None) == read
    assert got is None or got.whole.tolist() == [[number, -number]]
    assert got is None or got.decimals is None


@pytest.mark.parametrize(("digits", "read"), [(15, True), (16, False)])
def test_digits_before_a_point(digits: int, read: bool) -> None:
    cell = "1234567890123456"[:digits] + ".25"
    got = parse(f"7,{cell}\n8,-1\n".encode(), 2, decimal=1)
    assert (got is not None) == read
    if got is not None:
        assert got.decimals is not None
        assert got.decimals.tolist() == [float(cell), -1.0]
        assert got.whole.tolist() == [[7, 0], [8, 0]]


@pytest.mark.parametrize(
    "block", [b"1,.5\n", b"1,-.5\n", b"1,1.2.3\n", b"1.,2\n", b"1,2.\n1.5,2\n", b"1,-\n", b",1\n"]
)
def test_what_is_no_plain_decimal_is_left_to_others(block: bytes) -> None:
    assert parse(block, 2, decimal=1) is None


def test_stamps_of_a_far_clock_have_nine_places() -> None:
    """Beyond 2^23 s floats lie more than a nanosecond apart: 8.4 million s, 97 days."""
    assert [is_far(origin) for origin in (0, 8.3e6, -8.3e6, 8.4e6, -8.4e6)] == [
        *[False] * 3,
        *[True] * 2,
    ]
    times = np.array([0.5, 1.0, 1e-9, 0.1234567894, -0.25])
    assert decimals(times, 2**33) == [
        "8589934592.5",
        "8589934593.0",
        "8589934592.000000001",
        "8589934592.123456789",
        "8589934591.75",
    ]
    assert decimals(times[:3], 0) == ["0.5", "1.0", "0.000000001"]
    assert decimals(times[:2], 4e6) == ["4000000.5", "4000001.0"]
    assert decimals(np.array([1e22, -1e-7]), 0.0) == ["10000000000000000000000.0", "-0.0000001"]


def test_lines_come_in_blocks_of_a_size() -> None:
    content = b"one\ntwo\nthree\nfour\nfive"
    for size in (1, 4, 5, 9, 100):
        found = list(whole_lines(io.BytesIO(content), "it", size))
        assert b"".join(found) == content
        assert all(block.endswith(b"\n") for block in found[:-1])
        assert found[-1] == b"five"
    by_nine = list(whole_lines(io.BytesIO(content), "it", 9))
    assert by_nine == [b"one\ntwo\n", b"three\n", b"four\n", b"five"]
    default = list(whole_lines(io.BytesIO(b"123456789\n" * 30_000), "it"))
    first = BLOCK_BYTES // 10 * 10
    assert [len(block) for block in default] == [first, 300_000 - first]


def test_a_line_of_64_kib_is_the_longest() -> None:
    for length in (65536, 65537):
        blocks = whole_lines(io.BytesIO(b"1" * length), "it", 1 << 20)
        if length == 65536:
            assert list(blocks) == [b"1" * length]
        else:
            with pytest.raises(InputError, match="it: a line of more than 64 KiB"):
                list(blocks)


def test_a_header_of_4096_bytes_is_the_longest(tmp_path: Path, small: Design) -> None:
    for length in (4096, 4097):
        head = HEADER + " " * (length - 1 - len(HEADER))
        path = text(tmp_path, f"{head}\n{ROW}\n")
        if length == 4096:
            assert read(path, small)[0].tolist() == [[1, -2, 3, -4, 5, -6]]
        else:
            with pytest.raises(InputError, match="line 1: more than 4096 bytes, shorten"):
                read(path, small)


@pytest.mark.parametrize("rows", [1, 50])
@pytest.mark.parametrize("ending", ["csv", "npz"])
def test_what_is_read_is_told(tmp_path: Path, small: Design, ending: str, rows: int) -> None:
    path, told = tmp_path / f"log.{ending}", list[int]()
    with LogWriter(path) as writer:
        writer.write(np.ones((rows, 6), np.int64))
    assert sum(len(chunk.counts) for chunk in read_log(path, small, told.append)) == rows
    size = path.stat().st_size
    assert told == [size - len(HEADER) - 1 if ending == "csv" else size]


def test_part_of_a_chunk_and_its_marks() -> None:
    rows = np.arange(4)
    chunk = Chunk(np.arange(24).reshape(4, 6), rows % 2, None, rows * 10, rows * 2, None)
    some = chunk.part(slice(1, 3))
    assert some.counts.tolist() == [[*range(6, 12)], [*range(12, 18)]]
    assert some.sequence is not None
    assert some.sequence.tolist() == [10, 20]
    assert some.times is some.restarts is None
    assert [mark.tolist() for mark in some.marks] == [[1, 0], [2, 4]]


@pytest.mark.parametrize("told", [True, False])
@pytest.mark.parametrize("number", [2**63 - 1, -(2**63), 2**63, -(2**63) - 1])
def test_counts_of_a_log_without_a_design_have_64_bits(
    tmp_path: Path, small: Design, number: int, told: bool
) -> None:
    path = text(tmp_path, f"{HEADER}\n{ROW}\n1,2,3,4,5,{number}\n")
    if not told and -(2**63) <= number < 2**63:
        (chunk,) = read_log(path, None)
        assert chunk.counts[1, 5] == number
        return
    bits = "12" if told else "64"
    with pytest.raises(InputError, match=f"line 3: accel_z = {number} does .* {bits} bits"):
        list(read_log(path, small if told else None))


def test_places_of_narrow_digits_do_not_wrap() -> None:
    """Under numpy 1 a byte times a small 64-bit scalar is a byte: -300 came out as -44."""
    got = parse(b"1000,-300,26,999,-4096,123456\n", 6)
    assert got is not None
    assert got.whole.tolist() == [[1000, -300, 26, 999, -4096, 123456]]


@pytest.mark.parametrize("ending", ["csv", "npz"])
def test_a_log_has_the_columns_that_are_asked_for_and_no_others(
    tmp_path: Path, ending: str
) -> None:
    """Its other columns by default none; faults that nobody tells are 0."""
    counts, two = np.arange(12).reshape(2, 6), np.array([2, 0])
    options = {
        "faults": ("fault", None, [0, 0]),
        "times": ("time_s", np.array([0.5, 1.5]), [0.5, 1.5]),
        "channels": ("channel", two, [2, 0]),
        "restarts": ("restart", np.array([0, 1], np.uint8), [0, 1]),
    }
    for option in ("", *options):
        path = tmp_path / f"log{option}.{ending}"
        chosen = {option: True} if option else {}
        with LogWriter(path, **chosen) as writer:
            writer.write(counts, **({option: options[option][1]} if option else {}))
        wanted = dict(zip(HEADER.split(","), counts.T.tolist(), strict=True))
        if option:
            wanted[options[option][0]] = options[option][2]
        if ending == "npz":
            found = {name: column.tolist() for name, column in np.load(path).items()}
        else:
            header, *rows = (line.split(",") for line in path.read_text().splitlines())
            columns = zip(*([float(cell) for cell in row] for row in rows), strict=True)
            found = {name: list(column) for name, column in zip(header, columns, strict=True)}
        assert found == wanted


@pytest.mark.parametrize("taken", [1, 0])
def test_what_the_loops_do_not_take_is_read_without_them(small: Design, taken: int) -> None:
    """Loops that read one line as sixes, and say that they have read it, or that they have not."""

    def scan_log(*arguments: Any) -> int:
        arguments[5][:] = 6  # the counts
        return taken

    layout = _Layout("log.csv", small)
    layout.read_header(HEADER.encode())
    loops: Any = SimpleNamespace(scan_log=scan_log, lower=None)
    chunk = layout.read(f"{ROW}\n".encode(), 2, loops)
    assert chunk.counts.tolist() == [[6] * 6 if taken else [1, -2, 3, -4, 5, -6]]
    assert chunk[1:] == (None,) * 5


def test_what_the_loops_read_by_hand(tmp_path: Path, small: Design) -> None:
    """The loops themselves, as Python runs them; and those of before where a stamp is too late."""
    loops: Any = SimpleNamespace(scan_log=scanning.scan_log, lower=lower_powers())

    def read_by_loops(header: str, *rows: str) -> tuple[Chunk | None, Chunk]:
        layout, block = _Layout("log.csv", small), "".join(f"{row}\n" for row in rows).encode()
        layout.read_header(header.encode())
        with np.errstate(over="ignore"):
            return layout.scan(loops, block), layout.read(block, 2, loops)

    header = "sequence,accel_z,fault,accel_y,accel_x,time_s,gyro_z,gyro_y,gyro_x"
    for chunk in read_by_loops(header, "8,-6,1,5,-4,-0.25,3,-2,1", "9,6,0,5,4,1000000000000,3,2,1"):
        assert chunk is not None
        assert chunk.counts.tolist() == [[1, -2, 3, -4, 5, -6], [1, 2, 3, 4, 5, 6]]
        told = [column.tolist() for column in chunk[1:4]]
        assert told == [[1, 0], [-0.25, 1e12], [8, 9]]
    for row, told in (
        ("8,-6,1,5,-4,-1000000000001,3,-2,1", "time_s = -1e"),
        ("8,-6,2,5,-4,0,3,-2,1", "fault is 2"),
        (f"{10**18 + 1},-6,1,5,-4,0,3,-2,1", "sequence has"),
        ("8,2048,1,5,-4,0,3,-2,1", "accel_z = 2048"),
        ("8,-6,1,5,-4,0,3,-2,-32769", "gyro_x = -32769"),
    ):
        with pytest.raises(InputError, match=f"line 3: {told}"):
            read_by_loops(header, "8,-6,1,5,-4,-0.25,3,-2,1", row)
    alone, _ = read_by_loops(HEADER, ROW)
    assert alone is not None
    assert alone[1:] == (None,) * 5


@pytest.mark.parametrize(
    ("times", "origin", "loop"),
    [
        (None, 0.0, "rows"),
        (None, 2.0**33, "rows"),
        ([0.5, 2.0], 7.0, "rows"),
        ([0.5, 2.0], 2.0**33, "stamped"),
        ([0.5, 2e6], 2.0**33, None),  # further from the origin than nanoseconds are sure
        ([1e-9, 2.0], 0.0, None),  # it would have an exponent
        ([-9.9e-5, 2.0], 0.0, None),
        ([1e-4, -1e-4], 0.0, "rows"),
        ([-1e16, 2.0], 0.0, None),
        ([9999999999999998.0, -9999999999999998.0], 0.0, "rows"),
    ],
)
def test_which_loop_prints_what(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    times: list[float] | None,
    origin: float,
    loop: str | None,
) -> None:
    """Stamps of a far clock as whole nanoseconds; what no loop prints right, Python does."""

    given: list[Any] = []

    def printing(name: str) -> Any:
        def loop(*arguments: Any) -> int:
            given[:] = arguments
            told = f"{name}\n".encode()
            arguments[-1][: len(told)] = np.frombuffer(told, np.uint8)
            return len(told)

        return loop

    loops = SimpleNamespace(
        print_stamped=printing("stamped"), print_rows=printing("rows"), upper=None
    )
    monkeypatch.setattr(log_text, "kernels", lambda *_, **__: loops)
    path = tmp_path / "log.csv"
    stamps = None if times is None else np.array(times)
    with LogWriter(path, times=times is not None) as writer:
        writer.write(np.zeros((2, 6), np.int64), times=stamps, origin=origin)
    _, *lines = path.read_text().splitlines()
    if loop is None:
        assert stamps is not None
        assert [line.rpartition(",")[2] for line in lines] == decimals(stamps, origin)
    else:
        assert lines == [loop]
        widest = 6 * len(f"{-(2**63)},") + (len("-2.2250738585072014e-308,") if times else 0)
        assert len(given[-1]) >= 2 * widest
        asked = [time + origin for time in times or ()]
        if loop == "stamped":
            asked = [int(10**9 * Fraction(time)) for time in asked]
        assert given[1 if loop == "stamped" else 2].tolist() == asked


@pytest.mark.parametrize("mark", ["fault", "sequence"])
def test_marks_that_are_text_are_refused(tmp_path: Path, small: Design, mark: str) -> None:
    columns = {name: np.zeros(2, np.int64) for name in HEADER.split(",")}
    for wrong in (np.array(["0", "1"]), np.array([b"0", b"1"]), np.array([0.0, 1.0])):
        np.savez(tmp_path / "log.npz", **columns, **{mark: wrong})
        with pytest.raises(InputError, match=f"{mark} is of type .*, give whole numbers"):
            read(tmp_path / "log.npz", small)


def test_a_writer_wants_stamps_exactly_where_it_has_the_column(tmp_path: Path) -> None:
    counts = np.zeros((2, 6), np.int64)
    for times, given in ((True, None), (False, np.zeros(2))):
        with (
            LogWriter(tmp_path / "log.csv", times=times) as writer,
            pytest.raises(ValueError, match="exactly where"),
        ):
            writer.write(counts, times=given)


@pytest.mark.parametrize("head", [f"{HEADER}\n", f"{HEADER}\n{ROW}\n"])
def test_a_line_without_end_is_refused_before_it_fills_the_memory(
    tmp_path: Path, small: Design, head: str
) -> None:
    path = text(tmp_path, head + "1" * 3_000_000)
    with pytest.raises(InputError, match="a line of more than 64 KiB, which is no row"):
        read(path, small)
