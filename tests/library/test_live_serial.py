"""The example that reads a serial stream: what it prints, and its frames."""

from __future__ import annotations

import importlib.util
import os
import re
import subprocess
import sys
from math import radians
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import sculler
from sculler_model.frames import radii

EXAMPLE = Path(__file__).parents[2] / "examples" / "live_serial.py"
LINE = re.compile(
    r"\s*([0-9.]+) s  lat ([0-9.]+)°  lon ([0-9.]+)°  height ([0-9.]+) m  heading ([0-9.]+)°"
)


@pytest.fixture(scope="module")
def example() -> ModuleType:
    spec = importlib.util.spec_from_file_location("live_serial", EXAMPLE)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_it_follows_the_truth_over_a_damaged_frame(example: ModuleType) -> None:
    done = subprocess.run(
        [sys.executable, str(EXAMPLE)],
        capture_output=True,
        encoding="utf-8",
        check=True,
        stdin=subprocess.DEVNULL,
        timeout=120,
        env={
            **os.environ,
            "PYTHONPATH": os.pathsep.join(path for path in sys.path if path),
            "PYTHONIOENCODING": "utf-8",
        },
    )
    lines = done.stdout.splitlines()
    states = [LINE.fullmatch(line) for line in lines[:-1]]
    rows = np.array([found.groups() for found in states if found], float)
    assert rows[:, 0].tolist() == pytest.approx([0, 1, 2, 3, 4, 5], abs=0.011)
    truth = sculler.motion("turn", **example.PLACE, speed=example.SPEED).state(rows[:, 0])
    north = (np.radians(rows[:, 1]) - truth.lat) * radii(np.sin(radians(48)))[0]
    east = (np.radians(rows[:, 2]) - truth.lon) * radii(np.sin(radians(48)))[1] * 0.669
    # times are printed to 10 ms at worst, 30 m/s; what is lost is 6 ms of a turn of 6 °/s
    assert np.abs(north).max() < 0.3
    assert np.abs(east).max() < 0.3
    assert np.abs(rows[:, 3] - 500).max() < 0.05
    heading = np.degrees(truth.euler[:, 2]) % 360
    assert np.abs(rows[:, 4] - heading).max() < 0.1
    assert lines[-1].startswith("warning: a break of 0.0")
    assert "coast" not in lines[-1]
    assert lines[-1].count("break") == 1


def test_frames_are_found_between_noise_and_in_any_bursts(example: ModuleType) -> None:
    sent = [[k, -k, 2**23 - 1, -(2**23), 0, 0xA55A] for k in range(20)]
    stream = b"\xa5\xa5\x5a" + b"".join(
        example.frame(65_530 + k, k & 1, counts) + b"\xa5" * (k % 3)
        for k, counts in enumerate(sent)
    )
    for size in (1, 7, 31, 1000):
        bursts = (stream[k : k + size] for k in range(0, len(stream), size))
        found = [example.BODY.unpack(body) for good in example.bodies(bursts) for body in good]
        assert [list(row[2:]) for row in found] == sent
        assert [row[0] for row in found] == [(65_530 + k) % 65536 for k in range(20)]


def test_a_frame_of_which_one_bit_is_wrong_is_passed_over(example: ModuleType) -> None:
    good = example.frame(7, 0, [1, 2, 3, 4, 5, 6])
    for bit in range(8 * len(good)):
        wrong = bytearray(good)
        wrong[bit // 8] ^= 1 << bit % 8
        found = [row for rows in example.bodies(iter([bytes(wrong) + good])) for row in rows]
        assert found == [good[2:-2]], bit
