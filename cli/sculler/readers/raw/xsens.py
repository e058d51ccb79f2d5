"""Xsens MTi: MTData2 messages of the Xbus protocol.

A message has FA FF, its number (36 hex for MTData2), the length of what it says (1 byte, or FF and
2 bytes), that, and a byte that makes the sum of all bytes after the first 0 modulo 256.  MTData2 is
a row of packets: identifier (2 bytes), length (1) and data, most significant byte first.  The last
four bits of an identifier tell the numbers' form: 4-byte float, 12.20 or 16.32 fixed point, 8-byte
float.  Source: Xsens' *MT Low Level Communication Protocol Documentation*.

Of the packets these make samples, the first pair that is there: DeltaQ (803_) and DeltaV (401_),
or RateOfTurn (802_) and Acceleration (402_).  DeltaQ is the quaternion of the turn over the sample
interval, and is given as its rotation vector.  Time is SampleTimeFine (1060), ticks of 0.1 ms,
which begins anew after a day or after 2^32 ticks.  Clipping of an axis in StatusWord (E020) is a
fault.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sculler.readers.raw.checksums import Frames, numbers, reals, sum_of_bytes
from sculler.readers.raw.datagrams import Bytes, Decoded, Places, find
from sculler.readers.raw.recording import RawProtocol, Scales, Ticks, raw_format
from sculler_model.errors import InputError

_PREAMBLE, _BUS, _DATA = 0xFA, 0xFF, 0x36
_TIME, _STATUS = 0x1060, 0xE020
_CLIPPED = 0x3F00
_DAY_TICKS = 24 * 3600 * 10_000
_NUMBER_BYTES = (4, 4, 6, 8)  # by the precision's two bits
_KIND = 0xFFF0  # of an identifier, without the numbers' form


class _Source(NamedTuple):
    """Two packets that make samples, their numbers, and their units."""

    name: str
    gyro: int
    gyro_numbers: int
    accel: int
    scales: Scales


_SOURCES = (
    _Source("DeltaQ, DeltaV", 0x8030, 4, 0x4010, Scales({"rad": 1.0}, {"m/s": 1.0})),
    _Source("RateOfTurn, Acceleration", 0x8020, 3, 0x4020, Scales({"rad/s": 1.0}, {"m/s2": 1.0})),
)


class _Packet(NamedTuple):
    """Where in a message a packet's data begin, their length, and the packet's identifier."""

    begin: int
    length: int
    identifier: int


def _packets(message: bytes) -> dict[int, _Packet]:
    """The packets of a whole MTData2 message, by kind; none if they do not fill it."""
    at = 6 if message[3] == 0xFF else 4
    found = {}
    while at + 3 <= len(message) - 1:
        identifier, length = message[at] << 8 | message[at + 1], message[at + 2]
        found[identifier & _KIND] = _Packet(at + 3, length, identifier)
        at += 3 + length
    return found if at == len(message) - 1 else {}


class Xsens(RawProtocol):
    """Xbus messages; all but MTData2 with the wanted packets hold no sample."""

    longest = 6 + 2048 + 1
    ticks: Ticks | None = Ticks(1e-4, (_DAY_TICKS, 1 << 32), "SampleTimeFine, ticks of 0.1 ms")

    def __init__(self) -> None:
        self._source: _Source | None = None

    def starts(self, data: Bytes) -> Places:
        """Where FA FF stands."""
        return np.flatnonzero((data[:-1] == _PREAMBLE) & (data[1:] == _BUS))

    def lengths(self, data: Bytes, starts: Places) -> Places:
        """As byte 3 tells, or the two after it."""

        def at(offset: int) -> Places:
            return data.take(starts + offset, mode="clip").astype(np.int64)

        extended = at(4) << 8 | at(5)
        lengths = np.where(at(3) == 0xFF, 7 + extended, 5 + at(3))
        lengths[lengths > self.longest] = 0
        return lengths

    def whole(self, frames: Frames) -> NDArray[np.bool_]:
        """Whether the sum is 0."""
        good: NDArray[np.bool_] = sum_of_bytes(frames[:, 1:]) & 0xFF == 0
        return good

    def decode(self, frames: Frames) -> Decoded:
        """Samples of the messages that have the packets."""
        parts = []
        left = np.flatnonzero(frames[:, 2] == _DATA)
        while len(left):
            packets = _packets(frames[left[0]].tobytes())
            alike = self._alike(frames[left], packets)
            rows, left = left[alike], left[~alike]
            if self._source is not None and self._has(packets):
                parts.append(self._samples(frames[rows], rows, packets))
        if not parts:
            return Decoded(
                np.empty(0, np.int64),
                np.empty((0, 6)),
                np.empty(0, np.int64),
                np.empty(0, np.uint8),
            )
        rows = np.concatenate([part.rows for part in parts])
        order = np.argsort(rows)
        ticks = [part.ticks for part in parts if part.ticks is not None]
        return Decoded(
            rows[order],
            np.concatenate([part.values for part in parts])[order],
            np.concatenate(ticks)[order] if ticks else None,
            np.concatenate([part.faults for part in parts])[order],
        )

    @staticmethod
    def _alike(frames: Frames, packets: dict[int, _Packet]) -> NDArray[np.bool_]:
        """Which messages have the packets of the first at the same places."""
        alike = np.ones(len(frames), np.bool_)
        for packet in packets.values():
            head = slice(packet.begin - 3, packet.begin)
            alike &= (frames[:, head] == frames[0, head]).all(axis=1)
        if not packets:
            alike[1:] = False
        return alike

    def _has(self, packets: dict[int, _Packet]) -> bool:
        assert self._source is not None
        wanted = {self._source.gyro: self._source.gyro_numbers, self._source.accel: 3}
        for kind, count in wanted.items():
            packet = packets.get(kind)
            if packet is None or packet.length != count * _NUMBER_BYTES[packet.identifier & 3]:
                return False
        return self.ticks is None or (_TIME in packets and packets[_TIME].length == 4)

    def _samples(self, frames: Frames, rows: Places, packets: dict[int, _Packet]) -> Decoded:
        assert self._source is not None
        turn = _numbers_of(frames, packets[self._source.gyro])
        gyro = _rotation_vectors(turn) if self._source.gyro_numbers == 4 else turn
        values = np.hstack([gyro, _numbers_of(frames, packets[self._source.accel])])
        ticks = None
        if self.ticks is not None:
            ticks = numbers(_data(frames, packets[_TIME]), ">u4")[:, 0]
        faults = np.zeros(len(rows), np.uint8)
        if _STATUS in packets and packets[_STATUS].length == 4:
            status = numbers(_data(frames, packets[_STATUS]), ">u4")[:, 0]
            faults = (status & _CLIPPED != 0).astype(np.uint8)
        return Decoded(rows, values, ticks, faults)

    def settle(self, path: Path, head: Bytes) -> None:
        """The packets that the first messages have."""
        starts, lengths = find(self, head)
        seen = [
            _packets(head[start : start + length].tobytes())
            for start, length in zip(starts.tolist(), lengths.tolist(), strict=True)
            if head[start + 2] == _DATA
        ]
        for source in _SOURCES:
            having = [each for each in seen if source.gyro in each and source.accel in each]
            if having:
                self._source, self.scales = source, source.scales
                if not all(_TIME in each for each in having):
                    self.ticks = None
                return
        what = "no whole MTData2 message" if not seen else "the messages have no packets"
        raise InputError(
            f"{path}: {what} of gyro and accelerometer together; configure an output with DeltaQ"
            " and DeltaV, or RateOfTurn and Acceleration (or check --format)"
        )

    def notes(self) -> dict[str, str]:
        """The packets."""
        if self._source is None:
            return {}
        notes = {"packets": self._source.name}
        if self._source.gyro_numbers == 4:
            notes["increments"] = (
                "as the sensor gives them: coning and sculling within a sample are in them"
            )
        return notes


def _data(frames: Frames, packet: _Packet) -> Frames:
    return frames[:, packet.begin : packet.begin + packet.length]


def _numbers_of(frames: Frames, packet: _Packet) -> NDArray[np.float64]:
    """A packet's numbers, whatever their form."""
    data, form = _data(frames, packet), packet.identifier & 3
    if form == 0:
        return reals(data, ">f4")
    if form == 1:
        return numbers(data, ">i4").astype(np.float64) * 2.0**-20
    if form == 3:
        return reals(data, ">f8")
    parts = data.reshape(len(data), -1, 6)  # fraction of 32 bits, then the whole of 16
    halves = np.ascontiguousarray(parts).view(">u2").astype(np.int64)
    whole = halves[:, :, 2] - ((halves[:, :, 2] & 0x8000) << 1)
    fraction: NDArray[np.int64] = (halves[:, :, 0] << 16) | halves[:, :, 1]
    given: NDArray[np.float64] = whole + fraction * 2.0**-32
    return given


def _rotation_vectors(quaternions: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rotation vectors (N, 3), rad, of quaternions (N, 4), scalar first; the shorter turn."""
    scalar, vector = quaternions[:, :1], quaternions[:, 1:]
    scalar, vector = np.abs(scalar), np.where(scalar < 0, -vector, vector)
    sine = np.linalg.norm(vector, axis=1, keepdims=True)
    half = np.arctan2(sine, scalar)
    small = sine < 1e-9  # half / sine is 1 / scalar there, to the last digit
    ratio = np.where(small, 1 / np.maximum(scalar, 0.5), half / np.where(small, 1, sine))
    turns: NDArray[np.float64] = 2 * ratio * vector
    return turns


FORMATS = (raw_format("xsens", "MTData2 messages of an Xsens MTi", Xsens),)
