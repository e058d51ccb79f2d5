"""NovAtel OEM receivers: RAWIMU, RAWIMUS, RAWIMUX and RAWIMUSX, binary or ASCII, among other logs.

A binary message has a long header (AA 44 12, its own length, the message's number at byte 4, the
length of the message at byte 8) or a short one (AA 44 13, the length of the message, its number at
byte 4; 12 bytes), the message and a CRC, all least significant byte first.  An ASCII message is a
line `#NAME,...;...*CRC` or `%NAME,...;...*CRC`.  The CRC is that of polynomial 0x04C11DB7,
reflected, from 0, over all before it (over what stands between the first character and the star).

RAWIMU (268) and RAWIMUS (325) say: GPS week (4 bytes), seconds of the week (8-byte float), IMU
status (4), and as 4-byte whole numbers accelerometer z, -y, x and gyro z, -y, x.  RAWIMUX (1461)
and RAWIMUSX (1462) begin with IMU info (1; bit 0: IMU error, bit 1: encrypted), IMU type (1) and
week (2) instead.  Source: NovAtel's OEM7 manual of these logs; numbers, layouts and scale factors
by IMU type also in its maintained driver novatel/novatel_oem7_driver.

The values are increments over the IMU's sample interval, of some IMUs rates; their stamp is the
time of the sample.
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

_CRC = Crc(32, 0x04C11DB7, 0, reflected=True)
_SHORT_HEADER, _LEAST_HEADER, _CRC_BYTES = 12, 28, 4
_LONGEST_LINE = 1024
_MESSAGE_BYTES = 40
_PLAIN, _EXTENDED = (268, 325), (1461, 1462)
_NAMES = {b"RAWIMUA": False, b"RAWIMUSA": False, b"RAWIMUXA": True, b"RAWIMUSXA": True}
_ERROR, _ENCRYPTED = 1, 2
_WEEK_NS = 604_800 * 10**9
_HEX = frozenset(b"0123456789abcdefABCDEF")


class _Imu(NamedTuple):
    """What a count of a type of IMU is worth."""

    name: str
    gyro_unit: str
    gyro: float
    accel_unit: str
    accel: float


_IMUS = {
    number: _Imu(name, gyro_unit, gyro, accel_unit, accel)
    for numbers_of, name, gyro_unit, gyro, accel_unit, accel in (
        ((1, 11), "HG1700", "rad", 2.0**-33, "ft/s", 2.0**-27),
        ((4, 12), "HG1700", "rad", 2.0**-33, "ft/s", 2.0**-26),
        ((5, 27), "HG1900", "rad", 2.0**-33, "ft/s", 2.0**-27),
        ((20, 28), "HG1930", "rad", 2.0**-33, "ft/s", 2.0**-27),
        ((8,), "LN-200", "rad", 2.0**-19, "m/s", 2.0**-14),
        ((13,), "iIMU-FSAS", "arcsec", 0.1 * 2.0**-8, "m/s", 0.05 * 2.0**-15),
        ((26,), "ISA-100C", "rad", 1e-9, "m/s", 2e-8),
        ((52,), "µIMU", "rad", 1e-9, "m/s", 2e-8),
        ((31,), "ADIS16488", "deg", 720 * 2.0**-31, "m/s", 200 * 2.0**-31),
        ((32, 56), "STIM300", "deg", 2.0**-21, "m/s", 2.0**-22),
        ((41, 62), "Epson G320", "deg/s", 0.008 * 2.0**-16, "mg", 0.2 * 2.0**-16),
        ((61,), "Epson G370", "deg/s", 0.0151515 * 2.0**-16, "mg", 0.4 * 2.0**-16),
        ((58, 68, 69), "HG4930", "rad", 2.0**-33, "m/s", 2.0**-29),
    )
    for number in numbers_of
}
"""By the number of the IMU type.  KVH's are not here: their published scale is not sure."""


