"""Raw logs of what a design's [hardware.front] reads: the maker's frames, or the design's own.

The description is that of the front end (`sculler_model.front.Layout`), so that hardware and
`convert` read the same bytes alike: the same frames are whole, the same samples are marked.
Counts are the design's own.  Lost frames are told by the counter, as gaps.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sculler.readers.format import UNITS, Format, Request
from sculler.readers.raw.checksums import Crc, Frames
from sculler.readers.raw.datagrams import Bytes, Decoded, Places, share_of
from sculler.readers.raw.recording import RawProtocol, Scales, Ticks, recording_of
from sculler.readers.recording import ACCEL_UNITS, GYRO_UNITS, Recording
from sculler_model.errors import InputError
from sculler_model.front import Check, Flags, Layout, Number

_HEAD_BYTES = 1 << 14
_MOST = 0.5


def _numbers(frames: Frames, number: Number) -> NDArray[np.int64]:
    """A number of each frame, (N,)."""
    value = np.zeros(len(frames), np.int64)
    for place in number.places:
        value = value << 8 | frames[:, place]
    return value - ((value >> (number.bits - 1) & 1) << number.bits) if number.signed else value


def _raised(frames: Frames, every: tuple[Flags, ...]) -> NDArray[np.bool_]:
    """Whether a flag of each frame is raised, (N,)."""
    found = np.zeros(len(frames), np.bool_)
    for flags in every:
        found |= (frames[:, flags.place] ^ flags.normal) & flags.mask != 0
    return found


def _check(check: Check, content: Frames, zeros: int) -> NDArray[np.int64]:
    """The check of the bytes that it covers, (N,)."""
    mask = (1 << check.bits) - 1
    if check.kind == "crc":
        initial = check.initial
        if check.reflected:  # of the register that holds the lowest bit first
            initial = int(f"{initial:0{check.bits}b}"[::-1], 2)
        crc = Crc(check.bits, check.polynomial, initial, check.reflected, check.final)
        return crc(content, zeros).astype(np.int64)
    words = content.astype(np.int64)
    if check.word_bytes == 2:
        first, second = words[:, ::2], words[:, 1::2]
        words = first | second << 8 if check.little else first << 8 | second
    if check.kind == "sum":
        total = words.sum(axis=1) + check.initial
    else:
        total = np.bitwise_xor.reduce(words, axis=1) ^ check.initial
    value: NDArray[np.int64] = (total & mask) ^ check.final
    return value


class FrontFrames(RawProtocol):
    """The frames of a layout.

    Args:
        layout: with first bytes to each kind.
    """

    scales = Scales({}, {})

    def __init__(self, layout: Layout) -> None:
        self.layout = layout
        self.longest = layout.longest
        counter = layout.counter
        self.ticks = None
        if counter is not None:
            told = f"the frames' counter, of {counter.samples:,} samples"
            self.ticks = Ticks(None, (counter.samples,), told, counts=True)

    def starts(self, data: Bytes) -> Places:
        """Where a kind of frame may begin."""
        found = [self._begins(data, kind.first) for kind in self.layout.kinds]
        return np.unique(np.concatenate(found))

    @staticmethod
    def _begins(data: Bytes, first: bytes) -> Places:
        count = len(data) - len(first) + 1
        if count <= 0:
            return np.empty(0, np.int64)
        same = np.ones(count, np.bool_)
        for place, byte in enumerate(first):
            same &= data[place : place + count] == byte
        return np.flatnonzero(same)

    def lengths(self, data: Bytes, starts: Places) -> Places:
        """As the kind has them."""
        lengths = np.zeros(len(starts), np.int64)
        for kind in self.layout.kinds:
            same = np.ones(len(starts), np.bool_)
            for place, byte in enumerate(kind.first):
                same &= data[starts + place] == byte
            lengths[same] = kind.length
        return lengths

    def whole(self, frames: Frames) -> NDArray[np.bool_]:
        """Whether the check is right."""
        layout, length = self.layout, frames.shape[1]
        check = layout.check
        assert check is not None  # frames without one come over SPI
        content = frames[:, check.first : length + check.last + 1]
        zeros = next(kind.zeros for kind in layout.kinds if kind.length == length)
        good: NDArray[np.bool_] = _check(check, content, zeros) == _numbers(frames, check.given)
        return good

    def decode(self, frames: Frames) -> Decoded:
        """Samples of those frames that hold one."""
        layout = self.layout
        holds = ~_raised(frames, layout.absent)
        for kind in layout.kinds:
            if not kind.sample:
                begins = frames[:, : len(kind.first)] == np.frombuffer(kind.first, np.uint8)
                holds &= ~begins.all(axis=1)
        rows = np.flatnonzero(holds)
        if not len(rows):
            return Decoded(rows, np.empty((0, 6)), rows, np.empty(0, np.uint8))
        samples = frames[rows]
        values = [_numbers(samples, number) for number in (*layout.gyro, *layout.accel)]
        ticks = None
        if layout.counter is not None:
            counter = layout.counter
            count = _numbers(samples, counter.number) % counter.modulus
            ticks = (count >> counter.common_bits) * counter.inverse % counter.samples
        faults = _raised(samples, layout.faults).astype(np.uint8)
        return Decoded(rows, np.stack(values, axis=1).astype(np.float64), ticks, faults)


def are_frames(path: Path, layout: Layout) -> bool:
    """Whether a file begins with frames of a layout, most of it; not where it cannot be read."""
    try:
        with path.open("rb") as file:
            head = file.read(_HEAD_BYTES)
    except OSError:
        return False
    return share_of(FrontFrames(layout), head) > _MOST


def _open(path: Path, request: Request) -> Recording:
    link = request.design.front
    if link is None:
        raise InputError(
            "--format front reads the frames of the design's [hardware.front], and it has none"
        )
    if link.layout.aligned:
        raise InputError(
            f"{path}: the design's front end reads bursts, which have no sync bytes; --format"
            " adis16470 and adis16470-32 read those of ADIS16470 and like parts"
        )
    own = replace(
        request,
        gyro=request.gyro or GYRO_UNITS["counts"],
        accel=request.accel or ACCEL_UNITS["counts"],
    )
    return recording_of(path, FrontFrames(link.layout), own)


FORMATS = (
    Format(
        "front", "raw frames of the sensor that the design's [hardware.front] reads", _open, UNITS
    ),
)
