"""Frames of telemetry: their layout, what `--truth` makes of them, and the same from C."""

from __future__ import annotations

import json
import shutil
import struct
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sculler.formats.telemetry import frames_of
from sculler.formats.truth import read_truth
from sculler.host_c import HostInC
from sculler_model.design import Design
from sculler_model.navigation import NavHistory, NavState

Run = Callable[..., Any]
Refused = Callable[..., str]

STATES = [
    NavState(1.5, (0.5, -0.5, 0.5, 0.5), (1.0, -2.0, 3.0), 0.8, -2.9, 499.5, 0.25),
    NavState(1.75, (1.0, 0.0, -0.0, 0.0), (1e-300, 2.0, 3.0), -0.8, 3.0, -12.0, -3.1),
]
HISTORY = NavHistory.from_states(STATES)
STATUS = np.array([0, 10])


def test_a_frame_is_what_the_page_says() -> None:
    """Packed by hand, field by field."""
    data = frames_of(HISTORY, STATUS, 2**40)
    assert len(data) == 2 * 116
    for row, (state, status) in enumerate(zip(STATES, STATUS.tolist(), strict=True)):
        w, x, y, z = state.q
        body = bytes([0x53, 0x4E, 1, 1]) + struct.pack("<HHQ", 104, status, 2**40 + row)
        numbers = (state.time, x, y, z, w, *state.v, state.lat, state.lon, state.h, state.wander)
        body += struct.pack("<12d", *numbers)
        assert data[116 * row : 116 * row + 112] == body
        assert struct.unpack("<I", data[116 * row + 112 : 116 * row + 116])[0] == zlib.crc32(body)


@pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc")
def test_the_host_in_c_writes_and_reads_the_same() -> None:
    import ctypes

    host = HostInC(Design.preset("hg4930"))
    data = frames_of(HISTORY, STATUS, 2**40)
    assert host.telemetry(HISTORY, STATUS, 2**40) == data
    assert host.functions.sculler_crc32(b"123456789", 9) & 0xFFFFFFFF == 0xCBF43926
    read = host.functions.sculler_telemetry_read
    state, number, status = (ctypes.c_double * 12)(), ctypes.c_uint64(), ctypes.c_uint16()
    into = (state, ctypes.byref(number), ctypes.byref(status))
    assert read(data[116:], *into) == 0
    told = STATES[1]
    assert list(state) == [told.time, *told.q, *told.v, told.lat, told.lon, told.h, told.wander]
    assert (number.value, status.value) == (2**40 + 1, 10)
    for bit in range(0, 8 * 116, 7):  # any damage shows
        hurt = bytearray(data[:116])
        hurt[bit // 8] ^= 1 << bit % 8
        assert read(bytes(hurt), *into) == 9, bit
    assert number.value == 2**40 + 1


def test_frames_serve_as_truth(tmp_path: Path) -> None:
    path = tmp_path / "flight.frames"
    path.write_bytes(frames_of(HISTORY, STATUS, 0))
    (found,) = read_truth(path)
    assert found.q.tolist() == HISTORY.q.tolist()
    assert found.v.tolist() == HISTORY.v.tolist()
    np.testing.assert_allclose(found.lat, HISTORY.lat, rtol=1e-15)
    assert found.h.tolist() == HISTORY.h.tolist()


def test_damage_is_refused_with_its_place(refused: Refused, run: Run, tmp_path: Path) -> None:
    log, vectors = tmp_path / "log.csv", tmp_path / "vectors.csv"
    made = ("motion", "rest", "--design", "hg4930", "-o", log, "--truth", tmp_path / "truth.csv")
    assert run(*made, "--duration", 2).status == 0
    assert run("model", "hg4930", log, "-o", vectors).status == 0
    frames = tmp_path / "flight.frames"
    words = ("navigate", "hg4930", vectors, "-o", tmp_path / "n.csv", "--no-plots")
    place = ("--lat", 48, "--lon", 11, "--height", 500)
    outcome = run(*words, *place, "--telemetry", frames, "--json")
    assert json.loads(outcome.out)["telemetry"] == str(frames)
    assert json.loads(run(*words, "--truth", frames, "--json").out)["errors"]["instants"] > 40
    whole = frames.read_bytes()
    frames.write_bytes(whole[:-3])
    assert "the last frame is cut short, 113 bytes of 116" in refused(*words, "--truth", frames)
    hurt = bytearray(whole)
    hurt[116 * 5 + 50] ^= 4
    frames.write_bytes(hurt)
    assert "frame 6, from byte 580 on, is damaged" in refused(*words, "--truth", frames)
