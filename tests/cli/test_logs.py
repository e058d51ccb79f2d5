"""IMU logs: what is read, what is refused and in which words."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest

from sculler import logs
from sculler.logs import BLOCK_BYTES, LogWriter, read_log
from sculler_model.design import Design
from sculler_model.errors import InputError

HEADER = "gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z"
ROW = "1,-2,3,-4,5,-6"


@pytest.fixture
def small(design: Path) -> Design:
    return Design.load(design)


def read(path: Path, design: Design) -> tuple[np.ndarray, np.ndarray | None]:
    chunks = list(read_log(path, design))
    faults = [f for _, f in chunks if f is not None]
    return np.concatenate([c for c, _ in chunks]), np.concatenate(faults) if faults else None


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
    chunks = [c for c, _ in read_log(path, small, told.append)]
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
    "no header": (f"{ROW}\n{ROW}\n", "line 1: no header"),
    "missing column": (
        "gyro_x,gyro_z,accel_x,accel_y,accel_z\n1,2,3,4,5\n",
        "line 1: column gyro_y is missing",
    ),
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
    "other digits": (f"{HEADER}\n٣,2,3,4,5,6\n", "line 2: gyro_x is '٣'"),
    "short line": (f"{HEADER}\n{ROW}\n1,2,3\n{ROW}\n", "line 3: 3 values, give 6"),
    "long line": (f"{HEADER}\n{ROW},7\n{ROW}\n", "line 2: 7 values, give 6"),
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
    "fault negative": (f"{HEADER},fault\n{ROW},-1\n", "line 2: fault is -1, give 0 or 1"),
}


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
    with pytest.raises(InputError, match="cannot read the log"):
        read(tmp_path / name, small)


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
        got = logs._parse(bytes(block), 3)
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
            assert got.ravel().tolist() == [int(c) for c in plain]
    assert taken > 1000
