"""Iteration to convergence on the samples, against motions in closed form."""

from __future__ import annotations

from math import pi, radians

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

import sculler
from host_path import fine_design
from sculler_model.analysis.frequency import drift, iteration_drift
from sculler_model.analysis.integer_path import changed, rotation_vectors, running_attitude
from sculler_model.analysis.iteration import attitude_on, iterated
from sculler_model.analysis.manoeuvre import Manoeuvre, errors, true_attitude
from sculler_model.analysis.orders import HeldConing, left_by_order
from sculler_model.analysis.oscillation import Cone, Scull
from sculler_model.analysis.triple import ConingTurn, left
from sculler_model.design import Design
from sculler_model.errors import InputError
from sculler_model.frames import conjugate, product, rotate
from sculler_model.motion import Coning, SpinAccel

Array = NDArray[np.float64]

HZ = 2000.0


def off(motion: Coning, phi: Array, step: int, first: int) -> float:
    """Largest error of the attitude on the way, rad; the first block begins at sample `first`."""
    times = (first + step * np.arange(len(phi) + 1)) / HZ
    true = motion.attitude(times)
    since = product(conjugate(tuple(true[0])), tuple(true[1:].T))
    wrong = np.stack(product(conjugate(since), tuple(running_attitude(phi).T)), axis=1)
    return float(np.linalg.norm(rotation_vectors(wrong), axis=1).max())


@pytest.mark.parametrize("half_angle", [1, 45, 90])
@pytest.mark.parametrize("step", [1, 4, 11])
def test_a_cone_to_rounding(half_angle: float, step: int) -> None:
    """At a hundredth of the sample rate there is nothing that the samples do not tell."""
    motion = Coning(radians(half_angle), 2 * pi * HZ / 100)
    phi = iterated(motion.increments(660 + 40, 1 / HZ)[:, :3], step, degree=16, edge=20)
    assert off(motion, phi, step, 20) < 3e-12


@pytest.mark.parametrize(("degree", "most"), [(2, 2e-3), (4, 2e-4), (8, 2e-6), (16, 2e-10)])
def test_each_degree_takes_it_further(degree: int, most: float) -> None:
    """At a tenth of the sample rate, over 0.33 s of a cone of 1°."""
    motion = Coning(radians(1), 2 * pi * HZ / 10)
    phi = iterated(motion.increments(660 + 40, 1 / HZ)[:, :3], 1, degree=degree, edge=20)
    assert 0.02 * most < off(motion, phi, 1, 20) < most


def test_rate_samples_are_means_about_their_instants() -> None:
    motion = Coning(radians(10), 2 * pi * HZ / 100)
    rates = motion.rates(440 + 40, 1 / HZ, 1, filtered=True)[:, :3]
    phi = iterated(rates / HZ, 4, degree=12, ahead=0.5, edge=20)
    assert off(motion, phi, 4, 20) < 1e-12
    assert off(motion, iterated(rates / HZ, 4, degree=12, edge=20), 4, 20) > 1e-3


def test_a_polynomial_of_its_degree_is_exact() -> None:
    """At the ends of the record too, where all samples lie on one side."""
    rates = tuple(
        Polynomial(c) for c in ([1.0, -2.0, 3.0, 0.5], [0.5, 4.0, -1.0, 1.0], [-1.5, 1.0, 2.0, 0.0])
    )
    manoeuvre = Manoeuvre("cubic", 1.0, (rates[0], rates[1], rates[2]))
    times = np.linspace(0.0, 1.0, 41)
    samples = np.diff(manoeuvre.angle(times), axis=0)
    true = true_attitude(manoeuvre, times)
    for degree in (3, 7):
        q = running_attitude(iterated(samples, 1, degree=degree))
        assert errors(q, true).max() < 1e-7  # µrad; the truth's own is 3e-8
    assert errors(running_attitude(iterated(samples, 1, degree=2)), true).max() > 1e-2
    whole = running_attitude(iterated(samples, 8, degree=3))  # blocks longer than the polynomial's
    assert errors(whole, true[7::8]).max() < 1e-7


def test_a_large_turn_in_one_block() -> None:
    """2.5 rad about a fixed axis, and the same as a rotation vector."""
    turn = np.full((10, 3), [0.15, 0.0, 0.2])
    assert iterated(turn, 10, degree=4)[0] == pytest.approx([1.5, 0.0, 2.0], abs=1e-13)


def test_one_figure_whatever_the_intervals() -> None:
    design = Design.preset("stim300")
    samples = Coning(radians(1), 300.0).increments(240, design.sample_interval)
    fifth = attitude_on(design, samples)
    each = attitude_on(changed(design, algorithm={"minors": 1}), samples)
    assert np.array_equal(each[4::5], fifth)
    long = fine_design(16)  # more than 11: sample by sample
    assert np.abs(attitude_on(long, samples, degree=10)[4::5] - fifth[3::4]).max() < 1e-11


