"""`demo`: the main job end to end, held against closed forms."""

from __future__ import annotations

import json
from collections.abc import Callable
from math import pi, radians
from pathlib import Path
from typing import Any

import pytest

Run = Callable[..., Any]

SECONDS = 6


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("demo") / "out"


def test_demo(run: Run, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("CXX", raising=False)  # compiled as a user's would be
    outcome = run("demo", "-o", folder, "--seconds", SECONDS, "--json")
    assert (outcome.status, outcome.err) == (0, "")
    said = json.loads(outcome.out)
    assert said == json.loads((folder / "summary.json").read_text())
    assert said["identical"] is True
    assert said["navigation_identical"] is True
    assert (said["samples"], said["majors"]) == (12_000, 600)
    good, bad = said["errors_at_end"]["corrected"], said["errors_at_end"]["uncorrected"]
    for quantity in good:
        assert good[quantity] < bad[quantity] / 100

    # uncorrected, 0.1° of coning at 50 Hz turns the attitude by ½ a² Ω
    drift = 0.5 * radians(0.1) ** 2 * 2 * pi * 50 * SECONDS
    assert radians(bad["attitude_arcsec"] / 3600) == pytest.approx(drift, rel=0.01)
    # and 0.1° of rocking with 10 m/s² rectifies to half their product, in one direction of a body
    # that turns by 6 °/s: the chord of that arc (the drifting heading adds a little)
    chord = 2 / radians(6) * abs(0.5 * radians(0.1) * 10) * radians(6 * SECONDS / 2)
    assert bad["velocity_m_s"] == pytest.approx(chord, rel=0.5)

    assert (folder / "rtl.csv").read_bytes() == (folder / "model.csv").read_bytes()
    assert len((folder / "rtl.csv").read_text().splitlines()) == 601
    assert len((folder / "nav_truth.csv").read_text().splitlines()) == 602
    for name in ("errors", "track", "coning"):
        assert (folder / f"{name}.png").read_bytes().startswith(b"\x89PNG")
    readme = (folder / "README.md").read_text()
    for file in folder.iterdir():
        if file.name != "README.md":
            assert file.name in readme
    assert not list(folder.rglob(".*"))


def test_its_files_serve_the_other_verbs(run: Run, folder: Path, tmp_path: Path) -> None:
    if not (folder / "imu.csv").exists():
        pytest.skip("test_demo has not run")
    out = tmp_path / "again.csv"
    assert run("model", "stim300", folder / "imu.csv", "-o", out).status == 0
    assert run("compare", folder / "rtl.csv", out).status == 0


def test_to_read(run: Run, tmp_path: Path) -> None:
    outcome = run("demo", "-o", tmp_path / "demo", "--seconds", 1, "--no-plots")
    assert (outcome.status, outcome.err) == (0, "")
    for text in ("identical: 100 results", "attitude", "uncorrected", str(tmp_path / "demo")):
        assert text in outcome.out
    assert not list((tmp_path / "demo").glob("*.png"))
