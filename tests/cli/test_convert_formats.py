"""`convert` reads the formats people have: each found out by what is in it, each fault named."""

from __future__ import annotations

import builtins
import json
import struct
from collections.abc import Callable, Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sculler.formats.log import read_log
from sculler_model.design import Design

Run = Callable[..., Any]
Refused = Callable[..., str]

# 200 Hz, gyro LSB 1e-6 rad, accelerometer LSB 1e-4 m/s
DESIGN = """
name = "imu200"
[sensor]
kind = "increment"
sample_rate_hz = 200.0
gyro = { bits = 24, lsb = 1e-6 }
accel = { bits = 24, lsb = 1e-4 }
[algorithm]
family = "frequency-taylor"
samples = 2
minors = 2
"""
STEP = 5_000_000  # ns
EPOCH = 1_403_636_579_758_555_392


@pytest.fixture
def imu200(tmp_path: Path) -> Path:
    path = tmp_path / "imu200.toml"
    path.write_text(DESIGN)
    return path


@pytest.fixture
def convert(run: Run, tmp_path: Path, imu200: Path) -> Callable[..., tuple[Any, Any, Any]]:
    """Convert; what was said (JSON), the counts and the faults."""

    def convert(log: Path, *options: object) -> tuple[Any, Any, Any]:
        out = tmp_path / "out.csv"
        outcome = run("convert", log, "-o", out, "--design", imu200, "--json", *options)
        assert outcome.status == 0, outcome.err
        assert outcome.err == ""
        chunks = list(read_log(out, Design.load(imu200)))
        counts = np.concatenate([chunk.counts for chunk in chunks]).tolist()
        flags = [chunk.faults for chunk in chunks if chunk.faults is not None]
        return json.loads(outcome.out), counts, np.concatenate(flags).tolist() if flags else None

    return convert


def write(path: Path, *lines: str) -> Path:
    path.write_text("\n".join(lines) + "\n")
    return path


# A constant rate of (1, 2, -3) rad/s and specific force (0, 0.2, -10) m/s², in counts a sample.
RATES = "1,2,-3,0,0.2,-10"
CONSTANT = [5000, 10000, -15000, 0, 10, -500]

EUROC = (
    "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
    "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]"
)


def test_euroc(tmp_path: Path, convert: Run) -> None:
    rows = [f"{EPOCH + k * STEP},{RATES}" for k in range(6)]
    said, counts, _ = convert(write(tmp_path / "data.csv", EUROC, *rows))
    assert said["format"] == "euroc"
    assert counts == [CONSTANT] * 5  # six instants bound five intervals
    timing = said["timing"]
    # no digit of the nanoseconds is lost: as floats they would be off by up to 128 ns
    assert timing["shortest_step_s"] == pytest.approx(0.005, rel=1e-12)
    assert timing["longest_step_s"] == pytest.approx(0.005, rel=1e-12)
    assert timing["rate_hz"] == pytest.approx(200, rel=1e-6)
    assert said["warnings"] == []


def test_euroc_in_text_shows_its_units(run: Run, tmp_path: Path, imu200: Path) -> None:
    rows = [f"{EPOCH + k * STEP},{RATES}" for k in range(6)]
    log = write(tmp_path / "data.csv", EUROC, *rows)
    outcome = run("convert", log, "-o", tmp_path / "o.csv", "--design", imu200, "--axes", "RFU")
    assert outcome.status == 0
    assert "w_RS_S_x [rad s^-1]" in outcome.out
    assert "x (forward)" in outcome.out
    assert "-z (up)" in outcome.out


ROS_TIMES = {
    "rostopic": (
        "%time,field.header.seq,field.header.stamp",
        lambda k: f"{EPOCH + 7 * k * k},{k},{EPOCH + k * STEP}",
    ),
    "receipt only": ("%time", lambda k: f"{EPOCH + k * STEP}"),
    "bagpy": (  # the seconds change on the way
        "Time,header.seq,header.stamp.secs,header.stamp.nsecs",
        lambda k: f"{1.4e9 + 0.01 * k},{k},{1_403_636_579 + (k > 1)},{(k + 198) % 200 * STEP}",
    ),
    "ros 2": (
        "header.stamp.sec,header.stamp.nanosec,header.frame_id",
        lambda k: f"1403636579,{k * STEP},imu",
    ),
    "slashes": ("__time", lambda k: f"{1.4e9 + 0.005 * k:.6f}"),
}


