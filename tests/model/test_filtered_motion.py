"""A motion's samples behind filters that are not clocked with the samples."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np
import pytest

from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.motion import Curve, Motion, at_rest, delivered, filtered
from sculler_model.samples import Passing

RATE, T = 1000.0, 1e-3
HERTZ = 70.0
SHAKEN = Motion(0.8, 0.2, 500.0, up=Curve(waves=((0.01, 2 * pi * HERTZ, 0.3),)))

SINC = {"kind": "sinc", "width_samples": 4}
ODD = {"kind": "sinc", "width_samples": 2.5, "order": 2}
POLE = {"kind": "analogue", "numerator": [600.0], "denominator": [1.0, 600.0]}
PAIR = {"kind": "analogue", "numerator": [4e5], "denominator": [1.0, 800.0, 4e5]}
FAST = {"kind": "digital", "numerator": [0.25, 0.5, 0.25], "rate_hz": 4000.0}
SEEN = {"kind": "measured", "points": [[0, 1.0, 0.0], [100, 0.9, -10.0], [400, 0.5, -60.0]]}


def design(*stages: dict[str, Any], kind: str = "increment") -> Design:
    family = "frequency-taylor" if kind == "increment" else "filtered-rate"
    axes = {"bits": 32, "lsb": 1e-9}
    sensor = {"kind": kind, "sample_rate_hz": RATE, "gyro": axes, "accel": axes}
    algorithm = {"family": family, "samples": 2, "minors": 2}
    made = {"name": "f", "sensor": sensor | {"filter": list(stages)}, "algorithm": algorithm}
    return Design.parse(made)


def wave_of(samples: np.ndarray) -> complex:
    """Amplitude and phase at `HERTZ` of the force down, long after the start."""
    t = np.arange(len(samples) - 1000, len(samples)) * T
    of = np.stack((np.cos(2 * pi * HERTZ * t), np.sin(2 * pi * HERTZ * t), np.ones(len(t))), 1)
    (c, s, _), *_ = np.linalg.lstsq(of, samples[-1000:, 5], rcond=None)
    return complex(c, -s)


@pytest.mark.parametrize("kind", ["increment", "rate"])
@pytest.mark.parametrize(
    ("stages", "within"),
    [((SINC,), 1e-11), ((ODD, POLE), 1e-11), ((PAIR,), 1e-11), ((FAST,), 1e-11), ((SEEN,), 1e-7)],
    ids=["mean", "means and a pole", "two poles", "digital, faster", "measured"],
)
def test_a_wave_comes_out_as_the_response_says(
    stages: tuple[dict[str, Any], ...], within: float, kind: str
) -> None:
    asked = design(*stages, kind=kind)
    many = 6000 if stages == (SEEN,) else 2000  # its corners take seconds to die away
    blocks = list(delivered(SHAKEN, asked, many, 700))
    assert [len(block) for block in blocks[:2]] == [700, 700]
    plain = SHAKEN.increments(many, T) if kind == "increment" else SHAKEN.rates(many, T, 0, False)
    assert asked.sensor_response is not None
    expected = asked.sensor_response.value(2 * pi * HERTZ * T)
    assert wave_of(np.concatenate(blocks)) / wave_of(plain) == pytest.approx(expected, abs=within)


def test_a_mean_over_four_samples_is_that() -> None:
    """By the integral's own differences, and Simpson over the sample."""
    (found,) = delivered(SHAKEN, design(SINC), 500)
    # each instant of a sample sees the mean of 4 T about it
    fine = 64
    steps = SHAKEN.increments(fine * 506, T / fine)
    whole = np.concatenate((np.zeros((1, 6)), np.cumsum(steps, axis=0)))
    for sample in range(10, 500, 80):
        places = sample * fine + np.arange(fine + 1)
        means = (whole[places + 2 * fine] - whole[places - 2 * fine]) / 4
        weights = np.ones(fine + 1)
        weights[1:-1:2], weights[2:-1:2] = 4, 2  # Simpson
        expected = weights @ means / (3 * fine)
        assert found[sample, 5] == pytest.approx(expected[5], rel=1e-9)


@pytest.mark.parametrize("kind", ["increment", "rate"])
def test_what_stands_still_comes_out_from_the_start(kind: str) -> None:
    still = at_rest(0.8, 0.2, 500.0, 0.02, -0.03, 1.0)
    (found,) = delivered(still, design(POLE, SINC, kind=kind), 50)
    plain = still.increments(50, T) if kind == "increment" else still.rates(50, T)
    assert np.abs(found - plain).max() < 1e-12 * np.abs(plain).max()


def test_digital_filters_at_the_sample_rate_are_run_as_they_are() -> None:
    asked = design({"kind": "digital", "numerator": [1.0, 0.5], "denominator": [2.0, -0.9, 0.1]})
    found = np.concatenate(list(delivered(SHAKEN, asked, 300, 100)))
    assert np.array_equal(found, Passing(asked)(SHAKEN.increments(300, T)))


def test_without_a_filter_nothing_changes() -> None:
    (found,) = delivered(SHAKEN, Design.preset("stim300"), 100)
    assert np.array_equal(found, SHAKEN.increments(100, 1 / 2000))


def test_a_filter_that_remembers_too_long_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(filtered, "_MOST", 1 << 13)
    slow = design({"kind": "analogue", "numerator": [1.0], "denominator": [1.0, 1.0]})
    with pytest.raises(InputError, match=r"sensor\.filter: it remembers samples for more than"):
        next(delivered(SHAKEN, slow, 10))
