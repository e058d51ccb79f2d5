"""Faster and nearer to the truth than the open package on the same increments in the same run."""

from __future__ import annotations

import sys

import pytest

from sculler_model.errors import InputError
from studies.bench.navigators import compare

OURS, THEIRS = "wander azimuth, compiled", "python-ins Integrator"


@pytest.mark.deep
def test_a_thousand_seconds_of_a_smooth_motion() -> None:
    pytest.importorskip("numba", reason="Numba (extra `fast`) is missing")
    pytest.importorskip("pyins", reason="python-ins is missing")
    found = compare(seconds=1000, rate_hz=100, runs=3)
    ours, theirs = (found["navigators"][name] for name in (OURS, THEIRS))
    assert ours["horizontal_m"] < 1e-4
    assert theirs["horizontal_m"] < 1  # it was given what it needs
    assert found["error_ratio"] > 100
    assert ours["velocity_m_per_s"] < theirs["velocity_m_per_s"] / 100
    assert found["speed_ratio"] > 1.5  # about 6 on an idle machine
    assert len(found["navigators"]) == 5


def test_without_the_other_package_it_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(InputError, match="pandas is missing, install python-ins"):
        compare(seconds=1, runs=1)
