"""Errors that `Imperfect` and a sensor's place put in, taken out again."""

from __future__ import annotations

from math import radians
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from sculler_model.design import Design, SensorErrors
from sculler_model.errors import InputError
from sculler_model.fast import FastModel, VectorBlock
from sculler_model.frames import STANDARD_GRAVITY
from sculler_model.host import calibrated, major_increments, velocity_rotation
from sculler_model.motion import as_felt, spin_rock_size
from sculler_model.samples import Calibration, Imperfect, Quantiser, Undo

Array = NDArray[np.float64]

LINEAR: dict[str, Any] = {
    "gyro": {
        "bias": [20.0, -40.0, 10.0],
        "scale_factor": [500.0, -300.0, 200.0],
        "misalignment": [1.0, -0.5, 0.3, 0.8, -0.2, 0.4],
        "g_sensitivity": [5.0, -3.0, 2.0],
    },
    "accel": {
        "bias": [2.0, -1.0, 3.0],
        "scale_factor": [300.0, 200.0, -100.0],
        "misalignment": [-1.0, 0.5, 0.3, -0.8, 0.2, -0.4],
    },
}
BENT = {
    "gyro": {"asymmetry": [500.0, 200.0, -300.0], "square": [1.0, 2.0, 3.0]},
    "accel": {"asymmetry": [-900.0, 0.0, 100.0], "square": [10.0, 20.0, 30.0]},
}
ARMS = [[0.1, 0.02, -0.03], [0.05, -0.2, 0.01], [0.0, 0.03, 0.15]]
KINDS = {
    "linear": LINEAR,
    "bent": {name: {**LINEAR[name], **BENT[name]} for name in LINEAR},
    "late": {"delay_samples": 2.3},
    "early": {"delay_samples": -0.4},
    "apart": {"arms_m": ARMS},
    "all": {
        **{name: {**LINEAR[name], **BENT[name]} for name in LINEAR},
        "delay_samples": -3.7,
        "arms_m": ARMS,
    },
}


def sensor(kind: str, errors: dict[str, Any] | None = None) -> Design:
    """The same sensor, as fine as it gets, with and without errors."""
    part = {"kind": kind, "sample_rate_hz": 1000.0}
    part |= {"gyro": {"bits": 32, "lsb": 1e-10}, "accel": {"bits": 32, "lsb": 1e-8}}
    if kind == "rate":
        part |= {"gyro": {"bits": 32, "lsb": 1e-8}, "accel": {"bits": 32, "lsb": 1e-6}}
    return Design.parse(
        {
            "name": "d",
            "sensor": part | ({} if errors is None else {"errors": errors}),
            "algorithm": {"family": "frequency-taylor", "samples": 4, "minors": 5}
            if kind == "increment"
            else {"family": "filtered-rate", "samples": 2, "minors": 5},
        }
    )


def felt_and_true(kind: str, errors: dict[str, Any], count: int = 600) -> tuple[Array, Array]:
    """(N, 6) samples of spinning and rocking with errors, and without."""
    motion, design = spin_rock_size(radians(48), radians(11), 500.0, arm=0.0), sensor(kind, errors)
    (perfect,) = motion.chunks(design.sensor.kind, count, design.sample_interval)
    (placed,) = as_felt(motion, design).chunks(design.sensor.kind, count, design.sample_interval)
    return Imperfect(design)(placed), perfect


@pytest.mark.parametrize("errors", KINDS.values(), ids=KINDS)
@pytest.mark.parametrize("kind", ["increment", "rate"])
def test_what_was_put_in_is_taken_out(kind: str, errors: dict[str, Any]) -> None:
    """Rates and forces to 1e-9; near the ends of the record, where neighbours lack, to 1 %.

    Gravity is another one where an accelerometer is: 4e-7 m/s² at 15 cm.
    """
    felt, true = felt_and_true(kind, errors)
    per_sample = 1e-3 if kind == "increment" else 1.0
    undo = Undo(sensor(kind), Calibration.of(SensorErrors.model_validate(errors)))
    found = np.concatenate((undo(felt), undo.finish()))
    off, before = (np.abs(each - true) / per_sample for each in (found, felt))
    size = np.array([1.0, 1.0, 1.0, 10.0, 10.0, 10.0])
    inner = slice(undo.reach, len(true) - undo.reach)
    assert (off[inner] / size).max() < (5e-8 if "arms_m" in errors else 1e-9)
    assert (off / size).max() < 0.01
    assert (before[inner] / size).max() > 1e-4


def test_blocks_of_any_length() -> None:
    felt, _ = felt_and_true("increment", KINDS["all"])
    known = Calibration.of(SensorErrors.model_validate(KINDS["all"]))
    whole = Undo(sensor("increment"), known)
    at_once = np.concatenate((whole(felt), whole.finish()))
    for cuts in ([0, 3, 4, 200], [599], list(range(2, 600, 7))):
        undo = Undo(sensor("increment"), known)
        parts = [undo(part) for part in np.split(felt, cuts)] + [undo.finish()]
        assert len(np.concatenate(parts)) == len(felt)
        later = slice(20, None)  # the first block tells how it began
        np.testing.assert_allclose(np.concatenate(parts)[later], at_once[later], rtol=0, atol=1e-15)
    none = Undo(sensor("increment"), Calibration.of(SensorErrors()))
    assert np.array_equal(none(felt), felt)
    assert len(none.finish()) == 0


