"""[sensor.errors]: each error is what its data sheet's unit says, and nothing else."""

from __future__ import annotations

from math import exp, log, pi, radians, sqrt
from typing import Any

import numpy as np
import pytest

from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.motion import Curve, Motion, Turn, Z, as_felt, at_rest
from sculler_model.samples import Imperfect

Array = np.ndarray
G = 9.80665
HOUR = radians(1) / 3600


def design(rate: float = 100.0, kind: str = "increment", **errors: Any) -> Design:
    axes = {"bits": 32, "lsb": 1e-9}
    sensor = {"kind": kind, "sample_rate_hz": rate, "gyro": axes, "accel": axes, "errors": errors}
    family = "frequency-taylor" if kind == "increment" else "filtered-rate"
    algorithm = {"family": family, "samples": 4, "minors": 5}
    return Design.parse({"name": "d", "sensor": sensor, "algorithm": algorithm})


def allan(rate: Array, interval: float, many: int) -> float:
    """Overlapping Allan variance of (N, 3) at `many` intervals, the mean of the axes."""
    angle = np.vstack((np.zeros(3), np.cumsum(rate, axis=0))) * interval
    second = angle[2 * many :] - 2 * angle[many:-many] + angle[: -2 * many]
    return float((second**2).mean() / (2 * (many * interval) ** 2))


def test_what_is_constant_is_added_as_stated() -> None:
    misaligned = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
    made = design(
        gyro={
            "bias": [1.0, 2.0, 3.0],
            "scale_factor": [100, 200, 300],
            "misalignment": misaligned,
            "g_sensitivity": 2,
        },
        accel={"bias": 5, "asymmetry": [10, 20, 30], "square": [7.0, 8.0, 9.0]},
    )
    rate, force = np.array([0.1, -0.2, 0.3]), np.array([1.0, -2.0, -9.8])
    found = Imperfect(made)(np.tile(np.concatenate((rate, force)) * 0.01, (3, 1)))
    x, y, z = rate
    gyro = [
        x * (1 + 100e-6) + 1e-3 * y + 2e-3 * z + HOUR * (1 + 2 * force[0] / G),
        3e-3 * x + y * (1 + 200e-6) + 4e-3 * z + HOUR * (2 + 2 * force[1] / G),
        5e-3 * x + 6e-3 * y + z * (1 + 300e-6) + HOUR * (3 + 2 * force[2] / G),
    ]
    accel = [
        1.0 + 10e-6 * 1.0 + 7e-6 / G * 1.0 + 5e-3 * G,
        -2.0 + 20e-6 * 2.0 + 8e-6 / G * 4.0 + 5e-3 * G,
        -9.8 + 30e-6 * 9.8 + 9e-6 / G * 9.8**2 + 5e-3 * G,
    ]
    assert found == pytest.approx(np.tile([*gyro, *accel], (3, 1)) * 0.01, rel=1e-12)


def test_a_rate_sensor_has_the_same_errors_of_its_rates() -> None:
    sample = np.array([[0.1, -0.2, 0.3, 1.0, -2.0, -9.8]])
    errors = {"gyro": {"bias": 3.0, "random_walk": 0.1}, "accel": {"scale_factor": 50}}
    rates = Imperfect(design(kind="rate", **errors))(sample)
    increments = Imperfect(design(**errors))(sample * 0.01)
    assert increments == pytest.approx(rates * 0.01, rel=1e-12)


def test_allan_variances_are_those_of_the_data_sheet() -> None:
    """IEEE Std 952: N²/τ, K² τ/3, (2 ln 2/π) B²."""
    samples = 1 << 17
    still = np.zeros((samples, 6))

    def rates(**gyro: float) -> Array:
        return Imperfect(design(gyro=gyro), 7)(still)[:, :3] * 100.0

    white = rates(random_walk=0.3)
    for many in (1, 10, 100):
        expected = (radians(0.3) / 60) ** 2 / (many * 0.01)
        assert allan(white, 0.01, many) == pytest.approx(expected, rel=0.06)
    walk = rates(rate_random_walk=20.0)
    for many in (30, 300):
        expected = (20.0 * HOUR / 60) ** 2 * many * 0.01 / 3
        assert allan(walk, 0.01, many) == pytest.approx(expected, rel=0.1)
    flicker = rates(flicker=2.0)
    for many in (10, 100, 1000):
        expected = 2 * log(2) / pi * (2.0 * HOUR) ** 2
        assert allan(flicker, 0.01, many) == pytest.approx(expected, rel=0.1), many


def test_a_bias_that_wanders_is_gauss_markov() -> None:
    errors = {"accel": {"markov": 3.0, "markov_time_s": 2.0}}
    force = Imperfect(design(**errors), 3)(np.zeros((1 << 17, 6)))[:, 3:] * 100.0
    size = 3e-3 * G
    assert (force**2).mean() == pytest.approx(size**2, rel=0.1)
    for lag in (50, 200):  # s/100
        expected = size**2 * exp(-lag * 0.01 / 2.0)
        assert (force[lag:] * force[:-lag]).mean() == pytest.approx(expected, rel=0.2)


