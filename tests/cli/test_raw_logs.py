"""Raw binary logs: every format by datagrams made independently; lost and damaged ones are told."""

from __future__ import annotations

import json
import struct
from collections.abc import Callable, Collection
from math import cos, pi, sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import raw_datagrams as raw
from sculler.formats.log import read_log
from sculler.readers.raw.checksums import ZIP, Crc
from sculler_model.design import Design

Run = Callable[..., Any]
Refused = Callable[..., str]
Convert = Callable[..., tuple[Any, list[list[int]], list[float] | None, list[int] | None]]

DESIGN = """
name = "unit"
[sensor]
kind = "increment"
sample_rate_hz = {rate}
gyro = {{ bits = 32, lsb = {gyro} }}
accel = {{ bits = 32, lsb = {accel} }}
[algorithm]
family = "frequency-taylor"
samples = 2
minors = 1
"""
DEGREE = pi / 180
COUNTS = 40


@pytest.fixture
def convert(run: Run, tmp_path: Path) -> Convert:
    """Convert bytes; what was said (JSON), and the log's counts, times and faults."""

    def convert(
        content: bytes, gyro: float, accel: float, rate: float, *options: object
    ) -> tuple[Any, list[list[int]], list[float] | None, list[int] | None]:
        design, log, out = (tmp_path / name for name in ("unit.toml", "in.bin", "out.csv"))
        design.write_text(DESIGN.format(rate=rate, gyro=repr(gyro), accel=repr(accel)))
        log.write_bytes(content)
        outcome = run("convert", log, "-o", out, "--design", design, "--json", *options)
        assert outcome.status == 0, outcome.err
        chunks = list(read_log(out, Design.load(design)))
        counts = np.concatenate([chunk.counts for chunk in chunks]).tolist()
        given = [chunk.times for chunk in chunks if chunk.times is not None]
        flags = [chunk.faults for chunk in chunks if chunk.faults is not None]
        return (
            json.loads(outcome.out),
            counts,
            np.concatenate(given).tolist() if given else None,
            np.concatenate(flags).tolist() if flags else None,
        )

    return convert


def sample(k: int) -> tuple[list[int], list[int]]:
    """Gyro and accelerometer of sample k, with both signs and large numbers."""
    return [k + 1, -2 * k, -(2**23) + k], [2**23 - 1 - k, 3 * k, -20_560]


def expected(numbers: range | list[int]) -> list[list[int]]:
    return [[*sample(k)[0], *sample(k)[1]] for k in numbers]


def test_checksums_against_the_catalogue() -> None:
    """The check values of the catalogue of CRC algorithms, for the bytes 123456789."""
    frames = np.frombuffer(b"123456789", np.uint8)[None, :]
    assert ZIP(frames)[0] == 0xCBF43926
    assert Crc(32, 0x04C11DB7, 0xFFFFFFFF, reflected=False)(frames)[0] == 0x0376E6E7  # MPEG-2
    assert Crc(16, 0x1021, 0, reflected=False)(frames)[0] == 0x31C3  # XMODEM
    # zeros after it are the same as zeros in it
    padded = np.frombuffer(b"123456789\0\0", np.uint8)[None, :]
    mpeg = Crc(32, 0x04C11DB7, 0xFFFFFFFF, reflected=False)
    assert mpeg(frames, zeros=2)[0] == mpeg(padded)[0]


# STIM300

STIM = (DEGREE * 2.0**-21, 2.0**-22)


@pytest.mark.parametrize("identifier", [0x91, 0x93, 0xA5, 0xA7, 0x9B])
def test_stim300(convert: Convert, identifier: int) -> None:
    content = b"".join(raw.stim300(*sample(k), 250 + k, identifier) for k in range(COUNTS))
    said, counts, times, faults = convert(content, *STIM, 2000.0)
    assert said["format"] == "stim300"  # found out, whatever the name
    assert counts == expected(range(COUNTS))
    assert said["sensors"]["gyro"]["unchanged"]
    # the first increment ends one interval after the log begins
    assert times == pytest.approx([(k + 1) / 2000 for k in range(COUNTS)], abs=1e-12)
    assert faults == [0] * COUNTS
    assert said["datagrams"]["samples"] == COUNTS
    assert said["datagrams"]["bytes_passed_over"] == 0


