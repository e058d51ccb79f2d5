"""The host's third order: it holds where the rate is smooth, and never makes a run worse.

Truth is the attitude of a motion in closed form; the second order is its exact integral, by Gauss
and Legendre's rule.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from math import pi, radians, sin, sqrt

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sculler_model.analysis.integer_path import rotation_vectors, running_attitude
from sculler_model.frames import conjugate, product
from sculler_model.host import MajorIncrements, ThirdOrder, slopes
from sculler_model.host.third_order import (
    SMOOTH,
    of_part,
    rotation_terms,
    smooth_intervals,
    velocity_terms,
)
from sculler_model.motion import Curve, Turn, attitude, coning_turns, euler_turns

Array = NDArray[np.float64]

T = 0.01
NODES = 20
NODE, WEIGHT = np.polynomial.legendre.leggauss(NODES)


def second_order(turns: tuple[Turn, ...], intervals: int) -> MajorIncrements:
    """Exact α and α + ½∫α×ω of consecutive intervals T, no force."""
    at = (np.arange(intervals)[:, None] + 0.5 * (NODE + 1)) * T
    _, rate = attitude(turns, at.ravel())
    rates = np.stack(rate, axis=1).reshape(intervals, NODES, 3)
    values = np.linalg.inv(np.polynomial.legendre.legvander(NODE, NODES - 1))
    sums = np.zeros((NODES, NODES))  # from the interval's start to each node
    for k, row in enumerate(values.T):
        integral = np.polynomial.legendre.Legendre(row).integ(lbnd=-1)
        sums[:, k] = integral(NODE)
    alpha = 0.5 * T * np.einsum("j,rjk->rk", WEIGHT, rates)
    running = 0.5 * T * np.einsum("ij,rjk->rik", sums, rates)
    coning = 0.25 * T * np.einsum("j,rjk->rk", WEIGHT, np.cross(running, rates))
    return MajorIncrements(alpha + coning, alpha, np.zeros_like(alpha))


def off(turns: tuple[Turn, ...], phi: Array) -> Array:
    """Arc seconds between the attitude after each interval and the true one."""
    q = np.stack(attitude(turns, np.arange(len(phi) + 1) * T)[0], axis=1)
    true = product(conjugate(tuple(q[0])), tuple(q[1:].T))
    wrong = np.stack(product(conjugate(true), tuple(running_attitude(phi).T)), axis=1)
    found: Array = np.degrees(np.linalg.norm(rotation_vectors(wrong), axis=1)) * 3600
    return found


def spinning(half_angle: float, cone: float, spin: float) -> tuple[Turn, ...]:
    """Spin (rad/s) about an axis that goes round a cone (rad/s)."""
    return euler_turns(Curve((0.0, spin)), Curve((pi / 2 - half_angle,)), Curve((0.0, cone)))


@pytest.mark.parametrize("half_angle", [1, 45, 90])
@pytest.mark.parametrize("hertz", [0.5, 2, 4, 5.5, 6, 10, 25, 40, 60])
def test_never_worse_in_a_cone(half_angle: float, hertz: float) -> None:
    """Whose second order is better than its order: its third order has no drift."""
    turns = coning_turns(radians(half_angle), 2 * pi * hertz)
    plain = second_order(turns, 800)
    third = ThirdOrder()
    found = third(plain).phi
    before, after = off(turns, plain.phi), off(turns, found)
    assert after.max() <= before.max()
    if hertz > 6 - 1e-9:
        assert np.array_equal(found, plain.phi)
        assert (third.corrected, third.left) == (0, 800)
    else:
        assert after[-1] < max(0.95 * before[-1], 1e-9)
        assert (third.corrected, third.left) == (800, 0)


@pytest.mark.parametrize(("half_angle", "cone", "spin"), [(45, 5, 10), (80, 20, 1), (20, 30, 2)])
def test_much_better_in_a_spin_cone(half_angle: float, cone: float, spin: float) -> None:
    turns = spinning(radians(half_angle), cone, spin)
    plain = second_order(turns, 800)
    before, after = off(turns, plain.phi), off(turns, ThirdOrder()(plain).phi)
    assert after[-1] < before[-1] / 60
    assert before[4] > 10 * after[4]  # what the first four lacked is made up at once


def test_the_fifth_interval_makes_up_for_the_first_four() -> None:
    """And they stay as they are: no interval waits for a later one."""
    plain = second_order(spinning(radians(45), 5, 10), 9)
    found = ThirdOrder()(plain).phi
    assert np.array_equal(found[:4], plain.phi[:4])
    later = ThirdOrder()(second_order(spinning(radians(45), 5, 10), 14)[5:]).phi
    lacking = np.linalg.norm(found - plain.phi, axis=1)
    assert 4.5 < lacking[4] / lacking[5] < 5.5
    assert np.linalg.norm(later[4:] - found[:5], axis=1)[0] > 0


def test_what_the_first_four_lack_is_carried_to_the_fifth() -> None:
    """Attitude and velocity then are as if each had been corrected where it is."""
    k = np.arange(5.0)[:, None]
    turns = 0.25 * np.hstack((0.1 + 0.01 * k, 0.05 - 0.004 * k**2, 0.02 * k))
    dv = np.hstack((0.3 - 0.02 * k, 0.01 * k**2, 0.1 + 0.03 * k))
    found = ThirdOrder()(MajorIncrements(turns, turns, dv))
    rates, forces = slopes(turns), slopes(dv - 0.5 * np.cross(turns, dv))
    lacking_turn, lacking_velocity = np.zeros((2, 5, 3))
    for row in range(5):
        there, pushed = (of_part(each, row - 4.0, 1.0) for each in (rates, forces))
        lacking_turn[row] = rotation_terms(there)[0]
        lacking_velocity[row] = velocity_terms(there, pushed)[0]

    def matrices(phi: Array) -> list[Array]:
        """Of the attitude before each interval and after the last."""
        made = [np.eye(3)]
        for row in phi:
            made.append(made[-1] @ Rotation.from_rotvec(row).as_matrix())
        return made

    plain, all_corrected, told = (
        matrices(each)[-1] for each in (turns, turns + lacking_turn, found.phi)
    )
    before, after = (
        np.linalg.norm(Rotation.from_matrix(each @ all_corrected.T).as_rotvec())
        for each in (plain, told)
    )
    assert after < 1e-3 * before
    bodies = matrices(turns)[:5]
    lost = sum(C @ v for C, v in zip(bodies, lacking_velocity, strict=True))
    made_up = bodies[4] @ (found.dv_sf[4] - dv[4])
    assert np.linalg.norm(made_up - lost) < 1e-3 * np.linalg.norm(lost)


def test_a_vibration_of_a_seventeenth_of_the_update_rate_is_the_limit() -> None:
    """Of a sinusoid differences grow by 2 sin(π f T) each, whatever its size and phase."""
    limit = np.arcsin(sqrt(SMOOTH) / 2) / pi
    assert 1 / limit == pytest.approx(17.3, abs=0.1)
    k = np.arange(300)[:, None]
    for size, phase in ((1e-7, 0.0), (0.3, 1.0)):
        for much, expected in ((0.97, True), (1.03, False)):
            angle = 2 * pi * much * limit * k + phase
            alpha = size * np.hstack((np.cos(angle), np.sin(angle), 0 * angle + 1))
            assert np.all(smooth_intervals(alpha)[4:] == expected)
            assert not smooth_intervals(alpha)[:4].any()


def test_noise_is_not_smooth_and_a_large_turn_is_left() -> None:
    noise = np.random.default_rng(5).normal(0, 1e-6, (1000, 3))
    assert smooth_intervals(noise + np.array([0.01, 0.02, 0.0])).mean() < 0.001
    steady = np.broadcast_to([1.01, 0.0, 0.0], (50, 3))
    assert not smooth_intervals(steady).any()
    assert smooth_intervals(0.99 / 1.01 * steady)[4:].all()


def test_a_step_is_left_for_ten_intervals() -> None:
    alpha = np.zeros((40, 3))
    alpha[20:, 0] = 0.1
    smooth = smooth_intervals(alpha)
    assert smooth[4:20].all()
    assert not smooth[21:30].any()
    assert smooth[33:].all()


def test_slopes_are_those_of_a_polynomial() -> None:
    """Exact for the fourth degree, and moved to other intervals and halves of them."""
    rate = Polynomial([0.3, -1.0, 2.0, 0.7, -0.4])
    total = rate.integ()
    sums = np.array([[total(k + 0.5) - total(k - 0.5)] * 3 for k in range(-4, 1)])
    found = slopes(sums)
    assert [each[0, 0] for each in found] == pytest.approx(rate.coef.tolist(), rel=1e-12)
    for middle, length in ((-2.0, 1.0), (0.25, 0.5)):
        there = [each[0, 1] for each in of_part(found, middle, length)]
        moved = rate(Polynomial([middle, length])).coef * length
        assert there == pytest.approx(moved.tolist(), rel=1e-11)


def test_blocks_of_any_length_and_beginning_anew() -> None:
    plain = second_order(spinning(radians(45), 5, 10), 60)
    turning = np.arange(60)[:, None] * 0.01
    dv = np.hstack((0.1 + turning, 0.02 * np.sin(3 * turning), 0.1 * turning**2))
    plain = MajorIncrements(plain.phi, plain.alpha, dv)
    whole = ThirdOrder()(plain)
    assert not np.array_equal(whole.dv_sf, plain.dv_sf)
    for cuts in ([1, 2, 3, 4, 5, 20], [0, 4, 4, 22], [5, 17], [60]):
        corrector, parts = ThirdOrder(), []
        for first, last in zip([0, *cuts], [*cuts, 60], strict=True):
            parts.append(corrector(plain[first:last]))
        joined = MajorIncrements.concatenate(parts)
        assert np.array_equal(joined.phi, whole.phi)
        assert np.array_equal(joined.dv_sf, whole.dv_sf)
        assert (corrector.corrected, corrector.left, corrector.waiting) == (60, 0, 0)
    few = ThirdOrder()
    assert np.array_equal(few(plain[:3]).phi, plain.phi[:3])
    assert (few.corrected, few.left, few.waiting) == (0, 0, 3)


def test_blocks_of_any_length_where_vibration_comes_and_goes() -> None:
    """Also what is smooth again depends on ten intervals before, in whatever blocks they came."""
    k, rng = np.arange(160), np.random.default_rng(6)
    smooth = np.column_stack((0.05 * np.sin(0.1 * k), 0.05 * np.cos(0.07 * k), 0.01 + 0 * k))
    smooth[60:75, 0] += 1e-3 * np.sin(2 * pi * 0.3 * k[60:75])
    smooth[110, 1] += 0.2
    plain = MajorIncrements(smooth, smooth, 0.3 + 2 * np.roll(smooth, 1, axis=1))
    whole = ThirdOrder()
    expected = whole(plain)
    kept = np.flatnonzero((expected.phi == smooth).all(axis=1))
    assert set(range(63, 75)) < set(kept) < {*range(4), *range(60, 90), *range(110, 125)}
    assert (whole.corrected, whole.left) == (160 + 4 - len(kept), len(kept) - 4)
    for _ in range(25):
        cuts = [0, *sorted(rng.integers(0, 161, int(rng.integers(1, 40))).tolist()), 160]
        corrector = ThirdOrder()
        parts = [corrector(plain[a:b]) for a, b in pairwise(cuts)]
        joined = MajorIncrements.concatenate(parts)
        assert np.array_equal(joined.phi, expected.phi)
        assert np.array_equal(joined.dv_sf, expected.dv_sf)
        assert (corrector.corrected, corrector.left) == (whole.corrected, whole.left)


def test_intervals_of_short_history_are_counted_as_left() -> None:
    plain = second_order(spinning(radians(45), 5, 10), 22)
    third = ThirdOrder()
    third(plain[:3])
    assert (third.corrected, third.left, third.waiting) == (0, 0, 3)
    short = replace(plain[3:20], status=np.array([0, 1] + [0] * 15))
    third(short)  # three that waited, and two
    assert (third.corrected, third.left, third.waiting) == (15, 5, 0)
    third(plain[20:])
    assert (third.corrected, third.left, third.waiting) == (17, 5, 0)
    third(replace(plain[:1], status=np.ones(1, int)))  # none waits any more
    assert (third.corrected, third.left, third.waiting) == (17, 6, 0)


def test_vibration_that_begins_and_ends() -> None:
    """What it shakes is left, what comes after it is corrected again."""
    k = np.arange(400)
    shaken = 1e-3 * np.sin(2 * pi * 0.3 * k) * ((k > 150) & (k < 250))
    smooth = np.column_stack((0.05 * np.sin(0.1 * k), 0.05 * np.cos(0.07 * k), 0.01 + 0 * k))
    found = smooth_intervals(smooth + shaken[:, None])
    assert found[4:150].all()
    assert not found[152:250].any()
    assert found[265:].all()
    assert sin(pi * 0.3) ** 2 * 4 > SMOOTH
