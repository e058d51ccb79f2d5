"""Studies behind the sensor's filter: a delay leaves what no filter leaves; else closed forms."""

from __future__ import annotations

import cmath
from dataclasses import replace
from math import degrees, pi, radians, sin, sqrt
from typing import Any

import numpy as np
import pytest

import sculler
from sculler.runs.advice import Plan
from sculler.runs.analysis import (
    FrequencyPlan,
    PositionPlan,
    Subject,
    coning,
    frequency_study,
    position_study,
)
from sculler_model.analysis.advice import Environment, Requirement, advise
from sculler_model.analysis.flight import Profile, flown
from sculler_model.analysis.frequency import drift, record
from sculler_model.analysis.manoeuvre import BUMP, EARLY, LATE, MANOEUVRES, Manoeuvre, split
from sculler_model.analysis.orders import HeldConing, Manoeuvred, left_by_order
from sculler_model.analysis.oscillation import Cone
from sculler_model.analysis.position import Conditions, seen
from sculler_model.analysis.triple import ConingTurn, left
from sculler_model.analysis.vibration import Mount
from sculler_model.design import Design
from sculler_model.errors import InputError

SINC = {"kind": "sinc", "width_samples": 4}
MEAN = {"kind": "digital", "numerator": [0.25, 0.25, 0.25, 0.25]}
LATE_BY_20 = {"kind": "digital", "numerator": [0.0] * 20 + [1.0]}
"""Of a major interval of `PLAIN`, so that the same samples come an interval later."""
POLE = {"kind": "analogue", "numerator": [600.0], "denominator": [1.0, 600.0]}
SEEN = {"kind": "measured", "points": [[0, 1.0, 0.0], [100, 0.9, -9.0], [400, 0.5, -60.0]]}
HALF_STEP = {"kind": "digital", "numerator": [1.0], "denominator": [1.5, -0.5], "rate_hz": 4000.0}

TURNING = ConingTurn(radians(0.1), 50.0, radians(6.0), radians(5.0))
ROLL = Profile(
    "roll",
    np.linspace(0, 1.6, 9),
    np.array(
        [
            [0, 0, 0, 0, 0, 0],
            [2.0, 0.2, 0, 0, 4, -10],
            [0, -1.0, 0.7, 1, 30, 0],
            [-2.0, 0.9, 0, 0, 0, -20],
            [0.2, 0, 0, 0, 0, 0],
            *[[0.0] * 6] * 4,
        ]
    ),
)


def design(*stages: dict[str, Any], kind: str = "increment", **algorithm: Any) -> Design:
    """2 kHz, n = 4, M = 5, behind these stages."""
    data = Design.preset("stim300", samples=4, minors=5).as_json() | {"name": "filtered"}
    if kind == "rate":
        axes = {"bits": 32, "lsb": 1e-9}
        data["sensor"] |= {"kind": kind, "gyro": axes, "accel": axes}
        data["algorithm"]["family"] = "filtered-rate"
    data["sensor"] |= {"filter": list(stages)} if stages else {}
    data["algorithm"] |= algorithm
    return Design.parse(data)


PLAIN, LATER = design(), design(LATE_BY_20)


@pytest.mark.parametrize(
    ("stages", "expected"),
    [
        ((SINC,), 0.0),
        ((MEAN,), 1.5),
        ((LATE_BY_20,), 20.0),
        ((POLE,), 2000 / 600),
        ((HALF_STEP,), 0.25),  # Σ k a_k / Σ a_k = -1/2, in half samples
        ((MEAN, POLE), 1.5 + 2000 / 600),
        ((SEEN,), 9 / 360 * 2000 / 100),
    ],
    ids=["sinc", "mean", "late", "pole", "faster", "cascade", "measured"],
)
def test_the_delay_is_the_slope_of_the_phase(
    stages: tuple[dict[str, Any], ...], expected: float
) -> None:
    response = design(*stages).sensor_response
    assert response is not None
    assert response.delay == pytest.approx(expected, rel=1e-12)
    assert -cmath.phase(response.value(1e-5)) / 1e-5 == pytest.approx(expected, abs=1e-5)


def test_a_delay_leaves_of_a_manoeuvre_what_no_filter_leaves() -> None:
    plain, late = (split(each, MANOEUVRES["extreme"], 5, False) for each in (PLAIN, LATER))
    for name in ("source_1", "source_2", "complete", "third_order", "integer_path", "largest"):
        assert getattr(late, name) == pytest.approx(getattr(plain, name), rel=1e-3), name
    ends = [
        {each.order: each.attitude for each in left_by_order(of, motion, (5,), 2.0)}
        for of in (PLAIN, LATER)
        for motion in [Manoeuvred(MANOEUVRES["extreme"])]
    ]
    assert ends[1] == pytest.approx(ends[0], rel=1e-3)