def test_stim300_of_a_recorder(convert: Convert) -> None:
    content = b"".join(raw.stim300_of_a_recorder(*sample(k), k) for k in range(COUNTS))
    said, counts, _, _ = convert(content, *STIM, 2000.0)
    assert counts == expected(range(COUNTS))
    assert "zip" in said["notes"]["datagrams 0x93"]


def test_stim300_counts_internal_samples(convert: Convert) -> None:
    """At 500 Hz the counter goes on by 4; another design's rate is refused by the counter."""
    content = b"".join(raw.stim300(*sample(k), 4 * k) for k in range(COUNTS))
    _, _, times, _ = convert(content, *STIM, 500.0)
    assert times == pytest.approx([(k + 1) / 500 for k in range(COUNTS)], abs=1e-12)


def test_stim300_rate_of_another_design(tmp_path: Path, refused: Refused, convert: Convert) -> None:
    content = b"".join(raw.stim300(*sample(k), 4 * k) for k in range(COUNTS))
    convert(content, *STIM, 500.0)
    design = tmp_path / "other.toml"
    design.write_text(DESIGN.format(rate=1000.0, gyro=repr(STIM[0]), accel=repr(STIM[1])))
    (tmp_path / "out.csv").unlink()
    line = refused("convert", tmp_path / "in.bin", "-o", tmp_path / "out.csv", "--design", design)
    assert "500 Hz but sensor.sample_rate_hz = 1000" in line


def stim_stream(lost: Collection[int] = (), flipped: Collection[int] = ()) -> bytes:
    """200 datagrams, some not there, some with one bit wrong."""
    parts = []
    for k in range(200):
        if k in lost:
            continue
        frame = bytearray(raw.stim300([k, 2 * k, 3 * k], [0, 0, -20_000], k))
        if k in flipped:
            frame[5] ^= 0x10
        parts.append(bytes(frame))
    return b"".join(parts)


@pytest.mark.parametrize(
    ("content", "missing", "passed_over", "places"),
    [
        (stim_stream(lost={50}), [50], 0, 0),
        (stim_stream(lost=set(range(60, 73))), list(range(60, 73)), 0, 0),
        (stim_stream(flipped={50}), [50], 28, 1),
        (stim_stream(flipped={50, 51, 90}), [50, 51, 90], 84, 2),
        (stim_stream(lost={20}, flipped={90}), [20, 90], 28, 1),
        # garbage between, in which identifiers stand
        (stim_stream()[: 28 * 30] + b"\x91\x93junk\xa7" * 7 + stim_stream()[28 * 30 :], [], 49, 1),
        # cut within a datagram: its two halves are lost
        (stim_stream()[: 28 * 30 + 11] + stim_stream()[28 * 31 :], [30], 11, 1),
        # begins and ends within one: nothing of the middle is lost
        (stim_stream()[9:-5], [0, 199], 0, 0),
    ],
)
def test_stim300_lost_and_damaged(
    convert: Convert, content: bytes, missing: list[int], passed_over: int, places: int
) -> None:
    said, counts, times, faults = convert(content, *STIM, 2000.0, "--gaps", "bridge")
    inner = [k for k in missing if k not in (0, 199)]
    first = 1 if 0 in missing else 0
    last = 198 if 199 in missing else 199
    # every sample stands in its place in time, the lost ones bridged on a straight line
    assert [row[:3] for row in counts] == [[k, 2 * k, 3 * k] for k in range(first, last + 1)]
    assert faults == [int(k in inner) for k in range(first, last + 1)]
    assert times == pytest.approx([(k + 1) / 2000 for k in range(last + 1 - first)], abs=1e-12)
    assert said["timing"]["missing_samples"] == len(inner)
    assert said["datagrams"]["samples"] == 200 - len(missing)
    assert said["datagrams"]["bytes_passed_over"] == passed_over
    assert said["datagrams"]["places"] == places
    assert any("no whole datagram" in each for each in said["warnings"]) == bool(passed_over)


