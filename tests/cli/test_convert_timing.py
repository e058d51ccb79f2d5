"""`convert`: gaps, unequal steps, part of a log; biases, misalignment and mounting."""

from __future__ import annotations

import json
import tracemalloc
from collections.abc import Callable
from math import atan2, cos, pi, sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.io

from sculler.formats.log import read_log
from sculler.readers.mounting import Mounting, parse_axes
from sculler_model.design import Design
from sculler_model.errors import InputError

Run = Callable[..., Any]
Refused = Callable[..., str]

HEAD = "t,gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z"
STAMPED = ("--time-column", "t")
INCREMENTS = (*STAMPED, "--gyro-unit", "rad", "--accel-unit", "m/s")
RATES = (*STAMPED, "--gyro-unit", "rad/s", "--accel-unit", "m/s2")

# The small design of conftest: 1 kHz, gyro LSB 1e-6 rad, accelerometer LSB 1e-4 m/s.


def write(tmp_path: Path, times: Any, values: Any, head: str = HEAD) -> Path:
    """A log of seven or more columns: stamps in ms turned to s, and values."""
    path = tmp_path / "in.csv"
    rows = [
        ",".join([f"{1e-3 * t:.9f}", *map(repr, row)])
        for t, row in zip(times, np.asarray(values, float).tolist(), strict=True)
    ]
    path.write_text("\n".join([head, *rows]) + "\n")
    return path


@pytest.fixture
def convert(run: Run, tmp_path: Path, design: Path) -> Callable[..., tuple[Any, Any, Any]]:
    def convert(log: Path, *options: object) -> tuple[Any, Any, Any]:
        out = tmp_path / "out.csv"
        outcome = run("convert", log, "-o", out, "--design", design, "--json", *options)
        assert outcome.status == 0, outcome.err
        chunks = list(read_log(out, Design.load(design)))
        flags = [chunk.faults for chunk in chunks if chunk.faults is not None]
        counts = np.concatenate([chunk.counts for chunk in chunks])
        return json.loads(outcome.out), counts, np.concatenate(flags) if flags else None

    return convert


def ramp(values: Any) -> list[list[float]]:
    """Gyro x as given, in counts of 1e-6; the rest zero."""
    return [[1e-6 * v, 0, 0, 0, 0, 0] for v in values]


GAPPED = (0, 1, 2, 5, 6, 7, 8, 20)


def test_gaps_are_refused_unless_asked(tmp_path: Path, refused: Refused, design: Path) -> None:
    log = write(tmp_path, GAPPED, ramp(range(8)))
    words = ("convert", log, "-o", tmp_path / "o.csv", "--design", design, *INCREMENTS)
    line = refused(*words)
    assert "sample 3: a gap of 0.003 s after 0.002000 s (2 samples missing)" in line
    assert "--gaps bridge" in line
    line = refused(*words, "--gaps", "bridge", "--max-gap", "0.004")
    assert "sample 7: a gap of 0.012 s" in line
    assert "longer than --max-gap 0.004" in line
    assert "--max-gap goes with --gaps bridge" in refused(*words, "--max-gap", 1)


def test_gaps_ignored_are_told(tmp_path: Path, convert: Run) -> None:
    said, counts, faults = convert(
        write(tmp_path, GAPPED, ramp(range(8))), *INCREMENTS, "--gaps", "ignore"
    )
    assert counts[:, 0].tolist() == list(range(8))
    assert faults is None
    assert said["timing"]["gap_count"] == 2
    assert said["timing"]["missing_samples"] == 13


def test_bridge_of_increments(tmp_path: Path, convert: Run) -> None:
    """Increments from 20 to 80 over a gap of two samples: 40 and 60, and the faults say so."""
    values = [10, 20, 80, 10, 0, 130]
    said, counts, faults = convert(
        write(tmp_path, (0, 1, 4, 5, 6, 20), ramp(values)), *INCREMENTS, "--gaps", "bridge"
    )
    assert counts[:7, 0].tolist() == [10, 20, 40, 60, 80, 10, 0]
    assert counts[7:20, 0] == pytest.approx(np.arange(1, 14) * 130 / 14, abs=1)
    # straight from 0 to 130: 13 samples of 65 in the mean; the total is kept to half a count
    assert counts[7:20, 0].sum() == pytest.approx(13 * 65, abs=1)
    assert faults.tolist() == [0, 0, 1, 1, 0, 0, 0, *[1] * 13, 0]
    gaps = said["timing"]["gaps"]
    assert [(gap["sample"], gap["missing"]) for gap in gaps] == [(2, 2), (5, 13)]
    assert [gap["time"] for gap in gaps] == pytest.approx([0.001, 0.006])
    assert [gap["seconds"] for gap in gaps] == pytest.approx([0.003, 0.014])
    assert said["timing"]["rate_hz"] == pytest.approx(1000)


