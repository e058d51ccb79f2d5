"""Savage-20's requirements: his figures, and the error equations integrated in time."""

from __future__ import annotations

from math import degrees, pi, radians

import pytest

from sculler_model.analysis.requirement import (
    SCHULER,
    Grade,
    budget,
    drift_of,
    schuler_angle,
)
from sculler_model.errors import InputError


def test_figures_of_the_paper() -> None:
    """0.017 °/h, 0.004°; a hundredth of each, and a tenth of that for 0.1 nmi/h."""
    one, tenth = budget(1.0), budget(0.1)
    assert one.drift == pytest.approx(0.017, abs=5e-4)
    assert one.angle == pytest.approx(0.004, abs=5e-4)
    assert one.algorithm_drift == pytest.approx(0.00017, abs=5e-6)
    assert one.algorithm_angle == pytest.approx(0.00004, abs=5e-6)
    assert tenth.algorithm_drift == pytest.approx(0.000017, abs=5e-7)
    assert tenth.algorithm_angle == pytest.approx(0.000004, abs=5e-7)
    assert 2 * pi / SCHULER / 60 == pytest.approx(84, abs=0.5)


def test_sensors_make_schulers_angle_together() -> None:
    """0.01 °/h, 5 ppm, 40 µg, 10 µrad: on the order of 0.004°; gravity 0.0011°."""
    found = budget(1.0)
    assert found.taken[1] == pytest.approx(0.004, abs=5e-4)
    assert {p.source: p for p in found.parts}["gravity"].angle == pytest.approx(0.0011, abs=5e-5)
    assert found.algorithm_force == pytest.approx(2.0)  # 5 % of 40 µg
    assert found.too_much == ()


def test_gravity_alone_is_too_much_for_a_tenth_of_a_mile() -> None:
    assert budget(0.1).too_much == ("gravity",)
    assert Grade.of(0.1).misalignment == 1.0
    assert Grade.of(0.01).misalignment == 1.0  # the floor


def test_the_error_equations_in_time() -> None:
    """γ' = ε - δv/R, δv' = g γ over two days in steps of 2 s: growth and swing."""
    R, g, drift = 6_371_000.0, 9.80665, 0.01
    epsilon, step = radians(drift) / 3600, 2.0
    gamma = velocity = position = 0.0
    largest = 0.0
    steps = round(48 * 3600 / step)
    for _ in range(steps):  # leap-frog, which keeps the swing's size
        velocity += step * g * gamma
        position += step * velocity
        gamma += step * (epsilon - velocity / R)
        largest = max(largest, abs(gamma))
    assert degrees(largest) == pytest.approx(schuler_angle(drift), rel=2e-3)
    miles_an_hour = position / 1852 / (steps * step / 3600)
    assert drift_of(miles_an_hour) == pytest.approx(drift, rel=0.01)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: budget(0.0), "nmi/h: 0 is not allowed"),
        (lambda: budget(1.0, share=2.0), "share: 2 is not allowed"),
        (lambda: Grade(-1, 0, 0, 0, 0), "gyro bias: -1 is not allowed"),
    ],
)
def test_refusals(call: object, message: str) -> None:
    assert callable(call)
    with pytest.raises(InputError, match=message.replace("/", "/")):
        call()