def test_stim300_gap_is_refused_with_its_place(tmp_path: Path, refused: Refused) -> None:
    log = tmp_path / "in.bin"
    log.write_bytes(stim_stream(lost={50, 51}))
    line = refused("convert", log, "-o", tmp_path / "out.csv", "--design", "stim300")
    assert "sample 50: a gap" in line
    assert "2 samples missing" in line


def test_stim300_long_damage_counts_whole_rounds(convert: Convert) -> None:
    """300 datagrams are damaged: the counter of 8 bits alone would show 44."""
    parts = [bytearray(raw.stim300([7, 8, 9], [0, 0, -20_000], k)) for k in range(1000)]
    for frame in parts[400:700]:
        frame[7] ^= 1
    content = b"".join(map(bytes, parts))
    said, counts, _, _ = convert(content, *STIM, 2000.0, "--gaps", "bridge")
    assert said["timing"]["missing_samples"] == 300
    assert len(counts) == 1000


def test_stim300_status_is_a_fault(convert: Convert) -> None:
    content = b"".join(raw.stim300(*sample(k), k, status=(k == 5) * 8) for k in range(COUNTS))
    said, _, _, faults = convert(content, *STIM, 2000.0)
    assert faults == [int(k == 5) for k in range(COUNTS)]
    assert said["datagrams"]["faults"] == 1


def test_stim300_across_blocks(convert: Convert, monkeypatch: pytest.MonkeyPatch) -> None:
    """Blocks that cut datagrams anywhere change nothing."""
    content = stim_stream(lost={50}, flipped={90})
    whole = convert(content, *STIM, 2000.0, "--gaps", "bridge")
    for size in (130, 131, 997):
        monkeypatch.setattr("sculler.readers.raw.datagrams._BLOCK_BYTES", size)
        assert convert(content, *STIM, 2000.0, "--gaps", "bridge") == whole


def test_stim300_output_unit_is_asked_for(
    convert: Convert, refused: Refused, tmp_path: Path
) -> None:
    """No datagram says its unit: it is the design's, or given."""
    content = b"".join(raw.stim300([1 << 14, 0, 0], [0, 0, -(1 << 19)], k) for k in range(COUNTS))
    options = ("--gyro-unit", "deg/s", "--accel-unit", "g", "--rates", "mean")
    _, counts, _, _ = convert(content, DEGREE * 1e-6, 9.80665e-6, 2000.0, *options)
    assert counts == [[500, 0, 0, 0, 0, -500]] * COUNTS  # 1 °/s and 1 g over 1/2000 s
    design, log = tmp_path / "unit.toml", tmp_path / "in.bin"
    (tmp_path / "out.csv").unlink()
    words = ("convert", log, "-o", tmp_path / "out.csv", "--design", design)
    assert "give --gyro-unit, one of deg, deg/s" in refused(*words)
    assert "is not known, give --gyro-scale too" in refused(*words, "--gyro-unit", "rad")
    assert "--gyro-scale goes with --gyro-unit" in refused(*words, "--gyro-scale", "2")
    # the 30 g range has twice the scale
    options = ("--gyro-unit", "deg", "--accel-unit", "m/s", "--accel-scale", 2.0**-21)
    _, counts, _, _ = convert(content, DEGREE * 2.0**-21, 2.0**-21, 2000.0, *options)
    assert counts[0] == [1 << 14, 0, 0, 0, 0, -(1 << 19)]


# NovAtel

LN200 = (2.0**-19, 2.0**-14)


