"""`sculler analyze vibration`: figures, check through the integer path, picture, refusals."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Run = Callable[..., Any]


@pytest.mark.deep
def test_savages_vibration_with_a_check_and_a_picture(run: Run, tmp_path: Path) -> None:
    picture = tmp_path / "vibration.png"
    outcome = run(
        *("analyze", "vibration", "--family", "frequency-taylor", "--samples", 2, "--json"),
        *("--check", 16, "-o", picture),
    )
    assert (outcome.status, outcome.err) == (0, "")
    data = json.loads(outcome.out)
    assert data["input_g_rms"] == pytest.approx(59.2**0.5, rel=1e-9)
    assert data["worst_phase"]["sculling_y_ug"] == pytest.approx(1300, rel=0.05)
    (found,) = data["designs"].values()
    check = found["check"]
    for name, expected in found["model"].items():
        assert abs(check["error"][name] - expected) < 5 * check["sigma"][name]
        assert abs(expected) <= found["worst_phase"][name]
    assert picture.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


def test_readable_and_from_a_file(run: Run, tmp_path: Path) -> None:
    psd = tmp_path / "psd.csv"
    psd.write_text("freq_hz,psd_g2_per_hz\n10,0.01\n500,0.01\n")
    out = run("analyze", "vibration", "stim300", "--spectrum", psd).out
    assert "2.21 g rms" in out  # √4.9
    assert "stim300_4x5" in out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((), "nothing to analyze"),
        (("stim300", "--spectrum", "earthquake"), "no such spectrum"),
        (("stim300", "-o", "x.pdf"), "pictures are PNG"),
        (("stim300", "--rotary-hz", 0), "> 0"),
    ],
)
def test_faults(refused: Callable[..., str], words: tuple[object, ...], message: str) -> None:
    assert message in refused("analyze", "vibration", *words)


def test_a_malformed_file_is_refused(refused: Callable[..., str], tmp_path: Path) -> None:
    psd = tmp_path / "psd.csv"
    psd.write_text("freq_hz,psd_g2_per_hz\n10,0.01\n5,0.01\n")
    assert "5 Hz follows 10 Hz" in refused("analyze", "vibration", "stim300", "--spectrum", psd)