def test_velocity_under_a_steady_force_in_a_steady_turn() -> None:
    """The closed forms of `SpinAccel`, in one block and in many."""
    spin, T = SpinAccel((0.9, -0.4, 3.3), (1.0, 20.0, -3.0)), 1e-2
    samples = spin.increments(60, T)
    end = spin.velocity(np.array([0.6]))[0]
    (whole,) = iterated(samples, 60, degree=2)
    assert whole[3:] == pytest.approx(end, rel=1e-12)
    blocks = iterated(samples, 4, degree=4)
    q = np.vstack(([1.0, 0, 0, 0], running_attitude(blocks[:, :3])[:-1]))
    w, i, j, k = q.T
    x, y, z = blocks[:, 3:].T
    reached = [axis.sum() for axis in rotate((w, i, j, k), (x, y, z))]
    assert reached == pytest.approx(end, rel=1e-12)


def test_velocity_under_a_force_that_curves_while_the_axis_turns() -> None:
    """Polynomials of both, held against Gauss and Legendre's rule on the quaternion's own."""
    rate = [Polynomial(c) for c in ([1.0, -2.0, 3.0], [0.5, 4.0, -1.0], [-1.5, 1.0, 2.0])]
    force = [Polynomial(c) for c in ([3.0, 1.0, -5.0], [-2.0, 8.0, 1.0], [9.0, -4.0, 2.0])]
    times = np.linspace(0.0, 0.5, 21)
    samples = np.stack([np.diff(p.integ()(times)) for p in (*rate, *force)], axis=1)
    (found,) = iterated(samples, 20, degree=2)
    nodes, weights = np.polynomial.legendre.leggauss(16)
    at = 0.25 * (nodes + 1)
    turning = Manoeuvre("cubic", 1.0, (rate[0], rate[1], rate[2]))
    q = np.stack([true_attitude(turning, np.array([0.0, t]))[0] for t in at])
    w, i, j, k = q.T
    x, y, z = (p(at) for p in force)
    expected = [0.25 * float(weights @ axis) for axis in rotate((w, i, j, k), (x, y, z))]
    assert found[3:] == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize("kind", ["increment", "rate"])
def test_sculling_of_a_slow_motion_to_rounding(kind: str) -> None:
    """At a hundredth of the sample rate, against B J₁(A); near Nyquist the samples limit."""
    design = fine_design(4, minors=5, kind=kind)
    motion = Scull(radians(3.0), 10.0)
    hertz, allowed = iteration_drift(design, motion, 20.0, 16)
    assert hertz == pytest.approx(20, rel=1e-2)
    assert abs(allowed) < 1e-10
    _, none = iteration_drift(design, motion, 960.0)
    assert abs(none) > 0.1


REFUSED: dict[str, tuple[tuple[int, int], dict[str, int]]] = {
    "do not make whole blocks of 3": ((10, 3), {"step": 3}),
    "do not make whole blocks of 1": ((10, 2), {"step": 1}),
    "degree 31 is not allowed for 50 samples, give 1 to 30": ((50, 3), {"step": 1, "degree": 31}),
    "degree 10 is not allowed for 10 samples, give 1 to 9": ((10, 3), {"step": 1}),
}


@pytest.mark.parametrize("message", REFUSED)
def test_refuses(message: str) -> None:
    shape, options = REFUSED[message]
    with pytest.raises(InputError, match=message):
        sculler.iterated(np.zeros(shape), **options)  # type: ignore[arg-type]


def test_says_whether_algorithm_or_sampling_limits() -> None:
    """n = 2 leaves 1e6 times more than its samples allow; near Nyquist both leave the lot."""
    cone, design = Cone(radians(1)), fine_design(2, minors=1)
    hertz, allowed = iteration_drift(design, cone, 200.0, 20)
    assert hertz == pytest.approx(200, rel=1e-3)
    left_of, whole = drift(design, cone, np.array([hertz, 960.0]))
    assert abs(allowed) < 1e-6 * abs(left_of)
    _, none = iteration_drift(design, cone, 960.0)
    assert abs(none) > 0.02 * abs(whole)


def test_a_spin_cone_is_to_rounding_where_second_order_is_not() -> None:
    motion = ConingTurn(radians(45), 3.0, spin=10.0)
    (found,) = left(fine_design(4, minors=5), motion, [5], 1.0)
    assert found.iteration < 1e-12
    assert found.second_order > 1e-6
    assert found.host < found.second_order / 300
    held = list(left_by_order(fine_design(4, minors=5), HeldConing(motion), [5], 0.5))
    assert {each.iteration for each in held} == {held[0].iteration}
    assert held[0].iteration < 1e-12 < held[-1].attitude