@pytest.mark.parametrize("message", [1461, 1462])
def test_novatel_extended(convert: Convert, message: int) -> None:
    """The type of IMU gives the scale; other messages stand between; the week turns over."""
    parts = []
    for k in range(COUNTS):
        time = 604_799.9 + 0.005 * k
        week, seconds = 2000 + int(time >= 604_800), time % 604_800
        parts.append(raw.novatel(message, week, seconds, *sample(k)))
        if k % 7 == 3:
            parts.append(raw.novatel_message(42, bytes(72), short=False))
    said, counts, times, _ = convert(b"".join(parts), *LN200, 200.0)
    assert said["format"] == "novatel"
    assert counts == expected(range(COUNTS))
    assert times == pytest.approx([604_799.9 + 0.005 * k for k in range(COUNTS)], abs=1e-9)
    assert said["notes"]["IMU type"] == "8 (LN-200)"
    assert said["datagrams"]["others"] == 6


@pytest.mark.parametrize("message", [268, 325])
def test_novatel_plain_needs_a_scale(convert: Convert, tmp_path: Path, message: int) -> None:
    parts = [raw.novatel(message, 2000, 100 + 0.005 * k, *sample(k)) for k in range(COUNTS)]
    counts_of = ("--gyro-unit", "counts", "--accel-unit", "counts")
    _, counts, _, _ = convert(b"".join(parts), *LN200, 200.0, *counts_of)
    assert counts == expected(range(COUNTS))
    scales = ("--gyro-unit", "rad", "--gyro-scale", 2.0**-19, "--accel-unit", "m/s")
    _, counts, _, _ = convert(b"".join(parts), *LN200, 200.0, *scales, "--accel-scale", 2.0**-14)
    assert counts == expected(range(COUNTS))


def test_novatel_lost_message_is_a_gap(convert: Convert) -> None:
    parts = [raw.novatel(1462, 2000, 100 + 0.005 * k, *sample(k)) for k in range(COUNTS)]
    del parts[11:13]
    damaged = bytearray(parts[20])
    damaged[30] ^= 1
    parts[20] = bytes(damaged)
    said, counts, _, faults = convert(b"".join(parts), *LN200, 200.0, "--gaps", "bridge")
    assert said["timing"]["missing_samples"] == 3
    assert len(counts) == COUNTS
    assert [k for k, fault in enumerate(faults or []) if fault] == [11, 12, 22]


PUBLISHED = (
    b"%RAWIMUSXA,1692,484620.664;00,11,1692,484620.664389000,00801503,43110635,-817242,-202184,"
    b"-215194,-41188,-9895*a5db8c7b\r\n"
)
"""A line of the receiver maker's own decoder's tests: CRC, order and signs are theirs."""


def test_novatel_ascii(convert: Convert) -> None:
    def line(k: int) -> bytes:
        text = (
            f"RAWIMUSXA,1692,484620.664;00,11,1692,{484620.664389 + 0.01 * k:.9f},00801503,"
            f"43110635,-817242,-202184,{-215194 + k},-41188,-9895"
        ).encode()
        return b"%" + text + f"*{raw.crc_lsb_first(text, 0):08x}\r\n".encode()

    assert line(0) == PUBLISHED
    scale = (2.0**-33, 2.0**-27 * 0.3048)
    content = b"junk" + b"".join(map(line, range(COUNTS)))
    said, counts, times, _ = convert(content, *scale, 100.0)
    assert said["format"] == "novatel"
    assert counts == [[-9895, 41188, -215194 + k, -202184, 817242, 43110635] for k in range(COUNTS)]
    assert times is not None
    assert times[1] == pytest.approx(484620.674389, abs=1e-9)
    damaged = content.replace(b"41188,-9895*", b"41189,-9895*", 1)
    said, counts, _, _ = convert(damaged, *scale, 100.0)
    assert len(counts) == COUNTS - 1


def test_novatel_encrypted_or_of_two_units(tmp_path: Path, refused: Refused) -> None:
    log = tmp_path / "in.gps"
    words = ("convert", log, "-o", tmp_path / "out.csv", "--design", "ln200")
    parts = [raw.novatel(1462, 2000, 1 + 0.005 * k, *sample(k), info=2) for k in range(4)]
    log.write_bytes(b"".join(parts))
    assert "encrypted" in refused(*words)
    parts = [raw.novatel(1462, 2000, 1 + 0.005 * k, *sample(k), 8 + 24 * k) for k in range(2)]
    log.write_bytes(b"".join(parts))
    assert "IMU types 8 and 32" in refused(*words)


