"""Sensonor STIM300 (and STIM318, STIM320 alike): datagrams of the normal mode.

A datagram, most significant byte first, has the identifier (1 byte); gyro x, y, z (3 bytes each,
two's complement) and their status (1); the same of the accelerometers, of the inclinometers, and
the temperatures (2 bytes each) of each, as the identifier tells; the auxiliary input (3) and its
status (1); the counter (1) of the internal samples at 2000 Hz; the latency (2, µs); and the CRC
(4): polynomial 0x04C11DB7, initial value all ones, over the bytes before and as many zeros as make
them a multiple of 4.  Source: Sensonor's data sheet TS1524, tables of the normal mode, and the
constants of the maintained driver vortexntnu/stim300-driver.

What a count is worth depends on the output unit that the sensor was set to, and on the
accelerometers' range, which no datagram tells.

Some recorders send gyro and accelerometer alone under identifier 0x93, with the CRC-32 of zip
files: such datagrams of 28 bytes are taken as well, and told.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sculler.readers.raw.checksums import ZIP, Crc, Frames, numbers
from sculler.readers.raw.datagrams import Bytes, Decoded, Places
from sculler.readers.raw.recording import RawProtocol, Scales, Ticks, raw_format

_CRC = Crc(32, 0x04C11DB7, 0xFFFFFFFF, reflected=False)

_ACCEL, _INCLINATION, _TEMPERATURE, _AUXILIARY = 1, 2, 4, 8
_CONTENTS = {0x90 + bits: bits for bits in range(16)}
# with temperatures, where there are accelerometers or inclinometers, the identifier is 0xA_
_CONTENTS |= {0xA0 + bits: bits for bits in range(16) if bits & _TEMPERATURE and bits & 3}
_OLD = [0x90 + bits for bits in range(16) if bits & _TEMPERATURE and bits & 3]
for _identifier in _OLD:
    del _CONTENTS[_identifier]
_RECORDED = 0x93
_RECORDED_BYTES = 28


def _bytes_of(bits: int) -> int:
    """Length of a datagram with these contents."""
    triples = 1 + bool(bits & _ACCEL) + bool(bits & _INCLINATION)
    temperatures = triples if bits & _TEMPERATURE else 0
    return 1 + 10 * triples + 7 * temperatures + 4 * bool(bits & _AUXILIARY) + 3 + 4


_LENGTH = np.zeros(256, np.int64)
for _identifier, _bits in _CONTENTS.items():
    _LENGTH[_identifier] = _bytes_of(_bits)
_LENGTH[[0xBC, 0xBD]] = 26  # the configuration, at power-up


class Stim300(RawProtocol):
    """Datagrams of the normal mode; those of the configuration are known, and hold no sample."""

    longest = int(_LENGTH.max())
    scales = Scales({"deg": 2.0**-21, "deg/s": 2.0**-14}, {"m/s": 2.0**-22, "g": 2.0**-19})
    ticks = Ticks(1 / 2000, (1 << 8,), "the sensor's counter of samples at 2000 Hz", counts=True)

    def __init__(self) -> None:
        self.recorded = 0

    def starts(self, data: Bytes) -> Places:
        """Every byte that is an identifier."""
        return np.flatnonzero(_LENGTH[data] > 0)

    def lengths(self, data: Bytes, starts: Places) -> Places:
        """As the identifier tells; or of the recorders' form, if its checksum is right."""
        lengths = _LENGTH[data[starts]]
        short = np.flatnonzero(
            (data[starts] == _RECORDED) & (starts + _RECORDED_BYTES <= len(data))
        )
        frames = data[starts[short, None] + np.arange(_RECORDED_BYTES)]
        lengths[short[_is_recorded(frames)]] = _RECORDED_BYTES
        return lengths

    def whole(self, frames: Frames) -> NDArray[np.bool_]:
        """The CRC of the maker, or that of zip in the recorders' form."""
        zeros = -(frames.shape[1] - 4) % 4
        good: NDArray[np.bool_] = (
            _CRC(frames[:, :-4], zeros) == numbers(frames[:, -4:], ">u4")[:, 0]
        )
        if frames.shape[1] == _RECORDED_BYTES:
            good |= _is_recorded(frames)
        return good

    def decode(self, frames: Frames) -> Decoded:
        """Gyro and accelerometer; a fault where their status, or any other, is not 0."""
        length = frames.shape[1]
        identifiers = frames[:, 0]
        has_accel = np.isin(
            identifiers, [name for name, bits in _CONTENTS.items() if bits & _ACCEL]
        )
        rows = np.flatnonzero(has_accel)
        if not len(rows):
            return Decoded(rows, np.empty((0, 6)), rows, np.empty(0, np.uint8))
        self.recorded += int((identifiers == _RECORDED).sum()) if length == _RECORDED_BYTES else 0
        samples = frames[rows]
        values = np.hstack([numbers(samples[:, at : at + 9], ">i3") for at in (1, 11)])
        faults = (samples[:, 10] != 0) | (samples[:, 20] != 0)
        return Decoded(
            rows,
            values.astype(np.float64),
            samples[:, length - 7].astype(np.int64),
            faults.astype(np.uint8),
        )

    def notes(self) -> dict[str, str]:
        """That the datagrams are of the recorders' form."""
        if not self.recorded:
            return {}
        return {
            "datagrams 0x93": "of 28 bytes, gyro and accelerometer with the CRC-32 of zip, as some"
            " recorders write them"
        }


def _is_recorded(frames: Frames) -> NDArray[np.bool_]:
    """Whether frames of 28 bytes are of the recorders' form."""
    given = numbers(frames[:, -4:], ">u4")[:, 0]
    alike: NDArray[np.bool_] = (frames[:, 0] == _RECORDED) & (ZIP(frames[:, :-4]) == given)
    return alike


FORMATS = (raw_format("stim300", "raw datagrams of a Sensonor STIM300", Stim300),)
