"""The golden model of front ends against frames made by hand, damaged in known ways."""

from __future__ import annotations

import random
import struct
from collections.abc import Iterable, Sequence
from typing import Any

import pytest

import raw_datagrams
from front_designs import FRAMES, design_of, made
from sculler_model.errors import InputError
from sculler_model.front import Check, Counter, FrontModel, FrontSample, Number, adis_requests


def counts(number: int) -> tuple[tuple[int, int, int], tuple[int, int, int]]:
    rng = random.Random(number)
    six = [rng.randint(-(1 << 15), (1 << 15) - 1) for _ in range(6)]
    return (six[0], six[1], six[2]), (six[3], six[4], six[5])


def numbers(samples: Iterable[FrontSample], known: int) -> list[int | None]:
    """Which frame each sample is of; None for placeholders."""
    which = {counts(number): number for number in range(known)}
    return [None if s.placeholder else which[s.gyro, s.accel] for s in samples]


@pytest.mark.parametrize("name", FRAMES)
def test_whole_frames_are_taken_as_they_are(name: str) -> None:
    model = FrontModel(design_of(name).front, timed=False)
    stream = b"".join(made(name, *counts(i), i) for i in range(300))
    samples = list(model.run(stream))
    assert [(s.gyro, s.accel, s.fault) for s in samples] == [
        (*counts(i), False) for i in range(300)
    ]
    assert model.counters.frames_taken == 300
    assert model.counters.frames_bad == model.counters.frames_missed == 0