# VectorNav


def floats(*values: float) -> bytes:
    return struct.pack(f"<{len(values)}f", *values)


RATE = [1.0, 2.0, -3.0]  # rad/s
FORCE = [0.0, 0.25, -10.0]  # m/s²
EXACT = [2.0**-10, -(2.0**-9), 2.0**-8]  # what floats of 4 bytes hold


@pytest.mark.parametrize("common", [True, False])
def test_vectornav_increments(convert: Convert, common: bool) -> None:
    """DeltaTheta in degrees and DeltaVel, of one group or another, among other fields."""
    parts = []
    for k in range(COUNTS):
        startup = struct.pack("<Q", 5_000_000_000 + 5_000_000 * k)
        turn, velocity = floats(*EXACT), floats(0.5, 0.25 + k, -0.125)
        ypr = floats(1, 2, 3)
        if common:
            groups = {0: {0: startup, 3: ypr, 11: floats(0.005) + turn + velocity}, 4: {1: ypr}}
        else:
            groups = {1: {0: startup}, 2: {6: floats(0.005) + turn, 7: velocity, 9: ypr}}
        parts.append(raw.vectornav(groups))
    content = b"$VNYMR,1*00\r\n" + b"".join(parts)
    said, counts, times, _ = convert(content, DEGREE * 2.0**-12, 2.0**-10, 200.0)
    assert said["format"] == "vectornav"
    assert counts == [[4, -8, 16, 512, 256 + 1024 * k, -128] for k in range(COUNTS)]
    assert times == pytest.approx([5 + 0.005 * k for k in range(COUNTS)], abs=1e-12)
    assert "coning" in said["notes"]["increments"]


@pytest.mark.parametrize("fields", ["imu", "uncompensated", "compensated"])
def test_vectornav_rates(convert: Convert, fields: str) -> None:
    rate, force = floats(*RATE), floats(*FORCE)
    chosen: dict[int, dict[int, bytes]] = {
        "imu": {0: {9: force + rate}},
        "uncompensated": {2: {2: force, 3: rate}},
        "compensated": {2: {9: force, 10: rate}},
    }[fields]
    parts = []
    for k in range(COUNTS):
        groups = {**chosen, 1: {0: struct.pack("<Q", 5_000_000 * k)}}
        parts.append(raw.vectornav(groups))
    _, counts, _, _ = convert(b"".join(parts), 1e-6, 2.5e-4, 200.0)
    assert counts == [[5000, 10000, -15000, 0, 5, -200]] * (COUNTS - 1)


def test_vectornav_without_time(convert: Convert) -> None:
    """Nothing counts the messages: damage is told, and the sample after it is a fault."""
    message = raw.vectornav({2: {6: floats(0.005, *EXACT), 7: floats(0, 0, -0.05)}})
    damaged = message[:9] + bytes([message[9] ^ 4]) + message[10:]
    said, counts, times, faults = convert(
        message * 9 + damaged + message * 10, DEGREE * 2.0**-12, 1e-4, 200.0
    )
    assert times is None
    assert len(counts) == 19
    assert faults == [int(k == 9) for k in range(19)]
    assert any("neither counter nor time" in each for each in said["warnings"])


def test_vectornav_without_gyro(tmp_path: Path, refused: Refused) -> None:
    log = tmp_path / "in.bin"
    log.write_bytes(raw.vectornav({0: {0: bytes(8), 3: bytes(12)}}) * 9)
    line = refused("convert", log, "-o", tmp_path / "out.csv", "--design", "ln200")
    assert "configure an output with DeltaTheta and DeltaVel" in line


# Xsens

MANUAL = bytes.fromhex(
    "FA FF 36 31 10 20 02 DF C5 10 60 04 00 45 9D A0 40 20 0C BE DC 9A FA 3F 54 9F 37 41 1C BB 70"
    "80 20 0C BB AA 5C 80 3B 8C 55 01 BB 81 33 00 E0 20 04 00 00 00 81 45"
)
"""The example of the maker's protocol document; it has no checksum error, so its sum is 0."""