def test_cuts_change_nothing_but_rounding_and_seeds_everything() -> None:
    walks = {"random_walk": 0.1, "flicker": 1.0, "rate_random_walk": 3.0}
    wanders = {"markov": 1.0, "markov_time_s": 1.0, "bias": {"sigma": 2.0}}
    made = design(gyro=walks, accel=wanders)
    whole = Imperfect(made, 5)(np.zeros((1000, 6)))
    parts = Imperfect(made, 5)
    cut = np.concatenate([parts(np.zeros((many, 6))) for many in (1, 399, 600)])
    assert cut == pytest.approx(whole, rel=1e-9, abs=1e-18)
    assert np.abs(Imperfect(made, 6)(np.zeros((1000, 6))) - whole).min(axis=0).max() > 0
    # one more error leaves the random numbers of the others alone
    more = Imperfect(design(gyro=walks | {"bias": 36.0}, accel=wanders), 5)(np.zeros((1000, 6)))
    assert (more - whole)[:, :3] == pytest.approx(np.full((1000, 3), 0.36 * HOUR), rel=1e-6)
    assert (more == whole)[:, 3:].all()


def test_what_is_drawn_has_its_sigma() -> None:
    drawn = [
        Imperfect(design(gyro={"bias": {"sigma": 2.0}}), seed)(np.zeros((1, 6)))[0, :3]
        for seed in range(400)
    ]
    assert np.std(drawn) / (HOUR * 0.01) == pytest.approx(2.0, rel=4 / sqrt(2 * 1200))


def test_the_ends_of_the_range_are_kept_and_counted() -> None:
    imperfect = Imperfect(design(gyro={"range": 100.0}, accel={"range": 2.0}))
    samples = np.zeros((4, 6))
    samples[1, 1], samples[2, 5] = -radians(150) * 0.01, 30.0 * 0.01
    found = imperfect(samples)
    assert (found[1, 1], found[2, 5]) == pytest.approx((-radians(100) * 0.01, 2 * G * 0.01))
    assert imperfect.beyond_range == 2


def test_accelerometers_off_the_centre_feel_the_turning() -> None:
    """A steady spin about z: -ω² r towards the axis, by 0.1 m of x and 0.2 m of y."""
    rate = 3.0
    spin = Motion(0.8, 0.2, 500.0, turns=(Turn(Z, Curve((0.0, rate))),))
    arms = [[0.1, 0.0, 0.0], [0.0, 0.2, 0.0], [0.0, 0.0, 0.3]]
    t = np.array([0.0, 0.7])
    more = as_felt(spin, design(arms_m=arms)).sensed(t) - spin.sensed(t)
    expected = [0, 0, 0, -0.1 * rate**2, -0.2 * rate**2, 0]
    assert more == pytest.approx(np.tile(expected, (2, 1)), abs=1e-3)  # the Earth turns, too


def test_accelerometers_that_see_later() -> None:
    shaken = Motion(0.8, 0.2, 500.0, up=Curve(waves=((0.01, 50.0, 0.0),)))
    t = np.linspace(0, 1, 11)
    late = as_felt(shaken, design(delay_samples=0.5)).sensed(t)
    assert late[:, 3:] == pytest.approx(shaken.sensed(t - 0.005)[:, 3:], abs=1e-12)
    assert (late[:, :3] == shaken.sensed(t)[:, :3]).all()
    still = at_rest(0.8, 0.2, 500.0)
    assert as_felt(still, design(gyro={"bias": 1.0})) is still


def test_presets_fill_in_and_what_is_said_goes_first() -> None:
    made = design(preset="stim300", gyro={"random_walk": 0.2})
    errors = made.sensor.errors
    assert errors is not None
    assert errors.gyro.random_walk == 0.2
    assert errors.accel.random_walk == 0.06  # the data sheet's m/s/√h
    assert Design.parse(made.as_json()) == made
    assert "errors" not in Design.preset("stim300").as_json()["sensor"]


@pytest.mark.parametrize(
    ("errors", "said"),
    [
        ({"gyro": {"bias": [1, 2]}}, "sensor.errors.gyro.bias"),
        ({"gyro": {"biass": 1}}, "sensor.errors.gyro.biass"),
        ({"gyro": {"markov": 1.0}}, "markov and markov_time_s: give both or neither"),
        ({"accel": {"g_sensitivity": 1}}, "only gyros have one, leave it out"),
        ({"accel": {"random_walk": -1.0}}, "a number from 0 to 1e9"),
        ({"preset": "stim301"}, "one of stim300, hg9900"),
        ({"arms_m": [[0, 0, 0]]}, "three rows x, y, z"),
    ],
)
def test_faults_are_told(errors: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match="design: ") as raised:
        design(**errors)
    assert said in str(raised.value)