def test_bridge_of_rates(tmp_path: Path, convert: Run) -> None:
    """Rates 0.01 t (t in ms) with three missing: the bridge is the line itself, so exact."""
    times = [0, 1, 2, 3, 7, 8, 9]
    said, counts, faults = convert(
        write(tmp_path, times, ramp([1000 * 10 * t for t in times])), *RATES, "--gaps", "bridge"
    )
    assert counts[:, 0].tolist() == [10 * k + 5 for k in range(9)]  # ∫ over each millisecond
    # the intervals that a made-up rate bounds
    assert faults.tolist() == [0, 0, 0, 1, 1, 1, 1, 0, 0]
    assert said["timing"]["missing_samples"] == 3


def test_bridges_reach_the_status(run: Run, tmp_path: Path, design: Path) -> None:
    """Status bit 1 of the major interval (six samples) in which the bridge lies, of no other."""
    times = [t for t in range(24) if t not in (8, 9)]
    log, out, vectors = write(tmp_path, times, ramp([5] * 22)), tmp_path / "o.csv", tmp_path / "v"
    words = ("convert", log, "-o", out, "--design", design, *INCREMENTS, "--gaps", "bridge")
    assert run(*words).status == 0
    assert run("model", design, out, "-o", vectors).status == 0
    rows = [row.split(",") for row in vectors.read_text().splitlines()[1:]]
    assert [int(row[1]) & 2 for row in rows] == [0, 2, 0, 0]


