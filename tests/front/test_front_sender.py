"""Frames from numbers are those of independent makers, and come back through the receiver."""

from __future__ import annotations

import random

import pytest

from front_designs import FRAMES, design_of, made
from sculler_model.front import Receiver, frame_of


@pytest.mark.parametrize("name", FRAMES)
def test_frames_are_the_makers(name: str) -> None:
    design = design_of(name)
    assert design.front is not None
    layout, chance = design.front.layout, random.Random(name)
    unlike = set()
    for number in range(6):
        bits = design.sensor.gyro.bits
        counts = [chance.randint(-(1 << bits - 1), (1 << bits - 1) - 1) for _ in range(6)]
        frame = frame_of(layout, counts[:3], counts[3:], number)
        other = made(name, counts[:3], counts[3:], number)
        assert len(frame) == len(other)
        # what the layout tells of: numbers, counter, flags; the maker fills the rest as it likes
        for part in (*layout.gyro, *layout.accel):
            assert part.of(frame) == part.of(other)
        if layout.counter is not None:
            counter, low = layout.counter, (1 << layout.counter.bits) - 1
            assert counter.number.of(frame) & low == counter.number.of(other) & low
        assert not any(flags.raised_in(frame) for flags in (*layout.faults, *layout.absent))
        kind = layout.kind_of(frame)
        assert kind is not None
        assert layout.is_whole(frame, kind)
        unlike |= {place for place in range(len(frame)) if frame[place] != other[place]}
    assert len(unlike) < len(frame) // 2


@pytest.mark.parametrize("name", ["stim300", "hg4930"])
def test_a_fault_is_seen_and_nothing_else_changes(name: str) -> None:
    layout = design_of(name).front.layout  # type: ignore[union-attr]
    receiver = Receiver(layout)
    frame = frame_of(layout, (1, -2, 3), (-4, 5, -6), 7, fault=True)
    found = [kind for byte in frame for kind, _ in receiver.take(byte)]
    assert len(found) == 1
    assert any(flags.raised_in(frame) for flags in layout.faults)
    assert [part.of(frame) for part in layout.gyro] == [1, -2, 3]


def test_a_count_too_large_is_refused() -> None:
    layout = design_of("stim300").front.layout  # type: ignore[union-attr]
    with pytest.raises(ValueError, match="does not fit 24 bits"):
        frame_of(layout, (1 << 23, 0, 0), (0, 0, 0), 0)
