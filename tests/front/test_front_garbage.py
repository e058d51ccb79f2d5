"""Any bytes at any time: the receiver and the sequence in Amaranth's simulator give the model's."""

from __future__ import annotations

import random
from dataclasses import astuple, replace
from typing import Any

import pytest
from amaranth import Module
from amaranth.lib import wiring
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from amaranth_runs import drive
from front_runs import COUNTERS, PORTS
from raw_datagrams import crc_msb_first
from sculler_hdl.front.frames import FrameReceiver
from sculler_hdl.front.sequence import SampleSequence
from sculler_hdl.plan.front import FrontPlan
from sculler_model.design import Design
from sculler_model.front import FrontModel, Kind, Layout, Link

_AXES = {"bits": 8, "lsb": 1e-3}
DESIGN = Design.parse(
    {
        "name": "short",
        "sensor": {"kind": "increment", "sample_rate_hz": 1000.0, "gyro": _AXES, "accel": _AXES},
        "algorithm": {"family": "frequency-taylor", "samples": 2, "minors": 1},
        "hardware": {
            "front": {
                "sensor": "custom",
                "clock_hz": 4e6,
                "baud": 2e5,
                "frame": {
                    "sync": [0x55, 0xAA],
                    "length": 11,
                    "gyro": {"at": [2, 3, 4], "bytes": 1},
                    "accel": {"at": [5, 6, 7], "bytes": 1},
                    "counter": {"byte": 8, "modulus": 16, "step": 3},
                    "status": [{"byte": 8, "mask": 0x80}],
                    "check": {
                        "kind": "crc",
                        "bits": 16,
                        "byte": 9,
                        "first": 2,
                        "last": 8,
                        "polynomial": 0x1021,
                        "initial": 0xFFFF,
                    },
                },
            }
        },
    }
)
SPACING = 2 * 11 + 16  # clocks from byte to byte, as few as may be


def frame(number: int, status: int = 0) -> bytes:
    body = bytes((number + place) % 256 for place in range(6)) + bytes([3 * number % 16 | status])
    return b"\x55\xaa" + body + crc_msb_first(body, 16, 0x1021, 0xFFFF).to_bytes(2, "big")


def quick(link: Link) -> Link:
    """Frames follow each other at once: an interval is that of 12 bytes."""
    return replace(link, clock_hz=12.0 * SPACING, sample_rate_hz=1.0)


def run_parts(link: Link, stream: list[tuple[int, int]], clocks: int) -> tuple[Any, Any]:
    """What the parts hand over, and count, of bytes that are whole in given clocks."""
    plan = FrontPlan(link)
    receiver, sequence = FrameReceiver(plan), SampleSequence(DESIGN, plan)
    top = Module()
    top.submodules.receiver, top.submodules.sequence = receiver, sequence
    top.d.comb += [
        sequence.data_valid.eq(receiver.data_valid),
        sequence.idle.eq(receiver.idle),
        sequence.frame_valid.eq(receiver.frame_valid),
        receiver.frame_ready.eq(sequence.frame_ready),
        sequence.fault.eq(receiver.fault),
        sequence.broken.eq(receiver.broken),
        *(getattr(sequence, name).eq(getattr(receiver, name)) for name in plan.fields),
        sequence.sample_ready.eq(1),
    ]
    samples: list[Any] = []
    counters: dict[str, int] = dict.fromkeys(COUNTERS, 0)

    async def bench(ctx: Any) -> None:
        line = dict(stream)
        shown = [sequence.sample_valid, *(getattr(sequence, n) for n in PORTS)]
        counted = [getattr(sequence, name) for name in COUNTERS]
        ticks = ctx.tick().sample(*shown, sequence.sample_fault, *counted)
        ctx.set(receiver.data_valid, 0 in line)
        now = 0
        async for _, _, valid, *rest in ticks:
            if valid:
                samples.append((tuple(rest[:6]), rest[6]))
            now += 1
            ctx.set(receiver.data_valid, now in line)
            ctx.set(receiver.data, line.get(now, 0))
            if now == clocks:
                counters.update(zip(COUNTERS, rest[7:], strict=True))
                break

    assert isinstance(receiver, wiring.Component)
    drive(top, bench)
    return samples, counters


