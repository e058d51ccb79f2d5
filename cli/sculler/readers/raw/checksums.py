"""Checksums of many frames of one length at once: every step is taken for all of them.

The parameters are those of the catalogue of CRC algorithms: polynomial, initial value, whether
bits go least significant first (`reflected`), and what is XORed to the result.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Frames = NDArray[np.uint8]
"""(N, L): N frames of L bytes."""


@dataclass(frozen=True)
class Crc:
    """A CRC of up to 32 bits.

    Attributes:
        bits: its width, 16 or 32.
        polynomial: without the highest term, most significant bit first.
        initial: value before the first byte.
        reflected: bits go least significant first.
        final: XORed to the result.
    """

    bits: int
    polynomial: int
    initial: int
    reflected: bool
    final: int = 0

    @cached_property
    def _table(self) -> NDArray[np.uint32]:
        """What one byte makes of the value, for each of 256 bytes."""
        top, mask = 1 << (self.bits - 1), (1 << self.bits) - 1
        polynomial = self.polynomial
        if self.reflected:
            polynomial = int(f"{polynomial:0{self.bits}b}"[::-1], 2)
        table = []
        for byte in range(256):
            value = byte if self.reflected else byte << (self.bits - 8)
            for _ in range(8):
                if self.reflected:
                    value = (value >> 1) ^ (polynomial if value & 1 else 0)
                else:
                    value = ((value << 1) & mask) ^ (polynomial if value & top else 0)
            table.append(value)
        return np.array(table, np.uint32)

    def __call__(self, frames: Frames, zeros: int = 0) -> NDArray[np.uint32]:
        """The CRC (N,) of each frame, with `zeros` bytes of 0 after it."""
        table = self._table
        value = np.full(len(frames), self.initial, np.uint32)
        low, eight = np.uint32(0xFF), np.uint32(8)
        high, mask = np.uint32(self.bits - 8), np.uint32((1 << self.bits) - 1)
        columns = [column.astype(np.uint32) for column in frames.T]
        columns += [np.zeros(len(frames), np.uint32)] * zeros
        for byte in columns:
            if self.reflected:
                value = table[(value ^ byte) & low] ^ (value >> eight)
            else:
                value = table[((value >> high) ^ byte) & low] ^ ((value << eight) & mask)
        return value ^ np.uint32(self.final)


ZIP = Crc(32, 0x04C11DB7, 0xFFFFFFFF, reflected=True, final=0xFFFFFFFF)
"""CRC-32 of zip files and Ethernet."""


def sum_of_bytes(frames: Frames) -> NDArray[np.int64]:
    """The sum (N,) of each frame's bytes."""
    total: NDArray[np.int64] = frames.sum(axis=1, dtype=np.int64)
    return total


def sum_of_words(frames: Frames) -> NDArray[np.int64]:
    """The sum (N,) of each frame's 16-bit words, least significant byte first, modulo 2^16."""
    total: NDArray[np.int64] = numbers(frames, "<u2").sum(axis=1) & 0xFFFF
    return total


def numbers(frames: Frames, kind: str) -> NDArray[np.int64]:
    """Each frame's bytes as whole numbers.

    Args:
        frames: (N, L).
        kind: a numpy type code of 1 to 4 bytes ("<u2", ">i4"), or ">i3": 24 bits, signed.

    Returns:
        (N, L / size of one).
    """
    if kind == ">i3":
        high, middle, low = (frames[:, first::3].astype(np.int64) for first in range(3))
        value = (high << 16) | (middle << 8) | low
        return value - ((value & 0x800000) << 1)
    whole: NDArray[np.int64] = _viewed(frames, kind).astype(np.int64)
    return whole


def reals(frames: Frames, kind: str) -> NDArray[np.float64]:
    """Each frame's bytes as floats of a numpy type code ("<f4", ">f8"), (N, L / size of one)."""
    given: NDArray[np.float64] = _viewed(frames, kind).astype(np.float64)
    return given


def _viewed(frames: Frames, kind: str) -> NDArray[np.generic]:
    size = np.dtype(kind).itemsize
    return np.ascontiguousarray(frames).view(kind).reshape(len(frames), frames.shape[1] // size)
