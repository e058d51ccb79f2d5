"""VectorNav: binary output messages that the user configured.

A message has the sync byte FA, a byte of the groups present (bit 0: common, 1: time, 2: IMU, 3:
GPS, 4: attitude, 5: INS, 6: GPS 2), for each group a word of the fields present, the fields in the
order of groups and bits, and a CRC of 16 bits: polynomial 0x1021 from 0, over all between the sync
byte and itself, most significant byte first.  All else goes least significant byte first.  Source:
VectorNav's user manuals (binary output), and vnproglib as the driver dawonn/vectornav ships it.

Of the fields these make samples, the first pair that is there: DeltaTheta and DeltaVel (degrees,
m/s; of the common group in one field), UncompGyro and UncompAccel (or Imu of the common group),
AngularRate and Accel (rad/s, m/s²).  Time is TimeStartup, else TimeGps (ns).  There is no counter.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sculler.readers.raw.checksums import Crc, Frames, numbers, reals
from sculler.readers.raw.datagrams import Bytes, Decoded, Places, find
from sculler.readers.raw.recording import RawProtocol, Scales, Ticks, raw_format
from sculler_model.errors import InputError

_CRC = Crc(16, 0x1021, 0, reflected=False)
_SYNC = 0xFA
_COMMON, _TIME, _IMU = 0, 1, 2
_BYTES = (
    (8, 8, 8, 12, 16, 12, 24, 12, 12, 24, 20, 28, 2, 4, 8),
    (8, 8, 8, 2, 8, 8, 8, 4, 4, 1),
    (2, 12, 12, 12, 4, 4, 16, 12, 12, 12, 12, 2, 40),
    (8, 8, 2, 1, 1, 24, 24, 12, 12, 12, 4, 4, 2, 28),
    (2, 12, 16, 36, 12, 12, 12, 12, 12, 12, 28, 24, 12),
    (2, 24, 24, 12, 12, 12, 12, 12, 12, 4, 4, 68, 64),
    (8, 8, 2, 1, 1, 24, 24, 12, 12, 12, 4, 4, 2, 28),
)
"""Bytes of the fields of each group, by bit."""


class _Source(NamedTuple):
    """Two fields that make samples: group, bit and byte within the field; and their units."""

    name: str
    gyro: tuple[int, int, int]
    accel: tuple[int, int, int]
    scales: Scales


_INCREMENTS = Scales({"deg": 1.0}, {"m/s": 1.0})
_RATES = Scales({"rad/s": 1.0}, {"m/s2": 1.0})
_SOURCES = (
    _Source("DeltaTheta, DeltaVel", (_IMU, 6, 4), (_IMU, 7, 0), _INCREMENTS),
    _Source("DeltaTheta (common group)", (_COMMON, 11, 4), (_COMMON, 11, 16), _INCREMENTS),
    _Source("UncompGyro, UncompAccel", (_IMU, 3, 0), (_IMU, 2, 0), _RATES),
    _Source("Imu (common group)", (_COMMON, 9, 12), (_COMMON, 9, 0), _RATES),
    _Source("AngularRate, Accel", (_IMU, 10, 0), (_IMU, 9, 0), _RATES),
    _Source("AngularRate, Accel (common group)", (_COMMON, 5, 0), (_COMMON, 8, 0), _RATES),
)
_CLOCKS = (
    ("TimeStartup", (_COMMON, 0)),
    ("TimeStartup", (_TIME, 0)),
    ("TimeGps", (_COMMON, 1)),
    ("TimeGps", (_TIME, 1)),
)


class _Layout(NamedTuple):
    """Where in a message its fields begin, by group and bit, and the length of all of it."""

    fields: dict[tuple[int, int], int]
    length: int


def _layout(header: bytes) -> _Layout | None:
    """The layout that a message's first bytes tell; None where they can be no message's."""
    groups = header[1]
    present = [group for group in range(len(_BYTES)) if groups >> group & 1]
    begin = 2 + 2 * len(present)
    if not present or groups & 0x80 or len(header) < begin:
        return None
    fields = {}
    for number, group in enumerate(present):
        word = header[2 + 2 * number] | header[3 + 2 * number] << 8
        if not word or word >> len(_BYTES[group]):
            return None
        for bit, size in enumerate(_BYTES[group]):
            if word >> bit & 1:
                fields[group, bit] = begin
                begin += size
    return _Layout(fields, begin + 2)


class VectorNav(RawProtocol):
    """Binary output messages; those without the fields of the first are known, and no sample."""

    longest = 2 + sum(2 + sum(group) for group in _BYTES) + 2
    _header_bytes = 2 + 2 * len(_BYTES)

    def __init__(self) -> None:
        self._source: _Source | None = None
        self._clock: tuple[str, tuple[int, int]] | None = None
        self._layouts: dict[bytes, _Layout | None] = {}

    def starts(self, data: Bytes) -> Places:
        """Every sync byte."""
        return np.flatnonzero(data == _SYNC)

    def lengths(self, data: Bytes, starts: Places) -> Places:
        """As the groups and fields tell."""
        content = data.tobytes()
        found = (self._layout(content, start) for start in starts.tolist())
        return np.array([0 if layout is None else layout.length for layout in found], np.int64)

    def _layout(self, content: bytes, start: int) -> _Layout | None:
        groups = content[start + 1] if start + 1 < len(content) else 0
        header = content[start : start + 2 + 2 * groups.bit_count()]
        if header not in self._layouts:
            if len(self._layouts) > 10_000:  # of garbage
                self._layouts.clear()
            self._layouts[header] = _layout(header) if len(header) > 2 else None
        return self._layouts[header]

    def whole(self, frames: Frames) -> NDArray[np.bool_]:
        """Whether the CRC is right."""
        good: NDArray[np.bool_] = _CRC(frames[:, 1:-2]) == numbers(frames[:, -2:], ">u2")[:, 0]
        return good

    def decode(self, frames: Frames) -> Decoded:
        """Samples of the messages that have the fields."""
        rows, values, ticks = [], [], []
        for layout, at in self._kinds(frames):
            if self._source is None or not self._has(layout):
                continue
            some = frames[at]
            rows.append(at)
            values.append(
                np.hstack(
                    [
                        reals(some[:, begin : begin + 12], "<f4")
                        for begin in (
                            layout.fields[group, bit] + offset
                            for group, bit, offset in (self._source.gyro, self._source.accel)
                        )
                    ]
                )
            )
            if self._clock is not None:
                begin = layout.fields[self._clock[1]]
                low, high = numbers(some[:, begin : begin + 8], "<u4").T
                ticks.append(low + (high << 32))
        if not rows:
            return Decoded(np.empty(0, np.int64), np.empty((0, 6)), None, np.empty(0, np.uint8))
        row = np.concatenate(rows)
        order = np.argsort(row)
        clock = np.concatenate(ticks)[order] if ticks else None
        faults = np.zeros(len(row), np.uint8)
        return Decoded(row[order], np.concatenate(values)[order], clock, faults)

    def _has(self, layout: _Layout) -> bool:
        assert self._source is not None
        wanted = {self._source.gyro[:2], self._source.accel[:2]}
        if self._clock is not None:
            wanted.add(self._clock[1])
        return wanted <= layout.fields.keys()

    def _kinds(self, frames: Frames) -> list[tuple[_Layout, Places]]:
        """The rows of each layout."""
        header = frames[:, : self._header_bytes]
        found: dict[int, tuple[_Layout, list[int]]] = {}
        for row, content in enumerate(header):
            layout = self._layout(content.tobytes(), 0)
            if layout is not None:
                found.setdefault(id(layout), (layout, []))[1].append(row)
        return [(layout, np.array(rows, np.int64)) for layout, rows in found.values()]

    def settle(self, path: Path, head: Bytes) -> None:
        """The fields that the first messages have."""
        starts, _ = find(self, head)
        content = head.tobytes()
        layouts = [self._layout(content, start) for start in starts.tolist()]
        for source in _SOURCES:
            wanted = {source.gyro[:2], source.accel[:2]}
            having = [each for each in layouts if each and wanted <= each.fields.keys()]
            if having:
                self._source, self.scales = source, source.scales
                self._clock = next(
                    (clock for clock in _CLOCKS if all(clock[1] in each.fields for each in having)),
                    None,
                )
                self.ticks = None
                if self._clock is not None:
                    self.ticks = Ticks(1e-9, None, f"{self._clock[0]}, ns")
                return
        what = "no whole message" if not layouts else "the messages have no fields"
        raise InputError(
            f"{path}: {what} of gyro and accelerometer together; configure an output with"
            " DeltaTheta and DeltaVel, or UncompGyro and UncompAccel (or check --format)"
        )

    def notes(self) -> dict[str, str]:
        """The fields."""
        if self._source is None:
            return {}
        notes = {"fields": self._source.name}
        if self._source.scales is _INCREMENTS:
            notes["increments"] = (
                "as the sensor gives them: coning and sculling within a sample are in them"
            )
        return notes


FORMATS = (raw_format("vectornav", "binary output messages of a VectorNav sensor", VectorNav),)