def test_xsens_example_of_the_manual(convert: Convert) -> None:
    assert sum(MANUAL[1:]) % 256 == 0
    second = bytearray(MANUAL)
    second[14:16] = struct.pack(">H", 0x9DA0 + 100)  # SampleTimeFine, 10 ms later
    second[-1] = (second[-1] - sum(second[1:])) % 256
    said, counts, times, _ = convert(MANUAL + bytes(second), 1e-9, 1e-7, 100.0, "--rates", "mean")
    assert said["format"] == "xsens"
    # 0x459DA0 ticks of 0.1 ms; BEDC9AFA is -0.430869, BBAA5C80 is -0.00519902
    assert times == pytest.approx([456.2336, 456.2436], abs=1e-9)
    rate, force = struct.unpack(">3f", MANUAL[34:46]), struct.unpack(">3f", MANUAL[19:31])
    assert counts[0] == pytest.approx(
        [value * 0.01 / 1e-9 for value in rate] + [value * 0.01 / 1e-7 for value in force], abs=1
    )
    assert counts[0][3] == -43087


def fixed_12_20(value: float) -> bytes:
    return struct.pack(">i", round(value * 2**20))


def fixed_16_32(value: float) -> bytes:
    whole = round(value * 2**32).to_bytes(8, "big", signed=True)
    return whole[4:] + whole[2:4]


FORMS: dict[int, Callable[[float], bytes]] = {
    0: lambda value: struct.pack(">f", value),
    1: fixed_12_20,
    2: fixed_16_32,
    3: lambda value: struct.pack(">d", value),
}


@pytest.mark.parametrize("form", FORMS)
def test_xsens_forms_of_numbers(convert: Convert, form: int) -> None:
    rates = b"".join(FORMS[form](value) for value in (0.5, -1.25, 3.0))
    forces = b"".join(FORMS[form](value) for value in (-0.5, 0.25, 9.75))
    parts = [
        raw.xsens(
            [
                (
                    0x1060,
                    struct.pack(">I", 864_000_000 - 500 + 100 * k if k < 5 else 100 * (k - 5)),
                ),
                (0x2010, bytes(16)),
                (0x8020 | form, rates),
                (0x4020 | form, forces),
                (0xE020, struct.pack(">I", 0x800 if k == 7 else 1)),
            ]
        )
        for k in range(COUNTS)
    ]
    parts.insert(
        9, raw.xsens([(0x7010, bytes(200)), (0x7020, bytes(100))])
    )  # GNSS, with a long length
    said, counts, times, faults = convert(b"".join(parts), 1e-5, 1e-4, 100.0, "--rates", "mean")
    assert counts == [[500, -1250, 3000, -50, 25, 975]] * COUNTS
    # the clock begins anew after a day
    assert times == pytest.approx([86_399.95 + 0.01 * k for k in range(COUNTS)], abs=1e-9)
    assert faults == [int(k == 7) for k in range(COUNTS)]
    assert said["datagrams"]["others"] == 1


def test_xsens_quaternions(convert: Convert) -> None:
    """DeltaQ of a turn of θ about an axis is cos θ/2, and the axis times sin θ/2."""
    angle, axis = 0.02, (0.6, 0.0, -0.8)
    half = [cos(angle / 2), *(part * sin(angle / 2) for part in axis)]
    parts = []
    for k in range(COUNTS):
        sign = -1 if k == 3 else 1  # the same turn
        turn = [1, 0, 0, 0] if k == 4 else [sign * part for part in half]
        parts.append(
            raw.xsens(
                [
                    (0x1060, struct.pack(">I", 2**32 - 1000 + 100 * k & 2**32 - 1)),
                    (0x8033, struct.pack(">4d", *turn)),
                    (0x4013, struct.pack(">3d", 0.01, 0, -0.098)),
                ]
            )
        )
    _, counts, times, _ = convert(b"".join(parts), 1e-6, 1e-4, 100.0)
    assert sum(row[0] for row in counts) == 12_000 * (COUNTS - 1)
    assert [row[2] for row in counts[:6]] == [-16_000] * 4 + [0, -16_000]
    assert times is not None
    assert np.diff(times) == pytest.approx(0.01, abs=1e-6)


