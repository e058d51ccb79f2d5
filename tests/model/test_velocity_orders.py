"""ΔV_SF beyond second order where the axis of the rate turns, against a closed form.

The attitude is exp(a× t) exp(b× t), so the body's rate is exp(-b× t) a + b, whose axis turns with
|b|; the specific force is exp(-b× t) g, which in inertial space turns about a alone:

    ∫ C f dt = ∫ exp(a× t) g dt = t g + (1 - cos x)/x² (at)×g t + (1 - sin x/x)/x² (at)×((at)×g) t
"""

from __future__ import annotations

from math import cos, sin

import numpy as np
import pytest
from numpy.typing import NDArray

from host_path import fine_design
from sculler_model.fast import FastModel
from sculler_model.host import (
    MajorIncrements,
    ThirdOrder,
    major_increments,
    velocity_higher_orders,
    velocity_rotation,
)
from sculler_model.samples import Quantiser

Array = NDArray[np.float64]

A, B, FORCE = np.array([0.6, 1.1, -0.7]), np.array([2.0, -1.5, 2.5]), np.array([20.0, -8.0, 12.0])
NODES, WEIGHTS = (
    0.5 * (x + first) for x, first in zip(np.polynomial.legendre.leggauss(12), (1, 0), strict=True)
)


def skew(v: Array) -> Array:
    x, y, z = v
    return np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])


def turned(v: Array, t: float) -> Array:
    """exp(v× t)."""
    size = float(np.linalg.norm(v))
    unit = skew(v / size)
    found: Array = np.eye(3) + sin(size * t) * unit + (1 - cos(size * t)) * unit @ unit
    return found


def velocity(t: float) -> Array:
    """∫ exp(a× s) g ds from 0 to t."""
    size = float(np.linalg.norm(A))
    unit, x = skew(A / size), size * t
    found: Array = (
        t * FORCE + ((1 - cos(x)) * unit @ FORCE + (x - sin(x)) * unit @ unit @ FORCE) / size
    )
    return found


def sensed(t: float) -> Array:
    """Rate and force in the body, (6,)."""
    back = turned(B, -t)
    return np.concatenate((back @ A + B, back @ FORCE))


def integral(start: float, length: float) -> Array:
    return np.sum(
        [length * w * sensed(start + length * x) for x, w in zip(NODES, WEIGHTS, strict=True)],
        axis=0,
    )


def true(start: float, T: float) -> Array:
    attitude = turned(A, start) @ turned(B, start)
    found: Array = attitude.T @ (velocity(start + T) - velocity(start))
    return found


def errors(T: float, start: float = 0.3) -> tuple[float, float]:
    """Of ΔV_SF over one interval to second order, and with the higher orders (m/s)."""
    sums = integral(start, T)
    running = np.array([integral(start, T * x) for x in NODES])
    within = np.array([sensed(start + T * x) for x in NODES])
    alpha, upsilon = sums[:3], sums[3:]
    s_alpha, s_upsilon = (T * (WEIGHTS @ running[:, part]) for part in (slice(3), slice(3, 6)))
    once = np.cross(running[:, :3], within[:, 3:])
    sculling = T * WEIGHTS @ once - 0.5 * np.cross(alpha, upsilon)
    scrolling = T * T * (WEIGHTS * (1 - NODES)) @ once
    scrolling -= (np.cross(s_alpha, upsilon) + np.cross(alpha, s_upsilon)) / 6
    rows = [v[None] for v in (alpha, upsilon, s_alpha, s_upsilon, sculling, scrolling)]
    second = upsilon + velocity_rotation(rows[0], rows[1])[0] + sculling
    higher = velocity_higher_orders(*rows, T)[0]  # type: ignore[call-arg, arg-type]
    exact = true(start, T)
    return (
        float(np.linalg.norm(second - exact)),
        float(np.linalg.norm(second + higher - exact)),
    )


def test_the_higher_orders_go_from_the_fourth_to_the_fifth_power() -> None:
    """At 20 ms 2.02e-6 m/s becomes 7.4e-9."""
    (second, all_orders), (half_second, half_all) = errors(0.02), errors(0.01)
    assert second == pytest.approx(2.02e-6, rel=0.01)
    assert all_orders == pytest.approx(7.36e-9, rel=0.01)
    assert second / half_second == pytest.approx(2**4, rel=0.05)
    assert half_all < all_orders / 2**4.8