@pytest.mark.parametrize("case", ROS_TIMES)
def test_ros(tmp_path: Path, convert: Run, case: str) -> None:
    """Names as the exporting programs write them; between them an orientation and covariances."""
    head, stamp = ROS_TIMES[case]
    start, between = {"rostopic": ("field.", "."), "receipt only": ("field.", ".")}.get(
        case, ("", ".")
    )
    if case == "slashes":
        start, between = "/imu/data/", "/"
    names = [
        f"{start}{part}{between}{axis}"
        for part in ("orientation", "angular_velocity", "linear_acceleration")
        for axis in "xyz"
    ]
    names += [f"{start}angular_velocity_covariance{n}" for n in range(2)]
    rows = [f"{stamp(k)},0,0,0,{RATES},9,9" for k in range(5)]
    said, counts, _ = convert(write(tmp_path / "imu.csv", ",".join([head, *names]), *rows))
    assert said["format"] == "ros"
    assert counts == [CONSTANT] * 4
    # 1.4e9 s in a float are good to 0.2 µs, whole nanoseconds to 1e-15 s
    rel = 1e-4 if case == "slashes" else 1e-12
    assert said["timing"]["longest_step_s"] == pytest.approx(0.005, rel=rel)


def test_ros_without_a_time_and_with_other_units(tmp_path: Path, convert: Run) -> None:
    names = [f"{p}.{a}" for p in ("angular_velocity", "linear_acceleration") for a in "xyz"]
    log = write(tmp_path / "imu.csv", ",".join(names), *["90,0,0,0,0,-1"] * 3)
    said, counts, _ = convert(log, "--gyro-unit", "deg/s", "--accel-unit", "g")
    assert said["timing"] is None
    # π/2 rad/s and 9.80665 m/s² times 5 ms: 7853.98 and 490.33 counts, the remainder carried
    assert counts == [[7854, 0, 0, 0, 0, -490], [7854, 0, 0, 0, 0, -491]]


INCREMENTS = [
    [456300.005 + 0.005 * k, 1e-6 * k, -2e-6 * k, 3e-6, 0.1, -0.2, -0.04905] for k in range(9)
]
COUNTS = [[k, -2 * k, 3, 1000, -2000] for k in range(9)]


def test_kfgins_text(tmp_path: Path, convert: Run) -> None:
    rows = ["  ".join(f"{cell:.9f}" for cell in row) for row in INCREMENTS]
    said, counts, _ = convert(write(tmp_path / "imu.txt", *rows))
    assert said["format"] == "kfgins"
    assert [row[:5] for row in counts] == COUNTS
    assert sum(row[5] for row in counts) == -4414  # 9 · 490.5 = 4414.5 in the end
    assert said["timing"]["start_s"] == pytest.approx(456300.005)


def test_kfgins_binary(tmp_path: Path, convert: Run) -> None:
    log = tmp_path / "imu.bin"
    log.write_bytes(b"".join(struct.pack("<7d", *row) for row in INCREMENTS))
    said, counts, _ = convert(log)
    assert said["format"] == "kfgins-binary"
    assert [row[:5] for row in counts] == COUNTS


NPZ = {
    "gyro": np.tile([1.0, 2.0, -3.0], (5, 1)),
    "accel": np.tile([0.0, 0.2, -10.0], (5, 1)),
}


def test_npz(tmp_path: Path, convert: Run) -> None:
    log = tmp_path / "log.npz"
    np.savez(log, **NPZ, time=np.arange(5) * STEP, gyro_unit="rad/s", fault=[0, 0, 1, 0, 0])
    said, counts, faults = convert(log, "--accel-unit", "m/s2")
    assert said["format"] == "npz"
    assert counts == [CONSTANT] * 4
    assert faults == [0, 1, 1, 0]  # both intervals that the faulty rate bounds
    assert said["timing"]["rate_hz"] == pytest.approx(200)


def test_npz_of_increments_by_content(tmp_path: Path, convert: Run) -> None:
    """Found out without a suffix; the names say the units."""
    log = tmp_path / "log"
    with log.open("wb") as file:
        np.savez_compressed(
            file, dtheta=np.full((3, 3), 1e-3), dvel=np.full((3, 3), 0.1), t=[0.0, 0.005, 0.01]
        )
    said, counts, _ = convert(log)
    assert said["format"] == "npz"
    assert counts == [[1000] * 6] * 3


