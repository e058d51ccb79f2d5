"""`python -m studies.budget`: errors are those of the paper, and the page says what was flown."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("scipy")
pytest.importorskip("pyarrow")

from sculler.runs.campaign import Campaign, Outcome
from sculler.runs.campaign.hardware import Held
from sculler.runs.campaign.statistics import Statistics
from sculler_model.design import Design
from studies.budget.command import document
from studies.budget.flown import ALGORITHM, ALL, DESIGN, campaign_text, label


def campaign(folder: Path) -> Campaign:
    (folder / "ins.toml").write_text(DESIGN)
    (folder / "campaign.toml").write_text(campaign_text(2, 5.0))
    return Campaign.load(folder / "campaign.toml")


def test_the_errors_are_those_of_the_paper(tmp_path: Path) -> None:
    """0.01 °/h, 5 ppm, 40 µg, 10 µrad for 1 nmi/h, a tenth of each (and 1 µrad) for 0.1 nmi/h."""
    found: dict[str, Design] = {}
    plan = campaign(tmp_path)
    for name, design in zip(plan.labels, plan.designs, strict=True):
        found[name] = design
    assert len(found) == 7
    for rate in (1.0, 0.1):
        errors = found[label(rate, ALL)].sensor.errors
        assert errors is not None
        values: list[Any] = [errors.gyro.bias, errors.gyro.scale_factor, errors.gyro.misalignment]
        sigmas = [value.sigma for value in [*values, errors.accel.bias]]
        expected = np.array([0.01, 5.0, 0.01, 0.04]) * rate  # °/h, ppm, mrad, mg
        assert sigmas == pytest.approx(expected.tolist(), rel=1e-12)
    alone = found[label(1.0, "accelerometer")].sensor.errors
    assert alone is not None
    assert alone.gyro.bias is None
    assert found[ALGORITHM].sensor.errors is None


def test_the_page_tells_what_was_found(tmp_path: Path) -> None:
    plan = campaign(tmp_path)
    statistics = {}
    for number, name in enumerate(plan.labels):
        size = 1e-4 if name == ALGORITHM else 0.1 * (number + 1)
        told = {0.5: (size, size / 2, 2 * size), 0.95: (size, size, size)}
        track = np.zeros((1, 2))
        statistics[name] = Statistics(2, np.ones(1), track, told, told, told, told, told)
    held = [Held(ALGORITHM, 1, "verilator", 2000, 1000, None)]
    text = document(Outcome(plan, tmp_path, statistics, 14, None, None, held))
    assert "| gyro bias | 0.01 °/h | 0.6 | 0.1 (0.05 to 0.2) | 0.1 | 0.1 |" in text
    assert "| 0.1 nmi/h | 0.6 (0.3 to 1.2) |" in text
    assert "0.1 % of the budget of 0.1 nmi/h" in " ".join(text.split())
    assert "1 run in verilator: 1,000 results of 2,000 samples" in " ".join(text.split())
