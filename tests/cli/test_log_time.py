"""The log's own clock through `convert`, `model` and `simulate` to the vectors."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sculler.formats.log import LogWriter, read_log
from sculler.formats.vectors import read_vectors
from sculler_model.design import Design

Run = Callable[..., Any]

H = 1e-3  # s, the sample interval of conftest's little design; a major interval has six samples


def stamped(path: Path, times: Any, counts: Any = None) -> Path:
    """A log of the given stamps, s."""
    times = np.asarray(times, float)
    if counts is None:
        counts = np.random.default_rng(4).integers(-2000, 2000, (len(times), 6))
    with LogWriter(path, times=True) as writer:
        writer.write(counts, times=times)
    return path


def ends(path: Path) -> list[float]:
    return [time for block in read_vectors(path) for time in block.times]


@pytest.mark.parametrize(
    ("verb", "options"),
    [
        ("model", ()),
        ("model", ("--engine", "reference")),
        ("simulate", ()),
        ("simulate", ("--stall", 3)),
        ("simulate", ("--engine", "amaranth", "--stall", 5)),
    ],
)
def test_an_interval_ends_at_the_stamp_of_its_last_sample(
    run: Run, tmp_path: Path, design: Path, verb: str, options: tuple[object, ...]
) -> None:
    times = 1403636579.763555527 + H * np.arange(1, 28)
    log, out = stamped(tmp_path / "log.csv", times), tmp_path / "v.csv"
    outcome = run(verb, design, log, "-o", out, *options)
    assert outcome.status == 0, outcome.err
    assert ends(out) == [times[5], times[11], times[17], times[23]]


def test_each_result_keeps_its_own_end_where_the_core_drops_others(
    run: Run, tmp_path: Path, design: Path
) -> None:
    text = design.read_text() + ("" if "[hardware]" in design.read_text() else "\n[hardware]\n")
    design.write_text(text.replace("[hardware]", '[hardware]\noverrun = "drop-result"'))
    times = 4000.5 + H * np.arange(1, 3001)
    log, out = stamped(tmp_path / "log.csv", times), tmp_path / "v.csv"
    assert run("simulate", design, log, "-o", out, "--stall", 1).status == 0
    (block,) = read_vectors(out, Design.load(design))
    assert 0 < len(block) < 500  # of 500 intervals some were dropped
    assert block.times.tolist() == times[6 * block.major + 5].tolist()


def test_ends_do_not_depend_on_chunks(
    run: Run, tmp_path: Path, design: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    times = 7 + H * np.arange(1, 201)
    log, out = stamped(tmp_path / "log.csv", times), tmp_path / "v.csv"
    for size in (150, 311, 1 << 18):
        monkeypatch.setattr("sculler.formats.lines.BLOCK_BYTES", size)
        for verb in ("model", "simulate"):
            assert run(verb, design, log, "-o", out).status == 0
            assert ends(out) == times[5::6].tolist()


def test_without_stamps_the_vectors_are_as_before(
    run: Run, tmp_path: Path, design: Path, log: Path
) -> None:
    """The same bytes but for the last column; `compare` takes no missing column for one."""
    counts = np.concatenate([chunk.counts for chunk in read_log(log, Design.load(design))])
    with_times = stamped(tmp_path / "t.csv", H * np.arange(1, len(counts) + 1), counts)
    plain, timed = tmp_path / "plain.csv", tmp_path / "timed.csv"
    assert run("model", design, log, "-o", plain).status == 0
    assert run("simulate", design, with_times, "-o", timed).status == 0
    lines = [line.rpartition(",") for line in timed.read_text().splitlines()]
    assert lines[0][2] == "time_s"
    assert [line[0] for line in lines] == plain.read_text().splitlines()
    assert run("compare", plain, timed).status == 0


def test_too_few_samples_for_a_result_still_tell_that_there_are_stamps(
    run: Run, tmp_path: Path, design: Path
) -> None:
    log, out = stamped(tmp_path / "log.csv", [0.001, 0.002]), tmp_path / "v.csv"
    assert run("model", design, log, "-o", out).status == 0
    assert out.read_text().endswith(",time_s\n")


def recording(path: Path, times: Any, values: Any) -> Path:
    rows = [
        f"{t:.6f}," + ",".join(map(repr, row))
        for t, row in zip(times, np.asarray(values, float).tolist(), strict=True)
    ]
    path.write_text("\n".join(["t,gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z", *rows]) + "\n")
    return path


JITTER = np.array([0, 0.1, -0.2, 0.2, 0, 0.2, -0.1, 0, 0.1, 0])
STAMPS = np.round(12.5 + H * (np.arange(10) + JITTER), 6)


@pytest.mark.parametrize(
    ("units", "options", "wanted"),
    [
        # increments: each ends at its stamp
        (("rad", "m/s"), (), STAMPS),
        # rates integrated: the first increment ends at the second stamp
        (("rad/s", "m/s2"), (), STAMPS[1:]),
        # rates that are means over the interval before their stamp
        (("rad/s", "m/s2"), ("--rates", "mean"), STAMPS),
        # the grid begins one interval before the first increment ends, or at the first rate
        (("rad", "m/s"), ("--steps", "resample"), 12.5 + H * np.arange(10)),
        (("rad/s", "m/s2"), ("--steps", "resample"), 12.5 + H * np.arange(1, 10)),
    ],
)
def test_convert_keeps_the_stamps(
    run: Run,
    tmp_path: Path,
    design: Path,
    units: tuple[str, str],
    options: tuple[str, ...],
    wanted: Any,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    log = recording(tmp_path / "in.csv", STAMPS, np.full((10, 6), 1e-3))
    out = tmp_path / "out.csv"
    words = ("--time-column", "t", "--gyro-unit", units[0], "--accel-unit", units[1], *options)
    for rows in (1000, 3):
        monkeypatch.setattr("sculler.readers.text._CHUNK_ROWS", rows)
        outcome = run("convert", log, "-o", out, "--design", design, *words)
        assert outcome.status == 0, outcome.err
        found = [time for chunk in read_log(out, Design.load(design)) for time in chunk.times]
        assert found == pytest.approx(wanted.tolist(), abs=1e-12)
    without = run("convert", log, "-o", out, "--design", design, *words[2:])
    if not options or options[0] != "--steps":
        assert without.status == 0, without.err
        assert "time_s" not in out.read_text()