def test_size_effect_of_a_steady_turn_is_centripetal() -> None:
    """At 0.2 m from the axis of 60 °/s an accelerometer feels ω² r inward."""
    errors = {"arms_m": [[0.2, 0, 0], [0, 0, 0], [0, 0, 0]]}
    undo = Undo(sensor("rate"), Calibration.of(SensorErrors.model_validate(errors)))
    rate = radians(60)
    felt = np.tile([0.0, 0.0, rate, -0.2 * rate**2, 0.0, -STANDARD_GRAVITY], (50, 1))
    found = undo(felt)
    assert np.abs(found[:, 3]).max() < 1e-15
    assert np.array_equal(found[:, 4:], felt[: len(found), 4:])


def test_out_of_results_too() -> None:
    """Where the core has summed them up raw: what is left is bias times the change of the motion.

    A rate that changes by c rad/s² in a bias b of force leaves ½ b c T³/6, here 1e-6 m/s, and none
    in the mean.
    """
    design, clean = sensor("increment", LINEAR), sensor("increment")
    motion = spin_rock_size(radians(48), radians(11), 500.0, arm=0.0)
    (perfect,) = motion.chunks("increment", 2000, design.sample_interval)
    raw, true = (
        FastModel(clean).feed(Quantiser(clean)(each))
        for each in (Imperfect(design)(perfect), perfect)
    )
    known = Calibration.of(SensorErrors.model_validate(LINEAR))
    found = calibrated(clean, raw, major_increments(clean, raw), known)
    expected, before = major_increments(clean, true), major_increments(clean, raw)
    for name, most in (("alpha", 2e-10), ("phi", 2e-8), ("dv_sf", 3e-6)):
        off = np.abs(getattr(found, name) - getattr(expected, name)).max()
        assert off < most
        assert np.abs(getattr(before, name) - getattr(expected, name)).max() > 30 * off


REFUSED = {
    "gyro.flicker: is random or a limit": {"gyro": {"flicker": 0.5}},
    "accel.range: is random or a limit": {"accel": {"range": 10.0}},
    "gyro.bias: is random": {"gyro": {"bias": {"sigma": 4.0}}},
    "gyro.bias: is random or": {"preset": "stim300"},
}


@pytest.mark.parametrize("message", REFUSED)
def test_refuses_what_nobody_knows(message: str) -> None:
    with pytest.raises(InputError, match=message):
        Calibration.of(SensorErrors.model_validate(REFUSED[message]))


def test_results_do_not_tell_samples() -> None:
    design = sensor("increment")
    block = FastModel(design).feed(np.zeros((40, 6), int))
    known = Calibration.of(SensorErrors.model_validate(KINDS["all"]))
    with pytest.raises(InputError, match=r"gyro\.square, .*, delay_samples, arms_m cannot"):
        calibrated(design, block, major_increments(design, block), known)
    high = Design.preset("stim300", position="high-resolution")
    block = FastModel(high).feed(np.zeros((40, 6), int))
    linear = Calibration.of(SensorErrors.model_validate(LINEAR))
    with pytest.raises(InputError, match="high-resolution position cannot be freed of it"):
        calibrated(high, block, major_increments(high, block), linear)


@pytest.mark.parametrize("ppm", [2000.0, -2000.0])
def test_one_scale_factor_of_all_axes_scales_products_by_its_square(ppm: float) -> None:
    """Coning and sculling are of two vectors each; biases are taken out before they are scaled."""
    design = sensor("increment")
    rows = np.random.default_rng(4).integers(-(10**6), 10**6, (5, 18)) * 1000
    rows[:, 3:9] *= 10**9
    rows[:, 12:] *= 10**9
    block = VectorBlock(np.arange(5), np.zeros(5, np.int64), rows)
    felt = major_increments(design, block)
    each = {"bias": [20.0, -40.0, 10.0], "scale_factor": [ppm] * 3}
    errors = SensorErrors.model_validate({"gyro": each, "accel": each})
    found = calibrated(design, block, felt, Calibration.of(errors))
    m, T = 1 / (1 + 1e-6 * ppm), design.major_interval
    bias = np.array(each["bias"])
    alpha = m * (felt.alpha - np.radians(bias / 3600) * T)
    nu = rows[:, 9:12] * design.accel_scale / design.table.sum_denominator
    upsilon = m * (nu - 1e-3 * STANDARD_GRAVITY * bias * T)
    sculling = felt.dv_sf - nu - velocity_rotation(felt.alpha, nu)
    dv_sf = upsilon + velocity_rotation(alpha, upsilon) + m * m * sculling
    assert found.alpha == pytest.approx(alpha, rel=1e-12)
    assert found.phi == pytest.approx(alpha + m * m * (felt.phi - felt.alpha), rel=1e-12)
    assert found.dv_sf == pytest.approx(dv_sf, rel=1e-12)
    assert np.abs(sculling).max() > 1e-3 * np.abs(dv_sf).max()
