"""Breaks in logs: `model` and `simulate` refuse them with their line, or begin anew alike."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sculler.formats.log import LogWriter
from sculler.formats.vectors import read_vectors
from sculler_model.design import Design
from sculler_model.golden import GoldenModel
from tiers import few_of

Run = Callable[..., Any]
Refused = Callable[..., str]

H = 1e-3  # s; conftest's little design: six samples a major interval, its first short of history
COUNTS = np.random.default_rng(8).integers(-2048, 2048, (200, 6))
ENGINES = {
    "fast": ("model",),
    "reference": ("model", "--engine", "reference"),
    "verilator": ("simulate",),
    "stalls": ("simulate", "--stall", 3),
    "amaranth": ("simulate", "--engine", "amaranth", "--stall", 4),
}


def write(path: Path, times: Any = None, sequence: Any = None) -> Path:
    """A log of the first of `COUNTS` with stamps or a counter."""
    number = len(times if times is not None else sequence)
    with LogWriter(path, times=times is not None) as writer:
        writer.write(COUNTS[:number], times=None if times is None else np.asarray(times, float))
    if sequence is not None:
        head, *rows = path.read_text().splitlines()
        lines = [f"{row},{at}" for row, at in zip(rows, sequence, strict=True)]
        path.write_text("\n".join([f"{head},sequence", *lines]) + "\n")
    return path


def golden(design: Path, *pieces: Any) -> list[tuple[int, ...]]:
    """Rows of a model that begins anew with each piece of counts."""
    rows = []
    for piece in pieces:
        samples = ((tuple(row[:3]), tuple(row[3:]), 0) for row in piece.tolist())
        rows += [result.row() for result in GoldenModel(Design.load(design)).run(samples)]
    return rows


@pytest.mark.parametrize("engine", ENGINES)
def test_split_begins_anew(run: Run, tmp_path: Path, design: Path, engine: str) -> None:
    """Two breaks, one within an interval and one at its end: each piece as a log of its own."""
    number = np.delete(np.arange(1, 140), [*range(50, 57), 100])  # pieces of 50, 43 and 38
    verb, *options = ENGINES[engine]
    out = tmp_path / "v.csv"
    log = write(tmp_path / "log.csv", times=number * H)
    outcome = run(verb, design, log, "-o", out, *options, "--breaks", "split", "--json")
    assert outcome.status == 0, outcome.err
    said = json.loads(outcome.out)
    blocks = list(read_vectors(out))
    pieces = COUNTS[:50], COUNTS[50:93], COUNTS[93 : len(number)]
    assert [row for block in blocks for row in block.rows()] == golden(design, *pieces)
    ends = [time for block in blocks for time in block.times]
    wanted = [
        number[a + k] * H for a, b in ((0, 50), (50, 93), (93, 131)) for k in range(5, b - a, 6)
    ]
    assert ends == wanted
    assert said["break_count"] == 2
    assert [each["line"] for each in said["breaks"]] == [52, 95]
    assert [each["missing"] for each in said["breaks"]] == [7, 1]
    assert said["leftover_samples"] == 50 % 6 + 43 % 6 + 38 % 6
    assert said["short_history_results"] == 3
    assert said["samples"] == 131
    assert said["warnings"][0].startswith("line 52: time_s goes from 0.05 to 0.058 where the inter")


@pytest.mark.parametrize("block", few_of([200, 1 << 18], [200]))
def test_all_engines_agree(
    run: Run, tmp_path: Path, design: Path, block: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sculler.formats.lines.BLOCK_BYTES", block)
    number = np.delete(np.arange(200), [3, 4, 80, 96, 97, 150])
    log = write(tmp_path / "log.csv", times=number * H, sequence=number % 256)
    vectors = []
    for name, (verb, *options) in ENGINES.items():
        vectors.append(tmp_path / f"{name}.csv")
        words = (verb, design, log, "-o", vectors[-1], *options, "--breaks", "split")
        assert run(*words).status == 0
    assert len({path.read_bytes() for path in vectors}) == 1
    assert run("compare", vectors[0], vectors[-1]).status == 0
    assert [row[0] for b in read_vectors(vectors[0]) for row in b.rows()].count(0) == 4


@pytest.mark.parametrize(
    ("times", "line"),
    [
        (np.delete(np.arange(60), 20) * H, "line 22: time_s goes from 0.019 to 0.021 where the"),
        (np.delete(np.arange(60), 20) * H, "interval is 0.001 s, 1 sample is missing; give"),
        (np.delete(np.arange(60), [1, 2]) * H, "line 3: time_s goes from 0 to 0.003"),
        (np.insert(np.arange(60), 30, 29) * H, "line 32: time_s repeats the stamp before (0.029)"),
        (np.arange(60) * H - 9 * (np.arange(60) > 40), "line 43: time_s goes back from 0.04 to "),
        (np.arange(60) * 2 * H, "time_s shows 500 Hz but sensor.sample_rate_hz = 1000"),
    ],
)  # fmt: skip
def test_breaks_are_refused(
    tmp_path: Path, refused: Refused, design: Path, times: Any, line: str
) -> None:
    log = write(tmp_path / "log.csv", times=times)
    for verb in ("model", "simulate"):
        told = refused(verb, design, log, "-o", tmp_path / "v.csv")
        assert str(log) in told
        assert line in told


@pytest.mark.parametrize("gone", [[20], [5, 6, 7], [58]])
def test_a_counter_that_jumps_is_refused(
    tmp_path: Path, refused: Refused, design: Path, gone: list[int]
) -> None:
    log = write(tmp_path / "log.csv", sequence=np.delete(np.arange(100, 160), gone))
    told = refused("model", design, log, "-o", tmp_path / "v.csv")
    before = 99 + gone[0]
    assert f"line {gone[0] + 2}: sequence goes from {before} to {before + len(gone) + 1}" in told
    assert f"{len(gone)} sample" in told


@pytest.mark.parametrize(
    ("first", "modulus", "lowest", "bits"),
    [
        (250, 256, 0, 8),
        (100, 256, -128, 8),
        (65530, 65536, 0, 16),
        (32760, 65536, -32768, 16),
        (2**32 - 9, 2**32, 0, 32),
        (2**31 - 9, 2**32, -(2**31), 32),
    ],
)
def test_a_counter_may_wrap(
    run: Run, tmp_path: Path, design: Path, first: int, modulus: int, lowest: int, bits: int
) -> None:
    sequence = (first + np.arange(60) - lowest) % modulus + lowest
    log, out = write(tmp_path / "log.csv", sequence=sequence), tmp_path / "v.csv"
    outcome = run("model", design, log, "-o", out, "--json")
    assert outcome.status == 0, outcome.err
    assert json.loads(outcome.out)["sequence_wraps"] == {f"{bits} bits": 1}
    assert f"a counter of {bits} bits, wrapped 1 time" in run("model", design, log, "-o", out).out


@pytest.mark.parametrize(
    "sequence",
    [
        [254, 255, 1, 2],  # a wrap and a lost sample
        [5, 5, 6, 7],
        [7, 6, 5, 4],
        [999, 0, 1, 2],  # no counter ends there
        [65534, 65535, -32768, -32767],
    ],
)
def test_what_is_no_wrap_is_a_break(
    tmp_path: Path, refused: Refused, design: Path, sequence: list[int]
) -> None:
    log = write(tmp_path / "log.csv", sequence=sequence)
    assert "sequence goes from" in refused("model", design, log, "-o", tmp_path / "v.csv")


def test_jitter_is_no_break(run: Run, tmp_path: Path, design: Path) -> None:
    jitter = np.random.default_rng(1).normal(0, 0.25, 200)
    times = np.sort(np.arange(200) + jitter) * H
    times[50:53] = 0.0535, 0.053501, 0.053502  # late, then in time again
    log, plain = write(tmp_path / "log.csv", times=times), tmp_path / "v.csv"
    assert run("model", design, log, "-o", plain).status == 0
    assert [row[:2] for b in read_vectors(plain) for row in b.rows()][1:] == [
        (at, 0) for at in range(1, 33)
    ]


def test_stamps_and_counter_of_one_break_are_told_once(
    run: Run, tmp_path: Path, design: Path
) -> None:
    jitter = np.random.default_rng(1).normal(0, 0.15, 199)
    number = np.delete(np.arange(200), 120)
    times = np.sort(number + jitter) * H
    log, out = write(tmp_path / "log.csv", times=times, sequence=number), tmp_path / "v.csv"
    outcome = run("simulate", design, log, "-o", out, "--breaks", "split", "--json")
    assert outcome.status == 0, outcome.err
    said = json.loads(outcome.out)
    assert [each["sample"] for each in said["breaks"]] == [120]
    assert said["breaks"][0]["time_s"] == times[119]


def test_a_waveform_goes_over_all_pieces(run: Run, tmp_path: Path, design: Path) -> None:
    log = write(tmp_path / "log.csv", times=np.delete(np.arange(60), 30) * H)
    out, wave = tmp_path / "v.csv", tmp_path / "w.vcd"
    words = ("simulate", design, log, "-o", out, "--breaks", "split")
    assert run(*words, "--wave", wave, "--engine", "amaranth").status == 0
    assert len(out.read_text().splitlines()) == 1 + 30 // 6 + 29 // 6
    assert wave.stat().st_size > 1000


def test_a_read_log_goes_on_streaming(run: Run, tmp_path: Path, design: Path) -> None:
    """Many breaks: those beyond the first hundred are counted."""
    number = np.delete(np.arange(200), np.arange(20, 190, 30))
    log, out = write(tmp_path / "log.csv", sequence=number), tmp_path / "v.csv"
    outcome = run("model", design, log, "-o", out, "--breaks", "split")
    assert outcome.status == 0
    assert outcome.out.count("the core began anew there") == 6
