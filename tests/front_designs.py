"""Designs with front ends, and makers of their frames that know nothing of the code under test."""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence
from copy import deepcopy
from typing import Any

import raw_datagrams
from sculler_model.design import Design

Maker = Callable[[Sequence[int], Sequence[int], int], bytes]


def _preset(preset: str, rate: float | None = None, **front: Any) -> dict[str, Any]:
    found: dict[str, Any] = {
        "preset": preset,
        "name": "front_" + front["sensor"],
        "hardware": {"core": "compact", "front": {"clock_hz": 1e8, **front}},
    }
    if rate is not None:
        found["sensor"] = {"sample_rate_hz": rate}
    return found


def _adis(sensor: str, bits: int, kind: str) -> dict[str, Any]:
    axes = {"bits": bits, "lsb": 1e-6}
    return {
        "name": f"front_{sensor}",
        "sensor": {"kind": kind, "sample_rate_hz": 2000.0, "gyro": axes, "accel": axes},
        "algorithm": {
            "family": "frequency-taylor" if kind == "increment" else "filtered-rate",
            "samples": 2,
            "minors": 2,
        },
        "hardware": {"core": "compact", "front": {"sensor": sensor, "clock_hz": 1e8}},
    }


_CUSTOM = _adis("custom", 32, "increment")
_CUSTOM["hardware"]["front"] |= {
    "baud": 921600.0,
    "frame": {
        "sync": [0xFA, 0x05],
        "length": 31,
        "gyro": {"at": [2, 6, 10], "bytes": 4, "endian": "little"},
        "accel": {"at": [14, 18, 22], "bytes": 4, "endian": "little"},
        "counter": {"byte": 26, "modulus": 128, "step": 3},
        "status": [{"byte": 27, "mask": 0x7F, "normal": 0x77}],
        "check": {
            "kind": "crc", "bits": 16, "byte": 29, "first": 1, "last": 28, "polynomial": 0x1021,
        },
    },
}  # fmt: skip


def _custom(gyro: Sequence[int], accel: Sequence[int], number: int) -> bytes:
    body = struct.pack("<B6iBBB", 5, *gyro, *accel, 0x80 | 3 * number % 128, 0xF7, 1)
    return b"\xfa" + body + struct.pack(">H", raw_datagrams.crc_msb_first(body, 16, 0x1021, 0))


def _stim300(identifier: int, step: int) -> Maker:
    return lambda gyro, accel, number: raw_datagrams.stim300(
        gyro, accel, number * step, identifier=identifier
    )


def _hg4930(gyro: Sequence[int], accel: Sequence[int], number: int) -> bytes:
    return raw_datagrams.hg4930(gyro, accel, 6 * number)


def _registers(gyro: Sequence[int], accel: Sequence[int], number: int) -> bytes:
    """SYS_E_FLAG, then low and high words."""
    words = [word for value in (*gyro, *accel) for word in (value & 0xFFFF, value >> 16 & 0xFFFF)]
    return struct.pack(">13H", 0, *words)


FRAMES: dict[str, tuple[dict[str, Any], Maker]] = {
    "stim300": (_preset("stim300", sensor="stim300"), _stim300(0x91, 1)),
    "stim300 A7 at 125 Hz": (
        _preset("stim300", 125.0, sensor="stim300", datagram=0xA7, baud=374400.0),
        _stim300(0xA7, 16),
    ),
    "hg4930": (_preset("hg4930", sensor="hg4930"), _hg4930),
    "adis16470": (_adis("adis16470", 16, "rate"), raw_datagrams.adis16470),
    "adis16505": (
        _adis("adis16505", 32, "increment"),
        lambda gyro, accel, number: raw_datagrams.adis16470(gyro, accel, number, long=True),
    ),
    "adis16488": (_adis("adis16488", 32, "increment"), _registers),
    "custom": (_CUSTOM, _custom),
}
"""Designs as files, and makers of their frames: gyro, accelerometer, number of the sample."""


def design_of(name: str, rate: float | None = None, **front: Any) -> Design:
    """The design of a name, with another sample rate or other keys of [hardware.front]."""
    data: dict[str, Any] = deepcopy(FRAMES[name][0])
    data["hardware"]["front"] |= front
    if rate is not None:
        data["sensor"] = {**data.get("sensor", {}), "sample_rate_hz": rate}
    return Design.parse(data)


def made(name: str, gyro: Sequence[int], accel: Sequence[int], number: int) -> bytes:
    """The frame of a sample."""
    return FRAMES[name][1](gyro, accel, number)
