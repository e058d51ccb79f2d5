"""Datagrams in a raw binary log: found by their first bytes, their length and their checksum.

A log of a serial line has what was on the line: datagrams one after the other, and between them
bytes that were damaged, or of something else.  The reader looks at every place where a datagram may
begin, takes those whose checksum is right, in the order of the file and none within another, and
counts the rest.  So it finds its way back after any damage.

A format is a `Protocol`: where datagrams may begin, how long they are, whether they are whole, and
what they say.  All of it is asked for many datagrams at once.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sculler.readers.raw.checksums import Frames
from sculler.readers.recording import Advance
from sculler_model.errors import InputError

_BLOCK_BYTES = 1 << 20

Bytes = NDArray[np.uint8]
Places = NDArray[np.int64]


class Decoded(NamedTuple):
    """What datagrams of one length say.

    Attributes:
        rows: (N,) which of them hold a sample; the others are known, but say nothing of it.
        values: (N, 6) gyro x, y, z, accelerometer x, y, z.
        ticks: (N,) the device's counter or clock; None where it has none.
        faults: (N,) of 0 and 1.
    """

    rows: Places
    values: NDArray[np.float64]
    ticks: NDArray[np.int64] | None
    faults: NDArray[np.uint8]


class Protocol(ABC):
    """A format of datagrams.

    Attributes:
        longest: bytes that the longest datagram has.
    """

    longest: int

    @abstractmethod
    def starts(self, data: Bytes) -> Places:
        """Where datagrams may begin, growing."""

    @abstractmethod
    def lengths(self, data: Bytes, starts: Places) -> Places:
        """Bytes of the datagram that may begin at each start; 0 or less where none can."""

    @abstractmethod
    def whole(self, frames: Frames) -> NDArray[np.bool_]:
        """Whether the checksum of each datagram (N, L) is right."""

    @abstractmethod
    def decode(self, frames: Frames) -> Decoded:
        """What the datagrams (N, L) say.

        Raises:
            InputError: they say what cannot be read.
        """


@dataclass
class Census:
    """What a log is made of.

    Attributes:
        samples: datagrams that hold a sample.
        others: whole datagrams that hold none.
        bytes_passed_over: bytes that are no part of a whole datagram, but for those at both ends.
        places: runs of such bytes.
        first_place: byte of the file, from 0, where the first run begins; None without one.
        ends: bytes before the first datagram and after the last: one that was cut, as a rule.
        faults: samples whose status says a fault.
    """

    samples: int = 0
    others: int = 0
    bytes_passed_over: int = 0
    places: int = 0
    first_place: int | None = None
    ends: int = 0
    faults: int = 0

    def told(self) -> str:
        """In words."""
        told = f"{self.samples:,} with samples"
        if self.others:
            told += f", {self.others:,} others"
        if self.bytes_passed_over:
            places = "1 place" if self.places == 1 else f"{self.places:,} places"
            told += f"; {self.bytes_passed_over:,} damaged or foreign bytes in {places}"
        if self.faults:
            told += f"; {self.faults:,} samples marked as faults by the sensor"
        return told


class Part(NamedTuple):
    """The samples of a block of the file.

    Attributes:
        decoded: the samples, all rows, in the order of the file.
        passed_over: (N,) bytes passed over between each sample's datagram and the one before it.
        length: bytes of each sample's datagram, (N,).
    """

    decoded: Decoded
    passed_over: Places
    length: Places


def find(protocol: Protocol, data: Bytes) -> tuple[Places, Places]:
    """Starts and lengths of the whole datagrams in some bytes, in order, none within another."""
    starts = protocol.starts(data)
    lengths = protocol.lengths(data, starts)
    inside = (lengths > 0) & (starts + lengths <= len(data))
    starts, lengths = starts[inside], lengths[inside]
    good = np.zeros(len(starts), np.bool_)
    for length in np.unique(lengths).tolist():
        at = np.flatnonzero(lengths == length)
        good[at] = protocol.whole(_frames(data, starts[at], length))
    starts, lengths = starts[good], lengths[good]
    if (starts[1:] < (starts + lengths)[:-1]).any():
        free, kept = 0, []
        for place, (start, length) in enumerate(
            zip(starts.tolist(), lengths.tolist(), strict=True)
        ):
            if start >= free:
                kept.append(place)
                free = start + length
        starts, lengths = starts[kept], lengths[kept]
    return starts, lengths


def _frames(data: Bytes, starts: Places, length: int) -> Frames:
    frames: Frames = data[starts[:, None] + np.arange(length)]
    return frames


def share_of(protocol: Protocol, head: bytes) -> float:
    """How much of a file's first bytes are whole datagrams, two or more; 0 to 1."""
    data = np.frombuffer(head, np.uint8)
    _, lengths = find(protocol, data)
    if len(lengths) < 2:
        return 0.0
    return float(lengths.sum()) / len(data)


