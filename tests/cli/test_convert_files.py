"""`convert` reads files as people have them: arrays, comments, commas, bags; or says why not."""

from __future__ import annotations

import base64
import gzip
import json
import os
import sys
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.io

from sculler.commands.convert import command
from sculler.formats.log import read_log
from sculler.readers import registry as formats
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
UNITS = ("--gyro-unit", "rad/s", "--accel-unit", "m/s2")
ROWS = 8
# A constant rate of (1, 2, -3) rad/s and specific force (0, 0.2, -10) m/s², in counts a sample.
GYRO = np.tile([1.0, 2.0, -3.0], (ROWS, 1))
ACCEL = np.tile([0.0, 0.2, -10.0], (ROWS, 1))
TIME = np.arange(ROWS) * 0.005
CONSTANT = [[5000, 10000, -15000, 0, 10, -500]] * (ROWS - 1)


@pytest.fixture
def imu200(tmp_path: Path) -> Path:
    path = tmp_path / "imu200.toml"
    path.write_text(DESIGN)
    return path


@pytest.fixture
def convert(run: Run, tmp_path: Path, imu200: Path) -> Callable[..., tuple[Any, Any]]:
    """Convert; what was said (JSON) and the counts."""

    def convert(log: Path, *options: object) -> tuple[Any, Any]:
        out = tmp_path / "out.csv"
        outcome = run("convert", log, "-o", out, "--design", imu200, "--json", *options)
        assert outcome.status == 0, outcome.err
        chunks = list(read_log(out, Design.load(imu200)))
        return json.loads(outcome.out), np.concatenate([each.counts for each in chunks]).tolist()

    return convert


@pytest.fixture
def refuse(refused: Refused, tmp_path: Path, imu200: Path) -> Refused:
    """The line that refuses a log."""

    def refuse(log: Path, *options: object) -> str:
        return refused("convert", log, "-o", tmp_path / "out.csv", "--design", imu200, *options)

    return refuse


def test_formats_and_options_are_known() -> None:
    """Each format is found by its name, and uses options that there are."""
    options = {option.name for option in command.params}
    names = [each.name for each in formats.every()]
    assert names == list(formats.MODULES)
    page = (Path(__file__).parents[2] / "docs" / "reference" / "input-formats.md").read_text()
    for each in formats.every():
        assert each.options <= options
        assert each.about
        assert f"`{each.name}`" in page


# MAT and HDF5


