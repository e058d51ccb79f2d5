"""What the pictures of a run show: titles and legends apart, no jumps, uncertainty where known."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sculler.plots.pictures import error_picture, navigation_pictures, track_picture
from sculler.plots.truth import truth_pictures
from sculler_model.frames import from_euler
from sculler_model.motion import turn_motion
from sculler_model.navigation import NavHistory, navigation_errors
from tiers import few_of

matplotlib = pytest.importorskip("matplotlib")


@pytest.fixture
def figures(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """The figures that are saved, laid out."""
    from matplotlib.figure import Figure

    seen: list[Any] = []
    plain = Figure.savefig

    def keep(figure: Any, *words: Any, **named: Any) -> None:
        plain(figure, *words, **named)
        seen.append(figure)

    monkeypatch.setattr(Figure, "savefig", keep)
    return seen


def history(heading: float = 3.1, rate: float = 0.02) -> NavHistory:
    """300 s about a heading near 180°, to and fro."""
    time = np.linspace(0, 300, 601)
    q = np.array([from_euler(0.1, 0.2, heading + rate * 5 * np.sin(t)) for t in time.tolist()])
    one = np.ones_like(time)
    v = np.stack([100 * np.sin(time / 50), 0 * one, 1e-3 * time], axis=1)
    return NavHistory(time, q, v, 0.8 + 1e-7 * time, 0.1 * one, 500 * one)


def check_titles(figure: Any) -> None:
    figure.draw_without_rendering()
    for axes in figure.axes:
        legend = axes.get_legend()
        if legend is None or not axes.get_title(loc="left"):
            continue
        title = next(t for t in (axes._left_title, axes.title) if t.get_text())
        assert not title.get_window_extent().overlaps(legend.get_window_extent())


def test_angles_are_apart_and_do_not_jump(figures: list[Any], tmp_path: Path) -> None:
    navigation_pictures(history(), tmp_path / "nav.csv", (0.1, 0.2, 0.7))
    (figure,) = figures
    check_titles(figure)
    panels = {axes.get_title(loc="left"): axes for axes in figure.axes}
    assert list(panels)[3:] == ["Roll", "Pitch", "Heading"]
    assert len(figure.axes) == len(panels) == 6  # no axis hides behind another
    (line,) = panels["Heading"].get_lines()
    heading = line.get_ydata()
    assert np.abs(np.diff(heading)).max() < 6
    assert heading.max() > 180
    for name, sigma in (("Roll", 0.1), ("Pitch", 0.2), ("Heading", 0.7)):
        (band,) = panels[name].collections
        low, high = band.get_paths()[0].get_extents().intervaly
        middle = panels[name].get_lines()[0].get_ydata()
        assert low == pytest.approx(middle.min() - sigma)
        assert high == pytest.approx(middle.max() + sigma)
        assert "1 σ of the alignment" in panels[name].get_legend().get_texts()[0].get_text()


def test_without_an_alignment_no_uncertainty_is_known(figures: list[Any], tmp_path: Path) -> None:
    navigation_pictures(history(), tmp_path / "nav.csv")
    assert all(not axes.collections for axes in figures[0].axes)


@pytest.mark.parametrize(
    "sigma",
    few_of([None, (1e-3, 2e-3, 1e-2), (1e-9, 1e-9, 1e-9), (1.0, 1.0, 1.0)], [(1.0, 1.0, 1.0)]),
)
def test_pictures_against_a_truth(
    figures: list[Any], tmp_path: Path, sigma: tuple[float, float, float] | None
) -> None:
    truth = turn_motion().state(np.linspace(0, 300, 301))
    off = NavHistory(
        truth.time, truth.q, truth.v + 0.4, truth.lat + 1e-8 * truth.time, truth.lon, truth.h + 3
    )
    errors = navigation_errors(off, truth)
    truth_pictures(off, truth, errors, 123.456, tmp_path / "nav.csv", sigma)
    assert len(figures) == 3
    for figure in figures:
        check_titles(figure)
    bands = [band for axes in figures[0].axes for band in axes.collections]
    assert len(bands) == (0 if sigma is None else 2)


def test_long_names_stand_clear_of_titles(figures: list[Any], tmp_path: Path) -> None:
    time = np.linspace(0, 10, 11)
    series = (time + 1, time + 1, time + 1)
    names = ("a navigator of a long name that goes on", "and another one, uncorrected, as long")
    error_picture(tmp_path / "e.png", time, dict.fromkeys(names, series))
    track_picture(tmp_path / "t.png", history(), dict.fromkeys(names, history()))
    for figure in figures:
        check_titles(figure)
