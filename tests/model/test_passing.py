"""A motion's samples behind the sensor's filter: amplitude and phase by the filter's response."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from sculler_model.design import Design
from sculler_model.samples import Passing

MEAN = {"kind": "digital", "numerator": [0.25, 0.25, 0.25, 0.25]}
POLE = {"kind": "digital", "numerator": [1.0, 0.5], "denominator": [2.0, -0.9, 0.1]}


def filtered(*stages: dict[str, object], kind: str = "increment") -> Design:
    family = "frequency-taylor" if kind == "increment" else "filtered-rate"
    return Design.parse(
        {
            "name": "filtered",
            "sensor": {
                "kind": kind,
                "sample_rate_hz": 1000.0,
                "gyro": {"bits": 24, "lsb": 1e-8},
                "accel": {"bits": 24, "lsb": 1e-6},
                "filter": list(stages),
            },
            "algorithm": {"family": family, "samples": 2, "minors": 2},
        }
    )


@pytest.mark.parametrize("stages", [(MEAN,), (POLE,), (MEAN, POLE)])
def test_a_wave_comes_out_as_the_response_says(stages: tuple[dict[str, object], ...]) -> None:
    """In blocks of odd lengths; after the start-up, against F(λ)."""
    design = filtered(*stages)
    phase = 2 * pi * 0.07
    t = np.arange(400)
    wave = np.exp(1j * phase * t)
    samples = np.zeros((400, 6))
    samples[:, 0], samples[:, 4] = wave.real, wave.imag
    passing = Passing(design)
    found = np.concatenate([passing(block) for block in np.split(samples, [1, 2, 7, 100])])
    assert not passing.left_out
    assert design.sensor_response is not None
    expected = design.sensor_response.value(phase) * wave
    assert found[100:, 0] == pytest.approx(expected.real[100:], abs=1e-12)
    assert found[100:, 4] == pytest.approx(expected.imag[100:], abs=1e-12)


def test_what_stands_still_passes() -> None:
    still = np.tile([1.0, -2.0, 3.0, 0.0, 5.0, -9.8], (10, 1))
    assert Passing(filtered(MEAN, POLE))(still) == pytest.approx(still, abs=1e-14)


def test_what_it_cannot_run_is_said() -> None:
    samples = np.random.default_rng(1).normal(size=(5, 6))
    for design in (
        filtered({"kind": "sinc", "width_samples": 4}),
        filtered(MEAN, {"kind": "sinc", "width_samples": 4}),
        filtered(MEAN, kind="rate"),
    ):
        passing = Passing(design)
        assert passing.left_out
        assert (passing(samples) == samples).all()
    assert not Passing(Design.preset("stim300")).left_out