def read(path: Path, protocol: Protocol, census: Census, advance: Advance) -> Iterator[Part]:
    """The samples of a raw log, block by block.

    Args:
        path: the file.
        protocol: of its datagrams.
        census: filled as the file is read.
        advance: told the bytes read.

    Raises:
        InputError: the file cannot be read, or has no datagram with a sample.
    """
    try:
        with path.open("rb") as file:
            scan = _Scan(protocol, census)
            while block := file.read(_BLOCK_BYTES):
                advance(len(block))
                if (part := scan.add(block, last=False)) is not None:
                    yield part
            if (part := scan.add(b"", last=True)) is not None:
                yield part
    except OSError as error:
        raise InputError(
            f"{path}: cannot read the log ({error.strerror}), check the path"
        ) from error
    if not census.samples:
        seen = f"only {census.others:,} datagrams without" if census.others else "no whole datagram"
        raise InputError(f"{path}: {seen} with gyro and accelerometer, check --format")


class _Scan:
    """Goes through a file's bytes, from its begin to its end.

    Args:
        protocol: of the datagrams.
        census: filled on the way.
    """

    def __init__(self, protocol: Protocol, census: Census) -> None:
        self._protocol, self._census = protocol, census
        self._rest = b""
        self._begin = 0  # place of `_rest` in the file
        self._damage = 0  # bytes passed over since the last sample
        self._open = False  # the bytes before `_rest` were passed over
        self._any = False  # there has been a datagram

    def add(self, block: bytes, last: bool) -> Part | None:
        """The samples that the next bytes make whole."""
        self._rest += block
        longest = self._protocol.longest
        if not last and len(self._rest) < 2 * longest:
            return None
        data = np.frombuffer(self._rest, np.uint8)
        starts, lengths = find(self._protocol, data)
        if not last:  # what begins later may be cut by the end of the block
            sure = starts <= len(data) - longest
            starts, lengths = starts[sure], lengths[sure]
        ends = np.concatenate([np.zeros(1, np.int64), starts + lengths])
        dealt_with = len(data) if last else max(int(ends[-1]), len(data) - longest)
        between = np.append(starts, dealt_with) - ends  # bytes before each, and after the last
        if not self._any:
            self._census.ends += int(between[0])
            between[0] = 0
        self._any = self._any or len(starts) > 0
        self._count(between, ends + self._begin, last)
        before = np.cumsum(between) + self._damage
        self._damage = int(before[-1])
        self._rest, self._begin = self._rest[dealt_with:], self._begin + dealt_with
        found = _decoded(data, starts, lengths, self._protocol)
        self._census.samples += len(found.rows)
        self._census.others += len(starts) - len(found.rows)
        self._census.faults += int(found.faults.sum())
        if not len(found.rows):
            return None
        passed_over = np.diff(before[found.rows], prepend=0)
        self._damage -= int(before[found.rows[-1]])
        return Part(found, passed_over, lengths[found.rows])

    def _count(self, between: Places, at: Places, last: bool) -> None:
        """Add the bytes passed over to the census."""
        census = self._census
        between = between.copy()
        if last:
            census.ends += int(between[-1])
            between[-1] = 0
        runs = np.flatnonzero(between)
        census.bytes_passed_over += int(between.sum())
        goes_on = self._open and bool(between[0])
        census.places += len(runs) - goes_on
        self._open = bool(between[-1]) and not last
        if len(runs) and census.first_place is None:
            census.first_place = int(at[runs[0]])


def _decoded(data: Bytes, starts: Places, lengths: Places, protocol: Protocol) -> Decoded:
    """What the datagrams say, in their order."""
    rows, values, ticks, faults = [], [], [], []
    for length in np.unique(lengths).tolist():
        at = np.flatnonzero(lengths == length)
        found = protocol.decode(_frames(data, starts[at], length))
        if len(found.rows):
            rows.append(at[found.rows])
            values.append(found.values)
            faults.append(found.faults)
            if found.ticks is not None:
                ticks.append(found.ticks)
    if not rows:
        nothing = np.empty(0, np.int64)
        return Decoded(nothing, np.empty((0, 6)), nothing, np.empty(0, np.uint8))
    row = np.concatenate(rows)
    order = np.argsort(row, kind="stable")
    clock = np.concatenate(ticks)[order] if len(ticks) == len(rows) else None
    return Decoded(row[order], np.concatenate(values)[order], clock, np.concatenate(faults)[order])
