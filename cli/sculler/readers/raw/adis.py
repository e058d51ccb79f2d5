"""Analog Devices ADIS: bursts, as a recorder has them from the SPI port, one after the other.

All words have 16 bits, most significant byte first.  Three forms are read:

`adis16495` (ADIS1649x, ADIS1654x), 36 bytes: A5A5 (C3C3 where the burst has delta angles and
velocities), system flags, temperature, gyro x, y, z and accelerometer x, y, z with the low word
first each, the counter of samples, and the CRC-32 of zip, low word first, over the 15 words
between, least significant byte of each first.

`adis16470` (ADIS1646x, ADIS1647x, ADIS1650x), 20 bytes: diagnosis, gyro x, y, z, accelerometer x,
y, z, temperature, the counter of samples, and the sum of the bytes before.

`adis16470-32`, 32 bytes: the same with numbers of 32 bits, low word first.

Source: the data sheets' sections on burst reads, and Analog Devices' maintained drivers
analogdevicesinc/no-OS (drivers/imu) and the kernel's adis16475.  The ADIS16488 has no burst of its
own; what recorders make of it are as many forms as recorders.

No burst says what a count is worth, which the model's range gives.  The counter counts samples, so
that the sample rate is taken from the design.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sculler.readers.raw.checksums import ZIP, Frames, numbers, sum_of_bytes
from sculler.readers.raw.datagrams import Bytes, Decoded, Places
from sculler.readers.raw.recording import RawProtocol, Scales, Ticks, raw_format

_TICKS = Ticks(None, (1 << 16,), "the sensor's counter of samples", counts=True)


def _pairs(words: NDArray[np.int64]) -> NDArray[np.int64]:
    """Numbers of 32 bits, signed, of words (N, 2 n): low, high."""
    value = words[:, 1::2] << 16 | words[:, ::2]
    return value - ((value & 0x8000_0000) << 1)


class Adis16495(RawProtocol):
    """Bursts with a header and a CRC."""

    longest = 36
    scales = Scales({}, {})
    ticks = _TICKS

    def starts(self, data: Bytes) -> Places:
        """The headers."""
        first, second = data[:-1], data[1:]
        return np.flatnonzero((first == second) & ((first == 0xA5) | (first == 0xC3)))

    def lengths(self, data: Bytes, starts: Places) -> Places:
        """All alike."""
        return np.full(len(starts), self.longest, np.int64)

    def whole(self, frames: Frames) -> NDArray[np.bool_]:
        """Whether the CRC is right."""
        swapped = frames[:, 2:32].reshape(len(frames), 15, 2)[:, :, ::-1].reshape(len(frames), 30)
        words = numbers(frames[:, 32:], ">u2")
        good: NDArray[np.bool_] = ZIP(swapped) == words[:, 1] << 16 | words[:, 0]
        return good

    def decode(self, frames: Frames) -> Decoded:
        """Gyro and accelerometer; a fault where a system flag is set."""
        words = numbers(frames, ">u2")
        return Decoded(
            np.arange(len(frames)),
            _pairs(words[:, 3:15]).astype(np.float64),
            words[:, 15],
            (words[:, 1] != 0).astype(np.uint8),
        )


class Adis16470(RawProtocol):
    """Bursts without a header: two of them stand one after the other, or there is none."""

    longest = 20
    scales = Scales({}, {})
    ticks = _TICKS

    def starts(self, data: Bytes) -> Places:
        """Where a sum is right, and that of the burst before or after it."""
        count = len(data) - self.longest + 1
        if count <= 0:
            return np.empty(0, np.int64)
        total = np.concatenate([[0], np.cumsum(data, dtype=np.int64)])
        size = self.longest - 2
        sums = total[size : size + count] - total[:count]
        given = data[size : size + count].astype(np.int64) << 8 | data[size + 1 : size + 1 + count]
        right = (sums == given) & (sums > 0)
        paired = np.zeros(count, np.bool_)
        both = right[self.longest :] & right[: -self.longest]
        paired[self.longest :] |= both
        paired[: -self.longest] |= both
        return np.flatnonzero(paired)

    def lengths(self, data: Bytes, starts: Places) -> Places:
        """All alike."""
        return np.full(len(starts), self.longest, np.int64)

    def whole(self, frames: Frames) -> NDArray[np.bool_]:
        """Whether the sum is right."""
        good: NDArray[np.bool_] = (
            sum_of_bytes(frames[:, :-2]) == numbers(frames[:, -2:], ">u2")[:, 0]
        )
        return good

    def decode(self, frames: Frames) -> Decoded:
        """Gyro and accelerometer; a fault where the diagnosis is not 0."""
        words = numbers(frames, ">u2")
        return Decoded(
            np.arange(len(frames)),
            self._values(words).astype(np.float64),
            words[:, -2],
            (words[:, 0] != 0).astype(np.uint8),
        )

    def _values(self, words: NDArray[np.int64]) -> NDArray[np.int64]:
        given = words[:, 1:7]
        return given - ((given & 0x8000) << 1)


class Adis16470Long(Adis16470):
    """The same with 32 bits."""

    longest = 32

    def _values(self, words: NDArray[np.int64]) -> NDArray[np.int64]:
        return _pairs(words[:, 1:13])


FORMATS = (
    raw_format("adis16495", "bursts of an ADIS1649x or ADIS1654x, 36 bytes", Adis16495),
    raw_format("adis16470", "bursts of an ADIS1646x, 1647x or 1650x, 20 bytes", Adis16470),
    raw_format("adis16470-32", "the same with 32 bits, 32 bytes", Adis16470Long),
)