# ADIS and HG4930


def test_adis16495(convert: Convert) -> None:
    large = [[2**31 - 1 - k, -(2**31) + k, k] for k in range(COUNTS)]
    parts = [raw.adis16495(large[k], sample(k)[1], 65_530 + k) for k in range(COUNTS)]
    del parts[9]
    options = ("--gyro-unit", "counts", "--accel-unit", "counts", "--gaps", "ignore")
    said, counts, _, _ = convert(b"".join(parts), 1e-12, 1e-9, 2000.0, *options)
    assert said["format"] == "adis16495"
    kept = [k for k in range(COUNTS) if k != 9]
    assert counts == [[*large[k], *sample(k)[1]] for k in kept]
    assert said["timing"]["missing_samples"] == 1


@pytest.mark.parametrize("long", [False, True])
def test_adis16470(convert: Convert, long: bool) -> None:
    name = "adis16470-32" if long else "adis16470"
    low = -(2**31) if long else -(2**15)
    parts = [raw.adis16470([low + k, 7, -7], [k, 1, -800], k, long) for k in range(COUNTS)]
    junk = bytes(range(1, 14))
    content = junk + b"".join(parts[:20]) + junk + b"".join(parts[21:])
    options = ("--format", name, "--gyro-unit", "counts", "--accel-unit", "counts")
    said, counts, _, faults = convert(content, 1e-12, 1e-9, 2000.0, *options, "--gaps", "bridge")
    assert counts == [[low + k, 7, -7, k, 1, -800] for k in range(COUNTS)]
    assert faults == [int(k == 20) for k in range(COUNTS)]
    assert said["datagrams"]["bytes_passed_over"] == 13


@pytest.mark.parametrize("step", [1, 2, 3])
def test_hg4930(convert: Convert, step: int) -> None:
    """Until the test at power-up is done there are no data; the counter's step is found out."""
    parts = [raw.hg4930([0x55555555] * 3, [0x55555555] * 3, step * k, 0x200) for k in range(3)]
    parts += [raw.hg4930(*sample(k), step * k) for k in range(COUNTS)]
    control = struct.pack("<BB6hHH", 0x0E, 0x01, *[5] * 6, 4, 0)
    control += struct.pack("<H", sum(struct.unpack("<9H", control)) & 0xFFFF)
    parts[6:6] = [control] * 5
    del parts[20]  # samples 0, 1, 2 come before the controls
    scale = (2.0**-33, 2.0**-27 * 0.3048)
    said, counts, _, faults = convert(b"".join(parts), *scale, 100.0, "--gaps", "bridge")
    assert said["format"] == "hg4930"
    assert said["timing"]["missing_samples"] == 1
    bridged = (faults or []).index(1)
    assert bridged == 12
    assert counts[:12] == expected(range(12))
    assert counts[13:] == expected(range(13, COUNTS))
    assert said["datagrams"]["others"] == 8


def test_no_datagram_at_all(tmp_path: Path, refused: Refused) -> None:
    log = tmp_path / "in.bin"
    words = ("convert", log, "-o", tmp_path / "out.csv", "--design", "stim300")
    log.write_bytes(bytes(range(256)) * 40)
    assert "no text, byte 0 is 0" in refused(*words)
    for name in ("stim300", "adis16470"):
        line = refused(*words, "--format", name, *["--gyro-unit", "counts"] * (name != "stim300"),
                       *["--accel-unit", "counts"] * (name != "stim300"))  # fmt: skip
        assert "no whole datagram" in line
    log.write_bytes(b"".join(raw.stim300([1, 2, 3], [], k, 0x90) for k in range(9)))
    assert "only 9 datagrams without" in refused(*words)
