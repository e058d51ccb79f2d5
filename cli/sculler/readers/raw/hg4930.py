"""Honeywell HG4930: messages of the asynchronous protocol.

A message, least significant byte first, has the address 0E and its number (1 byte each), six
numbers of rates (2 bytes each), status words 1 and 2, and the sum of all 16-bit words before it.
The inertial message (02, 44 bytes) has delta angles x, y, z (2^-33 rad) and delta velocities x, y,
z (2^-27 ft/s) of 4 bytes each before the sum; the control messages (01 and CA, 20 bytes) have none.
Source: *HG4930 Performance and Installation Manual*, Honeywell; the maintained driver
bolderflight/hg4930 agrees.

Bits 0 and 1 of status word 1 count.  What they count between two inertial messages depends on what
else is sent, so that the usual step is taken from the first messages; a step that differs from it
is of lost messages, as few as explain it.  Until the power-up test is done the unit sends a fixed
pattern in place of data (bit 9 of status word 2): such messages are no samples.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sculler.readers.raw.checksums import Frames, numbers, sum_of_words
from sculler.readers.raw.datagrams import Bytes, Decoded, Places, find
from sculler.readers.raw.recording import RawProtocol, Scales, Ticks, raw_format

_ADDRESS, _INERTIAL = 0x0E, 0x02
_LENGTH = np.zeros(256, np.int64)
_LENGTH[[0x01, _INERTIAL, 0xCA]] = 20, 44, 20
_FAULTS_1 = 0x87F0  # IMU, gyro, accelerometer, gyro sensor, IMU OK
_FAULTS_2 = 0x7D00  # health, tests
_PATTERN = 1 << 9


class Hg4930(RawProtocol):
    """Messages; inertial ones hold a sample."""

    longest = 44
    scales = Scales({"rad": 2.0**-33}, {"ft/s": 2.0**-27})
    ticks: Ticks | None = Ticks(None, (4,), "the two-bit counter of the messages", counts=True)

    def __init__(self) -> None:
        self._step = 1  # of the counter from one inertial message to the next, modulo 4

    def starts(self, data: Bytes) -> Places:
        """An address and a known number."""
        return np.flatnonzero((data[:-1] == _ADDRESS) & (_LENGTH[data[1:]] > 0))

    def lengths(self, data: Bytes, starts: Places) -> Places:
        """As the number tells."""
        return _LENGTH[data[starts + 1]]

    def whole(self, frames: Frames) -> NDArray[np.bool_]:
        """Whether the sum is right."""
        good: NDArray[np.bool_] = (
            sum_of_words(frames[:, :-2]) == numbers(frames[:, -2:], "<u2")[:, 0]
        )
        return good

    def decode(self, frames: Frames) -> Decoded:
        """Increments; a fault where a status says so."""
        if frames.shape[1] != _LENGTH[_INERTIAL]:
            nothing = np.empty(0, np.int64)
            return Decoded(nothing, np.empty((0, 6)), nothing, np.empty(0, np.uint8))
        status = numbers(frames[:, 14:18], "<u2")
        rows = np.flatnonzero(status[:, 1] & _PATTERN == 0)
        status = status[rows]
        faults = (status[:, 0] & _FAULTS_1 != 0) | (status[:, 1] & _FAULTS_2 != 0)
        return Decoded(
            rows,
            numbers(frames[rows, 18:42], "<i4").astype(np.float64),
            self._counted(status[:, 0] & 3),
            faults.astype(np.uint8),
        )

    def _counted(self, counter: Places) -> Places:
        """The counter in inertial messages: modulo 4, or modulo 2 where it goes on by 2."""
        # an odd step is its own inverse modulo 4
        return counter >> 1 if self._step == 2 else counter * self._step % 4

    def settle(self, path: Path, head: Bytes) -> None:
        """The usual step of the counter."""
        starts, lengths = find(self, head)
        starts = starts[lengths == _LENGTH[_INERTIAL]]
        counter = self.decode(head[starts[:, None] + np.arange(_LENGTH[_INERTIAL])]).ticks
        if counter is None or len(counter) < 2:
            return
        self._step = int(np.bincount(np.diff(counter) % 4).argmax())
        if self._step == 2:
            self.ticks = Ticks(
                None, (2,), "the two-bit counter of the messages, every second count", counts=True
            )
        if not self._step:
            self.ticks = None

    def notes(self) -> dict[str, str]:
        """What the increments are."""
        return {
            "increments": "as the unit gives them: the turn within a sample is taken off the"
            " velocity (half the delta angle times the delta velocity)"
        }


FORMATS = (raw_format("hg4930", "inertial messages of a Honeywell HG4930", Hg4930),)