def test_parquet(tmp_path: Path, convert: Run) -> None:
    pa = pytest.importorskip("pyarrow")
    pq = pytest.importorskip("pyarrow.parquet")
    stamps = pa.array([EPOCH + k * STEP for k in range(5)], pa.timestamp("ns"))
    wx, wy, wz, ax, ay, az = (float(cell) for cell in RATES.split(","))
    columns: dict[str, Any] = {"t": stamps, "az": [az] * 5, "ay": [ay] * 5, "ax": [ax] * 5}
    columns |= {"wx": [wx] * 5, "wy": [wy] * 5, "wz": [wz] * 5, "fault": [0, 0, 0, 0, 1]}
    log = tmp_path / "log.pq"
    pq.write_table(pa.table(columns), log)
    said, counts, faults = convert(
        log,
        *("--gyro-columns", "wx,wy,wz", "--accel-columns", "ax,ay,az", "--time-column", "t"),
        *("--gyro-unit", "rad/s", "--accel-unit", "m/s2"),
    )
    assert said["format"] == "parquet"
    assert counts == [CONSTANT] * 4
    assert faults == [0, 0, 0, 1]
    assert said["timing"]["longest_step_s"] == pytest.approx(0.005, rel=1e-12)


def test_parquet_of_ros(tmp_path: Path, convert: Run) -> None:
    pa = pytest.importorskip("pyarrow")
    pq = pytest.importorskip("pyarrow.parquet")
    names = [f"{p}.{a}" for p in ("angular_velocity", "linear_acceleration") for a in "xyz"]
    columns: dict[str, Any] = {
        "header.stamp.sec": [12] * 5,
        "header.stamp.nanosec": [k * STEP for k in range(5)],
    }
    columns |= {name: [float(cell)] * 5 for name, cell in zip(names, RATES.split(","), strict=True)}
    log = tmp_path / "log.parquet"
    pq.write_table(pa.table(columns), log)
    said, counts, _ = convert(log)
    assert counts == [CONSTANT] * 4
    assert said["timing"]["start_s"] == 12


def _npz(path: Path, arrays: Mapping[str, Any]) -> Path:
    np.savez(path, **arrays)
    return path


UNITS = ("--gyro-unit", "rad/s", "--accel-unit", "m/s2")
NPZ_FAULTS: dict[str, tuple[dict[str, Any], tuple[str, ...], str]] = {
    "no gyro": (
        {"accel": NPZ["accel"]},
        UNITS,
        "no arrays gyro and accel of shape (N, 3); the file has accel (5×3)",
    ),
    "two gyros": (NPZ | {"gyr": NPZ["gyro"]}, UNITS, "gyro and gyr are both there"),
    "no unit": (dict(NPZ), ("--gyro-unit", "rad/s"), "the unit of accel is not given"),
    "odd unit": (NPZ | {"gyro_unit": "turns/s"}, (), "gyro_unit 'turns/s' is not known"),
    "shape": (NPZ | {"gyro": np.zeros((5, 2))}, UNITS, "the file has gyro (5×2), accel (5×3)"),
    "words": (
        NPZ | {"gyro": np.full((5, 3), "a")},
        UNITS,
        "no arrays gyro and accel of shape (N, 3)",
    ),
    "lengths": (NPZ | {"accel": np.zeros((4, 3))}, UNITS, "accel has 4 rows and gyro 5"),
    "few times": (NPZ | {"time": np.arange(4.0)}, UNITS, "time has 4 rows and gyro 5"),
    "empty": ({n: np.zeros((0, 3)) for n in NPZ}, UNITS, "gyro has no rows"),
    "nan": (NPZ | {"accel": np.full((5, 3), np.nan)}, UNITS, "sample 0: accel_x is nan"),
    "nan time": (NPZ | {"time": np.full(5, np.nan)}, UNITS, "sample 0: time is nan"),
    "fault of 2": (NPZ | {"fault": np.full(5, 2)}, UNITS, "column fault is not 0 or 1"),
    "rate": (NPZ | {"time": np.arange(5.0)}, UNITS, "shows 1 Hz but sensor.sample_rate_hz = 200"),
    "time unit": (NPZ | {"time": np.arange(5), "time_unit": "h"}, UNITS, "time_unit 'h'"),
}


@pytest.mark.parametrize("case", NPZ_FAULTS)
def test_npz_faults(tmp_path: Path, refused: Refused, imu200: Path, case: str) -> None:
    arrays, options, message = NPZ_FAULTS[case]
    log = _npz(tmp_path / "in.npz", arrays)
    words = ("convert", log, "-o", tmp_path / "out.csv", "--design", imu200)
    assert message in refused(*words, *options)