def test_a_delay_leaves_of_cones_what_no_filter_leaves() -> None:
    spinning = replace(TURNING, spin=radians(100.0))
    for motion in (TURNING, spinning):
        (plain,), (late,) = (list(left(of, motion, (5,), 1.0)) for of in (PLAIN, LATER))
        assert late.second_order == pytest.approx(plain.second_order, rel=1e-3)
    # a whole period later, but for the spin
    held = HeldConing(ConingTurn(radians(1.0), 100.0, radians(30.0), radians(20.0), radians(5.0)))
    for plain_end, late_end in zip(
        left_by_order(PLAIN, held, (5,), 0.5), left_by_order(LATER, held, (5,), 0.5), strict=True
    ):
        assert late_end.attitude == pytest.approx(plain_end.attitude, rel=2e-3)
        assert late_end.velocity == pytest.approx(plain_end.velocity, rel=1e-2, abs=1e-7)


def test_a_delay_leaves_of_a_manoeuvre_file_what_no_filter_leaves() -> None:
    plain, late = flown(PLAIN, ROLL), flown(LATER, ROLL)
    assert late.angle == pytest.approx(plain.angle, rel=1e-3)
    assert late.velocity == pytest.approx(plain.velocity, rel=1e-3)
    assert late.position == pytest.approx(plain.position, abs=0.02 * plain.velocity)


@pytest.mark.parametrize("stage", [SINC, MEAN], ids=["sinc", "mean"])
def test_what_a_mean_leaves_of_a_manoeuvre(stage: dict[str, Any]) -> None:
    """½ e T² ∫ ω̇ × ω dt, with 1/|F|² = 1 + e λ²: w²/12, of w samples (w² - 1)/12."""
    peaks = (0.02, 0.015, 0.01)
    x, y, z = (size * shape for size, shape in zip(peaks, (BUMP, EARLY, LATE), strict=True))
    slow = Manoeuvre("slow", 1.0, (x, y, z))
    t = (np.arange(20_000) + 0.5) / 20_000
    slopes = np.stack([p.deriv()(t) for p in (x, y, z)], axis=1)
    swept = np.cross(slopes, slow.rate(t)).mean(axis=0)
    e = 16 / 12 if stage is SINC else 15 / 12
    expected = 1e6 * 0.5 * e / 2000**2 * float(np.linalg.norm(swept))
    found = split(design(stage), slow, 5, False)
    assert found.complete == pytest.approx(expected, rel=0.02)
    assert found.iteration == pytest.approx(expected, rel=0.02)
    knowing = split(design(stage, family="uncompressed", base="tuned"), slow, 5, False)
    assert knowing.complete < 0.01 * expected


def test_what_a_mean_leaves_of_a_cone() -> None:
    """The closed form of `drift`, in a turn too; a tuned table makes it good."""
    filtered, tuned = design(SINC), design(SINC, family="tuned")
    per_hour = degrees(1) * 3600
    expected = abs(float(drift(filtered, Cone(TURNING.half_angle), np.array([50.0]))[0])) * per_hour
    assert expected == pytest.approx(3.2045, rel=1e-4)  # of 98.7
    still = replace(TURNING, turn=0.0, bank=0.0)
    (alone,) = left(filtered, still, (1,), 1.0)
    assert alone.second_order * per_hour == pytest.approx(expected, rel=1e-6)
    assert alone.iteration * per_hour == pytest.approx(expected, rel=1e-6)
    (turned,) = left(filtered, TURNING, (1,), 2.0)
    assert turned.second_order * per_hour == pytest.approx(expected, rel=1e-3)
    (known,) = left(tuned, TURNING, (1,), 2.0)
    assert known.second_order * per_hour < 1e-3


def test_what_a_mean_leaves_of_a_force_on_a_coning_body() -> None:
    """½ a² (1 - |F|²) of it, along the cone's axis."""
    a, hertz = radians(1.0), 20.0
    (*_, fourth) = left_by_order(design(MEAN), HeldConing(ConingTurn(a, hertz)), (5,), 1.0)
    response = design(MEAN).sensor_response
    assert response is not None
    lost = 1 - abs(response.value(2 * pi * hertz / 2000)) ** 2
    assert fourth.velocity == pytest.approx(0.5 * sin(a) ** 2 * lost * 9.80665, rel=0.03)


