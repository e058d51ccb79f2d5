"""Position by trapezoid and at high resolution: Savage-98 section VI, and integrals made here."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np
import pytest

from sculler.runs.analysis import of_family
from sculler_model.analysis.position import (
    Conditions,
    first_order,
    left,
    selection,
    trapezoid_ramps,
    true_ramps,
)
from sculler_model.errors import InputError

G, T = 9.80665, 0.02
PAPER = Conditions(3 * G, 3 * G, 1.0, 0.0, 3.6 * G, 50.0, 0.0, 1e-4, 10.0)


def test_figures_of_the_paper() -> None:
    """cm: 0.00196 and 0.098; 11.2 cm/s; 0.59, 29.4; 0.0039, 0.20; 0.32; 0.0011, 0.053, 0.024."""
    found = selection(PAPER, T)
    assert found.high_resolution
    assert 100 * found.velocity_rms == pytest.approx(11.2, abs=0.05)
    terms = {term.name: term for term in found.trapezoid + found.terms}
    for name, each, a_second in (
        ("trapezoid, ramp of the force", 0.00196, 0.098),
        ("trapezoid, force in a turn", 0.00196, 0.098),
        ("S_υ, force", 0.59, 29.4),
        ("S_υ, ramp of the force", 0.0039, 0.20),
        ("ΔR_rot, force in a turn", 0.0039, 0.20),
        ("S_υ, vibration", 0.32, 16.0),
        ("ΔR_rot, vibration in a turn", 0.0011, 0.053),
        ("ΔR_scrl, vibration in a turn (Eq. 109)", 0.0011, 0.053),
    ):
        assert 100 * terms[name].each == pytest.approx(each, rel=0.04), name
        assert 100 * terms[name].a_second == pytest.approx(a_second, rel=0.02), name
        assert terms[name].over
    random = 100 * terms["ΔR_rot, vibration in a turn"].random
    assert random == pytest.approx(0.024, abs=5e-4)


def test_a_slow_vehicle_needs_no_more_than_the_trapezoid() -> None:
    calm = Conditions(0.1, 0.01, 0.01, 0.0, limit=0.01, seconds=10.0)
    assert not selection(calm, 0.01).high_resolution


def test_straight_lines_by_their_integrals() -> None:
    """Eq. 108 against Eq. 106 and 107, integrated."""
    generator = np.random.default_rng(5)
    A, B, C, D = generator.normal(size=(4, 3))

    def alpha(t: np.ndarray) -> np.ndarray:
        return np.outer(t, A) + np.outer(t * t / 2, B)

    def force(t: np.ndarray) -> np.ndarray:
        return C + np.outer(t, D)

    velocity, moved = first_order(alpha, force, 0.3)
    assert true_ramps(A, B, C, D, 0.3) == pytest.approx(moved, rel=1e-12)
    assert trapezoid_ramps(A, B, C, D, 0.3) == pytest.approx(velocity * 0.15, rel=1e-12)


def test_the_paper_takes_a_phase_where_the_truth_is_s_alone() -> None:
    """ΔR_SF = S_υ for a sine of one cycle in a steady turn, so scrolling undoes the rotation."""
    omega = 2 * pi * 50

    def force(t: np.ndarray) -> np.ndarray:
        return np.outer(np.sin(omega * t), (0.0, 1.0, 0.0))

    _, moved = first_order(lambda t: np.outer(t, (1.0, 0.0, 0.0)), force, T, 2 * omega)
    assert moved == pytest.approx([0.0, T / omega, 0.0], abs=1e-15)
    found = {term.name: term.each for term in selection(PAPER, T).terms}
    rotation, scrolling = (
        found["ΔR_rot, vibration in a turn"],
        found["ΔR_scrl, vibration in a turn (Eq. 109)"],
    )
    assert scrolling == pytest.approx(rotation, rel=1e-9)


def _true_end(conditions: Conditions, step: float) -> tuple[complex, complex]:
    """Position at the end, and by the trapezoid of the true velocity: by a fine midpoint rule."""
    c, count = conditions, round(conditions.seconds / step)
    t = (np.arange(count) + 0.5) * step
    omega = 2 * pi * c.hertz
    alpha = c.rate * t + c.rocking * np.sin(omega * t)
    seen = (c.force + sqrt(2) * c.vibration * np.sin(omega * t)) * np.exp(1j * alpha)
    velocity = np.concatenate(([0], np.cumsum(seen) * step))
    position = complex(np.sum(velocity[:-1] + velocity[1:]) * step / 2)
    ends = velocity[:: round(T / step)]
    return position, complex(np.sum(ends[:-1] + ends[1:]) * T / 2)


def test_the_trapezoid_by_a_motion_integrated_here() -> None:
    shaken = Conditions(3.0, 0.0, 1.0, 0.0, 20.0, 47.0, 3e-4, 1e-4, 1.0)
    true, trapezoid = _true_end(shaken, 1e-5)
    found = left(of_family("frequency-taylor", 4, 0, 10).design, shaken)
    assert found.trapezoid.final == pytest.approx(abs(trapezoid - true), rel=1e-4)
    assert found.exact_integrals.final < found.trapezoid.largest / 1000


def test_high_resolution_is_exact_for_constant_rate_and_force() -> None:
    steady = Conditions(3 * G, 0.0, 1.0, 0.0, seconds=1.0)
    found = left(of_family("frequency-taylor", 4, 0, 10).design, steady)
    assert found.trapezoid.each == pytest.approx(3 * G * T**3 / 12, rel=1e-3)
    assert found.exact_integrals.largest < 1e-15
    assert found.core is not None
    assert found.core.largest < 1e-11


def test_what_is_left_does_not_depend_on_the_family() -> None:
    """It is the second order of the method, in the angle: halved turn, a quarter of it."""
    turning = Conditions(0.0, 0.0, 1.0, 0.0, 3.6 * G, 50.0, seconds=0.5)
    slower = Conditions(0.0, 0.0, 0.5, 0.0, 3.6 * G, 50.0, seconds=0.5)
    one, other = (
        left(of_family(family, 4, 0, 10).design, turning)
        for family in ("frequency-taylor", "time-taylor")
    )
    assert one.core == other.core
    assert one.core is not None
    assert one.core.each == pytest.approx(one.exact_integrals.each, rel=1e-3)
    halved = left(of_family("frequency-taylor", 4, 0, 10).design, slower)
    assert halved.exact_integrals.each == pytest.approx(one.exact_integrals.each / 4, rel=0.01)


def test_rates_have_no_core_at_high_resolution() -> None:
    steady = Conditions(G, 0.0, 1.0, seconds=0.1)
    assert left(of_family("filtered-rate", 2).design, steady).core is None


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"force": -1.0}, "force: -1 is not allowed"),
        ({"vibration": 1.0}, "no frequency"),
        ({"limit": 0.0}, "above 0"),
    ],
)
def test_refusals(keys: dict[str, float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        Conditions(**keys)