def hdf5(path: Path, tree: dict[str, Any], matlab: bool) -> Path:
    """An HDF5 file; as MATLAB writes version 7.3: axes turned, classes noted, a head before."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w", userblock_size=512 if matlab else 0) as file:
        for name, value in tree.items():
            array = np.atleast_2d(value).T if matlab else np.asarray(value)
            dataset = file.create_dataset(name.replace(".", "/"), data=array)
            if matlab:
                dataset.attrs["MATLAB_class"] = np.bytes_("double")
    if matlab:
        with path.open("r+b") as file:
            file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM")
    return path


def nested(tree: dict[str, Any]) -> dict[str, Any]:
    """Names with points as dictionaries in each other."""
    result: dict[str, Any] = {}
    for name, value in tree.items():
        *parents, last = name.split(".")
        inner = result
        for parent in parents:
            inner = inner.setdefault(parent, {})
        inner[last] = value
    return result


def save(path: Path, kind: str, tree: dict[str, Any]) -> Path:
    if kind == "mat":
        scipy.io.savemat(path, nested(tree))
        return path
    return hdf5(path, tree, matlab=kind == "v7.3")


TREES: dict[str, tuple[dict[str, Any], tuple[str, ...]]] = {
    "arrays": ({"gyro": GYRO, "accel": ACCEL, "t": TIME}, ()),
    "other names": ({"AngularVelocity": GYRO, "acc": ACCEL, "Timestamp": TIME}, ()),
    "lying": ({"gyro": GYRO.T, "accel": ACCEL.T, "t": TIME[:, None]}, ()),
    "structure": ({"imu.gyro": GYRO, "imu.acc": ACCEL, "imu.t": TIME, "gps.t": [1.0, 2.0]}, ()),
    "deep": ({"data.imu.gyr": GYRO, "data.imu.acc": ACCEL, "data.imu.time": TIME}, ()),
    "time above": ({"imu.gyro": GYRO, "imu.acc": ACCEL, "t": TIME}, ()),
    "two units": (
        {"a.gyro": GYRO * 0, "a.acc": ACCEL, "b.gyro": GYRO, "b.acc": ACCEL, "t": TIME},
        ("--gyro-columns", "b.gyro", "--accel-columns", "b.acc", "--time-column", "t"),
    ),
    "end of a name": (
        {"data.w": GYRO, "data.f": ACCEL, "stamp": TIME},
        ("--gyro-columns", "w", "--accel-columns", "data.f", "--time-column", "stamp"),
    ),
    "columns of arrays": (
        {"g": np.c_[TIME, GYRO], "a": np.c_[ACCEL, TIME]},
        (
            *("--gyro-columns", "g:2,g:3,g:4", "--accel-columns", "a:1,a:2,a:3"),
            *("--time-column", "g:1"),
        ),
    ),
    "vectors": (
        {"wx": GYRO[:, 0], "wy": GYRO[:, 1], "wz": GYRO[:, 2], "f": ACCEL, "t": TIME},
        ("--gyro-columns", "wx,wy,wz", "--accel-columns", "f", "--time-column", "t"),
    ),
    "matrix": (
        {"m": np.c_[TIME, GYRO, ACCEL], "n": TIME},
        (
            *("--variable", "m", "--gyro-columns", "2,3,4", "--accel-columns", "5,6,7"),
            *("--time-column", "1"),
        ),
    ),
}


@pytest.mark.parametrize(
    ("kind", "case"),
    [
        *(("mat", case) for case in TREES),
        *((kind, case) for kind in ("v7.3", "hdf5") for case in ("structure", "lying", "matrix")),
    ],
)
def test_arrays_by_name(tmp_path: Path, convert: Run, kind: str, case: str) -> None:
    tree, options = TREES[case]
    log = save(tmp_path / ("in.h5" if kind == "hdf5" else "in.mat"), kind, tree)
    said, counts = convert(log, *UNITS, *options)
    assert counts == CONSTANT
    assert said["timing"]["rate_hz"] == pytest.approx(200)
    assert said["format"] == ("hdf5" if kind == "hdf5" else "mat")


def test_units_in_the_file(tmp_path: Path, convert: Run) -> None:
    tree = {"gyro": np.degrees(GYRO), "accel": ACCEL / 9.80665, "gyro_unit": "deg/s"}
    log = save(tmp_path / "in.mat", "mat", tree | {"accel_unit": "g"})
    said, counts = convert(log)
    assert counts == CONSTANT
    assert said["timing"] is None


NOT_FOUND: dict[str, tuple[dict[str, Any], tuple[str, ...], str]] = {
    "none": (
        {"a": GYRO, "b": TIME},
        (),
        "no arrays gyro and accel of shape (N, 3); the file has a (8×3), b (8)",
    ),
    "two pairs": (
        {"a.gyro": GYRO, "a.acc": ACCEL, "b.gyro": GYRO, "b.acc": ACCEL},
        (),
        "more than one pair of gyro and accelerometer (a.gyro and b.gyro)",
    ),
    "two gyros": ({"gyro": GYRO, "omega": GYRO, "acc": ACCEL}, (), "gyro and omega are both there"),
    "two times": (
        {"gyro": GYRO, "acc": ACCEL, "t": TIME, "time": TIME},
        (),
        "t and time are both there",
    ),
    "ambiguous end": (
        {"a.w": GYRO, "b.w": GYRO, "f": ACCEL},
        ("--gyro-columns", "w", "--accel-columns", "f"),
        "'w' is the end of a.w and b.w",
    ),
    "no such": (
        {"w": GYRO, "f": ACCEL},
        ("--gyro-columns", "gyro", "--accel-columns", "f"),
        "no array 'gyro'; the file has w (8×3), f (8×3)",
    ),
    "no triple": (
        {"w": TIME, "f": ACCEL},
        ("--gyro-columns", "w", "--accel-columns", "f"),
        "w is no array of three columns",
    ),
    "no vector": (
        {"w": GYRO, "f": ACCEL},
        ("--gyro-columns", "w", "--accel-columns", "f", "--time-column", "w"),
        "name one of its columns as w:1",
    ),
    "one alone": ({"w": GYRO, "f": ACCEL}, ("--gyro-columns", "w"), "go together, give both"),
    "numbers alone": (
        {"w": GYRO, "f": ACCEL},
        ("--gyro-columns", "1,2,3", "--accel-columns", "4,5,6"),
        "columns by number need --variable",
    ),
    "lengths": ({"gyro": GYRO, "acc": ACCEL[1:]}, (), "acc has 7 rows and gyro 8"),
    "nan": ({"gyro": GYRO * np.nan, "acc": ACCEL}, (), "sample 0: gyro_x is nan"),
}


@pytest.mark.parametrize("case", NOT_FOUND)
def test_arrays_that_are_not_found(tmp_path: Path, refuse: Refused, case: str) -> None:
    tree, options, message = NOT_FOUND[case]
    np.savez(tmp_path / "in.npz", **tree)  # the same reader as of MAT, in less time
    assert message in refuse(tmp_path / "in.npz", *UNITS, *options)


def test_hdf5_without_h5py(
    tmp_path: Path, refuse: Refused, monkeypatch: pytest.MonkeyPatch
) -> None:
    log = save(tmp_path / "in.mat", "v7.3", {"gyro": GYRO, "accel": ACCEL})
    monkeypatch.setitem(sys.modules, "h5py", None)
    line = refuse(log, *UNITS)
    assert "version 7.3" in line
    assert "pip install 'sculler[formats]'" in line
    assert "save it again with MATLAB's save -v7" in line


# A MAT file with one wrong byte that ends the process of SciPy 1.17 by a signal, compressed.
CRASHING = (
    b"c-r%I4DoSvQZUskQ1EpO(M`+DNmU5QNi0drFUqx2D9A6)tk6+#E=o--Nlj76&$Chp2hx7|WeP^73Pwg&"
    b"CKgsk779iNMrI69z{o&6VD$9m15yism<@<Ipfm`uLir%$c%d{%t|T)zHNKdEffLBiV4yuPF$RIp_8@o8"
    b"Aj+N042ALKbaUU!jit>;{=X;DeH9FvbaEf5004A|Cky"
)


def test_damaged_mat_files(tmp_path: Path, refuse: Refused, run: Run) -> None:
    log = tmp_path / "in.mat"
    scipy.io.savemat(log, {"gyro": GYRO, "accel": ACCEL}, do_compression=True)
    whole = log.read_bytes()
    for content in (
        zlib.decompress(base64.b85decode(CRASHING)),
        whole[:60],
        whole[:200],
    ):
        log.write_bytes(content)
        assert "not a whole MAT or HDF5 file" in refuse(log, *UNITS)
    # the same reader serves truth files
    truth = tmp_path / "truth.mat"
    truth.write_bytes(zlib.decompress(base64.b85decode(CRASHING)))
    vectors = tmp_path / "v.csv"
    vectors.write_text("")
    outcome = run("navigate", "stim300", vectors, "-o", tmp_path / "nav.csv", "--truth", truth)
    assert outcome.status == 2
    assert "Traceback" not in outcome.err


def test_mat_that_unfolds_is_bounded(
    tmp_path: Path, refuse: Refused, monkeypatch: pytest.MonkeyPatch
) -> None:
    """64 MB of zeros in 64 kB: memory is bounded by what the size explains."""
    monkeypatch.setattr("sculler.readers.apart._LEAST_MEMORY", 16 << 20)
    log = tmp_path / "in.mat"
    scipy.io.savemat(log, {"gyro": np.zeros((3 << 20, 3))}, do_compression=True)
    assert log.stat().st_size < 1 << 17
    assert "MiB of memory to read, which its size does not explain" in refuse(log, *UNITS)


def test_mat_child_is_bounded_in_time(
    tmp_path: Path, refuse: Refused, monkeypatch: pytest.MonkeyPatch
) -> None:
    log = tmp_path / "in.mat"
    scipy.io.savemat(log, {"gyro": GYRO, "accel": ACCEL})
    monkeypatch.setattr("sculler.readers.apart._PATIENCE", 1e-4)
    assert "it took longer to read than its size explains" in refuse(log, *UNITS)


# numbers by their value


@pytest.mark.parametrize("kind", ["float32", "float64", "int32", "uint64"])
def test_stamps_of_every_type(tmp_path: Path, convert: Run, kind: str) -> None:
    """Stamps are taken by value, whatever the type of the array."""
    stamps = (4000 + TIME) if kind.startswith("float") else np.arange(ROWS) * 5_000_000
    log = tmp_path / "in.npz"
    np.savez(log, gyro=GYRO.astype(np.float32), accel=ACCEL, time=stamps.astype(kind))
    said, counts = convert(log, *UNITS)
    assert [row[:3] for row in counts] == [row[:3] for row in CONSTANT]
    assert said["timing"]["rate_hz"] == pytest.approx(200, rel=1e-2)
    assert ("float32: in steps of 0.000244 s" in said["notes"]["time stamps"]) == (
        kind == "float32"
    )


def test_stamp_beyond_every_clock(tmp_path: Path, refuse: Refused) -> None:
    log = tmp_path / "in.npz"
    stamps = np.array([2**63 + k for k in range(ROWS)], np.uint64)
    np.savez(log, gyro=GYRO, accel=ACCEL, time=stamps)
    assert "more than any clock shows" in refuse(log, *UNITS)


def test_parquet_of_ros_in_float_seconds(tmp_path: Path, convert: Run) -> None:
    """Whole seconds and nanoseconds in float columns lose no digit."""
    pa = pytest.importorskip("pyarrow")
    pq = pytest.importorskip("pyarrow.parquet")
    columns: dict[str, Any] = {
        "header.stamp.sec": [1.4e9] * ROWS,
        "header.stamp.nanosec": [5e6 * k for k in range(ROWS)],
    }
    for part, values in (("angular_velocity", GYRO), ("linear_acceleration", ACCEL)):
        columns |= {f"{part}.{axis}": values[:, k] for k, axis in enumerate("xyz")}
    log = tmp_path / "in.parquet"
    pq.write_table(pa.table(columns), log)
    said, counts = convert(log)
    assert counts == CONSTANT
    assert said["timing"]["longest_step_s"] == pytest.approx(0.005, rel=1e-12)


# text

COLUMNS = ("--gyro-columns", "wx,wy,wz", "--accel-columns", "ax,ay,az", "--time-column", "t")
NAMES = ["t", "wx", "wy", "wz", "ax", "ay", "az"]
TABLE = [[f"{time:.3f}", "1", "2", "-3.0", "0", "0.2", "-10"] for time in TIME.tolist()]


def lines(delimiter: str = ",", comma: bool = False, names: bool = True) -> list[str]:
    rows = [delimiter.join(row) for row in TABLE]
    if comma:
        rows = [row.replace(".", ",") for row in rows]
    return [delimiter.join(NAMES)] * names + rows


NUMBERED = ("--gyro-columns", "2,3,4", "--accel-columns", "5,6,7", "--time-column", "1")
TEXTS: dict[str, tuple[list[str], tuple[str, ...]]] = {
    "comments": (
        ["# logger v1", "", "#", *lines()[:3], "# half time", *lines()[3:], " # the end"],
        COLUMNS,
    ),
    "comment after a row": ([row + "  # note, 7" for row in lines()[1:]], NUMBERED),
    "commented header": (["# logger", "# " + lines()[0], *lines()[1:]], COLUMNS),
    "comments before rows": (["# logger", *lines(names=False)], NUMBERED),
    "comments and no columns": (
        ["# made by hand", "t,gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z", *lines()[1:]],
        ("--time-column", "t"),
    ),
    "decimal comma": (lines(";", comma=True), COLUMNS),
    "decimal comma, tabs": (lines("\t", comma=True), COLUMNS),
    "decimal comma, no header": (lines(";", comma=True, names=False), NUMBERED),
    "decimal comma, late": (
        [
            lines(";")[0],
            *[
                row.replace("0.2", "0,2").replace("-3.0", "-3").replace("0.0", "0,0")
                for row in lines(";")[1:]
            ],
        ],
        COLUMNS,
    ),
    "semicolons": (lines(";"), COLUMNS),
}


@pytest.mark.parametrize("ending", ["\n", "\r\n"])
@pytest.mark.parametrize("case", TEXTS)
def test_texts(tmp_path: Path, convert: Run, case: str, ending: str) -> None:
    rows, options = TEXTS[case]
    log = tmp_path / "in.csv"
    log.write_bytes("".join(row + ending for row in rows).encode())
    said, counts = convert(log, *UNITS, *options)
    assert counts == CONSTANT
    assert said["timing"]["longest_step_s"] == pytest.approx(0.005)
    assert ("numbers" in said["notes"]) == case.startswith("decimal")


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "utf-32"])
def test_encodings(tmp_path: Path, convert: Run, encoding: str) -> None:
    mark = "\ufeff" if encoding in ("utf-16-le", "utf-16-be") else ""
    log = tmp_path / "in.csv"
    log.write_bytes((mark + "\r\n".join(lines(";", comma=True)) + "\r\n").encode(encoding))
    _, counts = convert(log, *UNITS, *COLUMNS)
    assert counts == CONSTANT


def test_mixed_marks_are_refused(tmp_path: Path, refuse: Refused) -> None:
    """1.234 in a file of decimal commas may be a thousand: nobody can tell."""
    log = tmp_path / "in.csv"
    rows = lines(";", comma=True)
    rows[5] = rows[5].replace("-10", "-1.000")
    log.write_text("\n".join(rows) + "\n")
    line = refuse(log, *UNITS, *COLUMNS)
    assert "line 6: az is '-1.000', but other numbers have a decimal comma" in line


def test_a_row_cut_by_a_comment_is_refused(tmp_path: Path, refuse: Refused) -> None:
    log = tmp_path / "in.csv"
    rows = lines()
    rows[3] = rows[3].replace(",-10", " # -10")
    log.write_text("\n".join(rows) + "\n")
    assert "line 4: az (column 7) is missing" in refuse(log, *UNITS, *COLUMNS)


EUROC = (
    "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
    "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]"
)


def test_stamps_with_an_exponent(tmp_path: Path, convert: Run) -> None:
    """1.40363657976E+18 is a whole number of ns, and taken as such; that it is rounded is told."""
    log = tmp_path / "in.csv"
    values = ",1,2,-3,0,0.2,-10\n"
    stamps = [f"1.403636579{760 + 5 * k}E+18" for k in range(ROWS)]
    log.write_text(EUROC + "\n" + "".join(stamp + values for stamp in stamps))
    said, counts = convert(log)
    assert counts == CONSTANT
    assert said["timing"]["longest_step_s"] == pytest.approx(0.005, rel=1e-12)
    assert any("they tell times to 0.001 s only" in each for each in said["warnings"])


def test_a_stamp_that_is_not_whole(tmp_path: Path, refuse: Refused) -> None:
    log = tmp_path / "in.csv"
    log.write_text(EUROC + "\n1.5E+0,1,2,-3,0,0.2,-10\n1403636579760000000,1,2,-3,0,0.2,-10\n")
    assert "line 2: #timestamp [ns] is '1.5E+0', give a whole number" in refuse(log)


# files that are no text

NO_TEXT: dict[str, tuple[bytes, str]] = {
    "gzip": (gzip.compress(b"t,wx\n1,2\n"), "compressed with gzip, no text: unpack it first"),
    "zip": (b"PK\x03\x04" + bytes(22) + b"\x05\x00\x00\x00a.csv" + b"junk", "a zip archive"),
    "xlsx": (
        b"PK\x03\x04" + bytes(22) + b"\x13\x00\x00\x00[Content_Types].xml" + b"junk",
        "a spreadsheet, no text: save the sheet as CSV",
    ),
    "npy": (b"\x93NUMPY\x01\x00v", "save it with numpy.savez"),
    "old excel": (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(99), "save the sheet as CSV"),
    "ulog": (b"ULog\x01\x12\x35\x01" + bytes(99), "ulog2csv"),
    "tar": (b"imu.csv".ljust(257, b"\0") + b"ustar  ", "a tar archive"),
    "zeros": (bytes(999), "no text, byte 0 is 0"),
    "latin-1": ("t,wx °/s\n".encode("latin-1"), "not a text file in UTF-8 at byte 5, save it as"),
}


@pytest.mark.parametrize("case", NO_TEXT)
def test_files_that_are_no_text(tmp_path: Path, refuse: Refused, case: str) -> None:
    content, message = NO_TEXT[case]
    log = tmp_path / "in.dat"
    log.write_bytes(content)
    assert message in refuse(log, *UNITS)
    # the same where the user takes it for a text
    assert message in refuse(log, *UNITS, *COLUMNS)
    assert message in refuse(log, *UNITS, "--format", "csv")


@pytest.mark.parametrize(
    ("magic", "message"),
    [
        (b"#ROSBAG V2.0\n", "a ROS 1 bag, no text: leave --format out, or give --format rosbag"),
        (b"\x89MCAP0\r\n", "an MCAP file"),
        (b"SQLite format 3\0", "an SQLite database"),
        (b"MATLAB 5.0", "a MAT file"),
        (b"\x89HDF\r\n\x1a\n", "an HDF5 file"),
        (b"PAR1", "a Parquet file"),
    ],
)
def test_known_files_taken_for_text(
    tmp_path: Path, refuse: Refused, magic: bytes, message: str
) -> None:
    log = tmp_path / "in.csv"
    log.write_bytes(magic + bytes(99))
    assert message in refuse(log, *UNITS, "--format", "csv")


def test_damaged_npz_of_unknown_compression(tmp_path: Path, refuse: Refused) -> None:
    log = tmp_path / "in.npz"
    np.savez_compressed(log, gyro=GYRO, accel=ACCEL)
    content = bytearray(log.read_bytes())
    for magic, offset in ((b"PK\x03\x04", 8), (b"PK\x01\x02", 10)):
        content[content.index(magic) + offset] = 99
    log.write_bytes(content)
    assert "not a whole .npz file" in refuse(log, *UNITS)


# ROS bags


def imu_message(store: Any, stamp: int, gyro: Any, accel: Any) -> Any:
    types = store.types
    vector, zero = types["geometry_msgs/msg/Vector3"], np.zeros(9)
    header: dict[str, Any] = {
        "stamp": types["builtin_interfaces/msg/Time"](sec=stamp // 10**9, nanosec=stamp % 10**9),
        "frame_id": "imu",
    }
    if any(name == "seq" for name, _ in store.fielddefs["std_msgs/msg/Header"][1]):
        header["seq"] = 0
    return types["sensor_msgs/msg/Imu"](
        header=types["std_msgs/msg/Header"](**header),
        orientation=types["geometry_msgs/msg/Quaternion"](x=0.0, y=0.0, z=0.0, w=1.0),
        orientation_covariance=zero,
        angular_velocity=vector(**dict(zip("xyz", gyro, strict=True))),
        angular_velocity_covariance=zero,
        linear_acceleration=vector(**dict(zip("xyz", accel, strict=True))),
        linear_acceleration_covariance=zero,
    )


EPOCH = 1_403_636_579_758_555_392
IMU, TEMPERATURE = "sensor_msgs/msg/Imu", "std_msgs/msg/Float64"


def write_bag(
    path: Path, kind: str, topics: tuple[str, ...] = ("/imu",), stamp: int = EPOCH
) -> Path:
    """A bag of ROWS messages a topic, and of numbers; the file or folder to give."""
    typesys = pytest.importorskip("rosbags.typesys")
    rosbag1 = pytest.importorskip("rosbags.rosbag1")
    rosbag2 = pytest.importorskip("rosbags.rosbag2")
    ros1 = kind == "bag"
    store = typesys.get_typestore(
        typesys.Stores.ROS1_NOETIC if ros1 else typesys.Stores.ROS2_HUMBLE
    )
    if ros1:
        path = path.with_suffix(".bag")
        writer = rosbag1.Writer(path)
    else:
        storage = "MCAP" if kind == "mcap" else "SQLITE3"
        writer = rosbag2.Writer(path, version=9, storage_plugin=rosbag2.StoragePlugin[storage])
    serialise = store.serialize_ros1 if ros1 else store.serialize_cdr
    with writer:
        other = writer.add_connection("/temperature", TEMPERATURE, typestore=store)
        number = store.types[TEMPERATURE](data=20.0)
        for at, topic in enumerate(topics):
            connection = writer.add_connection(topic, IMU, typestore=store)
            for k in range(ROWS):
                own = imu_message(
                    store, stamp and stamp + 5_000_000 * k, GYRO[k] * (at + 1), ACCEL[k]
                )
                writer.write(connection, EPOCH + 5_000_000 * k + 1234 * k * k, serialise(own, IMU))
        writer.write(other, EPOCH, serialise(number, TEMPERATURE))
    return path


@pytest.mark.parametrize("kind", ["bag", "mcap", "db3"])
def test_bags(tmp_path: Path, convert: Run, kind: str) -> None:
    bag = write_bag(tmp_path / "rec", kind)
    given = [bag] if kind == "bag" else [bag, *bag.glob(f"*.{kind}")]
    assert len(given) == (1 if kind == "bag" else 2)
    for each in given:
        said, counts = convert(each)
        assert said["format"] == "rosbag"
        assert counts == CONSTANT
        assert said["notes"]["topic"] == "/imu"
        # the stamps of the headers, not the times of recording
        assert said["timing"]["longest_step_s"] == pytest.approx(0.005, rel=1e-12)
        assert said["timing"]["start_s"] == pytest.approx(EPOCH * 1e-9)


def test_bag_of_several_units(tmp_path: Path, convert: Run, refuse: Refused) -> None:
    bag = write_bag(tmp_path / "rec", "mcap", ("/a/imu", "/b/imu"))
    assert "several topics of an IMU, give --topic, one of /a/imu, /b/imu" in refuse(bag)
    _, counts = convert(bag, "--topic", "/b/imu")
    assert counts[0][:3] == [10000, 20000, -30000]
    (tmp_path / "out.csv").unlink()
    assert "topic /c is not there" in refuse(bag, "--topic", "/c")
    line = refuse(bag, "--topic", "/temperature")
    assert "is of type std_msgs/msg/Float64" in line


def test_bag_without_an_imu_or_stamps(tmp_path: Path, convert: Run, refuse: Refused) -> None:
    bag = write_bag(tmp_path / "none", "bag", ())
    assert "no topic of type sensor_msgs/msg/Imu, the bag has /temperature" in refuse(bag)
    bag = write_bag(tmp_path / "zero", "bag", stamp=0)
    said, _ = convert(bag)
    assert "time of recording" in said["notes"]["time stamps"]


def test_damaged_bags(tmp_path: Path, refuse: Refused) -> None:
    for kind in ("bag", "mcap", "db3"):
        bag = write_bag(tmp_path / f"rec{kind}", kind)
        file = bag if kind == "bag" else next(bag.glob(f"*.{kind}"))
        whole = file.read_bytes()
        for content in (whole[: len(whole) // 2], whole[:40], whole[:90] + b"\xff" * 900):
            file.write_bytes(content)
            line = refuse(file)
            assert "not a whole ROS bag" in line or "no topic" in line
        file.write_bytes(b"")
        assert "empty" in refuse(file)
        if kind != "bag":
            file.write_bytes(whole)
            other = file.rename(tmp_path / f"{kind}.dat")
            assert f"must be called *.{kind}" in refuse(other)
    (tmp_path / "folder").mkdir()
    assert "without metadata.yaml" in refuse(tmp_path / "folder")


def test_bag_without_rosbags(
    tmp_path: Path, refuse: Refused, monkeypatch: pytest.MonkeyPatch
) -> None:
    bag = tmp_path / "in.bag"
    bag.write_bytes(b"#ROSBAG V2.0\n" + bytes(99))
    for name in [name for name in sys.modules if name.split(".")[0] == "rosbags"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "rosbags", None)
    assert "pip install 'sculler[formats]'" in refuse(bag)


def test_help_loads_no_reader(run: Run) -> None:
    """Help is quick: no library of any format is loaded for it."""
    code = (
        "import sys; from sculler.main import main; main(['convert', '--help']);"
        "print([n for n in ('numpy', 'scipy', 'h5py', 'rosbags', 'pyarrow') if n in sys.modules])"
    )
    import subprocess

    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, env=os.environ
    )
    assert done.stdout.splitlines()[-1] == "[]"
    assert all(name in done.stdout.replace("\n", "").replace(" ", "") for name in formats.MODULES)