def increments(high_resolution: bool, T: float, count: int) -> tuple[MajorIncrements, Array]:
    """Of counts through the core, and what they should be."""
    per = 20
    position = "high-resolution" if high_resolution else "trapezoidal"
    design = fine_design(4, 0, per // 4, per / T, 4e-12, 4e-11, position=position)
    if high_resolution:
        design = fine_design(1, 1, per, per / T, 4e-12, 4e-11, position=position)
    samples = np.array([integral(T / per * k, T / per) for k in range(per * count)])
    block = FastModel(design).feed(Quantiser(design)(samples))
    return major_increments(design, block), np.array([true(T * k, T) for k in range(count)])


@pytest.mark.parametrize("high_resolution", [True, False])
def test_through_the_core(high_resolution: bool) -> None:
    """Without high-resolution position from five intervals, with `ThirdOrder`."""
    found, exact = increments(high_resolution, 0.02, 8)
    better = ThirdOrder()(found)
    off = np.linalg.norm(better.dv_sf - exact, axis=1)[5:]
    if high_resolution:
        assert np.array_equal(better.dv_sf, found.dv_sf)
    else:
        assert np.linalg.norm(found.dv_sf - exact, axis=1)[5:].min() > 1e-6
        assert np.array_equal(better.dv_sf[:4], found.dv_sf[:4])
    assert off.max() < 9e-9  # n = 4 itself leaves 8e-9 of it


def test_five_intervals_go_to_the_sixth_power() -> None:
    worst = []
    for T in (0.04, 0.02):
        exact = np.array([true(T * k, T) for k in range(8)])
        pairs = [second_order(T, k) for k in range(8)]
        alpha, dv_sf = (np.array([pair[i] for pair in pairs]) for i in range(2))
        found = ThirdOrder()(MajorIncrements(alpha, alpha, dv_sf))
        worst.append(float(np.linalg.norm(found.dv_sf - exact, axis=1)[5:].max()))
    assert worst[0] / worst[1] == pytest.approx(2**6, rel=0.1)
    assert worst[1] < 2e-9  # of 2.02e-6


def test_the_fifth_interval_makes_up_for_the_first_four() -> None:
    """The velocity over five intervals is as good as that of the fifth alone would be."""
    T = 0.02
    alpha, dv_sf = map(np.array, zip(*(second_order(T, k) for k in range(5)), strict=True))
    plain = MajorIncrements(alpha, alpha, dv_sf)
    found = ThirdOrder()(plain)

    def off(increments: MajorIncrements) -> Array:
        turns = [turned(A, T * k) @ turned(B, T * k) for k in range(5)]
        pairs = zip(turns, increments.dv_sf, strict=True)
        return np.sum([C @ dv for C, dv in pairs], axis=0) - velocity(5 * T)

    before, after = off(plain), off(found)
    assert np.linalg.norm(before) > 8e-6  # five times 2e-6
    assert np.linalg.norm(after) < 4e-8
    assert np.array_equal(found.dv_sf[:4], dv_sf[:4])


def second_order(T: float, k: int) -> tuple[Array, Array]:
    """α and ΔV_SF of interval k, the integrals exact."""
    sums = integral(T * k, T)
    running = np.array([integral(T * k, T * x) for x in NODES])
    within = np.array([sensed(T * k + T * x) for x in NODES])
    alpha, upsilon = sums[:3], sums[3:]
    once = T * WEIGHTS @ np.cross(running[:, :3], within[:, 3:])
    sculling = once - 0.5 * np.cross(alpha, upsilon)
    return alpha, upsilon + velocity_rotation(alpha[None], upsilon[None])[0] + sculling


def test_block_by_block() -> None:
    found, _ = increments(False, 0.02, 8)
    whole, parts = ThirdOrder()(found), ThirdOrder()
    pieces = [parts(found[k : k + 1]).dv_sf for k in range(len(found))]
    assert np.array_equal(np.concatenate(pieces), whole.dv_sf)