@pytest.mark.parametrize("chunk", [3, 4, 5, 1000])
def test_chunks_do_not_matter(
    tmp_path: Path, convert: Run, chunk: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A gap between chunks, of every kind of treatment."""
    rng = np.random.default_rng(6)
    times = np.array(sorted(set(range(60)) - {4, 5, 11, 30, 31, 32}), float)
    times[1:] += rng.uniform(-0.2, 0.2, len(times) - 1)
    values = np.hstack(
        [rng.integers(-400, 400, (len(times), 3)) * 1e-6, rng.uniform(-0.1, 0.1, (len(times), 3))]
    )
    log = write(tmp_path, times, values)
    options = (*INCREMENTS, "--gaps", "bridge", "--steps", "resample")
    said, counts, faults = convert(log, *options)
    monkeypatch.setattr("sculler.readers.text._CHUNK_ROWS", chunk)
    again, counts_again, faults_again = convert(log, *options)
    assert np.array_equal(counts, counts_again)
    assert np.array_equal(faults, faults_again)
    assert again["timing"]["gaps"] == said["timing"]["gaps"]


def test_jitter_is_taken_as_even_unless_resampled(tmp_path: Path, convert: Run) -> None:
    """Whole counts a sample: even passes them, resampling keeps their total to half a count."""
    rng = np.random.default_rng(7)
    times = np.arange(500.0)
    times[1:-1] += rng.uniform(-0.2, 0.2, 498)
    values = np.hstack([rng.integers(-900, 900, (500, 3)) * 1e-6, np.zeros((500, 3))])
    log = write(tmp_path, times, values)
    said, counts, _ = convert(log, *INCREMENTS)
    assert np.array_equal(counts[:, :3], np.rint(values[:, :3] / 1e-6))
    assert said["timing"]["unequal_steps"] > 400
    assert said["warnings"] == [hint for hint in said["warnings"] if "specific force" in hint]
    said, counts, faults = convert(log, *INCREMENTS, "--steps", "resample")
    assert len(counts) == 500
    assert not np.array_equal(counts[:, :3], np.rint(values[:, :3] / 1e-6))
    assert np.array_equal(counts[:, :3].sum(axis=0), np.rint(values[:, :3].sum(axis=0) / 1e-6))
    assert faults is None
    assert said["timing"]["left_out_s"] == pytest.approx(0, abs=1e-9)


def test_resampled_rates_of_a_jittered_sine(tmp_path: Path, convert: Run, design: Path) -> None:
    """sin at 5 Hz with true but uneven stamps: its integral over every even millisecond."""
    rng = np.random.default_rng(8)
    times = np.arange(300.0)
    times[1:-1] += rng.uniform(-0.2, 0.2, 298)
    omega = 2 * pi * 5e-3  # per ms
    values = [[10 * sin(omega * t), 0, 0, 0, 0, 0] for t in times]
    _, counts, _ = convert(write(tmp_path, times, values), *RATES, "--steps", "resample")
    grid = np.arange(300.0)
    angle = -10 / omega * np.cos(omega * grid) * 1e-3 / 1e-6
    total = np.cumsum(counts[:, 0])
    assert np.abs(total - (angle[1:] - angle[0])).max() < 0.6  # half a count, and the cubics


def test_a_clock_that_is_off_is_told(tmp_path: Path, convert: Run) -> None:
    log = write(tmp_path, np.arange(5000) * 1.001, ramp([5] * 5000))
    said, counts, _ = convert(log, *INCREMENTS)
    assert len(counts) == 5000
    assert any("999.000999 Hz, -999 ppm" in warning for warning in said["warnings"])
    said, counts, _ = convert(log, *INCREMENTS, "--steps", "resample")
    assert len(counts) == 1 + 5003  # the first of 1 ms, and 4999 steps of 1.001 ms
    assert not any("ppm" in warning for warning in said["warnings"])


@pytest.mark.parametrize(("kind", "rows"), [("rad", [11, 12, 13]), ("rad/s", [10, 11, 12, 13])])
def test_start_and_stop(tmp_path: Path, convert: Run, kind: str, rows: list[int]) -> None:
    """From 10 ms to 13 ms: three increments, or the four rates that bound three intervals."""
    log = write(tmp_path, range(20), ramp([100 * k if kind == "rad" else 0 for k in range(20)]))
    force = "m/s" if kind == "rad" else "m/s2"
    words = (*STAMPED, "--gyro-unit", kind, "--accel-unit", force, "--start", 0.01, "--stop", 0.013)
    said, counts, _ = convert(log, *words)
    assert len(counts) == 3
    assert said["timing"]["samples_read"] == len(rows)
    assert said["timing"]["start_s"] == pytest.approx(rows[0] * 1e-3)
    if kind == "rad":
        assert counts[:, 0].tolist() == [1100, 1200, 1300]


@pytest.mark.parametrize("chunk", [2, 1000])
def test_a_gap_before_the_start_is_nobodys(
    tmp_path: Path, convert: Run, chunk: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sculler.readers.text._CHUNK_ROWS", chunk)
    log = write(tmp_path, (0, 1, 10, 11, 12), ramp([5] * 5))
    said, counts, _ = convert(log, *INCREMENTS, "--start", 0.009)
    assert len(counts) == 3
    assert said["timing"]["gap_count"] == 0


def test_bridge_of_counts(tmp_path: Path, convert: Run) -> None:
    """Counts stay as they are; those of the bridge are rounded, the remainder carried."""
    times = (0, 1, 2, 5, 6)
    log = write(tmp_path, times, [[value, 0, 0, 0, 0, 0] for value in (3, 4, 4, 5, -7)])
    units = (*STAMPED, "--gyro-unit", "counts", "--accel-unit", "counts")
    said, counts, faults = convert(log, *units, "--gaps", "bridge")
    assert counts[:, 0].tolist() == [3, 4, 4, 4, 5, 5, -7]  # 4⅓ and 4⅔
    assert faults.tolist() == [0, 0, 0, 1, 1, 0, 0]
    assert not said["sensors"]["gyro"]["unchanged"]


NEEDS = "need time stamps, give --time-column"
OPTION_FAULTS: dict[str, tuple[tuple[object, ...], str]] = {
    "bridge without stamps": (("--gaps", "bridge"), NEEDS),
    "resample without stamps": (("--steps", "resample"), NEEDS),
    "start without stamps": (("--start", 1), NEEDS),
    "nothing between": ((*STAMPED, "--start", 5), "or none from --start to --stop"),
    "mean resampled": (
        (*STAMPED, "--gyro-unit", "rad/s", "--accel-unit", "m/s2", "--rates", "mean", "--steps",
         "resample"),
        "--steps resample takes rates at instants",
    ),
    "one of each": (("--gyro-unit", "rad/s"), "cannot be integrated alike, give --rates mean"),
    "bias of words": (("--gyro-bias", "a,b,c"), '--gyro-bias: "a,b,c" is not allowed'),
    "bias of two": (("--gyro-bias", "1,2"), "give three numbers and a unit"),
    "bias of nan": (("--accel-bias", "1,2,nan"), "give three numbers and a unit"),
    "bias in another unit": (("--accel-bias", "1,2,3 rad/s"), "one of m/s2, g, mg, ug"),
    "name outside MAT": (("--gyro-bias", "eb0"), '--gyro-bias: "eb0" is not allowed'),
    "misalignment in m": (("--misalignment", "1,2,3 m"), "one of rad, mrad, deg, arcmin, arcsec"),
    "two on a line": (("--axes", "FBU"), "two axes on one line"),
    "left-handed": (("--axes", "FRU"), '"FRU" is a mirror image (left-handed)'),
    "left-handed map": (("--axes", "y,x,z"), "is a mirror image, not a rotation"),
    "no axes": (("--axes", "RFQ"), 'axes: "RFQ" is not allowed'),
}  # fmt: skip


@pytest.mark.parametrize("case", OPTION_FAULTS)
def test_option_faults(tmp_path: Path, refused: Refused, design: Path, case: str) -> None:
    options, message = OPTION_FAULTS[case]
    log = write(tmp_path, range(9), ramp([5] * 9))
    units: tuple[object, ...] = ("--gyro-unit", "rad", "--accel-unit", "m/s")
    words = ("convert", log, "-o", tmp_path / "o.csv", "--design", design, *units, *options)
    assert message in refused(*words)


# Mounting: where each axis of the sensor points, and what comes out of (1, 2, 3).
@pytest.mark.parametrize(
    ("axes", "expected"),
    [
        ("FRD", [1, 2, 3]),
        ("RFU", [2, 1, -3]),
        ("frd", [1, 2, 3]),
        ("FLU", [1, -2, -3]),
        ("BRU", [-1, 2, -3]),
        ("DFR", [2, 3, 1]),
        ("z,x,y", [3, 1, 2]),
        ("-y,x,z", [-2, 1, 3]),
    ],
)
def test_axes(axes: str, expected: list[int]) -> None:
    vector = np.array([[1.0, 2.0, 3.0]])
    mounting = Mounting.parse(axes, (0.0, 0.0, 0.0))
    assert mounting.apply(vector).tolist() == [expected]
    assert (mounting.matrix @ vector[0]).tolist() == expected
    assert np.linalg.det(mounting.matrix) == pytest.approx(1)


def test_every_triple_of_directions_is_a_rotation_or_refused() -> None:
    good = 0
    for letters in (a + b + c for a in "FBRLUD" for b in "FBRLUD" for c in "FBRLUD"):
        try:
            parse_axes(letters)
            good += 1
        except InputError:
            continue
    assert good == 24  # the rotations of a cube


def test_misalignment_turns_by_the_rotation_vector(tmp_path: Path, convert: Run) -> None:
    """A turn of 30° about z, then the axes: (1, 0, 0) becomes (cos, sin, 0)."""
    log = write(tmp_path, range(3), [[1e-3, 0, 0, 0.05, 0, 0]] * 3)
    said, counts, _ = convert(log, *INCREMENTS, "--misalignment", "0,0,30 deg")
    total = counts.sum(axis=0)
    expected = [3000 * cos(pi / 6), 3000 * sin(pi / 6), 0, 1500 * cos(pi / 6), 1500 * sin(pi / 6)]
    assert total[:5] == pytest.approx(expected, abs=0.6)
    assert said["misalignment"] == pytest.approx([0, 0, pi / 6])
    cosines = [[float(c) for c in row["cosines"].split()] for row in said["mounting"]]
    assert atan2(cosines[1][0], cosines[0][0]) == pytest.approx(pi / 6, abs=1e-6)
    _, counts, _ = convert(log, *INCREMENTS, "--misalignment", "0,0,30 deg", "--axes", "y,-x,z")
    assert counts.sum(axis=0)[:2] == pytest.approx([expected[1], -expected[0]], abs=0.6)


@pytest.mark.parametrize(
    ("gyro", "accel"),
    [("1e-3,-2e-3,0", "0.1,0,-0.2"), ("206.264806,-412.529612,0 deg/h", "0.1,0,-0.2 m/s2")],
)
def test_biases_are_taken_off(tmp_path: Path, convert: Run, gyro: str, accel: str) -> None:
    """1000 samples of 1 ms with nothing but the bias in them leave nothing but its opposite."""
    log = write(tmp_path, range(1000), np.zeros((1000, 6)))
    said, counts, _ = convert(log, *INCREMENTS, "--gyro-bias", gyro, "--accel-bias", accel)
    # 206.264806 °/h are 1e-3 rad/s
    assert counts.sum(axis=0)[:3] * 1e-6 == pytest.approx([-1e-3, 2e-3, 0], abs=6e-7)
    assert counts.sum(axis=0)[3:] * 1e-4 == pytest.approx([-0.1, 0, 0.2], abs=6e-5)
    assert not said["sensors"]["gyro"]["unchanged"]


def test_vectors_of_a_mat_file(
    tmp_path: Path, convert: Run, refused: Refused, design: Path
) -> None:
    log = tmp_path / "in.mat"
    scipy.io.savemat(
        log, {"imu": np.zeros((1000, 6)), "eb": [[1e-3], [0], [0]], "four": np.ones(4)}
    )
    units = ("--gyro-unit", "rad", "--accel-unit", "m/s", "--variable", "imu")
    said, counts, _ = convert(log, *units, "--gyro-bias", "eb")
    assert counts[:, 0].sum() == -1000
    assert said["biases"]["gyro"] == pytest.approx([1e-3, 0, 0])
    words = ("convert", log, "-o", tmp_path / "no.csv", "--design", design, *units)
    assert "four is not a vector of three" in refused(*words, "--gyro-bias", "four")
    assert "no variable 'five'" in refused(*words, "--misalignment", "five")


def test_wrong_units_are_hinted_at(tmp_path: Path, convert: Run) -> None:
    """1 g given as 1 m/s², and 25 rad/s."""
    log = write(tmp_path, range(5), [[25, 0, 0, 0, 0, 1]] * 5)
    said, _, _ = convert(log, *RATES)
    force, rate = said["warnings"]
    assert "mean specific force is 1 m/s²" in force
    assert "(g taken for m/s²?)" in force
    assert "mean angular rate is 25 rad/s, more than vehicles turn" in rate
    good = write(tmp_path, range(5), [[0.1, 0, 0, 0, 0, -9.8]] * 5)
    assert convert(good, *RATES)[0]["warnings"] == []


def test_a_table_of_gaps(run: Run, tmp_path: Path, design: Path) -> None:
    times = [3 * k for k in range(40)]
    words = ("convert", write(tmp_path, [0, 1, 2, 3, *np.add(times, 6)], ramp([5] * 44)))
    outcome = run(
        *words, "-o", tmp_path / "o.csv", "--design", design, *INCREMENTS, "--gaps", "bridge"
    )
    assert outcome.status == 2  # the usual step is the gap's: another rate
    assert "the time column shows 349.593 Hz" in outcome.err  # 43 steps in 123 ms
    log = write(tmp_path, [t for t in range(200) if t % 5], ramp([5] * 160))
    outcome = run(
        *("convert", log, "-o", tmp_path / "o.csv", "--design", design, *INCREMENTS),
        *("--gaps", "bridge"),
    )
    assert outcome.status == 0
    assert "39 gaps, 39 samples missing, bridged" in outcome.out
    assert "and 19 more" in outcome.out


def test_memory_does_not_grow_with_the_log(
    run: Run, tmp_path: Path, design: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Everything at once, on a log and on one eight times as long."""
    monkeypatch.setattr("sculler.readers.text._CHUNK_ROWS", 256)
    monkeypatch.setattr("sculler_model.samples.plausibility.BLOCK", 256)
    monkeypatch.setattr("sculler_model.samples.plausibility._KEPT", 256)
    words = ("--design", design, *RATES, "--gaps", "bridge", "--steps", "resample", "--json")

    def peak(rows: int) -> int:
        times = np.arange(rows) * 1.0001
        log = write(tmp_path, np.delete(times, slice(100, 103)), np.full((rows - 3, 6), 0.01))
        tracemalloc.start()
        try:
            outcome = run("convert", log, "-o", tmp_path / "out.csv", *words)
            assert outcome.status == 0, outcome.err
            return tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()

    peak(2000)  # what is imported and cached on the first run
    assert peak(16_000) < 1.2 * peak(2000)
