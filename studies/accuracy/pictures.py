"""The pictures of accuracy.md, one a section."""

from __future__ import annotations

from math import pi, radians
from pathlib import Path

import numpy as np

from sculler.plots import vibration as plots
from sculler_model.algorithms import filtered_rate, frequency_taylor
from sculler_model.analysis.advice import PER_HOUR
from sculler_model.analysis.closed_form import uncorrected_rate
from sculler_model.analysis.vibration import PROFILES, Mount, respond
from studies.accuracy import savage_98, yang, zeng
from studies.accuracy.coning import coning_left, coning_whole, drift_curve, fine_design


def draw(folder: Path) -> list[Path]:
    """All pictures."""
    pictures = {
        "savage": savage_picture,
        "zeng-1": filter_picture,
        "zeng": zeng_picture,
        "yang": yang_picture,
        "recursion": recursion_picture,
    }
    paths = []
    for name, picture in pictures.items():
        paths.append(folder / f"accuracy-{name}.png")
        picture(paths[-1])
    return paths


def savage_picture(path: Path) -> None:
    """Vibration behind the mount, and what is left of what it rectifies to."""
    spectrum = PROFILES["savage-98"]
    both = Mount(y=savage_98.PAIR, z=savage_98.PAIR)
    designs = {
        "Eq. 61, 2 kHz": fine_design("frequency-taylor", 1, 1, 1, 2000.0),
        "4 samples, 1 kHz": fine_design("frequency-taylor", 4, 0, 1, 1000.0),
        "5 samples, 1 kHz": fine_design("frequency-taylor", 5, 0, 1, 1000.0),
    }
    plots.vibration_picture(path, spectrum, respond(spectrum, both), designs)


def filter_picture(path: Path) -> None:
    """Zeng's figure 1: coning, and what the filter of Eq. 2 lets through of it (Eq. 17)."""
    ratio = np.linspace(0, 0.5, 201)
    lines = {"coning, ½ a² Ω": ratio, "behind the filter": ratio * np.sinc(ratio) ** 2}
    plots.effect_picture(path, "Zeng's figure 1: what a filter of sinc(ΩT/2) does", ratio, lines)


def zeng_picture(path: Path) -> None:
    """Drift of Runge-Kutta, two and four filtered samples over the coning frequency."""
    hertz = np.geomspace(1, 500, 500)
    marks = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0]
    half_angle, T = zeng.HALF_ANGLE, zeng.T
    curves = {
        "Runge-Kutta, 2 samples": (
            zeng.runge_kutta_law(hertz),
            marks,
            [zeng.runge_kutta_drift(f, True, turns=max(int(f), 8)) for f in marks],
        )
    }
    for n in (2, 4):
        table = filtered_rate(n, 0)
        curves[f"filtered-rate, {n} samples"] = (
            drift_curve(table, half_angle, hertz, T, "rate"),
            marks,
            [coning_whole(table, 1, half_angle, f, T, "rate") for f in marks],
        )
    plots.drift_picture(
        path,
        "Filtered rates at 1 kHz, 1° coning: lines closed form, marks attitude",
        hertz,
        curves,
        zeng.HZ,
        "Zeng's case",
    )


def yang_picture(path: Path) -> None:
    """Drift over n + p: closed form and attitude, at three half angles."""
    totals = list(range(2, 8))
    tables = [frequency_taylor(2, total - 2) for total in totals]
    series = {}
    for degree in (1.0, 0.1, 0.01):
        a = radians(degree)
        series[f"{degree:g}°"] = (
            [coning_left(table, a, yang.HZ, yang.T) for table in tables],
            [coning_whole(table, 5, a, yang.HZ, yang.T) for table in tables],
        )
    plots.order_picture(
        path,
        f"Coning at {yang.HZ:g} Hz, 2 kHz samples, 5 ms major intervals",
        totals,
        series,
    )


def recursion_picture(path: Path) -> None:
    """Drift of the recursion and of four samples over the coning frequency."""
    a, T = radians(0.1), 1 / 2000
    hertz = np.geomspace(1, 1000, 500)
    marks = [3.0, 7.0, 15.0, 30.0, 55.0, 110.0, 230.0, 430.0]
    plots.drift_picture(
        path,
        "0.1° coning, 2 kHz samples, 10 ms major intervals: lines closed form, marks attitude",
        hertz,
        {
            "uncorrected": (np.abs(PER_HOUR * uncorrected_rate(a, a, 2 * pi * hertz)), [], []),
            **{
                name: (
                    drift_curve(frequency_taylor(n, p), a, hertz, T),
                    marks,
                    [coning_whole(frequency_taylor(n, p), 20 // n, a, f, T) for f in marks],
                )
                for name, n, p in (("recursion, n = 1, p = 1", 1, 1), ("ours, n = 4, p = 0", 4, 0))
            },
        },
        50.0,
        "the table's case",
    )