def test_npz_with_objects_or_cut_short(tmp_path: Path, refused: Refused, imu200: Path) -> None:
    log = tmp_path / "in.npz"
    words = ("convert", log, "-o", tmp_path / "out.csv", "--design", imu200, *UNITS)
    np.savez(log, gyro=np.array([{}], object), accel=NPZ["accel"])
    assert "not a whole .npz file" in refused(*words)
    np.savez_compressed(log, **NPZ)
    whole = log.read_bytes()
    for content in (whole[: len(whole) // 2], b"PK\x03\x04" + b"\x00" * 50, b"nothing"):
        log.write_bytes(content)
        assert "not a whole .npz file" in refused(*words)
    assert "cannot read the log" in refused(
        "convert", tmp_path / "absent.npz", "--format", "npz", *words[2:]
    )


def test_parquet_faults(tmp_path: Path, refused: Refused, imu200: Path) -> None:
    pa = pytest.importorskip("pyarrow")
    pq = pytest.importorskip("pyarrow.parquet")
    names = ["gyro_x", "gyro_y", "gyro_z", "accel_x", "accel_y", "accel_z"]
    good: dict[str, Any] = {name: [1.0, 2.0] for name in names}
    log = tmp_path / "in.parquet"
    words = ("convert", log, "-o", tmp_path / "out.csv", "--design", imu200)
    for change, options, message in (
        ({"accel_x": [1.0, None]}, UNITS, "sample 1: accel_x is empty"),
        ({"accel_x": [1.0, np.nan]}, UNITS, "sample 1: accel_x is nan"),
        ({"accel_x": ["a", "b"]}, UNITS, "column accel_x holds no numbers"),
        ({}, UNITS[:2], "--accel-unit is missing"),
        ({}, (*UNITS, "--time-column", "t"), "no column 't'"),
        ({name: pa.array([], pa.float64()) for name in names}, UNITS, "no samples"),
    ):
        pq.write_table(pa.table(good | change), log)
        assert message in refused(*words, *options)
    pq.write_table(pa.table(good), log)
    whole = log.read_bytes()
    log.write_bytes(whole[: len(whole) // 2])
    assert "not a whole Parquet file" in refused(*words, *UNITS)
    log.unlink()
    assert "cannot read the log" in refused(*words, *UNITS, "--format", "parquet")


def test_parquet_without_pyarrow(
    tmp_path: Path, refused: Refused, imu200: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = builtins.__import__

    def without(name: str, *rest: Any, **more: Any) -> Any:
        if name.startswith("pyarrow"):
            raise ImportError(name)
        return real(name, *rest, **more)

    log = tmp_path / "in.parquet"
    log.write_bytes(b"PAR1")
    monkeypatch.setattr(builtins, "__import__", without)
    line = refused("convert", log, "-o", tmp_path / "o.csv", "--design", imu200, *UNITS)
    assert "pip install 'sculler[formats]'" in line


ROW = "456300.005 0 0 0 0 0 0"
TEXT_FAULTS: dict[str, tuple[tuple[str, ...], tuple[str, ...], str]] = {
    "kfgins short row": ((ROW, "456300.010 0 0 0 0 0"), (), "line 2: accel_z (column 7) is miss"),
    "kfgins nan": ((ROW, "456300.010 0 0 nan 0 0 0"), (), "line 2: gyro_z is 'nan'"),
    "kfgins word": ((ROW, "456300.010 0 0 x 0 0 0"), (), "line 2: gyro_z is 'x'"),
    "kfgins back": (
        (ROW, "456300.010 0 0 0 0 0 0", ROW),
        (),
        "sample 2: time does not grow, it goes back by 0.005 s",
    ),
    "kfgins rate": (
        (ROW, "456300.015 0 0 0 0 0 0"),
        (),
        "shows 100 Hz but sensor.sample_rate_hz = 200",
    ),
    "kfgins column option": (
        (ROW,),
        ("--time-column", "1"),
        "--time-column is not used for format",
    ),
    "euroc not its header": (
        ("t,a,b,c,d,e,f", "1,2,3,4,5,6,7"),
        ("--format", "euroc"),
        "line 1: not the header of a file of format euroc",
    ),
    "euroc stamp with a point": (
        (EUROC, f"{EPOCH},{RATES}", f"{EPOCH}.5,{RATES}"),
        (),
        "line 3: #timestamp [ns] is '1403636579758555392.5', give a whole number",
    ),
    "euroc stamp too long": ((EUROC, f"{10**19},{RATES}"), (), "give a whole number"),
    "euroc stamp of two signs": ((EUROC, f"--1,{RATES}"), (), "give a whole number"),
    "euroc cut short": ((EUROC, f"{EPOCH},1,2"), (), "line 2: w_RS_S_z [rad s^-1] (column 4) is"),
    "euroc one row": ((EUROC, f"{EPOCH},{RATES}"), (), "too few samples to make an increment"),
    "euroc no rows": ((EUROC,), (), "the log has no samples"),
    "euroc columns": (
        (EUROC, f"{EPOCH},{RATES}"),
        ("--format", "euroc", "--gyro-columns", "a,b,c"),
        "--gyro-columns is not used for format euroc",
    ),
}


@pytest.mark.parametrize("case", TEXT_FAULTS)
def test_text_faults(tmp_path: Path, refused: Refused, imu200: Path, case: str) -> None:
    lines, options, message = TEXT_FAULTS[case]
    if case.startswith("kfgins") and "--format" not in options:
        options = ("--format", "kfgins", *options)
    log = write(tmp_path / "in.txt", *lines)
    words = ("convert", log, "-o", tmp_path / "out.csv", "--design", imu200)
    assert message in refused(*words, *options)


def test_column_there_twice(tmp_path: Path, refused: Refused, imu200: Path) -> None:
    log = write(tmp_path / "in.csv", "a,a,b,c,d,e", "1,2,3,4,5,6")
    words = ("convert", log, "-o", tmp_path / "out.csv", "--design", imu200, *UNITS)
    columns = ("--gyro-columns", "a,b,c", "--accel-columns", "d,e,b")
    assert "column 'a' is there twice" in refused(*words, *columns)


def test_kfgins_binary_faults(tmp_path: Path, refused: Refused, imu200: Path) -> None:
    log = tmp_path / "in.bin"
    words = ("convert", log, "-o", tmp_path / "out.csv", "--design", imu200)
    words += ("--format", "kfgins-binary")
    rows = b"".join(struct.pack("<7d", *row) for row in INCREMENTS)
    for content, message in (
        (rows[:-8], "not a whole number of rows of 56"),
        (b"", "the log is empty"),
        (rows[:56] + struct.pack("<7d", *[np.nan] * 7), "sample 1: time is nan"),
        (rows[56:112] + rows[:56], "sample 1: time does not grow, it goes back by 0.005 s"),
    ):
        log.write_bytes(content)
        assert message in refused(*words)
    log.unlink()
    assert "cannot read the log" in refused(*words)


@pytest.mark.parametrize("name", ["in.csv", "in.txt", "in"])
def test_empty_file(tmp_path: Path, refused: Refused, imu200: Path, name: str) -> None:
    log = tmp_path / name
    log.touch()
    words = ("convert", log, "-o", tmp_path / "out.csv", "--design", imu200)
    assert "the log is empty" in refused(*words, *UNITS)


def test_integration_of_a_coning_motion(tmp_path: Path, run: Run) -> None:
    """1°, 20 Hz at 1 kHz: what each treatment of the rates loses of the true drift.

    The gain of each rule over the true sinc, squared: (x/2)/tan(x/2) for means (and the trapezoid
    alike), 1 - 11/720·x⁴ for cubics.  The increments, not the drift, are compared here.
    """
    design = tmp_path / "fine.toml"
    design.write_text(
        DESIGN.replace("200.0", "1000.0").replace("1e-6", "1e-13").replace("24", "32")
    )
    omega, T, count = 2 * np.pi * 20, 1e-3, 200
    t = np.arange(count) * T
    amplitude = np.radians(1) * omega * 1e-3
    wx, wy = amplitude * np.cos(omega * t), amplitude * np.sin(omega * t)
    log = write(
        tmp_path / "in.csv",
        "gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z",
        *(f"{x!r},{y!r},0,0,0,-9.8" for x, y in zip(wx.tolist(), wy.tolist(), strict=True)),
    )
    out = tmp_path / "out.csv"
    words = ("convert", log, "-o", out, "--design", design, *UNITS)
    assert run(*words).status == 0
    counts = np.concatenate([counts for counts, *_ in read_log(out, Design.load(design))])
    theta = counts[2:-2, :2] * 1e-13
    # drift over a step is half the cross product of neighbouring increments, and so is its ratio
    drift = np.mean([a[0] * b[1] - a[1] * b[0] for a, b in pairwise(theta.tolist())])
    x = omega * T
    half = amplitude / omega * 2 * np.sin(x / 2)
    true = half**2 * np.sin(x)
    assert drift / true - 1 == pytest.approx(-11 / 360 * x**4, rel=0.02)
    trapezoid = ((x / 2) / np.tan(x / 2)) ** 2
    assert 1 - trapezoid > 300 * (1 - drift / true)
