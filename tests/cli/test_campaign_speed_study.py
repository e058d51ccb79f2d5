"""`python -m studies.campaigns`: what is timed is flown, and the page says what was measured."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

pytest.importorskip("scipy")
pytest.importorskip("pyarrow")
pytest.importorskip("matplotlib")

from sculler_model.errors import InputError
from studies.campaigns import command, measure
from studies.campaigns.measure import Timed, timed

ONE, TWO = (Timed(1, 100, 600.0, 120.0, 118.0, "a"), Timed(2, 100, 600.0, 64.0, 120.0, "a"))
WHOLE = Timed(2, 1000, 600.0, 630.0, 1200.0, "b")


def one_line(text: str) -> str:
    return " ".join(text.split())


def test_the_page_tells_what_was_measured() -> None:
    text = command.document([ONE, TWO], WHOLE)
    assert "1,000 flights of 10 minutes at 2000 Hz took 10.5 minutes with 2" in one_line(text)
    # 1.2e9 samples of 1 µs on two processors
    assert "A thousand flights of ten minutes are 10 minutes of two" in one_line(text)
    assert "| 1 | 100 | 2 | 50 | 1.00 | 0.983 | 0.98 |" in text
    assert "| 2 | 100 | 1.07 | 93.8 | 1.88 | 1 | 0.94 |" in text
    assert "| 2 | 1,000 | 10.5 | 95.2 | 1.90 | 1 | 0.95 |" in text
    assert command.CROWDED not in one_line(text)
    crowded = Timed(2, 1000, 600.0, 3000.0, 1200.0, "b")
    assert command.CROWDED in one_line(command.document([ONE], crowded))
    assert "are identical, bit for bit" in one_line(text)
    other = command.document([ONE, Timed(2, 100, 600.0, 64.0, 120.0, "c")], WHOLE)
    assert "are **not** identical" in one_line(other)


@pytest.mark.deep
def test_a_short_one(tmp_path: Path) -> None:
    one, two = (timed(tmp_path, 6, 2.0, workers) for workers in (1, 2))
    assert one.digest == two.digest
    for found in (one, two):
        assert 0 < found.processor < 60
        assert 0 < found.busy <= 1.2
        assert found.samples == 6 * 2.0 * 2000


def test_a_campaign_that_fails_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    failed = subprocess.CompletedProcess([], 2, "", "runs: 0 is not allowed\n")
    monkeypatch.setattr(measure.subprocess, "run", lambda *_, **__: failed)
    with pytest.raises(InputError, match=r"the campaign failed: runs: 0 is not allowed$"):
        timed(tmp_path, 6, 2.0, 1)