class NovAtel(RawProtocol):
    """Messages of an OEM receiver; all but the raw IMU's hold no sample."""

    longest = (1 << 16) + 256 + _CRC_BYTES
    scales = Scales({}, {})
    ticks = Ticks(1e-9, None, "GPS seconds of the week, as the messages say")

    def __init__(self) -> None:
        self._week: int | None = None
        self._type: int | None = None

    def starts(self, data: Bytes) -> Places:
        """The sync bytes, and the first characters of lines."""
        end = max(len(data) - 2, 0)
        first, second, third = data[:end], data[1 : end + 1], data[2 : end + 2]
        binary = (first == 0xAA) & (second == 0x44) & ((third == 0x12) | (third == 0x13))
        capital = (second >= ord("A")) & (second <= ord("Z"))
        text = ((first == ord("#")) | (first == ord("%"))) & capital
        return np.flatnonzero(binary | text)

    def lengths(self, data: Bytes, starts: Places) -> Places:
        """As the header tells; of a line up to its end."""

        def at(offset: int) -> Places:
            return data.take(starts + offset, mode="clip").astype(np.int64)

        short = _SHORT_HEADER + at(3) + _CRC_BYTES
        long = at(3) + at(8) + (at(9) << 8) + _CRC_BYTES
        long[at(3) < _LEAST_HEADER] = 0
        lengths = np.where(at(2) == 0x13, short, long)
        text = np.flatnonzero(at(0) != 0xAA)
        if len(text):
            line_ends = np.flatnonzero(data == ord("\n"))
            after = np.searchsorted(line_ends, starts[text])
            line_ends = np.append(line_ends, -1)
            lengths[text] = line_ends[after] - starts[text] + 1
            lengths[text[lengths[text] > _LONGEST_LINE]] = 0
            # CRC: a star and eight digits, before the line end of one or two bytes
            for place in text[lengths[text] > 0].tolist():
                start, length = int(starts[place]), int(lengths[place])
                line = data[start : start + length].tobytes().rstrip(b"\r\n")
                if line[-9:-8] != b"*" or not _HEX.issuperset(line[-8:]):
                    lengths[place] = 0
        return lengths

    def whole(self, frames: Frames) -> NDArray[np.bool_]:
        """Whether the CRC is right."""
        good = np.zeros(len(frames), np.bool_)
        binary = frames[:, 0] == 0xAA
        messages = frames[binary]
        good[binary] = (
            _CRC(messages[:, :-_CRC_BYTES]) == numbers(messages[:, -_CRC_BYTES:], "<u4")[:, 0]
        )
        for row in np.flatnonzero(~binary).tolist():
            good[row] = _is_whole_line(frames[row].tobytes())
        return good

    def decode(self, frames: Frames) -> Decoded:
        """The raw IMU's messages among these."""
        parts = [self._binary(frames, rows, header) for rows, header in _headers(frames)]
        parts += [self._line(frames[row].tobytes(), row) for row in _lines(frames)]
        kept = [part for part in parts if len(part.rows)]
        if not kept:
            return _NOTHING
        rows, values, ticks, faults = (np.concatenate(column) for column in zip(*kept, strict=True))
        order = np.argsort(rows)
        return Decoded(rows[order], values[order], ticks[order], faults[order])

    def _binary(self, frames: Frames, rows: Places, header: int) -> Decoded:
        """The samples among messages with a header of some bytes."""
        message = frames[rows, 4].astype(np.int64) + (frames[rows, 5].astype(np.int64) << 8)
        fits = frames.shape[1] == header + _MESSAGE_BYTES + _CRC_BYTES
        rows, message = (
            each[np.isin(message, _PLAIN + _EXTENDED) & fits] for each in (rows, message)
        )
        if not len(rows):
            return _NOTHING
        body = frames[rows, header : header + _MESSAGE_BYTES]
        extended = np.isin(message, _EXTENDED)
        info = np.where(extended, body[:, 0], 0)
        week = np.where(
            extended, numbers(body[:, 2:4], "<u2")[:, 0], numbers(body[:, :4], "<u4")[:, 0]
        )
        seconds = reals(body[:, 4:12], "<f8")[:, 0]
        self._require_type(body[extended, 1])
        return self._samples(rows, info, week, seconds, numbers(body[:, 16:], "<i4"))

    def _line(self, line: bytes, row: int) -> Decoded:
        """The sample of a line; none if it is of another message."""
        head, _, message = line.partition(b"*")[0].partition(b";")
        name = head[1:].split(b",")[0]
        if name not in _NAMES:
            return _NOTHING
        cells = message.split(b",")
        info = 0
        try:
            if _NAMES[name]:
                info = int(cells[0], 16)
                self._require_type(np.array([int(cells[1])]))
                cells = cells[2:]
            week, seconds = int(cells[0]), float(cells[1])
            counts = [int(cell) for cell in cells[3:]]
        except (ValueError, IndexError) as error:
            raise InputError(
                f"a line {line[:60].decode('ascii', 'replace')!r} cannot be read"
            ) from error
        if len(counts) != 6:
            raise InputError(f"a line {line[:60].decode('ascii', 'replace')!r} has no six counts")
        return self._samples(
            np.array([row]),
            np.array([info]),
            np.array([week]),
            np.array([seconds]),
            np.array([counts], np.int64),
        )

    def _require_type(self, given: NDArray[np.integer]) -> None:
        """Whether the messages go on with the IMU of the first."""
        for number in np.unique(given).tolist():
            if self._type not in (None, number):
                raise InputError(
                    f"messages of IMU types {self._type} and {number} are in one log, give them"
                    " apart"
                )
            self._type = number

    def _samples(
        self,
        rows: Places,
        info: NDArray[np.integer],
        week: NDArray[np.int64],
        seconds: NDArray[np.float64],
        counts: NDArray[np.int64],
    ) -> Decoded:
        """Samples of messages: accelerometer z, -y, x and gyro z, -y, x."""
        if (info & _ENCRYPTED).any():
            raise InputError(
                "the IMU's data are encrypted, ask the receiver's maker for the option"
            )
        if not np.isfinite(seconds).all() or (np.abs(seconds) > 1e7).any():
            raise InputError("the seconds of the GPS week are no such number, check the log")
        if self._week is None:
            self._week = int(week[0])
        ticks = (week - self._week) * _WEEK_NS + np.rint(seconds * 1e9).astype(np.int64)
        values = (counts[:, [5, 4, 3, 2, 1, 0]] * np.array([1, -1, 1, 1, -1, 1])).astype(np.float64)
        return Decoded(rows, values, ticks, (info & _ERROR).astype(np.uint8))

    def settle(self, path: Path, head: Bytes) -> None:
        """The scales, by the type of IMU that the first messages tell."""
        starts, lengths = find(self, head)
        for length in np.unique(lengths).tolist():
            at = starts[lengths == length]
            self.decode(head[at[:, None] + np.arange(length)])
        if self._type in _IMUS:
            imu = _IMUS[self._type]
            self.scales = Scales({imu.gyro_unit: imu.gyro}, {imu.accel_unit: imu.accel})

    def notes(self) -> dict[str, str]:
        """The type of IMU."""
        if self._type is None:
            return {}
        known = f" ({_IMUS[self._type].name})" if self._type in _IMUS else ""
        return {"IMU type": f"{self._type}{known}"}


