"""Navigation states as binary frames with a CRC (docs/reference/telemetry.md).

The same frames are written by the host in C, sculler_telemetry.c.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sculler.formats.tables import Block
from sculler_model.errors import InputError
from sculler_model.navigation import NavHistory

BEGINNING = b"SN\x01\x01\x68\x00"
"""Mark, version 1, kind 1 (a navigation state), 104 bytes of payload."""

FRAME = np.dtype(
    [
        ("beginning", f"S{len(BEGINNING)}"),
        ("status", "<u2"),
        ("number", "<u8"),
        ("time", "<f8"),
        ("q", "<f8", 4),  # x, y, z, w
        ("v", "<f8", 3),
        ("place", "<f8", 3),
        ("wander", "<f8"),
        ("crc", "<u4"),
    ]
)
"""A frame, packed."""

_CHECKED = FRAME.itemsize - 4
_FRAMES = 20_000  # read at a time


def frames_of(history: NavHistory, status: NDArray[np.int64], first: int) -> bytes:
    """States as frames.

    Args:
        history: (N,) states.
        status: (N,) status bits of the results that they come from.
        first: number of the first frame.
    """
    frames = np.zeros(len(history), FRAME)
    frames["beginning"], frames["status"] = BEGINNING, status
    frames["number"] = first + np.arange(len(history))
    frames["time"], frames["q"], frames["v"] = history.time, history.q[:, [1, 2, 3, 0]], history.v
    frames["place"] = np.column_stack((history.lat, history.lon, history.h))
    frames["wander"] = history.wander
    frames["crc"] = _crcs(frames)
    return frames.tobytes()


def telemetry_columns(path: Path) -> tuple[list[str], Iterator[Block]]:
    """A file of frames as the columns of a truth file, block by block.

    Raises:
        InputError: it is cut short, or the CRC or the beginning of a frame is wrong.
    """
    names = ["time_s", "q_w", "q_x", "q_y", "q_z", "v_north", "v_east", "v_down"]
    names += ["lat_deg", "lon_deg", "height_m"]

    def blocks() -> Iterator[Block]:
        for frames in _read(path):
            place = frames["place"]
            columns = (
                frames["time"],
                *frames["q"][:, [3, 0, 1, 2]].T,
                *frames["v"].T,
                *np.degrees(place[:, :2]).T,
                place[:, 2],
            )
            yield dict(zip(names, columns, strict=True))

    return names, blocks()


def _read(path: Path) -> Iterator[NDArray[np.void]]:
    """The frames of a file, each looked at."""
    number = 0
    with path.open("rb") as file:
        while data := file.read(_FRAMES * FRAME.itemsize):
            if len(data) % FRAME.itemsize:
                raise InputError(
                    f"{path}: the last frame is cut short, {len(data) % FRAME.itemsize} bytes of"
                    f" {FRAME.itemsize}; leave it out"
                )
            frames = np.frombuffer(data, FRAME)
            wrong = (frames["beginning"] != BEGINNING.rstrip(b"\0")) | (
                frames["crc"] != _crcs(frames)
            )
            if wrong.any():
                row = number + int(np.argmax(wrong))
                raise InputError(
                    f"{path}: frame {row + 1}, from byte {row * FRAME.itemsize} on, is damaged (its"
                    " beginning or its CRC is wrong); leave it out, or record again"
                )
            number += len(frames)
            yield frames


def _crcs(frames: NDArray[np.void]) -> NDArray[np.uint32]:
    """CRC-32 of each frame's bytes before it."""
    data, size = memoryview(frames.tobytes()), FRAME.itemsize
    starts = range(0, len(data), size)
    return np.fromiter((zlib.crc32(data[k : k + _CHECKED]) for k in starts), np.uint32)
