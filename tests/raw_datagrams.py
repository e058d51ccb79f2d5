"""Datagrams of sensors, made from the published layouts, bit by bit and number by number.

Nothing here comes from the readers: the CRCs go one bit at a time, the layouts stand as `struct`
formats.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Sequence


def crc_msb_first(data: bytes, bits: int, polynomial: int, value: int) -> int:
    """A CRC that takes the most significant bit first."""
    for byte in data:
        for bit in range(7, -1, -1):
            high = value >> (bits - 1) & 1
            value = (value << 1) & ((1 << bits) - 1)
            if high ^ (byte >> bit & 1):
                value ^= polynomial
    return value


def crc_lsb_first(data: bytes, value: int) -> int:
    """CRC-32 with the reflected polynomial EDB88320, nothing XORed to it."""
    for byte in data:
        for bit in range(8):
            low = value & 1 ^ byte >> bit & 1
            value = value >> 1 ^ (0xEDB88320 if low else 0)
    return value


def int24(values: Sequence[int]) -> bytes:
    return b"".join(value.to_bytes(3, "big", signed=True) for value in values)


PADDING = {0x90: 2, 0x91: 0, 0x93: 2, 0xA5: 2, 0xA7: 1, 0x9B: 2}
"""Zeros that Sensonor's data sheet has after datagrams of these identifiers, for the CRC."""


def stim300(
    gyro: Sequence[int],
    accel: Sequence[int],
    counter: int,
    identifier: int = 0x91,
    status: int = 0,
    latency: int = 200,
) -> bytes:
    """A datagram of the normal mode."""
    body = bytes([identifier]) + int24(gyro) + bytes([status])
    if identifier in (0x91, 0x93, 0xA5, 0xA7, 0x9B):
        body += int24(accel) + b"\0"
    if identifier in (0x93, 0xA7, 0x9B):
        body += int24([1, 2, 3]) + b"\0"  # inclinometers
    if identifier == 0xA5:
        body += 2 * (struct.pack(">3h", 25 * 256, 25 * 256, 25 * 256) + b"\0")
    if identifier == 0xA7:
        body += 3 * (struct.pack(">3h", 25 * 256, 25 * 256, 25 * 256) + b"\0")
    if identifier == 0x9B:
        body += int24([77]) + b"\0"
    body += struct.pack(">BH", counter % 256, latency)
    crc = crc_msb_first(body + bytes(PADDING[identifier]), 32, 0x04C11DB7, 0xFFFFFFFF)
    return body + struct.pack(">I", crc)


def stim300_of_a_recorder(gyro: Sequence[int], accel: Sequence[int], counter: int) -> bytes:
    """Identifier 93 with gyro and accelerometer alone, and zip's CRC."""
    body = b"\x93" + int24(gyro) + b"\0" + int24(accel) + b"\0"
    body += struct.pack(">BH", counter % 256, 200)
    return body + struct.pack(">I", zlib.crc32(body))


def novatel(
    message: int,
    week: int,
    seconds: float,
    gyro: Sequence[int],
    accel: Sequence[int],
    imu_type: int = 8,
    info: int = 0,
) -> bytes:
    """RAWIMU (268), RAWIMUS (325), RAWIMUX (1461) or RAWIMUSX (1462)."""
    counts = (accel[2], -accel[1], accel[0], gyro[2], -gyro[1], gyro[0])
    if message in (268, 325):
        body = struct.pack("<IdI6i", week, seconds, 0x77, *counts)
    else:
        body = struct.pack("<BBHdI6i", info, imu_type, week, seconds, 0x77, *counts)
    return novatel_message(message, body, short=message in (325, 1462))


def novatel_message(message: int, body: bytes, short: bool) -> bytes:
    """Any message with its header and CRC."""
    if short:
        head = struct.pack("<3sBHHI", b"\xaa\x44\x13", len(body), message, 2000, 0)
    else:
        head = struct.pack(
            "<3sBHBBHHBBHIIHH",
            *(b"\xaa\x44\x12", 28, message, 0, 0x20, len(body), 0, 100, 180, 2000, 0, 0, 0, 0),
        )
    return head + body + struct.pack("<I", crc_lsb_first(head + body, 0))


def vectornav(groups: dict[int, dict[int, bytes]]) -> bytes:
    """A binary output message: fields by group and bit, in any order."""
    head, fields = bytes([sum(1 << group for group in groups)]), b""
    for group in sorted(groups):
        head += struct.pack("<H", sum(1 << bit for bit in groups[group]))
        fields += b"".join(groups[group][bit] for bit in sorted(groups[group]))
    return b"\xfa" + head + fields + struct.pack(">H", crc_msb_first(head + fields, 16, 0x1021, 0))


def xsens(packets: Sequence[tuple[int, bytes]], message: int = 0x36) -> bytes:
    """An Xbus message of packets."""
    data = b"".join(struct.pack(">HB", name, len(value)) + value for name, value in packets)
    length = bytes([len(data)]) if len(data) < 255 else b"\xff" + struct.pack(">H", len(data))
    body = bytes([0xFF, message]) + length + data
    return b"\xfa" + body + bytes([-sum(body) % 256])


def adis16495(gyro: Sequence[int], accel: Sequence[int], counter: int, flags: int = 0) -> bytes:
    """A burst of 36 bytes."""
    words = [flags, 0x0200]
    for value in (*gyro, *accel):
        words += [value & 0xFFFF, value >> 16 & 0xFFFF]
    words.append(counter & 0xFFFF)
    crc = zlib.crc32(struct.pack("<15H", *words))
    return b"\xa5\xa5" + struct.pack(">15H", *words) + struct.pack(">HH", crc & 0xFFFF, crc >> 16)


def adis16470(gyro: Sequence[int], accel: Sequence[int], counter: int, long: bool = False) -> bytes:
    """A burst of 20 bytes, or of 32."""
    body = struct.pack(">H", 0)
    for value in (*gyro, *accel):
        if long:
            body += struct.pack(">HH", value & 0xFFFF, value >> 16 & 0xFFFF)
        else:
            body += struct.pack(">h", value)
    body += struct.pack(">hH", 250, counter & 0xFFFF)
    return body + struct.pack(">H", sum(body) & 0xFFFF)


def hg4930(gyro: Sequence[int], accel: Sequence[int], count: int, status2: int = 0) -> bytes:
    """An inertial message; `count` is that of the two bits."""
    body = struct.pack("<BB6hHH", 0x0E, 0x02, *[0] * 6, 0x04 | count & 3, status2)
    body += struct.pack("<6i", *gyro, *accel)
    return body + struct.pack("<H", sum(struct.unpack("<21H", body)) & 0xFFFF)