def test_rates_behind_their_usual_mean_are_those_without_a_filter() -> None:
    usual, stated = design(kind="rate"), design({"kind": "sinc"}, kind="rate")
    extreme = MANOEUVRES["extreme"]
    early = round(-extreme.start(stated) * 2000)
    plain, behind = extreme.samples(usual, 300), extreme.samples(stated, 300 + early)[early:]
    assert behind == pytest.approx(plain, abs=1e-9)
    assert ROLL.samples(stated, 50, 1000) == pytest.approx(ROLL.samples(usual, 50, 1000), abs=1e-5)


def test_position_behind_a_filter() -> None:
    """The vibration as the samples show it; what they lack of it does not grow."""
    conditions = Conditions(vibration=35.3, hertz=50.0, rocking=1e-3, rate=1.0)
    shown, lost = seen(design(MEAN), conditions)
    phase = 2 * pi * 50 / 2000
    gain = sin(2 * phase) / (4 * sin(phase / 2))
    assert shown.vibration == pytest.approx(35.3 * gain)
    assert shown.rocking == pytest.approx(1e-3 * gain)
    assert replace(shown, vibration=35.3, rocking=1e-3) == conditions
    assert lost == pytest.approx(sqrt(2) * 35.3 / (2 * pi * 50) ** 2 * (1 - gain))
    assert seen(PLAIN, conditions) == (conditions, 0.0)
    assert seen(LATER, conditions)[1] == pytest.approx(0.0, abs=1e-15)
    plan = PositionPlan({"a": Subject(design(MEAN), True)}, seconds=1.0)
    found = position_study(plan)["designs"]["a"]
    assert found["velocity_rms_cm_per_s"] == pytest.approx(11.24 * gain, rel=1e-3)
    assert found["filter_takes"] == pytest.approx(100 * 3.6 / 35.3 * 9.80665 * lost)


def test_advice_on_a_manoeuvre_knows_the_filter() -> None:
    """Tables that know it meet what no other does."""
    asked = Requirement(angle=5e-5, velocity=1e-4)
    found = advise(
        design(SINC),
        Environment(manoeuvre=ROLL, peak_rate=2.0),
        asked,
        most_samples=4,
        most_history=0,
        slowest=1,
    )
    meet = {each.design.algorithm.family for each in found if each.meets}
    assert meet == {"tuned"}


ENDS = {"kind": "measured", "points": [[0, 1.0, 0.0], [30, 0.9, -9.0]]}


def test_a_measured_response_that_ends_too_early_is_refused() -> None:
    ends = design(ENDS)
    unknown = r"50 Hz is above the end of the sensor's measured response, 30 Hz"
    with pytest.raises(InputError, match=f"the cone: {unknown}"):
        TURNING.seen(ends)
    with pytest.raises(InputError, match=f"the vibration: {unknown}"):
        seen(ends, Conditions(vibration=1.0, hertz=50.0))
    with pytest.raises(InputError, match=r"filtered: 50\.1 Hz is above the end of"):
        record(ends, 50.0)
    with pytest.raises(InputError, match=f"hertz: {unknown}"):
        sculler.coning_drift(ends, 0.1, 50.0)
    with pytest.raises(InputError, match=f"hertz: {unknown}"):
        sculler.sculling_drift(ends, 0.1, 10.0, 50.0)
    with pytest.raises(InputError, match=f"--coning: {unknown}"):
        Plan(ends, Mount(), coning=(0.1, 50.0), drift=1.0)
    assert record(design(SEEN), 50.0)


def test_a_study_ends_where_the_measured_response_does() -> None:
    ends = design(ENDS)
    plan = FrequencyPlan(coning(0.1), {"a": Subject(ends, True)}, integer_points=2, points=50)
    found = frequency_study(plan)["designs"]["a"]
    assert found["nyquist_hz"] == 1000.0
    known = [drift for drift in found["drift"] if drift is not None]
    assert 20 < len(known) < 30  # of 50 up to 1 kHz, evenly on a log scale from 1 Hz
    assert np.isfinite(known).all()
    assert max(point["hertz"] for point in found["integer_path"]) < 30
    # of its own: the gain falls evenly with λ, and λ is what it is taken of
    assert found["law"]["measured_order"] == pytest.approx(2.0, abs=0.1)
