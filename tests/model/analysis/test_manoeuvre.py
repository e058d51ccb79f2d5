"""Manoeuvres: truth against an ODE solver, error sources by their orders, third order."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from host_path import fine_design
from sculler_model.analysis.integer_path import rotation_vectors, running_attitude, unquantised
from sculler_model.analysis.manoeuvre import (
    MANOEUVRES,
    Manoeuvre,
    errors,
    second_order_steps,
    split,
    true_attitude,
    update_minors,
)
from sculler_model.errors import InputError
from sculler_model.frames import product
from sculler_model.host import rotation_terms, slopes, third_order_terms

EXTREME = MANOEUVRES["extreme"]


def integrated(manoeuvre: Manoeuvre, until: float) -> NDArray[np.float64]:
    """Quaternion at a time, from the differential equation itself."""

    def slope(t: float, q: NDArray[np.float64]) -> NDArray[np.float64]:
        x, y, z = manoeuvre.rate(np.array([t]))[0]
        w, i, j, k = q
        return 0.5 * np.array(product((w, i, j, k), (0.0, x, y, z)))

    found = solve_ivp(
        slope, (0, until), [1, 0, 0, 0], method="DOP853", rtol=1e-13, atol=1e-15, max_step=0.01
    )
    return found.y[:, -1] / np.linalg.norm(found.y[:, -1])


@pytest.mark.parametrize("name", MANOEUVRES)
def test_truth_solves_the_differential_equation(name: str) -> None:
    manoeuvre = MANOEUVRES[name]
    truth = true_attitude(manoeuvre, np.linspace(0, manoeuvre.duration, 51))
    middle = np.stack([integrated(manoeuvre, s * manoeuvre.duration / 50) for s in (20, 50)])
    assert errors(truth[[19, 49]], middle) == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize("name", MANOEUVRES)
def test_profiles_begin_and_end_at_rest_and_are_what_they_say(name: str) -> None:
    manoeuvre = MANOEUVRES[name]
    ends = np.array([-1.0, 0.0, manoeuvre.duration, manoeuvre.duration + 1])
    assert manoeuvre.rate(ends) == pytest.approx(0, abs=1e-9)
    t = np.linspace(0, manoeuvre.duration, 2001)
    mean = (manoeuvre.rate(t[1:]) + manoeuvre.rate(t[:-1])) / 2
    walked = np.cumsum(mean, axis=0)[-1] * (t[1] - t[0])
    assert manoeuvre.angle(ends)[-1] == pytest.approx(walked, abs=1e-5)
    assert manoeuvre.peak_degrees() == pytest.approx(
        {"extreme": [300, 100, 60], "turn-entry": [40, 8, 6], "pitch-over": [400, 50, 50]}[name],
        rel=1e-5,
    )


def test_source_1_falls_with_the_fourth_power_of_the_interval() -> None:
    """Savage-20: doubling the update rate divides it by 16; about 0.001 µrad at 200 Hz."""
    found = {hz: split(fine_design(2, minors=1), EXTREME, 1000 // hz, False) for hz in (100, 200)}
    assert found[100].source_1 / found[200].source_1 == pytest.approx(16, rel=0.01)
    assert 1e-4 < found[200].source_1 < 1e-2


def test_source_2_is_of_the_samples_and_not_of_the_update_rate() -> None:
    design = fine_design(4)
    found = [split(design, EXTREME, minors, False) for minors in (2, 5, 10)]
    assert [s.source_2 for s in found] == pytest.approx([found[0].source_2] * 3, rel=2e-3)
    # compressed: g0×g2 is wrong by h⁴ a minor interval, h³ over the manoeuvre
    slow = split(fine_design(4, rate=1000.0), EXTREME, 2, False)
    assert slow.source_2 / found[0].source_2 == pytest.approx(8, rel=0.01)


def test_two_samples_are_exact_for_a_linear_rate() -> None:
    """½∫α×ω of a + bt needs only two increments: no source 2, whatever coefficients are called."""
    ramp = Manoeuvre(
        "ramp", 1.0, (Polynomial([0.5, 1.0]), Polynomial([-0.3, 2.0]), Polynomial([1.0, -0.7]))
    )
    design = fine_design(2, minors=5, rate=200.0)
    phi, alpha = unquantised(design, ramp.samples(design, 200))
    exact = second_order_steps(ramp, np.linspace(0, 1, 21))
    assert phi == pytest.approx(exact, abs=1e-15)
    assert alpha == pytest.approx(np.diff(ramp.angle(np.linspace(0, 1, 21)), axis=0), abs=1e-15)


@pytest.mark.parametrize(("samples", "history", "kind"), [(4, 0, "increment"), (2, 0, "rate")])
def test_integers_leave_what_the_exact_samples_leave(samples: int, history: int, kind: str) -> None:
    design = fine_design(samples, history, kind=kind)
    found = split(design, EXTREME, 8, False)
    assert found.integer_path == pytest.approx(found.complete, rel=1e-3)
    assert found.largest >= found.complete


def test_the_designs_own_lsb_shows() -> None:
    design = fine_design(4, gyro_lsb=1e-7)
    assert (
        split(design, EXTREME, 5, True).integer_path
        > 2 * split(design, EXTREME, 5, False).integer_path
    )


PARABOLA = Manoeuvre(
    "parabola",
    1.0,
    (Polynomial([1.0, -2.0, 3.0]), Polynomial([0.5, 4.0, -1.0]), Polynomial([-1.5, 1.0, 2.0])),
)


def test_third_order_terms_are_those_of_the_rotation_vector() -> None:
    """What is left after them falls with the seventh power of the interval, not with the fifth.

    In halves it is half of that.
    """
    left, before, halves = [], [], []
    for interval in (0.04, 0.02):
        times = 0.2 + interval * np.arange(6)
        steps = np.linspace(times[4], times[5], 8001)
        true = rotation_vectors(running_attitude(second_order_steps(PARABOLA, steps))[-1:])[0]
        lacking = true - second_order_steps(PARABOLA, times)[4]
        rates = slopes(np.diff(PARABOLA.angle(times), axis=0))
        terms = third_order_terms(*rates[:3])[0]
        halves.append(np.linalg.norm(lacking - rotation_terms(rates)[0]))
        before.append(np.linalg.norm(lacking))
        left.append(np.linalg.norm(lacking - terms))
    assert before[0] / before[1] == pytest.approx(2**5, rel=0.1)
    assert left[0] / left[1] == pytest.approx(2**7, rel=0.25)
    assert left[1] < 0.01 * before[1]
    assert halves[0] < 0.6 * left[0]


def test_third_order_on_the_host_takes_manoeuvres_down() -> None:
    for name in MANOEUVRES:
        found = split(fine_design(2, minors=1), MANOEUVRES[name], 10, False)
        assert found.third_order < found.complete / 25


def test_third_order_is_zero_about_a_fixed_axis() -> None:
    t = np.linspace(0, 1, 30)[:, None]
    alpha = np.array([[0.1, -0.2, 0.3]]) * np.sin(2 * pi * t)
    assert rotation_terms(slopes(alpha)) == pytest.approx(0, abs=1e-17)


def test_update_rates() -> None:
    design = fine_design(4)  # 500 minor intervals a second
    assert update_minors(design, 50, 400) == [10, 8, 7, 6, 5, 4, 3, 2]
    assert update_minors(design, 500, 500) == [1]
    assert len(update_minors(design, 1, 500, most=4)) == 4
    with pytest.raises(InputError, match="500 minor intervals a second, of which no whole number"):
        update_minors(design, 260, 400)
