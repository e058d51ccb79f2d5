"""ROS bags through the maintained package `rosbags`: ROS 1 `.bag`, ROS 2 folders, `.mcap`, `.db3`.

Samples are the messages sensor_msgs/Imu of one topic: angular velocity (rad/s) and linear
acceleration (m/s²) with the stamp of the message's header, in the order of the recording.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from sculler.formats.log import COUNTS
from sculler.readers.format import UNITS, Format, Request, begins
from sculler.readers.recording import Clock, Recording, Samples, require_finite
from sculler_model.errors import InputError

_IMU = "sensor_msgs/msg/Imu"
_CHUNK_ROWS = 1 << 12
_ROS1 = b"#ROSBAG"
_SUFFIXES = ((_ROS1, ".bag"), (b"\x89MCAP0\r\n", ".mcap"), (b"SQLite format 3\0", ".db3"))


def read_rosbag(path: Path, request: Request) -> Recording:
    """The messages of an IMU's topic, read as its samples are drawn.

    Raises:
        InputError: rosbags is absent, the bag cannot be read, or there is no such topic or more
            than one; the message lists them.
    """
    units = request.units("rad/s", "m/s2")
    with _opened(path) as bag:
        topic = _topic(path, bag, request.topic)
        first = next(_messages(bag, topic), None)
        share = _size(path) / max(bag.message_count, 1)
    if first is None:
        raise InputError(f"{path}: topic {topic} has no messages, give another with --topic")
    by_header = first[0] != 0
    clock = Clock("ns")
    stamp = "header.stamp" if by_header else "time of recording, for header.stamp is 0"
    notes = {"topic": topic, "time stamps": f"{stamp}, ns"}

    def chunks() -> Iterator[Samples]:
        number = 0
        with _opened(path) as bag:
            messages = _messages(bag, topic)
            while some := list(islice(messages, _CHUNK_ROWS)):
                values = np.array([message[2:] for message in some])
                require_finite(path, number, values, COUNTS)
                number += len(some)
                stamps = np.array([message[0 if by_header else 1] for message in some], np.int64)
                request.advance(round(share * len(some)))
                yield Samples(values, times=clock(stamps))

    return Recording(*units, chunks(), clock=clock, notes=notes)


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    """The bag, open.

    Raises:
        InputError: rosbags is absent, or (within the context) the bag proves to be damaged.
    """
    try:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore
    except ImportError as error:
        raise InputError(
            f"{path}: reading ROS bags needs rosbags, run: pip install 'sculler[formats]'"
        ) from error
    _require_name(path)
    try:
        store = get_typestore(Stores.LATEST)
        with AnyReader([path], default_typestore=store) as bag:
            yield bag
    except (InputError, GeneratorExit):
        raise
    except OSError as error:
        raise InputError(
            f"{path}: cannot read the bag ({error.strerror or error}), check the path"
        ) from error
    except Exception as error:  # of damaged bags any: of assertions, of the unpackers, of yaml
        text = str(error) or type(error).__name__
        raise InputError(
            f"{path}: not a whole ROS bag ({text[:200]}), record it again, or mend it (rosbag"
            " reindex, mcap recover)"
        ) from error


def _require_name(path: Path) -> None:
    """Whether the name says what the file is, which rosbags goes by."""
    if path.is_dir():
        if not (path / "metadata.yaml").exists():
            raise InputError(
                f"{path}: a folder without metadata.yaml, so no ROS 2 bag; give a file, or mend the"
                " bag (ros2 bag reindex)"
            )
        return
    try:
        with path.open("rb") as file:
            head = file.read(16)
    except OSError as error:
        raise InputError(
            f"{path}: cannot read the bag ({error.strerror}), check the path"
        ) from error
    if not head:
        raise InputError(f"{path}: the bag is empty, record it again")
    for magic, suffix in _SUFFIXES:
        if head.startswith(magic):
            if path.suffix != suffix:
                raise InputError(f"{path}: such a bag must be called *{suffix}, rename it")
            return
    raise InputError(f"{path}: no ROS bag by its first bytes, check --format")


def _topic(path: Path, bag: Any, wanted: str | None) -> str:
    """The topic asked for, or the only one of an IMU."""
    topics: dict[str, str | None] = {name: info.msgtype for name, info in bag.topics.items()}
    imus = [name for name, kind in topics.items() if kind == _IMU]
    if wanted is not None:
        if wanted in imus:
            return wanted
        kind = f"is of type {topics[wanted]}" if wanted in topics else "is not there"
        raise InputError(
            f"{path}: topic {wanted} {kind}, give --topic, one of {', '.join(imus) or 'none'} (of"
            f" {_IMU})"
        )
    if len(imus) == 1:
        return imus[0]
    if imus:
        raise InputError(
            f"{path}: several topics of an IMU, give --topic, one of {', '.join(imus)}"
        )
    there = ", ".join(f"{name} ({kind})" for name, kind in topics.items())[:300]
    raise InputError(f"{path}: no topic of type {_IMU}, the bag has {there or 'none'}")


def _messages(bag: Any, topic: str) -> Iterator[tuple[float, ...]]:
    """Stamp of the header and time of recording, ns, and the six values of each message."""
    connections = [each for each in bag.connections if each.topic == topic]
    for connection, time, content in bag.messages(connections):
        message = bag.deserialize(content, connection.msgtype)
        stamp, rate, force = (
            message.header.stamp,
            message.angular_velocity,
            message.linear_acceleration,
        )
        yield (
            stamp.sec * 10**9 + stamp.nanosec,
            time,
            *(rate.x, rate.y, rate.z),
            *(force.x, force.y, force.z),
        )


def _size(path: Path) -> int:
    files = path.iterdir() if path.is_dir() else [path]
    return sum(file.stat().st_size for file in files)


FORMATS = (
    Format(
        "rosbag",
        "ROS 1 bags, ROS 2 bags (folders, .db3), MCAP",
        read_rosbag,
        UNITS | {"topic"},
        begins(*(magic for magic, _ in _SUFFIXES)),
        (".bag", ".mcap", ".db3"),
    ),
)
