"""What the series of the orders leaves of a cone, against the integers and against itself."""

from __future__ import annotations

from math import pi, radians, sin

import pytest

from sculler_model.analysis.cone_orders import cone_orders
from sculler_model.analysis.orders import HeldConing, left_by_order
from sculler_model.analysis.triple import ConingTurn
from sculler_model.design import Design

DENSE = Design.preset("stim300", family="uncompressed", samples=4)


@pytest.mark.parametrize("spin", [0.0, 360.0])
def test_it_is_what_the_core_leaves(spin: float) -> None:
    """A cone of 10° at 50 Hz, which the samples show well, handed over at 100 Hz."""
    hertz = 50.15
    found = cone_orders(radians(10), 2 * pi * hertz * 0.01, spin / 360 / hertz)
    motion = ConingTurn(radians(10), hertz, spin=radians(spin))
    through = {each.order: each for each in left_by_order(DENSE, HeldConing(motion), [5], 0.2)}
    for order, drift in ((2, found.second), (3, found.order_3), (4, found.order_4)):
        # beside the drift there is a tilt that does not grow
        assert abs(20 * drift) == pytest.approx(through[order].attitude, rel=0.05, abs=1e-5)


@pytest.mark.parametrize("turned", [0.3, 0.6])
def test_third_and_fourth_order_of_a_small_cone_cancel(turned: float) -> None:
    """The fourth's mean in closed form, which the third's cancels but for a power of two more."""
    left, size = cone_orders(radians(5), turned), sin(radians(5)) ** 4
    fourth = left.fourth - left.third
    assert fourth == pytest.approx(size * (turned**5 / 720 - 11 * turned**7 / 30240), rel=0.03)
    assert left.second == pytest.approx(-size * turned**7 / 3360, rel=0.05)
    assert abs(left.fourth) < 1e-3 * abs(left.second)
    assert left.order_3 / left.second == pytest.approx(-3 / 5, rel=0.01)


def test_without_an_axis_that_moves_there_is_nothing() -> None:
    """A spin alone is one rotation, which the first order has."""
    left = cone_orders(1e-9, 1.0, spin=0.5)
    assert max(map(abs, vars(left).values())) < 1e-14