def run_page(link: Link, stream: list[tuple[int, int]], clocks: int) -> tuple[Any, Any]:
    """The same of the model."""
    model = FrontModel(link)
    found = []
    for clock, byte in stream:
        found += model.take(byte, clock)
    found += model.until(clocks - 20)
    counters = dict(zip(COUNTERS, astuple(model.counters), strict=True))
    return [((*s.gyro, *s.accel), int(s.fault)) for s in found], counters


def check(link: Link, content: bytes, gaps: list[int]) -> None:
    """Bytes with pauses of so many byte times before some."""
    stream, clock = [], 5
    for place, byte in enumerate(content):
        clock += SPACING * (1 + (gaps[place % len(gaps)] if gaps and place % 7 == 0 else 0))
        stream.append((clock, byte))
    end = clock + SPACING * 20
    samples, counters = run_parts(link, stream, end)
    # a time-out in the very last clocks may or may not have been shown
    model = run_page(link, stream, end)
    assert samples[: len(model[0])] == model[0]
    assert len(samples) - len(model[0]) <= link.patience
    late = counters.pop("frames_late") - model[1].pop("frames_late")
    assert 0 <= late <= link.patience
    assert counters == model[1]


pieces = st.one_of(
    st.binary(max_size=6),
    st.sampled_from([b"\x55", b"\xaa", b"\x55\xaa", b"\x55\x55\xaa"]),
    st.builds(frame, st.integers(0, 40), st.sampled_from([0, 0x80])),
    st.builds(
        lambda number, bit: bytes(
            byte ^ (1 << bit % 8 if place == bit // 8 else 0)
            for place, byte in enumerate(frame(number))
        ),
        st.integers(0, 40),
        st.integers(0, 87),
    ),
)
streams = st.lists(pieces, min_size=1, max_size=14).map(b"".join)


@pytest.mark.parametrize("examples", [4, pytest.param(150, marks=pytest.mark.deep)])
def test_any_bytes(examples: int) -> None:
    """Frames in any order, whole and broken, and garbage between them, with pauses."""
    link = quick(DESIGN.front)

    @settings(
        max_examples=examples,
        deadline=None,
        derandomize=True,
        suppress_health_check=list(HealthCheck),
    )
    @given(streams, st.lists(st.integers(0, 60), max_size=3))
    def run(content: bytes, gaps: list[int]) -> None:
        check(link, content, gaps)

    run()


def test_a_wire_full_of_sync_bytes() -> None:
    """Where every byte may begin a frame, each is looked through before the next byte."""
    link = DESIGN.front
    assert link is not None
    layout: Layout = replace(link.layout, kinds=(Kind(b"\x55", 11),))
    link = quick(replace(link, layout=layout))
    content = b"\x55" * 40 + frame(1) + b"\x55" * 3 + frame(2) + bytes(12)
    check(link, content, [])
    rng = random.Random(1)
    check(link, bytes(rng.choice(b"\x55\xaa") for _ in range(60)), [])


def at_clocks(*frames: tuple[int, int]) -> list[tuple[int, int]]:
    """Bytes of numbered frames whose last byte is whole in a clock."""
    return [
        (last - SPACING * (10 - place), byte)
        for last, number in frames
        for place, byte in enumerate(frame(number))
    ]


def test_time_outs_come_to_the_clock_and_late_frames_are_not_used() -> None:
    link = quick(DESIGN.front)
    first, due, interval = 500, 500 + link.time_out, link.interval
    found = {}
    for late in (0, 1):  # the frame's last byte in the clock of the time-out, or one later
        stream = at_clocks((first, 0), (due + late, 4), (due + late + interval, 5))
        found[late] = run_parts(link, stream, due + 2 * interval)
        assert found[late] == run_page(link, stream, due + 2 * interval)
    counters = [found[late][1] for late in (0, 1)]
    assert [each["frames_late"] for each in counters] == [0, 4]
    assert [each["frames_missed"] for each in counters] == [3, 0]
    assert [each["frames_bad"] for each in counters] == [0, 1]
    # five placeholders by time-outs: frame 1 is the oldest whose place they took
    for number, bad, jumps in ((1, 1, 0), (0, 0, 1)):
        stream = at_clocks((first, 0), (due + interval + 200, number))
        samples, counted = run_parts(link, stream, due + 2 * interval)
        assert (samples, counted) == run_page(link, stream, due + 2 * interval)
        assert counted["frames_late"] == 5
        assert (counted["frames_bad"], counted["sensor_faults"]) == (bad, jumps)
