"""The demo's pictures."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sculler.plots import pictures as plots
from sculler_model.algorithms import frequency_taylor
from sculler_model.analysis.closed_form import drift_rate, uncorrected_rate
from sculler_model.design import Design
from sculler_model.navigation import NavHistory

Array = NDArray[np.float64]


def draw(
    folder: Path,
    design: Design,
    truth: NavHistory,
    estimates: dict[str, NavHistory],
    errors: dict[str, tuple[Array, Array, Array]],
) -> list[Path]:
    """Errors over time, tracks, and what the algorithm leaves of coning at other frequencies."""
    paths = [folder / name for name in ("errors.png", "track.png", "coning.png")]
    plots.error_picture(paths[0], truth.time, errors)
    plots.track_picture(paths[1], truth, estimates)

    n, T = design.algorithm.samples, design.sample_interval
    frequency = np.geomspace(1, 0.5 / T, 600)
    half_angle = np.radians(0.1)
    hour = np.degrees(1) * 3600
    omega = 2 * np.pi * frequency
    curves = {"uncorrected": hour * uncorrected_rate(half_angle, half_angle, omega)}
    for samples in (n, 3, 2):
        table = frequency_taylor(samples, 0)
        curves[f"n = {samples} samples a minor interval"] = hour * drift_rate(
            table, half_angle, half_angle, omega, T
        )
    plots.coning_picture(paths[2], frequency, curves, 50.0, "0.1°", 1 / T)
    return paths
