"""Increments through Numba are those of numpy, bit for bit."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from sculler_model.design import Design
from sculler_model.fast import FastModel, WideIntegers, limbs_of
from sculler_model.host import scaling
from sculler_model.host.compiled import compiled_scale, nearest_float
from sculler_model.navigation import compiled_run
from strategies import DESIGNS, random_counts

pytest.importorskip("numba")


def test_a_wide_integer_becomes_the_nearest_float() -> None:
    """As the exact integer's nearest, ties to even, by Python's own `float`."""
    rng = np.random.default_rng(3)
    numbers = [0, 1, -1, 2**63, -(2**63), 2**64, -(2**64), 2**126 - 1, -(2**127), 2**127 - 1]
    for _ in range(3000):
        bits = int(rng.integers(50, 127))
        low = int.from_bytes(rng.bytes(16), "little") >> (128 - bits)
        numbers += [low, -low]
    for bits in range(54, 126):  # half-way between two floats, and one off
        for odd in (0, 1):
            half = (((1 << 53) | odd) << (bits - 53)) + (1 << (bits - 54))
            numbers += [half - 1, half, half + 1, -half]
    wide = limbs_of(WideIntegers.from_integers(np.array(numbers, object), 2))
    with np.errstate(over="ignore"):
        found = [float(nearest_float(limbs)) for limbs in wide]
    assert found == [float(number) for number in numbers]
    assert all(abs(Fraction(f) - n) * 2**53 <= abs(n) for f, n in zip(found, numbers, strict=True))


def test_what_is_kept_on_disk_is_found_again() -> None:
    """Numba's key holds what a closure has: compiled code there differs in every process."""
    for compiled in (compiled_scale(), compiled_run()):
        function: Any = compiled
        assert function.py_func.__closure__ is None


@pytest.mark.parametrize("name", ["stim300_4x5", "taylor_8p8", "rate_4p1", "smallest"])
def test_every_increment_is_the_same(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    design = DESIGNS[name]
    rng = np.random.default_rng(1)
    counts = random_counts(design, 50 * design.samples_per_major, rng)
    block = FastModel(design).feed(counts)
    by_numpy, compiled = scaling._scaled(design, block), scaling._compiled(design, block)
    for column in ("phi", "alpha", "dv_sf"):
        assert np.array_equal(getattr(by_numpy, column), getattr(compiled, column)), column
    assert by_numpy.status is block.status


def test_a_body_that_turns_by_more_than_the_series_reach() -> None:
    """At rest, then by 1.3 and by 1.1 rad an interval: numpy does those, the rest is compiled."""
    design = Design.preset("stim300")
    each = round(1.3 / (design.samples_per_major * design.gyro_scale))
    counts = np.zeros((4 * design.samples_per_major, 6), np.int64)
    counts[20:40, 2] = each
    counts[60:, 2] = round(1.1 / 1.3 * each)
    counts[:, 3] = 1000
    block = FastModel(design).feed(counts)
    by_numpy, compiled = scaling._scaled(design, block), scaling._compiled(design, block)
    assert np.linalg.norm(compiled.alpha, axis=1).round(3).tolist() == [0, 1.3, 0, 1.1]
    assert np.array_equal(by_numpy.dv_sf, compiled.dv_sf)
    # a force along x held in the body: sin θ/θ and (1 - cos θ)/θ of it at the start of the turn
    force = 20 * 1000 * design.accel_scale
    for row in (1, 3):
        angle = compiled.alpha[row, 2]
        expected = force * np.array([np.sin(angle), 1 - np.cos(angle)]) / angle
        assert compiled.dv_sf[row, :2] == pytest.approx(expected, rel=1e-12)
