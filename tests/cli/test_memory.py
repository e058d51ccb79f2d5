"""A long log needs no more memory than a short one: motion, model, navigate with its truth."""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from sculler.formats import history, lines, truth_columns
from sculler.formats import vectors as vectors_file
from sculler_model import motion
from sculler_model.navigation import navigator
from sculler_model.samples import plausibility

Run = Callable[..., Any]

SHORT, LONG = 40, 160
"""Seconds at 100 Hz; results at 50 Hz."""

GROWTH = 300e3
"""Bytes by which the peak may differ; the long run's 6,000 more states, if they were kept, would be
600,000, and their vectors a million."""


@pytest.fixture
def _small_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Many blocks in little time, and no compiler, whose memory would hide theirs."""
    monkeypatch.setattr(motion.sampling, "CHUNK", 1 << 11)
    monkeypatch.setattr(lines, "BLOCK_BYTES", 1 << 13)
    for module in ("npz", "parquet"):
        monkeypatch.setattr(f"sculler.formats.tables.{module}.BLOCK_ROWS", 500)
    monkeypatch.setattr("sculler.formats.tables.parquet._GROUP_BYTES", 1 << 15)
    monkeypatch.setattr("sculler.formats.tables.npz._IN_MEMORY", 1 << 10)
    monkeypatch.setattr("sculler.formats.vectors_table._TOGETHER", 500)
    monkeypatch.setattr(plausibility, "BLOCK", 1 << 9)
    monkeypatch.setattr(truth_columns, "BLOCK", 500)
    monkeypatch.setattr(vectors_file.read_vectors, "__defaults__", (None, 500))
    monkeypatch.setattr(history.Thinned.__init__, "__defaults__", (500,))
    monkeypatch.setattr(navigator, "WORTH_COMPILING", 10**9)


@pytest.mark.deep
@pytest.mark.usefixtures("_small_blocks")
@pytest.mark.parametrize("ending", ["csv", "npz", "parquet"])
def test_memory_does_not_grow_with_the_log(run: Run, tmp_path: Path, ending: str) -> None:
    design = tmp_path / "design.toml"
    design.write_text('preset = "lasergyro"\nname = "long"\n[algorithm]\nsamples = 2\nminors = 1\n')
    peaks: dict[str, list[int]] = {}

    def measured(verb: str, *words: object) -> None:
        tracemalloc.start()
        try:
            outcome = run(verb, *words)
            peaks.setdefault(verb, []).append(tracemalloc.get_traced_memory()[1])
        finally:
            tracemalloc.stop()
        assert outcome.status == 0, outcome

    for seconds in (10, SHORT, LONG):  # the first imports what there is to import
        log, truth, vectors, nav = (
            tmp_path / f"{what}.{ending}" for what in ("log", "truth", "vectors", "nav")
        )
        where = ("--design", design, "--duration", seconds)
        measured("motion", "coning", *where, "-o", log, "--truth", truth)
        measured("model", design, log, "-o", vectors)
        measured("compare", vectors, vectors)
        measured("navigate", design, vectors, "-o", nav, "--truth", truth, "--no-plots")
    for verb, (_, short, long) in peaks.items():
        assert long < short + GROWTH, (verb, short, long)
