"""Compiled loops over text: the digits of `repr`, the floats of `float`, and refusals as before."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sculler.formats import compiled
from sculler.formats.history import HistoryWriter
from sculler.formats.log import LogWriter, read_log
from sculler.formats.truth import read_truth
from sculler.formats.vectors import VectorsWriter, read_vectors
from sculler.readers.text import Column, number_rows, open_text
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.fast import FastModel
from sculler_model.motion import MOTIONS
from sculler_model.navigation import NavHistory

pytest.importorskip("numba")

DESIGN = Design.preset("stim300")
HG4930 = Design.preset("hg4930")  # components of more than 64 bits
FUNCTION_SCOPED = settings(
    suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None
)


@pytest.fixture(scope="module")
def loops() -> compiled.Kernels:
    found = compiled.loaded()
    assert found is not None
    return found


def special_floats() -> np.ndarray:
    powers = 2.0 ** np.arange(-1074, 1024)
    tens = np.array([float(f"1e{k}") for k in range(-323, 309)])
    near = np.concatenate([np.nextafter(tens, 0), tens, np.nextafter(tens, np.inf)])
    others = [0.0, -0.0, 5e-324, 1.7976931348623157e308, 1e15, 1e16, 9999999999999998.0, 1e-4, 9e-5]
    others += [2.2250738585072014e-308, 9007199254740993.0, 123456.0, 1.5, 0.1 + 0.2]
    return np.concatenate([powers, near, -near, np.array(others)])


def test_floats_are_printed_as_repr_does(loops: compiled.Kernels) -> None:
    rng = np.random.default_rng(3)
    random_bits = rng.integers(0, 2**64, 20_000, np.uint64).view(np.float64)
    values = np.concatenate(
        [
            special_floats(),
            random_bits[np.isfinite(random_bits)],
            rng.standard_normal(20_000),
            rng.uniform(0, 1e5, 20_000).round(4),
            1.4e9 + np.arange(10_000) / 2000,
        ]
    )
    out = np.empty(26 * len(values), np.uint8)
    size = loops.print_floats(values[:, None], loops.upper, out)
    assert bytes(out[:size]).decode().split() == [repr(value) for value in values.tolist()]
    for beyond in (np.nan, np.inf, -np.inf):
        assert loops.print_floats(np.array([[1.0, beyond]]), loops.upper, out) == -1


def scanned(loops: compiled.Kernels, cells: list[str]) -> np.ndarray | None:
    text = np.frombuffer("".join(cell + "\n" for cell in cells).encode(), np.uint8)
    bits = np.empty((len(cells), 1), np.uint64)
    nothing = np.empty((0, 0), np.int64)
    rows = loops.scan_numbers(text, ord(","), np.zeros(1, np.int64), loops.lower, bits, nothing)
    return bits[:, 0].view(np.float64) if rows == len(cells) else None


def test_floats_are_read_as_float_does(loops: compiled.Kernels) -> None:
    rng = np.random.default_rng(4)
    ordinary = [v for v in special_floats().tolist() if v == 0 or 2.3e-308 < abs(v) < 8e307]
    texts = [repr(value) for value in ordinary]
    digits = rng.integers(1, 2**63, 20_000) // 10 ** rng.integers(0, 18, 20_000)
    places = rng.integers(0, 19, 20_000)
    for number, place in zip(digits.tolist(), places.tolist(), strict=True):
        text = f"{number:020}"[-19:]
        texts.append(f"{text[: 19 - place]}.{text[19 - place :]}" if 0 < place < 19 else text)
    # halfway between two floats: to the even one
    for odd in rng.integers(2**52, 2**53, 2000).tolist():
        texts += [str(2 * odd + 1), f"-{(2 * odd + 1) * 5**3}e-3"]
    read = scanned(loops, texts)
    assert read is not None
    expected = np.array([float(text) for text in texts])
    assert np.array_equal(read.view(np.uint64), expected.view(np.uint64))


@pytest.mark.parametrize(
    "cell",
    [
        *("", " ", "-", ".", "1.", ".5", "+1", "1 1", "1e", "1e+", "1..2", "1.2.3", "--1", "0x1"),
        *("nan", "inf", "1_0", "1,2", "1E5", "\u0663", "12345678901234567890", "1e99999"),
        *("1e400", "3e-320", "1.7e308"),  # no float of full precision
    ],
)
def test_what_is_not_plain_is_left_to_others(loops: compiled.Kernels, cell: str) -> None:
    assert scanned(loops, [cell]) is None


@pytest.fixture
def by_loops(monkeypatch: pytest.MonkeyPatch) -> Callable[[bool], None]:
    there = compiled.loaded()
    monkeypatch.setattr(compiled, "WORTH_READING", 0)
    monkeypatch.setattr(compiled, "WORTH_WRITING", 0)
    return lambda on: monkeypatch.setattr(compiled, "loaded", lambda: there if on else None)


def outcome(read: Callable[[], Any]) -> Any:
    """What reading gives: numbers, or the words of the refusal."""
    try:
        return [
            tuple(None if column is None else np.asarray(column).tolist() for column in columns)
            for columns in read()
        ]
    except InputError as error:
        return str(error)


LOG = "\n".join(
    [
        "gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z,fault,time_s,sequence",
        "-300,26,999,-4096,12,123456,0,1403636579.763555,65535",
        "-301,25,998,-4095,13,-8388608,1,1403636579.7640555,0",
        "8388607,0,0,0,0,0,0,17,999999999999999999",
        "",
    ]
)
BYTES = st.sampled_from([*b"0123456789-+., eE\n\r\x00\xff", ord("\t")])


@FUNCTION_SCOPED
@given(changes=st.lists(st.tuples(st.integers(67, len(LOG)), BYTES, st.booleans()), max_size=3))
def test_any_log_is_read_or_refused_alike(
    tmp_path: Path, by_loops: Callable[[bool], None], changes: list[tuple[int, int, bool]]
) -> None:
    content = changed(LOG, changes)
    path = tmp_path / "log.csv"
    path.write_bytes(content)
    found = []
    for on in (False, True):
        by_loops(on)
        found.append(outcome(lambda: read_log(path, DESIGN)))
    assert found[0] == found[1]


def changed(text: str, changes: list[tuple[int, int, bool]]) -> bytes:
    """A text with bytes changed or put in."""
    content = bytearray(text.encode())
    for place, byte, instead in changes:
        at = min(place, len(content))
        content[at : at + instead] = bytes([byte])
    return bytes(content)


@pytest.fixture(scope="module")
def vectors(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """Vectors with times of a narrow and a wide design, as text."""
    texts = {}
    for design in (DESIGN, HG4930):
        counts = np.random.default_rng(6).integers(-(2**23), 2**23, (60, 6))
        block = FastModel(design).feed(counts)
        path = tmp_path_factory.mktemp("vectors") / "v.csv"
        with VectorsWriter(path, design.columns) as writer:
            writer.write(type(block)(block.major, block.status, block.components, block.major / 7))
        lines = path.read_text().splitlines()
        texts[design.name] = "\n".join([*lines[:4], ""])
    return texts


@FUNCTION_SCOPED
@given(
    wide=st.booleans(),
    changes=st.lists(st.tuples(st.integers(0, 2000), BYTES, st.booleans()), max_size=3),
)
def test_any_vectors_are_read_or_refused_alike(
    tmp_path: Path,
    vectors: dict[str, str],
    by_loops: Callable[[bool], None],
    wide: bool,
    changes: list[tuple[int, int, bool]],
) -> None:
    design = HG4930 if wide else DESIGN
    text = vectors[design.name]
    head = text.index("\n") + 1
    body = [(head + place % (len(text) - head), byte, instead) for place, byte, instead in changes]
    path = tmp_path / "v.csv"
    path.write_bytes(changed(text, body))

    def read(reader: Design | None) -> Any:
        for block in read_vectors(path, reader):
            yield block.major, block.status, block.components, block.times

    for reader in (design, None):
        found = []
        for on in (False, True):
            by_loops(on)
            found.append(outcome(lambda reader=reader: read(reader)))  # type: ignore[misc]
        assert found[0] == found[1]


FOREIGN = "\n".join(
    [
        '1403636579758555392,0.25,-1e-3,"a",7.5',
        "1403636579763555392, 0.5 ,12345.678901234567,b,8",
        "-17,3,4,,0.000125",
        "",
    ]
)


@FUNCTION_SCOPED
@given(
    changes=st.lists(
        st.tuples(st.integers(0, len(FOREIGN)), BYTES | st.sampled_from([*b'#";']), st.booleans()),
        max_size=3,
    ),
    quoted=st.booleans(),
    exact=st.booleans(),
)
def test_any_foreign_text_is_read_or_refused_alike(
    tmp_path: Path,
    by_loops: Callable[[bool], None],
    changes: list[tuple[int, int, bool]],
    quoted: bool,
    exact: bool,
) -> None:
    path = tmp_path / "foreign.csv"
    path.write_bytes(changed(FOREIGN if quoted else FOREIGN.replace('"', ""), changes))
    columns = [Column("x", 1), Column("y", 2), Column("t", 4)]

    def read() -> Any:
        with open_text(path) as file:
            told = columns[2] if exact else None
            whole = [Column("n", 0)]
            yield from number_rows(file, path, 1, columns, ",", lambda _: None, whole, exact=told)

    found = []
    for on in (False, True):
        by_loops(on)
        found.append(outcome(read))
    assert found[0] == found[1]


def test_states_and_truths_are_the_same(tmp_path: Path, by_loops: Callable[[bool], None]) -> None:
    states = MOTIONS["coning"].make(0.8, 0.2, 500.0).state(np.arange(300) / 50)
    texts, truths = [], []
    for on in (False, True):
        by_loops(on)
        path = tmp_path / f"truth{on}.csv"
        with HistoryWriter(path, wander=True) as writer:
            writer.write(states)
        texts.append(path.read_bytes())
        truths.append(NavHistory.concatenate([*read_truth(path)]))
    assert texts[0] == texts[1]
    for one, other in zip(vars(truths[0]).values(), vars(truths[1]).values(), strict=True):
        assert np.array_equal(one, other)


@pytest.mark.parametrize("origin", [0.0, 1000.0, 1403636579.0, -1403636579.0])
@pytest.mark.parametrize("first", [0.0, 2.5e-5, 0.0005, 1 / 3, 2.0**-10 + 2.0**-31, 1e15])
def test_logs_with_stamps_are_written_alike(
    tmp_path: Path, by_loops: Callable[[bool], None], origin: float, first: float
) -> None:
    times = first + np.arange(50) / 2000
    counts = np.random.default_rng(1).integers(-(2**31), 2**31, (50, 6))
    texts = []
    for on in (False, True):
        by_loops(on)
        path = tmp_path / f"log{on}.csv"
        with LogWriter(path, faults=True, times=True) as writer:
            writer.write(counts, None, times, origin)
        texts.append(path.read_bytes())
    assert texts[0] == texts[1]
    assert b"e" not in texts[0].split(b"\n", 1)[1]
