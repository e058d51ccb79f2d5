"""What a chip sent: its results as exact integers with their times, and its states."""

from __future__ import annotations

import zlib
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sculler.formats.telemetry import FRAME
from sculler.soc.plan import COUNTERS, registers_of
from sculler_model.design import Design
from sculler_model.fast import VectorBlock
from sculler_model.golden import words_per_column

_MARK = b"SN\x01"
_HEAD, _CRC = 8, 4
_STATE, _RESULT, _ALIGNMENT = 1, 2, 3
_FRONT_STAMPS = 7  # registers of time stamps behind a result's columns

ALIGNMENT = np.dtype(
    [
        ("head", f"V{_HEAD}"),
        ("number", "<u8"),
        ("error", "<u4"),
        ("fine", "<u4"),
        ("seconds", "<f8"),
        ("q", "<f8", 4),
        ("covariance", "<f8", (3, 3)),
        ("horizontal_rate", "<f8"),
        ("down_rate", "<f8"),
        ("specific_force", "<f8"),
        ("gravity", "<f8"),
        ("gyro_bias", "<f8", 3),
        ("gyro_bias_sigma", "<f8", 3),
        ("surprise", "<f8"),
        ("crc", "<u4"),
    ]
)
"""A frame of kind 3; its quaternion is x, y, z, w as in a state's."""


@dataclass(frozen=True)
class ChipRecord:
    """What a chip's telemetry tells; row by row where a frame was whole.

    Attributes:
        results: the core's, as `sculler model` gives them, with the times of the intervals' ends.
        numbers: (N,) numbers of their frames, from 0.
        sample_clock, result_clock: (N,) when the core took the interval's last sample (with a front
            end: when its first bit came), and when the result was whole; in clocks since the
            counter's reset, as what follows.
        free, begun, ended: (N,) when the firmware had nothing left to do before the result, when it
            took it up, and when it had the state.
        counters: (N, 5) frames_taken, frames_bad, frames_missed, frames_late, samples_lost.
        alignments: frames of kind 3 (`ALIGNMENT`).
        states: the frames of the states (`sculler.formats.telemetry.FRAME`).
        state_ends: number of each state's frame, and the place of its last byte.
        passed_over: bytes that belong to no whole frame.
    """

    results: VectorBlock
    numbers: NDArray[np.int64]
    sample_clock: NDArray[np.int64]
    result_clock: NDArray[np.int64]
    free: NDArray[np.int64]
    begun: NDArray[np.int64]
    ended: NDArray[np.int64]
    counters: NDArray[np.int64]
    alignments: NDArray[np.void]
    states: NDArray[np.void]
    state_ends: list[tuple[int, int]]
    passed_over: int

    def first(self, results: int) -> ChipRecord:
        """As far as so many results go."""
        number = self.numbers[results] if results < len(self.numbers) else np.inf
        states = int((self.states["number"] < number).sum())
        return replace(
            self,
            results=self.results[:results],
            **{name: getattr(self, name)[:results] for name in _BY_RESULT},
            alignments=self.alignments[self.alignments["number"] < number],
            states=self.states[:states],
            state_ends=self.state_ends[:states],
        )


_BY_RESULT = ("numbers", "sample_clock", "result_clock", "free", "begun", "ended", "counters")


def read_chip(design: Design, data: bytes) -> ChipRecord:
    """Decode what a chip sent.  What is damaged is passed over, byte by byte.

    Args:
        design: of the chip.
        data: bytes of its telemetry.
    """
    states, alignments, results, at, passed = bytearray(), bytearray(), list[bytes](), 0, 0
    ends: list[tuple[int, int]] = []
    while at < len(data):
        kind, length = data[at + 3 : at + 4], _length(data, at)
        frame = data[at : at + length]
        if not length or len(frame) < length or not _is_whole(frame):
            passed += 1
            at += 1
            continue
        if kind[0] == _STATE and length == FRAME.itemsize:
            states += frame
            ends.append((int.from_bytes(frame[8:16], "little"), at + length - 1))
        elif kind[0] == _RESULT:
            results.append(frame)
        elif kind[0] == _ALIGNMENT and length == ALIGNMENT.itemsize:
            alignments += frame
        at += length
    table = np.frombuffer(bytes(alignments), ALIGNMENT)
    return _record(design, results, table, np.frombuffer(bytes(states), FRAME), ends, passed)


def _length(data: bytes, at: int) -> int:
    """Of the frame that would begin there, 0 for none."""
    head = data[at : at + _HEAD]
    if len(head) < _HEAD or head[: len(_MARK)] != _MARK:
        return 0
    return _HEAD + int.from_bytes(head[4:6], "little") + _CRC


def _is_whole(frame: bytes) -> bool:
    return zlib.crc32(frame[:-_CRC]) == int.from_bytes(frame[-_CRC:], "little")


def _record(
    design: Design,
    frames: list[bytes],
    alignments: NDArray[np.void],
    states: NDArray[np.void],
    ends: list[tuple[int, int]],
    passed: int,
) -> ChipRecord:
    registers = registers_of(design)
    layout = np.dtype(
        [
            ("head", f"V{_HEAD}"),
            ("number", "<u8"),
            ("window", "<u4", registers),
            ("counters", "<u4", len(COUNTERS)),
            ("free", "<u8"),
            ("begun", "<u8"),
            ("ended", "<u8"),
            ("crc", "<u4"),
        ]
    )
    own = [frame for frame in frames if len(frame) == layout.itemsize]
    table = np.frombuffer(b"".join(own), layout)
    stamps = table["window"][:, -_FRONT_STAMPS:].astype(np.int64)
    rows = [_row(design, window) for window in table["window"].tolist()]
    results = VectorBlock.from_rows(rows, design)
    return ChipRecord(
        results,
        table["number"].astype(np.int64),
        stamps[:, 0] | stamps[:, 1] << 32,
        stamps[:, 2] | stamps[:, 3] << 32,
        table["free"].astype(np.int64),
        table["begun"].astype(np.int64),
        table["ended"].astype(np.int64),
        table["counters"].astype(np.int64),
        alignments,
        states,
        ends,
        passed,
    )


def _row(design: Design, window: list[int]) -> list[int]:
    """A result's columns from its registers: major and status without sign, the others with it."""
    size = -(-words_per_column(design) // 2)
    row = []
    for number in range(len(design.columns)):
        words = window[size * number : size * (number + 1)]
        value = sum(word << 32 * place for place, word in enumerate(words))
        top = 1 << (32 * size - 1)
        row.append(value - 2 * top if number > 1 and value & top else value)
    return row
