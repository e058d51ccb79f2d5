"""Examples of raw datagrams, ROS bags and HDF5."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np

import raw_datagrams as raw

ROWS = 60
EPOCH = 1_403_636_579_758_555_392


def write_recordings(folder: Path) -> None:
    """Write one of each kind, 100 samples a second."""
    for name, content in _datagrams().items():
        (folder / name).write_bytes(content)
    _write_bag(folder / "imu.bag", "ROS1_NOETIC")
    _write_bag(folder / "bag2", "ROS2_HUMBLE", "MCAP")
    _write_bag(folder / "bag3", "ROS2_HUMBLE", "SQLITE3")
    for kept, name in (("bag2", "imu.mcap"), ("bag3", "imu.db3")):
        inside = next((folder / kept).glob(f"*{Path(name).suffix}"))
        inside.rename(folder / name)
        for left in (folder / kept).iterdir():
            left.unlink()
        (folder / kept).rmdir()
    _write_hdf5(folder / "imu.h5")


def _datagrams() -> dict[str, bytes]:
    samples = [([k, -2 * k, 300], [9, -k, -2000]) for k in range(ROWS)]
    force = struct.pack("<3f", 0.01, 0.0, -0.098)
    turn = struct.pack("<3f", 0.1, -0.2, 0.3)
    made = {
        "stim300.bin": [raw.stim300(*each, k) for k, each in enumerate(samples)],
        "novatel.bin": [
            raw.novatel(1462, 2000, 100 + k / 100, *each) for k, each in enumerate(samples)
        ],
        "vectornav.bin": [
            raw.vectornav({
                1: {0: struct.pack("<Q", 5_000_000_000 + 10_000_000 * k)},
                2: {6: struct.pack("<f", 0.01) + turn, 7: force},
            })
            for k in range(ROWS)
        ],
        "xsens.bin": [
            raw.xsens([
                (0x1060, struct.pack(">I", 100 * k)),
                (0x8033, struct.pack(">4d", 1, 0, 0, 0)),
                (0x4013, struct.pack(">3d", 0.01, 0, -0.098)),
            ])
            for k in range(ROWS)
        ],
        "adis16495.bin": [raw.adis16495(*each, k) for k, each in enumerate(samples)],
        "adis16470.bin": [raw.adis16470(*each, k) for k, each in enumerate(samples)],
        "hg4930.bin": [raw.hg4930(*each, k) for k, each in enumerate(samples)],
    }  # fmt: skip
    return {name: b"".join(parts) for name, parts in made.items()}


def _write_bag(path: Path, kind: str, storage: str | None = None) -> None:
    from rosbags import rosbag1, rosbag2
    from rosbags.typesys import Stores, get_typestore

    store, imu = get_typestore(Stores[kind]), "sensor_msgs/msg/Imu"
    writer: Any
    if storage is None:
        writer, serialise = rosbag1.Writer(path), store.serialize_ros1
    else:
        plugin = rosbag2.StoragePlugin[storage]
        writer = rosbag2.Writer(path, version=9, storage_plugin=plugin)
        serialise = store.serialize_cdr
    with writer:
        connection = writer.add_connection("/imu", imu, typestore=store)
        for k in range(ROWS):
            stamp = EPOCH + 10_000_000 * k
            writer.write(connection, stamp, serialise(_imu_message(store, stamp, k), imu))


def _imu_message(store: Any, stamp: int, number: int) -> Any:
    types = store.types
    header: dict[str, Any] = {
        "stamp": types["builtin_interfaces/msg/Time"](*divmod(stamp, 10**9)),
        "frame_id": "imu",
    }
    if "seq" in types["std_msgs/msg/Header"].__dataclass_fields__:
        header["seq"] = number
    vector = types["geometry_msgs/msg/Vector3"]
    nothing = np.zeros(9)
    return types["sensor_msgs/msg/Imu"](
        header=types["std_msgs/msg/Header"](**header),
        orientation=types["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 1.0),
        orientation_covariance=nothing,
        angular_velocity=vector(0.1, -0.2, 0.3),
        angular_velocity_covariance=nothing,
        linear_acceleration=vector(0.0, 0.1, -9.8),
        linear_acceleration_covariance=nothing,
    )


def _write_hdf5(path: Path) -> None:
    import h5py

    with h5py.File(path, "w") as file:
        file["gyro"] = np.full((ROWS, 3), 0.1)
        file["accel"] = np.full((ROWS, 3), -9.8)
        file["time"] = np.arange(ROWS) / 100
