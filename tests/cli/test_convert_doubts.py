"""`convert` on logs that one may doubt: each is said, refused with the cure, or put right.

The truth of each log is known by construction: 100 Hz, a gyro that rocks about x, gravity on z.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sculler.formats.log import read_log
from sculler_model.design import Design

Run = Callable[..., Any]
Refused = Callable[..., str]

DESIGN = """
name = "d"
[sensor]
kind = "increment"
sample_rate_hz = 100.0
gyro = { bits = 32, lsb = 1e-9 }
accel = { bits = 32, lsb = 1e-7 }
[algorithm]
family = "frequency-taylor"
samples = 2
minors = 1
"""
H = 0.01
NUMBER = np.arange(400)
ROCKING = 0.2 * np.sin(2 * np.pi * NUMBER / 100 + 0.1)
RATES = ("--gyro-unit", "rad/s", "--accel-unit", "m/s2")
INCREMENTS = ("--gyro-unit", "rad", "--accel-unit", "m/s")
COUNTS = ("--gyro-unit", "counts", "--accel-unit", "counts")
NAMES = "wx,wy,wz,ax,ay,az"
COLUMNS = ("--gyro-columns", "wx,wy,wz", "--accel-columns", "ax,ay,az")


@pytest.fixture
def d100(tmp_path: Path) -> Path:
    path = tmp_path / "d.toml"
    path.write_text(DESIGN)
    return path


def log(path: Path, stamps: list[str], values: Any = None, names: str = NAMES) -> Path:
    """A CSV of stamps as text, and six columns."""
    if values is None:
        values = np.tile([0, 0.02, -0.01, 0.1, 0.2, -9.8], (len(stamps), 1))
        values[:, 0] = ROCKING[: len(stamps)]
    rows = [
        f"{stamp}," + ",".join(f"{value:.9g}" for value in row)
        for stamp, row in zip(stamps, np.asarray(values).tolist(), strict=True)
    ]
    path.write_text("\n".join([f"t,{names}", *rows]) + "\n")
    return path


@pytest.fixture
def convert(run: Run, tmp_path: Path, d100: Path) -> Callable[..., Any]:
    """Convert; what was said, the counts, and the stamps of the log."""

    def convert(file: Path, *options: object) -> Any:
        out = tmp_path / "out.csv"
        words = ("--gyro-columns", *COLUMNS[1:]) if "--gyro-columns" not in options else ()
        stamps = () if "--time-column" in options else ("--time-column", "t")
        outcome = run("convert", file, "-o", out, "--design", d100, *words, *stamps, *options,
                      "--json")  # fmt: skip
        assert outcome.status == 0, outcome.err
        chunks = list(read_log(out, Design.load(d100)))
        times = [chunk.times for chunk in chunks if chunk.times is not None]
        said = json.loads(outcome.out)
        # what convert says is right, model must take
        assert run("model", d100, out, "-o", tmp_path / "v.csv").status == 0
        return (
            said,
            np.concatenate([chunk.counts for chunk in chunks]),
            np.concatenate(times) if times else None,
        )

    return convert


def seconds(times: Any, digits: int = 6) -> list[str]:
    return [f"{time:.{digits}f}" for time in times]


STEADY = seconds(NUMBER * H)


@pytest.fixture
def plain(convert: Run, tmp_path: Path) -> Any:
    """Counts of the log with good stamps."""
    said, counts, times = convert(log(tmp_path / "plain.csv", STEADY), *RATES)
    assert said["warnings"] == []
    assert times == pytest.approx(NUMBER[1:] * H)
    return counts


@pytest.mark.parametrize(
    ("stamps", "passed_over"),
    [
        (seconds(NUMBER // 4 * 4 * H), 300),
        (seconds(NUMBER // 2 * 2 * H + NUMBER % 2 * 5e-6), 200),
        ([f"{1.73234e9 + t:.5e}" for t in NUMBER * H], 399),
    ],
    ids=["batched", "near_dup", "six digits"],
)
def test_stamps_that_say_little_are_passed_over(
    convert: Run, tmp_path: Path, plain: Any, stamps: list[str], passed_over: int
) -> None:
    """The samples are as even as they are, and their stamps go by the sample rate."""
    said, counts, times = convert(log(tmp_path / "in.csv", stamps), *RATES)
    assert counts.tolist() == plain.tolist()
    assert said["timing"]["passed_over"] == passed_over
    (warning,) = said["warnings"]
    assert warning.startswith(f"{passed_over} stamps passed over, the first at sample 1")
    assert np.diff(times) == pytest.approx(np.full(398, H), abs=2e-6)


def test_a_repeated_stamp_costs_no_increment(
    convert: Run, tmp_path: Path, refused: Refused, d100: Path
) -> None:
    """A real sample under the stamp before: counted, kept; and all such rows are told."""
    stamps = seconds(np.insert(NUMBER, [50, 50, 200], [49, 49, 199])[:400] * H)
    values = np.tile([1e-4, 0, 0, 0, 0, -0.098], (400, 1))
    values[:, 1] = NUMBER * 1e-7
    file = log(tmp_path / "in.csv", stamps, values)
    said, counts, times = convert(file, *INCREMENTS)
    assert counts[:, 0].sum() == 400 * 100_000
    assert times == pytest.approx(NUMBER * H)
    assert said["timing"]["samples_too_many"] == 3
    assert said["timing"]["repeated_stamps"] == 3
    assert any("3 samples more than the stamps have time for" in w for w in said["warnings"])
    words = ("convert", file, "-o", tmp_path / "o.csv", "--design", d100, *COLUMNS, *INCREMENTS)
    line = refused(*words, "--time-column", "t", "--steps", "resample")
    assert "sample 50: time does not grow, it repeats the stamp before" in line
    assert "(3 such samples in all)" in line
    assert "--time-column none" in line
    said, counts, times = convert(file, *INCREMENTS, "--time-column", "none")
    assert times is None
    assert said["timing"] is None
    assert counts[:, 0].sum() == 400 * 100_000


def test_rows_written_twice_are_told(convert: Run, tmp_path: Path) -> None:
    rows = np.insert(NUMBER, 70, 69)
    values = np.tile([0, 0, 0, 0, 0, -0.098], (401, 1))
    values[:, 0] = ROCKING[rows] * H
    said, _, _ = convert(log(tmp_path / "in.csv", seconds(rows * H), values), *INCREMENTS)
    assert said["timing"]["samples_twice"] == 1
    assert any("1 sample with the stamp and the six numbers" in w for w in said["warnings"])


@pytest.mark.parametrize(
    ("stamps", "unit", "width", "what"),
    [
        (seconds((604799 + NUMBER * H) % 604800), "s", 604800, "the GPS week"),
        (seconds((86398 + NUMBER * H) % 86400), "s", 86400, "the day"),
        ([str((2**32 - 9000 + n * 10_000) % 2**32) for n in NUMBER], "us", 2**32 * 1e-6,
         "32 bits (us)"),
        ([str((65000 + n * 10) % 65536) for n in NUMBER], "ms", 65.536, "16 bits (ms)"),
        ([str((2**32 - 123 + n * 10) % 2**32) for n in NUMBER], "ms", 2**32 * 1e-3, "32 bits (ms)"),
    ],
)  # fmt: skip
def test_a_clock_that_is_full_goes_on(
    convert: Run, tmp_path: Path, plain: Any, stamps: list[str], unit: str, width: float, what: str
) -> None:
    file = log(tmp_path / "in.csv", stamps)
    said, counts, times = convert(file, *RATES, "--time-unit", unit)
    assert counts.tolist() == plain.tolist()
    assert np.diff(times) == pytest.approx(np.full(398, H), abs=1e-6)
    (rollover,) = said["timing"]["rollovers"]
    assert rollover["width"] == pytest.approx(width)
    (warning,) = said["warnings"]
    assert "time went back by" in warning
    assert what in warning


def test_a_counter_that_wraps_again_and_again(convert: Run, tmp_path: Path, plain: Any) -> None:
    """16 bits of microseconds are full six times a second; 10 ms steps are no riddle."""
    stamps = [str((n * 10_000 + 7) % 65536) for n in NUMBER]
    said, counts, _ = convert(log(tmp_path / "in.csv", stamps), *RATES, "--time-unit", "us")
    assert len(said["timing"]["rollovers"]) == 399 * 10_000 // 65536
    assert counts.tolist() == plain.tolist()


def test_a_clock_that_was_set_is_refused(tmp_path: Path, refused: Refused, d100: Path) -> None:
    file = log(tmp_path / "in.csv", seconds(NUMBER * H - 7.3 * (NUMBER >= 200)))
    words = ("convert", file, "-o", tmp_path / "o.csv", "--design", d100, *COLUMNS, *RATES)
    line = refused(*words, "--time-column", "t")
    assert "sample 200: time does not grow, it goes back by 7.29 s for good" in line
    assert "--time-column none" in line


def test_whole_milliseconds_at_800_hz(run: Run, tmp_path: Path) -> None:
    """Told as 1000 Hz once, for most steps are 1 ms."""
    design = tmp_path / "d800.toml"
    design.write_text(DESIGN.replace("100.0", "800.0"))
    file = log(tmp_path / "in.csv", [str(n * 1000 // 800) for n in NUMBER])
    words = ("convert", file, "-o", tmp_path / "o.csv", "--design", design, *COLUMNS, *RATES)
    outcome = run(*words, "--time-column", "t", "--time-unit", "ms", "--json")
    assert outcome.status == 0, outcome.err
    assert json.loads(outcome.out)["timing"]["rate_hz"] == pytest.approx(800, rel=2e-3)
    assert json.loads(outcome.out)["warnings"] == []


def test_seconds_as_float32(run: Run, tmp_path: Path) -> None:
    """At 4000 s they come in steps of 0.24 ms: told as 2096 Hz once."""
    design = tmp_path / "d2000.toml"
    design.write_text(DESIGN.replace("100.0", "2000.0"))
    times = np.float32(4000 + NUMBER / 2000)
    file = log(tmp_path / "in.csv", [repr(float(t)) for t in times])
    words = ("convert", file, "-o", tmp_path / "o.csv", "--design", design, *COLUMNS, *RATES)
    outcome = run(*words, "--time-column", "t", "--json")
    assert outcome.status == 0, outcome.err
    assert json.loads(outcome.out)["timing"]["gap_count"] == 0


def test_late_stamps_are_no_gap(convert: Run, tmp_path: Path, plain: Any) -> None:
    times = NUMBER * H
    times[100:104] = [1.045, 1.0451, 1.0452, 1.0453]
    said, counts, stamps = convert(log(tmp_path / "in.csv", seconds(times, 5)), *RATES)
    assert counts.tolist() == plain.tolist()
    assert said["timing"]["gap_count"] == 0
    assert said["timing"]["passed_over"] == 4
    assert stamps == pytest.approx(NUMBER[1:] * H)


def test_places_follow_a_clock_that_is_off(convert: Run, tmp_path: Path) -> None:
    """Half a per cent in 400 samples is two intervals; with jitter, and still no stamp strays."""
    jitter = np.random.default_rng(6).uniform(-0.2, 0.2, 400)
    stamps = (NUMBER * 1.005 + jitter) * H
    said, _, times = convert(log(tmp_path / "in.csv", seconds(stamps)), *RATES)
    assert said["timing"]["passed_over"] == 0
    assert times == pytest.approx(stamps[1:], abs=1e-6)


def test_ignored_gaps_stay_in_the_stamps(
    run: Run, refused: Refused, tmp_path: Path, d100: Path
) -> None:
    file = log(tmp_path / "in.csv", seconds(np.delete(np.arange(405), range(9, 14)) * H))
    out = tmp_path / "out.csv"
    words = ("convert", file, "-o", out, "--design", d100, *COLUMNS, "--time-column", "t")
    outcome = run(*words, *RATES, "--rates", "mean", "--gaps", "ignore", "--json")
    (warning,) = json.loads(outcome.out)["warnings"]
    assert "1 gap left as they are: model and simulate refuse" in warning
    line = refused("model", d100, out, "-o", tmp_path / "v.csv")
    assert "line 11: time_s goes from 0.08 to 0.14 where the interval is 0.01 s, 5 samples" in line
    assert run("model", d100, out, "-o", tmp_path / "v.csv", "--breaks", "split").status == 0


MINUS_Y = "az,-ay,ax,gz,-gy,gx"


@pytest.mark.parametrize(
    "columns",
    [("gx,-gy,gz", "ax,-ay,az"), ("7,-6,5", "4,-3,2")],
    ids=["names", "numbers"],
)
@pytest.mark.parametrize("names", [MINUS_Y, "az,ay,ax,gz,gy,gx"])
def test_a_column_may_be_taken_negative(
    convert: Run, tmp_path: Path, columns: tuple[str, str], names: str
) -> None:
    """Units that send minus y: headed `-gy`, or `gy` all the same."""
    values = np.tile([490_000, 11, 22, 267, 0, 249], (400, 1))
    values[:, 4] = NUMBER
    file = log(tmp_path / "in.csv", STEADY, values, names)
    time = "1" if columns[0][0].isdecimal() else "t"
    said, counts, _ = convert(
        file, *COUNTS, "--gyro-columns", columns[0], "--accel-columns", columns[1],
        "--time-column", time,
    )  # fmt: skip
    assert counts[7].tolist() == [249, -7, 267, 22, -11, 490_000]
    assert said["notes"]["signs"] == "negative of the column: gyro_y, accel_y"


def test_negative_columns_of_other_formats(convert: Run, tmp_path: Path) -> None:
    scipy_io = pytest.importorskip("scipy.io")
    values = np.column_stack([NUMBER * H, np.arange(2400).reshape(400, 6)])
    scipy_io.savemat(tmp_path / "in.mat", {"imu": values})
    _, counts, _ = convert(
        tmp_path / "in.mat", *COUNTS, "--gyro-columns", "-2,3,4", "--accel-columns", "5,6,-7",
        "--time-column", "1", "--variable", "imu",
    )  # fmt: skip
    assert counts[1].tolist() == [-6, 7, 8, 9, 10, -11]


def test_a_sign_that_may_be_a_name_is_refused(tmp_path: Path, refused: Refused, d100: Path) -> None:
    file = log(tmp_path / "in.csv", STEADY, names="gx,gy,-gy,ax,ay,az")
    words = ("convert", file, "-o", tmp_path / "o.csv", "--design", d100, *RATES)
    line = refused(*words, "--gyro-columns", "gx,-gy,ay", "--accel-columns", "ax,ay,az")
    assert "column '-gy' may be the negative of 'gy' or the column of that name" in line


def test_upside_down_units_are_told(convert: Run, tmp_path: Path) -> None:
    values = np.tile([0, 0.02, -0.01, 0.1, 0.2, 9.8], (400, 1))
    values[:, 0] = ROCKING
    file = log(tmp_path / "in.csv", STEADY, values)
    (warning,) = convert(file, *RATES)[0]["warnings"]
    assert "+9.8 m/s² along z, which is to point down" in warning
    assert "--axes FLU" in warning
    assert "--axes RFU" in warning
    for axes in ("FLU", "RFU"):
        assert convert(file, *RATES, "--axes", axes)[0]["warnings"] == []
    turned = ("--accel-columns", "-ax,-ay,-az", "--gyro-columns", "wx,wy,wz")
    assert convert(file, *RATES, *turned)[0]["warnings"] == []


@pytest.mark.parametrize(
    ("factor", "words"),
    [
        (0.5, "4.901 m/s², gravity is 9.8 m/s²: half of it: is the sample rate twice"),
        (2.0, "19.61 m/s², gravity is 9.8 m/s²: twice it: is the sample rate half"),
        (0.93, "9.117 m/s², gravity is 9.8 m/s²: check the accelerometer's unit and scale"),
        (0.98, None),
    ],
)
def test_another_gravity_is_told(
    convert: Run, tmp_path: Path, factor: float, words: str | None
) -> None:
    values = np.tile([1e-4, 0, 0, 0.0, 0.0, -9.803 * factor], (400, 1))
    values[:, 1] = NUMBER % 7 * 1e-5
    said = convert(log(tmp_path / "in.csv", STEADY, values), *RATES)[0]["warnings"]
    if words is None:
        assert said == []
    else:
        assert words in said[0]


def test_a_turn_is_no_wrong_gravity(convert: Run, tmp_path: Path) -> None:
    """30 m/s in a coordinated turn of 12 °/s: 18 % more than gravity."""
    values = np.tile([0, -0.11, 0.17, 0, 0, -11.6], (400, 1))
    values[:, 0] = 1e-3 * ROCKING
    assert convert(log(tmp_path / "in.csv", STEADY, values), *RATES)[0]["warnings"] == []


def sums(first: int = 0) -> Any:
    """Increments in counts of the design, and their running totals."""
    increments = np.tile([0, -3, 5, 0, 0, -980_000], (400, 1))
    increments[:, 0] = np.rint(2e6 * ROCKING)
    return increments, first + np.cumsum(increments, axis=0)


def test_running_sums_become_their_differences(convert: Run, tmp_path: Path) -> None:
    increments, totals = sums(17)
    file = log(tmp_path / "in.csv", STEADY, totals)
    said, counts, times = convert(file, *COUNTS, "--cumulative")
    assert counts.tolist() == increments[1:].tolist()
    assert times == pytest.approx(NUMBER[1:] * H)
    assert said["notes"]["running sums"].endswith("none wrapped")
    assert said["warnings"] == []
    si = log(tmp_path / "si.csv", STEADY, totals * ([1e-9] * 3 + [1e-7] * 3))
    assert abs(convert(si, *INCREMENTS, "--cumulative")[1] - increments[1:]).max() <= 1


@pytest.mark.parametrize("signed", [True, False])
@pytest.mark.parametrize("bits", [16, 24, 32])
def test_sums_that_wrap_are_undone(
    convert: Run, tmp_path: Path, bits: int, signed: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    increments, _ = sums()
    largest = 2 ** (bits - 4)
    increments = np.rint(increments * (0.9 * largest / np.abs(increments).max(axis=0, initial=1)))
    totals = np.cumsum(increments, axis=0) % 2**bits
    if signed:
        totals[totals >= 2 ** (bits - 1)] -= 2**bits
    # nine digits are not enough for 32 bits
    file = tmp_path / "in.csv"
    cells = [",".join(f"{value:.0f}" for value in row) for row in totals]
    rows = [f"{time},{row}" for time, row in zip(STEADY, cells, strict=True)]
    file.write_text("\n".join([f"t,{NAMES}", *rows]) + "\n")
    for chunk in (1 << 14, 50):
        monkeypatch.setattr("sculler.readers.text._CHUNK_ROWS", chunk)
        for given in ((), ("--cumulative-bits", bits)):
            said, counts, _ = convert(file, *COUNTS, "--cumulative", *given)
            assert counts.tolist() == increments[1:].tolist()
            assert f"accel_z at {bits} bits" in said["notes"]["running sums"]


def test_only_one_sensor_may_send_sums(convert: Run, tmp_path: Path) -> None:
    increments, totals = sums()
    mixed = np.hstack([totals[:, :3], increments[:, 3:]])
    file = log(tmp_path / "in.csv", STEADY, mixed)
    counts = convert(file, *COUNTS, "--cumulative", "--cumulative-of", "gyro")[1]
    assert counts.tolist() == increments[1:].tolist()


def test_running_sums_are_suspected(
    convert: Run, tmp_path: Path, refused: Refused, d100: Path
) -> None:
    _, totals = sums()
    file = log(tmp_path / "in.csv", STEADY, totals)
    warnings = convert(file, *COUNTS)[0]["warnings"]
    assert any("running sums? then give --cumulative" in warning for warning in warnings)
    wrapped = np.tile([0, 0, 0, 0, 0, -980_000], (400, 1))
    wrapped[:, 0] = (700 * (NUMBER + 1) + 2**15) % 2**16 - 2**15
    warnings = convert(log(tmp_path / "w.csv", STEADY, wrapped), *COUNTS)[0]["warnings"]
    assert warnings == [
        "gyro_x steps back by the range of a counter of 16 bits: are these running sums? then give"
        " --cumulative"
    ]
    big = np.tile([0.01, 0, 0, 0, 0, -0.098], (400, 1)).cumsum(axis=0)
    file = log(tmp_path / "b.csv", STEADY, big)
    words = ("convert", file, "-o", tmp_path / "o.csv", "--design", d100, *COLUMNS, *INCREMENTS)
    line = refused(*words)
    assert "sample 214: gyro_x = 2.15 rad does not fit 32 bits" in line
    assert "give --cumulative" in line


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ((*COUNTS, "--cumulative-bits", 16), "go with --cumulative"),
        ((*COUNTS, "--cumulative-of", "gyro"), "go with --cumulative"),
        ((*RATES, "--cumulative"), "takes running sums of increments"),
        (
            (*COUNTS, "--cumulative", "--cumulative-bits", 8),
            "sample 1: accel_z = -1960000 is no",
        ),
    ],
)
def test_options_of_sums_that_do_not_fit(
    tmp_path: Path, refused: Refused, d100: Path, options: tuple[object, ...], message: str
) -> None:
    _, totals = sums()
    totals[:, :3] = 0
    totals[0] = 0
    file = log(tmp_path / "in.csv", STEADY, totals)
    words = ("convert", file, "-o", tmp_path / "o.csv", "--design", d100, *COLUMNS)
    assert message in refused(*words, *options)


def test_spikes_and_zeros_are_told_with_their_sample(convert: Run, tmp_path: Path) -> None:
    """A spike of 30,000 times the rest, and two seconds of nothing."""
    rng = np.random.default_rng(4)
    values = rng.normal([0, 0, 0, 0, 0, -9.8], [1e-3] * 3 + [1e-2] * 3, (400, 6))
    values[200, 0] = 30
    values[300:] = 0
    said, _, _ = convert(log(tmp_path / "in.csv", STEADY, values), *RATES)
    warnings = said["warnings"]
    assert any(w.startswith("gyro_x is 300000000 at sample 200 (2 s), more than") for w in warnings)
    assert any(w.startswith("all six counts are 0 from sample 300 (3 s) on for") for w in warnings)