@pytest.mark.parametrize("name", [name for name in FRAMES if name != "adis16488"])
def test_every_flipped_bit_breaks_a_frame_which_gets_a_placeholder(name: str) -> None:
    frames = [made(name, *counts(i), i) for i in range(3)]
    link = design_of(name).front
    bits = range(8 * len(frames[1]))
    for bit in random.Random(1).sample(bits, 60):
        damaged = bytearray(frames[1])
        damaged[bit // 8] ^= 1 << bit % 8
        model = FrontModel(link, timed=False)
        after = [made(name, *counts(i), i) for i in range(3, 6)]
        samples = list(model.run(frames[0] + bytes(damaged) + frames[2] + b"".join(after)))
        assert numbers(samples, 6) == [0, None, 2, 3, 4, 5], bit
        assert samples[1] == samples[0]._replace(fault=True, placeholder=True)
        assert model.counters.frames_missed == 1


@pytest.mark.parametrize("name", [name for name in FRAMES if "adis" not in name])
def test_after_any_garbage_the_second_whole_frame_is_out(name: str) -> None:
    link = design_of(name).front
    longest = link.layout.longest
    for seed in range(60):
        rng = random.Random(seed)
        begin = [kind.first for kind in link.layout.kinds]
        garbage = b"".join(
            rng.choice([rng.randbytes(1), rng.choice(begin)]) for _ in range(rng.randint(1, 90))
        )
        model = FrontModel(link, timed=False)
        stream = garbage + made(name, *counts(0), 0) + made(name, *counts(1), 1)
        samples = list(model.run(stream + bytes(longest)))
        assert [s for s in samples if not s.placeholder][-2:] == [
            FrontSample(*counts(i), latency=200 if "stim" in name else 0) for i in (0, 1)
        ]


def test_a_wrong_check_counts_once_for_its_bytes() -> None:
    model = FrontModel(design_of("stim300").front, timed=False)
    # a frame full of identifiers, damaged: 28 places where one could begin
    frame = bytearray(
        made("stim300", *((int.from_bytes(b"\x91" * 3, "big", signed=True),) * 3,) * 2, 0)
    )
    frame[-1] ^= 1
    list(model.run(bytes(frame) + b"".join(made("stim300", *counts(i), i) for i in range(1, 5))))
    assert model.counters.frames_bad == 1


def clocked(
    model: FrontModel, interval: int, frames: Sequence[tuple[int, bytes]], end: int
) -> list[FrontSample]:
    """Frames whose last byte comes so many intervals from the start, in thousandths."""
    samples: list[FrontSample] = []
    for at, frame in frames:
        last = at * interval // 1000
        for place, byte in enumerate(frame):
            samples += model.take(byte, last - len(frame) + 1 + place)
    samples += model.until(end * interval // 1000 + 1)
    return samples


def test_time_outs_insert_placeholders_and_the_counter_puts_right_what_the_clock_got_wrong() -> (
    None
):
    link = design_of("stim300").front
    interval = link.interval

    def run(*frames: tuple[int, int], end: int) -> tuple[list[int | None], FrontModel]:
        model = FrontModel(link)
        given = [(at, made("stim300", *counts(i), i)) for at, i in frames]
        return numbers(clocked(model, interval, given, end), 500), model

    # 3 lost ones are found by the counter, no time-out
    found, model = run((1000, 0), (5000, 4), end=5100)
    assert found == [0, None, None, None, 4]
    assert (model.counters.frames_missed, model.counters.frames_late) == (3, 0)
    # silence: 4 at 4.5 intervals, then one each; nothing at 4.499
    assert run((1000, 0), end=5499)[0] == [0]
    found, model = run((1000, 0), end=10_501)
    assert found == [0] + [None] * 9
    assert model.counters.frames_late == 9
    # the sensor's clock was slow: one placeholder too many, so its frame is not used
    found, model = run((1000, 0), (6600, 4), (7600, 5), (8600, 6), end=8700)
    assert found == [0, None, None, None, None, None, 6]
    assert (model.counters.frames_bad, model.counters.frames_late) == (2, 5)
    # it was fast: one too few
    found, model = run((1000, 0), (6400, 7), end=6500)
    assert found == [0, None, None, None, None, None, None, 7]
    assert (model.counters.frames_missed, model.counters.frames_late) == (2, 4)
    # more than a round of the counter
    found, model = run((0, 0), (300_000, 300), end=300_100)
    assert len(found) == 301
    assert found[-1] == 300
    # a sensor that began anew
    found, model = run((1000, 100), (2000, 7), (3000, 8), end=3100)
    assert found == [100, 7, 8]
    assert model.counters.sensor_faults == 1


def test_the_status_marks_a_sample_and_control_messages_hold_none() -> None:
    model = FrontModel(design_of("stim300").front, timed=False)
    frames = [raw_datagrams.stim300(*counts(i), i, status=0x40 * (i == 1)) for i in range(3)]
    assert [s.fault for s in model.run(b"".join(frames))] == [False, True, False]
    assert model.counters.sensor_faults == 1
    model = FrontModel(design_of("hg4930").front, timed=False)
    control = struct.pack("<BB6hHH", 0x0E, 0x01, *[0] * 6, 4, 0)
    control += struct.pack("<H", sum(struct.unpack("<9H", control)) & 0xFFFF)
    pattern = raw_datagrams.hg4930(*counts(9), 0, status2=0x200)
    stream = pattern + control * 5 + made("hg4930", *counts(0), 0) + control * 5
    assert numbers(model.run(stream + made("hg4930", *counts(1), 1)), 2) == [0, 1]


def test_checks_are_those_of_the_catalogue() -> None:
    """CRC-16/XMODEM, CRC-32/ISO-HDLC, CRC-32/MPEG-2, CRC-16/ARC of 123456789."""
    given = Number((-1,))
    for bits, polynomial, initial, reflected, final, value in [
        (16, 0x1021, 0, False, 0, 0x31C3),
        (32, 0x04C11DB7, 0xFFFFFFFF, True, 0xFFFFFFFF, 0xCBF43926),
        (32, 0x04C11DB7, 0xFFFFFFFF, False, 0, 0x0376E6E7),
        (16, 0x8005, 0, True, 0, 0xBB3D),
        (16, 0x1021, 0xB2AA, True, 0, 0x63D0),  # CRC-16/RIELLO
    ]:
        check = Check("crc", bits, given, 0, -1, polynomial, initial, reflected, final)
        assert check.of(b"123456789") == value


@pytest.mark.parametrize(("bits", "step"), [(8, 1), (8, 16), (2, 6), (7, 3), (8, 12), (16, 1)])
def test_steps_of_a_counter(bits: int, step: int) -> None:
    counter = Counter(Number((0, 1)), bits, step)
    for k in range(counter.samples):
        assert counter.steps(k * step) == k
    odd = {d for d in range(counter.modulus) if counter.steps(d) is None}
    assert odd == set(range(counter.modulus)) - {k * step % counter.modulus for k in range(1 << 16)}


CUSTOM: dict[str, Any] = FRAMES["custom"][0]["hardware"]["front"]


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"baud": 9600}, "front.baud: a frame takes"),
        ({"clock_hz": 1e6}, "front.baud: .* 16th of clock_hz"),
        ({"baud": None}, "front.baud: missing"),
        ({"sck_hz": 1e6}, "front.sck_hz: custom sends on an asynchronous line"),
        ({"datagram": 0x91}, "front.datagram: goes with"),
        ({"sensor": "stim300"}, "front.frame: goes with"),
        ({"time_out": 200}, "front.time_out: 200 is more than the counter can tell, give 127"),
        ({"frame": {"length": 30}}, "front.frame: check goes beyond"),
        ({"frame": {"check": {"last": 29}}}, "front.frame: check covers itself"),
        ({"frame": {"check": {"polynomial": 0x11021}}}, "check.polynomial has more than 16 bits"),
        ({"frame": {"check": {"polynomial": None}}}, "check.polynomial goes with"),
        ({"frame": {"counter": {"modulus": 100}}}, "modulus 100 is no power of two"),
        ({"frame": {"counter": {"step": 128}}}, "step 128 is a multiple"),
        ({"frame": {"gyro": {"at": [0, 6, 10]}}}, "gyro lies on the sync bytes"),
        ({"frame": {"gyro": {"signed": False}}}, "gyro counts of 33 bits"),
        ({"frame": {"gyro": {"at": [1, 2]}}}, "three bytes of the frame"),
    ],
)
def test_what_does_not_fit_is_named(changed: dict[str, Any], said: str) -> None:
    def merged(base: Any, over: Any) -> Any:
        if not isinstance(base, dict) or not isinstance(over, dict):
            return over
        both = {**base, **{key: merged(base.get(key), value) for key, value in over.items()}}
        return {key: value for key, value in both.items() if value is not None}

    data = {**FRAMES["custom"][0], "hardware": {"front": merged(CUSTOM, changed)}}
    from sculler_model.design import Design

    with pytest.raises(InputError, match=said):
        Design.parse(data)


def test_registers_are_asked_for_by_their_addresses() -> None:
    """Those of the data sheets: X_GYRO_OUT 12 ... Z_ACCL_OUT 26; X_DELTANG_LOW 40 ... 56."""
    high = [0x08, 0x12, 0x16, 0x1A, 0x1E, 0x22, 0x26]
    assert adis_requests(increments=False, long=False) == tuple(a << 8 for a in high)
    both = [0x08, *range(0x40, 0x58, 2)]
    assert adis_requests(increments=True, long=True) == tuple(a << 8 for a in both)
