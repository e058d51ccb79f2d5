"""`convert`: foreign logs become counts, nothing is lost, and faults are named."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from fractions import Fraction
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.io

from sculler.formats.log import read_log
from sculler_model.design import Design

Run = Callable[..., Any]
Refused = Callable[..., str]

UNITS = ("--gyro-unit", "rad", "--accel-unit", "m/s")
COLUMNS = "gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z"


def counts_of(path: Path, design: Path) -> list[list[int]]:
    return np.concatenate([c for c, *_ in read_log(path, Design.load(design))]).tolist()


@pytest.fixture
def convert(run: Run, tmp_path: Path, design: Path) -> Callable[..., tuple[Any, list[list[int]]]]:
    """Convert for the small design; what was said (JSON) and the counts."""

    def convert(log: Path, *options: object) -> tuple[Any, list[list[int]]]:
        out = tmp_path / "out.csv"
        outcome = run("convert", log, "-o", out, "--design", design, "--json", *options)
        assert outcome.status == 0, outcome.err
        assert outcome.err == ""
        return json.loads(outcome.out), counts_of(out, design)

    return convert


def csv(tmp_path: Path, content: str) -> Path:
    path = tmp_path / "in.csv"
    path.write_text(content)
    return path


# The small design: increments at 1 kHz, gyro LSB 1e-6 rad, accelerometer LSB 1e-4 m/s.
@pytest.mark.parametrize(
    ("unit", "value", "expected"),
    [
        ("rad", "0.001234", 1234),
        ("deg", "1", 17453),  # π/180 rad
        ("arcsec", "-100", -485),  # 4.848e-6 rad each
        ("rad/s", "2", 2000),  # times 1 ms
        ("deg/s", "500", 8727),
        ("deg/h", "1000000", 4848),
        ("counts", "-32768", -32768),
    ],
)
def test_gyro_units(tmp_path: Path, convert: Run, unit: str, value: str, expected: int) -> None:
    log = csv(tmp_path, f"{COLUMNS}\n0,{value},0,0,0,0\n")
    _, counts = convert(log, "--gyro-unit", unit, "--accel-unit", "m/s", "--rates", "mean")
    assert counts == [[0, expected, 0, 0, 0, 0]]


@pytest.mark.parametrize(
    ("unit", "value", "expected"),
    [
        ("m/s", "-0.1", -1000),
        ("ft/s", "0.5", 1524),  # 0.3048 m
        ("m/s2", "150", 1500),
        ("g", "10", 981),  # 9.80665 m/s² times 1 ms is 98.0665 counts
        ("mg", "-20000", -1961),
        ("counts", "2047", 2047),
    ],
)
def test_accelerometer_units(
    tmp_path: Path, convert: Run, unit: str, value: str, expected: int
) -> None:
    log = csv(tmp_path, f"{COLUMNS}\n0,0,0,0,0,{value}\n")
    _, counts = convert(log, "--gyro-unit", "rad", "--accel-unit", unit, "--rates", "mean")
    assert counts == [[0, 0, 0, 0, 0, expected]]


def test_no_angle_is_lost(tmp_path: Path, convert: Run) -> None:
    """The running total of the counts is the rounded running total of the input, in rationals."""
    rng = np.random.default_rng(3)
    values = (rng.normal(size=(5000, 6)) * [3e-6] * 1).round(12)
    rows = [",".join(f"{v:.12f}" for v in row) for row in values]
    said, counts = convert(csv(tmp_path, "\n".join([COLUMNS, *rows]) + "\n"), *UNITS)
    lsb = [Fraction(1, 10**6)] * 3 + [Fraction(1, 10**4)] * 3
    total, given = [0] * 6, [Fraction(0)] * 6
    for row, read in zip(rows, counts, strict=True):
        for column, cell in enumerate(row.split(",")):
            given[column] += Fraction(cell)
            total[column] += read[column]
            assert abs(given[column] / lsb[column] - total[column]) < Fraction(1, 2) + Fraction(
                1, 10**6
            )
    for column, name in enumerate(COLUMNS.split(",")):
        left = given[column] - total[column] * lsb[column]
        assert said["columns"][name]["remainder"] == pytest.approx(float(left), abs=1e-12)
        assert said["columns"][name]["largest_count"] == max(abs(row[column]) for row in counts)


def test_columns_by_name_delimiter_and_preamble(tmp_path: Path, convert: Run) -> None:
    log = csv(
        tmp_path,
        "written by a logger\nsecond line\n"
        "t;ax;ay;az;wx;wy;wz;temperature\n"
        "0.000;1;2;3;4;5;6;20.5\n0.001;7;8;9;10;11;12;n/a\n",
    )
    said, counts = convert(
        log,
        *("--gyro-columns", "wx,wy,wz", "--accel-columns", "ax,ay,az", "--time-column", "t"),
        *("--gyro-unit", "counts", "--accel-unit", "counts", "--skip-rows", 2),
    )
    assert counts == [[4, 5, 6, 1, 2, 3], [10, 11, 12, 7, 8, 9]]
    assert said["samples"] == 2
    assert said["seconds"] == 0.002
    assert said["notes"]["time stamps"] == "t, s"
    assert said["timing"]["gap_count"] == 0


@pytest.mark.parametrize("head", ["", "a b c d e f\n"], ids=["no header", "header"])
def test_columns_by_number(tmp_path: Path, convert: Run, head: str) -> None:
    log = csv(tmp_path, head + "1 2 3 4 5 6\n")
    _, counts = convert(
        log,
        *("--gyro-columns", "4,5,6", "--accel-columns", "3,2,1"),
        *("--gyro-unit", "counts", "--accel-unit", "counts"),
    )
    assert counts == [[4, 5, 6, 3, 2, 1]]


def test_fault_column_is_carried(tmp_path: Path, convert: Run, design: Path) -> None:
    log = csv(tmp_path, f"fault,{COLUMNS}\n0,0,0,0,0,0,0\n1,0,0,0,0,0,0\n")
    convert(log, *UNITS)
    ((_, faults, *_),) = read_log(tmp_path / "out.csv", Design.load(design))
    assert faults is not None
    assert faults.tolist() == [0, 1]


def test_increments_for_a_rate_sensor(run: Run, tmp_path: Path) -> None:
    design = tmp_path / "rate.toml"
    design.write_text(
        'name = "r"\n[sensor]\nkind = "rate"\nsample_rate_hz = 100.0\n'
        "gyro = { bits = 16, lsb = 1e-3 }\naccel = { bits = 16, lsb = 1e-2 }\n"
        '[algorithm]\nfamily = "filtered-rate"\nsamples = 2\nminors = 2\n'
    )
    log = csv(tmp_path, f"{COLUMNS}\n0.01,0,0,0.5,0,0\n")
    out = tmp_path / "out.csv"
    assert run("convert", log, "-o", out, "--design", design, *UNITS).status == 0
    # 0.01 rad in 10 ms is 1 rad/s; 0.5 m/s is 50 m/s²
    assert counts_of(out, design) == [[1000, 0, 0, 5000, 0, 0]]


def test_axes_turn_and_the_most_negative_count(
    tmp_path: Path, convert: Run, refused: Refused, design: Path
) -> None:
    log = csv(tmp_path, f"{COLUMNS}\n1,2,3,4,5,6\n-32768,2,3,4,5,6\n")
    counted = ("--gyro-unit", "counts", "--accel-unit", "counts")
    _, counts = convert(log, *counted, "--axes", "z,x,y")
    assert counts == [[3, 1, 2, 6, 4, 5], [3, -32768, 2, 6, 4, 5]]
    _, counts = convert(csv(tmp_path, f"{COLUMNS}\n1,2,3,4,5,6\n"), *counted, "--axes", "y,x,-z")
    assert counts == [[2, 1, -3, 5, 4, -6]]

    log = csv(tmp_path, f"{COLUMNS}\n1,2,3,4,5,6\n-32768,2,3,4,5,6\n")
    words = ("convert", log, "-o", tmp_path / "no.csv", "--design", design, *counted)
    line = refused(*words, "--axes", "-x,-y,z")
    assert "sample 1: gyro_x = 32768 does not fit the sensor's 16 bits" in line
    assert "mirror image" in refused(*words, "--axes", "y,x,z")


FAULTS: dict[str, tuple[str, tuple[str, ...], str]] = {
    "no unit": (f"{COLUMNS}\n0,0,0,0,0,0\n", (), "--gyro-unit is missing"),
    "unknown unit": (f"{COLUMNS}\n0,0,0,0,0,0\n", ("--gyro-unit", "turns"), "'turns'"),
    "no such column": ("a,b,c\n1,2,3\n", UNITS, "line 1: no column 'gyro_x'"),
    "no such number": (
        "1,2,3\n",
        (*UNITS, "--gyro-columns", "1,2,3", "--accel-columns", "4,5,6"),
        "line 1: no column 4, the line has 3",
    ),
    "two columns": (f"{COLUMNS}\n0,0,0,0,0,0\n", (*UNITS, "--gyro-columns", "a,b"), "'a,b'"),
    "not a number": (
        f"{COLUMNS}\n0,0,0,0,0,0\n0,0,zero,0,0,0\n",
        UNITS,
        "line 3: gyro_z is 'zero'",
    ),
    "nan": (f"{COLUMNS}\n0,0,0,0,0,NaN\n", UNITS, "line 2: accel_z is 'NaN'"),
    "infinite": (f"{COLUMNS}\n0,0,0,0,inf,0\n", UNITS, "line 2: accel_y is 'inf'"),
    "cut short": (f"{COLUMNS}\n0,0,0,0,0,0\n0,0,0.1", UNITS, "line 3: the last line has no line"),
    "short row": (
        f"{COLUMNS}\n0,0,0,0,0,0\n0,0,0\n",
        UNITS,
        "line 3: accel_x (column 4) is missing",
    ),
    "empty": ("", UNITS, "the log is empty"),
    "header only": (f"{COLUMNS}\n", UNITS, "the log has no samples"),
    "too fast": (
        f"{COLUMNS}\n0,0,0,0,0,0\n0,1,0,0,0,0\n",
        UNITS,
        "sample 1: gyro_y = 1 rad does not fit",
    ),
    "halves of counts": (
        f"{COLUMNS}\n0,0,0,0,0.5,0\n",
        ("--gyro-unit", "counts", "--accel-unit", "counts"),
        "sample 0: accel_y = 0.5 is not a whole number of counts",
    ),
    "wrong rate": (
        f"t,{COLUMNS}\n0,0,0,0,0,0,0\n0.01,0,0,0,0,0,0\n",
        (*UNITS, "--time-column", "t"),
        "shows 100 Hz but sensor.sample_rate_hz = 1000",
    ),
    "time goes back": (
        f"t,{COLUMNS}\n0,0,0,0,0,0,0\n0.001,0,0,0,0,0,0\n-3,0,0,0,0,0,0\n",
        (*UNITS, "--time-column", "t"),
        "sample 2: time does not grow, it goes back by 3.001 s for good (after 0.001000 s)",
    ),
    "time stands still": (
        f"t,{COLUMNS}\n0,0,0,0,0,0,0\n" + "0.001,0,0,0,0,0,0\n" * 3,
        (*UNITS, "--time-column", "t", "--steps", "resample"),
        "sample 2: time does not grow, it repeats the stamp before (0.001000000 s) (2 such samples"
        " in all); give --steps even",
    ),
    "option of another format": (
        f"{COLUMNS}\n0,0,0,0,0,0\n",
        (*UNITS, "--variable", "x"),
        "--variable is not used for format csv",
    ),
    "long delimiter": (f"{COLUMNS}\n0,0,0,0,0,0\n", (*UNITS, "--delimiter", "::"), "'::'"),
    "fault of 2": (f"fault,{COLUMNS}\n2,0,0,0,0,0,0\n", UNITS, "column fault"),
}


@pytest.mark.parametrize("case", FAULTS)
def test_csv_faults(tmp_path: Path, refused: Refused, design: Path, case: str) -> None:
    content, options, message = FAULTS[case]
    log = csv(tmp_path, content)
    out = tmp_path / "out.csv"
    assert message in refused("convert", log, "-o", out, "--design", design, *options)


def test_binary_and_absent_csv(tmp_path: Path, refused: Refused, design: Path) -> None:
    log = tmp_path / "in.csv"
    log.write_bytes(b"\x80\x81\xff\xfe" * 40)
    words = ("-o", tmp_path / "out.csv", "--design", design, *UNITS)
    assert "not a text file in UTF-8" in refused("convert", log, *words)
    assert "cannot read the log" in refused("convert", tmp_path / "absent.csv", *words)


# MAT


@pytest.fixture
def mat(tmp_path: Path) -> Path:
    path = tmp_path / "in.mat"
    imu = np.arange(14.0).reshape(2, 7) * 1e-6
    imu[:, 6] = [0.001, 0.002]
    bad = imu.copy()
    bad[1, 2] = np.nan
    scipy.io.savemat(path, {"imu": imu, "bad": bad, "cube": np.zeros((2, 2, 2)), "word": "hello"})
    return path


def test_mat(convert: Run, mat: Path) -> None:
    said, counts = convert(mat, "--variable", "imu", *UNITS, "--time-column", 7)
    # the accelerometer's 1e-4 m/s is coarser: 3e-6 + 10e-6 stay in the remainder
    assert counts == [[0, 1, 2, 0, 0, 0], [7, 8, 9, 0, 0, 0]]
    assert said["format"] == "mat"
    assert said["columns"]["accel_x"]["remainder"] == pytest.approx(13e-6)
    _, counts = convert(
        mat, "--variable", "imu", *UNITS, "--gyro-columns", "3,2,1", "--accel-columns", "4,5,6"
    )
    assert counts[0] == [2, 1, 0, 0, 0, 0]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ((), "the file has imu (2×7), bad (2×7), cube (2×2×2): give --variable"),
        (("--variable", "ins"), "no variable 'ins'"),
        (("--variable", "word"), "is not a matrix of real numbers"),
        (("--variable", "cube"), "is not a matrix of real numbers"),
        (("--variable", "bad"), "bad(2, 3) is nan"),
        (("--variable", "imu", "--gyro-columns", "6,7,8"), "imu has columns 1 to 7, not 8"),
        (("--variable", "imu", "--gyro-columns", "a,b,c"), "no array 'a'; the file has imu (2×7)"),
        (("--variable", "imu", "--skip-rows", "1"), "--skip-rows is not used for format mat"),
        (("--variable", "imu", "--time-column", "1"), "time column shows"),
    ],
)
def test_mat_faults(
    tmp_path: Path,
    refused: Refused,
    design: Path,
    mat: Path,
    options: tuple[str, ...],
    message: str,
) -> None:
    words = ("convert", mat, "-o", tmp_path / "out.csv", "--design", design, *UNITS)
    assert message in refused(*words, *options)


def test_other_mat_files(tmp_path: Path, refused: Refused, design: Path, mat: Path) -> None:
    words = ("-o", tmp_path / "out.csv", "--design", design, *UNITS, "--variable", "imu")
    whole = mat.read_bytes()
    other = tmp_path / "other.mat"
    other.write_bytes(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM" + whole)
    assert "not a whole MAT or HDF5 file" in refused("convert", other, *words)
    for content in (b"", b"no MAT file at all, but long enough" * 20, whole[:150], whole[:250]):
        other.write_bytes(content)
        refused("convert", other, *words)
    assert "cannot read the log" in refused("convert", tmp_path / "absent.mat", *words)


def test_mat_without_scipy(
    tmp_path: Path, refused: Refused, design: Path, mat: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "scipy", None)
    words = ("convert", mat, "-o", tmp_path / "out.csv", "--design", design, *UNITS)
    assert "pip install 'sculler[formats]'" in refused(*words, "--variable", "imu")


# PSINS text

HEAD = """% PSINS-format SIMU log file.
% a comment
0.0 0.0 -90.6 0.0 0.0 0.0
34.25 108.91 380.0 0.0 {interval} 9.780327
{gyro} {gyro} {gyro} {accel} {accel} {accel}
"""
LASER = (pi / 180 / 3600 * 0.1, 125e-6 * 9.780327)


def psins(tmp_path: Path, rows: str, interval: str = "10.0", gyro: str = "0.1") -> Path:
    path = tmp_path / "in.imu"
    path.write_text(HEAD.format(interval=interval, gyro=gyro, accel="125.0") + rows)
    return path


def test_psins_counts_pass_unchanged(run: Run, tmp_path: Path) -> None:
    log, out = psins(tmp_path, "1 -2 3 0 0 80\n-8388608 2 3 4 5 8388607\n"), tmp_path / "out.csv"
    outcome = run("convert", log, "-o", out, "--design", "lasergyro", "--json")
    assert outcome.status == 0, outcome.err
    said = json.loads(outcome.out)
    assert said["sensors"]["gyro"]["unchanged"]
    assert said["sensors"]["accel"]["unchanged"]
    assert {column["remainder"] for column in said["columns"].values()} == {0.0}
    assert "34.25000000° N" in said["notes"]["position"]
    ((counts, *_),) = read_log(out, Design.preset("lasergyro"))
    assert counts.tolist() == [[1, -2, 3, 0, 0, 80], [-8388608, 2, 3, 4, 5, 8388607]]


def test_psins_of_another_scale_is_quantised(run: Run, tmp_path: Path) -> None:
    log, out = psins(tmp_path, "1 -2 3 0 0 80\n" * 4, gyro="0.25"), tmp_path / "out.csv"
    outcome = run("convert", log, "-o", out, "--design", "lasergyro", "--json")
    assert outcome.status == 0, outcome.err
    assert not json.loads(outcome.out)["sensors"]["gyro"]["unchanged"]
    ((counts, *_),) = read_log(out, Design.preset("lasergyro"))
    # 2.5, -5 and 7.5 counts a sample
    assert counts.sum(axis=0).tolist() == [10, -20, 30, 0, 0, 320]
    assert counts[:, 1].tolist() == [-5] * 4


@pytest.mark.parametrize(
    ("rows", "change", "message"),
    [
        ("1 2 3 4 5 6\n", {"interval": "5.0"}, "interval is 5 ms but sensor.sample_rate_hz = 100"),
        ("1 2 3 4 5 6\n", {"gyro": "0"}, "the gyro scales are not one number > 0"),
        ("1 2 3 4 5 6\n", {"gyro": "fast"}, "line 5: give six numbers"),
        ("1 2 3 4 5 6\n1 2 3\n", {}, "line 7: accel_x (column 4) is missing"),
        ("1 2 3 4 5 6\n1 2 3 4 5 6", {}, "line 7: the last line has no line end"),
        ("1 2 3 4 5 8388608\n", {}, "sample 0: accel_z = 8388608 does not fit"),
        ("1 2 3 4 5 6.5\n", {}, "sample 0: accel_z = 6.5 is not a whole number"),
        ("", {}, "the log has no samples"),
    ],
)
def test_psins_faults(
    tmp_path: Path, refused: Refused, rows: str, change: dict[str, str], message: str
) -> None:
    log = psins(tmp_path, rows, **change)
    line = refused("convert", log, "-o", tmp_path / "out.csv", "--design", "lasergyro")
    assert message in line
    assert str(log) in line


def test_psins_head_cut_short(tmp_path: Path, refused: Refused) -> None:
    log = tmp_path / "in.imu"
    log.write_text("% PSINS\n0 0 0 0 0 0\n")
    line = refused("convert", log, "-o", tmp_path / "out.csv", "--design", "lasergyro")
    assert "the head is cut short" in line
    line = refused(
        "convert", log, "-o", tmp_path / "out.csv", "--design", "lasergyro", "--gyro-unit", "rad"
    )
    assert "--gyro-unit is not used for format psins" in line