_NOTHING = Decoded(
    np.empty(0, np.int64), np.empty((0, 6)), np.empty(0, np.int64), np.empty(0, np.uint8)
)


def _headers(frames: Frames) -> list[tuple[Places, int]]:
    """Rows of the binary messages, by the length of their header."""
    binary, short = frames[:, 0] == 0xAA, frames[:, 2] == 0x13
    found = [(np.flatnonzero(binary & short), _SHORT_HEADER)]
    for length in np.unique(frames[binary & ~short, 3]).tolist():
        found.append((np.flatnonzero(binary & ~short & (frames[:, 3] == length)), length))
    return [(rows, length) for rows, length in found if len(rows)]


def _lines(frames: Frames) -> list[int]:
    """Rows of the ASCII messages."""
    rows: list[int] = np.flatnonzero(frames[:, 0] != 0xAA).tolist()
    return rows


def _is_whole_line(line: bytes) -> bool:
    """Whether the CRC of a line `?....*CRC` is right."""
    text = line.rstrip(b"\r\n")
    content = np.frombuffer(text[1:-9], np.uint8)
    return len(content) > 0 and int(_CRC(content[None, :])[0]) == int(text[-8:], 16)


FORMATS = (
    raw_format("novatel", "raw IMU messages of a NovAtel receiver, binary or ASCII", NovAtel),
)
