"""What files that are no text are, by their first bytes, and what to do with them."""

from __future__ import annotations

import re
from typing import NamedTuple


class Signature(NamedTuple):
    """How a kind of file begins.

    Attributes:
        magic: its bytes.
        what: it is.
        cure: what to do.
        at: the byte, from 0, where `magic` stands.
    """

    magic: bytes
    what: str
    cure: str
    at: int = 0


_READ = "leave --format out, or give --format {}"
_UNPACK = "unpack it first"
_AS_TEXT = "save the sheet as CSV"
_OTHER = "give a log of an IMU"

SIGNATURES = (
    Signature(b"#ROSBAG", "a ROS 1 bag", _READ.format("rosbag")),
    Signature(b"\x89MCAP0\r\n", "an MCAP file", _READ.format("rosbag")),
    Signature(
        b"SQLite format 3\x00",
        "an SQLite database",
        f"{_READ.format('rosbag')} if it is a ROS 2 bag",
    ),
    Signature(b"MATLAB ", "a MAT file", _READ.format("mat")),
    Signature(b"\x89HDF\r\n\x1a\n", "an HDF5 file", _READ.format("hdf5")),
    Signature(b"PAR1", "a Parquet file", _READ.format("parquet")),
    Signature(b"\x93NUMPY", "one NumPy array without a name", "save it with numpy.savez"),
    Signature(b"\x1f\x8b", "compressed with gzip", f"{_UNPACK} (gunzip)"),
    Signature(b"BZh", "compressed with bzip2", f"{_UNPACK} (bunzip2)"),
    Signature(b"\xfd7zXZ\x00", "compressed with xz", f"{_UNPACK} (unxz)"),
    Signature(b"\x28\xb5\x2f\xfd", "compressed with zstd", f"{_UNPACK} (unzstd)"),
    Signature(b"\x04\x22\x4d\x18", "compressed with lz4", f"{_UNPACK} (unlz4)"),
    Signature(b"7z\xbc\xaf\x27\x1c", "a 7z archive", _UNPACK),
    Signature(b"Rar!\x1a\x07", "a RAR archive", _UNPACK),
    Signature(b"ustar", "a tar archive", f"{_UNPACK} (tar -x)", 257),
    Signature(b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "a file of old Excel or Word", _AS_TEXT),
    Signature(b"ARROW1", "an Arrow (Feather) file", "save it as Parquet"),
    Signature(b"ULog\x01\x12\x35", "a ULog of PX4", "export its sensor topics as CSV (ulog2csv)"),
    Signature(
        b"\xa3\x95\x80\x80", "a DataFlash log of ArduPilot", "export its IMU messages as CSV"
    ),
    Signature(b"%PDF", "a PDF file", _OTHER),
    Signature(b"\x89PNG", "a PNG picture", _OTHER),
    Signature(b"\xff\xd8\xff", "a JPEG picture", _OTHER),
    Signature(b"\x7fELF", "a program", _OTHER),
    Signature(b"\x80\x04\x95", "a Python pickle", "save its arrays with numpy.savez"),
)

HEAD_BYTES = 512
"""Bytes that are enough to tell."""

_ENTRY = re.compile(rb"PK\x03\x04.{22}(..)(..)", re.DOTALL)


def is_npz(head: bytes) -> bool:
    """Whether a zip file's first bytes are of one with arrays; whole or not, if it names none."""
    name = _first_entry(head)
    return name is None or name.endswith(b".npy")


def _first_entry(head: bytes) -> bytes | None:
    """Name of the first file in a zip file."""
    found = _ENTRY.match(head)
    if found is None:
        return None
    return head[30 : 30 + int.from_bytes(found[1], "little")] or None


def told(head: bytes) -> str | None:
    """What a file is that begins so, and what to do; None if that is not known."""
    for magic, what, cure, at in SIGNATURES:
        if head[at:].startswith(magic):
            return f"{what}, no text: {cure}"
    if head.startswith(b"PK\x03\x04"):
        name = _first_entry(head) or b""
        if name.endswith(b".npy"):
            return f"an .npz file, no text: {_READ.format('npz')}"
        sheet = name.startswith((b"[Content_Types]", b"_rels", b"xl/", b"mimetype"))
        what, cure = ("a spreadsheet", _AS_TEXT) if sheet else ("a zip archive", _UNPACK)
        return f"{what}, no text: {cure}"
    return None
