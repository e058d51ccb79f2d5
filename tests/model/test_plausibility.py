"""Detectors of implausible counts: what each must find, and what none may."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sculler_model.design import Design
from sculler_model.motion import MOTIONS, PLACE
from sculler_model.samples import Finding, Plausibility, Quantiser, in_words, plausibility

DESIGN = Design.preset("stim300")
RATE = DESIGN.sensor.sample_rate_hz
N = 24_000  # 12 s
RNG = np.random.default_rng(12)
NOISE = np.rint(RNG.normal([40, -3, 9, 0, 0, -20_000], 30, (N, 6))).astype(np.int64)


@pytest.fixture(autouse=True, params=[False, True], ids=["in numpy", "compiled"])
def _both_ways(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """The close look at all samples, and the compiled one before it."""
    if request.param:
        pytest.importorskip("numba")
        monkeypatch.setattr(plausibility, "WORTH_COMPILING", 0)
    else:
        monkeypatch.setattr(plausibility, "compiled", lambda: None)


def look(counts: Any, chunk: int = 5000, times: Any = None) -> list[Finding]:
    detectors = Plausibility(DESIGN)
    for at in range(0, len(counts), chunk):
        part = slice(at, at + chunk)
        detectors(counts[part], None if times is None else times[part])
    return detectors.finish()


def changed(**columns: Any) -> Any:
    counts = NOISE.copy()
    for name, (rows, value) in columns.items():
        counts[rows, plausibility.INPUT_COLUMNS.index(name)] = value
    return counts


def test_noise_is_plausible() -> None:
    assert look(NOISE) == []
    assert look(NOISE[:50]) == []
    assert Plausibility(DESIGN).finish() == []


@pytest.mark.parametrize("chunk", [1, 999, 5000, 100_000])
def test_each_is_found_wherever_chunks_end(chunk: int) -> None:
    if chunk == 1:
        counts = changed(gyro_y=(slice(300, 2400), -7))[:2600]
        times = np.arange(2600) / RATE
        (found,) = look(counts, chunk, times)
        assert found == Finding("stuck", 300, 2100, "gyro_y", -7.0, 0.15)
        return
    counts = changed(
        gyro_y=(slice(6_000, 9_000), -7),
        accel_x=(slice(21_000, N), 55),
        gyro_z=(slice(100, 900), 2**23 - 1),
        accel_z=(slice(11_000, 11_001), 2_000_000),
    )
    counts[15_000:19_000] = 0
    assert look(counts, chunk, 7.0 + np.arange(N) / RATE) == [
        Finding("rail", 100, 800, "gyro_z", 2.0**23 - 1, 7.05),
        Finding("stuck", 6_000, 3_000, "gyro_y", -7.0, 10.0),
        Finding("spike", 11_000, 1, "accel_z", 2e6, 12.5),
        Finding("zero", 15_000, 4_000, None, None, 14.5),
        Finding("stuck", 21_000, 3_000, "accel_x", 55.0, 17.5),
    ]


def test_all_six_still() -> None:
    counts = NOISE.copy()
    counts[4_000:17_000] = counts[4_000]
    assert [(f.kind, f.first, f.samples) for f in look(counts)] == [("frozen", 4_000, 13_000)]
    counts = NOISE.copy()
    counts[:1_900] = 0  # less than a second
    assert look(counts) == []


def test_every_count_at_its_rail() -> None:
    counts = NOISE.copy()
    counts[9_000:] = [2**23 - 1, -(2**23), 2**23 - 1, -(2**23), 2**23 - 1, 2**23 - 1]
    found = look(counts)
    assert [f.kind for f in found].count("rail") == 6
    assert {f.samples for f in found if f.kind == "rail"} == {N - 9_000}
    lines = in_words(found, {})
    rail = "gyro_x stands at its rail in 15,000 samples, first at sample 9000 (8388607)"
    assert any(line.startswith(rail) for line in lines)


def test_ideal_logs_say_nothing() -> None:
    """Smooth motions, whose axes may well stand still, and a coarse gyro at rest."""
    for name in ("coning", "turn", "rest", "demo"):
        motion = MOTIONS[name].make(*([] if name == "demo" else PLACE))
        quantise = Quantiser(DESIGN)
        chunks = motion.chunks("increment", 20_000, 1 / RATE)
        assert look(np.concatenate([quantise(chunk) for chunk in chunks])) == []
    t = np.arange(N) / RATE
    smooth = np.zeros((N, 6), np.int64)
    smooth[:, 0] = np.rint(50_000 * np.sin(40 * np.pi * t))
    smooth[:, 1] = 33_000
    smooth[:, 5] = -20_000
    assert look(smooth) == []
    coarse = NOISE.copy()
    coarse[:, :3] = RNG.random((N, 3)) < 1e-4  # a count now and then
    assert look(coarse) == []


def test_a_knock_is_no_spike() -> None:
    counts = NOISE.copy()
    counts[5_000:5_040, 3] += np.rint(2e6 * np.hanning(40)).astype(np.int64)
    assert look(counts) == []


def test_a_spike_that_interpolation_spread_is_found() -> None:
    counts = np.full((400, 6), 30)
    counts[200:204, 0] += [-40_000, 541_000, 541_000, -40_000]
    assert [(f.kind, f.column) for f in look(counts)] == [("spike", "gyro_x")]


def test_long_lists_are_cut() -> None:
    findings = [Finding("spike", at, 1, "gyro_x", 1e6, None) for at in range(15)]
    lines = in_words(findings, {"spike": 15})
    assert len(lines) == 11
    assert lines[-1] == "5 more findings like these (spike)"
